/* Outputs and locals at the present instant, in the kernel's array y. */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include "dynamics.h"

struct vector {
    double x, y, z;
};

/* Imbalance 0 in the frame of link 1: position and its derivatives in q. */
struct imbalance {
    struct vector r, r1, r2;
};

static inline struct imbalance imbalance(const struct mechanism *d, double q)
{
    double s = d->s;
    double sin_a = sin(q + d->phase_a);
    double cos_a = cos(q + d->phase_a);
    if (d->planar) {
        double y = d->radial * sin_a;
        double z = d->radial * cos_a;
        return (struct imbalance){{0.0, y, d->axial - z}, {0.0, z, y}, {0.0, -y, z}};
    }
    double sin_b = sin(s * q + d->phase_b);
    double cos_b = cos(s * q + d->phase_b);
    double radial = d->radial - d->radial_cos * cos_b;
    double tangential = -d->arm * sin_b;
    double radial1 = s * d->radial_cos * sin_b;
    double tangential1 = -s * d->arm * cos_b;
    double radial2 = s * s * d->radial_cos * cos_b;
    double tangential2 = s * s * d->arm * sin_b;
    /* components along and across the turning drive, differentiated with it */
    double along1 = radial1 - tangential;
    double across1 = tangential1 + radial;
    double along2 = radial2 - 2.0 * tangential1 - radial;
    double across2 = tangential2 + 2.0 * radial1 - tangential;
    return (struct imbalance){
        {radial * cos_a - tangential * sin_a, radial * sin_a + tangential * cos_a,
         d->axial - d->axial_cos * cos_b},
        {along1 * cos_a - across1 * sin_a, along1 * sin_a + across1 * cos_a, s * d->axial_cos * sin_b},
        {along2 * cos_a - across2 * sin_a, along2 * sin_a + across2 * cos_a, s * s * d->axial_cos * cos_b}};
}

/* Turn a vector of the frame of link 1 about the central axis Ox and write it at y. */
static inline void write_in_fixed_frame(double *y, double sine, double cosine, struct vector v)
{
    y[0] = v.x;
    y[1] = v.y * cosine - v.z * sine;
    y[2] = v.y * sine + v.z * cosine;
}

/* Position, velocity and acceleration of imbalance 0 of module 0 in the fixed frame. */
static void write_imbalance(const struct mechanism *d, const struct state *x, double *y, double alpha2)
{
    double omega1 = x->omega1;
    double alpha1 = x->alpha1;
    double rate_q = d->k * (omega1 - x->omega2.value);
    double rate2_q = d->k * (alpha1 - alpha2);
    double sine = sin(x->theta1.value);
    double cosine = cos(x->theta1.value);
    struct imbalance m = imbalance(d, x->q.value);
    write_in_fixed_frame(y + Y_IMBALANCE_X, sine, cosine, m.r);
    write_in_fixed_frame(y + Y_IMBALANCE_VELOCITY_X, sine, cosine,
                         (struct vector){m.r1.x * rate_q, m.r1.y * rate_q - omega1 * m.r.z,
                                         m.r1.z * rate_q + omega1 * m.r.y});
    double square = rate_q * rate_q;
    double coriolis = 2.0 * omega1 * rate_q;
    double central = omega1 * omega1;
    double *a = y + Y_IMBALANCE_ACCELERATION_X;
    write_in_fixed_frame(a, sine, cosine,
                         (struct vector){m.r2.x * square + m.r1.x * rate2_q,
                                         m.r2.y * square + m.r1.y * rate2_q - coriolis * m.r1.z -
                                             alpha1 * m.r.z - central * m.r.y,
                                         m.r2.z * square + m.r1.z * rate2_q + coriolis * m.r1.y +
                                             alpha1 * m.r.y - central * m.r.z});
    y[Y_IMBALANCE_ACCELERATION] = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Instantaneous torques in the present mode. Returns the acceleration of link 2. */
static double write_torques(const struct mechanism *d, const struct state *x, double *y)
{
    double q = x->q.value;
    double load = x->load_torque;
    struct motion m;
    double housing = 0.0;
    if (x->mode == DRIVING) {
        m = motion(d, q, x->omega1, x->alpha1, x->omega2.value, d->j3, load);
    } else if (x->mode == FREE) {
        m = motion(d, q, x->omega1, x->alpha1, x->omega2.value, 0.0, 0.0);
    } else {
        m = held_motion(d, q, x->omega1, x->alpha1);
        m.clutch = x->mode == HELD_DRIVING ? load : 0.0;
        housing = m.clutch - m.mesh;
    }
    y[Y_INPUT_TORQUE] = m.drive;
    y[Y_MESH_TORQUE] = m.mesh;
    y[Y_OUTPUT_TORQUE] = x->mode == FREE ? 0.0 : m.clutch;
    y[Y_HOUSING_TORQUE] = housing;
    return m.alpha2;
}

static double stored_energy(const struct mechanism *d, const struct state *x)
{
    return kinetic_energy(d, x->q.value, x->omega1, x->omega2.value, x->omega3.value);
}

static void write_outputs(const struct mechanism *d, const struct state *x, double *y, bool imbalance)
{
    y[Y_OMEGA2] = x->omega2.value;
    y[Y_OMEGA_OUT] = x->omega3.value;
    y[Y_INPUT_SPEED] = x->omega1;
    y[Y_OMEGA_HUB] = x->omega3.value;
    y[Y_SHAFT_TWIST] = 0.0;
    y[Y_INPUT_TORQUE_MEAN] = x->input_torque_mean;
    y[Y_OUTPUT_TORQUE_MEAN] = x->output_torque_mean;
    y[Y_TORQUE_RIPPLE] = x->torque_ripple;
    y[Y_TORQUE_PEAK] = x->torque_peak;
    y[Y_DRIVE_ANGLE] = x->q.value;
    y[Y_DRIVE_TURNS] = x->drive_turns;
    y[Y_INPUT_ANGLE] = x->theta1.value;
    y[Y_INPUT_TURNS] = x->input_turns;
    y[Y_CONTACT_MODE] = x->mode;
    y[Y_CONTACT_SWITCHES] = (double)x->switches;
    y[Y_RHS_EVALUATIONS] = (double)x->evaluations;
    double stored = stored_energy(d, x);
    y[Y_ENERGY_IN] = x->energy_in.value;
    y[Y_ENERGY_OUT] = x->energy_out.value;
    y[Y_ENERGY_STORED] = stored;
    y[Y_ENERGY_LOST] = 0.0;
    y[Y_ENERGY_RESIDUAL] = x->energy_in.value - x->energy_out.value - (stored - x->energy_start);
    double alpha2 = write_torques(d, x, y);
    if (imbalance)
        write_imbalance(d, x, y, alpha2);
}

#endif
