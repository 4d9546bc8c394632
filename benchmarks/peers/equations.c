/* Equations of motion of the rigid module without losses, for integrators of others: see integrators.py. */
#include <math.h>
#include <stddef.h>

/* places of the numbers, as in integrators.py */
enum { HOUSING, OUTPUT, THERE, SPEED = 4, LOAD, RATIO, INERTIA2, INERTIA3, STIFFNESS };
enum { ROW = 9 };

#define EXPORTED __attribute__((visibility("default")))

/* Acceleration of link 2 with what it carries against a torque; torque with link 2 held. */
struct link2 {
    double acceleration, held_torque;
};

static struct link2 link2(const double *y, const double *numbers, const double *series, size_t rows, double carried,
                          double torque)
{
    const double omega1 = numbers[SPEED], k = numbers[RATIO], rate = k * (omega1 - y[1]);
    double inertia = 0.0, steady = 0.0;
    for (size_t n = 0; n < rows; n++) {
        const double *row = series + ROW * n;
        const double cosine = cos(row[0] * y[0]), sine = -sin(row[0] * y[0]);
        inertia += row[1] * cosine + row[5] * sine;
        steady += (row[2] * cosine + row[6] * sine) * omega1 * omega1;
        steady += (row[3] * cosine + row[7] * sine) * omega1 * rate;
        steady += (row[4] * cosine + row[8] * sine) * rate * rate;
    }
    return (struct link2){(k * steady - torque) / (numbers[INERTIA2] + carried - k * inertia), k * steady};
}

EXPORTED void rates(const double *y, const double *numbers, const double *series, size_t rows, double *result);
EXPORTED double guard(const double *y, const double *numbers, const double *series, size_t rows, int which);

/* Rates of the state (q, omega2, omega3). */
void rates(const double *y, const double *numbers, const double *series, size_t rows, double *result)
{
    const double load = numbers[LOAD], shaft = numbers[INERTIA3], stiffness = numbers[STIFFNESS];
    result[0] = numbers[RATIO] * (numbers[SPEED] - y[1]);
    result[1] = 0.0;
    if (stiffness > 0.0) {
        const double clutch = stiffness * fmax(0.0, y[1] - y[2]);
        result[1] = link2(y, numbers, series, rows, 0.0, clutch - stiffness * fmax(0.0, -y[1])).acceleration;
        result[2] = (clutch - load) / shaft;
        return;
    }
    const double closed = numbers[OUTPUT] != 0.0;
    if (numbers[HOUSING] == 0.0)
        result[1] = link2(y, numbers, series, rows, shaft * closed, load * closed).acceleration;
    result[2] = closed != 0.0 ? result[1] : -load / shaft;
}

/* Positive while a freewheel stays as it is. */
double guard(const double *y, const double *numbers, const double *series, size_t rows, int which)
{
    if (numbers[STIFFNESS] > 0.0 || numbers[THERE + which] == 0.0)
        return 1.0;
    if (numbers[which] == 0.0)
        return which == HOUSING ? y[1] : y[2] - y[1];
    if (which == OUTPUT) {
        double result[3];
        rates(y, numbers, series, rows, result);
        return numbers[LOAD] + numbers[INERTIA3] * result[1];
    }
    return (numbers[OUTPUT] != 0.0 ? numbers[LOAD] : 0.0) - link2(y, numbers, series, rows, 0.0, 0.0).held_torque;
}
