/* The motion of scene R1 written by hand: a yardstick for the speed of the kernel (see by_hand.py).

   Freewheels by events: Dormand and Prince's fifth order with its dense output where link 2 moves, the
   zero of the held torque where it rests. The speed of link 1 and the load (above 0) are constant, there is
   one imbalance, and nothing is computed but the motion: no torques, energies, means or checks. */
#include <math.h>

struct mechanism {
    double k, s, mass, phase_a, phase_b, radial, radial_cos, arm, axial, axial_cos;
    double pole_offset, pole_arm, spin, J2, J3, J16, harmonic, omega1, load;
};

enum { HELD, HELD_DRIVING, FREE, DRIVING };

struct state {
    double q, omega2, omega3, step, mode, switches, evaluations;
};

/* phase of the highest harmonic in a step, rad: between its ends a guard is looked at once */
#define PHASE 1.0
#define HELD_PHASE 0.3
#define SWITCHES_ALLOWED 1000000

struct point {
    double q, omega2;
};

/* G, and the torque on link 2 while it is not accelerated, at the rate q' of the drive. */
static double free_torque(const struct mechanism *m, double q, double rate_q, double *inertia)
{
    const double half = 0.5 * (m->s * q + m->phase_b), a = q + m->phase_a;
    const double sin_half = sin(half), cos_half = cos(half), sin_a = sin(a), cos_a = cos(a);
    const double sin_b = 2.0 * sin_half * cos_half, versed = 2.0 * sin_half * sin_half, cos_b = 1.0 - versed;
    const double pole = m->pole_offset + m->pole_arm * versed;
    const double g = m->mass * (m->spin * sin_b * sin_b + pole * pole) + m->J16;
    const double g1 = 2.0 * m->mass * m->s * sin_b * (m->spin * cos_b + pole * m->pole_arm);
    const double z = m->axial - m->axial_cos * cos_b, z1 = m->s * m->axial_cos * sin_b;
    const double radial = m->radial - m->radial_cos * cos_b, radial1 = m->s * m->radial_cos * sin_b;
    const double tangential = -m->arm * sin_b, tangential1 = -m->s * m->arm * cos_b;
    const double y = radial * sin_a + tangential * cos_a;
    const double y1 = (radial1 - tangential) * sin_a + (tangential1 + radial) * cos_a;
    const double i1 = 2.0 * m->mass * (y * y1 + z * z1);
    *inertia = m->J2 + m->k * m->k * g;
    return 0.5 * m->k * (g1 * rate_q * rate_q - i1 * m->omega1 * m->omega1);
}

static struct point rates(const struct mechanism *m, struct state *x, struct point y)
{
    double inertia;
    const double rate_q = m->k * (m->omega1 - y.omega2);
    const double torque = free_torque(m, y.q, rate_q, &inertia);
    x->evaluations += 1.0;
    if (x->mode == DRIVING)
        return (struct point){rate_q, (torque - m->load) / (inertia + m->J3)};
    return (struct point){rate_q, torque / inertia};
}

/* --- link 2 moves --- */

struct step {
    struct point y0, difference, k[7], dense[3];
    double h, omega3;
};

static struct point along(const struct step *s, double part)
{
    const double rest = 1.0 - part;
#define AT(f) s->y0.f + part * (s->difference.f + rest * (s->dense[0].f + part * (s->dense[1].f + rest * s->dense[2].f)))
    return (struct point){AT(q), AT(omega2)};
}

/* The smallest of what has to stay positive while the mode goes on: omega2, and the output freewheel's. */
static double guard(const struct mechanism *m, struct state *x, const struct step *s, double part)
{
    const struct point y = along(s, part);
    const double output = x->mode == FREE ? s->omega3 - m->load / m->J3 * part * s->h - y.omega2
                                          : m->load + m->J3 * rates(m, x, y).omega2;
    return fmin(y.omega2, output);
}

/* Where the guard falls through zero between two parts of a step (false position of Dowell and Jarratt). */
static double crossing(const struct mechanism *m, struct state *x, const struct step *s, double low, double high)
{
    double at_low = guard(m, x, s, low), at_high = guard(m, x, s, high);
    for (int n = 0; n < 60 && high - low > 1e-14; n++) {
        const double part = (low * at_high - high * at_low) / (at_high - at_low), at = guard(m, x, s, part);
        if ((at < 0.0) == (at_high < 0.0)) {
            high = part;
            at_high = at;
            at_low *= 0.5;
        } else {
            low = part;
            at_low = at;
            at_high *= 0.5;
        }
        if (at == 0.0)
            return part;
    }
    return high;
}

/* One step of at most h with the rates at its beginning in k[0]. Returns how far the error is above one. */
static double try_step(const struct mechanism *m, struct state *x, struct step *s, double h, double tolerance)
{
    static const double a[6][6] = {
        {1.0 / 5},
        {3.0 / 40, 9.0 / 40},
        {44.0 / 45, -56.0 / 15, 32.0 / 9},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
        {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
    static const double e[7] = {71.0 / 57600, 0.0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
    static const double d[7] = {-12715105075.0 / 11282082432, 0.0, 87487479700.0 / 32700410799,
                                -10690763975.0 / 1880347072, 701980252875.0 / 199316789632,
                                -1453857185.0 / 822651844, 69997945.0 / 29380423};
    struct point y = s->y0, error = {0.0, 0.0}, bent = {0.0, 0.0};
    for (int stage = 0; stage < 6; stage++) {
        y = s->y0;
        for (int n = 0; n <= stage; n++) {
            y.q += h * a[stage][n] * s->k[n].q;
            y.omega2 += h * a[stage][n] * s->k[n].omega2;
        }
        s->k[stage + 1] = rates(m, x, y);
    }
    for (int n = 0; n < 7; n++) {
        error.q += h * e[n] * s->k[n].q;
        error.omega2 += h * e[n] * s->k[n].omega2;
        bent.q += h * d[n] * s->k[n].q;
        bent.omega2 += h * d[n] * s->k[n].omega2;
    }
    s->h = h;
    s->omega3 = x->omega3;
#define DENSE(f)                                              \
    s->difference.f = y.f - s->y0.f;                          \
    s->dense[0].f = h * s->k[0].f - s->difference.f;          \
    s->dense[1].f = s->difference.f - h * s->k[6].f - s->dense[0].f; \
    s->dense[2].f = bent.f
    DENSE(q);
    DENSE(omega2);
    return fmax(fabs(error.q), fabs(error.omega2) / fabs(m->omega1)) / tolerance;
}

static void switch_to(struct state *x, int mode)
{
    x->mode = mode;
    x->switches += 1.0;
}

/* Move up to the time left or to an event, s. Returns the time it took. */
static double move(const struct mechanism *m, struct state *x, double left, double tolerance)
{
    struct step s = {.y0 = {x->q, x->omega2}};
    const double fastest = m->harmonic * m->k * (fabs(m->omega1) + fabs(x->omega2));
    s.k[0] = rates(m, x, s.y0);
    for (double passed = 0.0;;) {
        const double longest = fmin(x->step, PHASE / fastest), h = fmin(longest, left - passed);
        const double error = try_step(m, x, &s, h, tolerance);
        if (error > 1.0) {
            x->step = h * fmax(0.2, 0.9 * pow(error, -0.2));
            continue;
        }
        if (h == x->step || error > 0.3)
            x->step = h * fmin(5.0, 0.9 * pow(error + 1e-10, -0.2));
        const int half = guard(m, x, &s, 0.5) < 0.0, whole = half || guard(m, x, &s, 1.0) < 0.0;
        const double part = !whole ? 1.0 : half ? crossing(m, x, &s, 0.0, 0.5) : crossing(m, x, &s, 0.5, 1.0);
        const struct point y = along(&s, part);
        passed += part * h;
        x->q = y.q;
        x->omega2 = y.omega2;
        x->omega3 = x->mode == DRIVING ? y.omega2 : s.omega3 - m->load / m->J3 * part * h;
        if (whole) {
            const int stops = y.omega2 <= 1e-9 * fabs(m->omega1);
            if (x->mode == DRIVING) {
                if (stops)
                    x->omega2 = x->omega3 = 0.0;
                switch_to(x, stops ? HELD_DRIVING : FREE);
            } else if (stops) {
                x->omega2 = 0.0;
                switch_to(x, HELD);
            } else {
                x->omega2 = x->omega3;
                switch_to(x, DRIVING);
            }
            return passed;
        }
        if (passed >= left)
            return left;
        s.y0 = y;
        s.k[0] = s.k[6];
    }
}

/* --- link 2 rests --- */

static double held(const struct mechanism *m, struct state *x, double q)
{
    double inertia;
    x->evaluations += 1.0;
    return free_torque(m, q, m->k * m->omega1, &inertia) - (x->mode == HELD_DRIVING ? m->load : 0.0);
}

/* Rest up to the time left or until the torque releases link 2 or the shaft stops. Returns the time it took. */
static double rest(const struct mechanism *m, struct state *x, double left)
{
    const double rate = m->k * m->omega1, slowing = m->load / m->J3;
    const double until = x->mode == HELD ? fmin(left, x->omega3 / slowing) : left;
    const double pace = HELD_PHASE / (m->harmonic * fabs(rate));
    double low = 0.0, at_low = held(m, x, x->q), passed = until;
    int released = 0;
    while (low < until && !released) {
        double high = fmin(low + pace, until), at_high = held(m, x, x->q + rate * high);
        if (at_high > 0.0) {
            released = 1;
            for (int n = 0; n < 60 && high - low > 1e-16 && at_low < 0.0; n++) {
                const double time = (low * at_high - high * at_low) / (at_high - at_low);
                const double at = held(m, x, x->q + rate * time);
                if (at > 0.0) {
                    high = time;
                    at_high = at;
                    at_low *= 0.5;
                } else {
                    low = time;
                    at_low = at;
                    at_high *= 0.5;
                }
            }
            passed = high;
        }
        low = high;
        at_low = at_high;
    }
    x->q += rate * passed;
    if (x->mode == HELD)
        x->omega3 = passed == x->omega3 / slowing ? 0.0 : x->omega3 - slowing * passed;
    if (released)
        switch_to(x, x->mode == HELD ? FREE : DRIVING);
    else if (x->mode == HELD && x->omega3 == 0.0)
        switch_to(x, HELD_DRIVING);
    return passed;
}

/* Communication steps of h seconds. Returns 0, or 1 where there are events without end. */
int run(const struct mechanism *m, struct state *x, double tolerance, double h, long steps)
{
    for (long n = 0; n < steps; n++)
        for (double left = h; left > 0.0;) {
            left -= x->mode == FREE || x->mode == DRIVING ? move(m, x, left, tolerance) : rest(m, x, left);
            if (x->switches > SWITCHES_ALLOWED)
                return 1;
        }
    return 0;
}
