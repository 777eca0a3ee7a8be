/* The exponential of a matrix: balanced, then Pade's approximant of degree 13 with scaling and squaring
   (N. J. Higham, SIAM J. Matrix Anal. Appl. 26 (2005) 1179-1193). */

/* Powers of two d that make rows and columns of A equal in size: A becomes D^-1 A D. */
static void tn_balance(double *A, double *d, int n)
{
    int again = 1;
    for (int i = 0; i < n; i++)
        d[i] = 1;
    for (int round = 0; again && round < 100; round++) {
        again = 0;
        for (int i = 0; i < n; i++) {
            double row = 0, column = 0;
            for (int j = 0; j < n; j++)
                if (j != i) {
                    row += fabs(A[(size_t)i * n + j]);
                    column += fabs(A[(size_t)j * n + i]);
                }
            if (!(row > 0) || !(column > 0))
                continue;
            const int power = (int)floor(0.5 * log2(row / column) + 0.5);
            if (power == 0)
                continue;
            const double scale = ldexp(1, power);
            again = 1;
            d[i] *= scale;
            for (int j = 0; j < n; j++) {
                A[(size_t)i * n + j] /= scale;
                A[(size_t)j * n + i] *= scale;
            }
        }
    }
}

static double tn_norm(const double *A, int n)
{
    double largest = 0;
    for (int j = 0; j < n; j++) {
        double sum = 0;
        for (int i = 0; i < n; i++)
            sum += fabs(A[(size_t)i * n + j]);
        largest = sum > largest || isnan(sum) ? sum : largest;
    }
    return largest;
}

/* to = a A + b B + c C + e 1 */
static void tn_combine(double *to, double a, const double *A, double b, const double *B, double c, const double *C,
                       double e, int n)
{
    for (size_t l = 0; l < (size_t)n * n; l++)
        to[l] = a * A[l] + b * B[l] + c * C[l];
    for (int i = 0; i < n; i++)
        to[(size_t)i * n + i] += e;
}

/* A becomes exp(A). Returns 0 where memory is short or the result is beyond numbers. */
static int tn_exponential(double *A, int n)
{
    static const double b[] = {64764752532480000, 32382376266240000, 7771770303897600, 1187353796428800,
                               129060195264000, 10559470521600, 670442572800, 33522128640, 1323241920, 40840800,
                               960960, 16380, 182, 1};
    const size_t size = (size_t)n * n;
    double *work = malloc(sizeof(double) * (6 * size + n));
    if (!work)
        return 0;
    double *A2 = work, *A4 = A2 + size, *A6 = A4 + size, *U = A6 + size, *V = U + size, *W = V + size, *d = W + size;
    tn_balance(A, d, n);
    const double norm = tn_norm(A, n);
    if (!isfinite(norm)) {
        free(work);
        return 0;
    }
    const int squarings = norm > 5.37 ? ilogb(norm / 5.37) + 1 : 0;
    for (size_t l = 0; l < size; l++)
        A[l] = ldexp(A[l], -squarings);
    tn_multiply(A2, A, A, n, n, n);
    tn_multiply(A4, A2, A2, n, n, n);
    tn_multiply(A6, A4, A2, n, n, n);
    tn_combine(W, b[13], A6, b[11], A4, b[9], A2, 0, n);
    tn_multiply(V, A6, W, n, n, n);
    tn_combine(W, b[7], A6, b[5], A4, b[3], A2, b[1], n);
    for (size_t l = 0; l < size; l++)
        V[l] += W[l];
    tn_multiply(U, A, V, n, n, n); /* the odd part */
    tn_combine(W, b[12], A6, b[10], A4, b[8], A2, 0, n);
    tn_multiply(V, A6, W, n, n, n);
    tn_combine(W, b[6], A6, b[4], A4, b[2], A2, b[0], n);
    for (size_t l = 0; l < size; l++) {
        V[l] += W[l]; /* the even part */
        A[l] = V[l] + U[l];
        V[l] -= U[l];
    }
    const int regular = tn_solve(V, A, n, n) < 0;
    for (int s = 0; s < squarings; s++) {
        tn_multiply(W, A, A, n, n, n);
        memcpy(A, W, sizeof(double) * size);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            A[(size_t)i * n + j] *= d[i] / d[j];
    free(work);
    return regular && isfinite(tn_norm(A, n));
}
