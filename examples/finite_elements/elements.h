/* Four-node axisymmetric elements with one point, von Mises plasticity: the state of a square grid of them. */
#ifndef ELEMENTS_H
#define ELEMENTS_H

typedef struct {
    double modulus, shear, bulk, exponent; /* in Y */
    double hourglass;                      /* stiffness against hourglassing over that of bending */
    double damping;                        /* of hourglassing, over density x wave speed x size */
    int yields;
} Material;

typedef struct {
    int count;                                      /* elements along r and along z */
    double *r, *z, *vr, *vz, *fr, *fz, *mass;       /* of nodes, row by row from the surface down */
    double *srr, *szz, *stt, *srz, *strain, *flow;  /* of elements: stress, plastic strain, yield stress */
    double *qr, *qz, *density;                      /* hourglass forces; density */
    double size;                                    /* of the finest elements */
    Material material;
} Mesh;

typedef struct {
    double internal, plastic, hourglass, viscous; /* of one radian */
} Work;

enum { MOST_NODES = 500 }; /* along r and along z */

int graded(double h, int fine, double growth, double extent, double x[MOST_NODES]);
Mesh new_mesh(int count, Material material);
void set_densities(Mesh *mesh);
double critical_step(const Mesh *mesh);
void add_forces(Mesh *mesh, double dt, Work *work);

#endif
