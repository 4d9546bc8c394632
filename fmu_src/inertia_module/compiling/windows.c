/* What a library needs on Windows to do without the start-up code of a compiler: it has no state to set up. */
#ifdef _WIN32

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

int _fltused = 0; /* the compiler's mark of code that uses floating point */

int __stdcall DllMainCRTStartup(void *library, unsigned long reason, void *reserved);

int __stdcall DllMainCRTStartup(void *library, unsigned long reason, void *reserved)
{
    (void)library;
    (void)reason;
    (void)reserved;
    return 1;
}

/* The runtime of Windows 10 has one function for all of printf into memory. */
#define STANDARD_SNPRINTF 2ULL /* always end the text, return its whole length */

int vsnprintf(char *buffer, size_t size, const char *format, va_list arguments)
{
    return __stdio_common_vsprintf(STANDARD_SNPRINTF, buffer, size, format, NULL, arguments);
}

int snprintf(char *buffer, size_t size, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(buffer, size, format, arguments);
    va_end(arguments);
    return length;
}

#else
typedef int no_windows; /* a file of C has to declare something */
#endif
