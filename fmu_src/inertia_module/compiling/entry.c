/* The kernel on its own, for those who know its arrays. */
#include <stdint.h>

#if defined _WIN32
#define OFFERED __declspec(dllexport)
#else
#define OFFERED __attribute__((visibility("default")))
#endif

int64_t KERNEL(int64_t operation, double *p, double *d, double *u, double *x, double *y, double *w, double h);
OFFERED int64_t inertia_module_kernel(int64_t operation, double *p, double *d, double *u, double *x, double *y,
                                      double *w, double h);

int64_t inertia_module_kernel(int64_t operation, double *p, double *d, double *u, double *x, double *y, double *w,
                              double h)
{
    return KERNEL(operation, p, d, u, x, y, w, h);
}
