/* Drives an FMU through random calls: abuse SEED CALLS. Ends with status 0 if all calls behave correctly.
 *
 * A rejected call must change nothing that can be read; a status is one of four; and after all of it an
 * instance that is reset runs as a fresh one does, bit for bit.
 */
#include "abuse.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define INSTANCES 5
#define TRAJECTORY_STEPS 40

struct chance chance;
struct slot slots[INSTANCES];
const unsigned slot_count = INSTANCES;
struct serialized serialized;
static unsigned long steps;
static const char *const names[INSTANCES] = {"a", "%s%n", "instance with a longer name", "ü", "a"};
static const struct action *const groups[] = {value_actions, state_actions, life_actions};

static const struct action *some_action(void)
{
    static unsigned total;
    if (total == 0)
        for (unsigned n = 0; n < sizeof groups / sizeof *groups; n++)
            for (const struct action *action = groups[n]; action->name; action++)
                total += action->weight;
    unsigned place = below(&chance, total);
    for (unsigned n = 0; n < sizeof groups / sizeof *groups; n++)
        for (const struct action *action = groups[n]; action->name; action++) {
            if (place < action->weight)
                return action;
            place -= action->weight;
        }
    fail("some_action", "weights");
}

static void make(struct slot *slot)
{
    memset(slot, 0, sizeof *slot);
    slot->stop = INFINITY;
    slot->c = instantiate(&slot->journal, names[slot - slots]);
}

/* Reset an instance and compare its run with the run of a new one. */
static void compare_with_fresh(struct slot *slot)
{
    struct journal journal;
    const unsigned refuse_one_in = memory.refuse_one_in;
    memory.refuse_one_in = 0;
    memset(&journal, 0, sizeof journal);
    const fmi2Component fresh = instantiate(&journal, "fresh");
    CHECK(fresh && fmi2Reset(slot->c) == fmi2OK, "reset");
    CHECK(trajectory(slot->c, TRAJECTORY_STEPS) == trajectory(fresh, TRAJECTORY_STEPS),
          "an instance that was reset runs otherwise than a fresh one");
    fmi2FreeInstance(fresh);
    slot->stage = RUNNING;
    slot->stop = INFINITY;
    memory.refuse_one_in = refuse_one_in;
}

/* Execute one action and return 1 if it made a call. */
static int act(const struct action *action, struct slot *slot, unsigned long statuses[4])
{
    const fmi2Component c = one_in(&chance, 300) ? NULL : slot->c;
    const int watched = one_in(&chance, 8);
    const enum stage stage = slot->stage;
    struct snapshot before, after;
    const unsigned states = slot->states;
    if (watched)
        take_snapshot(slot->c, &before);
    const struct answer answer = action->run(slot, c);
    if (answer.no_call)
        return 0;
    CHECK(answer.status == fmi2OK || answer.status == fmi2Warning || answer.status == fmi2Discard ||
          answer.status == fmi2Error, "%s answers %d", action->name, answer.status);
    CHECK(c || answer.status == fmi2Error || strcmp(action->name, "wrong") == 0 || strcmp(action->name, "free") == 0,
          "%s without an instance answers %d", action->name, answer.status);
    statuses[answer.status]++;
    steps += answer.status == fmi2OK && strcmp(action->name, "step") == 0;
    if (watched && slot->c && answer.status >= fmi2Discard && strcmp(action->name, "revive") != 0) {
        take_snapshot(slot->c, &after);
        CHECK(is_same(&before, &after, stage == slot->stage) && states == slot->states,
              "%s, rejected in stage %d, changes %s: %s", action->name, stage, difference(&before, &after),
              slot->journal.last);
    }
    return 1;
}

int main(int count, char **arguments)
{
    CHECK(count == 3, "usage: abuse SEED CALLS");
    const unsigned long calls = strtoul(arguments[2], NULL, 10);
    unsigned long statuses[4] = {0}, made = 0, compared = 0;
    double slowest = 0.0;
    const char *slowest_name = "";
    chance.state = memory.chance.state = strtoull(arguments[1], NULL, 10);
    memory.refuse_one_in = 1000;
    while (made < calls) {
        struct slot *slot = &slots[below(&chance, INSTANCES)];
        if (!slot->c) {
            make(slot);
            continue;
        }
        const struct action *const action = some_action();
        const clock_t begin = clock();
        made += (unsigned long)act(action, slot, statuses);
        const double passed = (double)(clock() - begin) / CLOCKS_PER_SEC;
        if (passed > slowest) {
            slowest = passed;
            slowest_name = action->name;
        }
        if (slot->c && one_in(&chance, 20000)) {
            compare_with_fresh(slot);
            compared++;
        }
    }
    for (unsigned n = 0; n < INSTANCES; n++) {
        if (!slots[n].c)
            continue;
        compare_with_fresh(&slots[n]);
        compared++;
        fmi2FreeInstance(slots[n].c);
    }
    CHECK(memory.blocks == 0, "%zu blocks are left", memory.blocks);
    printf("%lu calls: %lu ok (%lu steps), %lu warning, %lu discard, %lu error;"
           " %lu instances compared with fresh ones; slowest call %s %.3f s\n",
           made, statuses[0], steps, statuses[1], statuses[2], statuses[3], compared, slowest_name, slowest);
    return 0;
}
