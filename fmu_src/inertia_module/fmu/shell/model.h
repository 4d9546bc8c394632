/* What the shell knows of a model: tables made from its table of variables, and the entry of its kernel. */
#ifndef MODEL_H
#define MODEL_H

#include <stddef.h>
#include <stdint.h>

#include "codes.h"
#include "kernel.h"

/* the kernel's arrays that hold variables */
enum array { PARAMETERS, INPUTS, OUTPUTS, CLOCK, ARRAYS }; /* CLOCK: the time, where it is a variable */
enum kind { REAL, INTEGER, BOOLEAN, ENUMERATION, UNUSED }; /* UNUSED: no variable has this value reference */

/* A variable; its value reference is its place in the table. */
struct variable {
    const char *name;
    enum kind kind;
    enum array array;
    int slot;
    int rate_slot;       /* of inputs: of the rate, and of whether it is given */
    int given_slot;
    int held;            /* of discrete ones: place among the values held in step mode, or -1 */
    int late;            /* filled in by OPERATION_OUTPUTS only, when it is read */
    int output;          /* whether its causality is output */
    int tunable;         /* whether it is a parameter that may change between steps */
    double start;        /* of parameters and inputs */
    double minimum;
    double maximum;
    double nominal;      /* of inputs and parameters: what a small change is measured by */
    const char *allowed; /* of parameters: what follows "must be" */
};

/* A sentence in pieces: each a text and then a number, or none. */
enum number { NO_NUMBER, PARAMETER_NUMBER, INPUT_NUMBER, STEP_NUMBER, LAST_PIECE };
struct piece {
    const char *text;
    enum number number;
    int slot;
};

/* What the model says when its kernel answers a status, or a sum with the number of a warning in it. */
struct message {
    int number;
    const struct piece *pieces;
};

/* A number of the constants d or the state x that the kernel takes for an index or a choice. */
struct bound {
    enum { CONSTANTS, STATE } of;
    size_t slot;
    double most; /* it must be a whole number from 0 to this */
};

struct model {
    const char *name;
    const char *guid;
    const struct variable *variables;
    size_t variable_count;
    int tolerance_slot;  /* of the parameters, or -1 */
    int length_slot;     /* of the state: length of the last step, or -1 where a step cannot stop at a switch */
    int switching_slot;  /* ... whether it has stopped at one */
    size_t p_size, d_size, u_size, x_size, y_size, w_size;
    const struct message *messages;
    size_t message_count;
    const struct message *warnings;
    size_t warning_count;
    const int *discrete; /* slots of outputs that may change in event mode only, where a host uses it */
    size_t discrete_count;
    const size_t *traced; /* value references shown of each step in the log category logSteps */
    size_t traced_count;
    const struct bound *bounds;
    size_t bound_count;
};

INTERNAL const struct model model;

#endif
