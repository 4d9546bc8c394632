/* The functions of FMI 3.0 with the counted memory of the tests: a host of FMI 3.0 has none to give. */
#define calloc counted_allocate
#define free counted_free
#include "fmi3.c"
