/* What Windows needs of a library that zig links without the startup code of mingw-w64, which takes a minute to compile:
 * an entry point, and the two functions of printf that the system's C library has under another name. */
#include <stdio.h>
#include <windows.h>

enum { STANDARD_RESULT = 2 }; /* _CRT_INTERNAL_PRINTF_STANDARD_SNPRINTF_BEHAVIOR: returns the length and ends the text, as C99 says */

int __cdecl __stdio_common_vsprintf(unsigned __int64 options, char *to, size_t room, const char *format, _locale_t locale,
                                    va_list arguments);
BOOL WINAPI DllMainCRTStartup(HINSTANCE library, DWORD reason, LPVOID reserved);

BOOL WINAPI DllMainCRTStartup(HINSTANCE library, DWORD reason, LPVOID reserved) {
    (void)library, (void)reason, (void)reserved;
    return TRUE; /* no variables to initialize */
}

int vsnprintf(char *to, size_t room, const char *format, va_list arguments) {
    return __stdio_common_vsprintf(STANDARD_RESULT, to, room, format, NULL, arguments);
}

int snprintf(char *to, size_t room, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(to, room, format, arguments);
    va_end(arguments);
    return length;
}
