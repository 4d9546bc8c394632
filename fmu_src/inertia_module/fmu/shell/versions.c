/* What the FMU is made for, and the kernel on its own for those who know its arrays. */
#include "instance.h"

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

FMI2_Export int64_t inertia_module_kernel(int64_t operation, double *p, double *d, double *u, double *x, double *y,
                                          double *w, double h)
{
    return KERNEL(operation, p, d, u, x, y, w, h);
}
