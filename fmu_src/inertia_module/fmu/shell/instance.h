/* One instance of the FMU, and what the files of the shell share of it. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include "fmi2Functions.h"
#include "model.h"

enum phase { INSTANTIATED, INITIALIZING, STEPPING, REFUSED, TERMINATED, PHASES };

enum category { LOG_WARNING, LOG_DISCARD, LOG_ERROR, LOG_STEPS, LOG_ALL, CATEGORIES };

/* Numbers of the shell that belong to the state, in front of the kernel's arrays. */
enum head { PHASE, TOLERANCE, TIME, LAST_STEP, PREPARED, COMPLETE, HEAD_SIZE };

/* A saved state: a link of the list of its instance, then a copy of the instance's block. */
struct saved {
    struct saved *next;
    struct saved *previous;
    double block[];
};

struct instance {
    fmi2CallbackFunctions callbacks;
    char *name;
    int logged[CATEGORIES];
    int warned;            /* of a communication point that is not the time reached */
    struct saved *states;
    /* the state: head, p, d, u, x, y, and x and u at the beginning of the last step, in one block */
    double *block;
    double *head, *p, *d, *u, *x, *y, *x_before, *u_before;
    double *values[ARRAYS];
    /* not part of the state: workspace of the kernel, and arrays to try things out on */
    double *w, *p_trial, *x_trial, *u_trial, *y_trial, *y_other;
};

/* doubles in the block of a state */
size_t block_size(void);

/* how an instance in a phase is called in messages */
extern const char *const phase_names[PHASES];

enum phase phase_of(const struct instance *c);

/* A number as text, the same on every platform and in every country; SHOWN brings the memory for it. */
#define NUMBER_SIZE 40
#define SHOWN(value) show((char[NUMBER_SIZE]){0}, value)
const char *show(char *text, double value);

/* Log a message if its category is on (errors always are) and return the status. Numbers: see SHOWN. */
fmi2Status report(struct instance *c, fmi2Status status, const char *format, ...)
#if defined __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* Report a call that does not belong to the phase, and one without its arrays: fmi2Error. */
fmi2Status out_of_order(struct instance *c, const char *call, const char *allowed);
fmi2Status without_array(struct instance *c, const char *call);

/* Report what the model says of a status of its kernel, with the values in u. */
fmi2Status explain(struct instance *c, fmi2Status status, int64_t answer, const double *u, double step);

/* Log what cannot be built of a mechanism that is accepted. */
void warn(struct instance *c);

/* Log the traced values of a step, if that is wanted. */
void trace(struct instance *c, double step);

/* Whether a parameter is finite, whole where it has to be, and within its range. */
int is_allowed(const struct variable *variable, double value);

/* Check the parameters and let the kernel start, unless that has been done since the last change. */
fmi2Status prepare(struct instance *c, fmi2Status refused);

/* Have the late outputs filled in, if they are not and can be. */
void complete(struct instance *c);

/* Start values, as after instantiation. */
void set_start_values(struct instance *c);

/* Forget all states saved. */
void free_states(struct instance *c);

void *allocate(const fmi2CallbackFunctions *callbacks, size_t size);
void release(const fmi2CallbackFunctions *callbacks, void *memory);

#endif
