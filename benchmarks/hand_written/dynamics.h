/* Equations of motion: torques and accelerations at one instant. */
#ifndef DYNAMICS_H
#define DYNAMICS_H

#include "inertia.h"

/* Mesh torque, link 2 unaccelerated: F = k (k G alpha1 + G' q'^2 / 2 + B alpha1 - I' omega1^2 / 2). */
static inline double free_torque(const struct mechanism *d, double omega1, double alpha1, double rate_q,
                                 const struct inertia *r)
{
    double k = d->k;
    return k * ((k * r->g + r->b) * alpha1 + 0.5 * r->g1 * rate_q * rate_q - 0.5 * r->i1 * omega1 * omega1);
}

/* dF/dt with alpha1 constant. */
static inline double free_torque_rate(const struct mechanism *d, double omega1, double alpha1, double rate_q,
                                      double rate2_q, const struct inertia *r)
{
    double k = d->k;
    return k * ((k * r->g1 + r->b1) * rate_q * alpha1 + 0.5 * r->g2 * rate_q * rate_q * rate_q +
                r->g1 * rate_q * rate2_q - 0.5 * r->i2 * rate_q * omega1 * omega1 - r->i1 * omega1 * alpha1);
}

/* Upper bound of |F| at these speeds: what a torque is to be called zero against. */
static inline double torque_scale(const struct mechanism *d, double omega1, double alpha1, double rate_q)
{
    return 0.5 * (d->g_slope * rate_q * rate_q + d->i_slope * omega1 * omega1) + d->alpha_slope * fabs(alpha1);
}

struct motion {
    double alpha2, drive, clutch, mesh; /* omega2', M1, Tc, M2 */
};

/* Link 2 carries shaft_inertia against shaft_torque. */
static inline struct motion motion(const struct mechanism *d, double q, double omega1, double alpha1,
                                   double omega2, double shaft_inertia, double shaft_torque)
{
    struct inertia r = reduced_inertia(d, q);
    double k = d->k;
    double rate_q = k * (omega1 - omega2);
    double free = free_torque(d, omega1, alpha1, rate_q, &r);
    double alpha2 = (free - shaft_torque) / (d->j2 + k * k * r.g + shaft_inertia);
    double mesh = free - k * k * r.g * alpha2;
    double rate2_q = k * (alpha1 - alpha2);
    double drive =
        (d->j1 + r.i) * alpha1 + r.i1 * rate_q * omega1 + r.b * rate2_q + r.b1 * rate_q * rate_q + mesh;
    return (struct motion){alpha2, drive, shaft_torque + shaft_inertia * alpha2, mesh};
}

/* The same with link 2 held. */
static inline struct motion held_motion(const struct mechanism *d, double q, double omega1, double alpha1)
{
    struct inertia r = reduced_inertia(d, q);
    double rate_q = d->k * omega1;
    double rate2_q = d->k * alpha1;
    double mesh = d->k * (r.g * rate2_q + 0.5 * r.g1 * rate_q * rate_q + r.b * alpha1 -
                          0.5 * r.i1 * omega1 * omega1);
    double drive =
        (d->j1 + r.i) * alpha1 + r.i1 * rate_q * omega1 + r.b * rate2_q + r.b1 * rate_q * rate_q + mesh;
    return (struct motion){0.0, drive, 0.0, mesh};
}

struct rates {
    double alpha2, jerk2, momentum; /* omega2', omega2'', P */
};

/* Acceleration of link 2 and P, for the inner stages of the integrator. */
static inline struct rates stage_rates(const struct mechanism *d, double q, double omega1, double alpha1,
                                       double omega2, double shaft_inertia, double shaft_torque)
{
    struct inertia r = reduced_inertia(d, q);
    double k = d->k;
    double rate_q = k * (omega1 - omega2);
    double free = free_torque(d, omega1, alpha1, rate_q, &r);
    double momentum = (d->j1 + r.i) * omega1 + r.b * rate_q + d->j2 * omega2;
    return (struct rates){(free - shaft_torque) / (d->j2 + k * k * r.g + shaft_inertia), 0.0, momentum};
}

/* The same with omega2''. */
static inline struct rates motion_rates(const struct mechanism *d, double q, double omega1, double alpha1,
                                        double omega2, double shaft_inertia, double shaft_torque)
{
    struct inertia r = reduced_inertia(d, q);
    double k = d->k;
    double rate_q = k * (omega1 - omega2);
    double inertia = d->j2 + k * k * r.g + shaft_inertia;
    double alpha2 = (free_torque(d, omega1, alpha1, rate_q, &r) - shaft_torque) / inertia;
    double rate = free_torque_rate(d, omega1, alpha1, rate_q, k * (alpha1 - alpha2), &r);
    double momentum = (d->j1 + r.i) * omega1 + r.b * rate_q + d->j2 * omega2;
    return (struct rates){alpha2, (rate - alpha2 * k * k * r.g1 * rate_q) / inertia, momentum};
}

static inline double angular_momentum(const struct mechanism *d, double q, double omega1, double omega2)
{
    struct inertia r = reduced_inertia(d, q);
    return (d->j1 + r.i) * omega1 + r.b * d->k * (omega1 - omega2) + d->j2 * omega2;
}

/* J1 + I + 2 k B + k^2 G: what the input shaft turns while link 2 is held. */
static inline double held_inertia(const struct mechanism *d, double q)
{
    struct inertia r = reduced_inertia(d, q);
    return d->j1 + r.i + 2.0 * d->k * r.b + d->k * d->k * r.g;
}

static inline double kinetic_energy(const struct mechanism *d, double q, double omega1, double omega2,
                                    double omega3)
{
    struct inertia r = reduced_inertia(d, q);
    double rate_q = d->k * (omega1 - omega2);
    return 0.5 * (d->j1 + r.i) * omega1 * omega1 + r.b * omega1 * rate_q + 0.5 * r.g * rate_q * rate_q +
           0.5 * d->j2 * omega2 * omega2 + 0.5 * d->j3 * omega3 * omega3;
}

#endif
