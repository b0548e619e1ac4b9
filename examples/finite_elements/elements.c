/* Mesh and forces of the elements: see Flanagan & Belytschko 1981, Int. J. Numer. Meth. Eng. 17:679. */

#include "elements.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double VISCOSITY = 0.06; /* linear bulk viscosity over density x wave speed x size */
enum { MOST_ALONG = 512 };

static double *zeros(int count)
{
    double *made = calloc((size_t)count, sizeof *made);
    if (!made) {
        fputs("out of memory\n", stderr);
        exit(1);
    }
    return made;
}

/* Coordinates 0, h, 2h, ... of `fine` elements, then geometric up to `extent`: the number of elements. */
int graded(double h, int fine, double growth, double extent, double x[MOST_NODES])
{
    int k = 0;
    x[0] = 0.0;
    for (double size = h; x[k] < extent && k < MOST_NODES - 1; k++) {
        x[k + 1] = x[k] + size;
        if (k + 1 >= fine) {
            size *= growth;
        }
    }
    return k;
}

/* A grid of count x count elements, all zero. */
Mesh new_mesh(int count, Material material)
{
    const int nodes = (count + 1) * (count + 1), elements = count * count;
    Mesh mesh = {.count = count, .material = material};
    double **of_nodes[] = {&mesh.r, &mesh.z, &mesh.vr, &mesh.vz, &mesh.fr, &mesh.fz, &mesh.mass};
    double **of_elements[] = {&mesh.srr, &mesh.szz, &mesh.stt, &mesh.srz, &mesh.strain,
                              &mesh.flow, &mesh.qr,  &mesh.qz,  &mesh.density};
    for (size_t k = 0; k < sizeof of_nodes / sizeof *of_nodes; k++) {
        *of_nodes[k] = zeros(nodes);
    }
    for (size_t k = 0; k < sizeof of_elements / sizeof *of_elements; k++) {
        *of_elements[k] = zeros(elements);
    }
    return mesh;
}

/* B_iI B_iI of an element with the hoop term, 1/length^2: bounds its highest frequency by 2 c sqrt(BB). */
static double gradient(const Mesh *mesh, int i, int j, double *area, double *radius)
{
    const int row = mesh->count + 1, top = j * row + i, bottom = top + row;
    const double *r = mesh->r, *z = mesh->z;
    const double y24 = z[bottom + 1] - z[top], y31 = z[top + 1] - z[bottom];
    const double x42 = r[top] - r[bottom + 1], x13 = r[bottom] - r[top + 1];
    *area = 0.5 * (x13 * y24 - x42 * y31);
    *radius = 0.25 * (r[top] + r[top + 1] + r[bottom] + r[bottom + 1]);
    return 0.5 * (y24 * y24 + y31 * y31 + x42 * x42 + x13 * x13) / (*area * *area) + 0.25 / (*radius * *radius);
}

void set_densities(Mesh *mesh)
{
    const int count = mesh->count, row = count + 1;
    double area, radius;
    const double finest = gradient(mesh, count > 8 ? 8 : 0, 0, &area, &radius);
    mesh->size = sqrt(2.0 / finest);
    for (int j = 0; j < count; j++) {
        for (int i = 0; i < count; i++) {
            const int e = j * count + i, top = j * row + i;
            mesh->density[e] = gradient(mesh, i, j, &area, &radius) / finest;
            const double mass = 0.25 * mesh->density[e] * area * radius;
            mesh->mass[top] += mass;
            mesh->mass[top + 1] += mass;
            mesh->mass[top + row] += mass;
            mesh->mass[top + row + 1] += mass;
            mesh->flow[e] = 1.0;
        }
    }
}

double critical_step(const Mesh *mesh)
{
    const double stiffness = mesh->material.bulk + 4.0 / 3.0 * mesh->material.shear;
    double most = 0.0;
    for (int j = 0; j < mesh->count; j++) {
        for (int i = 0; i < mesh->count; i++) {
            double area, radius;
            const double frequency = gradient(mesh, i, j, &area, &radius) / mesh->density[j * mesh->count + i];
            most = frequency > most ? frequency : most;
        }
    }
    return 1.0 / sqrt(stiffness * most);
}

/* One row of elements: stresses at the end of the step, and the forces on the two rows of nodes. */
static void add_row(Mesh *mesh, int j, double dt, Work *work)
{
    const int count = mesh->count, row = count + 1;
    const Material m = mesh->material;
    const double *restrict ru = mesh->r + j * row, *restrict zu = mesh->z + j * row; /* upper nodes */
    const double *restrict rl = ru + row, *restrict zl = zu + row;                   /* lower nodes */
    const double *restrict vru = mesh->vr + j * row, *restrict vzu = mesh->vz + j * row;
    const double *restrict vrl = vru + row, *restrict vzl = vzu + row;
    double *restrict srr = mesh->srr + j * count, *restrict szz = mesh->szz + j * count;
    double *restrict stt = mesh->stt + j * count, *restrict srz = mesh->srz + j * count;
    double *restrict strain = mesh->strain + j * count, *restrict flow = mesh->flow + j * count;
    double *restrict qr = mesh->qr + j * count, *restrict qz = mesh->qz + j * count;
    double force[8][MOST_ALONG];
    const double stiffness = m.bulk + 4.0 / 3.0 * m.shear, lambda = m.bulk - 2.0 / 3.0 * m.shear;
    const double bending = m.hourglass * (stiffness + m.shear) / 12.0; /* of a square, exactly integrated */
    /* density x wave speed x size is the same of all elements */
    const double impedance = sqrt(stiffness) * mesh->size, thickness = VISCOSITY * impedance;
    const double damping = m.damping * impedance;
    double internal = 0.0, plastic = 0.0, hourglass = 0.0, viscous = 0.0;
#pragma GCC ivdep /* no two of these arrays overlap; without it gcc does not vectorize: up to twice the time */
    for (int i = 0; i < count; i++) { /* nodes 1, 2: lower left and right; 3, 4: upper right and left */
        const double y24 = zl[i + 1] - zu[i], y31 = zu[i + 1] - zl[i];
        const double x42 = ru[i] - rl[i + 1], x13 = rl[i] - ru[i + 1];
        const double area = 0.5 * (x13 * y24 - x42 * y31), half = 0.5 / area;
        const double radius = 0.25 * (rl[i] + rl[i + 1] + ru[i + 1] + ru[i]);
        const double vr13 = vrl[i] - vru[i + 1], vr24 = vrl[i + 1] - vru[i];
        const double vz13 = vzl[i] - vzu[i + 1], vz24 = vzl[i + 1] - vzu[i];
        const double lrr = half * (y24 * vr13 + y31 * vr24), lrz = half * (x42 * vr13 + x13 * vr24);
        const double lzr = half * (y24 * vz13 + y31 * vz24), lzz = half * (x42 * vz13 + x13 * vz24);
        const double ltt = 0.25 * (vrl[i] + vrl[i + 1] + vru[i + 1] + vru[i]) / radius;
        const double volume = lrr + lzz + ltt, spin = 0.5 * dt * (lrz - lzr);
        const double before = srr[i] * lrr + szz[i] * lzz + stt[i] * ltt + srz[i] * (lrz + lzr);
        /* trial stress: Jaumann's rate */
        const double pull = lambda * dt * volume, twice = 2.0 * m.shear * dt, turn = 2.0 * spin * srz[i];
        double a = srr[i] + turn + pull + twice * lrr, b = szz[i] - turn + pull + twice * lzz;
        double c = stt[i] + pull + twice * ltt;
        double s = srz[i] + spin * (szz[i] - srr[i]) + 0.5 * twice * (lrz + lzr);
        const double mean = (a + b + c) / 3.0;
        a -= mean, b -= mean, c -= mean;
        /* radial return; the slope of the hardening is that at the step's beginning, the yield stress exact */
        const double mises = sqrt(1.5 * (a * a + b * b + c * c + 2.0 * s * s)) + 1e-300;
        const double beyond = 1.0 + m.modulus * strain[i], slope = m.exponent * m.modulus * flow[i] / beyond;
        const double over = m.yields ? fmax(mises - flow[i], 0.0) : 0.0;
        const double more = over / (3.0 * m.shear + slope);
        strain[i] += more;
        flow[i] = exp(m.exponent * log(1.0 + m.modulus * strain[i]));
        const double scale = over > 0.0 ? flow[i] / mises : 1.0;
        a = srr[i] = a * scale + mean;
        b = szz[i] = b * scale + mean;
        c = stt[i] = c * scale + mean;
        s = srz[i] = s * scale;
        const double after = a * lrr + b * lzz + c * ltt + s * (lrz + lzr);
        const double viscosity = thickness * volume;
        a += viscosity, b += viscosity, c += viscosity;
        const double rr = 0.5 * radius, hoop = 0.25 * area * c;
        const double r13 = rr * (y24 * a + x42 * s), r24 = rr * (y31 * a + x13 * s);
        const double z13 = rr * (y24 * s + x42 * b), z24 = rr * (y31 * s + x13 * b);
        /* hourglass stiffness: gamma = h - (h.r) B_r - (h.z) B_z */
        const double hr = half * (rl[i] - rl[i + 1] + ru[i + 1] - ru[i]);
        const double hz = half * (zl[i] - zl[i + 1] + zu[i + 1] - zu[i]);
        const double g13 = hr * y24 + hz * x42, g24 = hr * y31 + hz * x13;
        const double rate_r = vrl[i] - vrl[i + 1] + vru[i + 1] - vru[i] - g13 * vr13 - g24 * vr24;
        const double rate_z = vzl[i] - vzl[i + 1] + vzu[i + 1] - vzu[i] - g13 * vz13 - g24 * vz24;
        qr[i] += bending * radius * dt * rate_r;
        qz[i] += bending * radius * dt * rate_z;
        const double tr = qr[i] + damping * radius * rate_r, tz = qz[i] + damping * radius * rate_z;
        force[0][i] = r13 + hoop + tr * (1.0 - g13);
        force[1][i] = r24 + hoop - tr * (1.0 + g24);
        force[2][i] = -r13 + hoop + tr * (1.0 + g13);
        force[3][i] = -r24 + hoop - tr * (1.0 - g24);
        force[4][i] = z13 + tz * (1.0 - g13);
        force[5][i] = z24 - tz * (1.0 + g24);
        force[6][i] = -z13 + tz * (1.0 + g13);
        force[7][i] = -z24 - tz * (1.0 - g24);
        const double content = radius * area;
        internal += dt * content * (0.5 * (before + after) + viscosity * volume);
        plastic += content * more * flow[i];
        hourglass += dt * (tr * rate_r + tz * rate_z);
        viscous += dt * content * viscosity * volume;
    }
    double *fru = mesh->fr + j * row, *fzu = mesh->fz + j * row, *frl = fru + row, *fzl = fzu + row;
    for (int i = 0; i < count; i++) {
        frl[i] += force[0][i];
        fzl[i] += force[4][i];
        fru[i] += force[3][i];
        fzu[i] += force[7][i];
    }
    for (int i = 0; i < count; i++) {
        frl[i + 1] += force[1][i];
        fzl[i + 1] += force[5][i];
        fru[i + 1] += force[2][i];
        fzu[i + 1] += force[6][i];
    }
    work->internal += internal + hourglass;
    work->plastic += plastic;
    work->hourglass += hourglass;
    work->viscous += viscous;
}

void add_forces(Mesh *mesh, double dt, Work *work)
{
    const size_t nodes = (size_t)(mesh->count + 1) * (size_t)(mesh->count + 1);
    memset(mesh->fr, 0, nodes * sizeof *mesh->fr);
    memset(mesh->fz, 0, nodes * sizeof *mesh->fz);
    for (int j = 0; j < mesh->count; j++) {
        add_row(mesh, j, dt, work);
    }
}
