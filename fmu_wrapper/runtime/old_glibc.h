/* Included first where a system's own compiler makes a library: glibc 2.29 and 2.35 have newer versions of these functions (the same
 * values, without the old error handling), and wheels and FMUs must also load where glibc is as old as 2.17. */
#if defined(__linux__) && defined(__x86_64__)
#include <features.h>
#if defined(__GLIBC__)
__asm__(".symver pow,pow@GLIBC_2.2.5");
__asm__(".symver exp,exp@GLIBC_2.2.5");
__asm__(".symver log,log@GLIBC_2.2.5");
__asm__(".symver hypot,hypot@GLIBC_2.2.5");
#endif
#elif defined(__linux__) && defined(__aarch64__)
#include <features.h>
#if defined(__GLIBC__)
__asm__(".symver pow,pow@GLIBC_2.17");
__asm__(".symver exp,exp@GLIBC_2.17");
__asm__(".symver log,log@GLIBC_2.17");
__asm__(".symver hypot,hypot@GLIBC_2.17");
#endif
#endif
