/* An FMU of FMI 3.0; stubs.c has the functions that are not here. */
#include "foreign.h"

void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *place, bool v, bool l, bool events,
    bool early, const unsigned *r, size_t n, void *e, void *m, void *i)
{
    memset(&model, 0, sizeof model);
    early_allowed = early;
    return &model;
}
void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *place, bool v, bool l, void *e, void *m)
{
    memset(&model, 0, sizeof model);
    return &model;
}
int fmi3SetTime(void *c, double time)
{
    model.time = time;
    return 0;
}
int fmi3EnterInitializationMode(void *c, bool t, double tolerance, double start, bool s, double stop)
{
    model.time = start;
    return 0;
}
int fmi3SetFloat64(void *c, const unsigned *references, size_t n, const double *values, size_t m)
{
    model.u = values[0];
    return 0;
}
int fmi3GetFloat64(void *c, const unsigned *references, size_t n, double *values, size_t m)
{
    size_t j = 0;
    for (size_t i = 0; i < n; i++) {
        if (references[i] == ARRAY) {
            for (int k = 1; k <= 3; k++)
                values[j++] = k * model.time;
        } else {
            values[j++] = number(references[i]);
        }
    }
    return j == m ? 0 : 3;
}
int fmi3GetInt32(void *c, const unsigned *references, size_t n, int32_t *values, size_t m)
{
    values[0] = model.count;
    return 0;
}
int fmi3GetBoolean(void *c, const unsigned *references, size_t n, bool *values, size_t m)
{
    values[0] = number(FLAG) != 0.0;
    return 0;
}
int fmi3GetString(void *c, const unsigned *references, size_t n, const char **values, size_t m)
{
    for (size_t i = 0; i < n; i++)
        values[i] = text(references[i]);
    return 0;
}
int fmi3SetString(void *c, const unsigned *references, size_t n, const char *const *values, size_t m)
{
    snprintf(model.text, sizeof model.text, "%s", values[0]);
    return 0;
}
int fmi3GetBinary(void *c, const unsigned *references, size_t n, size_t *sizes, const uint8_t **values, size_t m)
{
    sizes[0] = 3;
    values[0] = (const uint8_t *)"foo";
    return 0;
}
int fmi3DoStep(void *c, double time, double step, bool n, bool *event, bool *ends, bool *early, double *reached)
{
    is_early = false;
    int status = behaviour(time, step);
    *event = *early = is_early;
    *ends = model.count < 0;
    *reached = is_early ? early_time : time + step;
    if (status == 0 && model.count >= 0) {
        model.time = *reached;
        model.count++;
    }
    return status;
}
