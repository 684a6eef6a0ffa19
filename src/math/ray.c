// SPDX-License-Identifier: MIT
// Rays: making, checking and mapping them.
#include "math/map.h"

sag_ray sag_ray_make(sag_vec3 origin, sag_vec3 direction) {
    return (sag_ray){.origin = origin, .direction = direction, .t_min = 0, .t_max = INFINITY};
}

sag_ray sag_ray_transform(const sag_affine *a, const sag_ray *ray) { return sagi_ray_transform(a, ray); }

bool sag_ray_is_valid(const sag_ray *ray) { return sagi_ray_is_valid(ray); }
