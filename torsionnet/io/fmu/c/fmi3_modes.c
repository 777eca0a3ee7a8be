/* FMI 3.0: states that are stored, derivatives, model exchange and the steps of co-simulation. */

TN_EXPORT fmi3Status FMI3(GetFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    return (fmi3Status)tn_store(SELF, state);
}

TN_EXPORT fmi3Status FMI3(SetFMUState)(fmi3Instance instance, fmi3FMUState state)
{
    return (fmi3Status)tn_restore(SELF, state);
}

TN_EXPORT fmi3Status FMI3(FreeFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    tn_discard(state);
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState state, size_t *size)
{
    *size = sizeof(tn_variables);
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(SerializeFMUState)(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    return (fmi3Status)tn_pack(SELF, state, bytes, size);
}

TN_EXPORT fmi3Status FMI3(DeserializeFMUState)(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                               fmi3FMUState *state)
{
    return (fmi3Status)tn_unpack(SELF, bytes, size, state);
}

TN_EXPORT fmi3Status FMI3(GetDirectionalDerivative)(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                                    size_t n_unknowns, const fmi3ValueReference knowns[],
                                                    size_t n_knowns, const fmi3Float64 seed[], size_t n_seed,
                                                    fmi3Float64 result[], size_t n_result)
{
    if (n_seed != n_knowns || n_result != n_unknowns)
        return (fmi3Status)tn_fail(SELF, TN_ERROR, "a directional derivative has as many numbers as variables");
    return (fmi3Status)tn_directional(SELF, unknowns, n_unknowns, knowns, n_knowns, seed, result);
}

TN_EXPORT fmi3Status FMI3(EvaluateDiscreteStates)(fmi3Instance instance)
{
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(UpdateDiscreteStates)(fmi3Instance instance, fmi3Boolean *again, fmi3Boolean *terminate,
                                                fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                                fmi3Boolean *next_event_defined, fmi3Float64 *next_event)
{
    *again = *terminate = *nominals_changed = *values_changed = *next_event_defined = false;
    *next_event = 0;
    return (fmi3Status)tn_require(SELF, TN_EVENT, "an update of discrete states");
}

TN_EXPORT fmi3Status FMI3(CompletedIntegratorStep)(fmi3Instance instance, fmi3Boolean no_return, fmi3Boolean *event,
                                                   fmi3Boolean *terminate)
{
    *event = *terminate = false;
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(SetTime)(fmi3Instance instance, fmi3Float64 time)
{
    SELF->v.time = time;
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(SetContinuousStates)(fmi3Instance instance, const fmi3Float64 x[], size_t n)
{
    return (fmi3Status)tn_set_states(SELF, x, n);
}

TN_EXPORT fmi3Status FMI3(GetContinuousStates)(fmi3Instance instance, fmi3Float64 x[], size_t n)
{
    return (fmi3Status)tn_get_states(SELF, x, n);
}

TN_EXPORT fmi3Status FMI3(GetContinuousStateDerivatives)(fmi3Instance instance, fmi3Float64 rates[], size_t n)
{
    return (fmi3Status)tn_get_rates(SELF, rates, n);
}

TN_EXPORT fmi3Status FMI3(GetNominalsOfContinuousStates)(fmi3Instance instance, fmi3Float64 nominals[], size_t n)
{
    for (size_t i = 0; i < n; i++)
        nominals[i] = 1;
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(GetNumberOfContinuousStates)(fmi3Instance instance, size_t *n)
{
    *n = TN_X;
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(GetNumberOfEventIndicators)(fmi3Instance instance, size_t *n)
{
    *n = 0;
    return fmi3OK;
}

TN_EXPORT fmi3Status FMI3(GetEventIndicators)(fmi3Instance instance, fmi3Float64 indicators[], size_t n)
{
    return n ? (fmi3Status)tn_fail(SELF, TN_ERROR, "there are no event indicators") : fmi3OK;
}

TN_EXPORT fmi3Status FMI3(DoStep)(fmi3Instance instance, fmi3Float64 from, fmi3Float64 size, fmi3Boolean no_return,
                                  fmi3Boolean *event_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                                  fmi3Float64 *last_time)
{
    *event_needed = *terminate = *early_return = false;
    const int status = tn_advance(SELF, from, size, SELF->update_callback ? tn_ask3 : NULL);
    *last_time = SELF->v.time;
    return (fmi3Status)status;
}
