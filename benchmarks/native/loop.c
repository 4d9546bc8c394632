/* A C host: steps a native FMU in a loop and prints how long each batch of steps, and each step, took.

   loop LIBRARY GUID STEP STEPS BATCH TOLERANCE OUT OUT REFERENCE=VALUE ...

   Before each step the first two values given are set, after it two outputs are read. Prints the wall time
   a step of each batch, ns, one a line; then the worst single step, ns; then both outputs. */
#include <dlfcn.h>
#include <fmi2Functions.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define MOST_VALUES 32

static fmi2InstantiateTYPE *instantiate;
static fmi2SetupExperimentTYPE *setup;
static fmi2EnterInitializationModeTYPE *enter;
static fmi2ExitInitializationModeTYPE *leave;
static fmi2SetRealTYPE *set_real;
static fmi2SetIntegerTYPE *set_integer;
static fmi2GetRealTYPE *get_real;
static fmi2DoStepTYPE *do_step;

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e9 * (double)time.tv_sec + (double)time.tv_nsec;
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...)
{
    (void)environment;
    (void)name;
    (void)status;
    (void)category;
    va_list arguments;
    va_start(arguments, message);
    vfprintf(stderr, message, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static void must(fmi2Status status, const char *what)
{
    if (status != fmi2OK) {
        fprintf(stderr, "%s answers %d\n", what, (int)status);
        exit(1);
    }
}

static void *function(void *library, const char *name)
{
    void *found = dlsym(library, name);
    if (!found && name[4] != 'S') /* the empty FMU has no Integers */
        must(fmi2Error, name);
    return found;
}

int main(int count, char **arguments)
{
    if (count < 11)
        return 2;
    void *library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        fprintf(stderr, "%s\n", dlerror());
        return 1;
    }
    *(void **)&instantiate = function(library, "fmi2Instantiate");
    *(void **)&setup = function(library, "fmi2SetupExperiment");
    *(void **)&enter = function(library, "fmi2EnterInitializationMode");
    *(void **)&leave = function(library, "fmi2ExitInitializationMode");
    *(void **)&set_real = function(library, "fmi2SetReal");
    *(void **)&set_integer = function(library, "fmi2SetInteger");
    *(void **)&get_real = function(library, "fmi2GetReal");
    *(void **)&do_step = function(library, "fmi2DoStep");

    const double step = atof(arguments[3]);
    const long steps = atol(arguments[4]), batch = atol(arguments[5]);
    const fmi2ValueReference outputs[2] = {(unsigned)atoi(arguments[7]), (unsigned)atoi(arguments[8])};
    fmi2ValueReference references[MOST_VALUES];
    double values[MOST_VALUES], read[2], worst = 0.0;
    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};

    fmi2Component c = instantiate("loop", fmi2CoSimulation, arguments[2], "", &callbacks, fmi2False, fmi2True);
    if (!c)
        return 1;
    must(setup(c, fmi2True, atof(arguments[6]), 0.0, fmi2False, 0.0), "setupExperiment");
    for (int n = 9; n < count && n - 9 < MOST_VALUES; n++) {
        char *rest;
        const int whole = arguments[n][0] == 'i'; /* i12=3 sets an Integer */
        references[n - 9] = (unsigned)strtol(arguments[n] + whole, &rest, 10);
        values[n - 9] = atof(rest + 1);
        const int number = (int)values[n - 9];
        if (whole)
            must(set_integer(c, &references[n - 9], 1, &number), "setInteger");
        else
            must(set_real(c, &references[n - 9], 1, &values[n - 9]), "setReal");
    }
    must(enter(c), "enterInitializationMode");
    must(leave(c), "exitInitializationMode");

    /* batches: one look at the clock each */
    for (long n = 0; n < steps; n += batch) {
        const double begin = now();
        for (long m = n; m < n + batch; m++) {
            set_real(c, references, 2, values);
            must(do_step(c, step * (double)m, step, fmi2True), "doStep");
            get_real(c, outputs, 2, read);
        }
        printf("%.1f\n", (now() - begin) / (double)batch);
    }
    printf("outputs %.17g %.17g\n", read[0], read[1]);
    /* once more, each step on its own */
    for (long m = steps; m < 2 * steps; m++) {
        const double begin = now();
        set_real(c, references, 2, values);
        must(do_step(c, step * (double)m, step, fmi2True), "doStep");
        get_real(c, outputs, 2, read);
        const double passed = now() - begin;
        if (passed > worst)
            worst = passed;
    }
    printf("worst %.1f\n", worst);
    return 0;
}
