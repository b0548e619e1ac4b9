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

/* From first touch along a force of exponent 3/2 to the end of its stage: velocity over the first one, and time over the
 * stage's length over that velocity. push: gamma times the force at the end over the velocity; share: of the energy, what the
 * stage stores; beyond: 1 for the lanes that the table does not have, whose values have no meaning. */
static void through_lanes(const double *restrict push, const double *restrict share, double *restrict velocity,
                          double *restrict time, double *restrict beyond) {
    double at[LANES], z[LANES], fourth[LANES], sum[LANES][8];
    int cell[LANES];
    for (int l = 0; l < LANES; l++) {
        double place = push[l] < PUSH_END ? push[l] * (PUSH_PIECES / PUSH_END) : 0.0;
        int piece = (int)place;
        double left = 1.0 - share[l] / largest_share(place, piece), margin = sqrt(left > 0.0 ? left : 0.0);
        int near = margin < MARGIN;
        beyond[l] = push[l] < PUSH_END && left > 0.0 ? 0.0 : 1.0;
        at[l] = 2.0 * (place - piece) - 1.0;
        z[l] = 2.0 * (near ? margin * (1.0 / MARGIN) : (margin - MARGIN) * (1.0 / (1.0 - MARGIN))) - 1.0;
        fourth[l] = z[l] * z[l] * (z[l] * z[l]);
        cell[l] = 2 * piece + 1 - near;
    }
    for (int l = 0; l < LANES; l++) {
        const double *row = &film_way_through[cell[l] * THROUGH_NUMBERS];
        double all[8] = {0.0}, power = 1.0;
        for (int rows = THROUGH_TERMS; rows > 0; rows -= 4) { /* of four powers of the margin */
            double four[8] = {0.0};
            for (int k = 0; k < rows; k++, row += 8)
                for (int i = 0; i < 8; i++) four[i] = four[i] * at[l] + row[i];
            for (int i = 0; i < 8; i++) all[i] += four[i] * power;
            power *= fourth[l];
        }
        memcpy(sum[l], all, sizeof all);
    }
    EACH(l) {
        velocity[l] = ((sum[l][6] * z[l] + sum[l][4]) * z[l] + sum[l][2]) * z[l] + sum[l][0];
        time[l] = ((sum[l][7] * z[l] + sum[l][5]) * z[l] + sum[l][3]) * z[l] + sum[l][1];
    }
}

#endif
