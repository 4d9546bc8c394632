/* Ideal freewheels as complementarity conditions: which contact mode holds, and what a jump does. */
#ifndef CONTACT_H
#define CONTACT_H

#include "dynamics.h"

/* a torque below this fraction of its scale is zero: the sign of its rate decides */
#define TORQUE_ROUNDING 1e-13

/* Whether value is positive, or zero within rounding and growing. */
static inline bool sign_or_trend(double value, double rate, double zero)
{
    return value > zero || (value >= -zero && rate > 0.0);
}

/* Contact mode of the 2 x 2 complementarity problem on accelerations. A freewheel touches where its
   relative velocity is exactly zero: the event search and the impulses set it so. */
static int select_mode(const struct mechanism *d, const struct state *x, double omega1)
{
    double k = d->k;
    double alpha1 = x->alpha1;
    double load = x->load_torque;
    double omega2 = x->omega2.value;
    struct inertia r = reduced_inertia(d, x->q.value);
    double rate_q = k * (omega1 - omega2);
    double free = free_torque(d, omega1, alpha1, rate_q, &r);
    double zero_free = TORQUE_ROUNDING * torque_scale(d, omega1, alpha1, rate_q);
    double zero = zero_free + TORQUE_ROUNDING * fabs(load);
    bool housing = d->housing && omega2 == 0.0;
    bool output = !d->output || x->omega3.value == omega2;
    double trend = housing ? free_torque_rate(d, omega1, alpha1, rate_q, k * alpha1, &r) : 0.0;
    if (!output)
        return !housing || sign_or_trend(free, trend, zero_free) ? FREE : HELD;
    if (housing && (!d->output || load >= 0.0))
        return sign_or_trend(free - load, trend, zero) ? DRIVING : HELD_DRIVING;
    if (!d->output)
        return DRIVING;
    if (housing && !sign_or_trend(free, trend, zero_free))
        return HELD; /* the load itself pulls the shaft away */
    double inertia = d->j2 + k * k * r.g;
    double alpha2 = inertia > 0.0 ? free / inertia : 0.0;
    trend = free_torque_rate(d, omega1, alpha1, rate_q, k * (alpha1 - alpha2), &r);
    double closing = d->j3 * free + inertia * load;
    double closing_rate = d->j3 * trend + k * k * r.g1 * rate_q * load;
    return sign_or_trend(closing, closing_rate, zero * (d->j3 + inertia)) ? DRIVING : FREE;
}

/* One linear part of a jump: omega1 by jump, link 2 by change2. Returns the input impulse. */
static double apply_part(const struct mechanism *d, struct state *x, const struct inertia *r, double jump,
                         double change2)
{
    double rate_change = d->k * (jump - change2);
    double impulse =
        (d->j1 + r->i) * jump + r->b * rate_change + d->k * (r->b * jump + r->g * rate_change);
    add(&x->energy_in, impulse * (x->omega1 + 0.5 * jump));
    x->omega1 += jump;
    return impulse;
}

struct impulses {
    double input, output;
};

/* A jump of omega1 is the limit of a steep ramp: link 2 moves freely up to where a freewheel closes and
   with what it has met from there on. Complementarity on impulses and end velocities. */
static struct impulses jump_input(const struct mechanism *d, struct state *x, double jump)
{
    struct inertia r = reduced_inertia(d, x->q.value);
    double k = d->k;
    double push = k * (r.b + k * r.g) * jump;
    double inertia = d->j2 + k * k * r.g;
    double omega2 = x->omega2.value;
    double omega3 = x->omega3.value;
    double target = x->omega1 + jump;
    bool joined = !d->output || (omega3 == omega2 && push > 0.0);
    if (joined)
        inertia += d->j3;
    double change = push != 0.0 ? push / inertia : 0.0;
    double fraction = 1.0;
    double end2 = omega2 + change;
    if (d->housing && end2 < 0.0) {
        fraction = omega2 / -change; /* the rest of the way link 2 is held */
        end2 = 0.0;
    } else if (!joined && end2 > omega3) {
        fraction = (omega3 - omega2) / change; /* the rest of the way it drives the shaft */
        end2 = omega3 + (1.0 - fraction) * push / (inertia + d->j3);
    }
    double part = fraction * jump;
    struct impulses impulses = {apply_part(d, x, &r, part, fraction * change), 0.0};
    if (fraction < 1.0)
        impulses.input += apply_part(d, x, &r, jump - part, end2 - (omega2 + fraction * change));
    x->omega1 = target;
    assign(&x->omega2, end2);
    if (end2 > omega3 || !d->output) {
        impulses.output = d->j3 * (end2 - omega3);
        assign(&x->omega3, end2);
    }
    return impulses;
}

#endif
