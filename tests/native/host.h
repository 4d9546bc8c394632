/* What the test programs share: a host's callbacks, numbers by chance, variables by their names. */
#ifndef HOST_H
#define HOST_H

#include "fmi2Functions.h"
#include "model.h"

#define MOST_VARIABLES 128
#define LONGEST_TEXT 4096

/* End the program with a message and status 1 unless a condition holds. */
#define CHECK(condition, ...)          \
    do {                               \
        if (!(condition))              \
            fail(#condition, __VA_ARGS__); \
    } while (0)

void fail(const char *condition, const char *format, ...)
#if defined __GNUC__
    __attribute__((format(printf, 2, 3), noreturn))
#endif
    ;

/* Numbers by chance, the same for the same seed on every platform. */
struct chance {
    uint64_t state;
};

uint64_t draw(struct chance *chance);
unsigned below(struct chance *chance, unsigned limit);
int one_in(struct chance *chance, unsigned count);
double between(struct chance *chance, double low, double high);

/* What the memory callbacks have counted, and how often they are to answer that there is no memory. */
struct memory {
    size_t blocks, bytes, most_bytes, calls;
    unsigned refuse_one_in;
    struct chance chance;
};
extern struct memory memory;

void *counted_allocate(size_t count, size_t size);
void counted_free(void *block);

/* What an instance has logged; the environment of its callbacks. */
struct journal {
    const char *name;
    unsigned long messages;
    fmi2Status status;
    char last[LONGEST_TEXT];
};

/* Takes the message for a printf format, as hosts do, and checks what comes with it. */
void checked_logger(fmi2ComponentEnvironment journal, fmi2String name, fmi2Status status, fmi2String category,
                    fmi2String message, ...);

/* An instance with callbacks that count; NULL if there was no memory. */
fmi2Component instantiate(struct journal *journal, const char *name);

/* The kind of a variable by the types of FMI 2.0, where an enumeration is an Integer. */
enum kind kind_of(const struct variable *variable);

fmi2ValueReference reference_of(const char *name);
fmi2Status set_value(fmi2Component c, fmi2ValueReference reference, double value);
double real_value(fmi2Component c, const char *name);

struct setting {
    const char *name;
    double value;
};

/* Set values by name up to a setting without one, and initialise. */
void start(fmi2Component c, const struct setting *settings);

#endif
