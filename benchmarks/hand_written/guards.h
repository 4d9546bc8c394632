/* Whether a guard can have dipped below zero between two looks, by its values and rates there. */
#ifndef GUARDS_H
#define GUARDS_H

#include <stdbool.h>

/* larger than the third with which a cubic's Bernstein coefficients would do: a margin */
#define SHARE 0.4

struct look {
    double value, rate;
};

/* Whether a guard that is not negative at both ends of a short interval h stays so inside. */
static inline bool stays_positive(struct look low, struct look high, double h)
{
    return low.value + SHARE * h * low.rate >= 0.0 && high.value - SHARE * h * high.rate >= 0.0;
}

/* Where to look for the lowest point: where the rate passes zero, if it does, else the middle. */
static inline double next_look(double low, double rate_low, double high, double rate_high)
{
    if (rate_low < 0.0 && 0.0 < rate_high) {
        double middle = low - rate_low * (high - low) / (rate_high - rate_low);
        if (low < middle && middle < high)
            return middle;
    }
    return 0.5 * (low + high);
}

#endif
