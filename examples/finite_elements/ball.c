/* An elastic ball strikes a rigid, frictionless plane: axisymmetric, explicit finite elements, the ball's true inertia.
 *
 * Elements of elements.c; strains are large, with Jaumann's rate of a linear elastic stress. The mesh is that of a
 * half-space under the conformal map w -> w/(1 + i w/2); a small cap at the far pole is left out. Lengths are in ball
 * radii, the density is 1, and stresses are in E* = E/(1 - nu^2), and velocities in the root of E* over the density.
 *
 *     ball nu velocity element fine growth extent
 *
 * element: size of the finest ones; fine: their number along r and z; growth: ratio of neighbours beyond.
 * Prints `history time approach force`, of one radian, and `end mass restitution duration energy`: the approach is that
 * of the centre of mass, the energy that at the end over that at first. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "elements.h"

enum { STEPS_OF_A_RECORD = 8, QUIET_STEPS = 500 };

static const double COURANT = 0.5; /* of the critical time step, which falls as the elements are compressed */

static Mesh mesh_of(double h, int fine, double growth, double extent, Material material)
{
    double x[MOST_NODES];
    const int count = graded(h, fine, growth, extent, x), row = count + 1, nodes = row * row, elements = count * count;
    Mesh mesh = new_mesh(count, material);
    for (int k = 0; k < nodes; k++) {
        const double r = x[k % row], z = -x[k / row], size = (1.0 - 0.5 * z) * (1.0 - 0.5 * z) + 0.25 * r * r;
        mesh.r[k] = r / size;
        mesh.z[k] = (z * (1.0 - 0.5 * z) - 0.5 * r * r) / size;
    }
    set_densities(&mesh);
    for (int k = 0; k < nodes; k++) {
        mesh.mass[k] = 0.0;
    }
    for (int e = 0; e < elements; e++) {
        const int top = e / count * row + e % count, bottom = top + row;
        const double *r = mesh.r, *z = mesh.z;
        const double area = 0.5 * ((r[top + 1] - r[bottom]) * (z[top] - z[bottom + 1])
                                   - (r[top] - r[bottom + 1]) * (z[top + 1] - z[bottom]));
        const double mass = fabs(area) * 0.0625 * (r[top] + r[top + 1] + r[bottom] + r[bottom + 1]);
        mesh.density[e] = 1.0;
        mesh.mass[top] += mass;
        mesh.mass[top + 1] += mass;
        mesh.mass[bottom] += mass;
        mesh.mass[bottom + 1] += mass;
    }
    /* of the thinnest elements: larger ones bear more viscosity */
    mesh.size = critical_step(&mesh) * sqrt(material.bulk + 4.0 / 3.0 * material.shear);
    return mesh;
}

/* Moves the nodes, and puts those of the surface that passed the plane z = 0 back onto it: the force on the plane. */
static double move_nodes(Mesh *mesh, double dt, double *kinetic)
{
    const int row = mesh->count + 1;
    double force = 0.0;
    *kinetic = 0.0;
    for (int k = 0; k < row * row; k++) {
        mesh->vr[k] = k % row == 0 ? 0.0 : mesh->vr[k] - dt * mesh->fr[k] / mesh->mass[k];
        mesh->vz[k] -= dt * mesh->fz[k] / mesh->mass[k];
        const double past = mesh->z[k] + dt * mesh->vz[k];
        if (k < row && past > 0.0) {
            mesh->vz[k] -= past / dt;
            force += mesh->mass[k] * past / (dt * dt);
        }
        *kinetic += 0.5 * mesh->mass[k] * (mesh->vr[k] * mesh->vr[k] + mesh->vz[k] * mesh->vz[k]);
        mesh->r[k] += dt * mesh->vr[k];
        mesh->z[k] += dt * mesh->vz[k];
    }
    return force;
}

static void strike(Mesh *mesh, double velocity)
{
    const int nodes = (mesh->count + 1) * (mesh->count + 1);
    double mass = 0.0;
    for (int k = 0; k < nodes; k++) {
        mesh->vz[k] = velocity;
        mass += mesh->mass[k];
    }
    double time = 0.0, approach = 0.0, speed = velocity, impulse = 0.0, since = 0.0, last = 0.0;
    double kinetic = 0.0, dt = 0.0;
    Work work = {0};
    for (int step = 0, quiet = 0; quiet < QUIET_STEPS; step++) {
        if (step % STEPS_OF_A_RECORD == 0) {
            dt = COURANT * critical_step(mesh);
        }
        const double force = move_nodes(mesh, dt, &kinetic);
        speed -= dt * force / mass;
        approach += dt * speed;
        time += dt;
        since += dt;
        impulse += dt * force;
        quiet = force == 0.0 && speed < 0.0 ? quiet + 1 : 0;
        last = force > 0.0 ? time : last;
        if ((step + 1) % STEPS_OF_A_RECORD == 0) {
            printf("history %.9g %.9g %.9g\n", time, approach - 0.5 * since * speed, impulse / since);
            impulse = since = 0.0;
        }
        add_forces(mesh, dt, &work);
    }
    const double first = 0.5 * mass * velocity * velocity;
    printf("end %.9g %.9g %.9g %.9g\n", mass, -speed / velocity, last, (kinetic + work.internal) / first);
}

int main(int count, char **words)
{
    double option[6];
    if (count != 7) {
        fputs("usage: ball nu velocity element fine growth extent\n", stderr);
        return 1;
    }
    for (int k = 1; k < count; k++) {
        option[k - 1] = strtod(words[k], NULL);
    }
    const double nu = option[0], E = 1.0 - nu * nu;
    const Material material = {E, 0.5 * E / (1.0 + nu), E / (3.0 * (1.0 - 2.0 * nu)), 0.0, 0.25, 0.0, 0};
    Mesh mesh = mesh_of(option[2], (int)option[3], option[4], option[5], material);
    strike(&mesh, option[1]);
    return 0;
}
