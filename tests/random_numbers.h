/* Random numbers of the C checks: the same in every run and on every machine. */
#ifndef RANDOM_NUMBERS_H
#define RANDOM_NUMBERS_H

#include <math.h>
#include <stdint.h>

static uint64_t seed = 20170417;

static double uniform(double low, double high) { /* splitmix64 */
    seed += 0x9e3779b97f4a7c15u;
    uint64_t z = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return low + (high - low) * (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static int32_t whole(int32_t low, int32_t high) { /* both included */
    int32_t n = low + (int32_t)uniform(0.0, (double)(high - low + 1));
    return n > high ? high : n;
}

static double over_decades(double low, double high) { return low * pow(high / low, uniform(0.0, 1.0)); }

#endif
