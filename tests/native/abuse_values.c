/* Random calls that read and set values and step. */
#include "abuse.h"

#include <math.h>
#include <string.h>

#define MUCH_WORK 1e5

/* Return 1 if all references have a kind and, unless ``calculated_too``, none is a calculated variable. */
static int are_all(const fmi2ValueReference *references, unsigned count, enum kind kind, int calculated_too)
{
    for (unsigned n = 0; n < count; n++)
        if (references[n] >= model.variable_count || kind_of(&model.variables[references[n]]) != kind ||
            (!calculated_too && model.variables[references[n]].array == OUTPUTS))
            return 0;
    return 1;
}

static struct answer get(struct slot *slot, fmi2Component c)
{
    fmi2ValueReference references[MOST_REFERENCES];
    fmi2Real reals[MOST_REFERENCES];
    fmi2Integer wholes[MOST_REFERENCES];
    const enum kind kind = one_in(&chance, 3) ? (enum kind)below(&chance, 3) : REAL;
    const unsigned count = some_references(references, kind, ARRAYS);
    const fmi2ValueReference *const given = one_in(&chance, 100) ? NULL : references;
    fmi2Real *const real_place = one_in(&chance, 100) ? NULL : reals;
    fmi2Integer *const whole_place = real_place ? wholes : NULL;
    const fmi2Status status = kind == REAL      ? fmi2GetReal(c, given, count, real_place)
                              : kind == INTEGER ? fmi2GetInteger(c, given, count, whole_place)
                                                : fmi2GetBoolean(c, given, count, whole_place);
    (void)slot;
    CHECK(status != fmi2OK || count == 0 || (given && real_place && are_all(references, count, kind, 1)),
          "variables of another kind are read");
    return CALLED(status);
}

/* Values that have been set are read with the same bits. A tolerance may be the one of setupExperiment. */
static void read_back(fmi2Component c, const fmi2ValueReference *references, unsigned count, const fmi2Real *set)
{
    fmi2Real values[MOST_REFERENCES];
    CHECK(fmi2GetReal(c, references, count, values) == fmi2OK, "what has been set can be read");
    for (unsigned n = 0; n < count; n++) {
        int last = strcmp(model.variables[references[n]].name, "tolerance") != 0;
        for (unsigned later = n + 1; later < count; later++)
            last &= references[later] != references[n];
        CHECK(!last || memcmp(&values[n], &set[n], sizeof *values) == 0, "%g is set, %g read", set[n], values[n]);
    }
}

static struct answer set(struct slot *slot, fmi2Component c)
{
    fmi2ValueReference references[MOST_REFERENCES];
    fmi2Real reals[MOST_REFERENCES];
    fmi2Integer wholes[MOST_REFERENCES];
    const int inputs = slot->stage == RUNNING || one_in(&chance, 2);
    const enum kind kind = inputs ? REAL : (enum kind)below(&chance, 3);
    const unsigned count = some_references(references, kind, inputs ? INPUTS : PARAMETERS);
    const fmi2ValueReference *const given = one_in(&chance, 100) ? NULL : references;
    const int nothing = one_in(&chance, 100);
    for (unsigned n = 0; n < count; n++) {
        const int known = references[n] < model.variable_count;
        reals[n] = known ? value_for(&model.variables[references[n]]) : any_number();
        wholes[n] = one_in(&chance, 20) ? (fmi2Integer)draw(&chance) : (fmi2Integer)below(&chance, 40);
    }
    if (!inputs && !one_in(&chance, 10)) /* choose_parameters sets parameters */
        return NO_CALL;
    const fmi2Status status = kind == REAL      ? fmi2SetReal(c, given, count, nothing ? NULL : reals)
                              : kind == INTEGER ? fmi2SetInteger(c, given, count, nothing ? NULL : wholes)
                                                : fmi2SetBoolean(c, given, count, nothing ? NULL : wholes);
    CHECK(status != fmi2OK || count == 0 || (given && !nothing && are_all(references, count, kind, 0)),
          "variables that are calculated or of another kind are set");
    CHECK(status != fmi2OK || count == 0 || (slot->stage != BROKEN && slot->stage != ENDED), "it is set too late");
    if (status == fmi2OK && kind == REAL)
        read_back(c, references, count, reals);
    return CALLED(status);
}

static struct answer strings(struct slot *slot, fmi2Component c)
{
    const fmi2ValueReference references[] = {0, 1};
    fmi2String texts[] = {"%s", NULL};
    const unsigned count = below(&chance, 3);
    const fmi2Status status =
        one_in(&chance, 2) ? fmi2GetString(c, references, count, texts) : fmi2SetString(c, references, count, texts);
    (void)slot;
    CHECK(!c || (status == fmi2OK) == (count == 0), "there are no Strings");
    return CALLED(status);
}

/* Number of evaluations so far, or 0 if the model has no such output. */
static double work_of(const struct slot *slot)
{
    return model.tolerance_slot >= 0 && slot->stage == RUNNING ? real_value(slot->c, "rhs_evaluations") : 0.0;
}

/* Free an instance with long steps and its states: the test needs many calls, not long ones. */
static void lose_patience(struct slot *slot)
{
    while (slot->states > 0)
        CHECK(fmi2FreeFMUstate(slot->c, &slot->kept[--slot->states].state) == fmi2OK, "freeing a state");
    CHECK(fmi2Reset(slot->c) == fmi2OK, "reset");
    slot->stage = NEW;
    slot->time = 0.0;
    slot->stop = INFINITY;
}

static struct answer step(struct slot *slot, fmi2Component c)
{
    double size = some_step(slot), time = slot->time;
    if (one_in(&chance, 40))
        time = any_number();
    if (one_in(&chance, 40))
        size = one_in(&chance, 2) ? -size : one_in(&chance, 2) ? NAN : one_in(&chance, 2) ? 0.0 : INFINITY;
    const double work = work_of(slot);
    const unsigned long messages = slot->journal.messages;
    const fmi2Status status = fmi2DoStep(c, time, size, one_in(&chance, 2));
    if (!c)
        return CALLED(status);
    CHECK(slot->stage == RUNNING || status == fmi2Error, "a step in stage %d answers %d", slot->stage, status);
    const int past = time + size > slot->stop + 1e-5 * fmax(1.0, fabs(slot->stop)) && isfinite(time);
    CHECK(slot->stage != RUNNING || (status == fmi2Error) == past, "a step to %g answers %d, the end is %g", time + size,
          status, slot->stop);
    CHECK(status != fmi2OK || (size > 0.0 && isfinite(size) && isfinite(time)), "step %g at %g is taken", size, time);
    if (status == fmi2OK)
        slot->time = time + size;
    if (work_of(slot) - work > MUCH_WORK ||
        (slot->journal.messages > messages && strstr(slot->journal.last, "is abandoned")))
        return lose_patience(slot), CALLED(fmi2OK);
    return CALLED(status);
}

static struct answer set_rates(struct slot *slot, fmi2Component c)
{
    fmi2ValueReference references[MOST_REFERENCES];
    fmi2Integer orders[MOST_REFERENCES];
    fmi2Real values[MOST_REFERENCES];
    const unsigned count = some_references(references, REAL, INPUTS);
    const fmi2Integer *const given = one_in(&chance, 100) ? NULL : orders;
    (void)slot;
    for (unsigned n = 0; n < count; n++) {
        orders[n] = one_in(&chance, 50) ? (fmi2Integer)below(&chance, 4) : 1;
        values[n] = one_in(&chance, 30) ? any_number() : between(&chance, -1e3, 1e3);
    }
    return CALLED(fmi2SetRealInputDerivatives(c, references, count, given, values));
}

static struct answer get_rates(struct slot *slot, fmi2Component c)
{
    fmi2ValueReference references[MOST_REFERENCES];
    fmi2Integer orders[MOST_REFERENCES];
    fmi2Real values[MOST_REFERENCES];
    const unsigned count = some_references(references, REAL, OUTPUTS);
    (void)slot;
    for (unsigned n = 0; n < count; n++)
        orders[n] = one_in(&chance, 50) ? (fmi2Integer)below(&chance, 4) : 1;
    return CALLED(fmi2GetRealOutputDerivatives(c, one_in(&chance, 100) ? NULL : references, count, orders,
                                               one_in(&chance, 100) ? NULL : values));
}

static struct answer get_directional(struct slot *slot, fmi2Component c)
{
    fmi2ValueReference unknowns[MOST_REFERENCES], knowns[MOST_REFERENCES];
    fmi2Real direction[MOST_REFERENCES], derivative[MOST_REFERENCES];
    const unsigned unknown_count = some_references(unknowns, REAL, OUTPUTS);
    const enum array by = slot->stage == STARTING && one_in(&chance, 2) ? PARAMETERS : INPUTS;
    const unsigned known_count = some_references(knowns, REAL, by);
    for (unsigned n = 0; n < known_count; n++)
        direction[n] = one_in(&chance, 20) ? any_number() : between(&chance, -1.0, 1.0);
    return CALLED(fmi2GetDirectionalDerivative(c, unknowns, unknown_count, one_in(&chance, 100) ? NULL : knowns,
                                               known_count, direction, one_in(&chance, 100) ? NULL : derivative));
}

static struct answer ask_status(struct slot *slot, fmi2Component c)
{
    const fmi2StatusKind kind = (fmi2StatusKind)below(&chance, 4);
    fmi2Status status;
    fmi2Real real;
    fmi2Integer whole;
    fmi2String text;
    const int nowhere = one_in(&chance, 20);
    (void)slot;
    switch (below(&chance, 6)) {
    case 0:
        return CALLED(fmi2GetStatus(c, kind, nowhere ? NULL : &status));
    case 1:
        return CALLED(fmi2GetRealStatus(c, kind, nowhere ? NULL : &real));
    case 2:
        return CALLED(fmi2GetIntegerStatus(c, kind, nowhere ? NULL : &whole));
    case 3:
        return CALLED(fmi2GetBooleanStatus(c, kind, nowhere ? NULL : &whole));
    case 4:
        return CALLED(fmi2GetStringStatus(c, kind, nowhere ? NULL : &text));
    default:
        return CALLED(fmi2CancelStep(c));
    }
}

const struct action value_actions[] = {
    {"step", 300, step},           {"get", 200, get},
    {"set", 150, set},             {"set_rates", 20, set_rates},
    {"get_rates", 10, get_rates},  {"get_directional", 10, get_directional},
    {"ask_status", 10, ask_status}, {"strings", 5, strings},
    {NULL, 0, NULL},
};
