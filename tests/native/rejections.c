/* Rejections that random calls rarely cause. */
#include "snapshot.h"

#include <math.h>
#include <string.h>

static const struct setting none[] = {{NULL, 0.0}};

static fmi2ValueReference first_output(void)
{
    for (fmi2ValueReference n = 0; n < model.variable_count; n++)
        if (model.variables[n].output)
            return n;
    fail("first_output", "the model has no output");
}

/* An input that is not finite has no derivative. An earlier version returned 0. */
static void no_derivative_at_an_infinite_input(fmi2Component c)
{
    const fmi2ValueReference input = 0, output = first_output();
    const fmi2Real bad[] = {INFINITY, -INFINITY, NAN}, direction = 1.0;
    fmi2Real derivative;
    for (int n = 0; n < 3; n++) {
        CHECK(fmi2Reset(c) == fmi2OK, "reset");
        start(c, none);
        CHECK(fmi2SetReal(c, &input, 1, &bad[n]) == fmi2OK, "setting an input");
        CHECK(fmi2GetDirectionalDerivative(c, &output, 1, &input, 1, &direction, &derivative) == fmi2Discard,
              "a derivative at %g", bad[n]);
    }
}

/* A rejected step changes neither the present time nor the single warning of a wrong communication point. */
static void refused_steps_leave_time_and_warning(fmi2Component c, struct journal *journal)
{
    fmi2Real time;
    CHECK(fmi2Reset(c) == fmi2OK, "reset");
    start(c, none);
    CHECK(fmi2DoStep(c, 0.0, -0.01, fmi2True) == fmi2Discard && journal->status == fmi2Discard, "a step backwards");
    CHECK(fmi2DoStep(c, 7.0, NAN, fmi2True) == fmi2Discard && journal->status == fmi2Discard, "a step that is none");
    CHECK(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &time) == fmi2OK && time == 0.0, "the time is %g", time);
    const unsigned long messages = journal->messages;
    CHECK(fmi2DoStep(c, 0.0, 0.01, fmi2True) == fmi2OK && journal->messages == messages, "a good step");
    CHECK(fmi2DoStep(c, 5.0, 0.01, fmi2True) == fmi2OK && journal->status == fmi2Warning, "a step elsewhere");
    CHECK(journal->messages == messages + 1, "one warning");
}

/* A tolerance of setupExperiment is valid from the beginning of initialization, independent of other calls. */
static void tolerance_of_the_experiment_wins(fmi2Component c)
{
    if (model.tolerance_slot < 0)
        return;
    CHECK(fmi2Reset(c) == fmi2OK, "reset");
    CHECK(fmi2SetupExperiment(c, fmi2True, 1e-4, 0.0, fmi2False, 0.0) == fmi2OK, "setupExperiment");
    CHECK(set_value(c, reference_of("tolerance"), 1e-5) == fmi2OK, "setting tolerance");
    CHECK(fmi2EnterInitializationMode(c) == fmi2OK && real_value(c, "tolerance") == 1e-4, "the experiment's wins");
    CHECK(set_value(c, reference_of("tolerance"), 1e-5) == fmi2OK, "setting tolerance");
    CHECK(real_value(c, "tolerance") == 1e-4, "the experiment's still wins");
    CHECK(fmi2ExitInitializationMode(c) == fmi2OK && real_value(c, "tolerance") == 1e-4, "the experiment's has won");
}

/* After fmi2Error the last computed values can be read for debugging, as the standard requires. */
static void values_can_be_read_after_an_error(fmi2Component c)
{
    const fmi2ValueReference output = first_output();
    fmi2ValueReference parameter = 0;
    fmi2Real before, value;
    while (model.variables[parameter].array != PARAMETERS || model.variables[parameter].kind != REAL)
        parameter++;
    CHECK(fmi2Reset(c) == fmi2OK, "reset");
    CHECK(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK, "setupExperiment");
    CHECK(fmi2GetReal(c, &output, 1, &value) == fmi2Error, "before initialization there is nothing to read");
    CHECK(fmi2EnterInitializationMode(c) == fmi2OK, "enterInitializationMode");
    CHECK(fmi2GetReal(c, &output, 1, &before) == fmi2OK, "reading in initialization mode");
    CHECK(set_value(c, parameter, NAN) == fmi2OK, "setting a parameter");
    CHECK(fmi2ExitInitializationMode(c) == fmi2Error, "a bad parameter");
    for (fmi2ValueReference n = 0; n < model.variable_count; n++)
        if (model.variables[n].kind == REAL)
            CHECK(fmi2GetReal(c, &n, 1, &value) == fmi2OK, "reading %s after an error", model.variables[n].name);
    CHECK(fmi2GetReal(c, &output, 1, &value) == fmi2OK && value == before, "the value last calculated");
    CHECK(fmi2GetReal(c, &parameter, 1, &value) == fmi2OK && isnan(value), "the parameter that is to blame");
    CHECK(fmi2DoStep(c, 0.0, 0.01, fmi2True) == fmi2Error, "a step after an error");
}

int main(void)
{
    static struct journal journal;
    const fmi2Component c = instantiate(&journal, "instance");
    no_derivative_at_an_infinite_input(c);
    refused_steps_leave_time_and_warning(c, &journal);
    tolerance_of_the_experiment_wins(c);
    values_can_be_read_after_an_error(c);
    fmi2FreeInstance(c);
    return 0;
}
