/* Random calls of FMI 3.0 in any order, also of event mode: abuse3 SEED CALLS.
 *
 * The program determines which call is allowed in which phase. Any other call is an error and changes no value.
 * (fmi2_by_3.c drives an instance like a host, event by event.)
 */
#include "fmi3Functions.h"
#include "host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum place { NEW, STARTING, BETWEEN_STEPS, AT_AN_EVENT, BROKEN, ENDED };

struct kept {
    fmi3FMUState state;
    enum place place;
    double time, stop;
};

static struct chance chance;
static fmi3Instance c; /* or NULL, for a call without an instance */
static enum place place;
static int has_events, stops;
static double now, stop; /* stop: of the experiment, if there is one */
static double discrete; /* value at the beginning of the step */
static struct kept kept;
static unsigned long updates, events;

static int is_running(void)
{
    return place == BETWEEN_STEPS || place == AT_AN_EVENT;
}

static fmi3ValueReference any_reference(void)
{
    return below(&chance, (unsigned)model.variable_count + 2);
}

static double any_value(void)
{
    static const double odd[] = {0.0, -1.0, 1e300, INFINITY, -INFINITY, NAN};
    return one_in(&chance, 3) ? odd[below(&chance, 6)] : between(&chance, 0.0, 100.0);
}

/* All Real values, or zeros, and the status of reading them. */
struct view {
    fmi3Status status;
    fmi3Float64 values[MOST_VARIABLES];
};

static void look(fmi3Instance instance, struct view *view)
{
    fmi3ValueReference references[MOST_VARIABLES];
    size_t count = 0;
    memset(view, 0, sizeof *view);
    for (fmi3ValueReference n = 0; n < model.variable_count; n++)
        if (model.variables[n].kind == REAL)
            references[count++] = n;
    view->status = fmi3GetFloat64(instance, references, count, view->values, count);
}

/* A discrete value of the model, or 0. It may change only in event mode, if the host uses it. */
static fmi3Float64 discrete_value(void)
{
    fmi3Float64 value = 0.0;
    for (fmi3ValueReference n = 0; n < model.variable_count; n++)
        if (model.variables[n].discrete_slot >= 0 && model.variables[n].kind == REAL)
            CHECK(fmi3GetFloat64(c, &n, 1, &value, 1) == fmi3OK, "reading %s", model.variables[n].name);
    return value;
}

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text)
{
    CHECK(environment == &kept && *category && *text && status <= fmi3Error, "a message with status %d", status);
}

static void update(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean set_requested,
                   fmi3Boolean get_allowed, fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early_return,
                   fmi3Float64 *early_return_time)
{
    struct view view;
    (void)finished;
    CHECK(environment == &kept && get_allowed && !set_requested && !can_return, "an update at %g", time);
    CHECK(!*early_return && *early_return_time == time, "an update at %g", time);
    look(c, &view);
    CHECK(view.status == fmi3OK && fmi3EnterEventMode(c) == fmi3Error, "an update at %g", time);
    CHECK(discrete_value() == discrete, "a discrete value changes in an update at %g", time);
    updates++;
}

static void make(void)
{
    const int watched = one_in(&chance, 4);
    has_events = one_in(&chance, 2);
    stops = one_in(&chance, 2);
    c = fmi3InstantiateCoSimulation("instance", model.guid, NULL, false, one_in(&chance, 2), has_events, stops, NULL,
                                    0, &kept, log_message, watched ? update : NULL);
    CHECK(c, "instantiation");
    place = NEW;
    memset(&kept, 0, sizeof kept);
}

static fmi3Status begin(fmi3Instance instance)
{
    const double start = one_in(&chance, 4) ? any_value() : 0.0;
    const int right = place == NEW && isfinite(start), has_stop = one_in(&chance, 3);
    const double end = start + pow(10.0, between(&chance, -4.0, 0.0));
    const fmi3Status status = fmi3EnterInitializationMode(instance, one_in(&chance, 3), 1e-6, start, has_stop, end);
    CHECK(!instance || (status == fmi3OK) == right, "the beginning of initialization in %d", place);
    if (status == fmi3OK) {
        place = STARTING;
        now = start;
        stop = has_stop ? end : INFINITY;
    }
    return status;
}

static fmi3Status end_of_initialization(fmi3Instance instance)
{
    const fmi3Status status = fmi3ExitInitializationMode(instance);
    CHECK(!instance || place == STARTING || status == fmi3Error, "the end of initialization in %d", place);
    if (instance && place == STARTING)
        place = status != fmi3OK ? BROKEN : has_events ? AT_AN_EVENT : BETWEEN_STEPS;
    return instance && place == BROKEN ? fmi3OK : status; /* more values can be read now than before */
}

static fmi3Status enter_event(fmi3Instance instance)
{
    const fmi3Status status = fmi3EnterEventMode(instance);
    CHECK(!instance || (status == fmi3OK) == (place == BETWEEN_STEPS && has_events), "event mode in %d", place);
    if (status == fmi3OK)
        place = AT_AN_EVENT;
    return status;
}

static fmi3Status pass_event(fmi3Instance instance)
{
    fmi3Boolean flags[5];
    fmi3Float64 next = 0.0;
    const int whole = !one_in(&chance, 5);
    const fmi3Status status =
        fmi3UpdateDiscreteStates(instance, &flags[0], &flags[1], &flags[2], whole ? &flags[3] : NULL, &flags[4], &next);
    CHECK(!instance || (status == fmi3OK) == (place == AT_AN_EVENT && whole), "an event in %d", place);
    return status;
}

static fmi3Status enter_step(fmi3Instance instance)
{
    const fmi3Status status = fmi3EnterStepMode(instance);
    CHECK(!instance || (status == fmi3OK) == (place == AT_AN_EVENT), "step mode in %d", place);
    if (status == fmi3OK)
        place = BETWEEN_STEPS;
    return status;
}

static fmi3Status take_step(fmi3Instance instance)
{
    fmi3Boolean event = false, ends = false, early = false;
    fmi3Float64 reached = NAN;
    discrete = instance && place == BETWEEN_STEPS ? discrete_value() : 0.0;
    const double step = one_in(&chance, 10) ? any_value() * -1e300 : between(&chance, 1e-5, 5e-3);
    const fmi3Status status = fmi3DoStep(instance, now, step, false, &event, &ends, &early, &reached);
    CHECK(!instance || place == BETWEEN_STEPS || status == fmi3Error, "a step in %d", place);
    const int past = now + step > stop + 1e-5 * fmax(1.0, fabs(stop));
    CHECK(!instance || place != BETWEEN_STEPS || (status == fmi3Error) == past, "a step to %g of %g", now + step, stop);
    if (status != fmi3OK)
        return status;
    CHECK(!has_events || discrete_value() == discrete, "a discrete value changes in step mode");
    CHECK(!ends && reached >= now && reached <= now + step && (early || reached == now + step), "a step to %g", reached);
    CHECK((stops || !early) && (!event || has_events), "an event that nobody waits for");
    events += event;
    now = reached;
    return status;
}

static fmi3Status set_number(fmi3Instance instance)
{
    const fmi3ValueReference reference = any_reference();
    const struct variable *const variable = reference < model.variable_count ? &model.variables[reference] : NULL;
    const fmi3Float64 value = any_value();
    const size_t count = one_in(&chance, 20) ? 2 : 1;
    const fmi3Status status = fmi3SetFloat64(instance, &reference, 1, &value, count);
    const int is_known = variable && variable->kind == REAL && count == 1;
    const int is_given = is_known && (variable->array == INPUTS || variable->array == PARAMETERS);
    const int is_open = place == NEW || place == STARTING || (is_running() && is_given &&
                                                              (variable->array == INPUTS || variable->tunable));
    CHECK(!instance || (is_given && is_open) || status == fmi3Error, "setting %u in %d", (unsigned)reference, place);
    return status;
}

static fmi3Status read_state(fmi3Instance instance)
{
    fmi3Byte bytes[147456];
    size_t size = 0;
    fmi3FMUState state = kept.state;
    switch (below(&chance, 4)) {
    case 0:
        if (!instance || fmi3GetFMUState(instance, &kept.state) != fmi3OK)
            return fmi3GetFMUState(NULL, &state);
        kept.place = place;
        kept.time = now;
        kept.stop = stop;
        return fmi3OK;
    case 1:
        if (fmi3SetFMUState(instance, kept.state) != fmi3OK)
            return fmi3Error;
        place = kept.place;
        now = kept.time;
        stop = kept.stop;
        return fmi3OK;
    case 2:
        if (fmi3SerializedFMUStateSize(instance, kept.state, &size) != fmi3OK)
            return fmi3Error;
        CHECK(size <= sizeof bytes && fmi3SerializeFMUState(instance, kept.state, bytes, size) == fmi3OK, "%zu", size);
        bytes[below(&chance, (unsigned)size)] ^= (fmi3Byte)(1U << below(&chance, 8));
        return fmi3DeserializeFMUState(instance, bytes, size, &state);
    default:
        return instance ? fmi3FreeFMUState(instance, &kept.state) : fmi3Error;
    }
}

static fmi3Status differentiate(fmi3Instance instance)
{
    const fmi3ValueReference unknown = any_reference(), known = any_reference();
    const fmi3Int32 order = (fmi3Int32)below(&chance, 3);
    const fmi3Float64 seed = any_value();
    const size_t count = one_in(&chance, 10) ? 0 : 1;
    fmi3Float64 found = 0.0;
    switch (below(&chance, 3)) {
    case 0:
        return fmi3GetOutputDerivatives(instance, &unknown, 1, &order, &found, count);
    case 1:
        return fmi3GetDirectionalDerivative(instance, &unknown, 1, &known, 1, &seed, count, &found, 1);
    default:
        return fmi3GetAdjointDerivative(instance, &unknown, 1, &known, 1, &seed, 1, &found, count);
    }
}

static fmi3Status end(fmi3Instance instance)
{
    if (one_in(&chance, 2)) {
        const fmi3Status status = fmi3Reset(instance);
        CHECK(!instance || status == fmi3OK, "a reset in %d", place);
        place = instance ? NEW : place;
        return status;
    }
    const fmi3Status status = fmi3Terminate(instance);
    CHECK(!instance || (status == fmi3OK) == is_running(), "an end in %d", place);
    if (status == fmi3OK)
        place = ENDED;
    return status;
}

int main(int count, char **arguments)
{
    static fmi3Status (*const calls[])(fmi3Instance) = {
        begin, begin, end_of_initialization, end_of_initialization, enter_event, pass_event, enter_step, enter_step,
        take_step, take_step, take_step, set_number, set_number, read_state, differentiate};
    unsigned long statuses[4] = {0};
    struct view before, after;
    CHECK(count == 3, "usage: abuse3 SEED CALLS");
    chance.state = strtoull(arguments[1], NULL, 10);
    make();
    for (unsigned long n = strtoul(arguments[2], NULL, 10); n > 0; n--) {
        const fmi3Instance instance = one_in(&chance, 200) ? NULL : c;
        look(c, &before);
        const fmi3Status status =
            one_in(&chance, 40) ? end(instance) : calls[below(&chance, sizeof calls / sizeof *calls)](instance);
        CHECK(status <= fmi3Error && (instance || status == fmi3Error), "status %d", status);
        statuses[status]++;
        look(c, &after);
        CHECK(status < fmi3Discard || memcmp(&before, &after, sizeof before) == 0, "a rejected call changes a value");
        if (one_in(&chance, 500)) {
            fmi3FreeInstance(c);
            make();
        }
    }
    fmi3FreeInstance(c);
    CHECK(memory.blocks == 0, "%zu blocks are left", memory.blocks);
    CHECK(statuses[fmi3OK] > 0 && statuses[fmi3Discard] > 0 && updates > 0, "too little was done");
    CHECK((events > 0) == (model.event_slot >= 0), "%lu events", events);
    printf("%lu ok, %lu discard, %lu error, %lu updates, %lu events\n", statuses[fmi3OK], statuses[fmi3Discard],
           statuses[fmi3Error], updates, events);
    return 0;
}
