/* All readable values of an instance. */
#include "snapshot.h"

#include <math.h>
#include <string.h>

static fmi2Status read_share(fmi2Component c, enum share share, double *values)
{
    fmi2ValueReference references[BOOLEAN + 1][MOST_VARIABLES];
    size_t counts[BOOLEAN + 1] = {0}, filled = 0;
    fmi2Integer whole[MOST_VARIABLES];
    for (size_t n = 0; n < model.variable_count; n++) {
        const struct variable *variable = &model.variables[n];
        if (variable->kind != UNUSED && (variable->array == OUTPUTS) == (share == CALCULATED))
            references[kind_of(variable)][counts[kind_of(variable)]++] = (fmi2ValueReference)n;
    }
    fmi2Status status = fmi2GetReal(c, references[REAL], counts[REAL], values);
    filled = counts[REAL];
    for (int kind = INTEGER; status == fmi2OK && kind <= BOOLEAN; kind++) {
        status = kind == INTEGER ? fmi2GetInteger(c, references[kind], counts[kind], whole)
                                 : fmi2GetBoolean(c, references[kind], counts[kind], whole);
        for (size_t n = 0; status == fmi2OK && n < counts[kind]; n++)
            values[filled++] = whole[n];
    }
    return status;
}

void take_snapshot(fmi2Component c, struct snapshot *snapshot)
{
    memset(snapshot, 0, sizeof *snapshot);
    for (int share = 0; share < SHARES; share++) {
        snapshot->status[share] = read_share(c, (enum share)share, snapshot->values[share]);
        if (snapshot->status[share] != fmi2OK)
            memset(snapshot->values[share], 0, sizeof snapshot->values[share]);
    }
    CHECK(snapshot->status[GIVEN] == fmi2OK, "inputs and parameters can always be read");
    CHECK(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &snapshot->time) == fmi2OK, "the time reached can be read");
}

int is_same(const struct snapshot *one, const struct snapshot *other, int calculated_too)
{
    for (int share = 0; share < SHARES; share++) {
        if (share == CALCULATED && !calculated_too)
            continue;
        if (one->status[share] != other->status[share] ||
            memcmp(one->values[share], other->values[share], sizeof one->values[share]) != 0)
            return 0;
    }
    return memcmp(&one->time, &other->time, sizeof one->time) == 0;
}

const char *difference(const struct snapshot *one, const struct snapshot *other)
{
    for (int share = 0; share < SHARES; share++) {
        size_t place = 0;
        for (int kind = REAL; kind <= BOOLEAN; kind++) {
            for (size_t n = 0; n < model.variable_count; n++) {
                const struct variable *variable = &model.variables[n];
                if ((int)kind_of(variable) != kind || (variable->array == OUTPUTS) != (share == CALCULATED))
                    continue;
                if (memcmp(&one->values[share][place], &other->values[share][place], sizeof(double)) != 0)
                    return variable->name;
                place++;
            }
        }
        if (one->status[share] != other->status[share])
            return share == GIVEN ? "whether parameters can be read" : "whether outputs can be read";
    }
    return memcmp(&one->time, &other->time, sizeof one->time) == 0 ? "nothing" : "the time reached";
}

uint64_t add_bits(uint64_t sum, const struct snapshot *snapshot)
{
    const unsigned char *bytes = (const unsigned char *)snapshot->values;
    for (size_t n = 0; n < sizeof snapshot->values; n++)
        sum = (sum ^ bytes[n]) * UINT64_C(1099511628211);
    return sum;
}

uint64_t trajectory(fmi2Component c, unsigned steps)
{
    static const struct setting none[] = {{NULL, 0.0}};
    const fmi2ValueReference inputs[] = {0, 1};
    const double step = 0.004;
    struct snapshot snapshot;
    uint64_t sum = UINT64_C(14695981039346656037);
    CHECK(model.variables[0].array == INPUTS && model.variables[1].array == INPUTS, "two inputs come first");
    start(c, none);
    for (unsigned n = 0; n < steps; n++) {
        const fmi2Real values[] = {100.0 + 7.0 * (n % 3), 10.0 * sin(n)};
        CHECK(fmi2SetReal(c, inputs, 2, values) == fmi2OK, "setting inputs");
        CHECK(fmi2DoStep(c, n * step, step, fmi2True) == fmi2OK, "step %u", n);
        take_snapshot(c, &snapshot);
        sum = add_bits(sum, &snapshot);
    }
    return sum;
}
