/* Random arguments. */
#include "abuse.h"

#include <float.h>
#include <math.h>

#define LONGEST_TRAVEL 20.0

double any_number(void)
{
    static const double special[] = {0.0, -0.0, 1e6, -1e6, 1e12, 1e-160, 4e-320, 1e15, -1e300, DBL_MAX, -DBL_MAX};
    switch (below(&chance, 6)) {
    case 0:
        return NAN;
    case 1:
        return one_in(&chance, 2) ? INFINITY : -INFINITY;
    case 2:
        return ldexp(between(&chance, -1.0, 1.0), (int)below(&chance, 2000) - 1000);
    default:
        return special[below(&chance, sizeof special / sizeof *special)];
    }
}

double value_for(const struct variable *variable)
{
    const double low = fmax(variable->minimum, -1e12), high = fmin(variable->maximum, 1e12);
    if (one_in(&chance, 30))
        return any_number();
    if (variable->array == INPUTS)
        return one_in(&chance, 50) ? between(&chance, low, high) : between(&chance, -2.0, 3.0) * variable->nominal;
    switch (below(&chance, 8)) {
    case 0:
        return low;
    case 1:
        return high;
    case 2:
        return between(&chance, low, high);
    case 3:
        return low + (high - low) * pow(10.0, between(&chance, -14.0, 0.0));
    case 4:
        return variable->start * pow(10.0, between(&chance, -3.0, 3.0));
    default:
        return variable->start * between(&chance, 0.3, 3.0);
    }
}

/* Angle that the mechanism turns and the shaft oscillates in one second, rad; 1 for a model without both. */
static double turning(fmi2Component c)
{
    static const char *const names[] = {"sun_radius", "satellite_radius", "shaft_stiffness", "output_inertia",
                                        "driven_inertia", "omega1", "omega2", "omega_out"};
    static const char *const whole_names[] = {"z2", "z16", "z17", "z6", "layout", "fidelity"};
    enum { SUN, SATELLITE, STIFFNESS, HUB, DRIVEN, OMEGA1, OMEGA2, OMEGA_OUT, REALS };
    enum { Z2, Z16, Z17, Z6, LAYOUT, FIDELITY, WHOLES };
    fmi2ValueReference references[REALS];
    fmi2Real real[REALS];
    fmi2Integer whole[WHOLES];
    if (model.tolerance_slot < 0)
        return 1.0;
    for (int n = 0; n < REALS; n++)
        references[n] = reference_of(names[n]);
    if (fmi2GetReal(c, references, REALS, real) != fmi2OK)
        return 1.0;
    for (int n = 0; n < WHOLES; n++)
        references[n] = reference_of(whole_names[n]);
    fmi2GetInteger(c, references, WHOLES, whole);
    const double gain = whole[LAYOUT] ? real[SUN] / real[SATELLITE]
                                      : (double)whole[Z2] / whole[Z16] * (1.0 + (double)whole[Z17] / whole[Z6]);
    const double speed = fabs(real[OMEGA1]) + fabs(real[OMEGA2]) + fabs(real[OMEGA_OUT]);
    const double swing =
        whole[FIDELITY] == 3 ? sqrt(real[STIFFNESS] * (1.0 / real[HUB] + 1.0 / real[DRIVEN])) : 0.0;
    return isfinite(speed) ? gain * speed + swing : 1.0;
}

double some_step(struct slot *slot)
{
    const int is_long = one_in(&chance, 100);
    const double step = pow(10.0, is_long ? between(&chance, -3.0, -1.0) : between(&chance, -7.0, -3.3));
    return fmin(step, LONGEST_TRAVEL / (1.0 + turning(slot->c)) * between(&chance, 0.1, 1.0));
}

unsigned some_references(fmi2ValueReference *references, enum kind kind, enum array array)
{
    const unsigned count = below(&chance, MOST_REFERENCES);
    for (unsigned n = 0; n < count; n++) {
        references[n] = below(&chance, (unsigned)model.variable_count);
        if (one_in(&chance, 100))
            references[n] = (fmi2ValueReference)(one_in(&chance, 2) ? draw(&chance) : model.variable_count);
        else if (!one_in(&chance, 50))
            for (int tries = 0; tries < 200; tries++) {
                const struct variable *variable = &model.variables[references[n]];
                if (kind_of(variable) == kind && (array == ARRAYS || variable->array == array))
                    break;
                references[n] = below(&chance, (unsigned)model.variable_count);
            }
    }
    return count;
}

void choose_parameters(struct slot *slot)
{
    const unsigned changes = below(&chance, 5);
    if (model.tolerance_slot >= 0) {
        /* the initialization of averaged takes long */
        static const double fidelities[] = {0.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0};
        const double fidelity = one_in(&chance, 60) ? 1.0 : fidelities[below(&chance, 8)];
        set_value(slot->c, reference_of("fidelity"), fidelity);
        set_value(slot->c, reference_of("method"), one_in(&chance, 3));
    }
    for (unsigned n = 0; n < changes; n++) {
        const fmi2ValueReference reference = below(&chance, (unsigned)model.variable_count);
        const struct variable *variable = &model.variables[reference];
        if (variable->array == PARAMETERS)
            set_value(slot->c, reference, value_for(variable));
    }
}
