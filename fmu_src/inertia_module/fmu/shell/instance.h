/* One instance of the FMU, whatever the version of FMI, and what the files of the shell share of it. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include "model.h"

/* what a call answers, by the numbers of FMI 2.0 and 3.0 */
enum status { OK, WARNING, DISCARD, ERROR };

enum phase { INSTANTIATED, INITIALIZING, STEPPING, REFUSED, TERMINATED, AT_EVENT, UPDATING, PHASES };

enum category { LOG_WARNING, LOG_DISCARD, LOG_ERROR, LOG_STEPS, LOG_ALL, CATEGORIES };

/* Numbers of the shell that belong to the state, in front of the kernel's arrays. */
enum head { PHASE, TOLERANCE, STOP_TIME, TIME, LAST_STEP, PREPARED, COMPLETE, HEAD_SIZE };

/* A saved state: a link of the list of its instance, then a copy of the instance's block. */
struct saved {
    struct saved *next;
    struct saved *previous;
    double block[];
};

struct instance;

/* What the version of FMI and the host give an instance to work with. */
struct host {
    void (*log)(struct instance *c, enum status status, const char *category, const char *text);
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
};

/* A host's type of values: which kinds of variables are of it, and how a value is read from an array and written. */
struct type {
    const char *name;
    unsigned kinds; /* 1 << kind of each */
    double (*read)(const void *values, size_t n);
    void (*write)(void *values, size_t n, double value);
};

struct instance {
    struct host host;
    char *name;
    int logged[CATEGORIES];
    int holds;             /* whether discrete values are held in step mode */
    int warned;            /* of a communication point that is not the time reached */
    struct saved *states;
    /* the state: head, p, d, u, x, y, x and u at the beginning of the last step, and discrete values, in one block */
    double *block;
    double *head, *p, *d, *u, *x, *y, *x_before, *u_before, *held;
    double *values[ARRAYS];
    /* not part of the state: workspace of the kernel, and arrays to try things out on */
    double *w, *p_trial, *x_trial, *u_trial, *y_trial, *y_other, *x_end, *y_end;
};

/* Whether a double is a number, infinities included; whether it is finite. By its bits: a comparison with NaN is an
   exception, which interrupts in some hosts. */
INTERNAL int is_number(double value);
INTERNAL int is_finite(double value);

/* doubles in the block of a state */
INTERNAL size_t block_size(void);

/* letters of a message at most, its end included */
#define LONGEST_MESSAGE 1024

/* how an instance in a phase is called in messages */
INTERNAL const char *const phase_names[PHASES];

INTERNAL enum phase phase_of(const struct instance *c);

/* Whether an instance takes steps: is between them or at an event; whether its outputs can be differentiated. */
INTERNAL int is_running(const struct instance *c);
INTERNAL int is_differentiable(const struct instance *c);

/* A number as text, the same on every platform and in every country; SHOWN brings the memory for it. */
#define NUMBER_SIZE 40
#define SHOWN(value) show((char[NUMBER_SIZE]){0}, value)
INTERNAL const char *show(char *text, double value);

/* Log a message if its category is on (errors always are) and return the status. Numbers: see SHOWN. */
INTERNAL enum status report(struct instance *c, enum status status, const char *format, ...)
#if defined __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* Report a call that does not belong to the phase, and one without its arrays: an error. */
INTERNAL enum status out_of_order(struct instance *c, const char *call, const char *allowed);
INTERNAL enum status without_array(struct instance *c, const char *call);

/* Report what the model says of a status of its kernel, with the values in u. */
INTERNAL enum status explain(struct instance *c, enum status status, int64_t answer, const double *u, double step);

/* Log what cannot be built of a mechanism that is accepted. */
INTERNAL void warn(struct instance *c);

/* Log the traced values of a step, if that is wanted. */
INTERNAL void trace(struct instance *c, double step);

INTERNAL enum status choose_logging(struct instance *c, int on, size_t count, const char *const categories[]);

/* Life. An instance is the first member of what a version of FMI makes of it, SIZE bytes in all; NULL: no memory. */
INTERNAL struct instance *create(const struct host *host, size_t size, const char *name, int logging);
INTERNAL void destroy(struct instance *c);
INTERNAL enum status set_up(struct instance *c, int tolerance_defined, double tolerance, double start_time,
                   int stop_time_defined, double stop_time);
INTERNAL enum status enter_initialization(struct instance *c);
INTERNAL enum status exit_initialization(struct instance *c, enum phase next);
INTERNAL enum status terminate(struct instance *c);
INTERNAL enum status reset(struct instance *c);

/* Report a call that must not come in an intermediate update: an error; else OK. */
INTERNAL enum status check_no_update(struct instance *c, const char *call);

/* Hold the discrete values as they are now, up to the next event; whether they have changed since. */
INTERNAL void hold_discrete(struct instance *c);
INTERNAL int has_discrete_change(const struct instance *c);

/* Whether a parameter is finite, whole where it has to be, and within its range. */
INTERNAL int is_allowed(const struct variable *variable, double value);

/* Check the parameters and let the kernel start, unless that has been done since the last change. */
INTERNAL enum status prepare(struct instance *c, enum status refused);

/* Have the late outputs filled in, if they are not and can be. */
INTERNAL void complete(struct instance *c);

/* Values by their references: all of a call are read or set, or none. */
INTERNAL enum status get_values(struct instance *c, const uint32_t references[], size_t count, void *values,
                       const struct type *type);
INTERNAL enum status set_values(struct instance *c, const uint32_t references[], size_t count, const void *values,
                       const struct type *type);
INTERNAL double read_real(const void *values, size_t n);
INTERNAL double read_integer(const void *values, size_t n);
INTERNAL void write_real(void *values, size_t n, double value);
INTERNAL void write_integer(void *values, size_t n, double value);

/* Steps by an operation of the kernel; whether the last one has stopped at a switch that is yet to be carried out. */
INTERNAL enum status take_step(struct instance *c, enum operation operation, double time, double step);
INTERNAL int has_stopped(const struct instance *c);
INTERNAL void carry_out_switch(struct instance *c);

/* A run: many steps in one call, with the bits of a loop of calls that read, set and step. */
struct run {
    double time;      /* of the next step */
    size_t steps;     /* to take, then those taken */
    const double *lengths;
    size_t input_count;
    const uint32_t *inputs;
    const double *set; /* of inputs, a row for each step */
    size_t output_count;
    const uint32_t *outputs;
    double *read;      /* of outputs of any type, a row before the first step and one after each */
    size_t row_size;   /* from one of these rows to the next */
};
INTERNAL enum status take_steps(struct instance *c, struct run *run,
                       enum status (*step)(struct instance *c, double time, double length));

/* Go through the last step, which began at a time, once more and show the instance as it is after its switches. */
INTERNAL void show_switches(struct instance *c, double time, void (*show)(struct instance *c));

/* Derivatives: of inputs and outputs by time, orders must be 1; of outputs by inputs and tunable parameters. */
INTERNAL enum status set_rates(struct instance *c, const uint32_t references[], size_t count, const int32_t orders[],
                      const double values[]);
INTERNAL enum status get_rates(struct instance *c, const uint32_t references[], size_t count, const int32_t orders[],
                      double values[]);
INTERNAL enum status directional(struct instance *c, const uint32_t unknowns[], size_t unknown_count,
                        const uint32_t knowns[], size_t known_count, const double direction[],
                        double derivative[]);
INTERNAL enum status adjoint(struct instance *c, const uint32_t unknowns[], size_t unknown_count, const uint32_t knowns[],
                    size_t known_count, const double seed[], double sensitivity[]);

/* Saved states. */
INTERNAL enum status save_state(struct instance *c, void **state);
INTERNAL enum status restore_state(struct instance *c, void *state);
INTERNAL enum status free_state(struct instance *c, void **state);
INTERNAL enum status serialized_size(struct instance *c, void *state, size_t *size);
INTERNAL enum status serialize_state(struct instance *c, void *state, void *bytes, size_t size);
INTERNAL enum status deserialize_state(struct instance *c, const void *bytes, size_t size, void **state);
INTERNAL void free_states(struct instance *c);

#endif
