/* Life of an instance: instantiation, initialisation, termination, reset. */
#include "instance.h"

#include <math.h>
#include <string.h>

INTERNAL_OBJECT const char *const phase_names[PHASES] = {
    "instantiated", "in initialization mode", "initialized", "in error since initialization", "terminated",
    "in event mode", "in an intermediate update"};

#define BITS_OF_INFINITY UINT64_C(0x7ff0000000000000)

static uint64_t bits_without_sign(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits & ~(UINT64_C(1) << 63);
}

int is_number(double value)
{
    return bits_without_sign(value) <= BITS_OF_INFINITY;
}

int is_finite(double value)
{
    return bits_without_sign(value) < BITS_OF_INFINITY;
}

size_t block_size(void)
{
    return HEAD_SIZE + model.p_size + model.d_size + model.y_size + 2 * (model.u_size + model.x_size) +
           model.discrete_count;
}

enum phase phase_of(const struct instance *c)
{
    return (enum phase)c->head[PHASE];
}

int is_running(const struct instance *c)
{
    return phase_of(c) == STEPPING || phase_of(c) == AT_EVENT;
}

int is_differentiable(const struct instance *c)
{
    return is_running(c) || phase_of(c) == TERMINATED || phase_of(c) == UPDATING;
}

/* Set all variables to their start values, as after instantiation. */
static void set_start_values(struct instance *c)
{
    memset(c->block, 0, block_size() * sizeof(double));
    c->head[TOLERANCE] = NAN;
    c->head[STOP_TIME] = INFINITY;
    c->warned = 0;
    for (size_t n = 0; n < model.variable_count; n++) {
        const struct variable *variable = &model.variables[n];
        if (variable->array == INPUTS || variable->array == PARAMETERS)
            c->values[variable->array][variable->slot] = variable->start;
    }
}

/* Set the pointers of the arrays into the memory of the instance. */
static void assign_arrays(struct instance *c, double *memory)
{
    double **const arrays[] = {&c->head, &c->p, &c->d, &c->u, &c->x, &c->y, &c->x_before, &c->u_before,
                               &c->held, &c->w, &c->p_trial, &c->x_trial, &c->u_trial, &c->y_trial, &c->y_other,
                               &c->x_end, &c->y_end};
    const size_t sizes[] = {HEAD_SIZE, model.p_size, model.d_size, model.u_size, model.x_size, model.y_size,
                            model.x_size, model.u_size, model.discrete_count, model.w_size, model.p_size,
                            model.x_size, model.u_size, model.y_size, model.y_size, model.x_size, model.y_size};
    c->block = memory;
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
        *arrays[n] = memory;
        memory += sizes[n];
    }
    c->values[PARAMETERS] = c->p;
    c->values[INPUTS] = c->u;
    c->values[OUTPUTS] = c->y;
    c->values[CLOCK] = &c->head[TIME];
}

struct instance *create(const struct host *host, size_t size, const char *name, int logging)
{
    const size_t trials = model.w_size + model.p_size + 2 * model.x_size + model.u_size + 3 * model.y_size;
    const size_t doubles = (block_size() + trials) * sizeof(double);
    const size_t letters = strlen(name) + 1;
    struct instance *c = host->allocate(1, size);
    double *memory = host->allocate(1, doubles + letters);
    if (!c || !memory) {
        if (memory)
            host->release(memory);
        if (c)
            host->release(c);
        return NULL;
    }
    memset(c, 0, size);
    memset(memory, 0, doubles);
    c->host = *host;
    assign_arrays(c, memory);
    c->name = memcpy((char *)memory + doubles, name, letters);
    for (int n = 0; n < CATEGORIES; n++)
        c->logged[n] = logging && n != LOG_STEPS && n != LOG_ALL;
    set_start_values(c);
    return c;
}

void destroy(struct instance *c)
{
    if (!c)
        return;
    const struct host host = c->host;
    free_states(c);
    host.release(c->block);
    host.release(c);
}

enum status set_experiment(struct instance *c, int tolerance_defined, double tolerance, double start_time,
                   int stop_time_defined, double stop_time)
{
    if (!c)
        return ERROR;
    if (phase_of(c) != INSTANTIATED)
        return report_wrong_phase(c, "setupExperiment", "before enterInitializationMode");
    if (!is_finite(start_time))
        return report(c, ERROR, "start time must be a finite number of seconds (got %s)", TEXT_OF(start_time));
    if (stop_time_defined && !(is_number(stop_time) && stop_time >= start_time))
        return report(c, ERROR, "stop time must be at least the start time %s s (got %s)", TEXT_OF(start_time),
                      TEXT_OF(stop_time));
    if (tolerance_defined && !(is_finite(tolerance) && tolerance > 0.0))
        return report(c, ERROR, "tolerance must be a positive number (got %s)", TEXT_OF(tolerance));
    c->head[TOLERANCE] = tolerance_defined ? tolerance : NAN;
    c->head[STOP_TIME] = stop_time_defined ? stop_time : INFINITY;
    c->head[TIME] = start_time;
    return OK;
}

enum status enter_initialization(struct instance *c)
{
    if (!c)
        return ERROR;
    if (phase_of(c) != INSTANTIATED)
        return report_wrong_phase(c, "enterInitializationMode", "directly after instantiation or reset");
    if (model.tolerance_slot >= 0 && is_number(c->head[TOLERANCE]))
        c->p[model.tolerance_slot] = c->head[TOLERANCE];
    c->head[PHASE] = INITIALIZING;
    return OK;
}

int is_allowed(const struct variable *variable, double value)
{
    if (!is_number(value) || (variable->kind != REAL && value != floor(value)))
        return 0;
    return value >= variable->minimum && value <= variable->maximum;
}

enum status start_kernel(struct instance *c, enum status failure)
{
    enum status status = OK;
    if (c->head[STARTED])
        return OK;
    for (size_t n = 0; n < model.variable_count; n++) {
        const struct variable *variable = &model.variables[n];
        if (variable->array != PARAMETERS || is_allowed(variable, c->p[variable->slot]))
            continue;
        status = report(c, failure, "%s must be %s (got %s)", variable->name, variable->allowed,
                        TEXT_OF(c->p[variable->slot]));
    }
    if (status != OK)
        return status;
    const int64_t kernel_status = call_kernel(OPERATION_START, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    if (kernel_status != STATUS_OK)
        return report_kernel_status(c, failure, kernel_status, c->u, 0.0);
    c->head[STARTED] = 1.0;
    c->head[LATE_COMPUTED] = 1.0;
    return OK;
}

void compute_late_outputs(struct instance *c)
{
    if (c->head[LATE_COMPUTED] || !c->head[STARTED])
        return;
    call_kernel(OPERATION_OUTPUTS, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    c->head[LATE_COMPUTED] = 1.0;
}

enum status exit_initialization(struct instance *c, enum phase next)
{
    if (!c)
        return ERROR;
    if (phase_of(c) != INITIALIZING)
        return report_wrong_phase(c, "exitInitializationMode", "after enterInitializationMode");
    const enum status status = start_kernel(c, ERROR);
    c->head[PHASE] = status == OK ? next : FAILED;
    if (status == OK)
        log_warnings(c);
    return status;
}

enum status terminate(struct instance *c)
{
    if (!c)
        return ERROR;
    if (check_not_updating(c, "terminate") != OK)
        return ERROR;
    if (!is_running(c))
        return report_wrong_phase(c, "terminate", "after exitInitializationMode");
    c->head[PHASE] = TERMINATED;
    return OK;
}

enum status check_not_updating(struct instance *c, const char *call)
{
    return phase_of(c) == UPDATING ? report_wrong_phase(c, call, "between steps") : OK;
}

void store_discrete(struct instance *c)
{
    for (size_t n = 0; n < model.discrete_count; n++)
        c->held[n] = c->y[model.discrete[n]];
}

int has_discrete_change(const struct instance *c)
{
    for (size_t n = 0; n < model.discrete_count; n++)
        if (c->y[model.discrete[n]] != c->held[n])
            return 1;
    return 0;
}

enum status reset(struct instance *c)
{
    if (!c || check_not_updating(c, "reset") != OK)
        return ERROR;
    set_start_values(c);
    return OK;
}
