// SPDX-License-Identifier: MIT
// 8³ dice in a grid, each the intersection of a box and a sphere without 21 pips: one description, placed 512
// times.
#include "solids.h"

enum { SIDE = 8 };
#define ROUNDING 1.4
#define PIP      0.2
#define APART    0.5

typedef struct pips {
    sag_vec3 at[21];
} pips;

// Opposite faces make seven. A face's pips are some of nine places.
static pips make_pips(void) {
    static const unsigned char faces[7][9] = {[1] = {0, 0, 0, 0, 1},
                                              [2] = {1, 0, 0, 0, 0, 0, 0, 0, 1},
                                              [3] = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                              [4] = {1, 0, 1, 0, 0, 0, 1, 0, 1},
                                              [5] = {1, 0, 1, 0, 1, 0, 1, 0, 1},
                                              [6] = {1, 0, 1, 1, 0, 1, 1, 0, 1}};
    pips p;
    int count = 0;
    for (int face = 1; face <= 6; face++)
        for (int place = 0; place < 9; place++) {
            if (!faces[face][place]) continue;
            const double side = face <= 3 ? 1 : -1, u = (place % 3 - 1) * APART, v = (place / 3 - 1) * APART;
            const int axis = face <= 3 ? face : 7 - face;
            p.at[count++] = axis == 1   ? (sag_vec3){side, u, v}
                            : axis == 2 ? (sag_vec3){u, side, v}
                                        : (sag_vec3){u, v, side};
        }
    return p;
}

static void write(scene_files *files) {
    const pips p = make_pips();
    fprintf(files->pov,
            "#declare Die = difference {\n  intersection { box { <-1, -1, -1>, <1, 1, 1> } sphere { <0, 0, "
            "0>, %g } }\n",
            ROUNDING);
    fprintf(files->pbrt,
            "ObjectBegin \"die\"\nSolidBegin \"difference\"\n  SolidBegin \"intersection\"\n"
            "    Shape \"box\" \"point3 min\" [-1 -1 -1] \"point3 max\" [1 1 1]\n"
            "    Shape \"sphere\" \"float radius\" %g\n  SolidEnd\n",
            ROUNDING);
    for (int i = 0; i < 21; i++) {
        fprintf(files->pov, "  sphere { <%g, %g, %g>, %g }\n", p.at[i].x, p.at[i].y, p.at[i].z, PIP);
        fprintf(files->pbrt,
                "  AttributeBegin Translate %g %g %g Shape \"sphere\" \"float radius\" %g AttributeEnd\n",
                p.at[i].x, p.at[i].y, p.at[i].z, PIP);
    }
    fprintf(files->pov, "}\n");
    fprintf(files->pbrt, "SolidEnd\nObjectEnd\n");
    for (unsigned i = 0; i < SIDE * SIDE * SIDE; i++) {
        const double spacing = 3.2, middle = (SIDE - 1) / 2.0;
        const sag_vec3 at = {spacing * (i % SIDE - middle), spacing * (i / SIDE % SIDE - middle),
                             spacing * (i / SIDE / SIDE - middle)};
        fprintf(files->pov, "object { Die translate <%g, %g, %g> }\n", at.x, at.y, at.z);
        fprintf(files->pbrt, "AttributeBegin Translate %g %g %g ObjectInstance \"die\" AttributeEnd\n", at.x,
                at.y, at.z);
    }
}

const scene_kind scene_dice = {
    "dice", "8 x 8 x 8 dice", {{38, -29, 25}, {0, 0, -1}, {0, 0, 1}, 0.55, 25, 75}, write};
