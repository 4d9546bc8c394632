/* A C host: steps a native FMU in a loop and prints how long it took.

   loop LIBRARY GUID STEP STEPS BATCH REPEATS TOLERANCE OUT OUT REFERENCE=VALUE ...

   Before each step the first two values given are set, after it two outputs are read. Prints the wall time
   a step of each batch, ns, one a line; then both outputs; then, from REPEATS runs of the same motion, the
   worst step, ns: each step's shortest time counts, so that what else the machine does does not. */
#include <dlfcn.h>
#include <fmi2Functions.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static fmi2InstantiateTYPE *instantiate;
static fmi2SetupExperimentTYPE *setup;
static fmi2EnterInitializationModeTYPE *enter;
static fmi2ExitInitializationModeTYPE *leave;
static fmi2SetRealTYPE *set_real;
static fmi2SetIntegerTYPE *set_integer;
static fmi2GetRealTYPE *get_real;
static fmi2DoStepTYPE *do_step;
static fmi2ResetTYPE *reset;

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
    if (!found)
        must(fmi2Error, name);
    return found;
}

struct run {
    fmi2Component c;
    double step, tolerance;
    long steps, batch;
    fmi2ValueReference outputs[2], inputs[2];
    double values[2], read[2];
};

/* Set the values given, i12=3 for an Integer, and initialise. */
static void start(struct run *run, int count, char **given)
{
    must(setup(run->c, fmi2True, run->tolerance, 0.0, fmi2False, 0.0), "setupExperiment");
    for (int n = 0; n < count; n++) {
        char *rest;
        const int whole = given[n][0] == 'i';
        const fmi2ValueReference reference = (unsigned)strtol(given[n] + whole, &rest, 10);
        const double value = atof(rest + 1);
        const int number = (int)value;
        if (whole)
            must(set_integer(run->c, &reference, 1, &number), "setInteger");
        else
            must(set_real(run->c, &reference, 1, &value), "setReal");
        if (n < 2) {
            run->inputs[n] = reference;
            run->values[n] = value;
        }
    }
    must(enter(run->c), "enterInitializationMode");
    must(leave(run->c), "exitInitializationMode");
}

static void advance(struct run *run, long n)
{
    set_real(run->c, run->inputs, 2, run->values);
    must(do_step(run->c, run->step * (double)n, run->step, fmi2True), "doStep");
    get_real(run->c, run->outputs, 2, run->read);
}

static void time_batches(struct run *run)
{
    for (long n = 0; n < run->steps; n += run->batch) {
        const double begin = now();
        for (long m = n; m < n + run->batch; m++)
            advance(run, m);
        printf("%.1f\n", (now() - begin) / (double)run->batch);
    }
    printf("outputs %.17g %.17g\n", run->read[0], run->read[1]);
}

static void time_steps(struct run *run, double *shortest)
{
    for (long n = 0; n < run->steps; n++) {
        const double begin = now();
        advance(run, n);
        shortest[n] = fmin(shortest[n], now() - begin);
    }
}

int main(int count, char **arguments)
{
    if (count < 12)
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
    *(void **)&reset = function(library, "fmi2Reset");
    *(void **)&do_step = function(library, "fmi2DoStep");

    struct run run = {.step = atof(arguments[3]), .steps = atol(arguments[4]), .batch = atol(arguments[5])};
    const int repeats = atoi(arguments[6]);
    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    double *shortest = malloc(sizeof(double) * (size_t)run.steps);
    double worst = 0.0;
    run.tolerance = atof(arguments[7]);
    run.outputs[0] = (unsigned)atoi(arguments[8]);
    run.outputs[1] = (unsigned)atoi(arguments[9]);
    run.c = instantiate("loop", fmi2CoSimulation, arguments[2], "", &callbacks, fmi2False, fmi2True);
    if (!run.c || !shortest)
        return 1;
    for (long n = 0; n < run.steps; n++)
        shortest[n] = HUGE_VAL;
    start(&run, count - 10, arguments + 10);
    time_batches(&run);
    for (int n = 0; n < repeats; n++) {
        must(reset(run.c), "reset");
        start(&run, count - 10, arguments + 10);
        time_steps(&run, shortest);
    }
    for (long n = 0; repeats && n < run.steps; n++)
        worst = fmax(worst, shortest[n]);
    printf("worst %.1f\n", worst);
    return 0;
}
