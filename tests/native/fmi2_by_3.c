/* The functions of FMI 2.0, implemented with the functions of FMI 3.0, so that the same programs test both.
 *
 * The environment variable FMI3 selects the features of the host: event, early, update, or none.
 */
#include "fmi2Functions.h"
#include "fmi3Functions.h"
#include "host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct component {
    fmi3Instance c;
    fmi2CallbackFunctions callbacks;
    char name[64];
    int has_events;
    int has_tolerance, has_stop;
    double tolerance, start, stop;
};

/* The instance behind a component, or NULL. */
static fmi3Instance behind(fmi2Component component)
{
    return component ? ((struct component *)component)->c : NULL;
}

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                        fmi3String message)
{
    const struct component *const component = environment;
    component->callbacks.logger(component->callbacks.componentEnvironment, component->name, (fmi2Status)status,
                                category, "%s", message);
}

/* Calls that are allowed in an intermediate update, and calls that are rejected. */
static void look(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean set_requested,
                 fmi3Boolean get_allowed, fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early_return,
                 fmi3Float64 *early_return_time)
{
    const fmi3Instance c = ((struct component *)environment)->c;
    const fmi3ValueReference clock = reference_of("time"), input = 0;
    fmi3ValueReference output = 0;
    fmi3Float64 value = NAN, one = 1.0;
    fmi3Boolean flag;
    (void)finished;
    while (!model.variables[output].output)
        output++;
    CHECK(get_allowed && !set_requested && !can_return && !*early_return && *early_return_time == time, "offers");
    CHECK(fmi3GetFloat64(c, &clock, 1, &value, 1) == fmi3OK && value == time, "the time is %g at %g", value, time);
    CHECK(fmi3GetFloat64(c, &output, 1, &value, 1) == fmi3OK && isfinite(value), "the output is %g", value);
    CHECK(fmi3GetDirectionalDerivative(c, &output, 1, &input, 1, &one, 1, &value, 1) != fmi3Error, "a derivative");
    CHECK(fmi3SetFloat64(c, &input, 1, &value, 1) == fmi3Error, "an input is set");
    CHECK(fmi3DoStep(c, time, 1e-3, false, &flag, &flag, &flag, &value) == fmi3Error, "a step within a step");
    CHECK(fmi3Reset(c) == fmi3Error && fmi3Terminate(c) == fmi3Error && fmi3EnterEventMode(c) == fmi3Error, "an end");
}

const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

const char *fmi2GetVersion(void)
{
    return strcmp(fmi3GetVersion(), "3.0") == 0 ? "2.0" : "none";
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    const char *const asked = getenv("FMI3") ? getenv("FMI3") : "";
    const int update = strcmp(asked, "update") == 0;
    if (!callbacks)
        return NULL;
    struct component *const made = calloc(1, sizeof *made);
    CHECK(made, "the test itself has run out of memory");
    made->callbacks = *callbacks;
    strncpy(made->name, name ? name : "", sizeof made->name - 1);
    made->has_events = strcmp(asked, "event") == 0;
    const fmi3LogMessageCallback log = callbacks->logger ? log_message : NULL;
    if (type == fmi2CoSimulation)
        made->c = fmi3InstantiateCoSimulation(name, guid, resources, visible, logging, made->has_events,
                                              made->has_events || strcmp(asked, "early") == 0, NULL, 0, made, log,
                                              update ? look : NULL);
    else
        made->c = fmi3InstantiateModelExchange(name, guid, resources, visible, logging, made, log);
    if (made->c)
        return made;
    free(made);
    return NULL;
}

void fmi2FreeInstance(fmi2Component component)
{
    fmi3FreeInstance(behind(component));
    free(component);
}

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    return (fmi2Status)fmi3SetDebugLogging(behind(component), on, count, categories);
}

/* State before several calls that FMI 2.0 has as a single one. It is restored if one of them fails. It is not part of
 * the test, so its memory is not counted and never rejected.
 */
static fmi3FMUState before(fmi3Instance c)
{
    const unsigned refuse_one_in = memory.refuse_one_in;
    fmi3FMUState state = NULL;
    if (refuse_one_in)
        memory.refuse_one_in = 0;
    CHECK(!c || fmi3GetFMUState(c, &state) == fmi3OK, "saving a state");
    if (refuse_one_in)
        memory.refuse_one_in = refuse_one_in;
    return state;
}

static void go_back(fmi3Instance c, fmi3FMUState state, int undo)
{
    CHECK(!c || !undo || fmi3SetFMUState(c, state) == fmi3OK, "restoring a state");
    CHECK(!c || fmi3FreeFMUState(c, &state) == fmi3OK, "freeing a state");
    if (c && memory.calls) /* threads do not count */
        memory.calls -= 2;
}

/* In FMI 3.0 the experiment belongs to the beginning of initialization. It is tried here and stored until then. */
fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop)
{
    struct component *const made = component;
    const fmi3FMUState state = before(behind(made));
    const fmi3Status status =
        fmi3EnterInitializationMode(behind(made), has_tolerance, tolerance, start, has_stop, stop);
    go_back(behind(made), state, 1);
    if (status != fmi3OK)
        return (fmi2Status)status;
    made->has_tolerance = has_tolerance;
    made->tolerance = tolerance;
    made->start = start;
    made->has_stop = has_stop;
    made->stop = stop;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component)
{
    const struct component *const made = component;
    if (!made)
        return (fmi2Status)fmi3EnterInitializationMode(NULL, false, 0.0, 0.0, false, 0.0);
    return (fmi2Status)fmi3EnterInitializationMode(made->c, made->has_tolerance, made->tolerance, made->start,
                                                   made->has_stop, made->stop);
}

/* Make all calls of event mode, up to its end. */
static fmi3Status pass_event(fmi3Instance c)
{
    fmi3Boolean flags[5];
    fmi3Float64 next;
    CHECK(fmi3UpdateDiscreteStates(c, &flags[0], &flags[1], &flags[2], &flags[3], &flags[4], &next) == fmi3OK, "event");
    CHECK(!flags[0] && !flags[1] && !flags[4], "an event wants more");
    CHECK(fmi3EnterEventMode(c) == fmi3Error, "event mode in event mode");
    return fmi3EnterStepMode(c);
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component)
{
    const fmi3Status status = fmi3ExitInitializationMode(behind(component));
    if (status == fmi3OK && ((struct component *)component)->has_events)
        return (fmi2Status)pass_event(behind(component));
    return (fmi2Status)status;
}

fmi2Status fmi2Terminate(fmi2Component component)
{
    return (fmi2Status)fmi3Terminate(behind(component));
}

fmi2Status fmi2Reset(fmi2Component component)
{
    struct component *const made = component;
    if (made) {
        made->has_tolerance = made->has_stop = 0;
        made->start = 0.0;
    }
    return (fmi2Status)fmi3Reset(behind(component));
}

/* Make a step, event by event if the instance returns early. */
static fmi3Status go_through(const struct component *made, double time, double step)
{
    fmi3Boolean event = true, ends = true, early = true;
    double reached = NAN, end = time + step;
    fmi3Status status = fmi3DoStep(made->c, time, step, false, &event, &ends, &early, &reached);
    while (status == fmi3OK) {
        CHECK(!ends && reached >= time && (early || (reached == end)), "the step to %g ends at %g", end, reached);
        CHECK(!event || made->has_events, "an event that was not asked for");
        if (event && (fmi3EnterEventMode(made->c) != fmi3OK || pass_event(made->c) != fmi3OK))
            return fmi3Error;
        if (!early || reached >= end)
            return fmi3OK;
        time = reached;
        status = fmi3DoStep(made->c, time, end - time, false, &event, &ends, &early, &reached);
        end = early ? end : reached;
    }
    return status;
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real step, fmi2Boolean no_state_prior)
{
    (void)no_state_prior;
    if (!component)
        return (fmi2Status)fmi3DoStep(NULL, time, step, false, NULL, NULL, NULL, NULL);
    const fmi3Instance c = behind(component);
    const fmi3FMUState state = before(c);
    const fmi3Status status = go_through(component, time, step);
    go_back(c, state, status > fmi3Warning);
    return (fmi2Status)status;
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2Real values[])
{
    return (fmi2Status)fmi3GetFloat64(behind(component), references, count, values, count);
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       const fmi2Real values[])
{
    return (fmi2Status)fmi3SetFloat64(behind(component), references, count, values, count);
}

static int is_enumeration(fmi2ValueReference reference)
{
    return reference < model.variable_count && model.variables[reference].kind == ENUMERATION;
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          fmi2Integer values[])
{
    fmi3Status status = fmi3OK;
    if (!references || !values || count == 0)
        return (fmi2Status)fmi3GetInt32(behind(component), references, count, values, count);
    for (size_t n = 0; status == fmi3OK && n < count; n++) {
        fmi3Int64 value = 0;
        if (!is_enumeration(references[n])) {
            status = fmi3GetInt32(behind(component), &references[n], 1, &values[n], 1);
            continue;
        }
        status = fmi3GetInt64(behind(component), &references[n], 1, &value, 1);
        values[n] = (fmi2Integer)value;
    }
    return (fmi2Status)status;
}

static fmi3Status set_wholes(fmi3Instance c, const fmi2ValueReference references[], size_t count,
                             const fmi2Integer values[])
{
    fmi3Status status = fmi3OK;
    for (size_t n = 0; status == fmi3OK && n < count; n++) {
        const fmi3Int64 value = values[n];
        status = is_enumeration(references[n]) ? fmi3SetInt64(c, &references[n], 1, &value, 1)
                                               : fmi3SetInt32(c, &references[n], 1, &values[n], 1);
    }
    return status;
}

fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          const fmi2Integer values[])
{
    if (!references || !values || count == 0)
        return (fmi2Status)fmi3SetInt32(behind(component), references, count, values, count);
    const fmi3Instance c = behind(component);
    const fmi3FMUState state = before(c);
    const fmi3Status status = set_wholes(c, references, count, values);
    go_back(c, state, status > fmi3Warning);
    return (fmi2Status)status;
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          fmi2Boolean values[])
{
    fmi3Boolean flags[MOST_VARIABLES];
    CHECK(count <= MOST_VARIABLES, "%zu values", count);
    const fmi3Status status = fmi3GetBoolean(behind(component), references, count, values ? flags : NULL, count);
    for (size_t n = 0; values && status == fmi3OK && n < count; n++)
        values[n] = flags[n];
    return (fmi2Status)status;
}

fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          const fmi2Boolean values[])
{
    fmi3Boolean flags[MOST_VARIABLES];
    CHECK(count <= MOST_VARIABLES, "%zu values", count);
    for (size_t n = 0; values && n < count; n++)
        flags[n] = values[n] != 0;
    return (fmi2Status)fmi3SetBoolean(behind(component), references, count, values ? flags : NULL, count);
}

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference references[], size_t count,
                         fmi2String values[])
{
    return (fmi2Status)fmi3GetString(behind(component), references, count, values, count);
}

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference references[], size_t count,
                         const fmi2String values[])
{
    return (fmi2Status)fmi3SetString(behind(component), references, count, values, count);
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    return (fmi2Status)fmi3GetFMUState(behind(component), state);
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state)
{
    return (fmi2Status)fmi3SetFMUState(behind(component), state);
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    return (fmi2Status)fmi3FreeFMUState(behind(component), state);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size)
{
    return (fmi2Status)fmi3SerializedFMUStateSize(behind(component), state, size);
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    return (fmi2Status)fmi3SerializeFMUState(behind(component), state, (fmi3Byte *)bytes, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    return (fmi2Status)fmi3DeserializeFMUState(behind(component), (const fmi3Byte *)bytes, size, state);
}

/* FMI 3.0 has no such call, so the tests that set rates omit them. */
fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                       const fmi2Integer orders[], const fmi2Real values[])
{
    (void)references;
    (void)count;
    (void)orders;
    (void)values;
    return component ? fmi2OK : fmi2Error;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                        const fmi2Integer orders[], fmi2Real values[])
{
    return (fmi2Status)fmi3GetOutputDerivatives(behind(component), references, count, orders, values, count);
}

/* Call the adjoint derivative, too: both must agree. */
fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference unknowns[],
                                        size_t unknown_count, const fmi2ValueReference knowns[], size_t known_count,
                                        const fmi2Real direction[], fmi2Real derivative[])
{
    fmi3Float64 seed[MOST_VARIABLES] = {0.0}, sensitivity[MOST_VARIABLES];
    const fmi3Instance c = behind(component);
    const fmi3Status status = fmi3GetDirectionalDerivative(c, unknowns, unknown_count, knowns, known_count, direction,
                                                           known_count, derivative, unknown_count);
    const fmi3Status other = fmi3GetAdjointDerivative(c, unknowns, unknown_count, knowns, known_count,
                                                      derivative ? seed : NULL, unknown_count, sensitivity, known_count);
    CHECK(status != fmi3OK || other != fmi3Error, "an adjoint derivative");
    return (fmi2Status)status;
}

/* FMI 3.0 has no such call, but other calls that are rejected in any phase. */
fmi2Status fmi2CancelStep(fmi2Component component)
{
    static unsigned turn;
    const fmi3Instance c = behind(component);
    const fmi3ValueReference reference = 0;
    fmi3Float32 real = 0.0F;
    fmi3Int8 whole = 0;
    fmi3Clock clock = false;
    fmi3Boolean flag = false;
    size_t count = 0;
    switch (turn++ % 12) {
    case 0:
        return (fmi2Status)fmi3GetFloat32(c, &reference, 1, &real, 1);
    case 1:
        return (fmi2Status)fmi3SetFloat32(c, &reference, 1, &real, 1);
    case 2:
        return (fmi2Status)fmi3SetInt8(c, &reference, 1, &whole, 1);
    case 3:
        return (fmi2Status)fmi3GetBinary(c, &reference, 1, &count, NULL, 1);
    case 4:
        return (fmi2Status)fmi3GetClock(c, &reference, 1, &clock);
    case 5:
        return (fmi2Status)fmi3EnterConfigurationMode(c);
    case 6:
        return (fmi2Status)fmi3GetNumberOfContinuousStates(c, &count);
    case 7:
        return (fmi2Status)fmi3CompletedIntegratorStep(c, false, &flag, NULL);
    case 8:
        return (fmi2Status)fmi3GetVariableDependencies(c, 0, NULL, NULL, NULL, NULL, 0);
    case 9:
        return (fmi2Status)fmi3ActivateModelPartition(c, 0, NAN);
    case 10:
        return (fmi2Status)fmi3GetFloat64(c, &reference, 1, NULL, 2);
    default:
        return (fmi2Status)fmi3DoStep(c, 0.0, 1e-3, false, NULL, &flag, &flag, NULL);
    }
}

static fmi2Status none(fmi2Component component)
{
    return component ? fmi2Discard : fmi2Error;
}

fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind;
    (void)value;
    return none(component);
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind;
    (void)value;
    return none(component);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)kind;
    (void)value;
    return none(component);
}

fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind;
    (void)value;
    return none(component);
}

/* The present time is a variable. */
fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value)
{
    const fmi3ValueReference clock = reference_of("time");
    if (kind != fmi2LastSuccessfulTime || !value)
        return none(component);
    return (fmi2Status)fmi3GetFloat64(behind(component), &clock, 1, value, 1);
}
