// SPDX-License-Identifier: MIT
// The sphere flake of E. Haines' Standard Procedural Databases, four times repeated: 7,381 balls, each one by
// itself as a user of either program would write them.
#include "../bench.h"
#include "solids.h"
#include <stdlib.h>

static void write(scene_files *files) {
    model m;
    model_make_flake(&m, 4);
    for (uint32_t i = 0; i < m.sphere_count; i++) {
        const float *s = m.spheres + 4 * (size_t)i;
        const double x = (double)s[0], y = (double)s[1], z = (double)s[2], r = (double)s[3];
        fprintf(files->pov, "sphere { <%.9g, %.9g, %.9g>, %.9g }\n", x, y, z, r);
        fprintf(
            files->pbrt,
            "AttributeBegin Translate %.9g %.9g %.9g Shape \"sphere\" \"float radius\" %.9g AttributeEnd\n",
            x, y, z, r);
    }
    model_free(&m);
}

const scene_kind scene_flake = {
    "flake", "sphere flake, 7,381 balls", {{1.2, 1.5, 2}, {0, 0.12, 0}, {0, 1, 0}, 0.66, 1.5, 4}, write};
