/* Saved states: copies of the instance's block, kept in a list so that a state of no use is known as such. */
#include "instance.h"

#include <math.h>
#include <string.h>

#define MARK "IMFMU1"

/* In front of the block in a serialized state. */
struct wrapper {
    char mark[8];
    char guid[40];
    uint64_t size;
    uint64_t sum;
};

/* Whether a state is one of this instance that has not been freed. */
static int is_saved(const struct instance *c, const void *state)
{
    for (const struct saved *saved = c->states; saved; saved = saved->next)
        if (saved == state)
            return 1;
    return 0;
}

static fmi2Status refuse(struct instance *c, const char *call)
{
    return report(c, fmi2Error, "the state of %s must be one that this instance has saved and not freed", call);
}

static struct saved *add_state(struct instance *c)
{
    struct saved *saved = allocate(&c->callbacks, sizeof *saved + block_size() * sizeof(double));
    if (!saved) {
        report(c, fmi2Error, "there is not enough memory for a state");
        return NULL;
    }
    saved->previous = NULL;
    saved->next = c->states;
    if (saved->next)
        saved->next->previous = saved;
    c->states = saved;
    return saved;
}

static void remove_state(struct instance *c, struct saved *saved)
{
    if (saved->next)
        saved->next->previous = saved->previous;
    if (saved->previous)
        saved->previous->next = saved->next;
    else
        c->states = saved->next;
    release(&c->callbacks, saved);
}

void free_states(struct instance *c)
{
    while (c->states)
        remove_state(c, c->states);
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (!state)
        return refuse(c, "getFMUstate");
    if (*state && !is_saved(c, *state))
        return refuse(c, "getFMUstate");
    struct saved *saved = *state ? *state : add_state(c);
    if (!saved)
        return fmi2Error;
    memcpy(saved->block, c->block, block_size() * sizeof(double));
    *state = saved;
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (!is_saved(c, state))
        return refuse(c, "setFMUstate");
    memcpy(c->block, ((struct saved *)state)->block, block_size() * sizeof(double));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (!state || !*state)
        return fmi2OK;
    if (!is_saved(c, *state))
        return refuse(c, "freeFMUstate");
    remove_state(c, *state);
    *state = NULL;
    return fmi2OK;
}

/* Sum over the bytes that tells a damaged state (Fowler, Noll and Vo's). */
static uint64_t sum_of(const unsigned char *bytes, size_t count)
{
    uint64_t sum = UINT64_C(14695981039346656037);
    for (size_t n = 0; n < count; n++)
        sum = (sum ^ bytes[n]) * UINT64_C(1099511628211);
    return sum;
}

/* What belongs in front of a block of so many bytes; the same for the same block, unused bytes included. */
static struct wrapper wrapper_of(const void *block, size_t length)
{
    struct wrapper wrapper;
    memset(&wrapper, 0, sizeof wrapper);
    memcpy(wrapper.mark, MARK, sizeof MARK);
    strncpy(wrapper.guid, model.guid, sizeof wrapper.guid - 1);
    wrapper.size = length;
    wrapper.sum = sum_of(block, length);
    return wrapper;
}

/* Number of a block of which only the bytes are there, at any address. */
static double number_at(const fmi2Byte *block, size_t place)
{
    double number;
    memcpy(&number, block + place * sizeof number, sizeof number);
    return number;
}

static int is_whole(double value, double most)
{
    return value >= 0.0 && value <= most && fmod(value, 1.0) == 0.0;
}

/* Whether all that is used as an index or a choice is one: the sum of bytes can be made to fit by anybody. */
static int is_sound(const fmi2Byte *block)
{
    const size_t p = HEAD_SIZE, d = p + model.p_size, x = d + model.d_size + model.u_size;
    const size_t x_before = x + model.x_size + model.y_size;
    const double phase = number_at(block, PHASE), prepared = number_at(block, PREPARED);
    if (!is_whole(phase, PHASES - 1) || !is_whole(prepared, 1.0) ||
        !is_whole(number_at(block, COMPLETE), 1.0))
        return 0;
    if ((phase == STEPPING || phase == TERMINATED) && prepared == 0.0)
        return 0;
    for (size_t n = 0; n < model.bound_count; n++) {
        const struct bound *bound = &model.bounds[n];
        const size_t first = bound->of == STATE ? x : d, second = bound->of == STATE ? x_before : d;
        if (!is_whole(number_at(block, first + bound->slot), bound->most) ||
            !is_whole(number_at(block, second + bound->slot), bound->most))
            return 0;
    }
    for (size_t n = 0; prepared != 0.0 && n < model.variable_count; n++) {
        const struct variable *variable = &model.variables[n];
        if (variable->array == PARAMETERS && !is_allowed(variable, number_at(block, p + (size_t)variable->slot)))
            return 0;
    }
    return 1;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size)
{
    struct instance *c = component;
    if (!c)
        return fmi2Error;
    if (!size || !is_saved(c, state))
        return refuse(c, "serializedFMUstateSize");
    *size = sizeof(struct wrapper) + block_size() * sizeof(double);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    struct instance *c = component;
    const size_t length = block_size() * sizeof(double);
    if (!c)
        return fmi2Error;
    if (!bytes || !is_saved(c, state))
        return refuse(c, "serializeFMUstate");
    if (size < sizeof(struct wrapper) + length)
        return report(c, fmi2Error, "the bytes of serializeFMUstate must be at least %lu, are %lu",
                      (unsigned long)(sizeof(struct wrapper) + length), (unsigned long)size);
    const double *block = ((struct saved *)state)->block;
    const struct wrapper wrapper = wrapper_of(block, length);
    memcpy(bytes, &wrapper, sizeof wrapper);
    memcpy(bytes + sizeof wrapper, block, length);
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    struct instance *c = component;
    const size_t length = block_size() * sizeof(double);
    if (!c)
        return fmi2Error;
    if (!bytes || !state)
        return refuse(c, "deSerializeFMUstate");
    if (size != sizeof(struct wrapper) + length)
        return report(c, fmi2Error, "the state must be one saved by this build, of %lu bytes, is of %lu bytes",
                      (unsigned long)(sizeof(struct wrapper) + length), (unsigned long)size);
    const struct wrapper wrapper = wrapper_of(bytes + sizeof wrapper, length);
    if (memcmp(&wrapper, bytes, sizeof wrapper) != 0 || !is_sound(bytes + sizeof wrapper))
        return report(c, fmi2Error, "the state must be one saved by this build, is damaged or of another build");
    if (*state && !is_saved(c, *state))
        return refuse(c, "deSerializeFMUstate");
    struct saved *saved = *state ? *state : add_state(c);
    if (!saved)
        return fmi2Error;
    memcpy(saved->block, bytes + sizeof wrapper, length);
    *state = saved;
    return fmi2OK;
}
