/* From the matrices of the mechanics to the state space x' = A x + B u, y = C x + D u.

   Coordinates c are heavy (TN_H), damped (TN_B) and static (TN_S) ones, in this order; states are heavy angles, their
   speeds, damped angles. */

#define TN_N (TN_H + TN_B + TN_S)
#define TN_X (2 * TN_H + TN_B)
#define TN_XU (TN_X + TN_U)

typedef struct {
    double M[TN_N * TN_N + 1], C[TN_N * TN_N + 1], K[TN_N * TN_N + 1], L[TN_N * TN_U + 1];
    double R0[TN_Y * TN_N + 1], R1[TN_Y * TN_N + 1], R2[TN_Y * TN_N + 1], F[TN_Y * TN_U + 1];
} tn_mechanics;

/* c = G (x, u), c' = G1 (x, u), and the state space itself, states and inputs side by side */
typedef struct {
    double G[TN_N * TN_XU + 1], AB[TN_X * TN_XU + 1], CD[TN_Y * TN_XU + 1], derived[TN_Q + 1];
} tn_state_space;

static void tn_fill(const double *p, double *derived, tn_mechanics *m);

/* rows `to` .. of the right-hand side: load - K c - C v, where v holds rates known so far */
static void tn_residual(double *rhs, const tn_mechanics *m, const double *G, const double *v, int first, int count)
{
    for (int i = 0; i < count; i++) {
        double *row = rhs + (size_t)i * TN_XU;
        memset(row, 0, sizeof(double) * TN_XU);
        for (int j = 0; j < TN_U; j++)
            row[TN_X + j] = m->L[(first + i) * TN_U + j];
        for (int j = 0; j < TN_N; j++) {
            const double k = m->K[(first + i) * TN_N + j], c = m->C[(first + i) * TN_N + j];
            for (int l = 0; l < TN_XU && (k != 0 || c != 0); l++)
                row[l] -= k * G[(size_t)j * TN_XU + l] + c * v[(size_t)j * TN_XU + l];
        }
    }
}

static void tn_block(double *to, const double *from, int first, int count)
{
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            to[i * count + j] = from[(first + i) * TN_N + first + j];
}

/* CD = R0 G + R1 G' + R2 G'' + F; A carries a row over states on in time */
static void tn_outputs(tn_state_space *s, const tn_mechanics *m, double *work)
{
    const double *R[] = {m->R0, m->R1, m->R2};
    double *row = work, *next = work + TN_XU;
    for (int y = 0; y < TN_Y; y++) {
        double *to = s->CD + (size_t)y * TN_XU;
        memcpy(to + TN_X, m->F + (size_t)y * TN_U, sizeof(double) * TN_U);
        for (int power = 0; power < 3; power++) {
            memset(row, 0, sizeof(double) * TN_XU);
            for (int j = 0; j < TN_N; j++)
                for (int l = 0; l < TN_XU && R[power][y * TN_N + j] != 0; l++)
                    row[l] += R[power][y * TN_N + j] * s->G[(size_t)j * TN_XU + l];
            for (int step = 0; step < power; step++) {
                tn_multiply(next, row, s->AB, 1, TN_X, TN_XU);
                memcpy(row, next, sizeof(double) * TN_XU);
            }
            for (int l = 0; l < TN_XU; l++)
                to[l] += row[l];
        }
    }
}

static const char *tn_assemble_with(tn_state_space *s, tn_mechanics *m, double *work)
{
    double *block = work, *rhs = block + TN_N * TN_N, *v = rhs + (size_t)TN_N * TN_XU;
    double *G = s->G, *heavy = G, *damped = G + (size_t)TN_H * TN_XU, *fixed = damped + (size_t)TN_B * TN_XU;
    for (int i = 0; i < TN_H; i++) {
        heavy[(size_t)i * TN_XU + i] = 1;
        v[(size_t)i * TN_XU + TN_H + i] = 1;
        s->AB[(size_t)i * TN_XU + TN_H + i] = 1;
    }
    for (int i = 0; i < TN_B; i++)
        damped[(size_t)i * TN_XU + 2 * TN_H + i] = 1;
    tn_residual(rhs, m, G, v, TN_H + TN_B, TN_S);
    tn_block(block, m->K, TN_H + TN_B, TN_S);
    if (tn_solve(block, rhs, TN_S, TN_XU) >= 0)
        return "these parameters leave a massless node without a spring";
    memcpy(fixed, rhs, sizeof(double) * TN_S * TN_XU);
    tn_residual(rhs, m, G, v, TN_H, TN_B);
    tn_block(block, m->C, TN_H, TN_B);
    if (tn_solve(block, rhs, TN_B, TN_XU) >= 0)
        return "these parameters leave a massless node without a damper";
    memcpy(s->AB + (size_t)2 * TN_H * TN_XU, rhs, sizeof(double) * TN_B * TN_XU);
    memcpy(v + (size_t)TN_H * TN_XU, rhs, sizeof(double) * TN_B * TN_XU);
    tn_residual(rhs, m, G, v, 0, TN_H);
    tn_block(block, m->M, 0, TN_H);
    if (tn_solve(block, rhs, TN_H, TN_XU) >= 0)
        return "these parameters leave a node without inertia";
    memcpy(s->AB + (size_t)TN_H * TN_XU, rhs, sizeof(double) * TN_H * TN_XU);
    tn_outputs(s, m, work);
    for (size_t l = 0; l < (size_t)TN_X * TN_XU; l++)
        if (!isfinite(s->AB[l]))
            return "these parameters lead to numbers that are not finite";
    for (size_t l = 0; l < (size_t)TN_Y * TN_XU; l++)
        if (!isfinite(s->CD[l]))
            return "these parameters lead to numbers that are not finite";
    return NULL;
}

/* The state space of parameters p. Returns what is wrong with them, or NULL. */
static const char *tn_assemble(tn_state_space *s, const double *p)
{
    tn_mechanics *m = calloc(1, sizeof *m);
    double *work = calloc((size_t)TN_N * TN_N + 2 * (size_t)(TN_N + 1) * TN_XU, sizeof *work);
    const char *fault = "out of memory";
    if (m && work) {
        memset(s, 0, sizeof *s);
        tn_fill(p, s->derived, m);
        fault = tn_assemble_with(s, m, work);
    }
    free(m);
    free(work);
    return fault;
}
