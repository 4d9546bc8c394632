/* Common to the FMUs of test_check.py. A test writes their behaviour to behaviour.h. */
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* value references; y is u, flag is true from 0.5 s on, text is "early" or "late", count counts the steps */
enum { TIME, U, Y, FLAG, TEXT, COUNT, ARRAY, DATA, IN_TEXT };

static struct {
    double time, u;
    int count;
    char text[64];
} model = {.text = "none"};

static double number(unsigned reference)
{
    switch (reference) {
    case TIME: return model.time;
    case FLAG: return model.time >= 0.5 - 1e-9;
    case COUNT: return model.count;
    default: return model.u;
    }
}

static const char *text(unsigned reference)
{
    return reference == IN_TEXT ? model.text : model.time >= 0.5 - 1e-9 ? "late" : "early";
}

/* of FMI 3.0: whether a step may return early, and whether and when it does */
static bool early_allowed, is_early;
static double early_time;

/* returns a status: 0 if all is well, 2 discards the step, 3 is an error */
static int behaviour(double time, double step);
#include "behaviour.h"
