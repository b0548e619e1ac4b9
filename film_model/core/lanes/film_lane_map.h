/* Whole ways by tables, in lanes. Internal to film_lanes.c. docs/method.md, section 10. */
#ifndef FILM_LANE_MAP_H
#define FILM_LANE_MAP_H

#include "lanes/film_lane_law.h"

/* The functions of a table at a number from 0 to MAP_END, up to four, each lane at its own; a number that is not there gives
 * values without a meaning. The piece and the place z in it, -1 to 1, are bits of 1 + number; even and odd powers of z are summed
 * apart, so that neither sum waits for the other. */
static void map_lanes(const double *table, int count, int functions, const double *restrict number, double (*restrict out)[4]) {
    uint64_t bits[LANES], piece[LANES];
    double z[LANES];
    EACH(l) {
        double y = number[l] < MAP_END ? 1.0 + number[l] : 1.0;
        z[l] = y > 1.0 ? y : 1.0;
    }
    memcpy(bits, z, sizeof bits);
    EACH(l) {
        piece[l] = (bits[l] >> 49) - (1023u << 3);
        bits[l] = ((bits[l] & 0x0001ffffffffffffu) << 3) | 0x3ff0000000000000u;
    }
    memcpy(z, bits, sizeof z);
    for (int l = 0; l < LANES; l++) {
        const double *row = table + (piece[l] * (uint64_t)count + (uint64_t)count) * (uint64_t)functions;
        double at = 2.0 * z[l] - 3.0, square = at * at, even[4] = {0.0}, odd[4] = {0.0};
        if (count % 2) {
            row -= functions;
            for (int f = 0; f < 4; f++) even[f] = row[f];
        }
        for (int k = count / 2; k > 0; k--) {
            row -= functions;
            for (int f = 0; f < 4; f++) odd[f] = odd[f] * square + row[f];
            row -= functions;
            for (int f = 0; f < 4; f++) even[f] = even[f] * square + row[f];
        }
        for (int f = 0; f < 4; f++) out[l][f] = even[f] + at * odd[f];
    }
}

#endif
