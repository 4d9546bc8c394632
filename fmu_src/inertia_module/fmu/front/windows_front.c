/* Windows: pythonfmu opens files by the letters of the country and Python reads UTF-8, so a path has to be ASCII. */
#ifdef _WIN32
#include "front.h"

#include <stdio.h>
#include <string.h>
#include <windows.h>

const char *python_version(void)
{
    const char *(*version)(void);
    const HMODULE python = LoadLibraryW(L"python3.dll");
    const FARPROC found = python ? GetProcAddress(python, "Py_GetVersion") : NULL;
    memcpy(&version, &found, sizeof found);
    return found ? version() : NULL;
}

void *load_library(const char **reason)
{
    static const wchar_t name[] = L"" PYTHONFMU;
    wchar_t path[LONGEST_PATH];
    HMODULE own;
    *reason = "it must be in the same folder as the library of this FMU, and python3.dll must be on the DLL search path";
    if (!GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS, (LPCWSTR)(const void *)name, &own))
        return NULL;
    DWORD length = GetModuleFileNameW(own, path, LONGEST_PATH);
    while (length > 0 && path[length - 1] != L'\\')
        length--;
    if (length + sizeof name / sizeof *name > LONGEST_PATH)
        return NULL;
    memcpy(path + length, name, sizeof name);
    return LoadLibraryExW(path, NULL, 0);
}

void *find_symbol(void *library, const char *name)
{
    const FARPROC found = GetProcAddress(library, name);
    void *address;
    memcpy(&address, &found, sizeof found);
    return address;
}

int to_plain_path(char *path)
{
    wchar_t wide[LONGEST_PATH], brief[LONGEST_PATH];
    if (!MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide, LONGEST_PATH))
        return 0;
    const wchar_t *letters = wide;
    while (*letters && *letters < 128)
        letters++;
    if (!*letters)
        return 1;
    const DWORD length = GetShortPathNameW(wide, brief, LONGEST_PATH);
    if (length == 0 || length >= LONGEST_PATH)
        return 0;
    for (DWORD n = 0; n <= length; n++) {
        if (brief[n] >= 128)
            return 0;
        path[n] = brief[n] == L'\\' ? '/' : (char)brief[n];
    }
    return 1;
}

int read_text(const char *folder, const char *name, char *text)
{
    char path[LONGEST_PATH + 32];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    const HANDLE file = CreateFileA(path, GENERIC_READ, FILE_SHARE_READ, NULL, OPEN_EXISTING, 0, NULL);
    DWORD length = 0;
    if (file == INVALID_HANDLE_VALUE)
        return 0;
    ReadFile(file, text, LONGEST_TEXT - 1, &length, NULL);
    CloseHandle(file);
    text[length] = '\0';
    return 1;
}

#else
typedef int no_windows; /* a file of C has to declare something */
#endif
