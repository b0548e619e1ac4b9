/* Loops that are compiled for several instruction sets: for the plain instructions of the processor's kind and, on x86, for
 * AVX2 and AVX-512; never with fused multiply-adds, so that all give the same bits. Internal. */
#ifndef FILM_WIDE_H
#define FILM_WIDE_H

/* Wider registers are used on x86-64; not by GCC for Windows, which does not align them on the stack. */
#if defined(__x86_64__) && (defined(__clang__) || (defined(__GNUC__) && !defined(_WIN32)))
#define FILM_WIDE
#endif

#endif
