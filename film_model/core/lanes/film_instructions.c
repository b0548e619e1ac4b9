/* The widest instructions that this processor and its operating system have. */
#include "film_core.h"
#include "lanes/film_wide.h"

#if defined(FILM_WIDE)
#include <cpuid.h>

int film_instructions(void) {
    unsigned a, b, c, d, low, high;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE)) return FILM_PLAIN;
    /* which registers the operating system saves */
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    if ((low & 0x06) != 0x06 || !__get_cpuid_count(7, 0, &a, &b, &c, &d) || !(b & bit_AVX2)) return FILM_PLAIN;
    const unsigned all = bit_AVX512F | bit_AVX512DQ | bit_AVX512VL;
    return (low & 0xe6) == 0xe6 && (b & all) == all ? FILM_AVX512 : FILM_AVX2;
}
#else
int film_instructions(void) { return FILM_PLAIN; }
#endif
