/* Loads shared libraries of FMUs like a host, and drives an instance of each in turn.
 *
 * Arguments: for each instance the library, the GUID, the version of FMI, the value references of the Reals to read
 * separated by commas, and settings type:reference:value (r Real, i Integer, b Boolean, e enumeration); then "--".
 * Environment variables: GLOBAL loads the libraries with RTLD_GLOBAL. TRAPS lets floating-point exceptions interrupt.
 * FLUSH sets subnormal numbers to zero (on x86-64), like programs compiled with -ffast-math.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fenv.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"
#include "fmi3FunctionTypes.h"
#include "instance.h"

#define MANY 128
#define STEPS 12
#define STEP 2e-3

struct setting {
    char type;
    unsigned reference;
    double value;
};

struct loaded {
    void *library, *instance;
    const char *guid;
    int version;
    double time;
    unsigned outputs[MANY];
    size_t output_count;
    struct setting settings[MANY];
    size_t setting_count;
};

static void *function(const struct loaded *loaded, const char *name)
{
    void *const found = dlsym(loaded->library, name);
    if (!found) {
        printf("%s is missing\n", name);
        exit(1);
    }
    return found;
}

/* A function of FMI 2.0 or 3.0 with the type in its header. */
#define CALL2(name) (*(fmi2##name##TYPE **)&(void *){function(loaded, "fmi2" #name)})
#define CALL3(name) (*(fmi3##name##TYPE **)&(void *){function(loaded, "fmi3" #name)})

static void print_bits(const char *name, int status, const double *values, size_t count)
{
    printf("%s %d", name, status);
    for (size_t n = 0; n < count; n++) {
        uint64_t bits;
        memcpy(&bits, &values[n], sizeof bits);
        printf(" %016" PRIx64, bits);
    }
    printf("\n");
}

static void take_message2(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                 fmi2String message, ...)
{
    (void)environment;
    printf("%s: %d %s %s\n", name, status, category, message);
}

static void take_message3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    (void)environment;
    printf("%d %s %s\n", status, category, message);
}

static void update3(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean set, fmi3Boolean get,
                    fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early_return, fmi3Float64 *until)
{
    struct loaded *const loaded = environment;
    double values[MANY];
    const fmi3Status status =
        CALL3(GetFloat64)(loaded->instance, loaded->outputs, loaded->output_count, values, loaded->output_count);
    (void)set;
    (void)get;
    (void)can_return;
    (void)early_return;
    (void)until;
    print_bits(finished ? "end" : "within", status, &time, 1);
    print_bits("update", status, values, loaded->output_count);
}

static int set_value(struct loaded *loaded, const struct setting *setting)
{
    const unsigned reference = setting->reference;
    const int32_t whole = setting->type == 'r' ? 0 : (int32_t)setting->value;
    const int64_t large = whole;
    const fmi3Boolean truth = whole != 0;
    if (loaded->version == 2)
        return setting->type == 'r'   ? CALL2(SetReal)(loaded->instance, &reference, 1, &setting->value)
               : setting->type == 'b' ? CALL2(SetBoolean)(loaded->instance, &reference, 1, &whole)
                                      : CALL2(SetInteger)(loaded->instance, &reference, 1, &whole);
    return setting->type == 'r'   ? CALL3(SetFloat64)(loaded->instance, &reference, 1, &setting->value, 1)
           : setting->type == 'b' ? CALL3(SetBoolean)(loaded->instance, &reference, 1, &truth, 1)
           : setting->type == 'e' ? CALL3(SetInt64)(loaded->instance, &reference, 1, &large, 1)
                                  : CALL3(SetInt32)(loaded->instance, &reference, 1, &whole, 1);
}

static void read_outputs(struct loaded *loaded)
{
    double values[MANY] = {0.0};
    const int status =
        loaded->version == 2
            ? (int)CALL2(GetReal)(loaded->instance, loaded->outputs, loaded->output_count, values)
            : (int)CALL3(GetFloat64)(loaded->instance, loaded->outputs, loaded->output_count, values,
                                     loaded->output_count);
    print_bits("outputs", status, values, loaded->output_count);
}

static int step(struct loaded *loaded, double length)
{
    if (loaded->version == 2) {
        const fmi2Status status = CALL2(DoStep)(loaded->instance, loaded->time, length, fmi2True);
        if (status == fmi2OK)
            loaded->time += length;
        return status;
    }
    bool needs_events, terminates, early;
    double reached = loaded->time;
    const fmi3Status status = CALL3(DoStep)(loaded->instance, loaded->time, length, true, &needs_events, &terminates,
                                            &early, &reached);
    loaded->time = reached;
    if (status == fmi3OK && needs_events) {
        bool flags[5];
        double next;
        CALL3(EnterEventMode)(loaded->instance);
        CALL3(UpdateDiscreteStates)(loaded->instance, &flags[0], &flags[1], &flags[2], &flags[3], &flags[4], &next);
        CALL3(EnterStepMode)(loaded->instance);
    }
    return status;
}

/* Rejected steps, inputs and parameters change nothing. */
static void be_rejected(struct loaded *loaded)
{
    static const double steps[] = {0.0, -1.0, 5e-324, 1e300, 1e308, INFINITY, NAN};
    static const double values[] = {1e300, 1.7e308, -INFINITY, INFINITY, NAN};
    const double time = loaded->time;
    for (size_t n = 0; n < sizeof steps / sizeof *steps; n++)
        printf("step %d\n", step(loaded, steps[n]));
    for (size_t n = 0; n < sizeof values / sizeof *values; n++) {
        loaded->time = values[n];
        printf("time %d\n", step(loaded, n == 1 ? 1.7e308 : 1e-3));
        loaded->time = time;
    }
    for (size_t n = 0; n < loaded->setting_count; n++) {
        struct setting setting = loaded->settings[n];
        if (setting.type != 'r')
            continue;
        for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
            setting.value = values[k];
            printf("set %d\n", set_value(loaded, &setting));
            printf("step %d\n", step(loaded, 1e-3));
        }
        printf("set %d\n", set_value(loaded, &loaded->settings[n]));
    }
}

static void serialize(struct loaded *loaded)
{
    void *state = NULL, *other = NULL;
    size_t size = 0;
    if (loaded->version == 2) {
        CALL2(GetFMUstate)(loaded->instance, &state);
        CALL2(SerializedFMUstateSize)(loaded->instance, state, &size);
        fmi2Byte *const bytes = malloc(size);
        CALL2(SerializeFMUstate)(loaded->instance, state, bytes, size);
        printf("state %d\n", CALL2(DeSerializeFMUstate)(loaded->instance, bytes, size, &other));
        printf("state %d\n", CALL2(SetFMUstate)(loaded->instance, other));
        CALL2(FreeFMUstate)(loaded->instance, &other);
        CALL2(FreeFMUstate)(loaded->instance, &state);
        free(bytes);
    } else {
        CALL3(GetFMUState)(loaded->instance, &state);
        CALL3(SerializedFMUStateSize)(loaded->instance, state, &size);
        fmi3Byte *const bytes = malloc(size);
        CALL3(SerializeFMUState)(loaded->instance, state, bytes, size);
        printf("state %d\n", CALL3(DeserializeFMUState)(loaded->instance, bytes, size, &other));
        printf("state %d\n", CALL3(SetFMUState)(loaded->instance, other));
        CALL3(FreeFMUState)(loaded->instance, &other);
        CALL3(FreeFMUState)(loaded->instance, &state);
        free(bytes);
    }
}

static void differentiate(struct loaded *loaded)
{
    static const double directions[] = {1.0, 1e99, 1e-99, 0.0, 1e308, 1e-300, INFINITY, NAN};
    const unsigned input = 0, output = loaded->outputs[0];
    const int32_t order = 1;
    double value = 0.0;
    for (size_t n = 0; n < sizeof directions / sizeof *directions; n++) {
        int status;
        if (loaded->version == 2)
            status = CALL2(GetDirectionalDerivative)(loaded->instance, &output, 1, &input, 1, &directions[n], &value);
        else
            status = CALL3(GetDirectionalDerivative)(loaded->instance, &output, 1, &input, 1, &directions[n], 1, &value,
                                                     1);
        print_bits("directional", status, &value, 1);
        if (loaded->version == 3)
            status = CALL3(GetAdjointDerivative)(loaded->instance, &output, 1, &input, 1, &directions[n], 1, &value, 1);
        print_bits("adjoint", status, &value, 1);
    }
    const int status = loaded->version == 2
                           ? (int)CALL2(GetRealOutputDerivatives)(loaded->instance, &output, 1, &order, &value)
                           : (int)CALL3(GetOutputDerivatives)(loaded->instance, &output, 1, &order, &value, 1);
    print_bits("rate", status, &value, 1);
}

/* Set valid and rejected rates of an input. */
static void ramp(struct loaded *loaded)
{
    static const double rates[] = {10.0, 1e300, 1e308, INFINITY, NAN};
    const unsigned input = 0;
    const int32_t order = 1;
    for (size_t n = 0; loaded->version == 2 && n < sizeof rates / sizeof *rates; n++) {
        CALL2(SetRealInputDerivatives)(loaded->instance, &input, 1, &order, &rates[n]);
        printf("ramp %d\n", step(loaded, 1e-3));
    }
}

/* Many steps in one call: an addition to FMI, equal in both versions. */
static void take_run(struct loaded *loaded)
{
    static const double lengths[] = {1e-3, 1e-3, 1e-3};
    double rows[4 * MANY] = {0.0};
    struct run run = {loaded->time, 3, lengths, 0, NULL, NULL, loaded->output_count, NULL, rows, MANY};
    uint32_t outputs[MANY];
    for (size_t n = 0; n < loaded->output_count; n++)
        outputs[n] = loaded->outputs[n];
    run.outputs = outputs;
    fmi2Status (*const take)(void *, struct run *) =
        *(fmi2Status(**)(void *, struct run *)) & (void *){function(loaded, "inertiaModuleRun")};
    const int status = take(loaded->instance, &run);
    if (status == fmi2OK)
        loaded->time = run.time;
    print_bits("run", status, rows + 3 * MANY, loaded->output_count);
}

static void instantiate(struct loaded *loaded, int mode)
{
    static const fmi2CallbackFunctions callbacks = {take_message2, calloc, free, NULL, NULL};
    loaded->time = 0.0;
    if (loaded->version == 2)
        loaded->instance =
            CALL2(Instantiate)("instance", fmi2CoSimulation, loaded->guid, "file:///", &callbacks, fmi2False, fmi2True);
    else
        loaded->instance =
            CALL3(InstantiateCoSimulation)("instance", loaded->guid, "/", false, true, mode == 1, mode == 1, NULL, 0,
                                           loaded, take_message3, mode == 2 ? update3 : NULL);
    if (!loaded->instance)
        exit(1);
}

static int initialize(struct loaded *loaded)
{
    int status;
    if (loaded->version == 2) {
        CALL2(SetupExperiment)(loaded->instance, fmi2False, 0.0, 0.0, fmi2True, 1e6);
        for (size_t n = 0; n < loaded->setting_count; n++)
            set_value(loaded, &loaded->settings[n]);
        CALL2(EnterInitializationMode)(loaded->instance);
        read_outputs(loaded);
        status = CALL2(ExitInitializationMode)(loaded->instance);
    } else {
        for (size_t n = 0; n < loaded->setting_count; n++)
            set_value(loaded, &loaded->settings[n]);
        CALL3(EnterInitializationMode)(loaded->instance, false, 0.0, 0.0, true, 1e6);
        read_outputs(loaded);
        status = CALL3(ExitInitializationMode)(loaded->instance);
    }
    printf("initialized %d\n", status);
    return status;
}

/* Rejected parameters and times before the first step. */
static void fail_to_initialize(struct loaded *loaded)
{
    const double tolerances[] = {NAN, INFINITY, 1e308, -1.0};
    for (size_t n = 0; n < loaded->setting_count; n++) {
        const double good = loaded->settings[n].value;
        if (loaded->settings[n].type != 'r')
            continue;
        for (size_t k = 0; k < 3; k++) {
            loaded->settings[n].value = tolerances[k];
            initialize(loaded);
            if (loaded->version == 2)
                CALL2(Reset)(loaded->instance);
            else
                CALL3(Reset)(loaded->instance);
        }
        loaded->settings[n].value = good;
    }
    for (size_t n = 0; n < 4; n++) {
        const double t = tolerances[n];
        printf("experiment %d\n",
               loaded->version == 2
                   ? (int)CALL2(SetupExperiment)(loaded->instance, fmi2True, t, t, fmi2True, t)
                   : (int)CALL3(EnterInitializationMode)(loaded->instance, true, t, t, true, t));
        printf("experiment %d\n",
               loaded->version == 2
                   ? (int)CALL2(SetupExperiment)(loaded->instance, fmi2True, t, 0.0, fmi2False, t)
                   : (int)CALL3(EnterInitializationMode)(loaded->instance, true, t, 0.0, true, t));
        if (loaded->version == 2)
            CALL2(Reset)(loaded->instance);
        else
            CALL3(Reset)(loaded->instance);
    }
}

static void load(struct loaded *loaded, char **words)
{
    loaded->library = dlopen(words[0], RTLD_NOW | (getenv("GLOBAL") ? RTLD_GLOBAL : RTLD_LOCAL));
    if (!loaded->library) {
        printf("%s\n", dlerror());
        exit(1);
    }
    loaded->guid = words[1];
    loaded->version = atoi(words[2]);
    for (char *word = strtok(words[3], ","); word; word = strtok(NULL, ","))
        loaded->outputs[loaded->output_count++] = (unsigned)atoi(word);
    for (words += 4; strcmp(*words, "--") != 0; words++) {
        struct setting *const setting = &loaded->settings[loaded->setting_count++];
        sscanf(*words, "%c:%u:%lf", &setting->type, &setting->reference, &setting->value);
    }
}

#define TRAPPED (FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW)
#define FLUSH_TO_ZERO 0x8040u

static void set_environment(void)
{
    if (getenv("TRAPS"))
        feenableexcept(TRAPPED);
#ifdef __x86_64__
    if (getenv("FLUSH"))
        __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | FLUSH_TO_ZERO);
#endif
}

/* Return 1 if the environment is unchanged since set_environment and no exception flag is set. */
static int is_as_it_was(void)
{
#ifdef __x86_64__
    if (getenv("FLUSH") && (__builtin_ia32_stmxcsr() & FLUSH_TO_ZERO) != FLUSH_TO_ZERO)
        return 0;
#endif
    return fegetexcept() == (getenv("TRAPS") ? TRAPPED : 0) && !fetestexcept(TRAPPED);
}

int main(int count, char **words)
{
    static struct loaded all[8];
    size_t instances = 0;
    for (int n = 1; n < count; n++) {
        load(&all[instances++], words + n);
        while (strcmp(words[n], "--") != 0)
            n++;
    }
    set_environment();
    for (int mode = 0; mode < 3; mode++) {
        for (size_t k = 0; k < instances; k++) {
            instantiate(&all[k], mode);
            fail_to_initialize(&all[k]);
            if (initialize(&all[k]) != fmi2OK)
                return 1;
        }
        for (int n = 0; n < STEPS; n++)
            for (size_t k = 0; k < instances; k++) {
                printf("instance %zu: step %d\n", k, step(&all[k], STEP * (n + 1)));
                read_outputs(&all[k]);
            }
        for (size_t k = 0; k < instances; k++) {
            ramp(&all[k]);
            differentiate(&all[k]);
            serialize(&all[k]);
            be_rejected(&all[k]);
            take_run(&all[k]);
            read_outputs(&all[k]);
        }
        for (size_t k = 0; k < instances; k++) {
            struct loaded *const loaded = &all[k];
            if (loaded->version == 2) {
                CALL2(Terminate)(loaded->instance);
                CALL2(FreeInstance)(loaded->instance);
            } else {
                CALL3(Terminate)(loaded->instance);
                CALL3(FreeInstance)(loaded->instance);
            }
        }
    }
    if (!is_as_it_was())
        printf("the environment is another than before\n");
    return is_as_it_was() ? 0 : 1;
}
