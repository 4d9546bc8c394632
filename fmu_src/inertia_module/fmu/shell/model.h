/* Tables of a model for the shell, generated from its table of variables, and the entry of its kernel. */
#ifndef MODEL_H
#define MODEL_H

#include <stddef.h>
#include <stdint.h>

#include "codes.h"
#include "kernel.h"

/* Arrays of the kernel that contain variables. CLOCK contains the time, which is a variable of FMI 3.0. */
enum array { PARAMETERS, INPUTS, OUTPUTS, CLOCK, ARRAYS };
enum kind { REAL, INTEGER, BOOLEAN, ENUMERATION, UNUSED }; /* UNUSED: no variable has this value reference */

/* A variable. Its value reference is its position in the table. */
struct variable {
    const char *name;
    enum kind kind;
    enum array array;
    int slot;            /* position in the array */
    int rate_slot;       /* input: position of its rate, otherwise -1 */
    int has_rate_slot;   /* input: position of the flag of its rate, otherwise -1 */
    int discrete_slot;           /* discrete: position among the values that are constant in step mode, otherwise -1 */
    int late;            /* 1 if only OPERATION_OUTPUTS computes it, when it is read */
    int output;          /* 1 if its causality is output */
    int tunable;         /* 1 for a parameter that may change between steps */
    double start;        /* parameters and inputs */
    double minimum;
    double maximum;
    double nominal;      /* inputs and parameters: scale of a small change */
    const char *allowed; /* parameters: text after "must be" in messages */
};

/* A part of a message: a text, and the kind and position of the number after it. */
enum number { NO_NUMBER, PARAMETER_NUMBER, INPUT_NUMBER, STEP_NUMBER, LAST_PIECE };
struct piece {
    const char *text;
    enum number number;
    int slot;
};

/* Message for a status of the kernel, or for a warning. */
struct message {
    int number;
    const struct piece *pieces;
};

/* Bound of a number of the constants d or of the state x that the kernel uses as an index or an enumeration. */
struct bound {
    enum { CONSTANTS, STATE } of;
    size_t slot;
    double maximum; /* the number must be a whole number from 0 to this one */
};

struct model {
    const char *name;
    const char *guid;
    const struct variable *variables;
    size_t variable_count;
    int tolerance_slot;  /* position of the tolerance in the parameters, or -1 */
    int length_slot;     /* position in the state of the length of the last step; -1 if steps cannot stop at events */
    int event_slot;      /* position in the state of the flag of a pending event, or -1 */
    size_t p_size, d_size, u_size, x_size, y_size, w_size;
    const struct message *messages;
    size_t message_count;
    const struct message *warnings;
    size_t warning_count;
    const int *discrete; /* positions of outputs that may only change in event mode, if the host uses it */
    size_t discrete_count;
    const size_t *traced; /* value references in the log category logSteps */
    size_t traced_count;
    const struct bound *bounds;
    size_t bound_count;
};

INTERNAL const struct model model;

#endif
