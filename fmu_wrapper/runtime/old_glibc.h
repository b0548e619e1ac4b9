/* Included first where a system's own compiler makes the binary: glibc 2.29 has newer versions of these functions, and
 * an FMU must also load where glibc is as old as 2.17. */
#if defined(__linux__) && defined(__x86_64__)
#include <features.h>
#if defined(__GLIBC__)
__asm__(".symver pow,pow@GLIBC_2.2.5");
__asm__(".symver exp,exp@GLIBC_2.2.5");
__asm__(".symver log,log@GLIBC_2.2.5");
#endif
#elif defined(__linux__) && defined(__aarch64__)
#include <features.h>
#if defined(__GLIBC__)
__asm__(".symver pow,pow@GLIBC_2.17");
__asm__(".symver exp,exp@GLIBC_2.17");
__asm__(".symver log,log@GLIBC_2.17");
#endif
#endif
