/* What the functions share: the constants of a mechanism, its state, and the step in hand. */
#ifndef MECHANISM_H
#define MECHANISM_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "accumulate.h"
#include "slots.h" /* numbers of the kernel's slots, modes and status codes: written by hand_written.py */

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

static inline double smaller(double a, double b)
{
    return a < b ? a : b;
}

/* Constants derived from the parameters, as in the kernel's derive.py. */
struct mechanism {
    double k, s, mass, phase_a, phase_b, radial, radial_cos, arm, axial, axial_cos;
    double pole_offset, pole_arm, spin;
    double period, period_low, period_turns;
    double harmonic, g_slope, i_slope, alpha_slope;
    double j1, j2, j3, j16, tolerance, max_step;
    bool planar, single, paired, housing, output, input_hold;
};

struct state {
    struct sum q, theta1, omega2, omega3, energy_in, energy_out;
    double drive_turns, input_turns, omega1, alpha1, held_input, held_step, load_torque, step_size;
    double energy_start, input_torque_mean, output_torque_mean, torque_ripple, torque_peak;
    double input_impulse, output_impulse, output_square; /* sums over the communication step in hand */
    int64_t switches, evaluations, step_switches, step_evaluations;
    int mode;
};

/* An instance. */
struct module {
    struct mechanism d;
    struct state x;
};

/* Stages are kept in the order 1, 6 to 12, the end of the step, 14 to 16. */
enum { END_STAGE = 8, STAGE_14 = 9, STAGE_15 = 10, STAGE_16 = 11, KEPT_STAGES = 12, DENSE = 7 };

/* The step of the integrator in hand. */
struct step {
    double rate_q[KEPT_STAGES], rate_omega2[KEPT_STAGES], momentum[KEPT_STAGES];
    double dense_q[DENSE], dense_omega2[DENSE];
    double omega1, alpha1, load, h, shaft_inertia, shaft_torque;
};

static inline void wrap_drive_angle(const struct mechanism *d, struct state *x)
{
    if (!(0.0 <= x->q.value && x->q.value < d->period))
        x->drive_turns += d->period_turns * wrap(&x->q, d->period, d->period_low);
}

static inline void wrap_input_angle(struct state *x)
{
    if (!(0.0 <= x->theta1.value && x->theta1.value < TWO_PI))
        x->input_turns += wrap(&x->theta1, TWO_PI, TWO_PI_LOW);
}

#endif
