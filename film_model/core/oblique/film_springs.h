/* Friction in any contact, by springs beside each other that slip: for laws that yield or are damped, in steps.
 *
 * Springs at radii r share the tangential stiffness 8 G_star a and the normal force like those of Popov's reduction, the spring at r as
 * the depth since the contact has reached it: a^power - r^power, where the depth grows as a^power; 2 for a sphere. Errors fall as the
 * square of one over the number of springs and of steps. Units: any consistent ones.
 * Nothing is allocated; copying a film_springs saves it. */
#ifndef FILM_SPRINGS_H
#define FILM_SPRINGS_H

#include "oblique/film_friction.h"

enum {
    FILM_MOST_SPRINGS = 256, /* most springs */
    FILM_MOST_STEPS = 1024,  /* of a leg, of impacts side by side */
    FILM_MOST_PHASES = 32,   /* that a film_watch keeps; later ones are left out */
    FILM_MOST_POWER = 40     /* all but the outermost springs share alike */
};

/* stiffness: of one spring. width: distance of the springs. power: as above, or 0: all are reached at once. mass: m_t. v: sliding velocity, also where nothing touches.
 * q: friction force. rise: of q over time in the last step. push: acceleration by what else acts. radius: of the contact, now. u: deflections. cut: how
 * many springs slipped in the last step, negative if against their direction at first; stuck: how many stuck inside all of those. */
typedef struct {
    double stiffness, width, power, friction, mass, v, q, rise, push, radius;
    double u[FILM_MOST_SPRINGS], reach[FILM_MOST_SPRINGS]; /* reach: (r/width)^power; 0 for a power of 0 */
    double sums[FILM_MOST_SPRINGS + 1];                    /* of the first values of reach */
    int32_t count, stuck, cut, even; /* even: 1 if all steps are of one time */
} film_springs;

/* The phases of springs that are watched. passed: time since it began. phase: of FILM_STICKS .. FILM_SLIDES in film_friction.h, or
 * -1 without contact; 0 in all members but for phase = -1 is the start. begins, kinds: of the `events` phases that began, after so
 * much of the time; FILM_REVERSES is slip with another sign. */
typedef struct {
    double passed, waited, begins[FILM_MOST_PHASES]; /* waited: since a contact began that has no phase yet */
    int32_t kinds[FILM_MOST_PHASES], events, phase, sign, cut, partly, reserved;
} film_watch;

/* Springs up to the radius `largest`, that do not touch; a step to a larger one doubles their distance. modulus: G_star. count: 1 to
 * FILM_MOST_SPRINGS. power: 0 to FILM_MOST_POWER. FILM_OK, or FILM_BAD_NUMBER: a count or power out of range, or a number that is not
 * finite, or not > 0; friction may be 0, the velocity any. */
FILM_API int film_springs_init(film_springs *state, int32_t count, double modulus, double largest, double power, double friction,
                               double mass, double velocity);

/* The power of a law: 1/(n - 1) of a reversible force ~ xi^n, n > 1, at most FILM_MOST_POWER, and 0 of a linear one; 2 of others. */
FILM_API double film_springs_power(const film_curve *curve);

/* Forward by a time >= 0, at the end of which the contact has this normal force and radius; both 0 without contact. By the
 * rule of the midpoint, half a step with the friction force before, half with that after; in even steps by Adams's rules of third
 * order, with the rise of that force in the step before too. */
FILM_API void film_springs_step(film_springs *state, double time, double force, double radius);

/* The same of the springs alone, where another integrator owns v: the surfaces move evenly by `moved` past each other. */
void film_springs_move(film_springs *state, double moved, double force, double radius);

/* The phase after a step of a time, from the radius `before`, in which of the springs that touch at its end so many slipped as in
 * film_springs.cut. */
FILM_API void film_springs_watch(film_watch *watch, int32_t cut, int32_t touch, double before, double radius, double time);

/* A coefficient of friction over the sliding speed: `rows` pairs (speed, coefficient) of increasing speed, with lines between and
 * constant beyond; one pair for a constant one. */
FILM_API double film_friction_at(const double *table, int32_t rows, double speed);

/* The sliding velocity after a normal impulse over m_t in which the contact slides: v' = -mu(|v|). Between two rows mu = a + b v, so that
 * mu falls or grows by e^(-b s) over the impulse s. The velocity is that of the far points, which turns while the contact still slides. */
FILM_API double film_friction_slid(const double *table, int32_t rows, double velocity, double impulse);

/* The coefficient of the next step: that at the speed which the present friction force leads to, with an error of its square. */
FILM_API void film_springs_take(film_springs *state, double time, const double *table, int32_t rows);

/* One impact: velocity at the end; force, step: largest |q|, and after how many steps; error: of the velocity, at any
 * time, as the largest differences to half and from there to a quarter of the springs and steps tell; slack: what the friction force lacks to its limit, a share of the
 * impulses. regime: of film_friction.h, by the first phase and the slack. watch: of the phases. */
typedef struct {
    double velocity, force, error, slack;
    int64_t step;
    int32_t regime, reserved;
    film_watch watch;
} film_springs_impact_result;

/* An impact of contacts that follow each other. begins, time: of each contact, and of its steps. force, radius: before its first step and
 * after each. friction, rows: as above. steps: of each contact, a multiple of 4. count: of springs, multiple of 4. motion: room for three
 * values at each time of `force`, sliding velocity, friction force and the radius inside which all sticks. result: errors are added; its
 * step counts the times of contacts before. FILM_OK or FILM_BAD_NUMBER as film_springs_init. */
FILM_API int film_springs_impact(int32_t count, double modulus, double power, double mass, double velocity, const double *friction, int32_t rows,
                                 int64_t contacts, const double *begins, const double *time, int64_t steps, const double *force,
                                 const double *radius, film_springs_impact_result *result, double *motion);

/* Its parts, which impacts in lanes share. begin: springs of the finest of all runs and of those with half and a quarter of springs and
 * steps, in runs that are 0 or have begun before and not moved.
 * end: what follows from the largest differences of the velocities of two runs in a contact, and from the sums of the limits and of |q|
 * up to its end. */
enum { FILM_SPRINGS_RUNS = 3 };
int film_springs_begin(film_springs *runs, int32_t all, int32_t count, double modulus, double power, double mass, double velocity, double friction,
                       int64_t steps, const double *radius);
int film_springs_end(film_springs_impact_result *result, double last, double before, double limits, double used);

/* The depth at which the contact has a radius of so many widths, in widths^power. */
double film_springs_reached(double power, double widths);

/* Of one impact of many. time: of the largest force. status: as film_springs_impact returns it; the others as above. */
typedef struct {
    double velocity, force, time, error, slack;
    int32_t regime, status;
} film_springs_brief;

/* Times of the knots of `count` impacts, one after another: `knots` + 1 from first touch to the turn, as many from there to the end.
 * legs: times of the turn, the end, and a kink of the force before the turn, which is a knot if their number is a multiple of 8 from 16 on, of
 * each; that is 0 without one. */
FILM_API void film_springs_knots(int64_t count, int64_t knots, const double *legs, double *times);

/* The impulse of each force at these times, knots: 3 to FILM_MOST_STEPS. */
FILM_API void film_springs_impulses(int64_t count, int64_t knots, const double *legs, const double *force, double *impulse);

/* By how much of the largest of some values up to the turn at most every other lies beside the cubic through its neighbours on one side
 * of the kink. */
FILM_API void film_springs_roughness(int64_t count, int64_t knots, const double *legs, const double *values, double *roughness);

/* The `count` impacts at some places of the others, side by side, without their motions; in single precision but for FILM_MOST_SPRINGS. numbers: of each modulus, power, mass, velocity and three times as
 * film_springs_knots. friction: `rows` pairs of all if shared is 1, else of each. steps: of each leg, a multiple of 4 up to FILM_MOST_STEPS. force,
 * radius: at the times of film_springs_knots, with cubics between; the radius may jump at the kink and at the turn. knots: at least 3. estimated:
 * 0 for an error of 0, without the runs that tell it. */
FILM_API void film_springs_many(int instructions, int64_t count, const int64_t *places, int32_t springs, int32_t estimated, const double *numbers,
                                const double *friction, int32_t rows, int shared, int64_t steps, int64_t knots, const double *force, const double *radius,
                                film_springs_brief *results);

/* How many springs touch. */
FILM_API int32_t film_springs_touching(const film_springs *state);

/* Energy of the springs. */
FILM_API double film_springs_energy(const film_springs *state);

/* The slope of the force of the contact alone, without damping, at x of the march, on the curve of a line. */
double film_contact_slope(const film_curve *curve, const film_line *line, double x);

/* That slope of a reversible law at forces and indentations of the march; 0 without force. It is 2 E_star times the contact radius. */
FILM_API void film_springs_slopes(const film_curve *curve, int64_t count, const double *force, const double *depth, double *slope);

/* Contact radii of impacts of contacts that yield and follow each other, `count` of each, at recorded forces and depths: first those of
 * its law in loading beyond the contacts before, elsewhere as a ball's in the dent of the deepest; second those of an elastic contact with
 * the slope of its force, F' = 2 modulus a. Neither shrinks in loading. modulus: E_star. law: radii of the law, not finite if unknown; read
 * up to the turn only. */
FILM_API void film_springs_radii(int64_t impacts, int64_t contacts, int64_t count, const double *force, const double *depth, const double *law,
                                 double modulus, double *first, double *second);

/* sizeof film_springs, film_springs_brief. */
FILM_API void film_springs_sizes(int64_t sizes[2]);

#endif
