/* Values by their references: all of a call are read or set, or none. */
#include "instance.h"

#include <math.h>
#include <string.h>

static const char *const kind_names[] = {"Real", "Integer", "Boolean"};

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference references[], size_t count,
                         const fmi2String values[])
{
    struct instance *c = component;
    (void)references;
    (void)values;
    if (!c)
        return fmi2Error;
    return count == 0 ? fmi2OK : report(c, fmi2Error, "a String cannot be set: there is none");
}

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference references[], size_t count,
                         fmi2String values[])
{
    struct instance *c = component;
    (void)references;
    (void)values;
    if (!c)
        return fmi2Error;
    return count == 0 ? fmi2OK : report(c, fmi2Error, "a String cannot be read: there is none");
}

/* The variable of a reference, or NULL with a report. */
static const struct variable *find(struct instance *c, fmi2ValueReference reference, enum kind kind)
{
    if (reference < model.variable_count && model.variables[reference].kind == kind)
        return &model.variables[reference];
    report(c, fmi2Error, "a value reference must be that of a variable of type %s in modelDescription.xml, is %u",
           kind_names[kind], (unsigned)reference);
    return NULL;
}

/* Make sure that the values a call asks for are there. */
static fmi2Status check_read(struct instance *c, const fmi2ValueReference references[], size_t count,
                             const void *values, enum kind kind)
{
    int calculated = 0, late = 0;
    if (count > 0 && (!references || !values))
        return without_array(c, "a call that reads values");
    for (size_t n = 0; n < count; n++) {
        const struct variable *variable = find(c, references[n], kind);
        if (!variable)
            return fmi2Error;
        calculated |= variable->array == OUTPUTS;
        late |= variable->late;
    }
    if (calculated && phase_of(c) == INITIALIZING) {
        const fmi2Status status = prepare(c, fmi2Discard);
        if (status != fmi2OK)
            return status;
    } else if (calculated && phase_of(c) == INSTANTIATED) {
        return out_of_order(c, "reading a calculated variable", "after enterInitializationMode");
    }
    if (late)
        complete(c);
    return fmi2OK;
}

static double value_of(const struct instance *c, fmi2ValueReference reference)
{
    const struct variable *variable = &model.variables[reference];
    return c->values[variable->array][variable->slot];
}

/* What an integer can hold of a parameter that has not been checked yet. */
static fmi2Integer as_integer(double value)
{
    if (isnan(value))
        return 0;
    return value > 2147483647.0 ? 2147483647 : value < -2147483648.0 ? -2147483647 - 1 : (fmi2Integer)value;
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       fmi2Real values[])
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    const fmi2Status status = check_read(c, references, count, values, REAL);
    for (size_t n = 0; status == fmi2OK && n < count; n++)
        values[n] = value_of(c, references[n]);
    return status;
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          fmi2Integer values[])
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    const fmi2Status status = check_read(c, references, count, values, INTEGER);
    for (size_t n = 0; status == fmi2OK && n < count; n++)
        values[n] = as_integer(value_of(c, references[n]));
    return status;
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          fmi2Boolean values[])
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    const fmi2Status status = check_read(c, references, count, values, BOOLEAN);
    for (size_t n = 0; status == fmi2OK && n < count; n++)
        values[n] = value_of(c, references[n]) != 0.0;
    return status;
}

/* A value of a call that sets values. */
static double number_in(const void *values, enum kind kind, size_t n)
{
    switch (kind) {
    case REAL:
        return ((const fmi2Real *)values)[n];
    case INTEGER:
        return ((const fmi2Integer *)values)[n];
    default:
        return ((const fmi2Boolean *)values)[n] ? 1.0 : 0.0;
    }
}

/* Make sure that a variable can be set to this value now. */
static fmi2Status check_write(struct instance *c, const struct variable *variable, double value)
{
    const enum phase phase = phase_of(c);
    if (variable->array == OUTPUTS)
        return report(c, fmi2Error, "a variable that is set must be an input or a parameter, %s is calculated",
                      variable->name);
    if (phase == INSTANTIATED || phase == INITIALIZING)
        return fmi2OK; /* values are checked at the end of initialization */
    if (variable->array == PARAMETERS && !variable->tunable)
        return report(c, fmi2Error, "setting %s must come before the end of initialization, the instance is %s",
                      variable->name, phase_names[phase]);
    if (phase != STEPPING)
        return report(c, fmi2Error, "setting %s must come before terminate, the instance is %s", variable->name,
                      phase_names[phase]);
    if (variable->array == PARAMETERS && !is_allowed(variable, value))
        return report(c, fmi2Discard, "%s must be %s, is %s", variable->name, variable->allowed, SHOWN(value));
    return fmi2OK;
}

static void assign(struct instance *c, const struct variable *variable, double value)
{
    /* a tolerance given to setupExperiment wins over the parameter */
    if (variable->array == PARAMETERS && variable->slot == model.tolerance_slot && phase_of(c) == INITIALIZING &&
        !isnan(c->head[TOLERANCE]))
        return;
    c->values[variable->array][variable->slot] = value;
}

/* Let the kernel follow parameters that have changed between steps, or put back what has been set. */
static fmi2Status tune(struct instance *c)
{
    const int64_t answer = KERNEL(OPERATION_TUNE, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    if (answer == STATUS_OK) {
        KERNEL(OPERATION_TUNE, c->p, c->d, c->u, c->x_before, c->y, c->w, 0.0);
        return fmi2OK;
    }
    const fmi2Status status = explain(c, fmi2Discard, answer, c->u, 0.0);
    memcpy(c->p, c->p_trial, model.p_size * sizeof(double));
    memcpy(c->u, c->u_trial, model.u_size * sizeof(double));
    KERNEL(OPERATION_CHECK, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    return status;
}

/* Set all the values of a call, or none. */
static fmi2Status set(struct instance *c, const fmi2ValueReference references[], size_t count, const void *values,
                      enum kind kind)
{
    int tuned = 0;
    if (!c)
        return fmi2Error;
    if (count > 0 && (!references || !values))
        return without_array(c, "a call that sets values");
    for (size_t n = 0; n < count; n++) {
        const struct variable *variable = find(c, references[n], kind);
        const double value = variable ? number_in(values, kind, n) : 0.0;
        const fmi2Status status = variable ? check_write(c, variable, value) : fmi2Error;
        if (status != fmi2OK)
            return status;
        tuned |= variable->array == PARAMETERS && c->p[variable->slot] != value;
    }
    tuned &= phase_of(c) == STEPPING;
    if (tuned) {
        complete(c); /* outputs hold the last step, with its parameters */
        memcpy(c->p_trial, c->p, model.p_size * sizeof(double));
        memcpy(c->u_trial, c->u, model.u_size * sizeof(double));
    }
    for (size_t n = 0; n < count; n++)
        assign(c, &model.variables[references[n]], number_in(values, kind, n));
    if (phase_of(c) == INITIALIZING)
        c->head[PREPARED] = 0.0;
    return tuned ? tune(c) : fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       const fmi2Real values[])
{
    return set(component, references, count, values, REAL);
}

fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          const fmi2Integer values[])
{
    return set(component, references, count, values, INTEGER);
}

fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          const fmi2Boolean values[])
{
    return set(component, references, count, values, BOOLEAN);
}
