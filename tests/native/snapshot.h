/* All that can be read of an instance, and the trajectory that tells two instances apart. */
#ifndef SNAPSHOT_H
#define SNAPSHOT_H

#include "host.h"

enum share { GIVEN, CALCULATED, SHARES };

struct snapshot {
    fmi2Status status[SHARES];
    double values[SHARES][MOST_VARIABLES];
    double time;
};

/* Read all values: those given to the instance, then those it calculates, as far as it lets them be read. */
void take_snapshot(fmi2Component c, struct snapshot *snapshot);

/* Whether two snapshots have the same bits, calculated values included or not. */
int is_same(const struct snapshot *one, const struct snapshot *other, int calculated_too);

/* Name of the first variable that differs, for messages. */
const char *difference(const struct snapshot *one, const struct snapshot *other);

/* A sum over bits, those of a snapshot added. */
uint64_t add_bits(uint64_t sum, const struct snapshot *snapshot);

/* Sum over the bits of all values at every step of a scene with bends and jumps, from instantiation or reset on. */
uint64_t trajectory(fmi2Component c, unsigned steps);

#endif
