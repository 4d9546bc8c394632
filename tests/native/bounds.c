/* Calls the kernel with each array in separate memory, to be run under a memory checker. */
#include "host.h"

#include <stdlib.h>

int64_t inertia_module_kernel(int64_t operation, double *p, double *d, double *u, double *x, double *y, double *w,
                              double h);

static double *doubles(size_t count)
{
    double *const made = calloc(count, sizeof *made);
    CHECK(made, "the test itself has run out of memory");
    return made;
}

static void run(const struct setting *changes, double speed)
{
    double *const p = doubles(model.p_size), *const d = doubles(model.d_size), *const u = doubles(model.u_size);
    double *const x = doubles(model.x_size), *const y = doubles(model.y_size), *const w = doubles(model.w_size);
    static const int operations[] = {OPERATION_STEP_ONLY, OPERATION_OUTPUTS, OPERATION_STEP_FOR_DIFFERENCING,
                                     OPERATION_OUTPUT_DERIVATIVES, OPERATION_UPDATE_PARAMETERS};
    for (size_t n = 0; n < model.variable_count; n++)
        if (model.variables[n].array == PARAMETERS)
            p[model.variables[n].slot] = model.variables[n].start;
    for (; changes->name; changes++)
        p[model.variables[reference_of(changes->name)].slot] = changes->value;
    u[0] = speed;
    u[1] = 5.0;
    CHECK(inertia_module_kernel(OPERATION_START, p, d, u, x, y, w, 0.0) == STATUS_OK, "start");
    for (int n = 0; n < 40; n++) {
        u[0] = speed + 10.0 * (n % 3); /* jumps */
        const int64_t status = inertia_module_kernel(operations[n % 5], p, d, u, x, y, w, 2e-3);
        CHECK(status == STATUS_OK, "operation %d answers %d", operations[n % 5], (int)status);
    }
    free(p);
    free(d);
    free(u);
    free(x);
    free(y);
    free(w);
}

int main(void)
{
    static const struct setting none[] = {{NULL, 0.0}};
    if (model.tolerance_slot < 0) {
        run(none, 50.0);
        return 0;
    }
    for (int fidelity = 0; fidelity <= 3; fidelity++)
        for (int layout = 0; layout <= 1; layout++) {
            const struct setting changes[] = {
                {"fidelity", fidelity}, {"layout", layout}, {"max_step", 1e-3}, {"satellites", 2.0}, {NULL, 0.0}};
            run(changes, 80.0);
        }
    return 0;
}
