/* Memory of an instance, counted by the callbacks. Prints bytes: an instance, and an instance with a state. */
#include "snapshot.h"

#include <stdio.h>

#define STEPS 2000

/* Set and read values and make steps, some of them rejected, with messages and a log of each step. */
static void use(fmi2Component c, struct journal *journal)
{
    const fmi2String every_step = "logSteps";
    const fmi2ValueReference inputs[] = {0, 1};
    const fmi2Integer orders[] = {1, 1};
    const fmi2Real rates[] = {1.0, 1.0};
    struct snapshot snapshot;
    CHECK(fmi2SetDebugLogging(c, fmi2True, 1, &every_step) == fmi2OK, "logging");
    for (int n = 0; n < STEPS; n++) {
        const fmi2Real values[] = {n % 100 == 50 ? 1e300 : 100.0 + n % 7, 5.0};
        fmi2SetReal(c, inputs, 2, values);
        fmi2SetRealInputDerivatives(c, inputs, 2, orders, rates);
        CHECK(fmi2DoStep(c, n * 1e-3, 1e-3, fmi2True) == (n % 100 == 50 ? fmi2Discard : fmi2OK), "step %d", n);
        take_snapshot(c, &snapshot);
    }
    CHECK(journal->messages >= STEPS, "%lu messages", journal->messages);
}

int main(void)
{
    static const struct setting none[] = {{NULL, 0.0}};
    static struct journal journal;
    fmi2FMUstate state = NULL;
    const fmi2Component c = instantiate(&journal, "instance");
    CHECK(c, "instantiation");
    const size_t of_instance = memory.bytes, calls = memory.calls;
    start(c, none);
    use(c, &journal);
    CHECK(memory.calls == calls, "memory was asked for or freed in initialisation, steps, or setting and reading");
    CHECK(fmi2GetFMUstate(c, &state) == fmi2OK, "saving a state");
    printf("%zu %zu\n", of_instance, memory.bytes);
    CHECK(fmi2FreeFMUstate(c, &state) == fmi2OK && memory.bytes == of_instance, "a state is freed as a whole");
    fmi2FreeInstance(c);
    CHECK(memory.blocks == 0 && memory.bytes == 0, "%zu blocks are left", memory.blocks);
    return 0;
}
