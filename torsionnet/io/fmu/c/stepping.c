/* Exact steps under inputs that run straight from u0 to u1: x+ = E x + G0 u0 + G1 u1.

   The matrices of a few step sizes are kept, so that only a step of a new size has its price. */

#define TN_KEPT 4
#define TN_W (TN_X + 2 * TN_U)

typedef struct {
    double size;
    unsigned long used;
    double *matrix; /* TN_X rows: E, G0, G1 side by side */
} tn_step;

typedef struct {
    tn_step kept[TN_KEPT];
    unsigned long count;
} tn_steps;

static void tn_forget_steps(tn_steps *steps)
{
    for (int i = 0; i < TN_KEPT; i++) {
        free(steps->kept[i].matrix);
        steps->kept[i].matrix = NULL;
    }
}

/* [A B 0; 0 0 1; 0 0 0] h: its exponential holds E and the integrals of inputs that are held or rise in time */
static int tn_make_step(double *matrix, const tn_state_space *s, double h)
{
    double *whole = calloc((size_t)TN_W * TN_W, sizeof *whole);
    int good = whole != NULL;
    if (good) {
        for (int i = 0; i < TN_X; i++)
            for (int j = 0; j < TN_XU; j++)
                whole[(size_t)i * TN_W + j] = h * s->AB[(size_t)i * TN_XU + j];
        for (int i = 0; i < TN_U; i++)
            whole[(size_t)(TN_X + i) * TN_W + TN_XU + i] = 1;
        good = tn_exponential(whole, TN_W);
    }
    for (int j = 0; good && j < TN_X; j++) { /* states that act on nothing keep what they are, to the last digit */
        int acts = 0;
        for (int i = 0; i < TN_X; i++)
            acts = acts || s->AB[(size_t)i * TN_XU + j] != 0;
        for (int i = 0; i < TN_X && !acts; i++)
            whole[(size_t)i * TN_W + j] = i == j;
    }
    for (int i = 0; good && i < TN_X; i++) {
        double *to = matrix + (size_t)i * TN_W;
        memcpy(to, whole + (size_t)i * TN_W, sizeof(double) * TN_W);
        for (int j = 0; j < TN_U; j++)
            to[TN_X + j] -= to[TN_XU + j];
    }
    free(whole);
    return good;
}

/* A kept step of this size, but for a part `slack` of it, or a new one; NULL where there is none. */
static const tn_step *tn_step_of(tn_steps *steps, const tn_state_space *s, double h, double slack)
{
    tn_step *oldest = steps->kept;
    steps->count++;
    for (int i = 0; i < TN_KEPT; i++) {
        tn_step *step = steps->kept + i;
        if (step->matrix && fabs(step->size - h) <= slack) {
            step->used = steps->count;
            return step;
        }
        if (!step->matrix || (oldest->matrix && step->used < oldest->used))
            oldest = step;
    }
    if (!oldest->matrix)
        oldest->matrix = malloc(sizeof(double) * (TN_X * TN_W + 1));
    if (!oldest->matrix || !tn_make_step(oldest->matrix, s, h)) {
        free(oldest->matrix);
        oldest->matrix = NULL;
        return NULL;
    }
    oldest->size = h;
    oldest->used = steps->count;
    return oldest;
}

/* x after a step. Returns whether it is finite; if not, x stays as it was. */
static int tn_take_step(const tn_step *step, double *x, const double *u0, const double *u1)
{
    double all[TN_W + 1], next[TN_X + 1];
    int finite = 1;
    memcpy(all, x, sizeof(double) * TN_X);
    memcpy(all + TN_X, u0, sizeof(double) * TN_U);
    memcpy(all + TN_XU, u1, sizeof(double) * TN_U);
    for (int i = 0; i < TN_X; i++) {
        next[i] = tn_product(step->matrix + (size_t)i * TN_W, all, TN_W);
        finite = finite && isfinite(next[i]);
    }
    if (finite)
        memcpy(x, next, sizeof(double) * TN_X);
    return finite;
}
