// SPDX-License-Identifier: MIT
// Rays: making, checking and mapping them.
#include <sagitta/math.h>

sag_ray sag_ray_make(sag_vec3 origin, sag_vec3 direction) {
    return (sag_ray){.origin = origin, .direction = direction, .t_min = 0, .t_max = INFINITY};
}

sag_ray sag_ray_transform(const sag_affine *a, const sag_ray *ray) {
    return (sag_ray){
        .origin = sag_affine_point(a, ray->origin),
        .direction = sag_affine_vector(a, ray->direction),
        .t_min = ray->t_min,
        .t_max = ray->t_max,
        .mask = ray->mask,
    };
}

bool sag_ray_is_valid(const sag_ray *ray) {
    sag_vec3 o = ray->origin, d = ray->direction;
    // x − x is 0 for finite x, else NaN.
    double zero = ((o.x - o.x) + (o.y - o.y) + (o.z - o.z)) + ((d.x - d.x) + (d.y - d.y) + (d.z - d.z));
    double length = fabs(d.x) + fabs(d.y) + fabs(d.z);
    return zero == 0 && length > 0 && ray->t_min <= ray->t_max;
}
