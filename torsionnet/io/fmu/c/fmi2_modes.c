/* What FMI 2.0 has for model exchange alone, and for co-simulation alone. */

TN_EXPORT fmi2Status FMI2(EnterEventMode)(fmi2Component component)
{
    return (fmi2Status)tn_change(SELF, TN_CONTINUOUS | TN_EVENT, TN_EVENT, "event mode");
}

TN_EXPORT fmi2Status FMI2(NewDiscreteStates)(fmi2Component component, fmi2EventInfo *info)
{
    memset(info, 0, sizeof *info);
    return (fmi2Status)tn_require(SELF, TN_EVENT, "an update of discrete states");
}

TN_EXPORT fmi2Status FMI2(EnterContinuousTimeMode)(fmi2Component component)
{
    return (fmi2Status)tn_change(SELF, TN_EVENT, TN_CONTINUOUS, "continuous-time mode");
}

TN_EXPORT fmi2Status FMI2(CompletedIntegratorStep)(fmi2Component component, fmi2Boolean no_return, fmi2Boolean *event,
                                                   fmi2Boolean *terminate)
{
    *event = *terminate = 0;
    return fmi2OK;
}

TN_EXPORT fmi2Status FMI2(SetTime)(fmi2Component component, fmi2Real time)
{
    SELF->v.time = time;
    return fmi2OK;
}

TN_EXPORT fmi2Status FMI2(SetContinuousStates)(fmi2Component component, const fmi2Real x[], size_t n)
{
    return (fmi2Status)tn_set_states(SELF, x, n);
}

TN_EXPORT fmi2Status FMI2(GetContinuousStates)(fmi2Component component, fmi2Real x[], size_t n)
{
    return (fmi2Status)tn_get_states(SELF, x, n);
}

TN_EXPORT fmi2Status FMI2(GetDerivatives)(fmi2Component component, fmi2Real rates[], size_t n)
{
    return (fmi2Status)tn_get_rates(SELF, rates, n);
}

TN_EXPORT fmi2Status FMI2(GetNominalsOfContinuousStates)(fmi2Component component, fmi2Real nominals[], size_t n)
{
    for (size_t i = 0; i < n; i++)
        nominals[i] = 1;
    return fmi2OK;
}

TN_EXPORT fmi2Status FMI2(GetEventIndicators)(fmi2Component component, fmi2Real indicators[], size_t n)
{
    return n ? (fmi2Status)tn_fail(SELF, TN_ERROR, "there are no event indicators") : fmi2OK;
}

static int tn_set_slope(tn_instance *self, unsigned ref, int order, double value)
{
    if (ref < TN_REF_INPUT || ref >= TN_REF_OUTPUT || order != 1 || !isfinite(value))
        return tn_fail(self, TN_ERROR, "only first derivatives of inputs can be given, not derivative %d of %u", order, ref);
    self->v.slope[ref - TN_REF_INPUT] = value;
    self->v.sloped[ref - TN_REF_INPUT] = 1;
    return TN_OK;
}

TN_EXPORT fmi2Status FMI2(SetRealInputDerivatives)(fmi2Component component, const fmi2ValueReference refs[], size_t n,
                                                   const fmi2Integer orders[], const fmi2Real values[])
{
    for (size_t i = 0; i < n; i++)
        TN_DO(tn_set_slope(SELF, refs[i], orders[i], values[i]));
    return fmi2OK;
}

TN_EXPORT fmi2Status FMI2(GetRealOutputDerivatives)(fmi2Component component, const fmi2ValueReference refs[], size_t n,
                                                    const fmi2Integer orders[], fmi2Real values[])
{
    return n ? (fmi2Status)tn_fail(SELF, TN_ERROR, "derivatives of outputs are not provided") : fmi2OK;
}

TN_EXPORT fmi2Status FMI2(DoStep)(fmi2Component component, fmi2Real from, fmi2Real size, fmi2Boolean no_return)
{
    return (fmi2Status)tn_advance(SELF, from, size, NULL);
}

TN_EXPORT fmi2Status FMI2(CancelStep)(fmi2Component component)
{
    return (fmi2Status)tn_fail(SELF, TN_ERROR, "no step is under way");
}

TN_EXPORT fmi2Status FMI2(GetRealStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value)
{
    *value = SELF->v.time;
    return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

TN_EXPORT fmi2Status FMI2(GetBooleanStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value)
{
    *value = 0;
    return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

#define TN_NO_STATUS(name, type) \
    TN_EXPORT fmi2Status FMI2(name)(fmi2Component component, const fmi2StatusKind kind, type *value) \
    { \
        return fmi2Discard; \
    }
TN_NO_STATUS(GetStatus, fmi2Status)
TN_NO_STATUS(GetIntegerStatus, fmi2Integer)
TN_NO_STATUS(GetStringStatus, fmi2String)
