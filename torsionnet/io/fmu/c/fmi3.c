/* The functions of FMI 3.0 that work here. */

#define SELF ((tn_instance *)instance)

static void tn_log3(tn_instance *self, int status, const char *text)
{
    ((fmi3LogMessageCallback)self->log_callback)(self->environment, (fmi3Status)status, "logStatusError", text);
}

/* Ask the host for the inputs at the end of the step. */
static int tn_ask3(tn_instance *self, double to)
{
    fmi3Boolean early = false;
    fmi3Float64 early_time = to;
    self->v.mode = TN_INTERMEDIATE;
    ((fmi3IntermediateUpdateCallback)self->update_callback)(self->environment, to, true, false, false, false, &early,
                                                            &early_time);
    self->v.mode = TN_STEPPING;
    return TN_OK;
}

static fmi3Instance tn_new3(fmi3String name, fmi3String token, int co_simulation, fmi3InstanceEnvironment environment,
                            fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    tn_instance *self = name && token ? tn_new(name, co_simulation) : NULL;
    if (!self)
        return NULL;
    self->environment = environment;
    self->log_callback = (tn_callback)log;
    self->log = log ? tn_log3 : NULL;
    self->update_callback = (tn_callback)update;
    if (strcmp(token, TN_TOKEN) != 0) {
        tn_fail(self, TN_ERROR, "the instantiation token is not that of this FMU");
        tn_free(self);
        return NULL;
    }
    return self;
}

TN_EXPORT const char *FMI3(GetVersion)(void) { return "3.0"; }

/* Errors are all there is to log. */
TN_EXPORT fmi3Status FMI3(SetDebugLogging)(fmi3Instance instance, fmi3Boolean on, size_t n, const fmi3String names[])
{
    return fmi3OK;
}

TN_EXPORT fmi3Instance FMI3(InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                      fmi3Boolean visible, fmi3Boolean on,
                                                      fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    return tn_new3(name, token, 0, environment, log, NULL);
}

TN_EXPORT fmi3Instance FMI3(InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean on, fmi3Boolean events,
    fmi3Boolean early_return, const fmi3ValueReference intermediate[], size_t n, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    tn_instance *self = tn_new3(name, token, 1, environment, log, n ? update : NULL);
    if (self)
        self->events = events;
    return self;
}

TN_EXPORT void FMI3(FreeInstance)(fmi3Instance instance) { tn_free(SELF); }

TN_EXPORT fmi3Status FMI3(EnterInitializationMode)(fmi3Instance instance, fmi3Boolean tolerance_given,
                                                   fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean stop_given,
                                                   fmi3Float64 stop)
{
    TN_DO(tn_setup(SELF, start));
    return (fmi3Status)tn_change(SELF, TN_INSTANTIATED, TN_INITIALIZING, "the initialization");
}

TN_EXPORT fmi3Status FMI3(ExitInitializationMode)(fmi3Instance instance) { return (fmi3Status)tn_start_up(SELF); }

TN_EXPORT fmi3Status FMI3(EnterEventMode)(fmi3Instance instance)
{
    return (fmi3Status)tn_change(SELF, TN_CONTINUOUS | TN_STEPPING | TN_EVENT, TN_EVENT, "event mode");
}

TN_EXPORT fmi3Status FMI3(EnterStepMode)(fmi3Instance instance)
{
    return (fmi3Status)tn_change(SELF, TN_EVENT, TN_STEPPING, "step mode");
}

TN_EXPORT fmi3Status FMI3(EnterContinuousTimeMode)(fmi3Instance instance)
{
    return (fmi3Status)tn_change(SELF, TN_EVENT, TN_CONTINUOUS, "continuous-time mode");
}

TN_EXPORT fmi3Status FMI3(Terminate)(fmi3Instance instance)
{
    return (fmi3Status)tn_change(SELF, TN_EVENT | TN_CONTINUOUS | TN_STEPPING, TN_TERMINATED, "termination");
}

TN_EXPORT fmi3Status FMI3(Reset)(fmi3Instance instance)
{
    tn_reset(SELF);
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(GetFloat64)(fmi3Instance instance, const fmi3ValueReference refs[], size_t n,
                                      fmi3Float64 values[], size_t n_values)
{
    for (size_t i = 0; i < n && i < n_values; i++)
        TN_DO(tn_get(SELF, refs[i], values + i));
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(SetFloat64)(fmi3Instance instance, const fmi3ValueReference refs[], size_t n,
                                      const fmi3Float64 values[], size_t n_values)
{
    for (size_t i = 0; i < n && i < n_values; i++)
        TN_DO(tn_set(SELF, refs[i], values[i]));
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(GetBoolean)(fmi3Instance instance, const fmi3ValueReference refs[], size_t n,
                                      fmi3Boolean values[], size_t n_values)
{
    for (size_t i = 0; i < n && i < n_values; i++) {
        int value;
        TN_DO(tn_get_flag(SELF, refs[i], &value));
        values[i] = value != 0;
    }
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(SetBoolean)(fmi3Instance instance, const fmi3ValueReference refs[], size_t n,
                                      const fmi3Boolean values[], size_t n_values)
{
    for (size_t i = 0; i < n && i < n_values; i++)
        TN_DO(tn_set_flag(SELF, refs[i], values[i]));
    return fmi3OK;
}
