/* A host that reports a Python version: python_host LIBRARY [VERSION]. */
#include "fmi2Functions.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#ifdef WITH_PYTHON
const char *Py_GetVersion(void);

static const char *version;

const char *Py_GetVersion(void)
{
    return version;
}
#endif

static void print(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                  fmi2String format, ...)
{
    va_list arguments;
    (void)environment;
    (void)name;
    printf("%d %s: ", status, category);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
}

int main(int count, char **arguments)
{
    const fmi2CallbackFunctions callbacks = {print, NULL, NULL, NULL, NULL};
    fmi2InstantiateTYPE *instantiate;
    void *const library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
    void *const found = library ? dlsym(library, "fmi2Instantiate") : NULL;
    if (!found) {
        printf("%s\n", dlerror());
        return 1;
    }
#ifdef WITH_PYTHON
    version = arguments[count - 1];
#else
    (void)count;
#endif
    memcpy(&instantiate, &found, sizeof found);
    return instantiate("host", fmi2CoSimulation, "", "file:///tmp", &callbacks, fmi2False, fmi2True) != NULL;
}
