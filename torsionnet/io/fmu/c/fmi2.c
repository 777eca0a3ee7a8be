/* The functions of FMI 2.0 for co-simulation and model exchange. */

#define SELF ((tn_instance *)component)

typedef void (*tn_logger2)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);

static void tn_log2(tn_instance *self, int status, const char *text)
{
    ((tn_logger2)self->log_callback)(self->environment, self->name, (fmi2Status)status, "logStatusError", text);
}

TN_EXPORT const char *FMI2(GetTypesPlatform)(void) { return "default"; }
TN_EXPORT const char *FMI2(GetVersion)(void) { return "2.0"; }

/* Errors are all there is to log. */
TN_EXPORT fmi2Status FMI2(SetDebugLogging)(fmi2Component component, fmi2Boolean on, size_t n, const fmi2String names[])
{
    return fmi2OK;
}

TN_EXPORT fmi2Component FMI2(Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean log)
{
    tn_instance *self = name && guid ? tn_new(name, type == fmi2CoSimulation) : NULL;
    if (!self)
        return NULL;
    if (functions && functions->logger) {
        self->environment = functions->componentEnvironment;
        self->log_callback = (tn_callback)functions->logger;
        self->log = tn_log2;
    }
    if (strcmp(guid, TN_TOKEN) != 0) {
        tn_fail(self, TN_ERROR, "the guid is not that of this FMU");
        tn_free(self);
        return NULL;
    }
    return self;
}

TN_EXPORT void FMI2(FreeInstance)(fmi2Component component) { tn_free(SELF); }

TN_EXPORT fmi2Status FMI2(SetupExperiment)(fmi2Component component, fmi2Boolean tolerance_given, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean stop_given, fmi2Real stop)
{
    return (fmi2Status)tn_setup(SELF, start);
}

TN_EXPORT fmi2Status FMI2(EnterInitializationMode)(fmi2Component component)
{
    return (fmi2Status)tn_change(SELF, TN_INSTANTIATED, TN_INITIALIZING, "the initialization");
}

TN_EXPORT fmi2Status FMI2(ExitInitializationMode)(fmi2Component component)
{
    return (fmi2Status)tn_start_up(SELF);
}

TN_EXPORT fmi2Status FMI2(Terminate)(fmi2Component component)
{
    return (fmi2Status)tn_change(SELF, TN_EVENT | TN_CONTINUOUS | TN_STEPPING, TN_TERMINATED, "termination");
}

TN_EXPORT fmi2Status FMI2(Reset)(fmi2Component component)
{
    tn_reset(SELF);
    return fmi2OK;
}

TN_EXPORT fmi2Status FMI2(GetReal)(fmi2Component component, const fmi2ValueReference refs[], size_t n, fmi2Real values[])
{
    for (size_t i = 0; i < n; i++)
        TN_DO(tn_get(SELF, refs[i], values + i));
    return fmi2OK;
}

TN_EXPORT fmi2Status FMI2(SetReal)(fmi2Component component, const fmi2ValueReference refs[], size_t n,
                                   const fmi2Real values[])
{
    for (size_t i = 0; i < n; i++)
        TN_DO(tn_set(SELF, refs[i], values[i]));
    return fmi2OK;
}

TN_EXPORT fmi2Status FMI2(GetBoolean)(fmi2Component component, const fmi2ValueReference refs[], size_t n,
                                      fmi2Boolean values[])
{
    for (size_t i = 0; i < n; i++)
        TN_DO(tn_get_flag(SELF, refs[i], values + i));
    return fmi2OK;
}

TN_EXPORT fmi2Status FMI2(SetBoolean)(fmi2Component component, const fmi2ValueReference refs[], size_t n,
                                      const fmi2Boolean values[])
{
    for (size_t i = 0; i < n; i++)
        TN_DO(tn_set_flag(SELF, refs[i], values[i]));
    return fmi2OK;
}

#define TN_NO_VARIABLES(name, type) \
    TN_EXPORT fmi2Status FMI2(name)(fmi2Component component, const fmi2ValueReference refs[], size_t n, type values[]) \
    { \
        return n ? (fmi2Status)tn_fail(SELF, TN_ERROR, "there are no variables of the type of " #name) : fmi2OK; \
    }
TN_NO_VARIABLES(GetInteger, fmi2Integer)
TN_NO_VARIABLES(GetString, fmi2String)
TN_NO_VARIABLES(SetInteger, const fmi2Integer)
TN_NO_VARIABLES(SetString, const fmi2String)

TN_EXPORT fmi2Status FMI2(GetFMUstate)(fmi2Component component, fmi2FMUstate *state)
{
    return (fmi2Status)tn_store(SELF, state);
}

TN_EXPORT fmi2Status FMI2(SetFMUstate)(fmi2Component component, fmi2FMUstate state)
{
    return (fmi2Status)tn_restore(SELF, state);
}

TN_EXPORT fmi2Status FMI2(FreeFMUstate)(fmi2Component component, fmi2FMUstate *state)
{
    tn_discard(state);
    return fmi2OK;
}

TN_EXPORT fmi2Status FMI2(SerializedFMUstateSize)(fmi2Component component, fmi2FMUstate state, size_t *size)
{
    *size = sizeof(tn_variables);
    return fmi2OK;
}

TN_EXPORT fmi2Status FMI2(SerializeFMUstate)(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    return (fmi2Status)tn_pack(SELF, state, bytes, size);
}

TN_EXPORT fmi2Status FMI2(DeSerializeFMUstate)(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate *state)
{
    return (fmi2Status)tn_unpack(SELF, bytes, size, state);
}

TN_EXPORT fmi2Status FMI2(GetDirectionalDerivative)(fmi2Component component, const fmi2ValueReference unknowns[],
                                                    size_t n_unknowns, const fmi2ValueReference knowns[],
                                                    size_t n_knowns, const fmi2Real seed[], fmi2Real result[])
{
    return (fmi2Status)tn_directional(SELF, unknowns, n_unknowns, knowns, n_knowns, seed, result);
}
