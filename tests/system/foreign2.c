/* An FMU of FMI 2.0; stubs.c has the functions that are not here. */
#include "foreign.h"

void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *place, const void *calls, int v, int l)
{
    memset(&model, 0, sizeof model);
    return &model;
}
int fmi2SetupExperiment(void *c, int t, double tolerance, double start, int s, double stop)
{
    model.time = start;
    return 0;
}
int fmi2SetReal(void *c, const unsigned *references, size_t n, const double *values)
{
    for (size_t i = 0; i < n; i++)
        model.u = values[i];
    return 0;
}
int fmi2GetReal(void *c, const unsigned *references, size_t n, double *values)
{
    for (size_t i = 0; i < n; i++)
        values[i] = number(references[i]);
    return 0;
}
int fmi2GetInteger(void *c, const unsigned *references, size_t n, int *values)
{
    for (size_t i = 0; i < n; i++)
        values[i] = (int)number(references[i]);
    return 0;
}
int fmi2GetBoolean(void *c, const unsigned *references, size_t n, int *values)
{
    return fmi2GetInteger(c, references, n, values);
}
int fmi2GetString(void *c, const unsigned *references, size_t n, const char **values)
{
    for (size_t i = 0; i < n; i++)
        values[i] = text(references[i]);
    return 0;
}
int fmi2GetBooleanStatus(void *c, int kind, int *value)
{
    *value = model.count < 0; /* the behaviour has ended the simulation */
    return 0;
}
int fmi2DoStep(void *c, double time, double step, int b)
{
    int status = behaviour(time, step);
    if (status == 0) {
        model.time = time + step;
        model.count++;
    }
    return status;
}
