/* Functions of FMI 3.0 for what this FMU has not: other types of variables, clocks, configuration, scheduled execution. */

static fmi3Status tn_absent(fmi3Instance instance, size_t n, const char *what)
{
    return n ? (fmi3Status)tn_fail(SELF, TN_ERROR, "%s: there is nothing of the kind in this FMU", what) : fmi3OK;
}

#define TN_ABSENT(name, type) \
    TN_EXPORT fmi3Status FMI3(Get##name)(fmi3Instance instance, const fmi3ValueReference refs[], size_t n, \
                                         fmi3##type values[], size_t n_values) \
    { \
        return tn_absent(instance, n, "Get" #name); \
    } \
    TN_EXPORT fmi3Status FMI3(Set##name)(fmi3Instance instance, const fmi3ValueReference refs[], size_t n, \
                                         const fmi3##type values[], size_t n_values) \
    { \
        return tn_absent(instance, n, "Set" #name); \
    }
TN_ABSENT(Float32, Float32)
TN_ABSENT(Int8, Int8)
TN_ABSENT(UInt8, UInt8)
TN_ABSENT(Int16, Int16)
TN_ABSENT(UInt16, UInt16)
TN_ABSENT(Int32, Int32)
TN_ABSENT(UInt32, UInt32)
TN_ABSENT(Int64, Int64)
TN_ABSENT(UInt64, UInt64)
TN_ABSENT(String, String)

/* The rest of them, by their arguments after the instance and, where there are any, n value references. */
#define TN_ABSENT_OF(name, ...) \
    TN_EXPORT fmi3Status FMI3(name)(fmi3Instance instance, const fmi3ValueReference refs[], size_t n, __VA_ARGS__) \
    { \
        return tn_absent(instance, n, #name); \
    }
TN_ABSENT_OF(GetBinary, size_t sizes[], fmi3Binary values[], size_t n_values)
TN_ABSENT_OF(SetBinary, const size_t sizes[], const fmi3Binary values[], size_t n_values)
TN_ABSENT_OF(GetClock, fmi3Clock values[])
TN_ABSENT_OF(SetClock, const fmi3Clock values[])
TN_ABSENT_OF(GetIntervalDecimal, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
TN_ABSENT_OF(GetIntervalFraction, fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
TN_ABSENT_OF(GetShiftDecimal, fmi3Float64 shifts[])
TN_ABSENT_OF(GetShiftFraction, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
TN_ABSENT_OF(SetIntervalDecimal, const fmi3Float64 intervals[])
TN_ABSENT_OF(SetIntervalFraction, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
TN_ABSENT_OF(SetShiftDecimal, const fmi3Float64 shifts[])
TN_ABSENT_OF(SetShiftFraction, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
TN_ABSENT_OF(GetOutputDerivatives, const fmi3Int32 orders[], fmi3Float64 values[], size_t n_values)
TN_ABSENT_OF(GetAdjointDerivative, const fmi3ValueReference knowns[], size_t n_knowns, const fmi3Float64 seed[],
             size_t n_seed, fmi3Float64 result[], size_t n_result)

#define TN_ABSENT_ALWAYS(name, ...) \
    TN_EXPORT fmi3Status FMI3(name)(__VA_ARGS__) { return tn_absent(instance, 1, #name); }
TN_ABSENT_ALWAYS(GetNumberOfVariableDependencies, fmi3Instance instance, fmi3ValueReference ref, size_t *n)
TN_ABSENT_ALWAYS(GetVariableDependencies, fmi3Instance instance, fmi3ValueReference dependent, size_t elements[],
                 fmi3ValueReference independents[], size_t of[], fmi3DependencyKind kinds[], size_t n)
TN_ABSENT_ALWAYS(EnterConfigurationMode, fmi3Instance instance)
TN_ABSENT_ALWAYS(ExitConfigurationMode, fmi3Instance instance)
TN_ABSENT_ALWAYS(ActivateModelPartition, fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time)

TN_EXPORT fmi3Instance FMI3(InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean on,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
    if (log)
        log(environment, fmi3Error, "logStatusError", "this FMU has no scheduled execution");
    return NULL;
}
