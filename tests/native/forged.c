/* Serialized states that are changed and have a correct check sum: no index or enumeration is used unchecked. */
#include "instance.h"
#include "snapshot.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* s, CPU time of a call. The evaluation limit of the kernel ends long steps; this limit ends endless loops. */
#define TIME_LIMIT 120
#define WRAPPER 64 /* bytes before the block: mark, GUID, size, check sum */

static const double forged[] = {-1.0, 0.5, 7.5, 1e9, 1e300, 1e308, INFINITY, -INFINITY, NAN};
#define FORGED (sizeof forged / sizeof *forged)

struct state {
    fmi2Byte *bytes;
    size_t size;
};

static struct state serialize(fmi2Component c)
{
    fmi2FMUstate saved = NULL;
    struct state state;
    CHECK(fmi2GetFMUstate(c, &saved) == fmi2OK, "saving");
    CHECK(fmi2SerializedFMUstateSize(c, saved, &state.size) == fmi2OK, "size");
    state.bytes = malloc(state.size);
    CHECK(state.bytes && fmi2SerializeFMUstate(c, saved, state.bytes, state.size) == fmi2OK, "serializing");
    CHECK(state.size == WRAPPER + block_size() * sizeof(double), "a state has %zu bytes", state.size);
    CHECK(fmi2FreeFMUstate(c, &saved) == fmi2OK, "freeing");
    return state;
}

/* Write a number into the block, and the new check sum. */
static void put(struct state *state, size_t place, double value)
{
    uint64_t sum = UINT64_C(14695981039346656037);
    memcpy(state->bytes + WRAPPER + place * sizeof value, &value, sizeof value);
    for (size_t n = WRAPPER; n < state->size; n++)
        sum = (sum ^ (unsigned char)state->bytes[n]) * UINT64_C(1099511628211);
    memcpy(state->bytes + WRAPPER - sizeof sum, &sum, sizeof sum);
}

static double get(const struct state *state, size_t place)
{
    double value;
    memcpy(&value, state->bytes + WRAPPER + place * sizeof value, sizeof value);
    return value;
}

static int is_taken(fmi2Component c, const struct state *state)
{
    fmi2FMUstate saved = NULL;
    if (fmi2DeSerializeFMUstate(c, state->bytes, state->size, &saved) != fmi2OK) {
        CHECK(!saved, "a rejected state is made");
        return 0;
    }
    CHECK(fmi2SetFMUstate(c, saved) == fmi2OK && fmi2FreeFMUstate(c, &saved) == fmi2OK, "a state is taken");
    return 1;
}

/* Position of the forged number in the block, for the report of a call that does not return. */
static size_t forged_place;

static void give_up(int signal)
{
    (void)signal;
    fail("a call returns", "number %zu of the block is forged", forged_place);
}

/* Call everything that a host may call and ignore the statuses. A sanitizer or the system reports a wrong access. */
static void use(fmi2Component c)
{
    alarm(TIME_LIMIT);
    const fmi2ValueReference input = 0;
    const fmi2Integer order = 1;
    fmi2ValueReference output = 0;
    fmi2Real value, direction = 1.0;
    struct snapshot snapshot;
    while (!model.variables[output].output)
        output++;
    take_snapshot(c, &snapshot);
    fmi2DoStep(c, 0.0, 1e-3, fmi2True);
    fmi2DoStep(c, 0.0, 1e-3, fmi2True);
    take_snapshot(c, &snapshot);
    fmi2GetRealOutputDerivatives(c, &output, 1, &order, &value);
    fmi2GetDirectionalDerivative(c, &output, 1, &input, 1, &direction, &value);
    fmi2EnterInitializationMode(c);
    fmi2ExitInitializationMode(c);
    fmi2Terminate(c);
    alarm(0);
}

/* Forge one number after the other and return the number of accepted states. */
static unsigned forge(fmi2Component c, struct state *state, size_t begin, size_t end)
{
    unsigned taken = 0;
    for (size_t place = begin; place < end; place++) {
        const double good = get(state, place);
        forged_place = place;
        for (size_t n = place % 3; n < FORGED; n += 3) { /* A third of the values in turn, for time */
            put(state, place, forged[n]);
            if (is_taken(c, state)) {
                use(c);
                taken++;
            }
        }
        put(state, place, good);
    }
    CHECK(is_taken(c, state), "the state as it was");
    return taken;
}

/* Forge the states of a scene. ``constants``: number of constants that are forged one by one. */
static void attack(fmi2Component c, const struct setting *settings, size_t constants)
{
    const size_t p = HEAD_SIZE, d = p + model.p_size, x = d + model.d_size + model.u_size;
    CHECK(fmi2Reset(c) == fmi2OK, "reset");
    start(c, settings);
    for (int n = 0; n < 5; n++)
        CHECK(fmi2DoStep(c, n * 0.01, 0.01, fmi2True) == fmi2OK, "step");
    struct state state = serialize(c);
    CHECK(forge(c, &state, PHASE, PHASE + 1) == 0, "a phase that is none is taken");
    CHECK(forge(c, &state, STARTED, HEAD_SIZE) == 0, "a mark that is neither 0 nor 1 is taken");
    put(&state, STARTED, 0.0);
    CHECK(!is_taken(c, &state), "a state steps with parameters that were never checked");
    put(&state, STARTED, 1.0);
    for (size_t n = 0; n < model.variable_count; n++) {
        const struct variable *variable = &model.variables[n];
        if (variable->array == PARAMETERS && variable->kind != REAL) {
            const size_t place = p + (size_t)variable->slot;
            const double good = get(&state, place);
            const double bad[] = {variable->minimum - 1.0, variable->maximum + 1.0, variable->minimum + 0.5, NAN, 1e300};
            for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
                put(&state, place, bad[k]);
                CHECK(!is_taken(c, &state), "%s = %g is taken", variable->name, bad[k]);
            }
            put(&state, place, good);
        }
    }
    for (size_t n = 0; n < model.bound_count; n++) {
        const struct bound *bound = &model.bounds[n];
        const size_t place = (bound->of == STATE ? x : d) + bound->slot;
        CHECK(get(&state, place) <= bound->maximum, "a good state is within its bounds");
        put(&state, place, 2.0 * bound->maximum + 1.0);
        CHECK(!is_taken(c, &state), "number %zu of %s is taken beyond its bound", bound->slot,
              bound->of == STATE ? "the state" : "the constants");
        put(&state, place, bound->maximum);
        CHECK(is_taken(c, &state), "the bound itself");
        use(c);
        CHECK(fmi2Reset(c) == fmi2OK, "reset");
        start(c, settings);
        free(state.bytes);
        state = serialize(c);
    }
    forge(c, &state, TOLERANCE, STARTED);
    forge(c, &state, d, d + constants);
    forge(c, &state, x, x + model.x_size);
    free(state.bytes);
}

int main(void)
{
    static struct journal journal;
    static const struct setting defaults[] = {{NULL, 0.0}};
    /* coasts */
    static const struct setting averaged[] = {{"fidelity", 1.0}, {"layout", 1.0}, {"omega_out_start", 150.0}, {NULL, 0.0}};
    static const struct setting elastic[] = {{"omega1", 100.0}, {"fidelity", 3.0}, {NULL, 0.0}};
    static const struct setting losses[] = {{"omega1", 100.0}, {"mesh_efficiency", 0.98},
                                            {"satellite_mesh_efficiency", 0.98}, {"satellites", 3.0}, {NULL, 0.0}};
    const fmi2Component c = instantiate(&journal, "instance");
    signal(SIGALRM, give_up);
    attack(c, defaults, model.d_size < 200 ? model.d_size : 200);
    if (strcmp(model.name, "InertiaModule") == 0) {
        attack(c, averaged, 200); /* the map and the first of its rows; all rows are used alike */
        attack(c, elastic, 0);
        attack(c, losses, 200);
    }
    fmi2FreeInstance(c);
    return 0;
}
