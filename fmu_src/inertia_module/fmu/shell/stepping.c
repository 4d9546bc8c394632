/* Communication steps. */
#include "instance.h"

#include <math.h>
#include <string.h>

/* Maximum distance of a communication point from the present time without a warning: fractions of step and time. */
#define NEAR_STEP 1e-3
#define NEAR_TIME 1e-12
/* A step may end after the stop time by this fraction of the stop time, or of a second, because hosts round. The
   Reference-FMUs allow the same. */
#define NEAR_STOP 1e-5
/* Maximum intermediate updates of a step: this number at its beginning, and the same number evenly spaced over it. */
#define MAX_UPDATES 1000.0

/* Warn once if the communication point is not the present time. The motion does not depend on the time. */
static void check_time(struct instance *c, double time, double step)
{
    /* The difference of halves is always finite. */
    const double half = 0.5 * time, half_reached = 0.5 * c->head[TIME];
    if (c->warned || fabs(half - half_reached) <= 0.5 * NEAR_STEP * step + NEAR_TIME * fabs(half))
        return;
    c->warned = 1;
    report(c, WARNING, "communication point must be the time reached, %s s, or the time of a saved state (got %s s)."
           " The motion continues from the present state.", TEXT_OF(c->head[TIME]), TEXT_OF(time));
}

static int ends_after_stop(const struct instance *c, double time, double step)
{
    const double stop = c->head[STOP_TIME];
    /* Sums of halves are always finite. */
    return is_number(step) && 0.5 * time + 0.5 * step > 0.5 * stop + 0.5 * NEAR_STOP * fmax(1.0, fabs(stop));
}

int has_pending_event(const struct instance *c)
{
    return model.event_slot >= 0 && c->x[model.event_slot] != 0.0;
}

void handle_pending_event(struct instance *c)
{
    if (!has_pending_event(c))
        return;
    call_kernel(OPERATION_HANDLE_EVENT, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    c->head[LATE_COMPUTED] = 0.0;
}

void replay_events(struct instance *c, double time, void (*show)(struct instance *c))
{
    const double step = c->head[LAST_STEP], late_at_end = c->head[LATE_COMPUTED], part = step / MAX_UPDATES;
    double passed = 0.0, n_updates = 0.0;
    if (model.event_slot < 0)
        return;
    memcpy(c->x_end, c->x, model.x_size * sizeof(double));
    memcpy(c->y_end, c->y, model.y_size * sizeof(double));
    memcpy(c->x, c->x_before, model.x_size * sizeof(double));
    while (passed < step) {
        const int is_limited = n_updates >= MAX_UPDATES * (1.0 + passed / step);
        const enum operation operation = is_limited ? OPERATION_STEP_ONLY : OPERATION_STEP_UNTIL_EVENT;
        const double length = is_limited ? fmin(part, step - passed) : step - passed;
        if (call_kernel(operation, c->p, c->d, c->u, c->x, c->y, c->w, length) != STATUS_OK)
            break;
        passed += c->x[model.length_slot];
        if (is_limited)
            continue;
        if (!has_pending_event(c))
            break;
        handle_pending_event(c);
        c->head[TIME] = time + passed;
        show(c);
        n_updates += 1.0;
    }
    memcpy(c->x, c->x_end, model.x_size * sizeof(double));
    memcpy(c->y, c->y_end, model.y_size * sizeof(double));
    c->head[TIME] = time + step;
    c->head[LATE_COMPUTED] = late_at_end;
}

enum status take_step(struct instance *c, enum operation operation, double time, double step)
{
    if (!c)
        return ERROR;
    if (phase_of(c) == AT_EVENT || phase_of(c) == UPDATING)
        return report_wrong_phase(c, "doStep", "in step mode");
    if (phase_of(c) != STEPPING)
        return report_wrong_phase(c, "doStep", "after exitInitializationMode");
    if (!is_finite(time))
        return report(c, DISCARD, "communication point must be a finite number of seconds (got %s)", TEXT_OF(time));
    if (ends_after_stop(c, time, step))
        return report(c, ERROR, "a step must end at or before the stop time %s s (got a step of %s s from %s s)",
                      TEXT_OF(c->head[STOP_TIME]), TEXT_OF(step), TEXT_OF(time));
    memcpy(c->x_trial, c->x, model.x_size * sizeof(double));
    const int64_t kernel_status = call_kernel(operation, c->p, c->d, c->u, c->x, c->y, c->w, step);
    if (kernel_status != STATUS_OK)
        return report_kernel_status(c, DISCARD, kernel_status, c->u, step);
    check_time(c, time, step);
    memcpy(c->x_before, c->x_trial, model.x_size * sizeof(double));
    memcpy(c->u_before, c->u, model.u_size * sizeof(double));
    /* Rates of inputs are valid for one step. */
    for (const struct variable *input = model.variables; input < model.variables + model.variable_count; input++) {
        if (input->array == INPUTS)
            c->u[input->rate_slot] = c->u[input->has_rate_slot] = 0.0;
    }
    const double length = model.length_slot >= 0 ? c->x[model.length_slot] : step;
    c->head[LATE_COMPUTED] = 0.0;
    c->head[TIME] = time + length;
    c->head[LAST_STEP] = length;
    if (c->logged[LOG_STEPS])
        log_step(c, length);
    return OK;
}

enum status take_steps(struct instance *c, struct run *run,
                       enum status (*step)(struct instance *c, double time, double length))
{
    static const struct type number = {"number", ~0u, read_real, write_real};
    if (!c)
        return ERROR;
    if (!run || (run->steps > 0 && !run->lengths))
        return report_missing_array(c, "inertiaModuleRun");
    const size_t n_steps = run->steps;
    const double *set = run->set;
    double *read = run->read;
    enum status status = get_values(c, run->outputs, run->output_count, read, &number);
    for (run->steps = 0; status == OK && run->steps < n_steps; run->steps++) {
        const double length = run->lengths[run->steps];
        status = set_values(c, run->inputs, run->input_count, set, &number);
        if (status == OK)
            status = step(c, run->time, length);
        if (status != OK)
            break;
        run->time += length;
        set += run->input_count;
        read += run->row_size;
        status = get_values(c, run->outputs, run->output_count, read, &number);
    }
    return status;
}
