/* Linux. */
#ifndef _WIN32
#define _GNU_SOURCE
#include "front.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

const char *python_version(void)
{
    const char *(*version)(void);
    void *const found = dlsym(RTLD_DEFAULT, "Py_GetVersion");
    memcpy(&version, &found, sizeof found);
    return found ? version() : NULL;
}

void *load_library(const char **reason)
{
    Dl_info own;
    char path[LONGEST_PATH];
    if (!dladdr(PYTHONFMU, &own))
        return NULL;
    const char *const slash = strrchr(own.dli_fname, '/');
    snprintf(path, sizeof path, "%.*s%s", slash ? (int)(slash - own.dli_fname + 1) : 0, own.dli_fname, PYTHONFMU);
    void *const library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library)
        *reason = dlerror();
    return library;
}

void *find_symbol(void *library, const char *name)
{
    return dlsym(library, name);
}

int to_plain_path(char *path)
{
    (void)path;
    return 1;
}

int read_text(const char *folder, const char *name, char *text)
{
    char path[LONGEST_PATH + 32];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *const file = fopen(path, "rb");
    if (!file)
        return 0;
    text[fread(text, 1, LONGEST_TEXT - 1, file)] = '\0';
    fclose(file);
    return 1;
}

#else
typedef int no_posix; /* a file of C has to declare something */
#endif
