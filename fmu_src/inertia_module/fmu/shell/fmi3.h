/* An instance as FMI 3.0 has it. */
#ifndef FMI3_H
#define FMI3_H

#include "fmi3Functions.h"
#include "instance.h"

struct component {
    struct instance core;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
    fmi3IntermediateUpdateCallback update;
    int event_mode;   /* whether the host uses it */
    int early_return; /* whether the host allows it */
};

/* Refuse an instantiation: there is no instance yet that could report it. */
INTERNAL fmi3Instance refuse(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, const char *message);

/* Whether there is an instance and a value for each reference: none of the variables is an array. */
INTERNAL fmi3Status check_count(struct instance *c, size_t count, size_t value_count);

#endif
