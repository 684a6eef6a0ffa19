// SPDX-License-Identifier: MIT
// From C++, and a shape alone: no context, no scene, no memory. A torus is asked for every crossing.
#include <cstdio>
#include <sagitta/sagitta.h>

int main() {
    sag_torus torus = {};
    torus.major_radius = 2;
    torus.minor_radius = 0.5;
    sag_ray ray = sag_ray_make(sag_vec3_make(-5, 0, 0), sag_vec3_make(1, 0, 0));
    sag_hit hits[4];
    std::size_t count = sag_torus_crossings(&torus, &ray, hits, 4);
    for (std::size_t i = 0; i < count; i++) {
        sag_surface surface;
        sag_torus_surface(&torus, &ray, &hits[i], &surface);
        std::printf("t = %g at x = %g, %s\n", hits[i].t, surface.position.x,
                    surface.side == SAG_SIDE_FRONT ? "entering" : "leaving");
    }
    return count == 4 ? 0 : 1;
}
