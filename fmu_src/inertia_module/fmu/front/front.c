/* The library in front of pythonfmu's, in the Python FMU: it passes calls on and adds what pythonfmu lacks.
 *
 * pythonfmu 0.7 decodes only %20 in the URI of the resources and follows a null pointer if it does not find the folder.
 * It crashes on an instance name that is not UTF-8, loses a saved state when a call writes over its pointer, uses any
 * pointer as a state, returns fmi2OK for rejected calls, and ends the simulation after a discarded step.
 * This library turns the URI into a path, keeps the name and the states of an instance, and returns the worst status
 * that the slave has logged in a call.
 */
#include "front.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST_MESSAGE 1024
#define OLDEST_PYTHON 11 /* of Python 3 */
#define INNER_NAME "instance" /* of each instance in pythonfmu; the host's name may be in any encoding */

/* All functions of the library that are called. */
#define FUNCTIONS(DO)                                                                                               \
    DO(Instantiate) DO(FreeInstance) DO(SetupExperiment) DO(EnterInitializationMode) DO(ExitInitializationMode)     \
    DO(Terminate) DO(Reset) DO(GetReal) DO(GetInteger) DO(GetBoolean) DO(SetReal) DO(SetInteger) DO(SetBoolean)     \
    DO(GetFMUstate) DO(SetFMUstate) DO(FreeFMUstate) DO(SerializedFMUstateSize) DO(SerializeFMUstate)               \
    DO(DeSerializeFMUstate) DO(GetDirectionalDerivative) DO(SetRealInputDerivatives) DO(GetRealOutputDerivatives)   \
    DO(DoStep) DO(GetRealStatus)

#define FIELD(name) fmi2##name##TYPE *name;
static struct {
    FUNCTIONS(FIELD)
} theirs;

enum category { LOG_WARNING, LOG_DISCARD, LOG_ERROR, LOG_ALL, CATEGORIES };
static const char *const category_names[CATEGORIES] = {
    "logStatusWarning", "logStatusDiscard", "logStatusError", "logAll"};

/* A saved state, an object of Python, in the list of its instance. */
struct saved {
    struct saved *next;
    fmi2FMUstate inner;
};

struct front {
    fmi2Component inner;
    fmi2CallbackFunctions host;
    fmi2CallbackFunctions own; /* for the library */
    fmi2Status worst;          /* status logged in the current call */
    struct saved *states;
    int logged[CATEGORIES];
    char name[];
};

static enum category category_of(fmi2Status status)
{
    return status == fmi2Warning   ? LOG_WARNING
           : status == fmi2Discard ? LOG_DISCARD
           : status >= fmi2Error   ? LOG_ERROR
                                   : LOG_ALL;
}

static int is_logged(const struct front *front, enum category category)
{
    return front->host.logger && (category == LOG_ERROR || front->logged[category]);
}

/* Take a message of the library: its category may be NULL, and the text of its own errors is no format. */
static void take_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                         fmi2String category, fmi2String message, ...)
{
    struct front *front = environment;
    const enum category kind = category_of(status);
    (void)name;
    (void)category;
    if (status > front->worst)
        front->worst = status;
    if (!is_logged(front, kind))
        return;
    if (status == fmi2Fatal)
        front->host.logger(front->host.componentEnvironment, front->name, fmi2Error, category_names[kind], "%s",
                           message);
    else
        front->host.logger(front->host.componentEnvironment, front->name, status, category_names[kind], message);
}

/* Log a message if its category is on and return the status. */
static fmi2Status report(const struct front *front, fmi2Status status, const char *format, ...)
{
    const enum category kind = category_of(status);
    char message[LONGEST_MESSAGE];
    va_list arguments;
    if (!is_logged(front, kind))
        return status;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    front->host.logger(front->host.componentEnvironment, front->name, status, category_names[kind], "%s", message);
    return status;
}

/* The place of a state in the list of its instance, or NULL if the instance has saved no such state. */
static struct saved **find_state(struct front *front, const void *state)
{
    for (struct saved **place = &front->states; *place; place = &(*place)->next)
        if (*place == state)
            return place;
    return NULL;
}

static void remove_state(struct front *front, struct saved **place)
{
    struct saved *const saved = *place;
    *place = saved->next;
    theirs.FreeFMUstate(front->inner, &saved->inner);
    free(saved);
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

/* The path of a file URI, in any case of its scheme, or the text as it is; with %41 decoded, or not. Too long a path is
   cut off. */
static void take_path(char *path, const char *uri, int decoded)
{
    static const char scheme[] = "file";
    size_t length = 0;
    while (scheme[length] && (uri[length] | 0x20) == scheme[length])
        length++;
    if (!scheme[length] && uri[length] == ':') {
        uri += length + 1;
        if (strncmp(uri, "//", 2) == 0) {
            uri += 2;
            if (!(uri[0] && uri[1] == ':')) /* an authority, such as localhost, ends at the next slash */
                while (*uri && *uri != '/')
                    uri++;
        }
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

/* Find the folder of the resources and the GUID in it; hosts do not agree on whether its URI is encoded. */
static int find_resources(char *path, const char *uri, char *guid)
{
    for (int decoded = 1; decoded >= 0; decoded--) {
        take_path(path, uri, decoded);
        if (to_plain_path(path) && read_text(path, "guid.txt", guid))
            return strstr(path, "%20") == NULL && strstr(path, "file://") == NULL; /* the library replaces these */
    }
    return 0;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    const char *reason = "", *version;
    void *library;
    if (!name || !*name)
        return refuse(callbacks, name, "the instance name must not be empty%s", "");
    if (type != fmi2CoSimulation)
        return refuse(callbacks, name, "the FMU type must be fmi2CoSimulation%s", "");
    if (!callbacks)
        return NULL;
    if (!resources)
        return refuse(callbacks, name, "the resource location must be the URI of a folder (got NULL)%s", "");
    if (!(version = python_version()))
        return refuse(callbacks, name, "Python must be 3.11 or later (got none in the process of this FMU)%s", "");
    if (strtol(version, NULL, 10) != 3 || strtol(version + 2, NULL, 10) < OLDEST_PYTHON)
        return refuse(callbacks, name, "Python must be 3.11 or later (got %s)", version);
    if (!(library = load_library(&reason)))
        return refuse(callbacks, name, "pythonfmu cannot be loaded: %s", reason);
    if ((reason = find_functions(library)))
        return refuse(callbacks, name, "pythonfmu does not export %s", reason);
    char path[LONGEST_PATH], own_guid[LONGEST_TEXT];
    if (!find_resources(path, resources, own_guid))
        return refuse(callbacks, name, "the resource location must be the URI of this FMU's resources, in a folder"
                      " whose name pythonfmu can read (got %s)", resources);
    if (!guid || strcmp(guid, own_guid) != 0)
        return refuse(callbacks, name, "the GUID must match modelDescription.xml: import the FMU again%s", "");
    struct front *front = calloc(1, sizeof *front + strlen(name) + 1);
    if (!front)
        return refuse(callbacks, name, "not enough memory for an instance%s", "");
    strcpy(front->name, name);
    front->host = *callbacks;
    front->own = (fmi2CallbackFunctions){take_message, callbacks->allocateMemory, callbacks->freeMemory, NULL, front};
    for (int n = 0; n < CATEGORIES; n++)
        front->logged[n] = logging != 0;
    front->inner = theirs.Instantiate(INNER_NAME, type, guid, path, &front->own, visible, fmi2True);
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
    while (front->states)
        remove_state(front, &front->states);
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
        if (found == CATEGORIES)
            return report(front, fmi2Error, "a log category must be logStatusWarning, logStatusDiscard, logStatusError"
                          " or logAll (got %s)", categories && categories[n] ? categories[n] : "NULL");
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
    return report(front, fmi2Error, "%s requires arguments that are not NULL", call);
}

/* A call of the library is answered by its own status or by the worst status that is logged in it. */
static fmi2Status worst_of(const struct front *front, fmi2Status status)
{
    return status > front->worst ? status : front->worst;
}

/* A call that is passed on if what it needs is given. */
#define PASS(name, given, parameters, arguments)            \
    fmi2Status fmi2##name parameters                        \
    {                                                       \
        struct front *front = c;                            \
        if (!front)                                         \
            return fmi2Error;                               \
        if (!(given))                                       \
            return without(front, "fmi2" #name);            \
        front->worst = fmi2OK;                              \
        return worst_of(front, theirs.name arguments);      \
    }
#define REFERENCES const fmi2ValueReference references[], size_t count
#define READ(name, type)                                                                           \
    PASS(name, count == 0 || (references && values), (fmi2Component c, REFERENCES, type values[]), \
         (front->inner, references, count, values))
#define CALL(name) PASS(name, 1, (fmi2Component c), (front->inner))
#define RATES(name, type)                                                                  \
    PASS(name, 1, (fmi2Component c, REFERENCES, const fmi2Integer order[], type values[]), \
         (front->inner, references, count, order, values))

CALL(EnterInitializationMode)
CALL(ExitInitializationMode)
CALL(Terminate)
CALL(Reset)
READ(GetReal, fmi2Real)
READ(GetInteger, fmi2Integer)
READ(GetBoolean, fmi2Boolean)
READ(SetReal, const fmi2Real)
READ(SetInteger, const fmi2Integer)
READ(SetBoolean, const fmi2Boolean)
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

/* --- saved states --- */

static fmi2Status without_state(const struct front *front)
{
    return report(front, fmi2Error, "a state must be saved by this instance and not yet freed");
}

/* Keep a new object of Python as a state, in place of the previous one if the host gives that. */
static fmi2Status keep_state(struct front *front, fmi2FMUstate inner, fmi2FMUstate *state)
{
    struct saved *saved = *state;
    if (saved) {
        theirs.FreeFMUstate(front->inner, &saved->inner);
    } else if ((saved = calloc(1, sizeof *saved))) {
        saved->next = front->states;
        front->states = saved;
    } else {
        theirs.FreeFMUstate(front->inner, &inner);
        return report(front, fmi2Error, "not enough memory for a state");
    }
    saved->inner = inner;
    *state = saved;
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    struct front *front = component;
    fmi2FMUstate inner = NULL;
    if (!front)
        return fmi2Error;
    if (!state || (*state && !find_state(front, *state)))
        return without_state(front);
    front->worst = fmi2OK;
    const fmi2Status status = worst_of(front, theirs.GetFMUstate(front->inner, &inner));
    return status == fmi2OK ? keep_state(front, inner, state) : status;
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state)
{
    struct front *front = component;
    if (!front)
        return fmi2Error;
    if (!find_state(front, state))
        return without_state(front);
    front->worst = fmi2OK;
    return worst_of(front, theirs.SetFMUstate(front->inner, ((struct saved *)state)->inner));
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    struct front *front = component;
    if (!front)
        return fmi2Error;
    if (!state || !*state)
        return fmi2OK;
    struct saved **const place = find_state(front, *state);
    if (!place)
        return without_state(front);
    remove_state(front, place);
    *state = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size)
{
    struct front *front = component;
    if (!front)
        return fmi2Error;
    if (!size || !find_state(front, state))
        return without_state(front);
    front->worst = fmi2OK;
    return worst_of(front, theirs.SerializedFMUstateSize(front->inner, ((struct saved *)state)->inner, size));
}

/* pythonfmu copies as many bytes as the host has, not as many as there are. */
fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    struct front *front = component;
    size_t length = 0;
    if (!front)
        return fmi2Error;
    if (!bytes)
        return without_state(front);
    const fmi2Status status = fmi2SerializedFMUstateSize(component, state, &length);
    if (status != fmi2OK)
        return status;
    if (size < length)
        return report(front, fmi2Error, "the size of a serialized state must be at least %lu bytes (got %lu)",
                      (unsigned long)length, (unsigned long)size);
    return worst_of(front, theirs.SerializeFMUstate(front->inner, ((struct saved *)state)->inner, bytes, length));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    struct front *front = component;
    fmi2FMUstate inner = NULL;
    if (!front)
        return fmi2Error;
    if (!bytes || !state || (*state && !find_state(front, *state)))
        return without_state(front);
    front->worst = fmi2OK;
    const fmi2Status status = worst_of(front, theirs.DeSerializeFMUstate(front->inner, bytes, size, &inner));
    return status == fmi2OK ? keep_state(front, inner, state) : status;
}

/* --- what no instance has: Strings and pending steps --- */

fmi2Status fmi2SetString(fmi2Component component, REFERENCES, const fmi2String values[])
{
    (void)references;
    (void)values;
    if (!component)
        return fmi2Error;
    return count == 0 ? fmi2OK : report(component, fmi2Error, "cannot set a String: the model has no String variables");
}

fmi2Status fmi2GetString(fmi2Component component, REFERENCES, fmi2String values[])
{
    (void)references;
    (void)values;
    if (!component)
        return fmi2Error;
    return count == 0 ? fmi2OK : report(component, fmi2Error, "cannot read a String: the model has no String variables");
}

fmi2Status fmi2CancelStep(fmi2Component component)
{
    return component ? report(component, fmi2Error, "cancelStep requires a pending step, but doStep always completes") : fmi2Error;
}

static fmi2Status not_pending(const struct front *front, const char *call)
{
    return front ? report(front, fmi2Discard, "%s requires a pending step, but doStep always completes", call) : fmi2Error;
}

fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind;
    (void)value;
    return not_pending(component, "getStatus");
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind;
    (void)value;
    return not_pending(component, "getIntegerStatus");
}

fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind;
    (void)value;
    return not_pending(component, "getStringStatus");
}

fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value)
{
    const struct front *front = component;
    if (!front)
        return fmi2Error;
    if (kind != fmi2LastSuccessfulTime || !value)
        return report(front, fmi2Discard, "the kind of getRealStatus must be fmi2LastSuccessfulTime");
    return theirs.GetRealStatus(front->inner, kind, value);
}

/* A rejected step ends no simulation. */
fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (!component)
        return fmi2Error;
    if (kind != fmi2Terminated || !value)
        return report(component, fmi2Discard, "the kind of getBooleanStatus must be fmi2Terminated");
    *value = fmi2False;
    return fmi2OK;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}
