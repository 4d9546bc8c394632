/* Link 2 held: the motion is known, only the moment of release has to be found. */
#ifndef HELD_H
#define HELD_H

#include "contact.h"
#include "guards.h"

/* phase of the highest harmonic between two looks at the guard, rad */
#define SCAN_PHASE 1.5
#define LOOKS 30
#define SCAN_INTERVALS 64

/* five-point Gauss-Legendre rule on [0, 1] */
#define GAUSS_NODE_1 0.04691007703066802
#define GAUSS_NODE_2 0.23076534494715845
#define GAUSS_WEIGHT_1 0.11846344252809454
#define GAUSS_WEIGHT_2 0.23931433524968324
#define GAUSS_WEIGHT_3 0.28444444444444444

/* The motion that is known, and the torque on the shaft at which link 2 is released. */
struct hold {
    double q, omega1, alpha1, threshold, zero;
};

static inline double held_angle(const struct mechanism *d, const struct hold *hold, double t)
{
    return hold->q + d->k * t * (hold->omega1 + 0.5 * hold->alpha1 * t);
}

/* Torque left in the housing freewheel, threshold - F, and its rate after the time t. */
static struct look release_guard(const struct mechanism *d, struct state *x, const struct hold *hold, double t)
{
    double alpha1 = hold->alpha1;
    double omega1 = hold->omega1 + alpha1 * t;
    double rate_q = d->k * omega1;
    struct inertia r = reduced_inertia(d, held_angle(d, hold, t));
    x->step_evaluations += 1;
    return (struct look){hold->threshold - free_torque(d, omega1, alpha1, rate_q, &r),
                         -free_torque_rate(d, omega1, alpha1, rate_q, d->k * alpha1, &r)};
}

/* Time of a point between low and high where the guard is below -zero, or -1 if its lowest is not. */
static double find_low(const struct mechanism *d, struct state *x, const struct hold *hold, double low,
                       struct look at_low, double high, struct look at_high)
{
    for (int n = 0; n < LOOKS; n++) {
        if (stays_positive(at_low, at_high, high - low))
            return -1.0;
        double t = next_look(low, at_low.rate, high, at_high.rate);
        struct look look = release_guard(d, x, hold, t);
        if (look.value < -hold->zero)
            return t;
        if (look.rate < 0.0) {
            low = t;
            at_low = look;
        } else {
            high = t;
            at_high = look;
        }
    }
    return -1.0;
}

/* First time found where the guard is below -zero, knowing it is not at low and is at high. */
static double find_release(const struct mechanism *d, struct state *x, const struct hold *hold, double low,
                           double high)
{
    double zero = hold->zero;
    double t = high;
    struct look look = release_guard(d, x, hold, t);
    for (int n = 0; n < 100; n++) {
        if (-4.0 * zero <= look.value && look.value < -zero)
            return t;
        double move = look.rate < 0.0 ? t - (look.value + 2.0 * zero) / look.rate : low;
        t = low < move && move < high ? move : 0.5 * (low + high);
        if (!(low < t && t < high))
            return high;
        look = release_guard(d, x, hold, t);
        if (look.value < -zero)
            high = t;
        else
            low = t;
    }
    return high;
}

/* Integral of Phi = J1 + I + 2 k B + k^2 G over the time from start to end (five-point Gauss rule). */
static double mean_inertia(const struct mechanism *d, struct state *x, const struct hold *hold, double start,
                           double end)
{
    double h = end - start;
    double near = held_inertia(d, held_angle(d, hold, start + GAUSS_NODE_1 * h)) +
                  held_inertia(d, held_angle(d, hold, end - GAUSS_NODE_1 * h));
    double mid = held_inertia(d, held_angle(d, hold, start + GAUSS_NODE_2 * h)) +
                 held_inertia(d, held_angle(d, hold, end - GAUSS_NODE_2 * h));
    double centre = held_inertia(d, held_angle(d, hold, start + 0.5 * h));
    x->step_evaluations += 5;
    return h * (GAUSS_WEIGHT_1 * near + GAUSS_WEIGHT_2 * mid + GAUSS_WEIGHT_3 * centre);
}

struct scan {
    double passed, integral; /* integral of Phi if alpha1 is not zero */
    bool released;
};

/* Follow the guard of the housing freewheel through at most SCAN_INTERVALS intervals. */
static struct scan scan(const struct mechanism *d, struct state *x, const struct hold *hold, double remaining)
{
    double alpha1 = hold->alpha1;
    double fastest = d->harmonic * d->k * larger(fabs(hold->omega1), fabs(hold->omega1 + alpha1 * remaining));
    double interval = smaller(remaining, d->max_step);
    if (fastest * interval > SCAN_PHASE)
        interval = SCAN_PHASE / fastest;
    struct look at_start = release_guard(d, x, hold, 0.0);
    struct scan scan = {0.0, 0.0, false};
    for (int n = 1; n <= SCAN_INTERVALS; n++) {
        double start = scan.passed;
        double end = n * interval;
        bool last = end >= remaining;
        if (end > remaining)
            end = remaining;
        struct look at_end = release_guard(d, x, hold, end);
        double found = end;
        if (!(at_end.value < -hold->zero))
            found = find_low(d, x, hold, start, at_start, end, at_end);
        if (found > 0.0)
            end = find_release(d, x, hold, start, found);
        if (alpha1 != 0.0)
            scan.integral += mean_inertia(d, x, hold, start, end);
        scan.passed = end;
        scan.released = found > 0.0;
        if (scan.released || last)
            break;
        at_start = at_end;
    }
    return scan;
}

/* Output shaft on its own: uniform deceleration by the load. */
static inline void coast(const struct mechanism *d, struct state *x, double load, double h)
{
    double change = -load * h / d->j3;
    add(&x->energy_out, load * h * (x->omega3.value + 0.5 * change));
    add(&x->omega3, change);
}

struct advance {
    double passed; /* time, or -1 if no step is small enough */
    bool event;    /* whether the contact mode may change then */
};

/* Advance some scan intervals, to the release of link 2 or to where the output shaft stops. */
static struct advance advance_held(const struct mechanism *d, struct state *x, double omega1, double alpha1,
                                   double load, double remaining)
{
    int mode = x->mode;
    double stop = -1.0;
    if (mode == HELD && load > 0.0 && d->j3 * x->omega3.value < load * remaining) {
        stop = d->j3 * x->omega3.value / load;
        remaining = stop;
    }
    double threshold = mode == HELD_DRIVING ? load : 0.0;
    double zero = TORQUE_ROUNDING * (torque_scale(d, omega1, alpha1, d->k * omega1) + fabs(threshold));
    struct hold hold = {x->q.value, omega1, alpha1, threshold, zero};
    struct scan s = scan(d, x, &hold, remaining);
    double h = s.passed;
    double end = omega1 + alpha1 * h;
    double before = held_inertia(d, hold.q);
    double after = held_inertia(d, held_angle(d, &hold, h));
    x->step_evaluations += 2;
    add(&x->energy_in, 0.5 * (after * end * end - before * omega1 * omega1));
    x->input_impulse += 0.5 * (after * end - before * omega1 + alpha1 * s.integral);
    add(&x->q, d->k * h * (omega1 + 0.5 * alpha1 * h));
    if (mode == HELD_DRIVING) {
        x->output_impulse += load * h;
        x->output_square += load * load * h;
        x->torque_peak = larger(x->torque_peak, fabs(load));
        return (struct advance){h, s.released};
    }
    coast(d, x, load, h);
    if (stop >= 0.0 && h >= stop && !s.released) {
        assign(&x->omega3, 0.0);
        return (struct advance){h, true};
    }
    return (struct advance){h, s.released};
}

#endif
