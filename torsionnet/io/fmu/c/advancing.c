/* Co-simulation: from one communication point to the next.

   The host tells the inputs where a step begins. Where they get to is, in this order: what it tells in an intermediate
   update, what follows from derivatives it gave, and a guess: the straight line on from the last step. What was guessed
   is put right when the next step begins and tells: the states are then those of inputs that ran straight from point to
   point, and no guess is ever carried on. */

/* Ends of the inputs by what is known at the beginning of a step. */
static void tn_predict(tn_variables *v, double h)
{
    for (int i = 0; i < TN_U; i++) {
        const int guess = v->extrapolate && !v->sloped[i];
        const double slope = v->sloped[i] ? v->slope[i] : guess && v->last_step > 0 ? (v->u[i] - v->before[i]) / v->last_step : 0;
        v->guess[i] = v->now[i] = v->u[i] + slope * h;
        v->guessed[i] = (unsigned char)guess;
    }
}

/* What the last step would have come to had the guesses been right. */
static int tn_put_right(tn_instance *self)
{
    tn_variables *v = &self->v;
    double missed[TN_U + 1];
    int any = 0;
    for (int i = 0; i < TN_U; i++) {
        missed[i] = v->last_step > 0 && v->guessed[i] ? v->u[i] - v->guess[i] : 0;
        any = any || missed[i] != 0;
    }
    if (!any)
        return TN_OK;
    const tn_step *step = tn_step_of(&self->steps, self->space, v->last_step, 1e-7 * v->last_step);
    if (!step)
        return TN_ERROR;
    for (int i = 0; i < TN_X; i++)
        v->x[i] += tn_product(step->matrix + (size_t)i * TN_W + TN_XU, missed, TN_U);
    return TN_OK;
}

/* Rounding makes equal steps differ in their last digits: what is left over is made up for later. */
static int tn_advance(tn_instance *self, double from, double h, int (*ask)(tn_instance *, double to))
{
    tn_variables *v = &self->v;
    double start[TN_U + 1];
    if (tn_require(self, TN_STEPPING, "a step") != TN_OK || tn_refresh(self) != TN_OK)
        return TN_ERROR;
    if (!isfinite(from) || !isfinite(h) || !(h >= 0))
        return tn_fail(self, TN_ERROR, "a step goes from a time by a size of at least 0, not from %g by %g", from, h);
    if (h == 0)
        return TN_OK;
    if (tn_put_right(self) != TN_OK)
        return tn_fail(self, TN_ERROR, "the step before %g has no matrix exponential", from);
    const double slack = 1e-7 * h + 1e-15 * fabs(from), size = from + h - v->reached;
    const int continues = fabs(from - v->reached) <= slack;
    const tn_step *step = tn_step_of(&self->steps, self->space, continues ? size : h, slack);
    if (!step)
        return tn_fail(self, TN_ERROR, "the step from %g by %g has no matrix exponential", from, h);
    memcpy(start, v->u, sizeof start);
    tn_predict(v, h);
    if (ask && ask(self, from + h) != TN_OK)
        return TN_ERROR;
    if (!tn_take_step(step, v->x, start, v->now))
        return tn_fail(self, TN_ERROR, "the states are beyond numbers at time %g", from + h);
    for (int i = 0; i < TN_U; i++) /* where the host told the end, nothing is left to put right */
        v->guessed[i] = v->guessed[i] && v->now[i] == v->guess[i];
    memcpy(v->before, start, sizeof start);
    memset(v->sloped, 0, sizeof v->sloped);
    v->reached = (continues ? v->reached : from) + step->size;
    v->time = from + h;
    v->last_step = h;
    return TN_OK;
}
