/* Steps and events of FMI 3.0. */
#include "fmi3.h"

/* Call the intermediate update of the host at the present time. ``finished``: 1 at the end of a step. */
static void show_instance(struct instance *core, int finished)
{
    struct component *const c = (struct component *)core;
    fmi3Boolean early_return = false;
    fmi3Float64 early_return_time = core->head[TIME];
    core->head[PHASE] = UPDATING;
    c->update(c->environment, core->head[TIME], false, true, finished, false, &early_return, &early_return_time);
    core->head[PHASE] = STEPPING;
}

static void show_within(struct instance *core)
{
    show_instance(core, 0);
}

/* Make a step that stops at events if the host allows early return. */
static enum status do_step(struct instance *c, double time, double step)
{
    const struct component *const component = (struct component *)c;
    const int stops = component->early_return && model.event_slot >= 0;
    const enum status status = take_step(c, stops ? OPERATION_STEP_UNTIL_EVENT : OPERATION_STEP_ONLY, time, step);
    if (status == OK && component->update && !stops)
        replay_events(c, time, show_within);
    return status;
}

/* Handle the pending event and call the intermediate update after the results of a step are written. */
static void end_step(struct instance *c)
{
    const struct component *const component = (struct component *)c;
    if (!component->event_mode)
        handle_pending_event(c);
    if (component->update)
        show_instance(c, 1);
    if (!component->event_mode)
        store_discrete(c);
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_state_prior,
                      fmi3Boolean *event_handling_needed, fmi3Boolean *terminate_simulation,
                      fmi3Boolean *early_return, fmi3Float64 *last_successful_time)
{
    const struct component *const component = instance;
    struct instance *const c = instance;
    (void)no_state_prior;
    if (!c)
        return fmi3Error;
    if (!event_handling_needed || !terminate_simulation || !early_return || !last_successful_time)
        return (fmi3Status)report_missing_array(c, "doStep");
    const enum status status = do_step(c, time, step);
    *event_handling_needed = status == OK && component->event_mode && (has_pending_event(c) || has_discrete_change(c));
    *early_return = status == OK && c->head[LAST_STEP] < step;
    *terminate_simulation = false;
    *last_successful_time = c->head[TIME];
    if (status == OK)
        end_step(c);
    return (fmi3Status)status;
}

static enum status do_whole_step(struct instance *c, double time, double step)
{
    const enum status status = do_step(c, time, step);
    if (status == OK)
        end_step(c);
    return status;
}

/* An addition to FMI: many steps in one call, for an instance whose steps do not stop at events. */
FMI3_Export fmi3Status inertiaModuleRun(fmi3Instance instance, struct run *run);

fmi3Status inertiaModuleRun(fmi3Instance instance, struct run *run)
{
    struct component *const c = instance;
    if (c && (c->event_mode || c->early_return))
        return (fmi3Status)report_wrong_phase(&c->core, "a run", "without event mode and early return");
    return (fmi3Status)take_steps(instance, run, do_whole_step);
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance)
{
    struct component *const c = instance;
    if (!c)
        return fmi3Error;
    if (!c->event_mode || phase_of(&c->core) != STEPPING)
        return (fmi3Status)report_wrong_phase(&c->core, "enterEventMode",
                                        "in step mode of an instance with eventModeUsed = true");
    c->core.head[PHASE] = AT_EVENT;
    return fmi3OK;
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    struct instance *const c = instance;
    if (!c)
        return fmi3Error;
    if (phase_of(c) != AT_EVENT)
        return (fmi3Status)report_wrong_phase(c, "enterStepMode", "in event mode");
    store_discrete(c);
    c->head[PHASE] = STEPPING;
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *needs_update, fmi3Boolean *terminates,
                                    fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                    fmi3Boolean *next_event_defined, fmi3Float64 *next_event)
{
    struct instance *const c = instance;
    if (!c)
        return fmi3Error;
    if (phase_of(c) != AT_EVENT)
        return (fmi3Status)report_wrong_phase(c, "updateDiscreteStates", "in event mode");
    if (!needs_update || !terminates || !nominals_changed || !values_changed || !next_event_defined || !next_event)
        return (fmi3Status)report_missing_array(c, "updateDiscreteStates");
    handle_pending_event(c);
    *needs_update = *terminates = *nominals_changed = *values_changed = *next_event_defined = false;
    return fmi3OK;
}
