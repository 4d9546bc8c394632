/* Many communication steps of one entry, the kernel's or the hand-written one, called the same way. */
#include <stdint.h>

typedef int64_t entry(int64_t operation, const double *p, const double *d, const double *u, double *x, double *y,
                      double *w, double h);

/* Returns the status of the last step. */
int64_t loop(entry *call, int64_t operation, const double *p, const double *d, const double *u, double *x,
             double *y, double *w, double h, int64_t steps)
{
    int64_t status = 0;
    for (int64_t n = 0; n < steps && status == 0; n++)
        status = call(operation, p, d, u, x, y, w, h);
    return status;
}
