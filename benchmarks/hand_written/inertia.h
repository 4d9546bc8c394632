/* Reduced inertia I, B, G of all imbalances and its exact derivatives in q. */
#ifndef INERTIA_H
#define INERTIA_H

#include "mechanism.h"

/* pi/2 in three parts, the first two of 33 bits: their multiples are exact up to LARGEST_ANGLE */
#define HALF_PI_1 1.5707963267341256
#define HALF_PI_2 6.077100506303966e-11
#define HALF_PI_3 2.0222662487959506e-21
#define QUADRANTS 0.6366197723675814
/* adding and subtracting it rounds to a whole number */
#define ROUNDER 6755399441055744.0
#define LARGEST_ANGLE 1e6

struct circular {
    double sine, cosine;
};

/* (sin x, cos x) where |x| < LARGEST_ANGLE: both Taylor series on |r| <= pi/4, summed in pairs (Estrin) so
   that a processor works on several terms at once; faster than two calls of the library. */
static inline struct circular reduced(double x)
{
    double quadrant = (x * QUADRANTS + ROUNDER) - ROUNDER;
    double r = ((x - quadrant * HALF_PI_1) - quadrant * HALF_PI_2) - quadrant * HALF_PI_3;
    double z = r * r;
    double z2 = z * z;
    double z4 = z2 * z2;
    double odd = (-0.16666666666666666 + z * 0.008333333333333333) +
                 z2 * (-0.0001984126984126984 + z * 2.7557319223985893e-06);
    odd += z4 * ((-2.505210838544172e-08 + z * 1.6059043836821613e-10) +
                 z2 * (-7.647163731819816e-13 + z * 2.8114572543455206e-15));
    double even = (0.041666666666666664 + z * -0.001388888888888889) +
                  z2 * (2.48015873015873e-05 + z * -2.755731922398589e-07);
    even += z4 * ((2.08767569878681e-09 + z * -1.1470745597729725e-11) +
                  z2 * (4.779477332387385e-14 + z * -1.5619206968586225e-16));
    double sine = r + r * z * odd;
    double half = 0.5 * z;
    double whole = 1.0 - half;
    double cosine = whole + (((1.0 - whole) - half) + z2 * even);
    /* two choices of two, which is faster than one of four */
    int turn = (int)quadrant;
    double first = turn & 1 ? cosine : sine;
    double second = turn & 1 ? sine : cosine;
    return (struct circular){turn & 2 ? -first : first, (turn + 1) & 2 ? -second : second};
}

static inline struct circular sine_cosine(double x)
{
    return fabs(x) < LARGEST_ANGLE ? reduced(x) : (struct circular){sin(x), cos(x)};
}

/* Two angles at once: one look at their size. */
static inline void sines_cosines(double x, double y, struct circular *of_x, struct circular *of_y)
{
    if (fabs(x) < LARGEST_ANGLE && fabs(y) < LARGEST_ANGLE) {
        *of_x = reduced(x);
        *of_y = reduced(y);
    } else {
        *of_x = (struct circular){sin(x), cos(x)};
        *of_y = (struct circular){sin(y), cos(y)};
    }
}

/* I, B, G and their derivatives in q. */
struct inertia {
    double i, i1, i2, b, b1, g, g1, g2;
};

static inline struct inertia planar_inertia(const struct mechanism *d, double q)
{
    double swing = d->mass * d->radial * d->axial;
    struct circular a = sine_cosine(q);
    double sine = a.sine * swing;
    double cosine = a.cosine * swing;
    double own = d->mass * d->radial * d->radial + d->j16;
    double fixed = own + d->mass * d->axial * d->axial;
    return (struct inertia){fixed - 2.0 * cosine, 2.0 * sine, 2.0 * cosine, own - cosine, sine, own, 0.0, 0.0};
}

static inline struct inertia bevel_inertia(const struct mechanism *d, double q)
{
    double mass = d->mass;
    double s = d->s;
    double half_b = 0.5 * (s * q + d->phase_b);
    struct circular half, a = {0.0, 0.0};
    if (d->paired)
        sines_cosines(half_b, q + d->phase_a, &half, &a);
    else
        half = sine_cosine(half_b);
    double sin_b = 2.0 * half.sine * half.cosine;
    double versed = 2.0 * half.sine * half.sine; /* 1 - cos B, without cancellation at the rolling pole */
    double cos_b = 1.0 - versed;
    double pole = d->pole_offset + d->pole_arm * versed;
    double swing = d->pole_arm * sin_b;
    struct inertia r;
    r.g = mass * (d->spin * sin_b * sin_b + pole * pole) + d->j16;
    r.g1 = 2.0 * mass * s * sin_b * (d->spin * cos_b + pole * d->pole_arm);
    r.g2 = 2.0 * mass * s * s *
           (d->spin * (cos_b * cos_b - sin_b * sin_b) + swing * swing + pole * d->pole_arm * cos_b);

    double z = d->axial - d->axial_cos * cos_b;
    double z1 = s * d->axial_cos * sin_b;
    double z2 = s * s * d->axial_cos * cos_b;
    double radial = d->radial - d->radial_cos * cos_b;
    double tangential = -d->arm * sin_b;
    double radial1 = s * d->radial_cos * sin_b;
    double tangential1 = -s * d->arm * cos_b;
    double radial2 = s * s * d->radial_cos * cos_b;
    double tangential2 = s * s * d->arm * sin_b;
    r.b = 0.0;
    r.b1 = 0.0;
    if (!d->paired) {
        r.i = mass * (0.5 * (radial * radial + tangential * tangential) + z * z);
        r.i1 = mass * (radial * radial1 + tangential * tangential1 + 2.0 * z * z1);
        r.i2 = mass * (radial1 * radial1 + radial * radial2 + tangential1 * tangential1 +
                       tangential * tangential2 + 2.0 * (z1 * z1 + z * z2));
        return r;
    }
    double y = radial * a.sine + tangential * a.cosine;
    double y1 = (radial1 - tangential) * a.sine + (tangential1 + radial) * a.cosine;
    double y2 = (radial2 - 2.0 * tangential1 - radial) * a.sine +
                (tangential2 + 2.0 * radial1 - tangential) * a.cosine;
    r.i = mass * (y * y + z * z);
    r.i1 = 2.0 * mass * (y * y1 + z * z1);
    r.i2 = 2.0 * mass * (y1 * y1 + y * y2 + z1 * z1 + z * z2);
    if (d->single) {
        r.b = mass * (y * z1 - z * y1);
        r.b1 = mass * (y * z2 - z * y2);
    }
    return r;
}

static inline struct inertia reduced_inertia(const struct mechanism *d, double q)
{
    return d->planar ? planar_inertia(d, q) : bevel_inertia(d, q);
}

#endif
