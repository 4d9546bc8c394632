/* Communication steps, and what the host may ask about them. */
#include "instance.h"

#include <math.h>
#include <string.h>

/* a communication point this far from the time reached, over the step and over the time, is worth a warning */
#define NEAR_STEP 1e-3
#define NEAR_TIME 1e-12

/* Tell once if the host's time is not the time reached: the motion itself knows no time. */
static void check_time(struct instance *c, double time, double step)
{
    if (c->warned || fabs(time - c->head[TIME]) <= NEAR_STEP * step + NEAR_TIME * fabs(time))
        return;
    c->warned = 1;
    report(c, fmi2Warning, "communication point must be the time reached, %s s, or that of a saved state, is %s s;"
           " the motion goes on from the state it is in", SHOWN(c->head[TIME]), SHOWN(time));
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real step, fmi2Boolean no_state_prior)
{
    struct instance *c = component;
    (void)no_state_prior;
    if (!c)
        return fmi2Error;
    if (phase_of(c) != STEPPING)
        return out_of_order(c, "doStep", "after exitInitializationMode");
    if (!isfinite(time))
        return report(c, fmi2Discard, "communication point must be a finite number of seconds, is %s", SHOWN(time));
    memcpy(c->x_trial, c->x, model.x_size * sizeof(double));
    const int64_t answer = KERNEL(OPERATION_STEP_ONLY, c->p, c->d, c->u, c->x, c->y, c->w, step);
    if (answer != STATUS_OK)
        return explain(c, fmi2Discard, answer, c->u, step);
    check_time(c, time, step);
    memcpy(c->x_before, c->x_trial, model.x_size * sizeof(double));
    memcpy(c->u_before, c->u, model.u_size * sizeof(double));
    /* rates of inputs hold for one step */
    for (const struct variable *input = model.variables; input < model.variables + model.variable_count; input++) {
        if (input->array == INPUTS)
            c->u[input->rate_slot] = c->u[input->given_slot] = 0.0;
    }
    c->head[COMPLETE] = 0.0;
    c->head[TIME] = time + step;
    c->head[LAST_STEP] = step;
    if (c->logged[LOG_STEPS])
        trace(c, step);
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component component)
{
    struct instance *c = component;
    return c ? report(c, fmi2Error, "cancelStep needs a pending step, there never is one") : fmi2Error;
}

static fmi2Status not_pending(struct instance *c, const char *call)
{
    return c ? report(c, fmi2Discard, "%s needs a pending step, there never is one", call) : fmi2Error;
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
        return report(c, fmi2Discard, "the kind of getRealStatus must be fmi2LastSuccessfulTime");
    *value = c->head[TIME];
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (kind != fmi2Terminated || !value)
        return report(c, fmi2Discard, "the kind of getBooleanStatus must be fmi2Terminated");
    *value = fmi2False; /* a refused step ends no simulation */
    return fmi2OK;
}
