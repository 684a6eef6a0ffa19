// SPDX-License-Identifier: MIT
// The frustum of a view as half-spaces. With the unit frame f (forward), r (right) and u (up) the side planes
// go through the eye; the right one's normal leans by the half angle α from r towards −f: n = r cos α − f sin
// α is perpendicular to the view's edge f cos α + r sin α and points out of the view.
#include "math/elementary.h"
#include "shapes/validate.h"

static sag_half_space through(sag_vec3 point, sag_vec3 normal) {
    return (sag_half_space){normal, sag_dot(normal, point)};
}

static sag_half_space side(sag_vec3 eye, sag_vec3 forward, sag_vec3 outward, double half_angle_rad) {
    return through(
        eye, sag_madd(sag_scale(outward, sagi_cos(half_angle_rad)), -sagi_sin(half_angle_rad), forward));
}

sag_status sag_frustum_planes(sag_vec3 eye, sag_vec3 forward, sag_vec3 up, double half_width_rad,
                              double half_height_rad, double near_distance, double far_distance,
                              sag_half_space planes[6], sag_error *error) {
    const double right_angle = 1.57079632679489661923;
    sag_status status = sagi_check_point(error, "frustum", "eye", eye);
    if (status == SAG_OK) status = sagi_check_direction(error, "frustum", "forward", forward);
    if (status == SAG_OK) status = sagi_check_direction(error, "frustum", "up", up);
    if (status != SAG_OK) return status;
    if (!(half_width_rad > 0 && half_width_rad < right_angle))
        return sagi_invalid(error, "frustum", "half_width_rad", half_width_rad, "must be in (0, pi/2)");
    if (!(half_height_rad > 0 && half_height_rad < right_angle))
        return sagi_invalid(error, "frustum", "half_height_rad", half_height_rad, "must be in (0, pi/2)");
    if (!(near_distance >= 0))
        return sagi_invalid(error, "frustum", "near_distance", near_distance, "must not be negative");
    if (!(near_distance < far_distance && sagi_is_coordinate(far_distance)))
        return sagi_invalid(error, "frustum", "far_distance", far_distance,
                            "must be beyond near_distance and at most 2^100");
    sag_vec3 f = sag_normalize(forward), across = sag_cross(f, sag_normalize(up));
    if (sagi_is_zero3(across))
        return sagi_invalid3(error, "frustum", "up", up, "must not be parallel to forward");
    sag_vec3 r = sag_normalize(across), u = sag_cross(r, f);
    planes[0] = side(eye, f, sag_neg(r), half_width_rad);
    planes[1] = side(eye, f, r, half_width_rad);
    planes[2] = side(eye, f, sag_neg(u), half_height_rad);
    planes[3] = side(eye, f, u, half_height_rad);
    planes[4] = through(sag_madd(eye, near_distance, f), sag_neg(f));
    planes[5] = through(sag_madd(eye, far_distance, f), f);
    return SAG_OK;
}
