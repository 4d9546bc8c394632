/* Values by the types of FMI 2.0, and the status of the last step. */
#include "fmi2Functions.h"
#include "instance.h"

static double read_boolean(const void *values, size_t n)
{
    return ((const fmi2Boolean *)values)[n] != 0;
}

static void write_boolean(void *values, size_t n, double value)
{
    ((fmi2Boolean *)values)[n] = value != 0.0;
}

static const struct type reals = {"Real", 1 << REAL, read_real, write_real};
static const struct type integers = {"Integer", 1 << INTEGER | 1 << ENUMERATION, read_integer, write_integer};
static const struct type booleans = {"Boolean", 1 << BOOLEAN, read_boolean, write_boolean};

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2Real values[])
{
    return (fmi2Status)get_values(c, references, count, values, &reals);
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference references[], size_t count,
                          fmi2Integer values[])
{
    return (fmi2Status)get_values(c, references, count, values, &integers);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference references[], size_t count,
                          fmi2Boolean values[])
{
    return (fmi2Status)get_values(c, references, count, values, &booleans);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference references[], size_t count,
                       const fmi2Real values[])
{
    return (fmi2Status)set_values(c, references, count, values, &reals);
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference references[], size_t count,
                          const fmi2Integer values[])
{
    return (fmi2Status)set_values(c, references, count, values, &integers);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference references[], size_t count,
                          const fmi2Boolean values[])
{
    return (fmi2Status)set_values(c, references, count, values, &booleans);
}

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference references[], size_t count,
                         const fmi2String values[])
{
    struct instance *c = component;
    (void)references;
    (void)values;
    if (!c)
        return fmi2Error;
    return count == 0 ? fmi2OK : (fmi2Status)report(c, ERROR, "cannot set a String: the model has no String variables");
}

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference references[], size_t count,
                         fmi2String values[])
{
    struct instance *c = component;
    (void)references;
    (void)values;
    if (!c)
        return fmi2Error;
    return count == 0 ? fmi2OK : (fmi2Status)report(c, ERROR, "cannot read a String: the model has no String variables");
}

fmi2Status fmi2CancelStep(fmi2Component component)
{
    struct instance *c = component;
    return c ? (fmi2Status)report(c, ERROR, "cancelStep requires a pending step, but doStep always completes") : fmi2Error;
}

static fmi2Status not_pending(struct instance *c, const char *call)
{
    return c ? (fmi2Status)report(c, DISCARD, "%s requires a pending step, but doStep always completes", call) : fmi2Error;
}

fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind;
    (void)value;
    return not_pending(component, "getStatus");
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind;
    (void)value;
    return not_pending(component, "getIntegerStatus");
}

fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind;
    (void)value;
    return not_pending(component, "getStringStatus");
}

fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (kind != fmi2LastSuccessfulTime || !value)
        return (fmi2Status)report(c, DISCARD, "the kind of getRealStatus must be fmi2LastSuccessfulTime");
    *value = c->head[TIME];
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (kind != fmi2Terminated || !value)
        return (fmi2Status)report(c, DISCARD, "the kind of getBooleanStatus must be fmi2Terminated");
    *value = fmi2False; /* a rejected step does not end the simulation */
    return fmi2OK;
}
