/* One instance: all that it knows stands in its own memory, so that any number of them run side by side. */

#include <stdarg.h>
#include <stdio.h>

enum { TN_OK, TN_WARNING, TN_DISCARD, TN_ERROR, TN_FATAL };
enum { TN_INSTANTIATED = 1, TN_INITIALIZING = 2, TN_EVENT = 4, TN_CONTINUOUS = 8, TN_STEPPING = 16, TN_INTERMEDIATE = 32,
       TN_TERMINATED = 64 };

/* Value references, in this order: time, inputs, outputs, states, their derivatives, parameters, derived parameters,
   whether inputs are extrapolated. */
enum { TN_REF_INPUT = 1, TN_REF_OUTPUT = TN_REF_INPUT + TN_U, TN_REF_STATE = TN_REF_OUTPUT + TN_Y,
       TN_REF_RATE = TN_REF_STATE + TN_X, TN_REF_PARAMETER = TN_REF_RATE + TN_X,
       TN_REF_DERIVED = TN_REF_PARAMETER + TN_P, TN_REF_EXTRAPOLATE = TN_REF_DERIVED + TN_Q };

/* What changes in the course of a simulation, and what a stored state consists of. */
typedef struct {
    double p[TN_P + 1], x[TN_X + 1];
    double u[TN_U + 1];       /* as the host set them */
    double now[TN_U + 1];     /* what outputs and derivatives see: after a step, where the inputs have got to */
    double before[TN_U + 1];  /* at the beginning of the last step */
    double slope[TN_U + 1];   /* of the next step, where `sloped` */
    double guess[TN_U + 1];   /* at the end of the last step, where `guessed` */
    unsigned char sloped[TN_U + 1], guessed[TN_U + 1];
    double time;              /* of the host */
    double reached;           /* to which the states belong; the same but for rounding */
    double last_step;         /* 0 where there is none to go on from */
    int extrapolate, mode;
} tn_variables;

typedef void (*tn_callback)(void);

typedef struct tn_instance {
    tn_variables v;
    tn_state_space *space; /* of v.p, unless `stale` */
    int stale, co_simulation, events;
    tn_steps steps;
    void *environment;
    char *name;
    void (*log)(struct tn_instance *, int status, const char *text);
    tn_callback log_callback, update_callback; /* of the host, of types that depend on the interface */
} tn_instance;

static int tn_fail(tn_instance *self, int status, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (self && self->log)
        self->log(self, status, text);
    return status;
}

static void tn_reset(tn_instance *self)
{
    memset(&self->v, 0, sizeof self->v);
    memcpy(self->v.p, tn_start, sizeof(double) * TN_P);
    self->v.extrapolate = 1;
    self->v.mode = TN_INSTANTIATED;
    self->stale = 1;
}

static void tn_free(tn_instance *self)
{
    if (!self)
        return;
    tn_forget_steps(&self->steps);
    free(self->space);
    free(self->name);
    free(self);
}

static tn_instance *tn_new(const char *name, int co_simulation)
{
    tn_instance *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->space = calloc(1, sizeof *self->space);
    self->name = calloc(strlen(name) + 1, 1);
    self->co_simulation = co_simulation;
    if (!self->space || !self->name) {
        tn_free(self);
        return NULL;
    }
    strcpy(self->name, name);
    tn_reset(self);
    return self;
}

/* Make the state space that of the parameters. */
static int tn_refresh(tn_instance *self)
{
    if (self->stale) {
        const char *fault = tn_assemble(self->space, self->v.p);
        if (fault)
            return tn_fail(self, TN_ERROR, "%s", fault);
        tn_forget_steps(&self->steps);
        self->stale = 0;
    }
    return TN_OK;
}

static int tn_require(tn_instance *self, int modes, const char *what)
{
    if (!self)
        return TN_ERROR;
    return self->v.mode & modes ? TN_OK : tn_fail(self, TN_ERROR, "%s is not allowed at this point", what);
}

static double tn_dot(const tn_instance *self, const double *row)
{
    return tn_product(row, self->v.x, TN_X) + tn_product(row + TN_X, self->v.now, TN_U);
}

static int tn_get(tn_instance *self, unsigned ref, double *value)
{
    const int computed = (ref >= TN_REF_OUTPUT && ref < TN_REF_STATE) || (ref >= TN_REF_RATE && ref < TN_REF_PARAMETER) ||
                         (ref >= TN_REF_DERIVED && ref < TN_REF_EXTRAPOLATE);
    if (computed && tn_refresh(self) != TN_OK)
        return TN_ERROR;
    if (ref == 0)
        *value = self->v.time;
    else if (ref < TN_REF_OUTPUT)
        *value = self->v.u[ref - TN_REF_INPUT];
    else if (ref < TN_REF_STATE)
        *value = tn_dot(self, self->space->CD + (size_t)(ref - TN_REF_OUTPUT) * TN_XU);
    else if (ref < TN_REF_RATE)
        *value = self->v.x[ref - TN_REF_STATE];
    else if (ref < TN_REF_PARAMETER)
        *value = tn_dot(self, self->space->AB + (size_t)(ref - TN_REF_RATE) * TN_XU);
    else if (ref < TN_REF_DERIVED)
        *value = self->v.p[ref - TN_REF_PARAMETER];
    else if (ref < TN_REF_EXTRAPOLATE)
        *value = self->space->derived[ref - TN_REF_DERIVED];
    else
        return tn_fail(self, TN_ERROR, "there is no real variable with value reference %u", ref);
    return TN_OK;
}

static int tn_set(tn_instance *self, unsigned ref, double value)
{
    const int before_start = self->v.mode & (TN_INSTANTIATED | TN_INITIALIZING);
    if (!isfinite(value))
        return tn_fail(self, TN_ERROR, "value reference %u is set to a number that is not finite", ref);
    if (ref >= TN_REF_INPUT && ref < TN_REF_OUTPUT) {
        self->v.now[ref - TN_REF_INPUT] = self->v.u[ref - TN_REF_INPUT] = value;
    } else if (ref >= TN_REF_STATE && ref < TN_REF_RATE && before_start) {
        self->v.x[ref - TN_REF_STATE] = value;
    } else if (ref >= TN_REF_PARAMETER && ref < TN_REF_DERIVED && before_start) {
        self->stale = self->stale || self->v.p[ref - TN_REF_PARAMETER] != value;
        self->v.p[ref - TN_REF_PARAMETER] = value;
    } else {
        return tn_fail(self, TN_ERROR, before_start ? "value reference %u cannot be set"
                                                    : "value reference %u cannot be set after the initialization", ref);
    }
    return TN_OK;
}

/* d(unknown)/d(known) of outputs and derivatives with respect to states and inputs */
static int tn_partial(tn_instance *self, unsigned unknown, unsigned known, double *value)
{
    const int output = unknown >= TN_REF_OUTPUT && unknown < TN_REF_STATE;
    const int rate = unknown >= TN_REF_RATE && unknown < TN_REF_PARAMETER;
    const int state = known >= TN_REF_STATE && known < TN_REF_RATE;
    const int input = known >= TN_REF_INPUT && known < TN_REF_OUTPUT;
    if (!(output || rate) || !(state || input))
        return tn_fail(self, TN_ERROR, "there is no derivative of value reference %u by %u", unknown, known);
    if (tn_refresh(self) != TN_OK)
        return TN_ERROR;
    const double *row = output ? self->space->CD + (size_t)(unknown - TN_REF_OUTPUT) * TN_XU
                               : self->space->AB + (size_t)(unknown - TN_REF_RATE) * TN_XU;
    *value = row[state ? known - TN_REF_STATE : TN_X + known - TN_REF_INPUT];
    return TN_OK;
}
