/* The functions of FMI 3.0 for co-simulation: life of an instance, its states and derivatives. */
#include "fmi3.h"

#include <stdlib.h>
#include <string.h>

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

static void forward_message(struct instance *c, enum status status, const char *category, const char *text)
{
    const struct component *const component = (struct component *)c;
    component->log(component->environment, (fmi3Status)status, category, text);
}

fmi3Instance reject_instantiation(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, const char *message)
{
    if (log)
        log(environment, fmi3Error, "logStatusError", message);
    return NULL;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
                                         const fmi3ValueReference intermediate[], size_t intermediate_count,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update)
{
    const struct host host = {log ? forward_message : NULL, calloc, free};
    (void)resources;
    (void)visible;
    (void)intermediate; /* all variables can be read in an intermediate update */
    (void)intermediate_count;
    if (!name || !*name)
        return reject_instantiation(environment, log, "the instance name must not be empty");
    if (!token || strcmp(token, model.guid) != 0)
        return reject_instantiation(environment, log,
                      "the instantiation token must match modelDescription.xml: import the FMU again");
    struct component *const c = (struct component *)create(&host, sizeof *c, name, logging);
    if (!c)
        return reject_instantiation(environment, log, "not enough memory for an instance");
    c->core.holds_discrete = 1;
    c->environment = environment;
    c->log = log;
    c->update = update;
    c->event_mode = event_mode;
    c->early_return = early_return;
    return c;
}

void fmi3FreeInstance(fmi3Instance c)
{
    destroy(c);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[])
{
    return (fmi3Status)set_logging(c, on, count, categories);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                       fmi3Float64 start_time, fmi3Boolean stop_time_defined, fmi3Float64 stop_time)
{
    enum status status = OK;
    if (c && phase_of(c) == INSTANTIATED)
        status = set_experiment(c, tolerance_defined, tolerance, start_time, stop_time_defined, stop_time);
    return (fmi3Status)(status == OK ? enter_initialization(c) : status);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    const struct component *const c = instance;
    const enum status status = exit_initialization(instance, c && c->event_mode ? AT_EVENT : STEPPING);
    if (status == OK)
        store_discrete(instance);
    return (fmi3Status)status;
}

fmi3Status fmi3Terminate(fmi3Instance c)
{
    if (c && phase_of(c) == AT_EVENT)
        store_discrete(c);
    return (fmi3Status)terminate(c);
}

fmi3Status fmi3Reset(fmi3Instance c)
{
    return (fmi3Status)reset(c);
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state)
{
    return (fmi3Status)save_state(c, state);
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state)
{
    return (fmi3Status)restore_state(c, state);
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state)
{
    return (fmi3Status)free_state(c, state);
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    return (fmi3Status)serialized_size(c, state, size);
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    return (fmi3Status)serialize_state(c, state, bytes, size);
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    return (fmi3Status)deserialize_state(c, bytes, size, state);
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference references[], size_t count,
                                    const fmi3Int32 orders[], fmi3Float64 values[], size_t value_count)
{
    const fmi3Status status = check_count(c, count, value_count);
    return status == fmi3OK ? (fmi3Status)get_rates(c, references, count, orders, values) : status;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t unknown_count,
                                        const fmi3ValueReference knowns[], size_t known_count,
                                        const fmi3Float64 seed[], size_t seed_count, fmi3Float64 sensitivity[],
                                        size_t sensitivity_count)
{
    if (check_count(c, known_count, seed_count) != fmi3OK || check_count(c, unknown_count, sensitivity_count) != fmi3OK)
        return fmi3Error;
    return (fmi3Status)directional(c, unknowns, unknown_count, knowns, known_count, seed, sensitivity);
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t unknown_count,
                                    const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
                                    size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count)
{
    if (check_count(c, unknown_count, seed_count) != fmi3OK || check_count(c, known_count, sensitivity_count) != fmi3OK)
        return fmi3Error;
    return (fmi3Status)adjoint(c, unknowns, unknown_count, knowns, known_count, seed, sensitivity);
}
