/* Random calls of an FMU: the declarations that the files of the program share. */
#ifndef ABUSE_H
#define ABUSE_H

#include "snapshot.h"

#define MOST_STATES 8
#define MOST_REFERENCES 6
#define MOST_BYTES 147456

/* Phase of an instance by the rules of FMI. It determines which calls are allowed. */
enum stage { NEW, STARTING, RUNNING, BROKEN, ENDED };

struct kept {
    fmi2FMUstate state;
    enum stage stage;
    double stop;
};

struct slot {
    fmi2Component c;
    enum stage stage;
    struct journal journal;
    struct kept kept[MOST_STATES];
    unsigned states;
    double time, stop; /* stop: of the experiment, if there is one */
    fmi2FMUstate freed; /* a state that has been freed */
};

/* The last serialized state of any instance. */
struct serialized {
    fmi2Byte bytes[MOST_BYTES];
    size_t size;
    enum stage stage;
    double stop;
};

extern struct chance chance;
extern struct slot slots[];
extern const unsigned slot_count;
extern struct serialized serialized;

/* Any number that a host may send: valid, extreme, or NaN. */
double any_number(void);

/* A value for a variable: mostly within its range, often an end of this range. */
double value_for(const struct variable *variable);

/* A communication step with a limited run time: short if the mechanism turns fast. */
double some_step(struct slot *slot);

/* References: mostly of the requested kind and array, sometimes of others, sometimes invalid. */
unsigned some_references(fmi2ValueReference *references, enum kind kind, enum array array);

/* Set parameters before initialisation, some of them extreme. */
void choose_parameters(struct slot *slot);

/* Result of an action: the status of its call, or a flag if it made no call. */
struct answer {
    fmi2Status status;
    int no_call;
};
#define NO_CALL ((struct answer){fmi2OK, 1})
#define CALLED(status_) ((struct answer){(status_), 0})

struct action {
    const char *name;
    unsigned weight;
    struct answer (*run)(struct slot *slot, fmi2Component c); /* c is the slot's instance, or NULL */
};
extern const struct action value_actions[], state_actions[], life_actions[];

#endif
