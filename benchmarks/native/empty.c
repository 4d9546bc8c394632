/* The least a native FMU 2.0 for co-simulation can be: what the shell of ours is measured against. */
#include <fmi2Functions.h>
#include <stdlib.h>

struct instance {
    double values[4];
};

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)name;
    (void)type;
    (void)guid;
    (void)resources;
    (void)callbacks;
    (void)visible;
    (void)logging;
    return calloc(1, sizeof(struct instance));
}

void fmi2FreeInstance(fmi2Component c)
{
    free(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_defined, fmi2Real stop)
{
    (void)c;
    (void)tolerance_defined;
    (void)tolerance;
    (void)start;
    (void)stop_defined;
    (void)stop;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference references[], size_t count, const fmi2Real values[])
{
    for (size_t n = 0; n < count; n++)
        ((struct instance *)c)->values[references[n] & 3] = values[n];
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference references[], size_t count,
                          const fmi2Integer values[])
{
    (void)c;
    (void)references;
    (void)count;
    (void)values;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2Real values[])
{
    for (size_t n = 0; n < count; n++)
        values[n] = ((struct instance *)c)->values[references[n] & 3];
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_state_prior)
{
    (void)no_state_prior;
    ((struct instance *)c)->values[3] = time + step;
    return fmi2OK;
}
