/* A host in a locale with decimal commas: prints the messages of rejected numbers. */
#include "host.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

int main(void)
{
    static struct journal journal;
    const fmi2ValueReference input = 0;
    const fmi2Real speed = 1234567.5;
    char number[32];
    CHECK(setlocale(LC_ALL, ""), "the locale of the environment");
    snprintf(number, sizeof number, "%.1f", 1.5);
    CHECK(strcmp(number, "1.5") != 0, "the locale writes %s", number);
    const fmi2Component c = instantiate(&journal, "instance");
    CHECK(fmi2SetupExperiment(c, fmi2True, -1.5, 0.0, fmi2False, 0.0) == fmi2Error, "a bad tolerance");
    printf("%s\n", journal.last);
    CHECK(fmi2SetupExperiment(c, fmi2False, 0.0, NAN, fmi2False, 0.0) == fmi2Error, "a bad start");
    printf("%s\n", journal.last);
    fmi2EnterInitializationMode(c);
    CHECK(fmi2ExitInitializationMode(c) == fmi2OK, "initialisation");
    fmi2SetReal(c, &input, 1, &speed);
    CHECK(fmi2DoStep(c, 0.0, 0.01, fmi2True) == fmi2Discard, "a bad input");
    printf("%s\n", journal.last);
    fmi2FreeInstance(c);
    return 0;
}
