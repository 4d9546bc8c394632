/* In front of pythonfmu's library, in the Python FMU: calls go through to it, with what it leaves undone.
 *
 * pythonfmu 0.7 decodes nothing but %20 of the URI of the resources and follows a null pointer where the folder is then
 * not found; it answers fmi2OK to what the slave refuses, and after a discarded step that the simulation is at its end.
 * Here the URI becomes a path, and a call is answered by the worst status that the slave has logged in it.
 */
#include "front.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST_MESSAGE 1024
#define OLDEST_PYTHON 11 /* of Python 3 */

/* All functions of the library that are called. */
#define FUNCTIONS(DO)                                                                                               \
    DO(Instantiate) DO(FreeInstance) DO(SetupExperiment) DO(EnterInitializationMode) DO(ExitInitializationMode)     \
    DO(Terminate) DO(Reset) DO(GetReal) DO(GetInteger) DO(GetBoolean) DO(GetString) DO(SetReal) DO(SetInteger)      \
    DO(SetBoolean) DO(SetString) DO(GetFMUstate) DO(SetFMUstate) DO(FreeFMUstate) DO(SerializedFMUstateSize)        \
    DO(SerializeFMUstate) DO(DeSerializeFMUstate) DO(GetDirectionalDerivative) DO(SetRealInputDerivatives)          \
    DO(GetRealOutputDerivatives) DO(DoStep) DO(CancelStep) DO(GetStatus) DO(GetRealStatus) DO(GetIntegerStatus)     \
    DO(GetStringStatus)

#define FIELD(name) fmi2##name##TYPE *name;
static struct {
    FUNCTIONS(FIELD)
} theirs;

enum category { LOG_WARNING, LOG_DISCARD, LOG_ERROR, LOG_ALL, CATEGORIES };
static const char *const category_names[CATEGORIES] = {
    "logStatusWarning", "logStatusDiscard", "logStatusError", "logAll"};

struct front {
    fmi2Component inner;
    fmi2CallbackFunctions host;
    fmi2CallbackFunctions own; /* what the library calls */
    fmi2Status worst;          /* logged in the call at hand */
    int logged[CATEGORIES];
};

/* What the library logs: its category may be NULL, and the text of its own errors is no format. */
static void take_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                         fmi2String category, fmi2String message, ...)
{
    struct front *front = environment;
    const enum category kind = status == fmi2Warning ? LOG_WARNING
                               : status == fmi2Discard ? LOG_DISCARD
                               : status >= fmi2Error ? LOG_ERROR
                                                     : LOG_ALL;
    (void)category;
    if (status > front->worst)
        front->worst = status;
    if (!front->host.logger || !(kind == LOG_ERROR || front->logged[kind]))
        return;
    if (status == fmi2Fatal)
        front->host.logger(front->host.componentEnvironment, name, fmi2Error, category_names[kind], "%s", message);
    else
        front->host.logger(front->host.componentEnvironment, name, status, category_names[kind], message);
}

static fmi2Component refuse(const fmi2CallbackFunctions *callbacks, fmi2String name, const char *reason,
                            const char *value)
{
    char message[LONGEST_MESSAGE];
    snprintf(message, sizeof message, reason, value);
    if (callbacks && callbacks->logger)
        callbacks->logger(callbacks->componentEnvironment, name ? name : "", fmi2Error,
                          category_names[LOG_ERROR], "%s", message);
    return NULL;
}

/* Find the functions of the library; NULL, or the name of one that it has not. */
static const char *find_functions(void *library)
{
    void *address;
#define FIND(name)                                       \
    if (!(address = find_symbol(library, "fmi2" #name))) \
        return "fmi2" #name;                             \
    memcpy(&theirs.name, &address, sizeof address);
    FUNCTIONS(FIND)
    return NULL;
}

static int digit_of(char letter)
{
    const char *const digits = "0123456789abcdef0123456789ABCDEF", *const found = letter ? strchr(digits, letter) : NULL;
    return found ? (int)(found - digits) % 16 : -1;
}

/* The path of a file URI, or the text as it is; with what %41 stands for, or not. A path too long is cut off. */
static void take_path(char *path, const char *uri, int decoded)
{
    if (strncmp(uri, "file:", 5) == 0) {
        uri += 5;
        if (strncmp(uri, "//", 2) == 0) /* an authority, empty or localhost, ends at the next slash */
            for (uri += 2; *uri && *uri != '/'; uri++)
                ;
    }
    if (uri[0] == '/' && uri[1] && uri[2] == ':') /* a drive of Windows */
        uri++;
    for (const char *const end = path + LONGEST_PATH - 1; *uri && path < end; uri++) {
        const int high = decoded && *uri == '%' ? digit_of(uri[1]) : -1, low = high >= 0 ? digit_of(uri[2]) : -1;
        *path++ = low >= 0 ? (char)(16 * high + low) : *uri;
        uri += low >= 0 ? 2 : 0;
    }
    *path = '\0';
}

/* Find the folder of the resources; hosts do not agree on whether its URI is encoded. */
static int find_resources(char *path, const char *uri)
{
    for (int decoded = 1; decoded >= 0; decoded--) {
        take_path(path, uri, decoded);
        if (to_plain_path(path) && has_file(path, "slavemodule.txt"))
            return strstr(path, "%20") == NULL && strstr(path, "file://") == NULL; /* the library replaces these */
    }
    return 0;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    const char *reason = "", *version;
    void *library;
    if (!callbacks || !name || !*name || type != fmi2CoSimulation)
        return refuse(callbacks, name, "an instance must have a name and be of type fmi2CoSimulation%s", "");
    if (!resources)
        return refuse(callbacks, name, "the resource location must be the URI of a folder, is NULL%s", "");
    if (!(version = python_version()))
        return refuse(callbacks, name, "Python must be 3.11 or later in the process of this FMU, there is none%s", "");
    if (strtol(version, NULL, 10) != 3 || strtol(version + 2, NULL, 10) < OLDEST_PYTHON)
        return refuse(callbacks, name, "Python must be 3.11 or later, is %s", version);
    if (!(library = load_library(&reason)))
        return refuse(callbacks, name, "pythonfmu cannot be loaded: %s", reason);
    if ((reason = find_functions(library)))
        return refuse(callbacks, name, "pythonfmu has no %s", reason);
    char path[LONGEST_PATH];
    if (!find_resources(path, resources))
        return refuse(callbacks, name, "the resource location must be the URI of this FMU's resources, in a folder"
                      " whose name pythonfmu can read, is %s", resources);
    struct front *front = calloc(1, sizeof *front);
    if (!front)
        return refuse(callbacks, name, "there is not enough memory%s", "");
    front->host = *callbacks;
    front->own = (fmi2CallbackFunctions){take_message, callbacks->allocateMemory, callbacks->freeMemory, NULL, front};
    for (int n = 0; n < CATEGORIES; n++)
        front->logged[n] = logging != 0;
    front->inner = theirs.Instantiate(name, type, guid, path, &front->own, visible, fmi2True);
    if (front->inner)
        return front;
    free(front);
    return NULL;
}

void fmi2FreeInstance(fmi2Component component)
{
    struct front *front = component;
    if (!front)
        return;
    theirs.FreeInstance(front->inner);
    free(front);
}

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    struct front *front = component;
    int chosen[CATEGORIES] = {0};
    if (!front)
        return fmi2Error;
    for (size_t n = 0; n < count; n++) {
        int found = 0;
        while (found < CATEGORIES && (!categories || !categories[n] || strcmp(categories[n], category_names[found])))
            found++;
        if (found == CATEGORIES) {
            refuse(&front->host, "", "a log category must be logStatusWarning, logStatusDiscard, logStatusError or"
                   " logAll, is %.64s", categories && categories[n] ? categories[n] : "NULL");
            return fmi2Error;
        }
        chosen[found] = 1;
    }
    for (int n = 0; n < CATEGORIES; n++)
        if (count == 0 || chosen[n] || chosen[LOG_ALL])
            front->logged[n] = on != 0;
    return fmi2OK;
}

/* pythonfmu follows null pointers. */
static fmi2Status without(const struct front *front, const char *call)
{
    refuse(&front->host, "", "the arguments of %s must be given, one is NULL", call);
    return fmi2Error;
}

/* A refused step ends no simulation. */
fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (!component)
        return fmi2Error;
    if (kind != fmi2Terminated || !value)
        return fmi2Discard;
    *value = fmi2False;
    return fmi2OK;
}

/* pythonfmu lets the host keep the pointer to what it has freed. */
fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    const struct front *front = component;
    if (!front)
        return fmi2Error;
    if (state && *state)
        theirs.FreeFMUstate(front->inner, state);
    if (state)
        *state = NULL;
    return fmi2OK;
}

/* A call that goes through if what it needs is given: answered by its own status or the worst that is logged in it. */
#define PASS(name, given, parameters, arguments)                            \
    fmi2Status fmi2##name parameters                                        \
    {                                                                       \
        struct front *front = c;                                            \
        if (!front)                                                         \
            return fmi2Error;                                               \
        if (!(given))                                                       \
            return without(front, "fmi2" #name);                            \
        front->worst = fmi2OK;                                              \
        const fmi2Status status = theirs.name arguments;                    \
        return status > front->worst ? status : front->worst;               \
    }
#define REFERENCES const fmi2ValueReference references[], size_t count
#define READ(name, type)                                                                           \
    PASS(name, count == 0 || (references && values), (fmi2Component c, REFERENCES, type values[]), \
         (front->inner, references, count, values))
#define CALL(name) PASS(name, 1, (fmi2Component c), (front->inner))
#define ASK(name, type) \
    PASS(name, value, (fmi2Component c, const fmi2StatusKind kind, type *value), (front->inner, kind, value))
#define RATES(name, type)                                                                  \
    PASS(name, 1, (fmi2Component c, REFERENCES, const fmi2Integer order[], type values[]), \
         (front->inner, references, count, order, values))

CALL(EnterInitializationMode)
CALL(ExitInitializationMode)
CALL(Terminate)
CALL(Reset)
CALL(CancelStep)
READ(GetReal, fmi2Real)
READ(GetInteger, fmi2Integer)
READ(GetBoolean, fmi2Boolean)
READ(GetString, fmi2String)
READ(SetReal, const fmi2Real)
READ(SetInteger, const fmi2Integer)
READ(SetBoolean, const fmi2Boolean)
READ(SetString, const fmi2String)
ASK(GetStatus, fmi2Status)
ASK(GetRealStatus, fmi2Real)
ASK(GetIntegerStatus, fmi2Integer)
ASK(GetStringStatus, fmi2String)
RATES(SetRealInputDerivatives, const fmi2Real)
RATES(GetRealOutputDerivatives, fmi2Real)
PASS(SetupExperiment, 1,
     (fmi2Component c, fmi2Boolean is_tolerance, fmi2Real tolerance, fmi2Real begin, fmi2Boolean is_end, fmi2Real end),
     (front->inner, is_tolerance, tolerance, begin, is_end, end))
PASS(DoStep, 1, (fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_state_prior),
     (front->inner, time, step, no_state_prior))
PASS(GetDirectionalDerivative, 1,
     (fmi2Component c, const fmi2ValueReference unknowns[], size_t unknown_count, REFERENCES, const fmi2Real direction[],
      fmi2Real derivative[]),
     (front->inner, unknowns, unknown_count, references, count, direction, derivative))
PASS(GetFMUstate, state, (fmi2Component c, fmi2FMUstate *state), (front->inner, state))
PASS(SetFMUstate, state, (fmi2Component c, fmi2FMUstate state), (front->inner, state))
PASS(SerializedFMUstateSize, state && size, (fmi2Component c, fmi2FMUstate state, size_t *size),
     (front->inner, state, size))
PASS(SerializeFMUstate, state && bytes, (fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size),
     (front->inner, state, bytes, size))
PASS(DeSerializeFMUstate, bytes && state,
     (fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state),
     (front->inner, bytes, size, state))

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}
