/* The kernel (made from Python), and the floating-point environment that it runs in. */
#ifndef KERNEL_H
#define KERNEL_H

#include <stdint.h>

/* Names that several files share. In sources/all.c all files are one, and nothing but the functions of FMI is visible. */
#ifdef ALL_IN_ONE
#define INTERNAL static
#define INTERNAL_OBJECT static
#else
#define INTERNAL extern
#define INTERNAL_OBJECT
#endif

/* It works on the arrays of the caller alone and changes nothing else. */
INTERNAL int64_t KERNEL(int64_t operation, double *p, double *d, double *u, double *x, double *y, double *w, double h);

/* The default environment of C: exceptions set flags, rounding to nearest, subnormal numbers.
 *
 * A host may have another one. Programs in Delphi and Fortran let exceptions interrupt, others flush subnormal numbers.
 * The optimiser moves divisions in front of their conditions, so the kernel may divide by zero and drop the result.
 */
#if defined __x86_64__ || defined _M_X64
#include <xmmintrin.h>
#define DEFAULT_MXCSR 0x1f80u
typedef unsigned environment;

static inline environment enter_default_environment(void)
{
    const environment of_host = _mm_getcsr();
    _mm_setcsr(DEFAULT_MXCSR);
    return of_host;
}

static inline void leave_default_environment(environment of_host)
{
    _mm_setcsr(of_host);
}
#elif defined __wasm__ || (defined _WIN32 && (defined __aarch64__ || defined _M_ARM64))
/* There is no other environment. */
typedef int environment;

static inline environment enter_default_environment(void)
{
    return 0;
}

static inline void leave_default_environment(environment of_host)
{
    (void)of_host;
}
#else
#include <fenv.h>
typedef fenv_t environment;

static inline environment enter_default_environment(void)
{
    environment of_host;
    fegetenv(&of_host);
    fesetenv(FE_DFL_ENV);
    return of_host;
}

static inline void leave_default_environment(environment of_host)
{
    fesetenv(&of_host);
}
#endif

/* Call the kernel in the default environment; the one of the host comes back with its flags as they were. */
static inline int64_t call_kernel(int64_t operation, double *p, double *d, double *u, double *x, double *y, double *w,
                                  double h)
{
    const environment of_host = enter_default_environment();
    const int64_t status = KERNEL(operation, p, d, u, x, y, w, h);
    leave_default_environment(of_host);
    return status;
}

#endif
