/* Saved states: copies of the instance's block in a list, so that an invalid pointer to a state is detected. */
#include "instance.h"

#include <math.h>
#include <string.h>

#define MARK "IMFMU1"

/* Header before the block in a serialized state. */
struct header {
    char mark[8];
    char guid[40];
    uint64_t size;
    uint64_t sum;
};

/* Return 1 if a state belongs to this instance and has not been freed. */
static int is_saved(const struct instance *c, const void *state)
{
    for (const struct saved *saved = c->states; saved; saved = saved->next)
        if (saved == state)
            return 1;
    return 0;
}

static enum status reject_state(struct instance *c)
{
    return report(c, ERROR, "a state must be saved by this instance and not yet freed");
}

static struct saved *add_state(struct instance *c)
{
    struct saved *saved = c->host.allocate(1, sizeof *saved + block_size() * sizeof(double));
    if (!saved) {
        report(c, ERROR, "not enough memory for a state");
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
    c->host.release(saved);
}

void free_states(struct instance *c)
{
    while (c->states)
        remove_state(c, c->states);
}

enum status save_state(struct instance *c, void **state)
{
    if (!c)
        return ERROR;
    if (check_not_updating(c, "saving a state") != OK)
        return ERROR;
    if (!state)
        return reject_state(c);
    if (*state && !is_saved(c, *state))
        return reject_state(c);
    struct saved *saved = *state ? *state : add_state(c);
    if (!saved)
        return ERROR;
    memcpy(saved->block, c->block, block_size() * sizeof(double));
    *state = saved;
    return OK;
}

enum status restore_state(struct instance *c, void *state)
{
    if (!c)
        return ERROR;
    if (check_not_updating(c, "restoring a state") != OK)
        return ERROR;
    if (!is_saved(c, state))
        return reject_state(c);
    memcpy(c->block, ((struct saved *)state)->block, block_size() * sizeof(double));
    return OK;
}

enum status free_state(struct instance *c, void **state)
{
    if (!c)
        return ERROR;
    if (!state || !*state)
        return OK;
    if (!is_saved(c, *state))
        return reject_state(c);
    remove_state(c, *state);
    *state = NULL;
    return OK;
}

/* Return a check sum of bytes (64-bit FNV-1a by Fowler, Noll and Vo), which detects damage by accident. */
static uint64_t sum_of(const unsigned char *bytes, size_t count)
{
    uint64_t sum = UINT64_C(14695981039346656037);
    for (size_t n = 0; n < count; n++)
        sum = (sum ^ bytes[n]) * UINT64_C(1099511628211);
    return sum;
}

/* Return the header of a block of ``length`` bytes. It has no undefined bytes, so equal blocks have equal headers. */
static struct header header_of(const void *block, size_t length)
{
    struct header header;
    memset(&header, 0, sizeof header);
    memcpy(header.mark, MARK, sizeof MARK);
    strncpy(header.guid, model.guid, sizeof header.guid - 1);
    header.size = length;
    header.sum = sum_of(block, length);
    return header;
}

/* Return a number of a block at any address, which need not be aligned. */
static double number_at(const unsigned char *block, size_t place)
{
    double number;
    memcpy(&number, block + place * sizeof number, sizeof number);
    return number;
}

static int is_whole(double value, double maximum)
{
    return is_number(value) && value >= 0.0 && value <= maximum && fmod(value, 1.0) == 0.0;
}

/* Return 1 if all indices, enumerations and counts of a block are within their ranges. A forged state can have a
   valid check sum. */
static int has_valid_numbers(const unsigned char *block)
{
    const size_t p = HEAD_SIZE, d = p + model.p_size, x = d + model.d_size + model.u_size;
    const size_t x_before = x + model.x_size + model.y_size;
    const double phase = number_at(block, PHASE), prepared = number_at(block, STARTED);
    if (!is_whole(phase, PHASES - 1) || phase == UPDATING || !is_whole(prepared, 1.0) ||
        !is_whole(number_at(block, LATE_COMPUTED), 1.0))
        return 0;
    if ((phase == STEPPING || phase == AT_EVENT || phase == TERMINATED) && prepared == 0.0)
        return 0;
    for (size_t n = 0; n < model.bound_count; n++) {
        const struct bound *bound = &model.bounds[n];
        const size_t first = bound->of == STATE ? x : d, second = bound->of == STATE ? x_before : d;
        if (!is_whole(number_at(block, first + bound->slot), bound->maximum) ||
            !is_whole(number_at(block, second + bound->slot), bound->maximum))
            return 0;
    }
    for (size_t n = 0; prepared != 0.0 && n < model.variable_count; n++) {
        const struct variable *variable = &model.variables[n];
        if (variable->array == PARAMETERS && !is_allowed(variable, number_at(block, p + (size_t)variable->slot)))
            return 0;
    }
    return 1;
}

/* Derive the constants of a block again from its parameters, because the kernel uses some of them as loop limits.
   Return 1 if the parameters are valid together. */
static int derive_constants(struct instance *c, double *block)
{
    double *const p = block + HEAD_SIZE, *const d = p + model.p_size;
    if (block[STARTED] == 0.0)
        return 1;
    memset(c->u_trial, 0, model.u_size * sizeof(double)); /* inputs may be out of range; the next step rejects them */
    return call_kernel(OPERATION_CHECK, p, d, c->u_trial, c->x_trial, c->y_trial, c->w, 0.0) == STATUS_OK;
}

enum status serialized_size(struct instance *c, void *state, size_t *size)
{
    if (!c)
        return ERROR;
    if (!size || !is_saved(c, state))
        return reject_state(c);
    *size = sizeof(struct header) + block_size() * sizeof(double);
    return OK;
}

enum status serialize_state(struct instance *c, void *state, void *bytes, size_t size)
{
    const size_t length = block_size() * sizeof(double);
    if (!c)
        return ERROR;
    if (!bytes || !is_saved(c, state))
        return reject_state(c);
    if (size < sizeof(struct header) + length)
        return report(c, ERROR, "the size of a serialized state must be at least %lu bytes (got %lu)",
                      (unsigned long)(sizeof(struct header) + length), (unsigned long)size);
    const double *block = ((struct saved *)state)->block;
    const struct header header = header_of(block, length);
    memcpy(bytes, &header, sizeof header);
    memcpy((unsigned char *)bytes + sizeof header, block, length);
    return OK;
}

enum status deserialize_state(struct instance *c, const void *bytes, size_t size, void **state)
{
    const size_t length = block_size() * sizeof(double);
    const unsigned char *const block = (const unsigned char *)bytes + sizeof(struct header);
    static const char damaged[] = "the state must be saved by this build (it is damaged or from another build)";
    if (!c)
        return ERROR;
    if (!bytes || !state)
        return reject_state(c);
    if (size != sizeof(struct header) + length)
        return report(c, ERROR, "the state must be saved by this build, with %lu bytes (got %lu bytes)",
                      (unsigned long)(sizeof(struct header) + length), (unsigned long)size);
    const struct header header = header_of(block, length);
    if (memcmp(&header, bytes, sizeof header) != 0 || !has_valid_numbers(block))
        return report(c, ERROR, "%s", damaged);
    if (*state && !is_saved(c, *state))
        return reject_state(c);
    struct saved *const copy = add_state(c);
    if (!copy)
        return ERROR;
    memcpy(copy->block, block, length);
    if (!derive_constants(c, copy->block)) {
        remove_state(c, copy);
        return report(c, ERROR, "%s", damaged);
    }
    if (*state) {
        memcpy(((struct saved *)*state)->block, copy->block, length);
        remove_state(c, copy);
    } else {
        *state = copy;
    }
    return OK;
}
