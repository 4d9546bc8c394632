/* What the front needs of the system. */
#ifndef FRONT_H
#define FRONT_H

#include "fmi2Functions.h"

#include <stddef.h>

/* On Windows a function with more on its stack would need code that the front is linked without. */
#ifdef _WIN32
#define LONGEST_PATH 600
#else
#define LONGEST_PATH 4096
#endif

/* Version of the Python in this process as text, 3.11.2 and so on; NULL if there is none. */
const char *python_version(void);

/* The library of pythonfmu, which lies beside this one; NULL with a reason if it cannot be loaded. */
void *load_library(const char **reason);

void *find_symbol(void *library, const char *name);

/* Make of a path, in UTF-8 and LONGEST_PATH bytes, one that pythonfmu can open and Python read; 0 if there is none. */
int to_plain_path(char *path);

/* Read the text at the beginning of a file in a folder, of LONGEST_TEXT bytes with its end; 0 if there is no file. */
#define LONGEST_TEXT 64
int read_text(const char *folder, const char *name, char *text);

#endif
