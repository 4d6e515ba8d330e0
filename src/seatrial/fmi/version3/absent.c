/* FMI 3.0: what these FMUs do not have. Asked for it they log an error and return it.

   Asked for nothing at all, no variable of a type say, they return that all is well. */

#include "front.h"

static fmi3Status none_of(fmi3Instance instance, size_t count, const char *what) {
    Front *self = instance;
    if (count == 0) return fmi3OK;
    return front_refuses(self, "%s: this FMU has no %s", self->name, what);
}

#define TYPE(Type)                                                                              \
    fmi3Status fmi3Get##Type(fmi3Instance instance, const fmi3ValueReference references[],      \
                             size_t count, fmi3##Type values[], size_t n) {                     \
        (void)references, (void)values, (void)n;                                                \
        return none_of(instance, count, #Type);                                                 \
    }                                                                                           \
    fmi3Status fmi3Set##Type(fmi3Instance instance, const fmi3ValueReference references[],      \
                             size_t count, const fmi3##Type values[], size_t n) {               \
        (void)references, (void)values, (void)n;                                                \
        return none_of(instance, count, #Type);                                                 \
    }
TYPE(Float32)
TYPE(Int8)
TYPE(UInt8)
TYPE(Int16)
TYPE(UInt16)
TYPE(UInt32)
TYPE(Int64)
TYPE(UInt64)

/* A function with its parameters, and those that it does not look at. */
#define ABSENT(name, count, what, parameters, ...)                                              \
    fmi3Status name parameters {                                                                \
        const void *const ignored[] = {__VA_ARGS__};                                            \
        (void)ignored;                                                                          \
        return none_of(instance, count, what);                                                  \
    }

/* ------------------------------------------------------------------ intervals of clocks */

#define REFERENCES fmi3Instance instance, const fmi3ValueReference references[], size_t count

ABSENT(fmi3GetIntervalDecimal, count, "time-based Clock",
       (REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]),
       references, intervals, qualifiers)
ABSENT(fmi3GetIntervalFraction, count, "time-based Clock",
       (REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
        fmi3IntervalQualifier qualifiers[]), references, counters, resolutions, qualifiers)
ABSENT(fmi3GetShiftDecimal, count, "time-based Clock",
       (REFERENCES, fmi3Float64 shifts[]), references, shifts)
ABSENT(fmi3GetShiftFraction, count, "time-based Clock",
       (REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[]),
       references, counters, resolutions)
ABSENT(fmi3SetIntervalDecimal, count, "time-based Clock",
       (REFERENCES, const fmi3Float64 intervals[]), references, intervals)
ABSENT(fmi3SetIntervalFraction, count, "time-based Clock",
       (REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]),
       references, counters, resolutions)
ABSENT(fmi3SetShiftDecimal, count, "time-based Clock",
       (REFERENCES, const fmi3Float64 shifts[]), references, shifts)
ABSENT(fmi3SetShiftFraction, count, "time-based Clock",
       (REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]),
       references, counters, resolutions)

/* ------------------------------------------------------------------ derivatives of outputs */

ABSENT(fmi3GetOutputDerivatives, count, "derivative of an output in time",
       (REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[], size_t n),
       references, orders, values, &n)

/* ------------------------------------------------------------------ dependencies by element */

ABSENT(fmi3GetNumberOfVariableDependencies, 1, "dependency of single elements",
       (fmi3Instance instance, fmi3ValueReference reference, size_t *count), &reference, count)
ABSENT(fmi3GetVariableDependencies, 1, "dependency of single elements",
       (fmi3Instance instance, fmi3ValueReference dependent, size_t elements[],
        fmi3ValueReference independents[], size_t their_elements[], fmi3DependencyKind kinds[],
        size_t count),
       &dependent, elements, independents, their_elements, kinds, &count)

/* ------------------------------------------------------------------ modes, model exchange */

ABSENT(fmi3EnterConfigurationMode, 1, "structural parameter to set",
       (fmi3Instance instance), NULL)
ABSENT(fmi3ExitConfigurationMode, 1, "structural parameter to set",
       (fmi3Instance instance), NULL)
ABSENT(fmi3EnterContinuousTimeMode, 1, "model exchange", (fmi3Instance instance), NULL)
ABSENT(fmi3CompletedIntegratorStep, 1, "model exchange",
       (fmi3Instance instance, fmi3Boolean no_earlier, fmi3Boolean *event, fmi3Boolean *ends),
       &no_earlier, event, ends)
ABSENT(fmi3SetTime, 1, "model exchange",
       (fmi3Instance instance, fmi3Float64 t), &t)
ABSENT(fmi3SetContinuousStates, 1, "model exchange",
       (fmi3Instance instance, const fmi3Float64 states[], size_t count), states, &count)
ABSENT(fmi3GetContinuousStateDerivatives, 1, "model exchange",
       (fmi3Instance instance, fmi3Float64 derivatives[], size_t count), derivatives, &count)
ABSENT(fmi3GetEventIndicators, 1, "model exchange",
       (fmi3Instance instance, fmi3Float64 indicators[], size_t count), indicators, &count)
ABSENT(fmi3GetContinuousStates, 1, "model exchange",
       (fmi3Instance instance, fmi3Float64 states[], size_t count), states, &count)
ABSENT(fmi3GetNominalsOfContinuousStates, 1, "model exchange",
       (fmi3Instance instance, fmi3Float64 nominals[], size_t count), nominals, &count)
ABSENT(fmi3GetNumberOfEventIndicators, 1, "model exchange",
       (fmi3Instance instance, size_t *count), count)
ABSENT(fmi3GetNumberOfContinuousStates, 1, "model exchange",
       (fmi3Instance instance, size_t *count), count)
ABSENT(fmi3ActivateModelPartition, 1, "scheduled execution",
       (fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 t), &clock, &t)

static fmi3Instance no_instance(fmi3String name, fmi3InstanceEnvironment environment,
                                fmi3LogMessageCallback log, const char *what) {
    Front nobody = {.log = log, .environment = environment};
    front_refuses(&nobody, "%s: this FMU has no %s", name ? name : "", what);
    return NULL;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log) {
    (void)token, (void)resources, (void)visible, (void)logging;
    return no_instance(name, environment, log, "model exchange");
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock) {
    (void)token, (void)resources, (void)visible, (void)logging;
    (void)update, (void)lock, (void)unlock;
    return no_instance(name, environment, log, "scheduled execution");
}
