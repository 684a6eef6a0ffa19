// SPDX-License-Identifier: MIT
// Models of spheres. Random ones: centres anywhere in a cube, radii so that they fill about a tenth of it.
// And the flake of Eric Haines' "A Proposal for Standard Graphics Environments" (IEEE CG&A 7(11), 1987): each
// ball carries nine of a third of its size, six around its equator and three on its upper half, touching it;
// at depth 4 it has 1 + 9 + 81 + 729 + 6,561 = 7,381 balls.
#include "bench.h"
#include <stdio.h>
#include <stdlib.h>

void model_make_random_spheres(model *m, uint32_t count) {
    *m = (model){.sphere_count = count};
    snprintf(m->name, sizeof m->name, "spheres");
    m->spheres = need((size_t)count * 4 * sizeof *m->spheres);
    uint64_t state = 7;
    double typical = cbrt(0.1 / count * 3 / (4 * 3.14159265358979323846));
    for (size_t i = 0; i < count; i++) {
        float *s = m->spheres + 4 * i;
        for (int k = 0; k < 3; k++) s[k] = (float)(random_unit(&state) - 0.5);
        s[3] = (float)(typical * (0.5 + random_unit(&state)));
    }
    model_measure(m);
}

enum { CHILDREN = 9 };

typedef struct ball {
    sag_vec3 center, up; // up: away from the parent
    double radius;
} ball;

static void children_of(const ball *parent, ball children[CHILDREN]) {
    sag_vec3 s, t;
    sag_frame(parent->up, &s, &t);
    for (int i = 0; i < CHILDREN; i++) {
        double around =
            i < 6 ? i * 3.14159265358979323846 / 3 : (2 * (i - 6) + 0.5) * 3.14159265358979323846 / 3;
        double rise = i < 6 ? 0 : sqrt(2.0 / 3), out = sqrt(1 - rise * rise);
        sag_vec3 up =
            sag_madd(sag_madd(sag_scale(parent->up, rise), out * cos(around), s), out * sin(around), t);
        children[i] = (ball){.up = sag_normalize(up), .radius = parent->radius / 3};
        children[i].center = sag_madd(parent->center, parent->radius + children[i].radius, children[i].up);
    }
}

// Breadth first: the children of ball i come right after those of ball i − 1.
void model_make_flake(model *m, int depth) {
    size_t count = 1, level = 1;
    for (int i = 0; i < depth; i++) count += level *= CHILDREN;
    ball *balls = need((count + CHILDREN) * sizeof *balls);
    balls[0] = (ball){.up = {0, 1, 0}, .radius = 0.5};
    for (size_t i = 0, made = 1; made < count; i++, made += CHILDREN) children_of(&balls[i], &balls[made]);
    *m = (model){.sphere_count = (uint32_t)count};
    snprintf(m->name, sizeof m->name, "sphereflake");
    m->spheres = need(count * 4 * sizeof *m->spheres);
    for (size_t i = 0; i < count; i++) {
        float *s = m->spheres + 4 * i;
        s[0] = (float)balls[i].center.x, s[1] = (float)balls[i].center.y, s[2] = (float)balls[i].center.z;
        s[3] = (float)balls[i].radius;
    }
    free(balls);
    model_measure(m);
}
