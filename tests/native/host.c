/* A host for the test programs: callbacks that count and check, random numbers, values by name. */
#include "host.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct memory memory;

void fail(const char *condition, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fflush(stdout);
    fprintf(stderr, "FAILED %s: ", condition);
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\n");
    va_end(arguments);
    exit(1);
}

/* SplitMix64 by Steele, Lea and Flood */
uint64_t draw(struct chance *chance)
{
    uint64_t z = chance->state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

unsigned below(struct chance *chance, unsigned limit)
{
    return (unsigned)(draw(chance) % limit);
}

int one_in(struct chance *chance, unsigned count)
{
    return below(chance, count) == 0;
}

double between(struct chance *chance, double low, double high)
{
    return low + (high - low) * ((double)(draw(chance) >> 11) * 0x1p-53);
}

/* Header of each block: its size and a mark, with a size that keeps the block aligned. */
#define MARK UINT64_C(0x6d61726b6d61726b)
struct block_head {
    uint64_t size;
    uint64_t mark;
};

void *counted_allocate(size_t count, size_t size)
{
    memory.calls++;
    if (memory.refuse_one_in && one_in(&memory.chance, memory.refuse_one_in))
        return NULL;
    struct block_head *block = malloc(sizeof *block + count * size);
    CHECK(block, "the test itself has run out of memory");
    block->size = count * size;
    block->mark = MARK;
    memset(block + 1, 0xA5, count * size); /* so that no program relies on zeros */
    memory.blocks++;
    memory.bytes += count * size;
    if (memory.bytes > memory.most_bytes)
        memory.most_bytes = memory.bytes;
    return block + 1;
}

void counted_free(void *block)
{
    struct block_head *head = (struct block_head *)block - 1;
    memory.calls++;
    CHECK(head->mark == MARK, "freeMemory of what allocateMemory has not given");
    memory.blocks--;
    memory.bytes -= head->size;
    head->mark = 0;
    free(head);
}

void checked_logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                    fmi2String message, ...)
{
    static const char *const categories[] = {"logStatusWarning", "logStatusDiscard", "logStatusError", "logSteps"};
    struct journal *journal = environment;
    va_list arguments;
    int known = 0;
    CHECK(name && category && message, "a message comes with NULL");
    CHECK(strcmp(name, journal->name) == 0, "a message of %s comes with the name %s", journal->name, name);
    for (size_t n = 0; n < sizeof categories / sizeof *categories; n++)
        known |= strcmp(category, categories[n]) == 0;
    CHECK(known, "a message comes in category %s", category);
    CHECK((status == fmi2OK) == (strcmp(category, "logSteps") == 0), "a message with status %d in %s", status,
          category);
    CHECK(*message, "an empty message");
    va_start(arguments, message);
    const int length = vsnprintf(journal->last, sizeof journal->last, message, arguments);
    va_end(arguments);
    CHECK(length > 0 && (size_t)length < sizeof journal->last, "a message of %d characters", length);
    journal->messages++;
    journal->status = status;
}

fmi2Component instantiate(struct journal *journal, const char *name)
{
    const fmi2CallbackFunctions callbacks = {checked_logger, counted_allocate, counted_free, NULL, journal};
    journal->name = name;
    return fmi2Instantiate(name, fmi2CoSimulation, model.guid, "file:///resources", &callbacks, fmi2False, fmi2True);
}

fmi2ValueReference reference_of(const char *name)
{
    for (size_t n = 0; n < model.variable_count; n++)
        if (strcmp(model.variables[n].name, name) == 0)
            return (fmi2ValueReference)n;
    fail("reference_of", "the model has no %s", name);
}

enum kind kind_of(const struct variable *variable)
{
    return variable->kind == ENUMERATION ? INTEGER : variable->kind;
}

fmi2Status set_value(fmi2Component c, fmi2ValueReference reference, double value)
{
    const fmi2Integer whole = (fmi2Integer)fmax(fmin(value, 2e9), -2e9);
    switch (kind_of(&model.variables[reference])) {
    case INTEGER:
        return fmi2SetInteger(c, &reference, 1, &whole);
    case BOOLEAN:
        return fmi2SetBoolean(c, &reference, 1, &whole);
    default:
        return fmi2SetReal(c, &reference, 1, &value);
    }
}

double real_value(fmi2Component c, const char *name)
{
    const fmi2ValueReference reference = reference_of(name);
    fmi2Real value = 0.0;
    CHECK(fmi2GetReal(c, &reference, 1, &value) == fmi2OK, "reading %s", name);
    return value;
}

void start(fmi2Component c, const struct setting *settings)
{
    CHECK(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK, "setupExperiment");
    for (; settings->name; settings++)
        CHECK(set_value(c, reference_of(settings->name), settings->value) == fmi2OK, "setting %s", settings->name);
    CHECK(fmi2EnterInitializationMode(c) == fmi2OK, "enterInitializationMode");
    CHECK(fmi2ExitInitializationMode(c) == fmi2OK, "exitInitializationMode");
}
