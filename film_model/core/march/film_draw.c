/* Lays one line through the law. docs/method.md, sections 2 and 5. */
#include "march/film_march.h"

/* Over lines shorter than this fraction of x, the distance to the law's singular point, a difference of works is mostly
 * rounding; Simpson's rule, whose error is (h/x)^4/2880 of the force, is exact there. core_check.c, check_softened. */
static const double SHORT_LINE = 2e-4;

/* Mean force over the next h: work difference over way or, for a short line, Simpson's rule. docs/method.md, section 2. */
double film_mean_force(const film_curve *curve, const film_state *s, double h) {
    double origin = s->branch >= 0 ? piece_at(curve, s->branch, s->xi)->force.origin : s->line.xi_origin;
    if (s->branch <= FILM_STRETCHED) origin = film_stretched_origin(curve, s);
    double near = s->xi - curve->compliance * s->elastic - origin, far = s->xi + h - curve->compliance * s->force_end - origin;
    double x = fabs(near) < fabs(far) ? near : far;
    double way = (s->xi + h) - s->xi; /* h as it is represented in xi: the work difference is over the same way */
    if (way != 0.0 && fabs(way) >= SHORT_LINE * fabs(x)) return (s->work_end - s->work) / way;
    double middle, work;
    law_at(curve, &s->line, s->xi + 0.5 * h, &middle, &work);
    return (s->elastic + 4.0 * middle + s->force_end) / 6.0;
}

/* The line over the next `length` that meets the law's force at its far end and does the law's work, or the chord. A
 * motion that turns there needs the true force: y = nu - gamma f is 0. docs/method.md, section 5. */
void film_make_turn_line(const film_curve *curve, const film_mesh *mesh, film_state *s, double length, int plain) {
    double h = s->direction * length;
    law_at(curve, &s->line, s->xi + h, &s->force_end, &s->work_end);
    double near = mesh->linearisation == FILM_CHORD ? s->elastic : 2.0 * film_mean_force(curve, s, h) - s->force_end;
    s->line.kappa = (s->force_end - near) * per_length(s, h);
    s->line.phi = near;
    s->line.damping = 0.0;
    if (is_damped(curve, s)) {
        double y0 = film_speed(curve, s, s->xi, s->elastic, s->nu);
        film_add_damping(curve, mesh, s, h, y0 > 0.0 ? y0 : 1.0, 0.0, plain || !(y0 > 0.0));
    }
}

/* The line over the next `length`, and the motion on it. Slope (f1 - f0)/h, and level so that the line does the law's work;
 * a chord begins at f0 instead. From rest it begins at f0, so that y = 0 there; where the motion comes to rest it ends at
 * f1, so that it balances where the law does. plain: as in film_add_damping. docs/method.md, section 2. */
motion film_make_line(const film_curve *curve, const film_mesh *mesh, film_state *s, double length, int plain) {
    double h = s->direction * length, per_h = per_length(s, h);
    law_at(curve, &s->line, s->xi + h, &s->force_end, &s->work_end);
    if (s->line_ends == ENDS_NEVER && leaves_freely(curve, s)) s->force_end = 0.0; /* but for rounding */
    double mean = film_mean_force(curve, s, h);
    int at_rest = s->from_turn && s->leg_node == 0;
    s->line.kappa = (s->force_end - s->elastic) * per_h;
    s->line.phi = mean - 0.5 * s->line.kappa * h;
    if (mesh->linearisation == FILM_CHORD) {
        s->line.phi = s->elastic;
    } else if (at_rest) {
        s->line.phi = s->elastic;
        s->line.kappa = 2.0 * (mean - s->elastic) * per_h;
    } else if (s->line_ends == ENDS_NEVER) {
        s->line.kappa = 2.0 * (s->force_end - mean) * per_h;
        s->line.phi = 2.0 * mean - s->force_end;
    }
    s->line.damping = 0.0;
    if (is_damped(curve, s)) film_damp_line(curve, mesh, s, length, at_rest, plain);
    motion m = motion_on(s, s->line.phi, s->line.kappa);
    if (at_rest && fabs(m.y0) <= REST_SPEED * (fabs(s->nu) + s->gamma * s->elastic)) m.y0 = 0.0;
    return m;
}

/* The line ends after `length` with the speed y of its own motion. */
void film_set_line_end(film_state *s, double length, double y) {
    double h = s->direction * length;
    s->xi_end = s->xi + h;
    double yield = s->gamma * s->line.damping;
    s->nu_end = s->direction * y * (1.0 + yield) + s->gamma * (s->line.phi + s->line.kappa * h);
}

/* A line of no length: the motion ends at the current point, at once. */
void film_end_here(film_state *s, int ends) {
    s->line.phi = s->elastic;
    s->line.kappa = s->line.damping = s->tau_end = 0.0;
    s->line_ends = ends;
    s->xi_end = s->xi;
    s->nu_end = s->nu;
    s->force_end = s->elastic;
    s->work_end = s->work;
}
