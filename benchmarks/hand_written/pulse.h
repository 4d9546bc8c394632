/* Link 2 in motion, free or driving the output shaft: steps of the embedded pair up to the next event. */
#ifndef PULSE_H
#define PULSE_H

#include "events.h"
#include "held.h"

/* phase of the highest harmonic within one step, rad; the same where the inertia all but vanishes */
#define STEP_PHASE 12.0
#define CUSP_PHASE 1.0
#define CUSP_RATIO 1e-2
#define SEGMENT_STEPS 64
#define SAFETY 0.9
#define SMALLEST_FACTOR 0.2
#define LARGEST_FACTOR 5.0
#define REJECTIONS 100

/* Fastest rate of the highest harmonic over a step h, rad/s. */
static inline double highest_rate(const struct mechanism *d, const struct step *w, double omega2, double h)
{
    return d->harmonic * d->k * larger(fabs(w->omega1 - omega2), fabs(w->omega1 + w->alpha1 * h - omega2));
}

/* Whether the inertia behind link 2 is far smaller where the imbalance rests in link 1 than elsewhere. */
static inline bool has_cusp(const struct mechanism *d, const struct step *w)
{
    double moving = d->k * d->k * d->mass;
    double offset = d->pole_offset;
    double far = offset + 2.0 * d->pole_arm;
    double least = d->j2 + d->k * d->k * d->j16 + w->shaft_inertia + moving * offset * offset;
    return least < CUSP_RATIO * moving * (far * far + d->spin);
}

/* Longest step that can be searched for events: a bounded phase of the highest harmonic. */
static inline double longest_step(const struct mechanism *d, const struct step *w, double omega2,
                                  double remaining)
{
    double step = smaller(remaining, d->max_step);
    double fastest = highest_rate(d, w, omega2, step);
    double phase = has_cusp(d, w) ? CUSP_PHASE : STEP_PHASE;
    return fastest * step > phase ? phase / fastest : step;
}

/* How much of its own speed the mechanism can impart to link 2 and what it carries, 0 to 1: the natural
   measure of an error of omega2. */
static inline double response(const struct mechanism *d, const struct step *w)
{
    double own = d->alpha_slope;
    return own > 0.0 ? own / (own + d->j2 + w->shaft_inertia) : 1.0;
}

/* Upper bound of the inertia that takes part in P, kg m^2. */
static inline double inertia_scale(const struct mechanism *d)
{
    return (d->alpha_slope + 0.5 * d->i_slope) / d->k + d->j1 + d->j2;
}

struct change {
    double q, omega2, fastest; /* fastest: largest speed, or -1 if no step will do */
};

/* Make the longest step whose error is allowed; the stages are left in w, its length in w->h. The size
   for the next step is carried in the state, from one communication step to the next. */
static struct change try_steps(const struct mechanism *d, struct state *x, struct step *w, double remaining,
                               const struct rates *start)
{
    double omega1 = w->omega1;
    double alpha1 = w->alpha1;
    double omega2 = x->omega2.value;
    double carried = x->step_size;
    double limit = longest_step(d, w, omega2, remaining);
    double share = response(d, w);
    double tolerance = d->tolerance;
    double h = carried > 0.0 ? smaller(limit, carried) : 0.1 * limit;
    for (int attempt = 0; attempt < REJECTIONS; attempt++) {
        w->h = h;
        stages(d, w, x->q.value, omega2, start);
        x->step_evaluations += 11;
        double change_q = h * result(w->rate_q);
        double change2 = h * result(w->rate_omega2);
        double ends = larger(fabs(omega1 + alpha1 * h), fabs(omega2 + change2));
        double fastest = larger(ends, larger(fabs(omega1), fabs(omega2)));
        double measure = larger(share * fastest, fabs(change2));
        /* alpha1 times the integral of P is work, to be compared with the energy at these speeds */
        double ramp = alpha1 != 0.0 ? inertia_scale(d) * fastest * fastest / fabs(alpha1) : 0.0;
        double error = 0.0;
        if (measure > 0.0)
            error = error_norm(w, tolerance, tolerance * measure, tolerance * ramp);
        double factor = LARGEST_FACTOR;
        if (!(error < 1e300))
            factor = SMALLEST_FACTOR;
        else if (error > 0.0)
            factor = smaller(LARGEST_FACTOR, larger(SMALLEST_FACTOR, SAFETY * pow(error, -0.125)));
        if (error <= 1.0) {
            /* a step cut short by the end of the communication step says little about longer ones */
            x->step_size = attempt == 0 && h < carried ? larger(factor * h, carried) : factor * h;
            return (struct change){change_q, change2, fastest};
        }
        h *= factor;
    }
    return (struct change){0.0, 0.0, -1.0};
}

/* Take the step over; where a velocity has met its limit, or passed it within rounding, set it there. */
static void commit(const struct mechanism *d, struct state *x, const struct step *w, double passed,
                   const struct change *change, int which)
{
    add(&x->q, change->q);
    wrap_drive_angle(d, x);
    add(&x->omega2, change->omega2);
    if (which == LINK2 || (d->housing && x->omega2.value < 0.0))
        assign(&x->omega2, 0.0);
    if (x->mode == DRIVING) {
        x->omega3 = x->omega2;
        return;
    }
    coast(d, x, w->load, passed);
    if (which == LINK2) {
        if (x->omega3.value < 0.0)
            assign(&x->omega3, 0.0);
    } else if (which == OUTPUT || x->omega3.value < x->omega2.value) {
        if (d->housing && x->omega3.value < 0.0)
            assign(&x->omega3, 0.0);
        x->omega2 = x->omega3;
    }
}

/* Integral of Tc^2 over the step or its part sigma, and its peak. */
static void add_square(const struct mechanism *d, struct state *x, const struct step *w, double sigma)
{
    const double nodes[KEPT_STAGES] = {0.0, C6, C7, C8, C9, C10, C11, 1.0, 1.0, C14, C15, C16};
    double square[KEPT_STAGES];
    double peak = x->torque_peak;
    double share = sigma >= 0.0 ? sigma : 1.0;
    int count = sigma < 0.0 ? 8 : KEPT_STAGES;
    for (int n = 0; n < count; n++) {
        double torque = w->load + d->j3 * w->rate_omega2[n];
        if (nodes[n] <= share)
            peak = larger(peak, fabs(torque));
        square[n] = torque * torque;
    }
    x->torque_peak = peak;
    x->output_square += quadrature(w->h, square, sigma);
}

/* Impulses and works of the torques over the time passed since link 1 and 2 had start1 and start2:
   exact in the end values, for M1 - Tc is the rate of P. ramp is alpha1 times the integral of P. */
static void add_works(const struct mechanism *d, struct state *x, const struct step *w, double start1,
                      double start2, double passed, double turned2, double momentum, double momentum_end,
                      double ramp)
{
    double alpha1 = w->alpha1;
    double end1 = start1 + alpha1 * passed;
    double impulse = momentum_end - momentum;
    double work = end1 * momentum_end - start1 * momentum - ramp;
    if (x->mode == DRIVING) {
        double end2 = x->omega2.value;
        double clutch = d->j3 * (end2 - start2) + w->load * passed;
        impulse += clutch;
        work += d->j3 * (end1 * end2 - start1 * start2 - alpha1 * turned2);
        work += w->load * passed * (start1 + 0.5 * alpha1 * passed);
        x->output_impulse += clutch;
        add(&x->energy_out, w->load * turned2);
    }
    x->input_impulse += impulse;
    add(&x->energy_in, alpha1 == 0.0 ? start1 * impulse : work);
}

struct taken {
    double passed, change_q, ramp; /* time, or -1 if no step is small enough */
    int which;                     /* guard that fell, or NONE */
};

/* One accepted step, shortened to the first event in it. rates are those at its beginning, then its end. */
static struct taken one_step(const struct mechanism *d, struct state *x, struct step *w, double remaining,
                             struct rates *rates)
{
    struct change change = try_steps(d, x, w, remaining, rates);
    if (change.fastest < 0.0)
        return (struct taken){-1.0, 0.0, 0.0, NONE};
    double h = w->h;
    double alpha1 = w->alpha1;
    double omega2 = x->omega2.value;
    double end2 = omega2 + change.omega2;
    struct rates end = motion_rates(d, x->q.value + change.q, w->omega1 + alpha1 * h, alpha1, end2,
                                    w->shaft_inertia, w->shaft_torque);
    x->step_evaluations += 1;
    keep(w, END_STAGE, drive_rate(d, w, 1.0, end2), &end);
    double phase = h * larger(highest_rate(d, w, omega2, h), highest_rate(d, w, end2, h));
    struct event event = {-1.0, NONE};
    if (!is_step_quiet(d, x, w, phase, rates, end2, &end)) {
        double ends = larger(fabs(omega2), larger(fabs(end2), fabs(x->omega3.value)));
        event = first_event(d, x, w, phase, change.fastest, larger(response(d, w) * change.fastest, ends));
    }
    double passed = h;
    if (event.sigma < 0.0) {
        event = (struct event){-1.0, NONE};
    } else {
        change.q = dense_change(w->dense_q, event.sigma);
        change.omega2 = dense_change(w->dense_omega2, event.sigma);
        passed = event.sigma * h;
    }
    double ramp = alpha1 != 0.0 ? alpha1 * quadrature(h, w->momentum, event.sigma) : 0.0;
    if (x->mode == DRIVING)
        add_square(d, x, w, event.sigma);
    commit(d, x, w, passed, &change, event.which);
    if (event.which != NONE) {
        end.momentum = angular_momentum(d, x->q.value, w->omega1 + alpha1 * passed, x->omega2.value);
        x->step_evaluations += 1;
    }
    *rates = end;
    return (struct taken){passed, change.q, ramp, event.which};
}

/* Advance to the next event, the end of the time remaining, or SEGMENT_STEPS steps. */
static struct advance advance_moving(const struct mechanism *d, struct state *x, double omega1, double alpha1,
                                     double load, double remaining)
{
    bool driving = x->mode == DRIVING;
    struct step w;
    w.omega1 = omega1;
    w.alpha1 = alpha1;
    w.load = load;
    w.shaft_inertia = driving ? d->j3 : 0.0;
    w.shaft_torque = driving ? load : 0.0;
    double start2 = x->omega2.value;
    struct rates rates =
        motion_rates(d, x->q.value, omega1, alpha1, start2, w.shaft_inertia, w.shaft_torque);
    x->step_evaluations += 1;
    double momentum = rates.momentum;
    double time = 0.0;
    double angle = 0.0;
    double ramp = 0.0;
    int which = NONE;
    for (int n = 0; n < SEGMENT_STEPS; n++) {
        w.omega1 = omega1 + alpha1 * time;
        struct taken step = one_step(d, x, &w, remaining - time, &rates);
        if (step.passed < 0.0)
            return (struct advance){-1.0, false};
        angle += step.change_q;
        ramp += step.ramp;
        which = step.which;
        bool done = step.passed >= remaining - time;
        time = done ? remaining : time + step.passed;
        if (done || which != NONE)
            break;
    }
    double turned2 = time * (omega1 + 0.5 * alpha1 * time) - angle / d->k;
    add_works(d, x, &w, omega1, start2, time, turned2, momentum, rates.momentum, ramp);
    return (struct advance){time, which != NONE};
}

#endif
