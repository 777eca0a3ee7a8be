/* Dense linear algebra on matrices in rows, small enough to stay in the cache of a processor. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* a . b; four sums side by side do not wait for each other */
static double tn_product(const double *a, const double *b, int n)
{
    double sums[4] = {0, 0, 0, 0};
    int j = 0;
    for (; j + 4 <= n; j += 4)
        for (int l = 0; l < 4; l++)
            sums[l] += a[j + l] * b[j + l];
    for (; j < n; j++)
        sums[0] += a[j] * b[j];
    return sums[0] + sums[1] + (sums[2] + sums[3]);
}

/* C = A B, with A (n, m) and B (m, k); zeros of A cost nothing */
static void tn_multiply(double *restrict C, const double *restrict A, const double *restrict B, int n, int m, int k)
{
    memset(C, 0, sizeof(double) * n * k);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < m; j++) {
            const double a = A[(size_t)i * m + j];
            const double *row = B + (size_t)j * k;
            double *to = C + (size_t)i * k;
            if (a != 0)
                for (int l = 0; l < k; l++)
                    to[l] += a * row[l];
        }
}

static void tn_swap_rows(double *A, int i, int j, int n)
{
    for (int l = 0; i != j && l < n; l++) {
        const double kept = A[(size_t)i * n + l];
        A[(size_t)i * n + l] = A[(size_t)j * n + l];
        A[(size_t)j * n + l] = kept;
    }
}

/* X of A X = B in place of B (n, k); A is used up. Rows are brought to one size first, so that units do not choose
   the pivots. Returns the row without a pivot, else -1. */
static int tn_solve(double *A, double *B, int n, int k)
{
    for (int i = 0; i < n; i++) {
        double size = 0;
        for (int j = 0; j < n; j++)
            size = fmax(size, fabs(A[(size_t)i * n + j]));
        if (!(size > 0) || !isfinite(size))
            return i;
        const double scale = ldexp(1, -ilogb(size));
        for (int j = 0; j < n; j++)
            A[(size_t)i * n + j] *= scale;
        for (int j = 0; j < k; j++)
            B[(size_t)i * k + j] *= scale;
    }
    for (int p = 0; p < n; p++) {
        int best = p;
        for (int i = p + 1; i < n; i++)
            if (fabs(A[(size_t)i * n + p]) > fabs(A[(size_t)best * n + p]))
                best = i;
        tn_swap_rows(A, p, best, n);
        tn_swap_rows(B, p, best, k);
        const double *pivot = A + (size_t)p * n;
        if (!(fabs(pivot[p]) > 1e-14))
            return p;
        for (int i = p + 1; i < n; i++) {
            double *row = A + (size_t)i * n;
            const double factor = row[p] / pivot[p];
            if (factor == 0)
                continue;
            for (int j = p; j < n; j++)
                row[j] -= factor * pivot[j];
            for (int j = 0; j < k; j++)
                B[(size_t)i * k + j] -= factor * B[(size_t)p * k + j];
        }
    }
    for (int i = n - 1; i >= 0; i--)
        for (int j = 0; j < k; j++) {
            double sum = B[(size_t)i * k + j];
            for (int l = i + 1; l < n; l++)
                sum -= A[(size_t)i * n + l] * B[(size_t)l * k + j];
            B[(size_t)i * k + j] = sum / A[(size_t)i * n + i];
        }
    return -1;
}
