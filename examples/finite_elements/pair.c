/* An elastic-plastic ball strikes an elastic-plastic half-space without friction: axisymmetric, explicit elements.
 *
 * Elements of elements.c. The ball is a half-space, too, upside down in its own frame, with a spherical cap that levels off
 * beyond r = CAP, so that the law's half-spaces are compared and not a ball's own compliance; its mass is that of the frame.
 * Nodes of the flat surface do not enter the segments of the ball's: impulses by Gauss and Seidel's iteration conserve
 * momentum. The inertia of the half-spaces is not the question, as in impact.c. Lengths are in ball radii, stresses in Y.
 *
 *     pair E nu n Y E nu n Y mass velocity element fine growth extent hourglass curvature
 *
 * first the ball's E, nu, n and Y, then those of the half-space; the rest and what is printed are those of impact.c, and
 * curvature: of the half-space, which is a ball then; that of the ball is 1 less this. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "elements.h"

enum { STEPS_OF_A_RECORD = 8, STEPS_OF_A_LIMIT = 10, QUIET_STEPS = 500, SWEEPS = 40 };

static const double CAP = 0.6, CLOSED = 1e-7; /* CLOSED: overlap left, over the finest element's size */
static const double COURANT = 0.8;            /* of the critical time step; the viscosity takes the rest */
static const double DAMPING = 0.2;            /* without it waves along the surfaces grow where the ball yields first */

typedef struct {
    Mesh mesh;
    double strength; /* unit of the mesh's stresses and masses */
} Half;

typedef struct {
    int node, segment;
    double part, nr, nz, along, impulse, yielding; /* place and direction on the segment; 1/mass of the overlap */
} Pair;

static double height(double r) /* of the ball's surface below its pole */
{
    const double slope = CAP / sqrt(1.0 - CAP * CAP);
    return r < CAP ? 1.0 - sqrt(1.0 - r * r) : 1.0 - sqrt(1.0 - CAP * CAP) - slope * CAP * expm1(1.0 - r / CAP);
}

/* wave: modulus over density of both bodies, so that one time step serves both. curvature: of the surface. */
static Half half_of(const double *option, double h, int fine, double growth, double extent, double hourglass, double wave,
                    double curvature)
{
    double x[MOST_NODES];
    const double E = option[0] / option[3], nu = option[1];
    const int count = graded(h, fine, growth, extent, x), nodes = (count + 1) * (count + 1);
    const Material material = {E, 0.5 * E / (1.0 + nu), E / (3.0 * (1.0 - 2.0 * nu)), option[2], hourglass, DAMPING, 1};
    Mesh mesh = new_mesh(count, material);
    for (int k = 0; k < nodes; k++) {
        mesh.r[k] = x[k % (count + 1)];
        mesh.z[k] = -x[k / (count + 1)] - (curvature > 0.0 ? height(curvature * mesh.r[k]) / curvature : 0.0);
    }
    set_densities(&mesh);
    for (int k = 0; k < nodes; k++) {
        mesh.mass[k] *= E / wave;
    }
    for (int e = 0; e < count * count; e++) {
        mesh.density[e] *= E / wave;
    }
    mesh.size *= sqrt(E / wave);
    return (Half){mesh, option[3]};
}

/* Free nodes accelerate; those on the axis keep r = 0, those of the outer faces stay. Returns the kinetic energy. */
static double move_nodes(Half *half, double dt)
{
    Mesh *mesh = &half->mesh;
    const int row = mesh->count + 1;
    double energy = 0.0;
    for (int j = 0; j < mesh->count; j++) {
        for (int k = j * row; k < j * row + mesh->count; k++) {
            mesh->vr[k] = k == j * row ? 0.0 : mesh->vr[k] - dt * mesh->fr[k] / mesh->mass[k];
            mesh->vz[k] -= dt * mesh->fz[k] / mesh->mass[k];
            energy += 0.5 * mesh->mass[k] * (mesh->vr[k] * mesh->vr[k] + mesh->vz[k] * mesh->vz[k]);
            mesh->r[k] += dt * mesh->vr[k];
            mesh->z[k] += dt * mesh->vz[k];
        }
    }
    return half->strength * energy;
}

static void push(Half *half, int node, double r, double z, double dt)
{
    Mesh *mesh = &half->mesh;
    const double over = 1.0 / (half->strength * mesh->mass[node]);
    mesh->r[node] += node ? r * over : 0.0;
    mesh->vr[node] += node ? r * over / dt : 0.0;
    mesh->z[node] += z * over;
    mesh->vz[node] += z * over / dt;
}

/* Separates the surfaces: the force on the ball, along its axis. */
static double contact(Half *ball, Half *flat, double depth, double dt, int *touched)
{
    static Pair pairs[MOST_NODES];
    const Mesh *up = &ball->mesh, *low = &flat->mesh;
    int count = 0, k = 0;
    for (int i = 0; i < low->count; i++) {
        while (k < up->count - 1 && up->r[k + 1] < low->r[i]) {
            k++;
        }
        const double dr = up->r[k + 1] - up->r[k], dz = up->z[k] - up->z[k + 1], length = sqrt(dr * dr + dz * dz);
        const double part = (low->r[i] - up->r[k]) / dr;
        const double overlap = low->z[i] + up->z[k] - part * dz + depth;
        if (overlap <= -low->size) {
            if (count && pairs[count - 1].node < i - 2) {
                break;
            }
            continue;
        }
        const double masses = 1.0 / (flat->strength * low->mass[i])
                              + ((1.0 - part) * (1.0 - part) / up->mass[k] + part * part / up->mass[k + 1]) / ball->strength;
        pairs[count++] = (Pair){i, k, part, dz / length, -dr / length, 0.0, 0.0, masses};
    }
    double worst = 1.0;
    for (int sweep = 0; sweep < SWEEPS && worst > CLOSED * low->size; sweep++) {
        worst = 0.0;
        for (int p = 0; p < count; p++) {
            Pair *pair = pairs + p;
            const int s = pair->segment;
            const double w = pair->part, r = low->r[pair->node] - (1.0 - w) * up->r[s] - w * up->r[s + 1];
            const double z = low->z[pair->node] + (1.0 - w) * up->z[s] + w * up->z[s + 1] + depth;
            const double overlap = -(pair->nr * r + pair->nz * z);
            const double before = pair->impulse;
            pair->impulse = fmax(before + overlap / pair->yielding, 0.0);
            const double more = pair->impulse - before;
            worst = fmax(worst, fabs(more) * pair->yielding);
            push(flat, pair->node, more * pair->nr, more * pair->nz, dt);
            push(ball, s, -more * (1.0 - w) * pair->nr, more * (1.0 - w) * pair->nz, dt);
            push(ball, s + 1, -more * w * pair->nr, more * w * pair->nz, dt);
        }
    }
    double force = 0.0;
    *touched = -1;
    for (int p = 0; p < count; p++) {
        if (pairs[p].impulse > 0.0) {
            force -= pairs[p].impulse * pairs[p].nz / (dt * dt);
            *touched = pairs[p].node;
        }
    }
    return force;
}

static void strike(Half *ball, Half *flat, double mass, double speed)
{
    const double first = 0.5 * mass * speed * speed;
    double depth = 0.0, velocity = speed, time = 0.0, last = 0.0, impulse = 0.0, since = 0.0, kinetic = 0.0, dt = 0.0;
    Work works[2] = {{0.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}};
    int farthest = -1, quiet = 0;
    for (long step = 0; quiet < QUIET_STEPS; step++) {
        if (step % STEPS_OF_A_LIMIT == 0) {
            dt = COURANT * fmin(critical_step(&ball->mesh), critical_step(&flat->mesh));
        }
        kinetic = move_nodes(ball, dt) + move_nodes(flat, dt);
        depth += dt * velocity;
        int touched;
        const double force = contact(ball, flat, depth, dt, &touched);
        velocity -= dt * force / mass;
        time += dt;
        since += dt;
        impulse += dt * force;
        quiet = touched < 0 && velocity < 0.0 ? quiet + 1 : 0;
        last = touched >= 0 ? depth : last;
        for (; farthest < touched; farthest++) {
            printf("contact %.9g %.9g\n", flat->mesh.r[farthest + 1], depth);
        }
        if ((step + 1) % STEPS_OF_A_RECORD == 0) {
            printf("history %.9g %.9g %.9g\n", time, depth - 0.5 * since * velocity, impulse / since);
            impulse = since = 0.0;
        }
        add_forces(&ball->mesh, dt, works);
        add_forces(&flat->mesh, dt, works + 1);
    }
    const double a = ball->strength / first, b = flat->strength / first;
    printf("end %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", -velocity / speed, last,
           -flat->mesh.z[0] - ball->mesh.z[0], kinetic / first, a * works[0].internal + b * works[1].internal,
           a * works[0].plastic + b * works[1].plastic, a * works[0].hourglass + b * works[1].hourglass,
           a * works[0].viscous + b * works[1].viscous, b * works[1].plastic);
}

int main(int count, char **words)
{
    double option[16];
    if (count != 17) {
        fputs("usage: pair E nu n Y E nu n Y mass velocity element fine growth extent hourglass curvature\n", stderr);
        return 1;
    }
    for (int k = 1; k < count; k++) {
        option[k - 1] = strtod(words[k], NULL);
    }
    const double wave = fmin(option[0] / option[3], option[4] / option[7]), *mesh = option + 10;
    Half ball = half_of(option, mesh[0], (int)mesh[1], mesh[2], mesh[3], mesh[4], wave, 1.0 - mesh[5]);
    Half flat = half_of(option + 4, mesh[0], (int)mesh[1], mesh[2], mesh[3], mesh[4], wave, mesh[5]);
    strike(&ball, &flat, option[8], option[9]);
    return 0;
}
