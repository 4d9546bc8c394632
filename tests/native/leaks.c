/* Life cycles of instances, one after the other, to be run under a memory checker: leaks COUNT. */
#include "snapshot.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STATES 3

static void initialize(fmi2Component c, unsigned long life)
{
    if (model.tolerance_slot >= 0) { /* kinematic, rigid and elastic in turn, averaged in one of 500 */
        static const double fidelities[] = {0.0, 2.0, 3.0};
        set_value(c, reference_of("fidelity"), life % 500 == 1 ? 1.0 : fidelities[life % 3]);
    }
    fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0);
    CHECK(fmi2EnterInitializationMode(c) == fmi2OK && fmi2ExitInitializationMode(c) == fmi2OK, "life %lu", life);
}

/* Save, serialize, read and restore states; fmi2FreeInstance frees some of them. */
static void save_and_restore(fmi2Component c, unsigned long life)
{
    fmi2FMUstate states[STATES] = {NULL};
    size_t size;
    for (int n = 0; n < STATES - 1; n++)
        CHECK(fmi2GetFMUstate(c, &states[n]) == fmi2OK, "life %lu", life);
    CHECK(fmi2SerializedFMUstateSize(c, states[0], &size) == fmi2OK, "life %lu", life);
    fmi2Byte *const bytes = malloc(size);
    CHECK(bytes, "the test itself has run out of memory");
    CHECK(fmi2SerializeFMUstate(c, states[0], bytes, size) == fmi2OK, "life %lu", life);
    CHECK(fmi2DeSerializeFMUstate(c, bytes, size, &states[STATES - 1]) == fmi2OK, "life %lu", life);
    free(bytes);
    CHECK(fmi2SetFMUstate(c, states[STATES - 1]) == fmi2OK, "life %lu", life);
    if (life % 2 == 0)
        CHECK(fmi2FreeFMUstate(c, &states[0]) == fmi2OK && !states[0], "life %lu", life);
}

static void live(unsigned long life)
{
    static struct journal journal;
    const fmi2ValueReference input = 0;
    const fmi2Real speed = 100.0, bad = 1e300;
    struct snapshot snapshot;
    const fmi2Component c = instantiate(&journal, "instance");
    CHECK(c, "life %lu", life);
    if (life % 7 == 0) { /* freed without terminate */
        fmi2FreeInstance(c);
        return;
    }
    initialize(c, life);
    for (int n = 0; n < 3; n++) {
        CHECK(fmi2SetReal(c, &input, 1, n == 1 ? &bad : &speed) == fmi2OK, "life %lu", life);
        CHECK(fmi2DoStep(c, n * 1e-4, 1e-4, fmi2True) == (n == 1 ? fmi2Discard : fmi2OK), "life %lu", life);
    }
    take_snapshot(c, &snapshot);
    save_and_restore(c, life);
    if (life % 5 == 0)
        fmi2Terminate(c);
    if (life % 3 == 0)
        fmi2Reset(c);
    fmi2FreeInstance(c);
}

int main(int count, char **arguments)
{
    CHECK(count == 2, "usage: leaks COUNT");
    const unsigned long lives = strtoul(arguments[1], NULL, 10);
    for (unsigned long life = 0; life < lives; life++)
        live(life);
    CHECK(memory.blocks == 0 && memory.bytes == 0, "%zu blocks are left", memory.blocks);
    printf("%lu instances lived\n", lives);
    return 0;
}
