/* Life of an instance: instantiation, initialisation, termination, reset. */
#include "instance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const phase_names[PHASES] = {
    "instantiated", "in initialization mode", "initialized", "in error since initialization", "terminated"};

size_t block_size(void)
{
    return HEAD_SIZE + model.p_size + model.d_size + model.y_size + 2 * (model.u_size + model.x_size);
}

enum phase phase_of(const struct instance *c)
{
    return (enum phase)c->head[PHASE];
}

/* Whether the host manages the memory. */
static int is_hosted(const fmi2CallbackFunctions *callbacks)
{
    return callbacks->allocateMemory && callbacks->freeMemory;
}

void *allocate(const fmi2CallbackFunctions *callbacks, size_t size)
{
    return is_hosted(callbacks) ? callbacks->allocateMemory(1, size) : calloc(1, size);
}

void release(const fmi2CallbackFunctions *callbacks, void *memory)
{
    if (!memory)
        return;
    if (is_hosted(callbacks))
        callbacks->freeMemory(memory);
    else
        free(memory);
}

void set_start_values(struct instance *c)
{
    memset(c->block, 0, block_size() * sizeof(double));
    c->head[TOLERANCE] = NAN;
    c->warned = 0;
    for (size_t n = 0; n < model.variable_count; n++) {
        const struct variable *variable = &model.variables[n];
        if (variable->array != OUTPUTS)
            c->values[variable->array][variable->slot] = variable->start;
    }
}

/* Cut the instance's memory into its arrays. */
static void lay_out(struct instance *c, double *memory)
{
    double **const arrays[] = {&c->head, &c->p, &c->d, &c->u, &c->x, &c->y, &c->x_before, &c->u_before,
                               &c->w, &c->p_trial, &c->x_trial, &c->u_trial, &c->y_trial, &c->y_other};
    const size_t sizes[] = {HEAD_SIZE, model.p_size, model.d_size, model.u_size, model.x_size, model.y_size,
                            model.x_size, model.u_size, model.w_size, model.p_size, model.x_size,
                            model.u_size, model.y_size, model.y_size};
    c->block = memory;
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
        *arrays[n] = memory;
        memory += sizes[n];
    }
    c->values[PARAMETERS] = c->p;
    c->values[INPUTS] = c->u;
    c->values[OUTPUTS] = c->y;
}

/* Refuse an instantiation: there is no instance yet that could report it. */
static fmi2Component refuse(const fmi2CallbackFunctions *callbacks, const char *name, const char *message)
{
    if (callbacks && callbacks->logger)
        callbacks->logger(callbacks->componentEnvironment, name ? name : "", fmi2Error, "logStatusError", message);
    return NULL;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)resources;
    (void)visible;
    if (!callbacks)
        return NULL;
    if (!name || !*name)
        return refuse(callbacks, name, "the instance name must not be empty, is empty");
    if (type != fmi2CoSimulation)
        return refuse(callbacks, name, "the type of the instance must be fmi2CoSimulation, is another");
    if (!guid || strcmp(guid, model.guid) != 0)
        return refuse(callbacks, name, "the GUID must be that of modelDescription.xml, is of another build");
    const size_t trials = model.w_size + model.p_size + model.x_size + model.u_size + 2 * model.y_size;
    const size_t doubles = (block_size() + trials) * sizeof(double);
    const size_t letters = strlen(name) + 1;
    struct instance *c = allocate(callbacks, sizeof *c);
    double *memory = allocate(callbacks, doubles + letters);
    if (!c || !memory) {
        release(callbacks, memory);
        release(callbacks, c);
        return refuse(callbacks, name, "there is not enough memory for an instance");
    }
    memset(c, 0, sizeof *c);
    memset(memory, 0, doubles);
    c->callbacks = *callbacks;
    lay_out(c, memory);
    c->name = memcpy((char *)memory + doubles, name, letters);
    for (int n = 0; n < CATEGORIES; n++)
        c->logged[n] = logging && n != LOG_STEPS && n != LOG_ALL;
    set_start_values(c);
    return c;
}

void fmi2FreeInstance(fmi2Component component)
{
    struct instance *c = component;
    if (!c)
        return;
    const fmi2CallbackFunctions callbacks = c->callbacks;
    free_states(c);
    release(&callbacks, c->block);
    release(&callbacks, c);
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                               fmi2Real start_time, fmi2Boolean stop_time_defined, fmi2Real stop_time)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (phase_of(c) != INSTANTIATED)
        return out_of_order(c, "setupExperiment", "before enterInitializationMode");
    if (!isfinite(start_time))
        return report(c, fmi2Error, "start time must be a finite number of seconds, is %s", SHOWN(start_time));
    if (stop_time_defined && !(stop_time >= start_time))
        return report(c, fmi2Error, "stop time must be at least the start time %s s, is %s", SHOWN(start_time),
                      SHOWN(stop_time));
    if (tolerance_defined && !(tolerance > 0.0 && isfinite(tolerance)))
        return report(c, fmi2Error, "tolerance must be a positive number, is %s", SHOWN(tolerance));
    c->head[TOLERANCE] = tolerance_defined ? tolerance : NAN;
    c->head[TIME] = start_time;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (phase_of(c) != INSTANTIATED)
        return out_of_order(c, "enterInitializationMode", "right after instantiation or reset");
    if (model.tolerance_slot >= 0 && !isnan(c->head[TOLERANCE]))
        c->p[model.tolerance_slot] = c->head[TOLERANCE];
    c->head[PHASE] = INITIALIZING;
    return fmi2OK;
}

int is_allowed(const struct variable *variable, double value)
{
    if (variable->kind != REAL && value != floor(value))
        return 0;
    return value >= variable->minimum && value <= variable->maximum;
}

fmi2Status prepare(struct instance *c, fmi2Status refused)
{
    fmi2Status status = fmi2OK;
    if (c->head[PREPARED])
        return fmi2OK;
    for (size_t n = 0; n < model.variable_count; n++) {
        const struct variable *variable = &model.variables[n];
        if (variable->array != PARAMETERS || is_allowed(variable, c->p[variable->slot]))
            continue;
        status = report(c, refused, "%s must be %s, is %s", variable->name, variable->allowed,
                        SHOWN(c->p[variable->slot]));
    }
    if (status != fmi2OK)
        return status;
    const int64_t answer = KERNEL(OPERATION_START, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    if (answer != STATUS_OK)
        return explain(c, refused, answer, c->u, 0.0);
    c->head[PREPARED] = 1.0;
    c->head[COMPLETE] = 1.0;
    return fmi2OK;
}

void complete(struct instance *c)
{
    if (c->head[COMPLETE] || !c->head[PREPARED])
        return;
    KERNEL(OPERATION_OUTPUTS, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    c->head[COMPLETE] = 1.0;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (phase_of(c) != INITIALIZING)
        return out_of_order(c, "exitInitializationMode", "after enterInitializationMode");
    const fmi2Status status = prepare(c, fmi2Error);
    c->head[PHASE] = status == fmi2OK ? STEPPING : REFUSED;
    if (status == fmi2OK)
        warn(c);
    return status;
}

fmi2Status fmi2Terminate(fmi2Component component)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (phase_of(c) != STEPPING)
        return out_of_order(c, "terminate", "after exitInitializationMode");
    c->head[PHASE] = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component component)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    set_start_values(c);
    return fmi2OK;
}
