/* A value reference that no variable has, between used ones: gap REFERENCE. */
#include "host.h"

#include <stdlib.h>

int main(int count, char **arguments)
{
    static struct journal journal;
    static const struct setting none[] = {{NULL, 0.0}};
    const fmi2Component c = instantiate(&journal, "instance");
    fmi2Real value = 7.0, one = 1.0;
    fmi2Integer whole = 7, order = 1;
    CHECK(count == 2, "usage: gap REFERENCE");
    const fmi2ValueReference gap = (fmi2ValueReference)atoi(arguments[1]), input = 0, before = gap - 1, after = gap + 1;
    CHECK(model.variables[before].kind == REAL && model.variables[after].kind == REAL, "the gap is elsewhere");
    start(c, none);
    CHECK(fmi2GetReal(c, &before, 1, &value) == fmi2OK && fmi2GetReal(c, &after, 1, &value) == fmi2OK, "neighbours");
    CHECK(fmi2GetReal(c, &gap, 1, &value) == fmi2Error && fmi2SetReal(c, &gap, 1, &value) == fmi2Error, "Real");
    CHECK(fmi2GetInteger(c, &gap, 1, &whole) == fmi2Error && fmi2SetInteger(c, &gap, 1, &whole) == fmi2Error, "Integer");
    CHECK(fmi2GetBoolean(c, &gap, 1, &whole) == fmi2Error && fmi2SetBoolean(c, &gap, 1, &whole) == fmi2Error, "Boolean");
    CHECK(fmi2GetRealOutputDerivatives(c, &gap, 1, &order, &value) == fmi2Error, "the rate of an output");
    CHECK(fmi2GetDirectionalDerivative(c, &gap, 1, &input, 1, &one, &value) == fmi2Error, "an unknown");
    CHECK(fmi2GetDirectionalDerivative(c, &before, 1, &gap, 1, &one, &value) == fmi2Error, "a known");
    CHECK(fmi2DoStep(c, 0.0, 1e-3, fmi2True) == fmi2OK, "step");
    fmi2FreeInstance(c);
    return 0;
}
