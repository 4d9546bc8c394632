/* Random calls that save, restore, serialize and free states. */
#include "abuse.h"

#include <stdlib.h>
#include <string.h>

/* A state that does not belong to the slot: freed, of another instance, or NULL. */
static fmi2FMUstate foreign_state(const struct slot *slot)
{
    const struct slot *other = &slots[below(&chance, slot_count)];
    if (other != slot && other->c && other->states > 0 && one_in(&chance, 2))
        return other->kept[below(&chance, other->states)].state;
    for (unsigned n = 0; n < slot->states; n++)
        if (slot->kept[n].state == slot->freed) /* the memory has been reused */
            return NULL;
    return one_in(&chance, 3) ? NULL : slot->freed;
}

static struct kept *some_kept(struct slot *slot)
{
    return slot->states > 0 && !one_in(&chance, 20) ? &slot->kept[below(&chance, slot->states)] : NULL;
}

static struct answer save(struct slot *slot, fmi2Component c)
{
    struct kept *kept = slot->states < MOST_STATES && !one_in(&chance, 3) ? NULL : some_kept(slot);
    fmi2FMUstate state = kept ? kept->state : NULL;
    fmi2Status status;
    if (one_in(&chance, 20)) {
        state = foreign_state(slot);
        const fmi2FMUstate before = state;
        if (!state)
            return CALLED(fmi2GetFMUstate(c, NULL));
        status = fmi2GetFMUstate(c, &state);
        CHECK(status == fmi2Error && state == before, "a state is saved into one that is foreign");
        return CALLED(status);
    }
    if (!kept && slot->states == MOST_STATES)
        return NO_CALL;
    status = fmi2GetFMUstate(c, &state);
    if (status != fmi2OK) {
        CHECK(state == (kept ? kept->state : NULL), "a rejected save changes the host's state");
        return CALLED(status);
    }
    if (!kept)
        kept = &slot->kept[slot->states++];
    *kept = (struct kept){state, slot->stage, slot->stop};
    return CALLED(status);
}

static struct answer restore(struct slot *slot, fmi2Component c)
{
    const struct kept *kept = some_kept(slot);
    const fmi2Status status = fmi2SetFMUstate(c, kept ? kept->state : foreign_state(slot));
    CHECK(!c || (status == fmi2OK) == (kept != NULL), "restoring a state answers %d", status);
    if (status == fmi2OK) {
        slot->stage = kept->stage;
        slot->stop = kept->stop;
        CHECK(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &slot->time) == fmi2OK, "the time of a state");
    }
    return CALLED(status);
}

static struct answer discard(struct slot *slot, fmi2Component c)
{
    struct kept *kept = some_kept(slot);
    fmi2FMUstate state = kept ? kept->state : foreign_state(slot);
    const fmi2FMUstate before = state;
    const fmi2Status status = fmi2FreeFMUstate(c, one_in(&chance, 50) && !kept ? NULL : &state);
    if (kept && c) {
        CHECK(status == fmi2OK && state == NULL, "freeing a state answers %d", status);
        slot->freed = before;
        *kept = slot->kept[--slot->states];
    } else {
        CHECK(state == before, "refusing to free a state changes it");
    }
    return CALLED(status);
}

static struct answer serialize(struct slot *slot, fmi2Component c)
{
    const struct kept *kept = some_kept(slot);
    const fmi2FMUstate state = kept ? kept->state : foreign_state(slot);
    size_t size = 0;
    fmi2Status status = fmi2SerializedFMUstateSize(c, state, one_in(&chance, 50) ? NULL : &size);
    if (status != fmi2OK || size == 0)
        return CALLED(status);
    CHECK(kept && size <= MOST_BYTES, "a state has %zu bytes", size);
    if (one_in(&chance, 20)) {
        fmi2Byte few[64];
        status = fmi2SerializeFMUstate(c, state, few, below(&chance, sizeof few));
        CHECK(status == fmi2Error, "a state fits into too few bytes");
        return CALLED(status);
    }
    if (one_in(&chance, 50))
        return CALLED(fmi2SerializeFMUstate(c, state, NULL, size));
    fmi2Byte *const bytes = malloc(size); /* exact size: a sanitizer reports any write beyond it */
    CHECK(bytes, "the test itself has run out of memory");
    status = fmi2SerializeFMUstate(c, state, bytes, size);
    CHECK(status == fmi2OK, "serializing answers %d", status);
    memcpy(serialized.bytes, bytes, size);
    serialized.size = size;
    serialized.stage = kept->stage;
    serialized.stop = kept->stop;
    free(bytes);
    return CALLED(status);
}

/* A copy of the serialized state with changed bytes or another length, in memory of the exact size. */
static fmi2Byte *damaged(size_t *size)
{
    *size = one_in(&chance, 3) ? below(&chance, (unsigned)serialized.size + 100) : serialized.size;
    fmi2Byte *const bytes = calloc(1, *size + 1);
    CHECK(bytes, "the test itself has run out of memory");
    memcpy(bytes, serialized.bytes, *size < serialized.size ? *size : serialized.size);
    for (unsigned n = 1 + below(&chance, 3); *size > 0 && n > 0; n--)
        bytes[below(&chance, (unsigned)*size)] ^= (fmi2Byte)(1 + below(&chance, 255));
    return bytes;
}

static struct answer deserialize(struct slot *slot, fmi2Component c)
{
    fmi2FMUstate state = NULL;
    fmi2Status status;
    if (serialized.size == 0 || slot->states == MOST_STATES)
        return NO_CALL;
    if (one_in(&chance, 2)) {
        size_t size;
        fmi2Byte *const bytes = damaged(&size);
        if (size == serialized.size && memcmp(bytes, serialized.bytes, size) == 0) {
            free(bytes); /* the changes have cancelled */
            return NO_CALL;
        }
        status = fmi2DeSerializeFMUstate(c, (const fmi2Byte *)bytes, size, &state);
        free(bytes);
        CHECK(status == fmi2Error && !state, "a damaged state is taken");
        return CALLED(status);
    }
    if (one_in(&chance, 20))
        return CALLED(fmi2DeSerializeFMUstate(c, one_in(&chance, 2) ? NULL : serialized.bytes, serialized.size,
                                              NULL));
    if (one_in(&chance, 20) && (state = foreign_state(slot)) != NULL) {
        status = fmi2DeSerializeFMUstate(c, serialized.bytes, serialized.size, &state);
        CHECK(status == fmi2Error, "a state is read into one that is foreign");
        return CALLED(status);
    }
    struct kept *const kept = one_in(&chance, 4) ? some_kept(slot) : NULL;
    state = kept ? kept->state : NULL;
    status = fmi2DeSerializeFMUstate(c, serialized.bytes, serialized.size, &state);
    CHECK(!kept || state == kept->state, "reading into a state of the instance makes another");
    if (status == fmi2OK)
        *(kept ? kept : &slot->kept[slot->states++]) = (struct kept){state, serialized.stage, serialized.stop};
    return CALLED(status);
}

const struct action state_actions[] = {
    {"save", 20, save},           {"restore", 15, restore},         {"free_state", 12, discard},
    {"serialize", 10, serialize}, {"deserialize", 10, deserialize}, {NULL, 0, NULL},
};
