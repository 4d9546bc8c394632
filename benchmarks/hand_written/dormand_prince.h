/* Dormand and Prince's embedded pair 8(5,3) with dense output of order 7, for (q, omega2). */
#ifndef DORMAND_PRINCE_H
#define DORMAND_PRINCE_H

#include "dormand_prince_table.h"
#include "dynamics.h"

/* Mean over the step, of order 8, of the quantity whose stages are r. */
static inline double result(const double *r)
{
    return B1 * r[0] + B6 * r[1] + B7 * r[2] + B8 * r[3] + B9 * r[4] + B10 * r[5] + B11 * r[6] + B12 * r[7];
}

static inline double error_5(const double *r)
{
    return ERR5_1 * r[0] + ERR5_6 * r[1] + ERR5_7 * r[2] + ERR5_8 * r[3] + ERR5_9 * r[4] + ERR5_10 * r[5] +
           ERR5_11 * r[6] + ERR5_12 * r[7];
}

static inline double error_3(const double *r)
{
    return ERR3_1 * r[0] + ERR3_6 * r[1] + ERR3_7 * r[2] + ERR3_8 * r[3] + ERR3_9 * r[4] + ERR3_10 * r[5] +
           ERR3_11 * r[6] + ERR3_12 * r[7];
}

/* Rates at a stage, and what is kept of them. */
static inline struct rates rates_at(const struct mechanism *d, const struct step *w, double node, double q,
                                    double omega2)
{
    double omega1 = w->omega1 + node * w->h * w->alpha1;
    return stage_rates(d, q, omega1, w->alpha1, omega2, w->shaft_inertia, w->shaft_torque);
}

static inline double drive_rate(const struct mechanism *d, const struct step *w, double node, double omega2)
{
    return d->k * (w->omega1 + node * w->h * w->alpha1 - omega2);
}

static inline void keep(struct step *w, int stage, double rate_q, const struct rates *rates)
{
    w->rate_q[stage] = rate_q;
    w->rate_omega2[stage] = rates->alpha2;
    w->momentum[stage] = rates->momentum;
}

/* The twelve stages of the step in hand from (q, omega2); start holds omega2' and P there.
   u is q', v omega2'. */
static void stages(const struct mechanism *d, struct step *w, double q, double omega2,
                   const struct rates *start)
{
    double h = w->h;
    struct rates r;
    double u1 = d->k * (w->omega1 - omega2);
    double v1 = start->alpha2;
    keep(w, 0, u1, start);

    double y = omega2 + h * (A2_1 * v1);
    double u2 = drive_rate(d, w, C2, y);
    double v2 = rates_at(d, w, C2, q + h * (A2_1 * u1), y).alpha2;

    y = omega2 + h * (A3_1 * v1 + A3_2 * v2);
    double u3 = drive_rate(d, w, C3, y);
    double v3 = rates_at(d, w, C3, q + h * (A3_1 * u1 + A3_2 * u2), y).alpha2;

    y = omega2 + h * (A4_1 * v1 + A4_3 * v3);
    double u4 = drive_rate(d, w, C4, y);
    double v4 = rates_at(d, w, C4, q + h * (A4_1 * u1 + A4_3 * u3), y).alpha2;

    y = omega2 + h * (A5_1 * v1 + A5_3 * v3 + A5_4 * v4);
    double u5 = drive_rate(d, w, C5, y);
    double v5 = rates_at(d, w, C5, q + h * (A5_1 * u1 + A5_3 * u3 + A5_4 * u4), y).alpha2;

    y = omega2 + h * (A6_1 * v1 + A6_4 * v4 + A6_5 * v5);
    double u6 = drive_rate(d, w, C6, y);
    r = rates_at(d, w, C6, q + h * (A6_1 * u1 + A6_4 * u4 + A6_5 * u5), y);
    double v6 = r.alpha2;
    keep(w, 1, u6, &r);

    y = omega2 + h * (A7_1 * v1 + A7_4 * v4 + A7_5 * v5 + A7_6 * v6);
    double u7 = drive_rate(d, w, C7, y);
    r = rates_at(d, w, C7, q + h * (A7_1 * u1 + A7_4 * u4 + A7_5 * u5 + A7_6 * u6), y);
    double v7 = r.alpha2;
    keep(w, 2, u7, &r);

    y = omega2 + h * (A8_1 * v1 + A8_4 * v4 + A8_5 * v5 + A8_6 * v6 + A8_7 * v7);
    double u8 = drive_rate(d, w, C8, y);
    r = rates_at(d, w, C8, q + h * (A8_1 * u1 + A8_4 * u4 + A8_5 * u5 + A8_6 * u6 + A8_7 * u7), y);
    double v8 = r.alpha2;
    keep(w, 3, u8, &r);

    y = omega2 + h * (A9_1 * v1 + A9_4 * v4 + A9_5 * v5 + A9_6 * v6 + A9_7 * v7 + A9_8 * v8);
    double x = q + h * (A9_1 * u1 + A9_4 * u4 + A9_5 * u5 + A9_6 * u6 + A9_7 * u7 + A9_8 * u8);
    double u9 = drive_rate(d, w, C9, y);
    r = rates_at(d, w, C9, x, y);
    double v9 = r.alpha2;
    keep(w, 4, u9, &r);

    y = omega2 +
        h * (A10_1 * v1 + A10_4 * v4 + A10_5 * v5 + A10_6 * v6 + A10_7 * v7 + A10_8 * v8 + A10_9 * v9);
    x = q + h * (A10_1 * u1 + A10_4 * u4 + A10_5 * u5 + A10_6 * u6 + A10_7 * u7 + A10_8 * u8 + A10_9 * u9);
    double u10 = drive_rate(d, w, C10, y);
    r = rates_at(d, w, C10, x, y);
    double v10 = r.alpha2;
    keep(w, 5, u10, &r);

    y = omega2 + h * (A11_1 * v1 + A11_4 * v4 + A11_5 * v5 + A11_6 * v6 + A11_7 * v7 + A11_8 * v8 +
                      A11_9 * v9 + A11_10 * v10);
    x = q + h * (A11_1 * u1 + A11_4 * u4 + A11_5 * u5 + A11_6 * u6 + A11_7 * u7 + A11_8 * u8 + A11_9 * u9 +
                 A11_10 * u10);
    double u11 = drive_rate(d, w, C11, y);
    r = rates_at(d, w, C11, x, y);
    double v11 = r.alpha2;
    keep(w, 6, u11, &r);

    y = omega2 + h * (A12_1 * v1 + A12_4 * v4 + A12_5 * v5 + A12_6 * v6 + A12_7 * v7 + A12_8 * v8 +
                      A12_9 * v9 + A12_10 * v10 + A12_11 * v11);
    x = q + h * (A12_1 * u1 + A12_4 * u4 + A12_5 * u5 + A12_6 * u6 + A12_7 * u7 + A12_8 * u8 + A12_9 * u9 +
                 A12_10 * u10 + A12_11 * u11);
    r = rates_at(d, w, 1.0, x, y);
    keep(w, 7, drive_rate(d, w, 1.0, y), &r);
}

/* Estimated error of the step over the allowed one (Hairer's mix of orders 5 and 3). scale_momentum
   allows an error of the integral of P, which counts only with a ramp of omega1 (else 0). */
static double error_norm(const struct step *w, double scale_q, double scale_omega2, double scale_momentum)
{
    double q5 = error_5(w->rate_q) / scale_q;
    double q3 = error_3(w->rate_q) / scale_q;
    double v5 = error_5(w->rate_omega2) / scale_omega2;
    double v3 = error_3(w->rate_omega2) / scale_omega2;
    double sum5 = q5 * q5 + v5 * v5;
    double sum3 = q3 * q3 + v3 * v3;
    if (scale_momentum > 0.0) {
        double p5 = error_5(w->momentum) / scale_momentum;
        double p3 = error_3(w->momentum) / scale_momentum;
        sum5 += p5 * p5;
        sum3 += p3 * p3;
    }
    double mix = sum5 + 0.01 * sum3;
    return mix == 0.0 ? 0.0 : w->h * sum5 / sqrt(2.0 * mix);
}

static inline double weigh_stage_14(const double *r)
{
    return A14_1 * r[0] + A14_7 * r[2] + A14_8 * r[3] + A14_9 * r[4] + A14_10 * r[5] + A14_11 * r[6] +
           A14_12 * r[7] + A14_13 * r[8];
}

static inline double weigh_stage_15(const double *r)
{
    return A15_1 * r[0] + A15_6 * r[1] + A15_7 * r[2] + A15_8 * r[3] + A15_11 * r[6] + A15_12 * r[7] +
           A15_13 * r[8] + A15_14 * r[9];
}

static inline double weigh_stage_16(const double *r)
{
    return A16_1 * r[0] + A16_6 * r[1] + A16_7 * r[2] + A16_8 * r[3] + A16_9 * r[4] + A16_13 * r[8] +
           A16_14 * r[9] + A16_15 * r[10];
}

static inline void keep_extra_stage(const struct mechanism *d, struct step *w, int stage, double node,
                                    double q, double omega2)
{
    struct rates r = rates_at(d, w, node, q, omega2);
    keep(w, stage, drive_rate(d, w, node, omega2), &r);
}

/* Stages 14 to 16, wanted only where the inside of the step is. */
static void extra_stages(const struct mechanism *d, struct step *w, double q, double omega2)
{
    double h = w->h;
    keep_extra_stage(d, w, STAGE_14, C14, q + h * weigh_stage_14(w->rate_q),
                     omega2 + h * weigh_stage_14(w->rate_omega2));
    keep_extra_stage(d, w, STAGE_15, C15, q + h * weigh_stage_15(w->rate_q),
                     omega2 + h * weigh_stage_15(w->rate_omega2));
    keep_extra_stage(d, w, STAGE_16, C16, q + h * weigh_stage_16(w->rate_q),
                     omega2 + h * weigh_stage_16(w->rate_omega2));
}

/* Seven coefficients of the interpolant of the quantity whose rates are r. */
static void dense_coefficients(double h, const double *restrict r, double *restrict dense)
{
    double change = h * result(r);
    dense[0] = change;
    dense[1] = h * r[0] - change;
    dense[2] = 2.0 * change - h * (r[0] + r[8]);
    dense[3] = h * (D4_1 * r[0] + D4_6 * r[1] + D4_7 * r[2] + D4_8 * r[3] + D4_9 * r[4] + D4_10 * r[5] +
                    D4_11 * r[6] + D4_12 * r[7] + D4_13 * r[8] + D4_14 * r[9] + D4_15 * r[10] + D4_16 * r[11]);
    dense[4] = h * (D5_1 * r[0] + D5_6 * r[1] + D5_7 * r[2] + D5_8 * r[3] + D5_9 * r[4] + D5_10 * r[5] +
                    D5_11 * r[6] + D5_12 * r[7] + D5_13 * r[8] + D5_14 * r[9] + D5_15 * r[10] + D5_16 * r[11]);
    dense[5] = h * (D6_1 * r[0] + D6_6 * r[1] + D6_7 * r[2] + D6_8 * r[3] + D6_9 * r[4] + D6_10 * r[5] +
                    D6_11 * r[6] + D6_12 * r[7] + D6_13 * r[8] + D6_14 * r[9] + D6_15 * r[10] + D6_16 * r[11]);
    dense[6] = h * (D7_1 * r[0] + D7_6 * r[1] + D7_7 * r[2] + D7_8 * r[3] + D7_9 * r[4] + D7_10 * r[5] +
                    D7_11 * r[6] + D7_12 * r[7] + D7_13 * r[8] + D7_14 * r[9] + D7_15 * r[10] + D7_16 * r[11]);
}

/* Change since the beginning of the step at the fraction sigma of it. */
static inline double dense_change(const double *dense, double sigma)
{
    double rest = 1.0 - sigma;
    double y = (dense[5] + sigma * dense[6]) * rest;
    y = (dense[4] + y) * sigma;
    y = (dense[3] + y) * rest;
    y = (dense[2] + y) * sigma;
    y = (dense[1] + y) * rest;
    return (dense[0] + y) * sigma;
}

/* Derivative of dense_change in sigma. */
static inline double dense_rate(const double *dense, double sigma)
{
    double rest = 1.0 - sigma;
    double y = dense[5] + sigma * dense[6];
    double slope = dense[6] * rest - y;
    y = dense[4] + y * rest;
    slope = slope * sigma + y;
    y = dense[3] + y * sigma;
    slope = slope * rest - y;
    y = dense[2] + y * rest;
    slope = slope * sigma + y;
    y = dense[1] + y * sigma;
    slope = slope * rest - y;
    return slope * sigma + dense[0] + y * rest;
}

/* Integral over the step (sigma < 0) or its part sigma of the quantity whose stages are r. */
static double quadrature(double h, const double *r, double sigma)
{
    if (sigma < 0.0)
        return h * result(r);
    double dense[DENSE];
    dense_coefficients(h, r, dense);
    return dense_change(dense, sigma);
}

#endif
