/* An instance of the FMU, independent of the version of FMI, and the functions that the files of the shell share. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include "model.h"

/* Status of a call, with the numbers of FMI 2.0 and 3.0. */
enum status { OK, WARNING, DISCARD, ERROR };

enum phase { INSTANTIATED, INITIALIZING, STEPPING, FAILED, TERMINATED, AT_EVENT, UPDATING, PHASES };

enum category { LOG_WARNING, LOG_DISCARD, LOG_ERROR, LOG_STEPS, LOG_ALL, CATEGORIES };

/* Numbers of the shell that belong to the state, before the arrays of the kernel. STARTED: the kernel has started
   with the present parameters. LATE_COMPUTED: the late outputs belong to the present state. */
enum head { PHASE, TOLERANCE, STOP_TIME, TIME, LAST_STEP, STARTED, LATE_COMPUTED, HEAD_SIZE };

/* A saved state: a link of the list of its instance, and a copy of the instance's block. */
struct saved {
    struct saved *next;
    struct saved *previous;
    double block[];
};

struct instance;

/* Functions of the host for logging and memory. */
struct host {
    void (*log)(struct instance *c, enum status status, const char *category, const char *text);
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
};

/* A type of values in calls: the kinds of variables that have it, and functions that read and write a value. */
struct type {
    const char *name;
    unsigned kinds; /* sum of 1 << kind */
    double (*read)(const void *values, size_t n);
    void (*write)(void *values, size_t n, double value);
};

struct instance {
    struct host host;
    char *name;
    int logged[CATEGORIES];
    int holds_discrete;            /* 1 if discrete values are constant in step mode (FMI 3.0) */
    int warned;            /* 1 after the warning of a wrong communication point */
    struct saved *states;
    /* The state in one block: head, p, d, u, x, y, x and u at the beginning of the last step, discrete values. */
    double *block;
    double *head, *p, *d, *u, *x, *y, *x_before, *u_before, *held;
    double *values[ARRAYS];
    /* Not part of the state: workspace of the kernel, and arrays for trial calls. */
    double *w, *p_trial, *x_trial, *u_trial, *y_trial, *y_other, *x_end, *y_end;
};

/* Return 1 if a double is not NaN, or if it is finite. The functions use its bits, because a comparison with NaN is a
   floating-point exception, which interrupts some hosts. */
INTERNAL int is_number(double value);
INTERNAL int is_finite(double value);

/* Number of doubles in the block of a state. */
INTERNAL size_t block_size(void);

/* Maximum size of a message, with its final 0. */
#define MESSAGE_SIZE 1024

/* Names of the phases in messages. */
INTERNAL const char *const phase_names[PHASES];

INTERNAL enum phase phase_of(const struct instance *c);

/* Return 1 between steps or at an event. Return 1 if derivatives of the outputs are available. */
INTERNAL int is_running(const struct instance *c);
INTERNAL int is_differentiable(const struct instance *c);

/* Return a number as text, which is the same on every platform and in every locale. TEXT_OF provides the memory. */
#define NUMBER_SIZE 40
#define TEXT_OF(value) number_text((char[NUMBER_SIZE]){0}, value)
INTERNAL const char *number_text(char *text, double value);

/* Log a message if its category is on (errors always are) and return the status. Write numbers with TEXT_OF. */
INTERNAL enum status report(struct instance *c, enum status status, const char *format, ...)
#if defined __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* Report a call that is not allowed in the present phase, or a call with a NULL array, and return ERROR. */
INTERNAL enum status report_wrong_phase(struct instance *c, const char *call, const char *allowed);
INTERNAL enum status report_missing_array(struct instance *c, const char *call);

/* Report the message of a status of the kernel, with the values of inputs in u, and return ``status``. */
INTERNAL enum status report_kernel_status(struct instance *c, enum status status, int64_t kernel_status,
                                          const double *u, double step);

/* Log the warnings of the model, such as a mechanism that cannot be built. */
INTERNAL void log_warnings(struct instance *c);

/* Log the traced values of a step if the category logSteps is on. */
INTERNAL void log_step(struct instance *c, double step);

INTERNAL enum status set_logging(struct instance *c, int on, size_t count, const char *const categories[]);

/* Life of an instance. It is the first member of a larger struct of ``size`` bytes, which depends on the version of
   FMI. ``create`` returns NULL if there is not enough memory. */
INTERNAL struct instance *create(const struct host *host, size_t size, const char *name, int logging);
INTERNAL void destroy(struct instance *c);
INTERNAL enum status set_experiment(struct instance *c, int tolerance_defined, double tolerance, double start_time,
                   int stop_time_defined, double stop_time);
INTERNAL enum status enter_initialization(struct instance *c);
INTERNAL enum status exit_initialization(struct instance *c, enum phase next);
INTERNAL enum status terminate(struct instance *c);
INTERNAL enum status reset(struct instance *c);

/* Report a call that is not allowed in an intermediate update and return ERROR; otherwise return OK. */
INTERNAL enum status check_not_updating(struct instance *c, const char *call);

/* Store the present discrete values, which are valid up to the next event. Return 1 if they have changed since. */
INTERNAL void store_discrete(struct instance *c);
INTERNAL int has_discrete_change(const struct instance *c);

/* Return 1 if a parameter is not NaN, a whole number if its kind requires this, and within its range. */
INTERNAL int is_allowed(const struct variable *variable, double value);

/* Check the parameters and start the kernel, unless it has started since the last change. If the parameters are
   rejected, return ``failure``. */
INTERNAL enum status start_kernel(struct instance *c, enum status failure);

/* Compute the late outputs, unless they are valid or the kernel has not started. */
INTERNAL void compute_late_outputs(struct instance *c);

/* Read or set values by their references: either all values of a call or none. */
INTERNAL enum status get_values(struct instance *c, const uint32_t references[], size_t count, void *values,
                       const struct type *type);
INTERNAL enum status set_values(struct instance *c, const uint32_t references[], size_t count, const void *values,
                       const struct type *type);
INTERNAL double read_real(const void *values, size_t n);
INTERNAL double read_integer(const void *values, size_t n);
INTERNAL void write_real(void *values, size_t n, double value);
INTERNAL void write_integer(void *values, size_t n, double value);

/* Make a step by an operation of the kernel. Return 1 if the last step has stopped just before an event. */
INTERNAL enum status take_step(struct instance *c, enum operation operation, double time, double step);
INTERNAL int has_pending_event(const struct instance *c);
INTERNAL void handle_pending_event(struct instance *c);

/* A run: many steps in one call, with the same bits as a loop of calls that read, set and step. */
struct run {
    double time;      /* beginning of the next step */
    size_t steps;     /* number of steps to make; afterwards number of steps made */
    const double *lengths;
    size_t input_count;
    const uint32_t *inputs;
    const double *set; /* values of the inputs, one row for each step */
    size_t output_count;
    const uint32_t *outputs;
    double *read;      /* values of the outputs, one row before the first step and one after each step */
    size_t row_size;   /* distance between these rows, in doubles */
};
INTERNAL enum status take_steps(struct instance *c, struct run *run,
                       enum status (*step)(struct instance *c, double time, double length));

/* Repeat the last step, which began at ``time``, and call ``show`` after each of its events. */
INTERNAL void replay_events(struct instance *c, double time, void (*show)(struct instance *c));

/* Time derivatives of inputs and outputs (orders must be 1). Partial derivatives of outputs with respect to inputs and
   tunable parameters. */
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
