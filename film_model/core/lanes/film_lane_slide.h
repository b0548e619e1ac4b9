/* Friction of many impacts by springs, in lanes: film_springs_impact without the motion. Internal to film_lanes.c, which compiles it for
 * numbers of double and of single precision, `real`, of which twice as many fit into a register. Each impact is in units of its own: of
 * its sliding velocity, its duration, and the mass. docs/method.md, section 15. */
/* The springs of a group of impacts, as in film_springs, with one over what they divide by. top: how deep the contact is, as reach, over the
 * depth of the widest contact; met: springs that touch; rise: of q in the last step; cut: if asked for. slides: the sign of a contact all of whose
 * springs slip, else 0; share: their limit over top - reach; time: since the leg began; h: of the last step; stale: 1 if u is that limit
 * and not put in. */
typedef struct {
    real per_width[SPRUNG], stiffness[SPRUNG], per_stiffness[SPRUNG], power[SPRUNG], friction[SPRUNG], v[SPRUNG], q[SPRUNG];
    real rise[SPRUNG], top[SPRUNG], cut[SPRUNG], slides[SPRUNG], share[SPRUNG], time[SPRUNG], h[SPRUNG];
    real met[SPRUNG], count[SPRUNG];
    real u[FILM_MOST_SPRINGS][SPRUNG], reach[FILM_MOST_SPRINGS][SPRUNG], sums[FILM_MOST_SPRINGS + 1][SPRUNG];
    int32_t spheres, stale; /* spheres: 1 if the power of all is 2 or 0 */
} spring_group;

/* Springs that do not touch. Those of the impact before in the lane are kept where they are alike. per_stiffness: the unit of that. */
static void put_springs(spring_group *restrict g, int l, const film_springs *s, double per_stiffness) {
    int32_t alike = g->power[l] == (real)s->power && g->count[l] == (real)s->count ? s->count : 0;
    double stiffness = s->stiffness * per_stiffness, per_depth = 1.0 / film_springs_reached(s->power, s->count);
    g->per_width[l] = (real)(1.0 / s->width), g->stiffness[l] = (real)stiffness, g->per_stiffness[l] = (real)(1.0 / stiffness);
    g->power[l] = (real)s->power, g->friction[l] = (real)s->friction, g->v[l] = s->v < 0.0 ? -1.0f : s->v > 0.0, g->count[l] = (real)s->count;
    g->q[l] = g->rise[l] = g->top[l] = g->slides[l] = g->share[l] = g->met[l] = g->time[l] = g->h[l] = 0.0f, g->stale = 0;
    g->spheres = (l == 0 || g->spheres) && (s->power == 2.0 || s->power == 0.0);
    for (int32_t j = alike; j < FILM_MOST_SPRINGS && j < s->count; j++)
        g->reach[j][l] = (real)(s->reach[j] * per_depth), g->sums[j + 1][l] = (real)(s->sums[j + 1] * per_depth);
    g->sums[0][l] = 0.0f;
}

/* What steps of a group are beside: the force and the radius after each; of a step, its time, the ratio of that to the time before, 0 for
 * none, and over the mean of both. */
typedef struct {
    real force[CHUNK][SPRUNG], radius[CHUNK][SPRUNG], h[SPRUNG], ratio[SPRUNG], even[SPRUNG];
} group_steps;

/* Members after each step, for a friction of 1, as far as they depend on force and radius alone; limit: of the friction force; way: more than
 * any spring's limit grows. */
typedef struct {
    real top[CHUNK][SPRUNG], touch[CHUNK][SPRUNG], share[CHUNK][SPRUNG], limit[CHUNK][SPRUNG], way[CHUNK][SPRUNG];
} group_plan;

/* Springs from `first` to `last` in a step, and their sum after it: those that do not touch end at 0, one that the contact has just
 * reached moves with it for its part of the step. whole: all of them touch all the time. */
INLINED void slip_springs(spring_group *restrict g, int32_t first, int32_t last, const real *restrict top, const real *restrict per_share,
                          const real *restrict per_grown, const real *restrict moved, int whole, int watched, real *restrict sum) {
    for (int32_t j = first; j < last; j++) EACH_SPRUNG(l) {
        real left = top[l] - g->reach[j][l], most = left * per_share[l], part = left * per_grown[l];
        most = whole || most > 0.0f ? most : 0.0f;
        part = part < 1.0f ? part : 1.0f;
        part = whole || (real)j < g->met[l] ? 1.0f : part;
        real u = g->u[j][l] + moved[l] * part;
        if (watched) g->cut[l] += left > 0.0f ? (u > most ? 1.0f : 0.0f) - (u < -most ? 1.0f : 0.0f) : 0.0f;
        u = u < -most ? -most : u;
        u = u > most ? most : u;
        g->u[j][l] = u;
        sum[l] += u;
    }
}

/* The depths and springs of a step. */
CALLED void plan_step(const spring_group *restrict g, const real *restrict radius, real *restrict top, real *restrict sums, real *restrict touch) {
    static const real shift = 1.5f / ROUNDING; /* adding and subtracting it rounds to a whole number */
    EACH_SPRUNG(l) {
        real widths = radius[l] * g->per_width[l], nearest = (widths + shift) - shift, n = nearest < g->count[l] ? nearest : g->count[l];
        touch[l] = n;
        real together = widths > 0.0f ? 1.0f : 0.0f;
        real per = 1.0f / g->count[l], part = widths * per;
        top[l] = g->power[l] == 0.0f ? together : part * part;
        sums[l] = g->power[l] == 0.0f ? 0.0f : n * (n * n * (real)(1.0 / 3) - (real)(1.0 / 12)) * (per * per);
    }
    for (int l = 0; !g->spheres && l < SPRUNG; l++) {
        if (g->power[l] == 2.0f || g->power[l] == 0.0f) continue;
        top[l] = (real)film_springs_reached(g->power[l], radius[l] * g->per_width[l] / g->count[l]);
        sums[l] = g->sums[(int32_t)touch[l]][l];
    }
}

/* Its limits, from those before. A limit is linear in reach, and springs that the contact has just reached are as one at the edge. */
CALLED void limit_step(const spring_group *restrict g, const real *restrict force, const real *restrict top, const real *restrict sums,
                       const real *restrict touch, const real *restrict top_before, const real *restrict share_before,
                       real *restrict share, real *restrict limit, real *restrict way) {
    EACH_SPRUNG(l) {
        real all = touch[l] * top[l] - sums[l], first = g->reach[0][l], before = top_before[l], own = share_before[l];
        real now = all > 0.0f ? force[l] * g->per_stiffness[l] / all : 0.0f;
        real edge = (top[l] - before) * now, inner = (top[l] - first) * now - (before - first) * own;
        limit[l] = all > 0.0f ? force[l] : 0.0f;
        way[l] = (inner > edge ? inner : edge) + STUCK * (top[l] * now + before * own);
        share[l] = now;
    }
}

/* A plan of every `each` of some steps. */
static void plan_steps(const spring_group *restrict g, const group_steps *restrict of, int each, int count, group_plan *restrict to) {
    real sums[CHUNK][SPRUNG];
    for (int i = 0; i < count; i++) plan_step(g, of->radius[(i + 1) * each - 1], to->top[i], sums[i], to->touch[i]);
    for (int i = 0; i < count; i++)
        limit_step(g, of->force[(i + 1) * each - 1], to->top[i], sums[i], to->touch[i], i > 0 ? to->top[i - 1] : g->top,
                   i > 0 ? to->share[i - 1] : g->share, to->share[i], to->limit[i], to->way[i]);
}

/* How far the far points move in a step, and the signs of contacts that slide on; whether all do. one: 1 if friction is one number. */
CALLED int begin_step(const spring_group *restrict g, const group_steps *restrict s, const real *restrict way, int one,
                      real *restrict moved, real *restrict sign) {
    int32_t slide = 1;
    EACH_SPRUNG(l) {
        moved[l] = (g->v[l] - s->h[l] * (0.5f * g->q[l] + g->rise[l] * s->ratio[l] * (real)(1.0 / 6))) * s->h[l];
        sign[l] = one && g->slides[l] * moved[l] > g->friction[l] * way[l] ? g->slides[l] : 0.0f;
    }
    EACH_SPRUNG(l) slide &= sign[l] != 0.0f;
    return slide;
}

/* The springs of contacts that all slide. */
CALLED void put_limits(spring_group *restrict g, int32_t last) {
    for (int32_t j = 0; j < last; j++) EACH_SPRUNG(l) {
        real most = (g->top[l] - g->reach[j][l]) * (g->share[l] * g->friction[l]);
        g->u[j][l] = (real)j < g->met[l] && most > 0.0f ? g->slides[l] * most : 0.0f;
    }
    g->stale = 0;
}

/* The springs that slip or stick. */
CALLED void move_springs(spring_group *restrict g, const real *restrict top, const real *restrict share, const real *restrict touch,
                         const real *restrict moved, int watched, real *restrict sum) {
    real per_grown[SPRUNG], per_share[SPRUNG];
    int32_t last = 0, least = FILM_MOST_SPRINGS;
    EACH_SPRUNG(l) {
        int32_t now = (int32_t)touch[l], before = (int32_t)g->met[l], fewer = now < before ? now : before, more = now + before - fewer;
        least = fewer < least ? fewer : least;
        last = more > last ? more : last;
    }
    EACH_SPRUNG(l) {
        real grown = top[l] - g->top[l];
        per_grown[l] = 1.0f / (grown > LEAST_RISE ? grown : LEAST_RISE);
        per_share[l] = share[l] * g->friction[l];
        g->cut[l] = 0.0f;
    }
    least = least > 1 && !watched ? least - 1 : 0; /* the last spring may touch by rounding alone */
    if (g->stale) put_limits(g, last);
    slip_springs(g, 0, least, top, per_share, per_grown, moved, 1, 0, sum);
    if (watched) slip_springs(g, 0, last, top, per_share, per_grown, moved, 0, 1, sum);
    else slip_springs(g, least, last, top, per_share, per_grown, moved, 0, 0, sum);
}

/* film_springs_step, by Adams's rules for steps of any time, to a friction force. */
INLINED void end_in(spring_group *restrict g, const group_steps *restrict s, int l, real q, int timed) {
    real before = g->q[l], change = q - before, bent = s->even[l] * (change - g->rise[l] * s->ratio[l]) * (real)(1.0 / 12);
    g->v[l] -= s->h[l] * (0.5f * (before + q) - bent);
    g->q[l] = q;
    g->rise[l] = timed ? change : g->rise[l];
}

/* A step that takes no time is for a contact that jumps wide or narrow. */
CALLED void end_step(spring_group *restrict g, const group_steps *restrict s, const real *restrict unit, const real *restrict sign,
                     const real *restrict sum, int timed) {
    EACH_SPRUNG(l) {
        real limit = g->friction[l] * unit[l], summed = g->stiffness[l] * sum[l];
        real whole = summed >= (1.0f - SUMMED) * limit ? 1.0f : summed <= (SUMMED - 1.0f) * limit ? -1.0f : 0.0f;
        end_in(g, s, l, sign[l] != 0.0f ? sign[l] * limit : summed, timed);
        g->slides[l] = sign[l] != 0.0f ? sign[l] : limit > 0.0f ? whole : 0.0f;
    }
}

/* The same where all slide on. */
CALLED void end_slide(spring_group *restrict g, const group_steps *restrict s, const real *restrict unit, const real *restrict sign, int timed) {
    EACH_SPRUNG(l) end_in(g, s, l, sign[l] * (g->friction[l] * unit[l]), timed);
}

static void slide_group(spring_group *restrict g, const group_steps *restrict s, const group_plan *restrict p, int i, int one, int timed, int watched) {
    real sum[SPRUNG] = {0.0f}, moved[SPRUNG], sign[SPRUNG];
    int slides = begin_step(g, s, p->way[i], one, moved, sign);
    if (slides) {
        end_slide(g, s, p->limit[i], sign, timed);
        for (int l = 0; watched && l < SPRUNG; l++) g->cut[l] = sign[l] * p->touch[i][l];
    } else {
        move_springs(g, p->top[i], p->share[i], p->touch[i], moved, watched, sum);
        end_step(g, s, p->limit[i], sign, sum, timed);
    }
    g->stale = slides;
    memcpy(g->top, p->top[i], sizeof g->top);
    memcpy(g->share, p->share[i], sizeof g->share);
    memcpy(g->met, p->touch[i], sizeof g->met);
}

/* film_springs_take, if the coefficient depends on the speed. */
static void take_friction(spring_group *restrict g, const real *restrict h, const double *const *table, const double *speed, int32_t rows) {
    for (int l = 0; rows > 1 && l < SPRUNG; l++)
        g->friction[l] = (real)film_friction_at(table[l], rows, fabs(g->v[l] - h[l] * g->q[l]) * speed[l]);
}

/* What one group has done so far, and what it is from: a leg of contact in steps, each between two of its knots. when: time of the largest |q|. near_forces, near_radii: at the four
 * knots around a step. */
typedef struct {
    spring_group runs[FILM_SPRINGS_RUNS];
    real force[SPRUNG], when[SPRUNG], limits[SPRUNG], used[SPRUNG], apart[FILM_SPRINGS_RUNS][SPRUNG];
    const double *table[SPRUNG], *forces[SPRUNG], *radii[SPRUNG];
    double speed[SPRUNG], unit[SPRUNG]; /* of velocity, and of force */
    film_bend bend[2][SPRUNG]; /* of the way in, and of that out, which has none */
    real bent[2][SPRUNG], early[2][SPRUNG], late[2][SPRUNG]; /* its members */
    real share[FILM_MOST_STEPS + 1]; /* of a leg, after each of its steps on the way in */
    real near_forces[4][SPRUNG], near_radii[4][SPRUNG];
    film_springs_impact_result found[SPRUNG];
} sliding_group;

/* Value 0 of a cubic whose values 1 to 4 have a stride. */
static double before_cubic(const double *value, int64_t by) { return 4.0 * (value[by] + value[3 * by]) - 6.0 * value[2 * by] - value[4 * by]; }

/* Force and radius at four knots in a row, but for the first `known`. */
INLINED void put_knots(sliding_group *restrict s, int l, int64_t known, const double *force, const double *radius) {
    for (int64_t k = known; k < 4; k++) s->near_forces[k][l] = (real)(force[k] * s->unit[l]), s->near_radii[k][l] = (real)radius[k];
}

/* The four knots from `first` on of a leg with a kink, by cubics on the side of the kink on which their steps are. */
static void bend_knots(sliding_group *restrict s, int l, int64_t first, int64_t knot) {
    const double *at = s->forces[l] + knot, *radii = s->radii[l] + knot;
    double jumped[5] = {0.0, before_cubic(radii, 1), radii[1], radii[2], radii[3]}, force[4], radius[4];
    int late = first + 1 >= knot; /* of the middle two knots the first is the kink, or beyond */
    for (int k = 0; k < 4; k++) force[k] = at[first - knot + k], radius[k] = radii[first - knot + k];
    if (late) {
        radius[knot - first] = jumped[1];
        if (first + 1 == knot) force[0] = before_cubic(at - 1, 1), radius[0] = before_cubic(jumped, 1);
    } else {
        double left[5] = {0.0, before_cubic(radii, -1), radii[-1], radii[-2], radii[-3]};
        radius[knot - first] = left[1];
        if (first + 2 == knot) force[3] = before_cubic(at + 1, -1), radius[3] = before_cubic(left, 1);
    }
    put_knots(s, l, 0, force, radius);
}

/* The four knots from `first` of a leg on, whose values begin at `begin`; the last four were from `before` on. */
CALLED void take_knots(sliding_group *restrict s, int out, int64_t begin, int64_t first, int64_t before) {
    int64_t known = first == before + 1 ? 3 : 0;
    if (first == before) return;
    memmove(s->near_forces, s->near_forces + 4 - known, (size_t)known * sizeof s->near_forces[0]);
    memmove(s->near_radii, s->near_radii + 4 - known, (size_t)known * sizeof s->near_radii[0]);
    for (int l = 0; l < SPRUNG; l++) {
        int64_t knot = s->bend[out][l].knot;
        if (first <= knot && knot <= first + 3) bend_knots(s, l, first, knot);
        else put_knots(s, l, knot == before ? 0 : known, s->forces[l] + begin + first, s->radii[l] + begin + first);
    }
}

/* The cubic through four knots at x from the first of them, at least 0. */
CALLED void between_knots(real (*restrict near)[SPRUNG], real x, real *restrict out) {
    real a = x - 1.0f, b = x - 2.0f, c = x - 3.0f;
    real w0 = -a * b * c * (real)(1.0 / 6), w1 = 0.5f * x * b * c, w2 = -0.5f * x * a * c, w3 = x * a * b * (real)(1.0 / 6);
    EACH_SPRUNG(l) {
        real value = w0 * near[0][l] + w1 * near[1][l] + w2 * near[2][l] + w3 * near[3][l];
        out[l] = value > 0.0f ? value : 0.0f;
    }
}

/* How many impacts have a phase after a step. */
static int watch_group(sliding_group *restrict s, const real *before, const real *radius, const real *time) {
    const spring_group *fine = &s->runs[0];
    int known = 0;
    for (int l = 0; l < SPRUNG; l++) {
        film_watch *watch = &s->found[l].watch;
        if (watch->events == 0) film_springs_watch(watch, (int32_t)fine->cut[l], (int32_t)fine->met[l], before[l], radius[l], time[l]);
        known += watch->events > 0;
    }
    return known;
}

/* How much of a leg is passed after step i. */
static real passed(const sliding_group *s, int out, int64_t i, int64_t steps) { return out ? 1.0f - s->share[steps - i] : s->share[i]; }

/* How far two runs are apart. */
CALLED void put_apart(sliding_group *restrict s, int k, const real *restrict fine, const real *restrict coarse) {
    EACH_SPRUNG(l) {
        real apart = (real)fabs(fine[l] - coarse[l]);
        s->apart[k][l] = apart > s->apart[k][l] ? apart : s->apart[k][l];
    }
}

/* The times of a step of a run that ends at a share of a leg, or takes none. */
CALLED void begin_time(const sliding_group *restrict s, spring_group *restrict g, group_steps *restrict to, int out, real share, int timed) {
    EACH_SPRUNG(l) {
        real bent = s->bent[out][l], up = share < bent ? share : bent, rest = share > bent ? share - bent : 0.0f;
        real now = s->early[out][l] * up + s->late[out][l] * rest, before = g->h[l], h = timed ? now - g->time[l] : 0.0f;
        real both = before + h, per = before > 0.0f ? 1.0f / (before * both) : 0.0f;
        to->h[l] = h;
        to->ratio[l] = h * both * per;
        to->even[l] = per * h > 0.0f ? 2.0f * h * before * per : 1.0f;
        g->time[l] = now;
        g->h[l] = timed ? h : before;
    }
}

/* What friction has done in a step. begin: time of the leg, NULL for 0. */
CALLED void measure_step(sliding_group *restrict s, const real *restrict begin, const real *restrict time, const real *restrict force) {
    const spring_group *fine = &s->runs[0];
    EACH_SPRUNG(l) {
        real size = (real)fabs(fine->q[l]), at = (begin ? begin[l] : 0.0f) + fine->time[l];
        s->when[l] = size > s->force[l] ? at : s->when[l];
        s->force[l] = size > s->force[l] ? size : s->force[l];
        s->limits[l] += fine->friction[l] * force[l] * time[l];
        s->used[l] += size * time[l];
    }
}

/* Force and radius after steps `first` + 1 on of a leg, or after step 0. */
static void take_steps(sliding_group *restrict s, group_steps *restrict to, int out, int64_t first, int count, double per, int64_t knots) {
    int64_t near = -2;
    for (int k = 0; k < count; k++) {
        double x = (double)(first + k) * per;
        int64_t own = first + k > 0 ? (int64_t)(x - 0.5 * per) : 0, at = own < 1 ? 0 : own - 1 < knots - 3 ? own - 1 : knots - 3;
        take_knots(s, out, out * (knots + 1), at, near);
        near = at;
        between_knots(s->near_forces, (real)(x - (double)near), to->force[k]);
        between_knots(s->near_radii, (real)(x - (double)near), to->radius[k]);
    }
}

/* A leg of contact, which begins at a time, NULL for 0; whether impacts are left without a phase. out: 1 on the way out, which begins
 * with a step of no time: where the contact turns its radius may jump. */
static int follow_leg(sliding_group *restrict s, int out, const real *begin, int32_t rows, int64_t steps, int64_t knots, int runs, int watched) {
    real before[SPRUNG], v[FILM_SPRINGS_RUNS][CHUNK][SPRUNG];
    double per = (double)knots / (double)steps;
    group_steps of;
    group_plan plan;
    EACH_SPRUNG(l) before[l] = (real)s->radii[l][out * (knots + 1)];
    for (int64_t first = !out; first <= steps;) {
        int64_t left = steps - first + 1;
        int count = first == 0 ? 1 : left < CHUNK ? (int)left : CHUNK;
        take_steps(s, &of, out, first, count, per, knots);
        for (int k = 0; k < runs; k++) {
            int each = first == 0 ? 1 : 1 << k;
            spring_group *g = &s->runs[k];
            plan_steps(g, &of, each, count / each, &plan);
            for (int j = 0; j < count / each; j++) {
                int64_t i = first == 0 ? 0 : first - 1 + (j + 1) * each;
                begin_time(s, g, &of, out, passed(s, out, i, steps), i > 0);
                take_friction(g, of.h, s->table, s->speed, rows);
                slide_group(g, &of, &plan, j, rows == 1, i > 0, watched && k == 0);
                memcpy(v[k][j], g->v, sizeof g->v);
                if (k > 0) put_apart(s, k, v[k - 1][first == 0 ? 0 : 2 * j + 1], v[k][j]);
                if (k > 0) continue;
                if (watched && i > 0) watched = watch_group(s, before, of.radius[j], of.h) < SPRUNG;
                measure_step(s, begin, of.h, of.force[j]);
                memcpy(before, of.radius[j], sizeof before);
            }
        }
        first += count;
    }
    return watched;
}

/* film_springs_many; an incomplete group is filled up with its first impact. */
static void slide_lanes(int64_t count, const int64_t *places, int32_t springs, int32_t estimated, const double *numbers, const double *friction,
                        int32_t rows, int shared, int64_t steps, int64_t knots, const double *force, const double *radius, film_springs_brief *results) {
    sliding_group s;
    film_springs runs[FILM_SPRINGS_RUNS];
    int64_t values = 2 * (knots + 1);
    int of = estimated ? FILM_SPRINGS_RUNS : 1;
    memset(&s, 0, sizeof s);
    memset(runs, 0, sizeof runs);
    for (int64_t i = 0; i <= steps && i <= FILM_MOST_STEPS; i++) s.share[i] = (real)film_leg_share((double)i / (double)steps);
    for (int64_t first = 0; first < count; first += SPRUNG) {
        real turn[SPRUNG];
        double duration[SPRUNG];
        int status[SPRUNG];
        memset(s.force, 0, offsetof(sliding_group, table) - offsetof(sliding_group, force));
        for (int k = 0; k < of; k++) memset(s.runs[k].u, 0, (size_t)(springs >> k) * sizeof s.runs[k].u[0]);
        for (int l = 0; l < SPRUNG; l++) {
            int64_t i = places[first + (first + l < count ? l : 0)];
            const double *n = numbers + 7 * i;
            duration[l] = n[5], s.speed[l] = n[3] != 0.0 ? fabs(n[3]) : 1.0;
            s.unit[l] = duration[l] / (n[2] * s.speed[l]);
            s.table[l] = friction + (shared ? 0 : 2 * rows * i);
            s.forces[l] = force + i * values, s.radii[l] = radius + i * values;
            s.found[l] = (film_springs_impact_result){.velocity = n[3], .watch = {.phase = -1}};
            status[l] = film_springs_begin(runs, of, springs, n[0], n[1], n[2], n[3], s.table[l][1], values - 1, s.radii[l]);
            for (int k = 0; k < of; k++) put_springs(&s.runs[k], l, &runs[k], duration[l] * duration[l] / n[2]);
            turn[l] = (real)(n[4] / n[5]);
            s.bend[0][l] = film_bend_of(n[6] / n[5], n[4] / n[5], knots), s.bend[1][l] = film_bend_of(0.0, 1.0 - n[4] / n[5], knots);
            for (int k = 0; k < 2; k++)
                s.bent[k][l] = (real)s.bend[k][l].share, s.early[k][l] = (real)s.bend[k][l].early, s.late[k][l] = (real)s.bend[k][l].late;
        }
        int watched = follow_leg(&s, 0, NULL, rows, steps, knots, of, 1);
        follow_leg(&s, 1, turn, rows, steps, knots, of, watched);
        for (int l = 0; l < SPRUNG && first + l < count; l++) {
            film_springs_impact_result *found = &s.found[l];
            if (status[l] == FILM_OK) {
                double rounded = SUMMED / 16 * (double)(estimated != 0);
                found->velocity = s.runs[0].v[l] * s.speed[l], found->force = s.force[l] / s.unit[l];
                status[l] = film_springs_end(found, s.speed[l] * (s.apart[1][l] + rounded), s.speed[l] * s.apart[2][l], s.limits[l], s.used[l]);
            }
            const film_springs_brief brief = {found->velocity, found->force, s.when[l] * duration[l], found->error, found->slack, found->regime, status[l]};
            results[first + l] = brief;
        }
    }
}
