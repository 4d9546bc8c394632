/* Compensated sums and wrapped angles: nothing is lost over billions of steps or turns. */
#ifndef ACCUMULATE_H
#define ACCUMULATE_H

#include <math.h>

#define TWO_PI 6.283185307179586
#define TWO_PI_LOW 2.4492935982947064e-16

/* A sum and what rounding has lost of it. */
struct sum {
    double value, low;
};

/* Neumaier's sum. */
static inline void add(struct sum *sum, double value)
{
    value += sum->low;
    double old = sum->value;
    double new = old + value;
    double shift = new - old;
    sum->low = (old - (new - shift)) + (value - shift);
    sum->value = new;
}

static inline void assign(struct sum *sum, double value)
{
    sum->value = value;
    sum->low = 0.0;
}

/* Time and what rounding has kept from it, the time passed later. */
static inline struct sum later(struct sum time, double passed)
{
    passed += time.low;
    double new = time.value + passed;
    return (struct sum){new, passed - (new - time.value)};
}

/* Bring an angle into [0, period), period in two doubles. Returns the periods taken off. */
static inline double wrap(struct sum *angle, double period, double period_low)
{
    double rest = fmod(angle->value, period); /* of the sign of the angle: exact */
    double periods = floor((angle->value - rest) / period + 0.5);
    double low = angle->low - periods * period_low;
    if (rest < 0.0) {
        double turned = rest + period;
        low += rest - (turned - period) + period_low;
        rest = turned;
        periods -= 1.0;
    }
    if (rest >= period) {
        rest -= period;
        low -= period_low;
        periods += 1.0;
    }
    /* what low has gathered belongs to the angle, unless that takes it below zero by rounding */
    double total = rest + low;
    if (total >= 0.0) {
        low -= total - rest;
        rest = total;
    }
    angle->value = rest;
    angle->low = low;
    return periods;
}

#endif
