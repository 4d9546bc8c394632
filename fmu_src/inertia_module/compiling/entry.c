/* The kernel on its own, for those who know its arrays. */
#include "kernel.h"

#include <stddef.h>

#if defined _WIN32
#define OFFERED __declspec(dllexport)
#else
#define OFFERED __attribute__((visibility("default")))
#endif

OFFERED int64_t inertia_module_kernel(int64_t operation, double *p, double *d, double *u, double *x, double *y,
                                      double *w, double h);

int64_t inertia_module_kernel(int64_t operation, double *p, double *d, double *u, double *x, double *y, double *w,
                              double h)
{
    return call_kernel(operation, p, d, u, x, y, w, h);
}

/* A run: many steps in one call (memory.Run in Python). */
struct kernel_run {
    double time; /* for others */
    size_t steps; /* to take, then those taken */
    const double *lengths;
    size_t input_count;
    double *const *inputs;
    const double *set; /* of inputs, a row for each step */
    size_t output_count;
    const double *const *outputs;
    double *read;      /* of outputs, a row before the first step and one after each */
    size_t row_size;   /* from one of these rows to the next */
    int64_t operation;
    double *records[6];
    double *rates;     /* of inputs: they hold for one step */
    size_t rate_count;
};

OFFERED int64_t inertia_module_kernel_run(struct kernel_run *run);

int64_t inertia_module_kernel_run(struct kernel_run *run)
{
    const size_t wanted = run->steps;
    double *const *const r = run->records;
    for (run->steps = 0;; run->steps++) {
        for (size_t n = 0; n < run->output_count; n++)
            run->read[run->steps * run->row_size + n] = *run->outputs[n];
        if (run->steps == wanted)
            return 0;
        for (size_t n = 0; n < run->input_count; n++)
            *run->inputs[n] = run->set[run->steps * run->input_count + n];
        const double length = run->lengths[run->steps];
        const int64_t status = call_kernel(run->operation, r[0], r[1], r[2], r[3], r[4], r[5], length);
        if (status != 0)
            return status;
        for (size_t n = 0; n < run->rate_count; n++)
            run->rates[n] = 0.0;
    }
}
