/* The functions of FMI 3.0 as a WebAssembly component offers them (FMI-LS-WASM, draft of July 2026).
 *
 * By the canonical ABI of the component model a list or a text is a pointer and a length, in memory that the host has
 * asked cabi_realloc for and that the function called frees; what does not fit one number is answered by a pointer
 * to memory that the host copies before its next call. An instance is known by its address.
 */
#include "fmi3.h"

#include <stdlib.h>
#include <string.h>

#define CO_SIMULATION "fmi:fmi3/co-simulation@3.0.0#"
#define EXPORT(name) __attribute__((export_name(name)))
#define METHOD(name) EXPORT(CO_SIMULATION "[method]co-simulation-instance." name)
#define IMPORT(module, name) __attribute__((import_module(module), import_name(name)))

typedef struct instance *Instance;

/* Texts and lists as they come. */
struct text {
    char *letters;
    size_t length;
};
struct list {
    void *items;
    size_t count;
};

/* Answers: a value, or a status that is an error. */
struct listed {
    uint8_t failed;
    union {
        uint8_t status;
        struct list list;
    } is;
};
struct stepped {
    uint8_t failed;
    union {
        uint8_t status;
        struct {
            double last_successful_time;
            bool event_handling_needed, terminate_simulation, early_return;
        } result;
    } is;
};
struct updated {
    uint8_t failed;
    union {
        uint8_t status;
        struct {
            bool needs_update, terminates, nominals_changed, values_changed, next_event_defined;
            double next_event;
        } info;
    } is;
};
struct counted {
    uint8_t failed;
    union {
        uint8_t status;
        uint64_t count;
    } is;
};
struct instantiated {
    uint8_t done;
    int32_t handle;
};

IMPORT("fmi:fmi3/callbacks@3.0.0", "log-message")
void log_message(const char *name, size_t name_length, int32_t status, const char *category, size_t category_length,
                 const char *message, size_t message_length);
IMPORT("[export]fmi:fmi3/co-simulation@3.0.0", "[resource-new]co-simulation-instance") int32_t new_handle(Instance c);

EXPORT("cabi_realloc")
void *reallocate(void *old, size_t old_size, size_t alignment, size_t size)
{
    (void)old_size;
    (void)alignment; /* of 16 bytes it always is */
    void *const memory = size > 0 ? realloc(old, size) : NULL;
    if (size > 0 && !memory)
        __builtin_trap();
    return memory;
}

/* The list of the last answer, kept until the next one. */
static void *answered(size_t count, size_t size)
{
    static void *kept;
    free(kept);
    kept = calloc(count > 0 ? count : 1, size);
    if (!kept)
        __builtin_trap();
    return kept;
}

/* Whether a call has failed; then its status goes where the value would be. */
static uint8_t has_failed(fmi3Status status, uint8_t *instead)
{
    if (status > fmi3Warning)
        *instead = (uint8_t)status;
    return status > fmi3Warning;
}

static struct listed *answer(fmi3Status status, void *items, size_t count)
{
    static struct listed listed;
    listed.is.list = (struct list){items, count};
    listed.failed = has_failed(status, &listed.is.status);
    return &listed;
}

/* Free what was given; the address of none of something is any. */
static void drop_given(void *items, size_t count)
{
    if (count > 0)
        free(items);
}

/* A text that ends with a zero; to be freed. */
static char *ended(char *letters, size_t length)
{
    letters = reallocate(length > 0 ? letters : NULL, length, 1, length + 1);
    letters[length] = '\0';
    return letters;
}

static void free_texts(struct text *texts, size_t count)
{
    for (size_t n = 0; n < count; n++)
        drop_given(texts[n].letters, texts[n].length);
    drop_given(texts, count);
}

/* Length of a text without a letter of UTF-8 that was cut at its end: hosts take whole ones only. */
static size_t whole_length(const char *text)
{
    const size_t length = strlen(text);
    size_t start = length;
    while (start > 0 && ((unsigned char)text[start - 1] & 0xC0) == 0x80)
        start--;
    const unsigned char first = start > 0 ? (unsigned char)text[start - 1] : 0;
    const size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 1;
    return size > 1 && length - start + 1 < size ? start - 1 : length;
}

static void tell(fmi3InstanceEnvironment name, fmi3Status status, fmi3String category, fmi3String message)
{
    log_message(name, strlen(name), status, category, strlen(category), message, whole_length(message));
}

EXPORT("fmi:fmi3/common@3.0.0#get-version")
struct text *get_version(void)
{
    static struct text version;
    version = (struct text){(char *)(uintptr_t)fmi3GetVersion(), strlen(fmi3GetVersion())};
    return &version;
}

/* Life. An intermediate update is never called for: the draft lets hosts leave out the callback, and no component that
 * imports it is linked by one that does. */
EXPORT(CO_SIMULATION "[static]co-simulation-instance.instantiate-co-simulation")
struct instantiated *instantiate(char *name, size_t name_length, char *token, size_t token_length, char *resources,
                                 size_t resources_length, int32_t visible, int32_t logging, int32_t event_mode,
                                 int32_t early_return, uint32_t *intermediate, size_t intermediate_count)
{
    static struct instantiated result;
    name = ended(name, name_length);
    token = ended(token, token_length);
    resources = ended(resources, resources_length);
    struct component *const c =
        fmi3InstantiateCoSimulation(name, token, resources, visible, logging, event_mode, early_return, intermediate,
                                    intermediate_count, name, tell, NULL);
    if (c)
        c->environment = c->core.name;
    free(name);
    free(token);
    free(resources);
    drop_given(intermediate, intermediate_count);
    result = (struct instantiated){c != NULL, c ? new_handle(&c->core) : 0};
    return &result;
}

EXPORT(CO_SIMULATION "[dtor]co-simulation-instance")
void drop(Instance c)
{
    fmi3FreeInstance(c);
}

METHOD("set-debug-logging")
int32_t set_debug_logging(Instance c, int32_t on, struct text *given, size_t count)
{
    const char **const categories = reallocate(NULL, 0, 4, (count + 1) * sizeof *categories);
    for (size_t n = 0; n < count; n++)
        categories[n] = given[n].letters = ended(given[n].letters, given[n].length++);
    const fmi3Status status = fmi3SetDebugLogging(c, on, count, categories);
    free(categories);
    free_texts(given, count);
    return status;
}

METHOD("enter-initialization-mode")
int32_t enter_initialization_mode(Instance c, int32_t tolerance_defined, double tolerance, double start_time,
                                  int32_t stop_time_defined, double stop_time)
{
    return fmi3EnterInitializationMode(c, tolerance_defined, tolerance, start_time, stop_time_defined, stop_time);
}

/* Functions that take and answer nothing else. */
#define PLAIN(Call, name)            \
    METHOD(name)                     \
    int32_t plain_##Call(Instance c) \
    {                                \
        return fmi3##Call(c);        \
    }
PLAIN(ExitInitializationMode, "exit-initialization-mode")
PLAIN(EnterEventMode, "enter-event-mode")
PLAIN(EnterStepMode, "enter-step-mode")
PLAIN(Terminate, "terminate")
PLAIN(Reset, "reset")
PLAIN(EnterConfigurationMode, "enter-configuration-mode")
PLAIN(ExitConfigurationMode, "exit-configuration-mode")
PLAIN(EvaluateDiscreteStates, "evaluate-discrete-states")

METHOD("update-discrete-states")
struct updated *update_discrete_states(Instance c)
{
    static struct updated updated;
    memset(&updated, 0, sizeof updated);
    const fmi3Status status = fmi3UpdateDiscreteStates(
        c, &updated.is.info.needs_update, &updated.is.info.terminates, &updated.is.info.nominals_changed,
        &updated.is.info.values_changed, &updated.is.info.next_event_defined, &updated.is.info.next_event);
    updated.failed = has_failed(status, &updated.is.status);
    return &updated;
}

METHOD("do-step")
struct stepped *do_step(Instance c, double time, double step, int32_t no_state_prior)
{
    static struct stepped stepped;
    memset(&stepped, 0, sizeof stepped);
    const fmi3Status status =
        fmi3DoStep(c, time, step, no_state_prior, &stepped.is.result.event_handling_needed,
                   &stepped.is.result.terminate_simulation, &stepped.is.result.early_return,
                   &stepped.is.result.last_successful_time);
    stepped.failed = has_failed(status, &stepped.is.status);
    return &stepped;
}

/* The pair of functions for a type. */
#define ACCESS(Type, type)                                                                                     \
    METHOD("get-" type)                                                                                        \
    struct listed *get_##Type(Instance c, uint32_t *references, size_t count)                                  \
    {                                                                                                          \
        fmi3##Type *const values = answered(count, sizeof *values);                                            \
        const fmi3Status status = fmi3Get##Type(c, references, count, values, count);                          \
        drop_given(references, count);                                                                         \
        return answer(status, values, count);                                                                  \
    }                                                                                                          \
    METHOD("set-" type)                                                                                        \
    int32_t set_##Type(Instance c, uint32_t *references, size_t count, fmi3##Type *values, size_t value_count) \
    {                                                                                                          \
        const fmi3Status status = fmi3Set##Type(c, references, count, values, value_count);                    \
        drop_given(references, count);                                                                         \
        drop_given(values, value_count);                                                                       \
        return status;                                                                                         \
    }
ACCESS(Float32, "float32")
ACCESS(Float64, "float64")
ACCESS(Int8, "int8")
ACCESS(Int16, "int16")
ACCESS(Int32, "int32")
ACCESS(Int64, "int64")
ACCESS(UInt8, "uint8")
ACCESS(UInt16, "uint16")
ACCESS(UInt32, "uint32")
ACCESS(UInt64, "uint64")
ACCESS(Boolean, "boolean")

/* No variable is of these types: what is asked for more than none of is refused. */
#define NONE_OF(Type, type, Value, ...)                                             \
    METHOD("get-" type)                                                             \
    struct listed *get_##Type(Instance c, uint32_t *references, size_t count)       \
    {                                                                               \
        Value *const values = NULL;                                                 \
        const fmi3Status status = fmi3Get##Type(c, references, count, __VA_ARGS__); \
        drop_given(references, count);                                              \
        return answer(status, answered(0, 1), 0);                                   \
    }
NONE_OF(String, "string", fmi3String, values, 0)
NONE_OF(Binary, "binary", fmi3Binary, NULL, values, 0)
NONE_OF(Clock, "clock", fmi3Clock, values)

METHOD("set-string")
int32_t set_string(Instance c, uint32_t *references, size_t count, struct text *values, size_t value_count)
{
    drop_given(references, count);
    free_texts(values, value_count);
    return fmi3SetString(c, NULL, count, NULL, 0);
}

METHOD("set-binary")
int32_t set_binary(Instance c, uint32_t *references, size_t count, struct text *values, size_t value_count)
{
    drop_given(references, count);
    free_texts(values, value_count);
    return fmi3SetBinary(c, NULL, count, NULL, NULL, 0);
}

METHOD("set-clock")
int32_t set_clock(Instance c, uint32_t *references, size_t count, bool *values, size_t value_count)
{
    drop_given(references, count);
    drop_given(values, value_count);
    return fmi3SetClock(c, NULL, count, NULL);
}

/* Functions that are not offered, whatever they are given. */
#define LISTS_NOTHING(Call, name, ...)                                     \
    METHOD(name)                                                           \
    struct listed *list_##Call(Instance c, void *references, size_t count) \
    {                                                                      \
        drop_given(references, count);                                     \
        return answer(fmi3##Call(c, NULL, count, __VA_ARGS__), NULL, 0);   \
    }
LISTS_NOTHING(GetIntervalDecimal, "get-interval-decimal", NULL, NULL)
LISTS_NOTHING(GetIntervalFraction, "get-interval-fraction", NULL, NULL, NULL)
LISTS_NOTHING(GetShiftDecimal, "get-shift-decimal", NULL)
LISTS_NOTHING(GetShiftFraction, "get-shift-fraction", NULL, NULL)

#define SETS_NOTHING(Call, name, ...)                                                                \
    METHOD(name)                                                                                     \
    int32_t set_##Call(Instance c, void *references, size_t count, void *values, size_t value_count) \
    {                                                                                                \
        drop_given(references, count);                                                               \
        drop_given(values, value_count);                                                             \
        return fmi3##Call(c, NULL, count, __VA_ARGS__);                                              \
    }
SETS_NOTHING(SetIntervalDecimal, "set-interval-decimal", NULL)
SETS_NOTHING(SetIntervalFraction, "set-interval-fraction", NULL, NULL)
SETS_NOTHING(SetShiftDecimal, "set-shift-decimal", NULL)
SETS_NOTHING(SetShiftFraction, "set-shift-fraction", NULL, NULL)

METHOD("get-number-of-variable-dependencies")
struct counted *count_dependencies(Instance c, uint32_t reference)
{
    static struct counted counted;
    size_t count = 0;
    const fmi3Status status = fmi3GetNumberOfVariableDependencies(c, reference, &count);
    counted.is.count = count;
    counted.failed = has_failed(status, &counted.is.status);
    return &counted;
}

METHOD("get-variable-dependencies")
struct listed *list_dependencies(Instance c, uint32_t reference)
{
    return answer(fmi3GetVariableDependencies(c, reference, NULL, NULL, NULL, NULL, 0), NULL, 0);
}

/* States: serialized at once, so that a host never holds one that belongs to an instance. */
METHOD("get-fmu-state")
struct listed *get_fmu_state(Instance c)
{
    fmi3FMUState state = NULL;
    fmi3Byte *bytes = NULL;
    size_t size = 0;
    fmi3Status status = fmi3GetFMUState(c, &state);
    if (status == fmi3OK)
        status = fmi3SerializedFMUStateSize(c, state, &size);
    if (status == fmi3OK) {
        bytes = answered(size, 1);
        status = fmi3SerializeFMUState(c, state, bytes, size);
    }
    fmi3FreeFMUState(c, &state);
    return answer(status, bytes, size);
}

METHOD("set-fmu-state")
int32_t set_fmu_state(Instance c, fmi3Byte *bytes, size_t size)
{
    fmi3FMUState state = NULL;
    fmi3Status status = fmi3DeserializeFMUState(c, bytes, size, &state);
    if (status == fmi3OK)
        status = fmi3SetFMUState(c, state);
    fmi3FreeFMUState(c, &state);
    drop_given(bytes, size);
    return status;
}

/* Derivatives. */
#define DERIVATIVE(Call, name, answers)                                                                            \
    METHOD(name)                                                                                                   \
    struct listed *get_##Call(Instance c, uint32_t *unknowns, size_t unknown_count, uint32_t *knowns,              \
                              size_t known_count, double *seed, size_t seed_count)                                 \
    {                                                                                                              \
        double *const derivatives = answered(answers, sizeof *derivatives);                                        \
        const fmi3Status status = fmi3Get##Call(c, unknowns, unknown_count, knowns, known_count, seed, seed_count, \
                                                derivatives, answers);                                             \
        drop_given(unknowns, unknown_count);                                                                       \
        drop_given(knowns, known_count);                                                                           \
        drop_given(seed, seed_count);                                                                              \
        return answer(status, derivatives, answers);                                                               \
    }
DERIVATIVE(DirectionalDerivative, "get-directional-derivative", unknown_count)
DERIVATIVE(AdjointDerivative, "get-adjoint-derivative", known_count)

/* Pairs of a reference and an order, taken apart into the two halves of a new array; to be freed. */
static uint32_t *taken_apart(const uint32_t *pairs, size_t count)
{
    uint32_t *const apart = reallocate(NULL, 0, 4, (2 * count + 1) * sizeof *apart);
    for (size_t n = 0; n < count; n++) {
        apart[n] = pairs[2 * n];
        apart[count + n] = pairs[2 * n + 1];
    }
    return apart;
}

METHOD("get-output-derivatives")
struct listed *get_output_derivatives(Instance c, uint32_t *pairs, size_t count)
{
    uint32_t *const references = taken_apart(pairs, count);
    double *const values = answered(count, sizeof *values);
    const fmi3Status status =
        fmi3GetOutputDerivatives(c, references, count, (const fmi3Int32 *)references + count, values, count);
    free(references);
    drop_given(pairs, count);
    return answer(status, values, count);
}

/* FMI 3.0 has no such function, the draft has: the core's, which FMI 2.0 offers, does. */
METHOD("set-input-derivatives")
int32_t set_input_derivatives(Instance c, uint32_t *pairs, size_t count, double *values, size_t value_count)
{
    uint32_t *const references = taken_apart(pairs, count);
    fmi3Status status = check_count(c, count, value_count);
    if (status == fmi3OK)
        status = (fmi3Status)set_rates(c, references, count, (const int32_t *)references + count, values);
    free(references);
    drop_given(pairs, count);
    drop_given(values, value_count);
    return status;
}
