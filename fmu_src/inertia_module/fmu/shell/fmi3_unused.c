/* Functions of FMI 3.0 that every library must export and that this FMU does not support. They return an error.
 *
 * The FMU has no variables of these types, no clocks and no configuration mode. It supports neither model exchange nor
 * scheduled execution.
 */
#include "fmi3.h"

#pragma GCC diagnostic ignored "-Wunused-parameter"

static fmi3Status none_of(struct instance *c, const char *type, size_t count)
{
    if (!c)
        return fmi3Error;
    return count == 0 ? fmi3OK : (fmi3Status)report(c, ERROR, "the model has no variables of type %s", type);
}

#define NO_VARIABLES(Type)                                                                                           \
    fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count,                    \
                             fmi3##Type values[], size_t value_count)                                                \
    {                                                                                                                \
        return none_of(c, #Type, count);                                                                             \
    }                                                                                                                \
    fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count,                    \
                             const fmi3##Type values[], size_t value_count)                                          \
    {                                                                                                                \
        return none_of(c, #Type, count);                                                                             \
    }

NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(UInt32)
NO_VARIABLES(UInt64)
NO_VARIABLES(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference references[], size_t count, size_t sizes[],
                         fmi3Binary values[], size_t value_count)
{
    return none_of(c, "Binary", count);
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference references[], size_t count, const size_t sizes[],
                         const fmi3Binary values[], size_t value_count)
{
    return none_of(c, "Binary", count);
}

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference references[], size_t count, fmi3Clock values[])
{
    return none_of(c, "Clock", count);
}

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference references[], size_t count, const fmi3Clock values[])
{
    return none_of(c, "Clock", count);
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    return reject_instantiation(environment, log, "the interface type must be co-simulation (got model exchange)");
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    return reject_instantiation(environment, log, "the interface type must be co-simulation (got scheduled execution)");
}

static fmi3Status not_supported(struct instance *c, const char *call)
{
    return c ? (fmi3Status)report(c, ERROR, "%s is not supported (see the capabilities in modelDescription.xml)", call)
             : fmi3Error;
}

#define NOT_SUPPORTED(Call, ...)          \
    fmi3Status fmi3##Call(__VA_ARGS__)  \
    {                                   \
        return not_supported(c, #Call);   \
    }

NOT_SUPPORTED(GetNumberOfVariableDependencies, fmi3Instance c, fmi3ValueReference reference, size_t *count)
NOT_SUPPORTED(GetVariableDependencies, fmi3Instance c, fmi3ValueReference dependent, size_t elements[],
            fmi3ValueReference independents[], size_t other_elements[], fmi3DependencyKind kinds[], size_t count)
NOT_SUPPORTED(EnterConfigurationMode, fmi3Instance c)
NOT_SUPPORTED(ExitConfigurationMode, fmi3Instance c)
NOT_SUPPORTED(GetIntervalDecimal, fmi3Instance c, const fmi3ValueReference references[], size_t count,
            fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
NOT_SUPPORTED(GetIntervalFraction, fmi3Instance c, const fmi3ValueReference references[], size_t count,
            fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
NOT_SUPPORTED(GetShiftDecimal, fmi3Instance c, const fmi3ValueReference references[], size_t count,
            fmi3Float64 shifts[])
NOT_SUPPORTED(GetShiftFraction, fmi3Instance c, const fmi3ValueReference references[], size_t count,
            fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NOT_SUPPORTED(SetIntervalDecimal, fmi3Instance c, const fmi3ValueReference references[], size_t count, const
            fmi3Float64 intervals[])
NOT_SUPPORTED(SetIntervalFraction, fmi3Instance c, const fmi3ValueReference references[], size_t count,
            const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NOT_SUPPORTED(SetShiftDecimal, fmi3Instance c, const fmi3ValueReference references[], size_t count, const
            fmi3Float64 shifts[])
NOT_SUPPORTED(SetShiftFraction, fmi3Instance c, const fmi3ValueReference references[], size_t count, const
            fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NOT_SUPPORTED(EvaluateDiscreteStates, fmi3Instance c)
NOT_SUPPORTED(EnterContinuousTimeMode, fmi3Instance c)
NOT_SUPPORTED(CompletedIntegratorStep, fmi3Instance c, fmi3Boolean no_state_prior, fmi3Boolean *event,
            fmi3Boolean *terminate)
NOT_SUPPORTED(SetTime, fmi3Instance c, fmi3Float64 time)
NOT_SUPPORTED(SetContinuousStates, fmi3Instance c, const fmi3Float64 states[], size_t count)
NOT_SUPPORTED(GetContinuousStateDerivatives, fmi3Instance c, fmi3Float64 derivatives[], size_t count)
NOT_SUPPORTED(GetEventIndicators, fmi3Instance c, fmi3Float64 indicators[], size_t count)
NOT_SUPPORTED(GetContinuousStates, fmi3Instance c, fmi3Float64 states[], size_t count)
NOT_SUPPORTED(GetNominalsOfContinuousStates, fmi3Instance c, fmi3Float64 nominals[], size_t count)
NOT_SUPPORTED(GetNumberOfEventIndicators, fmi3Instance c, size_t *count)
NOT_SUPPORTED(GetNumberOfContinuousStates, fmi3Instance c, size_t *count)
NOT_SUPPORTED(ActivateModelPartition, fmi3Instance c, fmi3ValueReference reference, fmi3Float64 time)
