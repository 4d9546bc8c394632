/* Fidelity rigid, method event, written by hand in C: what the compiled kernel is measured against.
   The functions have the names and the algorithm of the kernel's; the numbers live in structs and locals. */
#include <stddef.h>

#include "outputs.h"
#include "pulse.h"

#define LARGEST_SPEED 1e6
#define LARGEST_TORQUE 1e12
#define SMALLEST_SPEED 1e-150
#define LARGEST_STEP 1e6
#define MAX_EVALUATIONS 50000000
#define SWITCHES_PER_PULSE 64.0
#define SWITCHES_ALLOWED 1000.0
#define STALLS_ALLOWED 100

/* The constants, from the kernel's array of them. */
static struct mechanism take_mechanism(const double *p, const double *d)
{
    return (struct mechanism){
        .k = d[D_K],
        .s = d[D_S],
        .mass = d[D_MASS],
        .phase_a = d[D_PHASE_A],
        .phase_b = d[D_PHASE_B],
        .radial = d[D_RADIAL],
        .radial_cos = d[D_RADIAL_COS],
        .arm = d[D_ARM],
        .axial = d[D_AXIAL],
        .axial_cos = d[D_AXIAL_COS],
        .pole_offset = d[D_POLE_OFFSET],
        .pole_arm = d[D_POLE_ARM],
        .spin = d[D_SPIN],
        .period = d[D_PERIOD],
        .period_low = d[D_PERIOD_LOW],
        .period_turns = d[D_PERIOD_TURNS],
        .harmonic = d[D_HARMONIC],
        .g_slope = d[D_G_SLOPE],
        .i_slope = d[D_I_SLOPE],
        .alpha_slope = d[D_ALPHA_SLOPE],
        .j1 = d[D_J1],
        .j2 = d[D_J2],
        .j3 = d[D_J3],
        .j16 = d[D_J16],
        .tolerance = d[D_TOLERANCE],
        .max_step = d[D_MAX_STEP],
        .planar = d[D_PLANAR] != 0.0,
        .single = d[D_SINGLE] != 0.0,
        .paired = d[D_PAIRED] != 0.0,
        .housing = d[D_HOUSING] != 0.0,
        .output = d[D_OUTPUT] != 0.0,
        .input_hold = p[P_INPUT_HOLD] != 0.0,
    };
}

static int check_inputs(const double *u)
{
    if (!(fabs(u[U_OMEGA1]) <= LARGEST_SPEED))
        return BAD_OMEGA1;
    if (!(fabs(u[U_LOAD_TORQUE]) <= LARGEST_TORQUE))
        return BAD_LOAD_TORQUE;
    if (!(fabs(u[U_DRIVE_TORQUE]) <= LARGEST_TORQUE))
        return BAD_DRIVE_TORQUE;
    return OK;
}

static double input_speed(const double *u)
{
    return fabs(u[U_OMEGA1]) >= SMALLEST_SPEED ? u[U_OMEGA1] : 0.0;
}

static int start(struct module *m, const double *p, const double *d, const double *u, double *y)
{
    *m = (struct module){.d = take_mechanism(p, d)};
    struct state *x = &m->x;
    x->omega1 = input_speed(u);
    x->held_input = x->omega1;
    x->load_torque = u[U_LOAD_TORQUE];
    x->q.value = p[P_DRIVE_ANGLE_START];
    wrap_drive_angle(&m->d, x);
    x->omega2.value = p[P_OMEGA2_START];
    x->omega3.value = p[P_OMEGA_OUT_START];
    x->mode = select_mode(&m->d, x, x->omega1);
    x->energy_start = stored_energy(&m->d, x);
    write_outputs(&m->d, x, y, true);
    return OK;
}

/* Take the inputs of the coming step and clear its sums. Returns the jump of omega1. */
static double begin(const struct mechanism *d, struct state *x, const double *u, double h)
{
    double omega1 = input_speed(u);
    x->alpha1 = 0.0;
    if (d->input_hold && x->held_step > 0.0)
        x->alpha1 = (omega1 - x->held_input) / x->held_step;
    x->held_input = omega1;
    x->held_step = h;
    x->load_torque = u[U_LOAD_TORQUE];
    x->input_impulse = 0.0;
    x->output_impulse = 0.0;
    x->output_square = 0.0;
    x->torque_peak = 0.0;
    x->step_switches = 0;
    x->step_evaluations = 0;
    return omega1 - x->omega1;
}

/* Choose the contact mode anew and count a switch if it is another. */
static void choose_mode(const struct mechanism *d, struct state *x, double omega1)
{
    int mode = select_mode(d, x, omega1);
    if (mode != x->mode) {
        x->mode = mode;
        x->step_switches += 1;
    }
}

/* Advance link 2 and the output shaft by h from event to event. Returns a status. */
static int run_events(const struct mechanism *d, struct state *x, double h)
{
    double omega1 = x->omega1;
    double alpha1 = x->alpha1;
    double load = x->load_torque;
    struct sum time = {0.0, 0.0};
    double travel = 0.0;
    int stalls = 0;
    choose_mode(d, x, omega1);
    while (time.value < h) {
        double remaining = (h - time.value) - time.low;
        int mode = x->mode;
        double speed = omega1 + alpha1 * time.value;
        struct advance step = mode == HELD || mode == HELD_DRIVING
                                  ? advance_held(d, x, speed, alpha1, load, remaining)
                                  : advance_moving(d, x, speed, alpha1, load, remaining);
        if (step.passed < 0.0)
            return STEP_TOO_SMALL;
        travel += step.passed * d->k * (fabs(speed) + fabs(alpha1) * step.passed + fabs(x->omega2.value));
        wrap_drive_angle(d, x);
        if (step.passed >= remaining)
            time.value = h;
        else
            time = later(time, step.passed);
        if (step.event) {
            choose_mode(d, x, omega1 + alpha1 * time.value);
            stalls = x->mode == mode ? stalls + 1 : 0;
            double allowed = SWITCHES_ALLOWED + SWITCHES_PER_PULSE * d->harmonic * travel;
            if (stalls > STALLS_ALLOWED || (double)x->step_switches > allowed)
                return TOO_MANY_SWITCHES;
        }
        if (x->step_evaluations > MAX_EVALUATIONS)
            return TOO_MUCH_WORK;
    }
    return OK;
}

/* Means over the step, all impulses included, and the angle of link 1. */
static void end(struct state *x, double h, struct impulses jump)
{
    add(&x->theta1, h * (x->omega1 + 0.5 * x->alpha1 * h));
    wrap_input_angle(x);
    x->omega1 += x->alpha1 * h;
    x->input_torque_mean = (jump.input + x->input_impulse) / h;
    x->output_torque_mean = (jump.output + x->output_impulse) / h;
    double mean = x->output_impulse / h;
    double variance = x->output_square / h - mean * mean;
    x->torque_ripple = variance > 0.0 ? sqrt(variance) : 0.0;
    x->switches += x->step_switches;
    x->evaluations += x->step_evaluations;
}

static bool is_finite(const struct state *x)
{
    double motion = (fabs(x->q.value) + fabs(x->theta1.value)) + (fabs(x->omega2.value) + fabs(x->omega3.value));
    double energies = fabs(x->energy_in.value) + fabs(x->energy_out.value);
    double means = fabs(x->input_torque_mean) + (fabs(x->output_torque_mean) + fabs(x->torque_ripple));
    return motion + (energies + means) < 1e300;
}

/* Advance by the communication step h; a status other than OK leaves state and outputs as they were. */
static int advance(struct module *m, const double *u, double *y, double h, bool imbalance)
{
    if (!(0.0 < h && h <= LARGEST_STEP))
        return BAD_STEP;
    int status = check_inputs(u);
    if (status != OK)
        return status;
    const struct mechanism *d = &m->d;
    struct state *x = &m->x;
    struct state kept = *x;
    double jump = begin(d, x, u, h);
    struct impulses impulses = {0.0, 0.0};
    if (jump != 0.0)
        impulses = jump_input(d, x, jump);
    status = run_events(d, x, h);
    if (status == OK) {
        end(x, h, impulses);
        if (!is_finite(x))
            status = NOT_FINITE;
    }
    if (status != OK) {
        *x = kept;
        return status;
    }
    write_outputs(d, x, y, imbalance);
    return OK;
}

/* Size of an instance in doubles. */
int64_t instance_size(void)
{
    return (int64_t)((sizeof(struct module) + sizeof(double) - 1) / sizeof(double));
}

/* The kernel's entry: START and STEP. Here x is the instance, and there is no workspace to be handed in. */
int64_t call(int64_t operation, const double *p, const double *d, const double *u, void *x, double *y,
             double *w, double h)
{
    (void)w;
    if (operation == START)
        return start(x, p, d, u, y);
    return advance(x, u, y, h, operation == STEP);
}
