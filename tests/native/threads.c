/* Instances in many simultaneous threads give the bits of a single thread: threads THREADS INSTANCES. */
#define _POSIX_C_SOURCE 200809L
#include "snapshot.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#define MOST_THREADS 64
#define STEPS 20
#define AVERAGED_EVERY 250

static unsigned long instances;
static uint64_t *expected; /* check sum of all results of each instance */

/* The counting memory callbacks are not thread-safe, so the shell uses its default memory functions. */
static uint64_t run(unsigned long number)
{
    const fmi2CallbackFunctions callbacks = {NULL, NULL, NULL, NULL, NULL};
    const fmi2ValueReference inputs[] = {0, 1};
    static const double fidelities[] = {0.0, 2.0, 3.0, 2.0};
    const double fidelity = number % AVERAGED_EVERY == 0 ? 1.0 : fidelities[number % 4];
    const double damping = 1e-4 + 1e-6 * (double)(number % 97);
    const struct setting module[] = {{"fidelity", fidelity}, {"link2_inertia", damping * 50.0}, {NULL, 0.0}};
    const struct setting shaft[] = {{"shaft_damping", damping}, {NULL, 0.0}};
    const fmi2Component c =
        fmi2Instantiate("instance", fmi2CoSimulation, model.guid, NULL, &callbacks, fmi2False, fmi2False);
    struct snapshot snapshot;
    uint64_t sum = 0;
    CHECK(c, "instantiation");
    start(c, model.tolerance_slot >= 0 ? module : shaft);
    for (int n = 0; n < STEPS; n++) {
        const fmi2Real values[] = {80.0 + (double)(number % 41) + 5.0 * sin(n), 5.0};
        fmi2SetReal(c, inputs, 2, values);
        CHECK(fmi2DoStep(c, n * 1e-3, 1e-3, fmi2True) == fmi2OK, "instance %lu, step %d", number, n);
        take_snapshot(c, &snapshot);
        sum = add_bits(sum, &snapshot);
    }
    fmi2FreeInstance(c);
    return sum;
}

/* Run all instances; each thread begins with another one. */
static void *run_all(void *first)
{
    for (unsigned long n = 0; n < instances; n++) {
        const unsigned long number = (n + *(unsigned long *)first) % instances;
        CHECK(run(number) == expected[number], "instance %lu has other bits in a thread", number);
    }
    return NULL;
}

int main(int count, char **arguments)
{
    pthread_t threads[MOST_THREADS];
    unsigned long firsts[MOST_THREADS];
    CHECK(count == 3, "usage: threads THREADS INSTANCES");
    const unsigned long thread_count = strtoul(arguments[1], NULL, 10);
    instances = strtoul(arguments[2], NULL, 10);
    CHECK(thread_count <= MOST_THREADS && instances > 0, "too many threads, or no instances");
    expected = calloc(instances, sizeof *expected);
    CHECK(expected, "the test itself has run out of memory");
    for (unsigned long number = 0; number < instances; number++)
        expected[number] = run(number);
    for (unsigned long n = 0; n < thread_count; n++) {
        firsts[n] = n * instances / thread_count;
        CHECK(pthread_create(&threads[n], NULL, run_all, &firsts[n]) == 0, "starting thread %lu", n);
    }
    for (unsigned long n = 0; n < thread_count; n++)
        CHECK(pthread_join(threads[n], NULL) == 0, "ending thread %lu", n);
    free(expected);
    printf("%lu threads, %lu instances each: the bits of one thread\n", thread_count, instances);
    return 0;
}
