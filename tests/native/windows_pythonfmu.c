/* Replaces python3.dll, the library of pythonfmu, or a host of both on Windows. A macro selects one of the three. */
#include "fmi2FunctionTypes.h"

#include <windows.h>

int __stdcall begin(void *library, unsigned long reason, void *reserved);

#if defined PYTHON
__declspec(dllexport) const char *Py_GetVersion(void);

const char *Py_GetVersion(void)
{
    return "3.11.2";
}

int __stdcall begin(void *library, unsigned long reason, void *reserved)
{
    (void)library, (void)reason, (void)reserved;
    return 1;
}

#elif defined BEHIND
/* Write the arguments to the log of the host. */
__declspec(dllexport) fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String path,
                                                    const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                                    fmi2Boolean logging);

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String path,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)type, (void)guid, (void)visible, (void)logging;
    callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "", path);
    const int found = SetCurrentDirectoryA(path) && GetFileAttributesA("slavemodule.txt") != INVALID_FILE_ATTRIBUTES;
    callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "", found ? "found" : "missing");
    return NULL;
}

#define STUB(name)                          \
    __declspec(dllexport) int name(void);   \
    int name(void)                          \
    {                                       \
        return 0;                           \
    }
STUBS

int __stdcall begin(void *library, unsigned long reason, void *reserved)
{
    (void)library, (void)reason, (void)reserved;
    return 1;
}

#else
static void print(const char *text)
{
    DWORD written, length = 0;
    while (text[length])
        length++;
    WriteFile(GetStdHandle(STD_OUTPUT_HANDLE), text, length, &written, NULL);
    WriteFile(GetStdHandle(STD_OUTPUT_HANDLE), "\n", 1, &written, NULL);
}

static void hear(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                 fmi2String format, ...)
{
    va_list arguments;
    (void)environment, (void)name, (void)status, (void)category;
    va_start(arguments, format);
    print(format[0] == '%' && format[1] == 's' ? va_arg(arguments, const char *) : format);
    va_end(arguments);
}

int __stdcall begin(void *library, unsigned long reason, void *reserved)
{
    const fmi2CallbackFunctions callbacks = {hear, NULL, NULL, NULL, NULL};
    static char location[4096];
    const HMODULE front = LoadLibraryA("InertiaModulePy.dll");
    fmi2InstantiateTYPE *const instantiate =
        front ? (fmi2InstantiateTYPE *)(void *)GetProcAddress(front, "fmi2Instantiate") : NULL;
    (void)library, (void)reason, (void)reserved;
    if (!GetEnvironmentVariableA("LOCATION", location, sizeof location))
        print("no location");
    else if (!instantiate)
        print("no library");
    else
        instantiate("host", fmi2CoSimulation, "", location, &callbacks, fmi2False, fmi2True);
    ExitProcess(0);
}
#endif
