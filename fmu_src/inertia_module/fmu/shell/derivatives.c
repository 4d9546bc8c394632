/* Derivatives: rates of inputs and outputs, and outputs by inputs, by differences of steps tried out. */
#include "instance.h"

#include <math.h>
#include <string.h>

/* change of the inputs, over their size or their nominal value, that differences are taken of */
#define CHANGE 1e-4

/* Whether all references are Reals of inputs, or of outputs, and the order is 1. */
static fmi2Status check_references(struct instance *c, const fmi2ValueReference references[], size_t count,
                                   const fmi2Integer order[], int inputs)
{
    for (size_t n = 0; n < count; n++) {
        const struct variable *variable =
            references[n] < model.variable_count ? &model.variables[references[n]] : NULL;
        if (!variable || (inputs ? variable->array != INPUTS : !variable->output))
            return report(c, fmi2Error, "a value reference must be that of an %s, is %u", inputs ? "input" : "output",
                          (unsigned)references[n]);
        if (order && order[n] != 1)
            return report(c, fmi2Error, "the order of a derivative of %s must be 1, is %d", variable->name,
                          (int)order[n]);
    }
    return fmi2OK;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                       const fmi2Integer order[], const fmi2Real values[])
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (phase_of(c) == REFUSED || phase_of(c) == TERMINATED)
        return out_of_order(c, "setRealInputDerivatives", "before terminate");
    if (count > 0 && (!references || !order || !values))
        return without_array(c, "setRealInputDerivatives");
    const fmi2Status status = check_references(c, references, count, order, 1);
    for (size_t n = 0; status == fmi2OK && n < count; n++) {
        const struct variable *input = &model.variables[references[n]];
        c->u[input->rate_slot] = values[n];
        c->u[input->given_slot] = 1.0;
    }
    return status;
}

static void try_from(struct instance *c, const double *x, const double *u)
{
    memcpy(c->x_trial, x, model.x_size * sizeof(double));
    memcpy(c->u_trial, u, model.u_size * sizeof(double));
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                        const fmi2Integer order[], fmi2Real values[])
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (phase_of(c) != STEPPING && phase_of(c) != TERMINATED)
        return out_of_order(c, "getRealOutputDerivatives", "after exitInitializationMode");
    if (count > 0 && (!references || !order || !values))
        return without_array(c, "getRealOutputDerivatives");
    const fmi2Status status = check_references(c, references, count, order, 0);
    if (status != fmi2OK || count == 0)
        return status;
    try_from(c, c->x, c->u);
    memcpy(c->y_trial, c->y, model.y_size * sizeof(double));
    const int64_t answer = KERNEL(OPERATION_RATES, c->p, c->d, c->u_trial, c->x_trial, c->y_trial, c->w, 0.0);
    if (answer != STATUS_OK)
        return explain(c, fmi2Discard, answer, c->u_trial, 0.0);
    for (size_t n = 0; n < count; n++)
        values[n] = c->y_trial[model.variables[references[n]].slot];
    return fmi2OK;
}

/* The outputs, had the inputs been changed: of the last step or, before the first, of the start. */
static int64_t try_change(struct instance *c, const fmi2ValueReference knowns[], size_t count,
                          const fmi2Real direction[], double scale, double *y)
{
    const int stepped = c->head[LAST_STEP] > 0.0;
    try_from(c, stepped ? c->x_before : c->x, stepped ? c->u_before : c->u);
    for (size_t n = 0; n < count; n++)
        c->u_trial[model.variables[knowns[n]].slot] += scale * direction[n];
    return KERNEL(stepped ? OPERATION_STEP_PRECISELY : OPERATION_START, c->p, c->d, c->u_trial, c->x_trial, y, c->w,
                  c->head[LAST_STEP]);
}

/* How long the direction is, measured by the sizes of the inputs. */
static double length_of(const struct instance *c, const fmi2ValueReference knowns[], size_t count,
                        const fmi2Real direction[])
{
    const double *u = c->head[LAST_STEP] > 0.0 ? c->u_before : c->u;
    double length = 0.0;
    for (size_t n = 0; n < count; n++) {
        const struct variable *variable = &model.variables[knowns[n]];
        const double input = u[variable->slot]; /* refused later if it is not finite */
        const double size = isfinite(input) ? fmax(fabs(input), variable->nominal) : variable->nominal;
        length = fmax(length, fabs(direction[n]) / size);
    }
    return length;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference unknowns[],
                                        size_t unknown_count, const fmi2ValueReference knowns[], size_t known_count,
                                        const fmi2Real direction[], fmi2Real derivative[])
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if ((unknown_count > 0 && (!unknowns || !derivative)) || (known_count > 0 && (!knowns || !direction)))
        return without_array(c, "getDirectionalDerivative");
    if (check_references(c, unknowns, unknown_count, NULL, 0) != fmi2OK ||
        check_references(c, knowns, known_count, NULL, 1) != fmi2OK)
        return fmi2Error;
    for (size_t n = 0; n < known_count; n++)
        if (!isfinite(direction[n]))
            return report(c, fmi2Error, "a direction must be finite, is %s", SHOWN(direction[n]));
    if (phase_of(c) == INITIALIZING) {
        const fmi2Status status = prepare(c, fmi2Discard);
        if (status != fmi2OK)
            return status;
    } else if (phase_of(c) != STEPPING && phase_of(c) != TERMINATED) {
        return out_of_order(c, "getDirectionalDerivative", "after enterInitializationMode");
    }
    const double length = length_of(c, knowns, known_count, direction);
    for (size_t n = 0; n < unknown_count; n++)
        derivative[n] = 0.0;
    if (length == 0.0 || unknown_count == 0)
        return fmi2OK;
    /* central differences; one-sided where the change leads out of what is allowed */
    double forward = CHANGE / length, backward = -CHANGE / length;
    int64_t answer = try_change(c, knowns, known_count, direction, forward, c->y_trial);
    if (answer != STATUS_OK)
        answer = try_change(c, knowns, known_count, direction, forward = 0.0, c->y_trial);
    if (answer == STATUS_OK && try_change(c, knowns, known_count, direction, backward, c->y_other) != STATUS_OK)
        answer = try_change(c, knowns, known_count, direction, backward = 0.0, c->y_other);
    if (answer == STATUS_OK && forward == backward)
        return report(c, fmi2Discard, "inputs must be able to change one way, both ways they leave what is allowed");
    if (answer != STATUS_OK)
        return explain(c, fmi2Discard, answer, c->u_trial, c->head[LAST_STEP]);
    for (size_t n = 0; n < unknown_count; n++) {
        const int slot = model.variables[unknowns[n]].slot;
        derivative[n] = (c->y_trial[slot] - c->y_other[slot]) / (forward - backward);
    }
    return fmi2OK;
}
