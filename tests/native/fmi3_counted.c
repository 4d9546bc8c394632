/* The functions of FMI 3.0 with the counted memory of the tests. FMI 3.0 has no memory callbacks. */
#define calloc counted_allocate
#define free counted_free
#include "fmi3.c"
