/* Time derivatives of inputs and outputs. Partial derivatives of outputs by differences of trial steps. */
#include "instance.h"

#include <math.h>
#include <string.h>

/* Change of inputs and parameters for differences, relative to their magnitude or nominal value. */
#define RELATIVE_CHANGE 1e-4

/* Range of the magnitudes of a direction, except 0. No result then overflows. */
#define MIN_NUMBER 1e-100
#define MAX_NUMBER 1e100

/* Status next to the statuses of the kernel: a changed parameter is out of its range. */
#define OUT_OF_RANGE (-1)

/* Required role of a reference. KNOWN: a variable that outputs depend on between steps. AT_START: a variable that
   outputs depend on in initialization mode. */
enum role { OUTPUT, INPUT, KNOWN, AT_START };

static int has_role(const struct variable *variable, enum role role)
{
    if (role == OUTPUT || variable->array != PARAMETERS)
        return role == OUTPUT ? variable->output : variable->array == INPUTS;
    return variable->kind == REAL && (role == AT_START || (role == KNOWN && variable->tunable));
}

/* Check that all references have a role, and that the orders are 1. */
static enum status check_references(struct instance *c, const uint32_t references[], size_t count,
                                   const int32_t orders[], enum role role)
{
    static const char *const names[] = {"output", "input", "input or a tunable parameter",
                                        "input or a Real parameter"};
    for (size_t n = 0; n < count; n++) {
        const struct variable *variable =
            references[n] < model.variable_count ? &model.variables[references[n]] : NULL;
        if (!variable || !has_role(variable, role))
            return report(c, ERROR, "a value reference must belong to an %s (got %u)", names[role],
                          (unsigned)references[n]);
        if (orders && orders[n] != 1)
            return report(c, ERROR, "the order of a derivative of %s must be 1 (got %d)", variable->name,
                          (int)orders[n]);
    }
    return OK;
}

enum status set_rates(struct instance *c, const uint32_t references[], size_t count, const int32_t orders[],
                      const double values[])
{
    if (!c)
        return ERROR;
    if (phase_of(c) == FAILED || phase_of(c) == TERMINATED)
        return report_wrong_phase(c, "setting derivatives of inputs", "before terminate");
    if (count > 0 && (!references || !orders || !values))
        return report_missing_array(c, "setting derivatives of inputs");
    const enum status status = check_references(c, references, count, orders, INPUT);
    for (size_t n = 0; status == OK && n < count; n++) {
        const struct variable *input = &model.variables[references[n]];
        c->u[input->rate_slot] = values[n];
        c->u[input->has_rate_slot] = 1.0;
    }
    return status;
}

static void copy_to_trial(struct instance *c, const double *x, const double *u)
{
    memcpy(c->x_trial, x, model.x_size * sizeof(double));
    memcpy(c->u_trial, u, model.u_size * sizeof(double));
}

enum status get_rates(struct instance *c, const uint32_t references[], size_t count, const int32_t orders[],
                      double values[])
{
    if (!c)
        return ERROR;
    if (!is_differentiable(c))
        return report_wrong_phase(c, "reading derivatives of outputs", "after exitInitializationMode");
    if (count > 0 && (!references || !orders || !values))
        return report_missing_array(c, "reading derivatives of outputs");
    const enum status status = check_references(c, references, count, orders, OUTPUT);
    if (status != OK || count == 0)
        return status;
    copy_to_trial(c, c->x, c->u);
    memcpy(c->y_trial, c->y, model.y_size * sizeof(double));
    const int64_t kernel_status =
        call_kernel(OPERATION_OUTPUT_DERIVATIVES, c->p, c->d, c->u_trial, c->x_trial, c->y_trial, c->w, 0.0);
    if (kernel_status != STATUS_OK)
        return report_kernel_status(c, DISCARD, kernel_status, c->u_trial, 0.0);
    for (size_t n = 0; n < count; n++)
        values[n] = c->y_trial[model.variables[references[n]].slot];
    return OK;
}

/* Compute the outputs with changed knowns: of the last step again or, before the first step, of the start. The
   constants d then belong to the changed parameters. */
static int64_t compute_trial(struct instance *c, const uint32_t knowns[], size_t count,
                          const double direction[], double scale, double *y)
{
    const int stepped = c->head[LAST_STEP] > 0.0;
    int changes_parameters = 0;
    copy_to_trial(c, stepped ? c->x_before : c->x, stepped ? c->u_before : c->u);
    memcpy(c->p_trial, c->p, model.p_size * sizeof(double));
    for (size_t n = 0; n < count; n++) {
        const struct variable *known = &model.variables[knowns[n]];
        (known->array == INPUTS ? c->u_trial : c->p_trial)[known->slot] += scale * direction[n];
        changes_parameters |= stepped && known->array == PARAMETERS;
    }
    for (size_t n = 0; n < count; n++) {
        const struct variable *known = &model.variables[knowns[n]];
        if (known->array == PARAMETERS && !is_allowed(known, c->p_trial[known->slot]))
            return OUT_OF_RANGE;
    }
    if (changes_parameters) {
        const int64_t kernel_status =
            call_kernel(OPERATION_UPDATE_PARAMETERS, c->p_trial, c->d, c->u_trial, c->x_trial, y, c->w, 0.0);
        if (kernel_status != STATUS_OK)
            return kernel_status;
    }
    const enum operation operation = stepped ? OPERATION_STEP_FOR_DIFFERENCING : OPERATION_START;
    return call_kernel(operation, c->p_trial, c->d, c->u_trial, c->x_trial, y, c->w, c->head[LAST_STEP]);
}

/* Return the length of the direction: the maximum of its numbers relative to the magnitudes of the knowns. */
static double length_of(const struct instance *c, const uint32_t knowns[], size_t count,
                        const double direction[])
{
    const double *u = c->head[LAST_STEP] > 0.0 ? c->u_before : c->u;
    double length = 0.0;
    for (size_t n = 0; n < count; n++) {
        const struct variable *variable = &model.variables[knowns[n]];
        /* The kernel later rejects a value that is not finite. */
        const double value = (variable->array == INPUTS ? u : c->p)[variable->slot];
        const double size = is_finite(value) ? fmax(fabs(value), variable->nominal) : variable->nominal;
        length = fmax(length, fabs(direction[n]) / size);
    }
    return length;
}

/* Check the references, arrays and phase of a call for partial derivatives. */
static enum status check_call(struct instance *c, const uint32_t unknowns[], size_t unknown_count,
                              const double of_unknowns[], const uint32_t knowns[], size_t known_count,
                              const double of_knowns[])
{
    if ((unknown_count > 0 && (!unknowns || !of_unknowns)) || (known_count > 0 && (!knowns || !of_knowns)))
        return report_missing_array(c, "computing derivatives");
    const int at_start = phase_of(c) == INITIALIZING;
    if (check_references(c, unknowns, unknown_count, NULL, OUTPUT) != OK ||
        check_references(c, knowns, known_count, NULL, at_start ? AT_START : KNOWN) != OK)
        return ERROR;
    if (at_start)
        return start_kernel(c, DISCARD);
    if (!is_differentiable(c))
        return report_wrong_phase(c, "computing derivatives", "after enterInitializationMode");
    return OK;
}

static enum status check_numbers(struct instance *c, const double numbers[], size_t count)
{
    for (size_t n = 0; n < count; n++) {
        const double number = numbers[n];
        if (!is_finite(number) || fabs(number) > MAX_NUMBER || (number != 0.0 && fabs(number) < MIN_NUMBER))
            return report(c, ERROR, "a number of a direction must be 0 or between 1e-100 and 1e100 in magnitude (got %s)",
                          TEXT_OF(number));
    }
    return OK;
}

/* Compute the outputs with the knowns changed in both directions into y_trial and y_other. ``change`` is the distance
   between both, or 0 if the direction is 0. */
static enum status compute_both_sides(struct instance *c, const uint32_t knowns[], size_t count,
                                 const double direction[], double *change)
{
    const double length = length_of(c, knowns, count, direction);
    *change = 0.0;
    if (length == 0.0)
        return OK;
    /* Central differences; one-sided differences if a change leaves the allowed range. */
    double forward = RELATIVE_CHANGE / length, backward = -RELATIVE_CHANGE / length;
    int64_t kernel_status = compute_trial(c, knowns, count, direction, forward, c->y_trial);
    if (kernel_status != STATUS_OK)
        kernel_status = compute_trial(c, knowns, count, direction, forward = 0.0, c->y_trial);
    if (kernel_status == STATUS_OK && compute_trial(c, knowns, count, direction, backward, c->y_other) != STATUS_OK)
        kernel_status = compute_trial(c, knowns, count, direction, backward = 0.0, c->y_other);
    size_t inputs = 0;
    while (inputs < count && model.variables[knowns[inputs]].array == INPUTS)
        inputs++;
    if (inputs < count) /* a parameter has changed: restore the constants */
        call_kernel(OPERATION_UPDATE_PARAMETERS, c->p, c->d, c->u_trial, c->x_trial, c->y_trial, c->w, 0.0);
    if (kernel_status == STATUS_OK && forward == backward)
        return report(c, DISCARD, "the perturbed inputs and parameters must be valid for at least one sign of the"
                      " direction");
    if (kernel_status != STATUS_OK)
        return report_kernel_status(c, DISCARD, kernel_status, c->u_trial, c->head[LAST_STEP]);
    *change = forward - backward;
    return OK;
}

static double slope_of(const struct instance *c, uint32_t unknown, double change)
{
    const int slot = model.variables[unknown].slot;
    return change == 0.0 ? 0.0 : (c->y_trial[slot] - c->y_other[slot]) / change;
}

enum status directional(struct instance *c, const uint32_t unknowns[], size_t unknown_count,
                        const uint32_t knowns[], size_t known_count, const double direction[],
                        double derivative[])
{
    double change;
    if (!c)
        return ERROR;
    enum status status = check_call(c, unknowns, unknown_count, derivative, knowns, known_count, direction);
    if (status == OK)
        status = check_numbers(c, direction, known_count);
    if (status == OK && unknown_count > 0)
        status = compute_both_sides(c, knowns, known_count, direction, &change);
    for (size_t n = 0; status == OK && n < unknown_count; n++)
        derivative[n] = slope_of(c, unknowns[n], change);
    return status;
}

enum status adjoint(struct instance *c, const uint32_t unknowns[], size_t unknown_count, const uint32_t knowns[],
                    size_t known_count, const double seed[], double sensitivity[])
{
    static const double one = 1.0;
    double change;
    if (!c)
        return ERROR;
    enum status status = check_call(c, unknowns, unknown_count, seed, knowns, known_count, sensitivity);
    if (status == OK)
        status = check_numbers(c, seed, unknown_count);
    for (size_t n = 0; status == OK && n < known_count; n++) {
        status = compute_both_sides(c, &knowns[n], 1, &one, &change);
        sensitivity[n] = 0.0;
        for (size_t m = 0; status == OK && m < unknown_count; m++)
            sensitivity[n] += seed[m] * slope_of(c, unknowns[m], change);
    }
    return status;
}
