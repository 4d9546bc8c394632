/* Random calls that create, end and reset instances, and switch their logging. */
#include "abuse.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct answer setup(struct slot *slot, fmi2Component c)
{
    const int bad = one_in(&chance, 4);
    const double tolerance = bad ? any_number() : 1e-6, begin = bad ? any_number() : between(&chance, -1.0, 1.0);
    const double stop = bad ? any_number() : begin + pow(10.0, between(&chance, -4.0, 1.0));
    const int has_stop = one_in(&chance, 3);
    const fmi2Status status = fmi2SetupExperiment(c, one_in(&chance, 3), tolerance, begin, has_stop, stop);
    CHECK(!c || slot->stage == NEW || status == fmi2Error, "setupExperiment in stage %d: %d", slot->stage,
          status);
    if (status == fmi2OK) {
        slot->time = begin;
        slot->stop = has_stop ? stop : INFINITY;
    }
    return CALLED(status);
}

static struct answer enter(struct slot *slot, fmi2Component c)
{
    const fmi2Status status = fmi2EnterInitializationMode(c);
    CHECK(!c || (status == fmi2OK) == (slot->stage == NEW), "enterInitializationMode in stage %d: %d",
          slot->stage, status);
    if (status == fmi2OK)
        slot->stage = STARTING;
    return CALLED(status);
}

static struct answer leave(struct slot *slot, fmi2Component c)
{
    const fmi2Status status = fmi2ExitInitializationMode(c);
    if (!c)
        return CALLED(status);
    CHECK(slot->stage == STARTING || status == fmi2Error, "exitInitializationMode in stage %d: %d",
          slot->stage, status);
    CHECK(status == fmi2OK || status == fmi2Error, "exitInitializationMode answers %d", status);
    if (slot->stage == STARTING)
        slot->stage = status == fmi2OK ? RUNNING : BROKEN;
    return CALLED(status);
}

static struct answer terminate(struct slot *slot, fmi2Component c)
{
    const fmi2Status status = fmi2Terminate(c);
    CHECK(!c || (status == fmi2OK) == (slot->stage == RUNNING), "terminate in stage %d: %d", slot->stage, status);
    if (status == fmi2OK)
        slot->stage = ENDED;
    return CALLED(status);
}

static struct answer reset(struct slot *slot, fmi2Component c)
{
    const fmi2Status status = fmi2Reset(c);
    CHECK(!c || status == fmi2OK, "reset answers %d", status);
    if (status == fmi2OK) {
        slot->stage = NEW;
        slot->time = 0.0;
        slot->stop = INFINITY;
    }
    return CALLED(status);
}

/* Bring an instance to the step mode like a correct host, with random parameters. */
static struct answer revive(struct slot *slot, fmi2Component c)
{
    if (!c || slot->stage == RUNNING)
        return NO_CALL;
    reset(slot, c);
    choose_parameters(slot);
    enter(slot, c);
    if (!one_in(&chance, 10))
        return leave(slot, c);
    return CALLED(fmi2OK);
}

static struct answer set_logging(struct slot *slot, fmi2Component c)
{
    static const char *const names[] = {
        "logStatusWarning", "logStatusDiscard", "logStatusError", "logSteps", "logAll", "", "100%s%n%d",
        "a name much longer than any name of a category has a right to be, and with %s near its end %s %s %s %s %n",
        NULL};
    fmi2String categories[4] = {NULL, NULL, NULL, NULL};
    const unsigned count = below(&chance, 4);
    const int rare = one_in(&chance, 4);
    for (unsigned n = 0; n < count; n++)
        categories[n] = names[below(&chance, rare ? 9 : 5)];
    const unsigned long before = slot->journal.messages;
    const fmi2String *const given = one_in(&chance, 50) ? NULL : categories;
    const fmi2Status status = fmi2SetDebugLogging(c, one_in(&chance, 2), count, given);
    CHECK(!c || status != fmi2Error || slot->journal.messages > before, "a rejection is not reported");
    if (c && given && count > 0 && categories[0] == names[6])
        CHECK(strstr(slot->journal.last, "100%s%n%d"), "a message is not escaped: %s", slot->journal.last);
    return CALLED(status);
}

/* Instantiate with wrong arguments, which returns no instance. */
static struct answer instantiate_wrongly(struct slot *slot, fmi2Component c)
{
    struct journal journal = {"x", 0, fmi2OK, ""};
    fmi2CallbackFunctions callbacks = {checked_logger, counted_allocate, counted_free, NULL, &journal};
    fmi2Component made = NULL;
    (void)slot;
    (void)c;
    switch (below(&chance, 6)) {
    case 0:
        made = fmi2Instantiate("x", fmi2CoSimulation, model.guid, "", NULL, fmi2False, fmi2True);
        break;
    case 1:
        journal.name = "";
        made = fmi2Instantiate(one_in(&chance, 2) ? NULL : "", fmi2CoSimulation, model.guid, "", &callbacks,
                               fmi2False, fmi2True);
        break;
    case 2:
        made = fmi2Instantiate("x", fmi2ModelExchange, model.guid, NULL, &callbacks, fmi2False, fmi2True);
        break;
    case 3:
        made = fmi2Instantiate("x", fmi2CoSimulation, "{%s}", NULL, &callbacks, fmi2False, fmi2True);
        break;
    case 4:
        callbacks.logger = NULL;
        made = fmi2Instantiate("x", fmi2CoSimulation, NULL, NULL, &callbacks, fmi2False, fmi2True);
        break;
    default:
        fmi2FreeInstance(NULL);
        CHECK(strcmp(fmi2GetVersion(), "2.0") == 0 && strcmp(fmi2GetTypesPlatform(), "default") == 0, "the version");
    }
    CHECK(!made, "an instance is made against the rules");
    return CALLED(fmi2OK);
}

static struct answer free_instance(struct slot *slot, fmi2Component c)
{
    fmi2FreeInstance(c);
    if (c) {
        slot->c = NULL;
        slot->freed = NULL;
        slot->states = 0;
    }
    return CALLED(fmi2OK);
}

const struct action life_actions[] = {
    {"setup", 5, setup},         {"enter", 5, enter},
    {"leave", 5, leave},         {"terminate", 2, terminate},
    {"reset", 1, reset},         {"revive", 60, revive},
    {"logging", 10, set_logging}, {"wrong", 3, instantiate_wrongly},
    {"free", 1, free_instance},  {NULL, 0, NULL},
};
