/* Damping: the damped force, what damping adds to a line, and when a damped contact ends and begins. docs/method.md, section
 * 7. */
#include "march/film_march.h"

/* ---------------------------------------------------------------- the true force */

/* F = f + c y, y (1 + gamma c) = nu - gamma f, and its derivatives. docs/method.md, sections 7 and 11. */
film_contact film_force(const film_curve *curve, const film_state *s, double xi, double nu) {
    film_contact at = {0.0, 0.0, 0.0};
    if (s->branch == FILM_FREE) return at;
    double work, c = damping_at(curve, &s->line, xi);
    law_at(curve, &s->line, xi, &at.force, &work);
    at.by_xi = law_slope(curve, &s->line, xi);
    if (s->line.damper > 0.0 && s->line.branch >= 0) {
        double yield = 1.0 + s->gamma * c, c_slope = s->line.damper * slope_at(&piece_at(curve, s->line.branch, xi)->damping, xi);
        at.by_xi = (at.by_xi + c_slope * (nu - s->gamma * at.force) / yield) / yield;
        at.force = total_force(&s->line, c, at.force, nu);
        at.by_nu = c / yield;
    }
    return at;
}

/* dF/dt at xi and nu. */
double film_force_rate(const film_curve *curve, const film_state *s, double xi, double nu) {
    film_contact at = film_force(curve, s, xi, nu);
    return at.by_xi * (nu - s->gamma * at.force) + at.by_nu * (s->load - at.force);
}

/* ---------------------------------------------------------------- the damping of a line */

/* The mean of the law's c over the next h, weighted with y^2 of a speed that changes linearly in time from y0 to y1: as a
 * constant it dissipates as much as c. Where c may begin as a root, the rule's steps are taken to the fourth power.
 * docs/method.md, section 7. */
static double mean_damping(const film_curve *curve, const film_state *s, double h, double y0, double y1) {
    double sum = 0.0, weights = 0.0, per_way = 2.0 / (y0 + y1);
    int root = h > 0.0 && s->xi <= INSIDE_DENT * h;
    for (int k = 0; k < GAUSS; k++) {
        double w = GAUSS_AT[k], u = root ? w * w * w * w : w, y = y0 + (y1 - y0) * u;
        double weight = GAUSS_WEIGHT[k] * y * y * (root ? 4.0 * w * w * w : 1.0);
        sum += weight * damping_at(curve, &s->line, s->xi + h * per_way * u * (y0 + 0.5 * (y1 - y0) * u));
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : damping_at(curve, &s->line, s->xi + 0.5 * h); /* y^2 underflows */
}

/* xi' along the direction of motion, of the true law. */
double film_speed(const film_curve *curve, const film_state *s, double xi, double force, double nu) {
    return s->direction * (nu - s->gamma * force) / (1.0 + s->gamma * damping_at(curve, &s->line, xi));
}

/* Adds damping to the line over the next h, passed with speeds y0 to y1: the mean of c as a constant, and the difference
 * between c y and that at both ends as a tilt of the line's own force, so that the force is the law's there while the work
 * stays that of c y. At a turn c y is 0 and the line keeps its force. plain: the constant alone.
 * docs/method.md, section 7. */
void film_add_damping(const film_curve *curve, const film_mesh *mesh, film_state *s, double h, double y0, double y1, int plain) {
    double mean = mean_damping(curve, s, h, y0, y1), c0 = damping_at(curve, &s->line, s->xi), c1 = damping_at(curve, &s->line, s->xi + h);
    double d = s->direction, at = mean, tilt;
    s->line.damping = mean;
    /* too long to trust the end speeds: the tilt could add energy, so damping stays constant */
    if (plain || mesh->linearisation == FILM_CHORD || mean * fabs(h) > 0.5 * fmax(y0, y1) || per_length(s, h) == 0.0) return;
    double speed = 2.0 / 3.0 * (y0 * y0 + y0 * y1 + y1 * y1) / (y0 + y1); /* mean over the way, for a speed linear in time */
    if (y0 == 0.0 || y1 == 0.0) {
        at = y0 == 0.0 ? c0 : c1;
        tilt = (y0 == 0.0 ? 2.0 : -2.0) * d * (mean - at) * speed / h;
        s->line.phi -= y0 == 0.0 ? 0.0 : tilt * h;
    } else {
        tilt = d * ((c1 - mean) * y1 - (c0 - mean) * y0) / h;
        s->line.phi -= 0.5 * tilt * h;
    }
    s->line.damping = at;
    s->line.kappa += tilt;
}

/* Adds damping to the line over the next `length`, as film_add_damping. The speed at its end, which weights the mean, is that
 * of the line with an evenly weighted mean. docs/method.md, section 7. */
void film_damp_line(const film_curve *curve, const film_mesh *mesh, film_state *s, double length, int at_rest,
                    int plain) {
    double h = s->direction * length, tau, y = 0.0;
    s->line.damping = mean_damping(curve, s, h, 1.0, 1.0);
    motion rough = motion_on(s, s->line.phi, s->line.kappa);
    if (at_rest) rough.y0 = 0.0;
    if (move_to(&rough, length, &tau, &y) == REACHED && y > 0.0) {
        double nu = s->direction * y * (1.0 + s->gamma * s->line.damping) + s->gamma * (s->line.phi + s->line.kappa * h);
        y = fmax(film_speed(curve, s, s->xi + h, s->force_end, nu), 0.0);
    } else {
        y = 0.0;
    }
    double y0 = at_rest ? 0.0 : fmax(film_speed(curve, s, s->xi, s->elastic, s->nu), 0.0);
    if (y0 + y > 0.0) film_add_damping(curve, mesh, s, h, y0, y, plain);
}

/* The energy that damping took over the first tau of a line, at whose end the impactor is at xi with nu and the law's work
 * is `work`: what is missing from the impactor's energy and is neither stored nor radiated, the integral of gamma F^2 dt.
 * docs/method.md, section 7. */
double film_dissipated(const film_line *line, double tau, double xi, double nu, double work) {
    double gamma = line->gamma, moved = gamma * (line->load * tau - (nu - line->nu)), radiated = 0.0, x, y;
    double gone = 0.5 * (line->nu - nu) * (line->nu + nu) + line->load * (xi - line->xi + moved) - (work - line->work);
    if (gamma == 0.0) return gone;
    motion m = motion_from(1.0, line->nu, gamma, line->load, line->phi, line->kappa, line->damping);
    for (int k = 0; k < GAUSS; k++) {
        motion_at(&m, GAUSS_AT[k] * tau, &x, &y);
        double force = line->phi + line->kappa * x + line->damping * y;
        radiated += GAUSS_WEIGHT[k] * force * force;
    }
    return gone - gamma * radiated * tau;
}

/* ---------------------------------------------------------------- release and touch */

/* The current line, for damping_at and law_at; in flight after a damped contact, one on the stage whose dent may still be
 * open. */
static film_line active_line(const film_curve *curve, const film_state *s) {
    film_line line = s->line;
    if (s->branch == FILM_FREE && s->damper > 0.0 && curve->stage[0].damped) {
        line.branch = 0;
        line.damper = s->damper;
    }
    return line;
}

/* nu + f/c: by how much nu exceeds the outward velocity at which F is 0. It has the sign of F, and is smooth where f and c
 * both go to 0. INFINITY without damping: undamped contacts end only at xi_free. docs/method.md, section 7. */
double film_release_margin(const film_curve *curve, const film_state *s) {
    film_line line = active_line(curve, s);
    double f, work, c = damping_at(curve, &line, s->xi);
    if (!(c > 0.0)) return INFINITY;
    law_at(curve, &line, s->xi, &f, &work);
    return fmin(s->nu + f / c, 1e300);
}

/* When F rises from 0 again, of a contact that was released inside its dent and that the load turns back there, by halving.
 * docs/method.md, section 7. */
double film_touch_time(const film_curve *curve, const film_state *s) {
    film_line inside = s->line;
    double low = 0.0, high = -s->nu / s->load, f, work;
    inside.branch = 0;
    inside.damper = s->damper;
    for (int k = 0; k < HALVINGS; k++) {
        double t = 0.5 * (low + high), xi = s->xi + t * (s->nu + 0.5 * s->load * t);
        law_at(curve, &inside, xi, &f, &work);
        if (total_force(&inside, damping_at(curve, &inside, xi), f, s->nu + s->load * t) > 0.0) high = t; else low = t;
    }
    return high;
}
