/* What the fuzzers of contact on modes and of bodies that relax share: random numbers from the number of the run, and how
 * they fail. FUZZ: the fuzzer's name. */
#ifndef FUZZ_NUMBERS_H
#define FUZZ_NUMBERS_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t seed;
static long runs;

static double uniform(void) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) / 9007199254740992.0;
}

static double spread(double low, double high) { return low * pow(high / low, uniform()); }

static void fail(const char *what) {
    fprintf(stderr, FUZZ ": %s in run %ld\n", what, runs);
    abort();
}

#endif
