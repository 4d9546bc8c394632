/* Communication steps. */
#include "instance.h"

#include <math.h>
#include <string.h>

/* a communication point this far from the time reached, over the step and over the time, is worth a warning */
#define NEAR_STEP 1e-3
#define NEAR_TIME 1e-12
/* a step may end past the stop time by this share of it, or of a second: hosts round (Reference-FMUs allow the same) */
#define NEAR_STOP 1e-5
/* intermediate updates of a step: so many at its beginning, and so many more spread evenly over it */
#define UPDATES 1000.0

/* Tell once if the host's time is not the time reached: the motion itself knows no time. */
static void check_time(struct instance *c, double time, double step)
{
    /* halves: their difference is finite */
    const double half = 0.5 * time, half_reached = 0.5 * c->head[TIME];
    if (c->warned || fabs(half - half_reached) <= 0.5 * NEAR_STEP * step + NEAR_TIME * fabs(half))
        return;
    c->warned = 1;
    report(c, WARNING, "communication point must be the time reached, %s s, or the time of a saved state (got %s s)."
           " The motion continues from the present state.", SHOWN(c->head[TIME]), SHOWN(time));
}

static int leads_past_stop(const struct instance *c, double time, double step)
{
    const double stop = c->head[STOP_TIME];
    /* halves: their sums are finite */
    return is_number(step) && 0.5 * time + 0.5 * step > 0.5 * stop + 0.5 * NEAR_STOP * fmax(1.0, fabs(stop));
}

int has_stopped(const struct instance *c)
{
    return model.switching_slot >= 0 && c->x[model.switching_slot] != 0.0;
}

void carry_out_switch(struct instance *c)
{
    if (!has_stopped(c))
        return;
    call_kernel(OPERATION_HANDLE_EVENT, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    c->head[COMPLETE] = 0.0;
}

void show_switches(struct instance *c, double time, void (*show)(struct instance *c))
{
    const double step = c->head[LAST_STEP], complete_at_end = c->head[COMPLETE], part = step / UPDATES;
    double passed = 0.0, shown = 0.0;
    if (model.switching_slot < 0)
        return;
    memcpy(c->x_end, c->x, model.x_size * sizeof(double));
    memcpy(c->y_end, c->y, model.y_size * sizeof(double));
    memcpy(c->x, c->x_before, model.x_size * sizeof(double));
    while (passed < step) {
        const int too_many = shown >= UPDATES * (1.0 + passed / step);
        const enum operation operation = too_many ? OPERATION_STEP_ONLY : OPERATION_STEP_UNTIL_EVENT;
        const double length = too_many ? fmin(part, step - passed) : step - passed;
        if (call_kernel(operation, c->p, c->d, c->u, c->x, c->y, c->w, length) != STATUS_OK)
            break;
        passed += c->x[model.length_slot];
        if (too_many)
            continue;
        if (!has_stopped(c))
            break;
        carry_out_switch(c);
        c->head[TIME] = time + passed;
        show(c);
        shown += 1.0;
    }
    memcpy(c->x, c->x_end, model.x_size * sizeof(double));
    memcpy(c->y, c->y_end, model.y_size * sizeof(double));
    c->head[TIME] = time + step;
    c->head[COMPLETE] = complete_at_end;
}

enum status take_step(struct instance *c, enum operation operation, double time, double step)
{
    if (!c)
        return ERROR;
    if (phase_of(c) == AT_EVENT || phase_of(c) == UPDATING)
        return out_of_order(c, "doStep", "in step mode");
    if (phase_of(c) != STEPPING)
        return out_of_order(c, "doStep", "after exitInitializationMode");
    if (!is_finite(time))
        return report(c, DISCARD, "communication point must be a finite number of seconds (got %s)", SHOWN(time));
    if (leads_past_stop(c, time, step))
        return report(c, ERROR, "a step must end at or before the stop time %s s (got a step of %s s from %s s)",
                      SHOWN(c->head[STOP_TIME]), SHOWN(step), SHOWN(time));
    memcpy(c->x_trial, c->x, model.x_size * sizeof(double));
    const int64_t answer = call_kernel(operation, c->p, c->d, c->u, c->x, c->y, c->w, step);
    if (answer != STATUS_OK)
        return explain(c, DISCARD, answer, c->u, step);
    check_time(c, time, step);
    memcpy(c->x_before, c->x_trial, model.x_size * sizeof(double));
    memcpy(c->u_before, c->u, model.u_size * sizeof(double));
    /* rates of inputs hold for one step */
    for (const struct variable *input = model.variables; input < model.variables + model.variable_count; input++) {
        if (input->array == INPUTS)
            c->u[input->rate_slot] = c->u[input->given_slot] = 0.0;
    }
    const double length = model.length_slot >= 0 ? c->x[model.length_slot] : step;
    c->head[COMPLETE] = 0.0;
    c->head[TIME] = time + length;
    c->head[LAST_STEP] = length;
    if (c->logged[LOG_STEPS])
        trace(c, length);
    return OK;
}

enum status take_steps(struct instance *c, struct run *run,
                       enum status (*step)(struct instance *c, double time, double length))
{
    static const struct type number = {"number", ~0u, read_real, write_real};
    if (!c)
        return ERROR;
    if (!run || (run->steps > 0 && !run->lengths))
        return without_array(c, "inertiaModuleRun");
    const size_t wanted = run->steps;
    const double *set = run->set;
    double *read = run->read;
    enum status status = get_values(c, run->outputs, run->output_count, read, &number);
    for (run->steps = 0; status == OK && run->steps < wanted; run->steps++) {
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
