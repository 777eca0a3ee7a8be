/* What both versions of the interface ask for in much the same words. */

static int tn_change(tn_instance *self, int from, int to, const char *what)
{
    TN_DO(tn_require(self, from, what));
    if (to == TN_EVENT)
        self->v.last_step = 0; /* inputs may jump: nothing is extrapolated across an event */
    self->v.mode = to;
    return TN_OK;
}

static int tn_setup(tn_instance *self, double start)
{
    TN_DO(tn_require(self, TN_INSTANTIATED, "the set-up of an experiment"));
    self->v.time = self->v.reached = start;
    return TN_OK;
}

static int tn_start_up(tn_instance *self)
{
    TN_DO(tn_refresh(self));
    return tn_change(self, TN_INITIALIZING, self->co_simulation && !self->events ? TN_STEPPING : TN_EVENT,
                     "the end of the initialization");
}

static int tn_get_flag(tn_instance *self, unsigned ref, int *value)
{
    *value = self->v.extrapolate;
    return ref == TN_REF_EXTRAPOLATE ? TN_OK : tn_fail(self, TN_ERROR, "there is no boolean variable %u", ref);
}

static int tn_set_flag(tn_instance *self, unsigned ref, int value)
{
    if (ref != TN_REF_EXTRAPOLATE)
        return tn_fail(self, TN_ERROR, "there is no boolean variable %u", ref);
    TN_DO(tn_require(self, TN_INSTANTIATED | TN_INITIALIZING, "a change of a fixed parameter"));
    self->v.extrapolate = value != 0;
    return TN_OK;
}

static int tn_set_states(tn_instance *self, const double *x, size_t n)
{
    if (n != TN_X)
        return tn_fail(self, TN_ERROR, "there are %d states, not %u", TN_X, (unsigned)n);
    memcpy(self->v.x, x, sizeof(double) * TN_X);
    return TN_OK;
}

static int tn_get_states(tn_instance *self, double *x, size_t n)
{
    if (n != TN_X)
        return tn_fail(self, TN_ERROR, "there are %d states, not %u", TN_X, (unsigned)n);
    memcpy(x, self->v.x, sizeof(double) * TN_X);
    return TN_OK;
}

static int tn_get_rates(tn_instance *self, double *rates, size_t n)
{
    if (n != TN_X)
        return tn_fail(self, TN_ERROR, "there are %d states, not %u", TN_X, (unsigned)n);
    for (unsigned i = 0; i < TN_X; i++)
        TN_DO(tn_get(self, TN_REF_RATE + i, rates + i));
    return TN_OK;
}

/* A stored state is a copy of the variables; what follows from parameters is calculated again where these differ. */
static int tn_unpack(tn_instance *self, const void *bytes, size_t size, void **state)
{
    if (size != sizeof(tn_variables))
        return tn_fail(self, TN_ERROR, "a stored state has %u bytes, not %u", (unsigned)sizeof(tn_variables), (unsigned)size);
    if (!*state)
        *state = malloc(size);
    if (!*state)
        return tn_fail(self, TN_ERROR, "out of memory");
    memcpy(*state, bytes, size);
    return TN_OK;
}

static int tn_store(tn_instance *self, void **state)
{
    return tn_unpack(self, &self->v, sizeof self->v, state);
}

static int tn_pack(tn_instance *self, const void *state, void *bytes, size_t size)
{
    if (!state || size < sizeof(tn_variables))
        return tn_fail(self, TN_ERROR, "a stored state needs %u bytes", (unsigned)sizeof(tn_variables));
    memcpy(bytes, state, sizeof(tn_variables));
    return TN_OK;
}

static int tn_restore(tn_instance *self, const void *state)
{
    if (!state)
        return tn_fail(self, TN_ERROR, "there is no stored state");
    const tn_variables *stored = state;
    self->stale = self->stale || memcmp(stored->p, self->v.p, sizeof stored->p) != 0;
    self->v = *stored;
    return TN_OK;
}

static void tn_discard(void **state)
{
    if (state) {
        free(*state);
        *state = NULL;
    }
}

static int tn_directional(tn_instance *self, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns,
                          size_t n_knowns, const double *seed, double *result)
{
    for (size_t i = 0; i < n_unknowns; i++) {
        result[i] = 0;
        for (size_t j = 0; j < n_knowns; j++) {
            double partial;
            TN_DO(tn_partial(self, unknowns[i], knowns[j], &partial));
            result[i] += partial * seed[j];
        }
    }
    return TN_OK;
}
