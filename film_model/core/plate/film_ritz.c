/* Functions on a line for Ritz's method, as film_ritz.h says.
 *
 * The polynomials that satisfy the supports: combinations of P_0 ... P_3, and the double integrals of P_k, k >= 2, which vanish
 * with their slopes at both ends. In sqrt((2 k + 1)/2) times these, the integral of f''^2 is a sum of squares. The shapes diagonalise
 * the integral of f^2: one-sided Jacobi rotations of its factor keep the digits of the smallest, which `eigh` would lose. */
#include "plate/film_ritz.h"

#include "plate/film_rows.h"

#define PI 3.14159265358979323846
#define JOINED 4         /* polynomials that join the shapes */
#define RIGID 1e-9       /* integral of f''^2 below which it is the rounding of a motion as a rigid body */
#define SMALLEST 1e-12   /* root of the integral of f^2 over that with f''^2: 1.4e-11 at degree 1000 */
#define NEGLECTED 1e-9   /* rows shorter than this need not be orthogonal to each other: they are no shapes */
#define ORTHOGONAL 1e-15 /* cosine of two rows */
#define SWEEPS 40        /* at most; 130 rows take 10 */
#define SAME_BENT 1e-9

/* The polynomials of one parity, or all: columns are the degrees first, first + step, ... */
typedef struct {
    int32_t first, step, columns, rows, low; /* low: rows of P_0 ... P_3 */
    double curved[4][2];                     /* their second derivatives in the first two columns */
    double *moved, *factor, *size;           /* rows x columns, rows x rows, rows */
    double *bends;                           /* rows x columns: second derivatives of the shapes */
} half;

static const double *of(const double *rows, int32_t width, int32_t k) { return rows + (ptrdiff_t)k * width; }

static double unit(int32_t degree) { return sqrt(2.0 / (2.0 * degree + 1.0)); } /* norm of P_degree */

/* Combinations of P_0 ... P_3 that satisfy the supports, rigid motions first. */
static int32_t lowest(const int32_t *ends, double rows[4][4]) {
    int clamped = (ends[0] == FILM_EDGE_CLAMPED) + (ends[1] == FILM_EDGE_CLAMPED), free = (ends[0] == FILM_EDGE_FREE) + (ends[1] == FILM_EDGE_FREE);
    double s = clamped == 1 ? (ends[0] == FILM_EDGE_CLAMPED ? -1.0 : 1.0) : ends[0] == FILM_EDGE_FREE ? 1.0 : -1.0;
    const double whole[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    const double one_pin[3][4] = {{1, -s, 0, 0}, {-1, 0, 1, 0}, {0, -1, 0, 1}};
    const double cantilever[2][4] = {{2, -3 * s, 1, 0}, {5 * s, -6, 0, 1}}, propped[1][4] = {{-5 * s, 3, 5 * s, -3}};
    const double(*from)[4] = free == 2 ? whole : free == 1 ? (clamped ? cantilever : one_pin) : clamped ? propped : one_pin + 1;
    int32_t count = free == 2 ? 4 : clamped == 2 ? 0 : clamped ? 1 + free : 2 + free;
    for (int32_t k = 0; k < count; k++)
        for (int c = 0; c < 4; c++) rows[k][c] = from[k][c];
    return count;
}

/* The polynomials of a half as rows of coefficients of normed Legendre polynomials. */
static void fill(half *part, const int32_t *ends, int32_t degree) {
    double rows[4][4];
    int32_t count = lowest(ends, rows);
    part->columns = (degree - part->first) / part->step + 1;
    part->rows = part->low = 0;
    for (int32_t k = 0; k < count; k++) {
        const double *row = rows[k];
        if (part->step == 2 && row[part->first] == 0.0 && row[part->first + 2] == 0.0) continue;
        double *moved = at(part->moved, part->columns, part->rows);
        for (int32_t c = 0; c < part->columns; c++) {
            int32_t n = part->first + part->step * c;
            moved[c] = n < 4 ? row[n] * unit(n) : 0.0;
        }
        double bends[2] = {3.0 * row[2] * unit(0), 15.0 * row[3] * unit(1)}; /* P_2'' = 3, P_3'' = 15 s */
        for (int32_t c = 0; c < 2; c++) part->curved[part->rows][c] = part->step == 1 ? bends[c] : c ? 0.0 : bends[part->first];
        part->rows++;
    }
    part->low = part->rows;
    for (int32_t k = part->first == 0 || part->step == 1 ? 2 : 3; k <= degree - 2; k += part->step) {
        double *moved = at(part->moved, part->columns, part->rows++), n = 2.0 * k, scale = sqrt((n + 1.0) / 2.0);
        const double parts[3] = {1.0 / ((n - 1.0) * (n + 1.0)), -2.0 / ((n - 1.0) * (n + 3.0)), 1.0 / ((n + 1.0) * (n + 3.0))};
        for (int32_t c = 0; c < part->columns; c++) moved[c] = 0.0;
        for (int32_t d = 0; d < 3; d++) moved[(k - 2 + 2 * d - part->first) / part->step] = scale * parts[d] * unit(k - 2 + 2 * d);
    }
}

/* The column of the second derivative of a row that is an integral. */
static int32_t column(const half *part, int32_t row) { return row - part->low + (part->step == 1 ? 2 : 1); }

/* Integral of the product of the second derivatives of two rows. */
static double curves(const half *part, int32_t i, int32_t j) {
    if (i >= part->low || j >= part->low) return i == j ? 1.0 : 0.0;
    return part->curved[i][0] * part->curved[j][0] + part->curved[i][1] * part->curved[j][1];
}

/* Rows of the inverse of Cholesky's factor of the sum of both integrals, in `factor`; `moved` becomes its product with them. */
static void normalise(half *part, double *memory) {
    int32_t m = part->rows, n = part->columns;
    double *lower = part->factor, *one = memory;
    for (int32_t i = 0; i < m; i++)
        for (int32_t j = 0; j <= i; j++) {
            double sum = curves(part, i, j) + dot(n, at(part->moved, n, i), at(part->moved, n, j));
            sum -= dot(j, at(lower, m, i), at(lower, m, j));
            at(lower, m, i)[j] = i == j ? sqrt(sum) : sum / at(lower, m, j)[j];
        }
    for (int32_t i = 0; i < m; i++) {
        double *row = at(lower, m, i), *moved = at(part->moved, n, i), scale = 1.0 / row[i];
        for (int32_t j = 0; j < m; j++) one[j] = j == i ? 1.0 : 0.0;
        for (int32_t k = 0; k < i; k++) {
            add(k + 1, one, -row[k], at(lower, m, k));
            add(n, moved, -row[k], at(part->moved, n, k));
        }
        for (int32_t j = 0; j < m; j++) row[j] = scale * one[j];
        for (int32_t c = 0; c < n; c++) moved[c] *= scale;
    }
}

/* Cosine and sine of the rotation that makes two rows orthogonal, from their squares and product. */
static void rotation(double alpha, double beta, double both, double *c, double *s) {
    double slope = (beta - alpha) / (2.0 * both), t = (slope < 0.0 ? -1.0 : 1.0) / (fabs(slope) + sqrt(1.0 + slope * slope));
    *c = 1.0 / sqrt(1.0 + t * t);
    *s = *c * t;
}

static void turn(int32_t n, double *a, double *b, double c, double s) {
    for (int32_t k = 0; k < n; k++) {
        double x = a[k], y = b[k];
        a[k] = c * x - s * y;
        b[k] = s * x + c * y;
    }
}

/* The longest of the rows from i on takes the place of row i: half as many sweeps are needed. */
static void lengthen(half *part, int32_t i) {
    int32_t best = i;
    for (int32_t j = i + 1; j < part->rows; j++)
        if (part->size[j] > part->size[best]) best = j;
    if (best == i) return;
    turn(part->columns, at(part->moved, part->columns, i), at(part->moved, part->columns, best), 0.0, 1.0);
    turn(part->rows, at(part->factor, part->rows, i), at(part->factor, part->rows, best), 0.0, 1.0);
    turn(1, &part->size[i], &part->size[best], 0.0, -1.0);
    part->size[best] = fabs(part->size[best]);
}

/* Rotations make the rows of `moved` orthogonal; those of `factor` follow. */
static void rotate(half *part) {
    int32_t m = part->rows, n = part->columns;
    for (int32_t i = 0; i < m; i++) part->size[i] = dot(n, at(part->moved, n, i), at(part->moved, n, i));
    for (int32_t sweep = 0, turned = 1; sweep < SWEEPS && turned; sweep++) {
        turned = 0;
        for (int32_t i = 0; i + 1 < m; i++) {
            lengthen(part, i);
            for (int32_t j = i + 1; j < m; j++) {
                double *a = at(part->moved, n, i), *b = at(part->moved, n, j), alpha = part->size[i], beta = part->size[j];
                if (fmax(alpha, beta) < NEGLECTED * NEGLECTED) continue;
                double both = dot(n, a, b);
                if (fabs(both) <= ORTHOGONAL * sqrt(alpha * beta)) continue;
                double c, s;
                rotation(alpha, beta, both, &c, &s);
                turn(n, a, b, c, s);
                turn(m, at(part->factor, m, i), at(part->factor, m, j), c, s);
                part->size[i] = dot(n, a, a);
                part->size[j] = dot(n, b, b);
                turned = 1;
            }
        }
    }
}

/* The shapes of a half: rows of `moved` and `bends`, and the integral of f''^2 in `size`. */
static void shapes_of(half *part, double *memory) {
    int32_t m = part->rows, n = part->columns, kept = 0;
    normalise(part, memory);
    rotate(part);
    for (int32_t i = 0; i < m; i++) {
        double size = sqrt(part->size[i]);
        if (!(size > SMALLEST)) continue;
        double *moved = at(part->moved, n, kept), *bends = at(part->bends, n, kept);
        const double *from = of(part->moved, n, i), *factor = of(part->factor, m, i);
        for (int32_t c = 0; c < n; c++) moved[c] = from[c] / size;
        for (int32_t c = 0; c < n; c++) bends[c] = 0.0;
        for (int32_t j = 0; j < m; j++) {
            if (j >= part->low) bends[column(part, j)] += factor[j] / size;
            else for (int32_t c = 0; c < 2; c++) bends[c] += part->curved[j][c] * factor[j] / size;
        }
        part->size[kept++] = dot(n, bends, bends);
    }
    part->rows = kept;
}

/* The bend of the shape with this number among those of all halves. */
static double highest_of(const half *parts, int32_t halves, int32_t count) {
    for (int32_t h = 0; h < halves; h++)
        for (int32_t i = 0; i < parts[h].rows; i++) {
            int32_t below = 0, equal = 0;
            for (int32_t g = 0; g < halves; g++)
                for (int32_t j = 0; j < parts[g].rows; j++) {
                    below += parts[g].size[j] < parts[h].size[i];
                    equal += parts[g].size[j] == parts[h].size[i];
                }
            if (below < count && count <= below + equal) return parts[h].size[i];
        }
    return -1.0;
}

/* Jacobi rotations of a small symmetric matrix; `v`: rows that are turned likewise. */
static void diagonalise(int32_t n, double a[JOINED][JOINED], int32_t width, double *v) {
    for (int32_t round = 0; round < SWEEPS; round++)
        for (int32_t i = 0; i + 1 < n; i++)
            for (int32_t j = i + 1; j < n; j++) {
                if (a[i][j] == 0.0) continue;
                double c, s;
                rotation(a[i][i], a[j][j], a[i][j], &c, &s);
                turn(n, a[i], a[j], c, s);
                for (int32_t k = 0; k < n; k++) turn(1, &a[k][i], &a[k][j], c, s);
                a[i][j] = a[j][i] = 0.0;
                turn(width, at(v, width, i), at(v, width, j), c, s);
            }
}

/* What the shapes up to `highest` lack of the lowest polynomials that bend: as many rows of parts of the other shapes. */
static void join(const half *part, double highest, int32_t more, double *chosen) {
    int32_t m = part->rows, found = 0;
    double bent[JOINED][JOINED];
    for (int32_t i = 0; found < more; i++) {
        if (i < part->low && part->curved[i][0] == 0.0 && part->curved[i][1] == 0.0) continue;
        double *row = at(chosen, m, found);
        for (int32_t r = 0; r < m; r++) {
            const double *bends = of(part->bends, part->columns, r);
            double both = i >= part->low ? bends[column(part, i)] : part->curved[i][0] * bends[0] + part->curved[i][1] * bends[1];
            row[r] = part->size[r] <= highest ? 0.0 : both / part->size[r];
        }
        for (int32_t round = 0; round < 2; round++) {
            double size = sqrt(dot(m, row, row));
            for (int32_t r = 0; r < m; r++) row[r] /= size;
            for (int32_t k = 0; k < found; k++) add(m, row, -dot(m, row, at(chosen, m, k)), at(chosen, m, k));
        }
        double size = sqrt(dot(m, row, row));
        for (int32_t r = 0; r < m; r++) row[r] /= size;
        found++;
    }
    for (int32_t i = 0; i < more; i++)
        for (int32_t j = 0; j < more; j++) {
            bent[i][j] = 0.0;
            for (int32_t r = 0; r < m; r++) bent[i][j] += part->size[r] * at(chosen, m, i)[r] * at(chosen, m, j)[r];
        }
    diagonalise(more, bent, m, chosen);
}

/* One more function, a sum of the shapes of a half: its coefficients in normed polynomials, and those of its second derivative. */
static void append(const half *part, const double *weights, int32_t width, double *moved, double *bends) {
    for (int32_t c = 0; c < width; c++) moved[c] = bends[c] = 0.0;
    for (int32_t r = 0; r < part->rows; r++)
        for (int32_t c = 0; weights[r] != 0.0 && c < part->columns; c++) {
            moved[part->first + part->step * c] += weights[r] * at(part->moved, part->columns, r)[c];
            bends[part->first + part->step * c] += weights[r] * at(part->bends, part->columns, r)[c];
        }
}

/* Coefficients of the derivative: P_n' = sum of (2 k + 1) P_k over k = n - 1, n - 3, ... */
static void slope_of(int32_t width, const double *moved, double *slopes) {
    double above[2] = {0.0, 0.0};
    for (int32_t k = width - 1; k >= 0; k--) {
        slopes[k] = (2.0 * k + 1.0) * above[(k + 1) % 2] * unit(k);
        above[k % 2] += moved[k] / unit(k);
    }
}

int64_t film_ritz_kept(int32_t degree) { return 3 * ((int64_t)degree + 1) * (degree + 1) + 2 * ((int64_t)degree + 1); }

int64_t film_ritz_size(int32_t degree) {
    int64_t width = (int64_t)degree + 1;
    return film_ritz_kept(degree) + 6 * width * width + (2 * JOINED + 4) * width;
}

/* The shapes of both halves, or of all polynomials; how many there are. next: where their rows are put. */
static int32_t all_shapes(half *parts, int32_t halves, const int32_t *ends, int32_t degree, double *memory, double *next) {
    int32_t total = 0;
    for (int32_t h = 0; h < halves; h++) {
        half *part = &parts[h];
        *part = (half){h, halves, (degree - h) / halves + 1, 0, 0, {{0}}, NULL, NULL, NULL, NULL};
        int32_t most = part->columns;
        part->moved = next;
        part->factor = at(part->moved, most, most);
        part->bends = at(part->factor, most, most);
        part->size = at(part->bends, most, most);
        next = part->size + most;
        fill(part, ends, degree);
        shapes_of(part, memory);
        total += part->rows;
    }
    return total;
}

/* Functions in sums of the shapes of the halves: those up to `highest`, and `more` of each half that join them; how many. */
static int32_t chosen_of(const half *parts, int32_t halves, double highest, int32_t more, int32_t width, double *rows, double *weights) {
    double *moved = rows, *bends = at(rows, width, width), *weight = at(weights, width, JOINED);
    int32_t functions = 0;
    for (int32_t h = 0; h < halves; h++) {
        const half *part = &parts[h];
        for (int32_t i = 0; i < part->rows; i++) {
            if (!(part->size[i] <= highest)) continue;
            for (int32_t r = 0; r < part->rows; r++) weight[r] = r == i ? 1.0 : 0.0;
            append(part, weight, width, at(moved, width, functions), at(bends, width, functions));
            functions++;
        }
        if (more) join(part, highest, more, weights);
        for (int32_t k = 0; k < more; k++, functions++)
            append(part, at(weights, part->rows, k), width, at(moved, width, functions), at(bends, width, functions));
    }
    return functions;
}

/* Whether a function has odd polynomials alone. */
static int is_odd(int32_t width, const double *moved) {
    for (int32_t c = 0; c < width; c += 2)
        if (moved[c] != 0.0) return 0;
    return 1;
}

int32_t film_ritz_make(film_ritz *line, const int32_t *ends, int32_t degree, int32_t count, double *memory) {
    if (degree < 6 || count < 0) return FILM_BAD_NUMBER;
    int32_t width = degree + 1, halves = ends[0] == ends[1] ? 2 : 1;
    half parts[2];
    double *moved = memory + film_ritz_kept(degree), *bends = at(moved, width, width), *weights = at(bends, width, width);
    if (count > all_shapes(parts, halves, ends, degree, weights, at(weights, width, JOINED + 1))) return FILM_BAD_NUMBER;
    double highest = count ? highest_of(parts, halves, count) * (1.0 + SAME_BENT) : INFINITY;
    int32_t more = !count || (ends[0] == FILM_EDGE_SIMPLE && halves == 2) ? 0 : JOINED / halves;
    int32_t f = chosen_of(parts, halves, highest, more, width, moved, weights);
    double *series = memory, *bent = at(series, width, f), *sloped = bent + f, *crossed = at(sloped, f, f);
    uint8_t *odd = (uint8_t *)at(crossed, f, f);
    int32_t *order = (int32_t *)weights; /* sorted by what they bend */
    for (int32_t i = 0; i < f; i++) {
        double own = dot(width, at(bends, width, i), at(bends, width, i));
        int32_t k = i;
        for (; k > 0 && bent[k - 1] > own; k--) bent[k] = bent[k - 1], order[k] = order[k - 1];
        bent[k] = own;
        order[k] = i;
    }
    double *slopes = parts[0].moved; /* the halves, which take more, are no longer needed */
    for (int32_t i = 0; i < f; i++) slope_of(width, at(moved, width, order[i]), at(slopes, width, i));
    for (int32_t i = 0; i < f; i++) {
        odd[i] = halves == 2 && is_odd(width, at(moved, width, order[i]));
        for (int32_t j = 0; j < f; j++) {
            at(sloped, f, i)[j] = dot(width, at(slopes, width, i), at(slopes, width, j));
            at(crossed, f, i)[j] = dot(width, at(bends, width, order[i]), at(moved, width, order[j]));
        }
        for (int32_t c = 0; c < width; c++) at(series, width, i)[c] = at(moved, width, order[i])[c] / unit(c);
        if (bent[i] < RIGID) bent[i] = 0.0;
    }
    *line = (film_ritz){f, f - more * halves, degree, halves, series, bent, sloped, crossed, odd};
    return FILM_OK;
}

double film_ritz_at(const film_ritz *line, int32_t p, double s) {
    if (!line->series) return sin((p + 1) * (PI / 2.0) * (s + 1.0));
    const double *series = of(line->series, line->degree + 1, p);
    double sum = 0.0, before = 0.0, own = 1.0;
    for (int32_t n = 0; n <= line->degree; n++) {
        sum += series[n] * own;
        double next = ((2.0 * n + 1.0) * s * own - n * before) / (n + 1.0);
        before = own;
        own = next;
    }
    return sum;
}
