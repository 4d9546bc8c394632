/* The functions of FMI 2.0. */
#include "fmi2Functions.h"
#include "instance.h"

#include <stdlib.h>
#include <string.h>

struct component {
    struct instance core;
    fmi2CallbackFunctions callbacks;
};

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

/* Forward a message to the logger of the host, which interprets it as a printf format. */
static void forward_message(struct instance *c, enum status status, const char *category, const char *text)
{
    const fmi2CallbackFunctions *const callbacks = &((struct component *)c)->callbacks;
    char escaped[2 * MESSAGE_SIZE];
    size_t length = 0;
    for (; *text && length < sizeof escaped - 2; text++) {
        escaped[length++] = *text;
        if (*text == '%')
            escaped[length++] = '%';
    }
    escaped[length] = '\0';
    callbacks->logger(callbacks->componentEnvironment, c->name, (fmi2Status)status, category, escaped);
}

/* Report why an instantiation is rejected. There is no instance that could report it. */
static fmi2Component reject_instantiation(const fmi2CallbackFunctions *callbacks, const char *name, const char *message)
{
    if (callbacks && callbacks->logger)
        callbacks->logger(callbacks->componentEnvironment, name ? name : "", fmi2Error, "logStatusError", message);
    return NULL;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    struct host host = {forward_message, calloc, free};
    (void)resources;
    (void)visible;
    if (!callbacks)
        return NULL;
    if (!name || !*name)
        return reject_instantiation(callbacks, name, "the instance name must not be empty");
    if (type != fmi2CoSimulation)
        return reject_instantiation(callbacks, name, "the FMU type must be fmi2CoSimulation");
    if (!guid || strcmp(guid, model.guid) != 0)
        return reject_instantiation(callbacks, name, "the GUID must match modelDescription.xml: import the FMU again");
    if (!callbacks->logger)
        host.log = NULL;
    if (callbacks->allocateMemory && callbacks->freeMemory) {
        host.allocate = callbacks->allocateMemory;
        host.release = callbacks->freeMemory;
    }
    struct component *const c = (struct component *)create(&host, sizeof *c, name, logging);
    if (!c)
        return reject_instantiation(callbacks, name, "not enough memory for an instance");
    c->callbacks = *callbacks;
    return c;
}

void fmi2FreeInstance(fmi2Component c)
{
    destroy(c);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    return (fmi2Status)set_logging(c, on != 0, count, categories);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                               fmi2Real start_time, fmi2Boolean stop_time_defined, fmi2Real stop_time)
{
    return (fmi2Status)set_experiment(c, tolerance_defined, tolerance, start_time, stop_time_defined, stop_time);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return (fmi2Status)enter_initialization(c);
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return (fmi2Status)exit_initialization(c, STEPPING);
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    return (fmi2Status)terminate(c);
}

fmi2Status fmi2Reset(fmi2Component c)
{
    return (fmi2Status)reset(c);
}

static enum status do_step(struct instance *c, double time, double step)
{
    return take_step(c, OPERATION_STEP_ONLY, time, step);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_state_prior)
{
    (void)no_state_prior;
    return (fmi2Status)do_step(c, time, step);
}

/* An addition to FMI: many steps in one call. */
FMI2_Export fmi2Status inertiaModuleRun(fmi2Component c, struct run *run);

fmi2Status inertiaModuleRun(fmi2Component c, struct run *run)
{
    return (fmi2Status)take_steps(c, run, do_step);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    return (fmi2Status)save_state(c, state);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    return (fmi2Status)restore_state(c, state);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    return (fmi2Status)free_state(c, state);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    return (fmi2Status)serialized_size(c, state, size);
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    return (fmi2Status)serialize_state(c, state, bytes, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    return (fmi2Status)deserialize_state(c, bytes, size, state);
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                       const fmi2Integer orders[], const fmi2Real values[])
{
    return (fmi2Status)set_rates(c, references, count, orders, values);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                        const fmi2Integer orders[], fmi2Real values[])
{
    return (fmi2Status)get_rates(c, references, count, orders, values);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[], size_t unknown_count,
                                        const fmi2ValueReference knowns[], size_t known_count,
                                        const fmi2Real direction[], fmi2Real derivative[])
{
    return (fmi2Status)directional(c, unknowns, unknown_count, knowns, known_count, direction, derivative);
}
