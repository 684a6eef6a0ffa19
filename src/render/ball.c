// SPDX-License-Identifier: MIT
// Lights that are balls. From outside only a cap is seen; points spread over the whole ball would waste half
// of the samples, and most of those near the rim. The directions that meet the ball of radius r at distance d
// are a cone with sin θ = r/d, which is sampled uniformly: density 1/(2π(1 − cos θ)) per solid angle (PBR 4th
// ed. §6.2.4).
//
// The point itself: for a direction θ off the axis the near crossing is seen from the ball's centre under the
// angle α,
//     cos α = sin²θ/sin θ_max + cos θ √(1 − sin²θ/sin²θ_max).
#include "area.h"

#include "quick.h"

bool sagi_ball_find(sag_shape_kind kind, const void *shape, const sag_affine *place, uint32_t primitive,
                    sagi_ball *ball) {
    if (kind == SAG_SHAPE_SPHERE) {
        const sag_sphere *sphere = shape;
        bool clipped = sphere->z_min > -sphere->radius || sphere->z_max < sphere->radius;
        if (sphere->z_min == 0 && sphere->z_max == 0) clipped = false;
        if (clipped || (sphere->phi_max_rad > 0 && sphere->phi_max_rad < 6.283185)) return false;
        *ball = (sagi_ball){sphere->center, sphere->radius};
    } else if (kind == SAG_SHAPE_SPHERES) {
        const sag_spheres *set = shape;
        size_t i = 3 * (size_t)primitive;
        ball->center =
            set->centers_f64
                ? sag_vec3_make(set->centers_f64[i], set->centers_f64[i + 1], set->centers_f64[i + 2])
                : sag_vec3_make(set->centers_f32[i], set->centers_f32[i + 1], set->centers_f32[i + 2]);
        ball->radius = set->radii_f32 ? set->radii_f32[primitive] : set->radius;
    } else {
        return false;
    }
    // A similarity keeps it a ball: columns of one length, perpendicular.
    sag_vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; i++) axes[i] = sag_affine_vector(place, axes[i]);
    double scale2 = sag_dot(axes[0], axes[0]), tolerance = 1e-12 * scale2;
    for (int i = 0; i < 3; i++) {
        if (!(fabs(sag_dot(axes[i], axes[i]) - scale2) <= tolerance)) return false;
        if (!(fabs(sag_dot(axes[i], axes[(i + 1) % 3])) <= tolerance)) return false;
    }
    ball->center = sag_affine_point(place, ball->center);
    ball->radius *= sqrt(scale2);
    return ball->radius > 0 && isfinite(ball->radius) && sag_is_finite(ball->center);
}

double sagi_ball_cone(const sagi_ball *ball, sag_vec3 from) {
    sag_vec3 d = sag_sub(ball->center, from);
    double sin2 = sagi_square(ball->radius) / sag_dot(d, d);
    // Very near the surface the cone is a half space and tells little: the area is sampled there.
    if (!(sin2 < 0.9999)) return 0;
    return sin2 / (1 + sqrt(1 - sin2)); // 1 − cos without cancellation
}

void sagi_ball_sample(const sagi_ball *ball, sag_vec3 from, double cone, sag_vec2 u, sag_surface *surface) {
    sag_vec3 axis = sag_sub(from, ball->center), s, t;
    double sin2_max = sagi_square(ball->radius) / sag_dot(axis, axis);
    double rise = u.x * cone, sin2 = rise * (2 - rise); // of 1 − cos θ
    double rest = sqrt(fmax(0, 1 - sin2 / sin2_max));
    double cos_a = sagi_clamp(sin2 / sqrt(sin2_max) + (1 - rise) * rest, -1, 1);
    double sin_a = sqrt(1 - cos_a * cos_a), sin_phi, cos_phi;
    sagi_quick_turn(u.y, &sin_phi, &cos_phi);
    axis = sag_normalize(axis);
    sag_frame(axis, &s, &t);
    sag_vec3 n = sag_add(sag_scale(axis, cos_a),
                         sag_add(sag_scale(s, sin_a * cos_phi), sag_scale(t, sin_a * sin_phi)));
    *surface = (sag_surface){
        .position = sag_madd(ball->center, ball->radius, n), .geometric_normal = n, .shading_normal = n};
    // n is a unit to 8 roundings, and its product and the sum add 2: far within 2⁻⁴⁸ of the sizes that go in.
    sag_vec3 size = sag_abs(ball->center);
    surface->position_error =
        sag_vec3_make((size.x + ball->radius) * 0x1p-48, (size.y + ball->radius) * 0x1p-48,
                      (size.z + ball->radius) * 0x1p-48);
}
