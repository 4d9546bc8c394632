/* Values by their references: a call reads or sets either all values or none. */
#include "instance.h"

#include <math.h>
#include <string.h>

/* Return the variable of a reference, or NULL after a report. */
static const struct variable *find(struct instance *c, uint32_t reference, const struct type *type)
{
    const enum kind kind = reference < model.variable_count ? model.variables[reference].kind : UNUSED;
    if (kind != UNUSED && type->kinds >> kind & 1)
        return &model.variables[reference];
    report(c, ERROR, "a value reference must belong to a variable of type %s in modelDescription.xml (got %u)",
           type->name, (unsigned)reference);
    return NULL;
}

/* Check that the values of a call can be read, and compute late outputs. */
static enum status check_read(struct instance *c, const uint32_t references[], size_t count,
                             const void *values, const struct type *type)
{
    int calculated = 0, late = 0;
    if (count > 0 && (!references || !values))
        return report_missing_array(c, "reading values");
    for (size_t n = 0; n < count; n++) {
        const struct variable *variable = find(c, references[n], type);
        if (!variable)
            return ERROR;
        calculated |= variable->array == OUTPUTS;
        late |= variable->late;
    }
    if (calculated && phase_of(c) == INITIALIZING) {
        const enum status status = start_kernel(c, DISCARD);
        if (status != OK)
            return status;
    } else if (calculated && phase_of(c) == INSTANTIATED) {
        return report_wrong_phase(c, "reading a calculated variable", "after enterInitializationMode");
    }
    if (late)
        compute_late_outputs(c);
    return OK;
}

static double value_of(const struct instance *c, uint32_t reference)
{
    const struct variable *variable = &model.variables[reference];
    const enum phase phase = phase_of(c);
    const int is_stored = phase == STEPPING || phase == UPDATING || phase == TERMINATED;
    if (variable->discrete_slot >= 0 && c->holds_discrete && is_stored)
        return c->held[variable->discrete_slot];
    return c->values[variable->array][variable->slot];
}

double read_real(const void *values, size_t n)
{
    return ((const double *)values)[n];
}

double read_integer(const void *values, size_t n)
{
    return ((const int32_t *)values)[n];
}

void write_real(void *values, size_t n, double value)
{
    ((double *)values)[n] = value;
}

/* Values beyond the type are limited, because a parameter may not have been checked yet. */
void write_integer(void *values, size_t n, double value)
{
    ((int32_t *)values)[n] = !is_number(value) ? 0 : (int32_t)fmin(fmax(value, INT32_MIN), INT32_MAX);
}

enum status get_values(struct instance *c, const uint32_t references[], size_t count, void *values,
                       const struct type *type)
{
    if (!c)
        return ERROR;
    const enum status status = check_read(c, references, count, values, type);
    for (size_t n = 0; status == OK && n < count; n++)
        type->write(values, n, value_of(c, references[n]));
    return status;
}

/* Check that a variable can be set to this value in the present phase. */
static enum status check_write(struct instance *c, const struct variable *variable, double value)
{
    const enum phase phase = phase_of(c);
    if (variable->array != INPUTS && variable->array != PARAMETERS)
        return report(c, ERROR, "a variable to set must be an input or a parameter (%s is calculated)",
                      variable->name);
    if (phase == INSTANTIATED || phase == INITIALIZING)
        return OK; /* values are checked at the end of initialization */
    if (variable->array == PARAMETERS && !variable->tunable)
        return report(c, ERROR, "setting %s is allowed only before the end of initialization (the instance is %s)",
                      variable->name, phase_names[phase]);
    if (phase == UPDATING)
        return report(c, ERROR, "setting %s is allowed only between steps (the instance is %s)", variable->name,
                      phase_names[phase]);
    if (!is_running(c))
        return report(c, ERROR, "setting %s is allowed only before terminate (the instance is %s)", variable->name,
                      phase_names[phase]);
    if (variable->array == PARAMETERS && !is_allowed(variable, value))
        return report(c, DISCARD, "%s must be %s (got %s)", variable->name, variable->allowed, TEXT_OF(value));
    return OK;
}

static void assign(struct instance *c, const struct variable *variable, double value)
{
    /* A tolerance of setupExperiment has priority over the parameter. */
    if (variable->array == PARAMETERS && variable->slot == model.tolerance_slot && phase_of(c) == INITIALIZING &&
        is_number(c->head[TOLERANCE]))
        return;
    c->values[variable->array][variable->slot] = value;
}

/* Update the kernel after a change of parameters between steps. If they are rejected, restore the previous values. */
static enum status update_parameters(struct instance *c)
{
    const int64_t kernel_status = call_kernel(OPERATION_UPDATE_PARAMETERS, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    if (kernel_status == STATUS_OK) {
        call_kernel(OPERATION_UPDATE_PARAMETERS, c->p, c->d, c->u, c->x_before, c->y, c->w, 0.0);
        return OK;
    }
    const enum status status = report_kernel_status(c, DISCARD, kernel_status, c->u, 0.0);
    memcpy(c->p, c->p_trial, model.p_size * sizeof(double));
    memcpy(c->u, c->u_trial, model.u_size * sizeof(double));
    call_kernel(OPERATION_CHECK, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    return status;
}

enum status set_values(struct instance *c, const uint32_t references[], size_t count, const void *values,
                       const struct type *type)
{
    int changes_parameters = 0;
    if (!c)
        return ERROR;
    if (count > 0 && (!references || !values))
        return report_missing_array(c, "setting values");
    for (size_t n = 0; n < count; n++) {
        const struct variable *variable = find(c, references[n], type);
        const double value = variable ? type->read(values, n) : 0.0;
        const enum status status = variable ? check_write(c, variable, value) : ERROR;
        if (status != OK)
            return status;
        changes_parameters |= variable->array == PARAMETERS && c->p[variable->slot] != value;
    }
    changes_parameters &= is_running(c);
    if (changes_parameters) {
        compute_late_outputs(c); /* the late outputs of the last step depend on its parameters */
        memcpy(c->p_trial, c->p, model.p_size * sizeof(double));
        memcpy(c->u_trial, c->u, model.u_size * sizeof(double));
    }
    for (size_t n = 0; n < count; n++)
        assign(c, &model.variables[references[n]], type->read(values, n));
    if (phase_of(c) == INITIALIZING)
        c->head[STARTED] = 0.0;
    return changes_parameters ? update_parameters(c) : OK;
}
