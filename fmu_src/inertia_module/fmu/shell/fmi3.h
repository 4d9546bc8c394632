/* An instance of FMI 3.0. */
#ifndef FMI3_H
#define FMI3_H

#include "fmi3Functions.h"
#include "instance.h"

struct component {
    struct instance core;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
    fmi3IntermediateUpdateCallback update;
    int event_mode;   /* 1 if the host uses it */
    int early_return; /* 1 if the host allows it */
};

/* Report why an instantiation is rejected. There is no instance that could report it. */
INTERNAL fmi3Instance reject_instantiation(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                           const char *message);

/* Check that there is an instance and one value for each reference, because no variable is an array. */
INTERNAL fmi3Status check_count(struct instance *c, size_t count, size_t value_count);

#endif
