// SPDX-License-Identifier: MIT
// Rays that leave a surface without meeting it again, as functions: spawn.h says how.
#include "shapes/spawn.h"

sag_ray sag_spawn_ray(const sag_surface *surface, sag_vec3 direction) {
    sag_ray ray = {.t_min = 0};
    sagi_spawn(surface, direction, &ray);
    return ray;
}

sag_ray sag_spawn_ray_to_point(const sag_surface *surface, sag_vec3 point) {
    sag_ray ray = {.t_min = 0};
    sagi_spawn_to_point(surface, point, &ray);
    return ray;
}

sag_ray sag_spawn_ray_to_surface(const sag_surface *from, const sag_surface *to) {
    sag_ray ray = {.t_min = 0};
    sagi_spawn_to_surface(from, to, &ray);
    return ray;
}
