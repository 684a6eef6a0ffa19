// SPDX-License-Identifier: MIT
// Flat pieces of surface as they are seen from a point: triangles and parallelograms, sampled uniformly over
// the directions they fill, or more where the receiver faces them.
#ifndef SAGI_RENDER_SPHERICAL_H
#define SAGI_RENDER_SPHERICAL_H

#include <sagitta/math.h>

// A triangle a, a + e, a + f; or the parallelogram with the fourth corner a + e + f.
typedef struct sagi_facet {
    sag_vec3 a, e, f;
    sag_vec3 middle; // by sagi_facet_measure
    double size2;    // the square of its longest chord; the same
    bool parallelogram;
} sagi_facet;

// Fills `middle` and `size2` in.
static inline void sagi_facet_measure(sagi_facet *facet) {
    const sag_vec3 sum = sag_add(facet->e, facet->f), difference = sag_sub(facet->e, facet->f);
    double size2 = sag_dot(difference, difference);
    if (facet->parallelogram) {
        const double other = sag_dot(sum, sum);
        if (other > size2) size2 = other;
    } else {
        const double e = sag_dot(facet->e, facet->e), f = sag_dot(facet->f, facet->f);
        if (e > size2) size2 = e;
        if (f > size2) size2 = f;
    }
    facet->size2 = size2;
    facet->middle = sag_madd(facet->a, facet->parallelogram ? 0.5 : 1.0 / 3, sum);
}

// A triangle on the unit sphere; spherical.c.
typedef struct sagi_spherical_triangle {
    sag_vec3 a, b, c;
    double determinant, ab, bc, ca;
    double solid_angle;
    double weights[4]; // of the receiver at the corners of the unit square; see spherical.c
} sagi_spherical_triangle;

// The facet from a point.
typedef struct sagi_facet_view {
    sagi_spherical_triangle parts[2];
    int count;
    double first;       // probability of the first part
    double solid_angle; // of all; 0: seen from its edge, or not finite
} sagi_facet_view;

// `normal`: that of the receiver, which light at a grazing angle matters less to; 0: it receives light alike
// from everywhere. front_only: it gets none from behind.
void sagi_facet_see(const sagi_facet *facet, sag_vec3 from, sag_vec3 normal, bool front_only,
                    sagi_facet_view *view);
// A direction to the facet, a unit, and its density per solid angle. view->solid_angle > 0.
sag_vec3 sagi_facet_sample(const sagi_facet_view *view, sag_vec2 u, double *pdf);
// The density with which sagi_facet_sample finds the unit direction wi, which meets the facet.
double sagi_facet_pdf(const sagi_facet_view *view, sag_vec3 wi);
// Where the ray from → wi meets the facet: p = a + u e + v f, kept within it, and the distance.
void sagi_facet_meet(const sagi_facet *facet, sag_vec3 from, sag_vec3 wi, double *u, double *v, double *t);

#endif
