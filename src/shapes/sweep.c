// SPDX-License-Identifier: MIT
#include "shapes/sweep.h"
#include "math/elementary.h"
#include "shapes/quadric_solve.h"

bool sagi_sweep_holds(double phi_max_rad, sag_vec3 center, const sag_ray *ray, double t) {
    if (sagi_sweep_is_full(phi_max_rad)) return true;
    double x = sagi_ray_coordinate(ray->origin.x, center.x, t, ray->direction.x).hi;
    double y = sagi_ray_coordinate(ray->origin.y, center.y, t, ray->direction.y).hi;
    return sagi_sweep_angle(x, y) <= phi_max_rad;
}

sag_box3 sagi_sweep_bounds(double phi_max_rad, double radius, double z_min, double z_max) {
    double end = sagi_sweep_end(phi_max_rad), r = radius;
    sag_box3 box = {{-r, -r, z_min}, {r, r, z_max}};
    if (end < SAGI_PI) box.min.x = fmin(0, r * sagi_cos(end));
    if (end < SAGI_PI / 2) box.max.y = r * sagi_sin(end);
    if (end <= SAGI_PI)
        box.min.y = 0;
    else if (end < SAGI_PI * 3 / 2)
        box.min.y = r * sagi_sin(end);
    return box;
}

sag_status sagi_sweep_validate(sag_error *error, const char *shape, double phi_max_rad) {
    // 2π may have been rounded from a float or from degrees on the way here.
    if (phi_max_rad >= 0 && phi_max_rad <= SAGI_TWO_PI * (1 + 0x1p-22)) return SAG_OK;
    return sagi_invalid(error, shape, "phi_max_rad", phi_max_rad, "must be from 0 to 2 pi");
}

sag_status sagi_check_interval(sag_error *error, const char *shape, double z_min, double z_max) {
    if (!sagi_is_coordinate(z_min))
        return sagi_invalid(error, shape, "z_min", z_min, "must be finite and at most 2^100");
    if (!sagi_is_coordinate(z_max))
        return sagi_invalid(error, shape, "z_max", z_max, "must be finite and at most 2^100");
    if (z_min < z_max) return SAG_OK;
    return sag_error_set(error, SAG_ERROR_GEOMETRY, "%s: z_min %.17g must be less than z_max %.17g", shape,
                         z_min, z_max);
}

sag_status sagi_check_closed(sag_error *error, const char *shape, bool closed, double phi_max_rad) {
    if (!closed || sagi_sweep_is_full(phi_max_rad)) return SAG_OK;
    return sagi_invalid(error, shape, "phi_max_rad", phi_max_rad,
                        "must be a full turn (0 or 2 pi) for a closed shape");
}
