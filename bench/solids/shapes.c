// SPDX-License-Identifier: MIT
// 12² closed shapes of six kinds, each turned another way. POV-Ray has no paraboloid and no hyperboloid: they
// are quadrics cut off by planes, with a box about them, as its users write them.
#include "solids.h"

enum { SIDE = 12 };

static void torus(scene_files *f) {
    fprintf(f->pov, "torus { 0.7, 0.28 rotate <90, 0, 0> "); // POV-Ray's lies in the xz plane
    fprintf(f->pbrt, "Shape \"torus\" \"float majorradius\" 0.7 \"float minorradius\" 0.28");
}

static void cone(scene_files *f) {
    fprintf(f->pov, "cone { <0, 0, 0>, 0.8, <0, 0, 1.5>, 0 ");
    fprintf(f->pbrt, "Shape \"cone\" \"float radius\" 0.8 \"float height\" 1.5 \"bool closed\" true");
}

static void cylinder(scene_files *f) {
    fprintf(f->pov, "cylinder { <0, 0, -0.8>, <0, 0, 0.8>, 0.6 ");
    fprintf(f->pbrt, "Shape \"cylinder\" \"float radius\" 0.6 \"float zmin\" -0.8 \"float zmax\" 0.8 \"bool "
                     "closed\" true");
}

// x² + y² = z/2, z from 0 to 1.28.
static void paraboloid(scene_files *f) {
    fprintf(f->pov, "intersection { quadric { <1, 1, 0>, <0, 0, 0>, <0, 0, -0.5>, 0 } plane { z, 1.28 }\n"
                    "  bounded_by { box { <-0.8, -0.8, 0>, <0.8, 0.8, 1.28> } } ");
    fprintf(f->pbrt, "Shape \"paraboloid\" \"float radius\" 0.8 \"float zmax\" 1.28 \"bool closed\" true");
}

// x² + y² = 0.16 + z²/2, |z| ≤ 0.9: a line through (0.4, 0, 0) turned about the axis.
static void hyperboloid(scene_files *f) {
    const double s = 0.6363961030678928; // 0.9/√2
    fprintf(f->pov, "intersection { quadric { <1, 1, -0.5>, <0, 0, 0>, <0, 0, 0>, -0.16 } plane { z, 0.9 } "
                    "plane { -z, 0.9 }\n"
                    "  bounded_by { box { <-0.752, -0.752, -0.9>, <0.752, 0.752, 0.9> } } ");
    fprintf(f->pbrt,
            "Shape \"hyperboloid\" \"point3 p1\" [0.4 %.17g -0.9] \"point3 p2\" [0.4 %.17g 0.9] \"bool "
            "closed\" true",
            -s, s);
}

static void ellipsoid(scene_files *f) {
    fprintf(f->pov, "sphere { <0, 0, 0>, 1 scale <0.9, 0.6, 0.45> ");
    fprintf(f->pbrt, "Shape \"ellipsoid\" \"vector3 radii\" [0.9 0.6 0.45]");
}

static void write(scene_files *files) {
    static void (*const kinds[])(scene_files *) = {torus, cone, cylinder, paraboloid, hyperboloid, ellipsoid};
    for (unsigned i = 0; i < SIDE * SIDE; i++) {
        const double spacing = 2.1, middle = (SIDE - 1) / 2.0;
        const sag_vec3 at = {spacing * (i % SIDE - middle), spacing * (i / SIDE - middle), 0};
        const sag_affine place = tumbled(i, at);
        fprintf(files->pbrt, "AttributeBegin ");
        write_matrix_pbrt(files->pbrt, &place);
        fprintf(files->pbrt, "\n  ");
        kinds[(i + i / SIDE) % 6](files);
        write_matrix_pov(files->pov, &place);
        fprintf(files->pov, " }\n");
        fprintf(files->pbrt, "\nAttributeEnd\n");
    }
}

const scene_kind scene_shapes = {
    "shapes", "12 x 12 shapes of six kinds", {{4, -20, 17}, {0, -1.5, 0}, {0, 0, 1}, 0.75, 8, 45}, write};
