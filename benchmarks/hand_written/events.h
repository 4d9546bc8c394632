/* Where in a step of the integrator link 2 leaves its contact mode: guards and their crossings. */
#ifndef EVENTS_H
#define EVENTS_H

#include "contact.h"
#include "dormand_prince.h"
#include "guards.h"

#define VELOCITY_ROUNDING 1e-14
/* phase of the highest harmonic between two looks at a guard, and up to which the ends of a step tell */
#define LOOK_PHASE 1.0
#define QUIET_PHASE 2.0
#define DIP_LOOKS 30

/* Second guard (Tc while driving, else omega3 - omega2) and its rate, the time t into the step. */
static inline struct look output_guard(const struct mechanism *d, const struct state *x, const struct step *w,
                                       double t, double omega2, const struct rates *rates)
{
    if (x->mode == DRIVING)
        return (struct look){w->load + d->j3 * rates->alpha2, d->j3 * rates->jerk2};
    double slowing = w->load / d->j3;
    return (struct look){x->omega3.value - slowing * t - omega2, -slowing - rates->alpha2};
}

/* A guard at the fraction sigma of the step and its rate per unit of sigma: velocities are those of the
   dense output, a torque is evaluated exactly at its state. */
static struct look guard_inside(const struct mechanism *d, struct state *x, const struct step *w, int which,
                                double sigma)
{
    double h = w->h;
    double omega2 = x->omega2.value + dense_change(w->dense_omega2, sigma);
    if (which == OUTPUT && x->mode == DRIVING) {
        double q = x->q.value + dense_change(w->dense_q, sigma);
        double omega1 = w->omega1 + w->alpha1 * sigma * h;
        struct rates r = motion_rates(d, q, omega1, w->alpha1, omega2, w->shaft_inertia, w->shaft_torque);
        x->step_evaluations += 1;
        return (struct look){w->load + d->j3 * r.alpha2, h * d->j3 * r.jerk2};
    }
    double rate = dense_rate(w->dense_omega2, sigma);
    if (which == LINK2)
        return (struct look){omega2, rate};
    double slowing = h * w->load / d->j3;
    return (struct look){x->omega3.value - slowing * sigma - omega2, -slowing - rate};
}

/* Fraction of the step, low to high, where the guard is below -zero, or -1 if its lowest is not. */
static double find_dip(const struct mechanism *d, struct state *x, const struct step *w, int which,
                       double zero, double low, struct look at_low, double high, struct look at_high)
{
    for (int n = 0; n < DIP_LOOKS; n++) {
        if (stays_positive(at_low, at_high, high - low))
            return -1.0;
        double sigma = next_look(low, at_low.rate, high, at_high.rate);
        struct look look = guard_inside(d, x, w, which, sigma);
        if (look.value < -zero)
            return sigma;
        if (look.rate < 0.0) {
            low = sigma;
            at_low = look;
        } else {
            high = sigma;
            at_high = look;
        }
    }
    return -1.0;
}

/* Fraction where the guard falls below -zero; it is below at high and not at low. */
static double find_crossing(const struct mechanism *d, struct state *x, const struct step *w, int which,
                            double zero, double low, double high)
{
    double sigma = high;
    struct look look = guard_inside(d, x, w, which, sigma);
    for (int n = 0; n < 100; n++) {
        if (-4.0 * zero <= look.value && look.value < -zero)
            return sigma;
        double move = look.rate < 0.0 ? sigma - (look.value + 2.0 * zero) / look.rate : low;
        sigma = low < move && move < high ? move : 0.5 * (low + high);
        if (!(low < sigma && sigma < high))
            return high;
        look = guard_inside(d, x, w, which, sigma);
        if (look.value < -zero)
            high = sigma;
        else
            low = sigma;
    }
    return high;
}

/* First crossing of one guard in the step, looked for in so many parts of it, or -1. */
static double first_crossing(const struct mechanism *d, struct state *x, const struct step *w, int which,
                             double zero, int looks)
{
    double low = 0.0;
    struct look at_low = guard_inside(d, x, w, which, 0.0);
    for (int n = 1; n <= looks; n++) {
        double high = (double)n / looks;
        struct look at_high = guard_inside(d, x, w, which, high);
        double found = high;
        if (!(at_high.value < -zero))
            found = find_dip(d, x, w, which, zero, low, at_low, high, at_high);
        if (found > 0.0)
            return find_crossing(d, x, w, which, zero, low, found);
        low = high;
        at_low = at_high;
    }
    return -1.0;
}

/* Whether a guard, not negative at the beginning of the step, is so to its end. */
static inline bool is_clear(struct look start, struct look end, double h)
{
    return end.value >= 0.0 && stays_positive(start, end, h);
}

/* Whether neither guard can have fallen through zero in the step. */
static bool is_step_quiet(const struct mechanism *d, const struct state *x, const struct step *w,
                          double phase, const struct rates *start, double end2, const struct rates *end)
{
    double h = w->h;
    double start2 = x->omega2.value;
    if (phase > QUIET_PHASE)
        return false;
    struct look link2_start = {start2, start->alpha2};
    struct look link2_end = {end2, end->alpha2};
    if (d->housing && !is_clear(link2_start, link2_end, h))
        return false;
    return !d->output ||
           is_clear(output_guard(d, x, w, 0.0, start2, start), output_guard(d, x, w, h, end2, end), h);
}

struct event {
    double sigma; /* fraction of the step, or -1 */
    int which;    /* which guard */
};

/* Earliest event in the step just made. fastest is the largest of the speeds, taken the largest that
   link 2 and the shaft take on: what a torque and a velocity are to be called zero against. */
static struct event first_event(const struct mechanism *d, struct state *x, struct step *w, double phase,
                                double fastest, double taken)
{
    extra_stages(d, w, x->q.value, x->omega2.value);
    x->step_evaluations += 3;
    dense_coefficients(w->h, w->rate_q, w->dense_q);
    dense_coefficients(w->h, w->rate_omega2, w->dense_omega2);
    int looks = 1 + (int)floor(phase / LOOK_PHASE);
    struct event event = {-1.0, NONE};
    double zero = VELOCITY_ROUNDING * taken;
    if (d->housing)
        event = (struct event){first_crossing(d, x, w, LINK2, zero, looks), LINK2};
    if (d->output) {
        if (x->mode == DRIVING)
            zero = TORQUE_ROUNDING *
                   (torque_scale(d, w->omega1, w->alpha1, 2.0 * d->k * fastest) + fabs(w->load));
        double sigma = first_crossing(d, x, w, OUTPUT, zero, looks);
        if (sigma > 0.0 && (event.sigma < 0.0 || sigma < event.sigma))
            event = (struct event){sigma, OUTPUT};
    }
    return event;
}

#endif
