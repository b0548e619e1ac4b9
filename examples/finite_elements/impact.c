/* A rigid, frictionless ball strikes a half-space that yields: axisymmetric, explicit finite elements.
 *
 * Four-node elements with one point and Flanagan-Belytschko hourglass stiffness; von Mises plasticity with
 * sigma_y = Y (1 + E eps_p/Y)^n, radial return, Jaumann's rate; nodes of the surface are held on the sphere exactly.
 * Lengths are in ball radii and stresses in Y. The inertia of the half-space is not the question: an element's density
 * makes its critical time step that of the finest one, so that waves cross the large domain in few steps.
 * Integrals over the angle are left out: masses and forces are those of one radian.
 *
 *     impact E/Y nu n mass velocity element fine growth extent hourglass yields [velocity ...]
 *
 * mass and velocity of the ball; element: size of the finest ones; fine: their number along r and z; growth: ratio of
 * neighbours beyond; extent: of the domain; hourglass: stiffness over that of bending; yields: 0 or 1; velocities of
 * later impacts on the same dent, 0: that of the rebound before.
 * Prints `contact r depth` when a node of the surface is touched first, `history time depth force` and `end ...`. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "elements.h"

enum { STEPS_OF_A_RECORD = 8, STEPS_OF_A_LIMIT = 10, QUIET_STEPS = 500 };

static const double COURANT = 0.8; /* of the critical time step; the viscosity takes the rest */

typedef struct {
    double mass, velocity, depth; /* of one radian; positive inwards */
} Ball;

static Mesh mesh_of(double h, int fine, double growth, double extent, Material material)
{
    double x[MOST_NODES];
    const int count = graded(h, fine, growth, extent, x), nodes = (count + 1) * (count + 1);
    Mesh mesh = new_mesh(count, material);
    for (int k = 0; k < nodes; k++) {
        mesh.r[k] = x[k % (count + 1)];
        mesh.z[k] = -x[k / (count + 1)];
    }
    set_densities(&mesh);
    return mesh;
}

/* Pushes the nodes of the surface that entered the sphere back onto it: the force on the ball, along its axis. */
static double contact(Mesh *mesh, const Ball *ball, double dt, int *touched)
{
    const double centre = 1.0 - ball->depth;
    double force = 0.0;
    *touched = -1;
    for (int i = 0; i < mesh->count; i++) {
        const double dr = mesh->r[i], dz = mesh->z[i] - centre, distance = sqrt(dr * dr + dz * dz);
        const double overlap = 1.0 - distance;
        if (overlap <= 0.0) {
            continue;
        }
        const double nr = dr / distance, nz = dz / distance;
        mesh->r[i] += overlap * nr;
        mesh->z[i] += overlap * nz;
        mesh->vr[i] += overlap * nr / dt;
        mesh->vz[i] += overlap * nz / dt;
        force -= mesh->mass[i] * overlap * nz / (dt * dt);
        *touched = i;
    }
    return force;
}

/* Free nodes accelerate; those on the axis keep r = 0, those of the outer faces stay. Returns the kinetic energy. */
static double move_nodes(Mesh *mesh, double dt)
{
    const int row = mesh->count + 1;
    double energy = 0.0;
    for (int j = 0; j < mesh->count; j++) {
        for (int k = j * row; k < j * row + mesh->count; k++) {
            mesh->vr[k] -= dt * mesh->fr[k] / mesh->mass[k];
            mesh->vz[k] -= dt * mesh->fz[k] / mesh->mass[k];
        }
        mesh->vr[j * row] = 0.0;
        for (int k = j * row; k < j * row + mesh->count; k++) {
            energy += 0.5 * mesh->mass[k] * (mesh->vr[k] * mesh->vr[k] + mesh->vz[k] * mesh->vz[k]);
            mesh->r[k] += dt * mesh->vr[k];
            mesh->z[k] += dt * mesh->vz[k];
        }
    }
    return energy;
}

/* One impact: the ball that rebounds. Energies of one radian are over that of the ball at first: the balance closes to
 * the work of the contact. `end`: restitution, depth of the ball where contact ended and of the dent, energies. */
static Ball strike(Mesh *mesh, Ball ball)
{
    const double first = 0.5 * ball.mass * ball.velocity * ball.velocity, speed = ball.velocity;
    double time = 0.0, last_depth = 0.0, impulse = 0.0, since = 0.0, kinetic = 0.0, dt = 0.0;
    Work work = {0};
    int farthest = -1, quiet = 0;
    for (long step = 0; quiet < QUIET_STEPS; step++) {
        if (step % STEPS_OF_A_LIMIT == 0) {
            dt = COURANT * critical_step(mesh);
        }
        kinetic = move_nodes(mesh, dt);
        ball.depth += dt * ball.velocity;
        int touched;
        const double force = contact(mesh, &ball, dt, &touched);
        ball.velocity -= dt * force / ball.mass;
        time += dt;
        since += dt;
        impulse += dt * force;
        quiet = touched < 0 && ball.velocity < 0.0 ? quiet + 1 : 0;
        if (touched >= 0) {
            last_depth = ball.depth;
        }
        for (; farthest < touched; farthest++) {
            printf("contact %.9g %.9g\n", mesh->r[farthest + 1], ball.depth);
        }
        if ((step + 1) % STEPS_OF_A_RECORD == 0) {
            printf("history %.9g %.9g %.9g\n", time, ball.depth - 0.5 * since * ball.velocity, impulse / since);
            impulse = since = 0.0;
        }
        add_forces(mesh, dt, &work);
    }
    printf("end %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %d\n", -ball.velocity / speed, last_depth, -mesh->z[0],
           kinetic / first, work.internal / first, work.plastic / first, work.hourglass / first, work.viscous / first,
           mesh->count);
    return ball;
}

int main(int count, char **words)
{
    double option[12];
    if (count < 12) {
        fputs("usage: impact E/Y nu n mass velocity element fine growth extent hourglass yields [velocity ...]\n", stderr);
        return 1;
    }
    for (int k = 1; k < 12; k++) {
        option[k - 1] = strtod(words[k], NULL);
    }
    const double E = option[0], nu = option[1];
    Material material = {E, 0.5 * E / (1.0 + nu), E / (3.0 * (1.0 - 2.0 * nu)), option[2], option[9], 0.0, option[10] != 0.0};
    Mesh mesh = mesh_of(option[5], (int)option[6], option[7], option[8], material);
    Ball ball = strike(&mesh, (Ball){option[3], option[4], 0.0});
    for (int k = 12; k < count; k++) {
        const double again = strtod(words[k], NULL);
        ball.velocity = again > 0.0 ? again : -ball.velocity;
        ball = strike(&mesh, ball);
    }
    return 0;
}
