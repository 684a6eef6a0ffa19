// SPDX-License-Identifier: MIT
// Where a point of the scene appears in the picture, and how large.
//
// A pixel is the mean of radiance over its part of the film (weighted by the filter). So what a particle
// brings to the camera counts as much as film belongs to the surface around its point: with w the way from
// the point of the lens to it, in the camera's space, a small piece dS of the film's image covers, at z = 1,
//
//     perspective     dA = |w · dS|/z³                    orthographic    dA = |w · dS|, w.z = 1
//     environment     dω = |w · dS|/|w|³, dA = dω/sin θ   equal area      dA = dω
//
// which a lens does not change: at a fixed point of it the camera is a sheared pinhole. A map M to the world
// takes w·dS to (M w)·dS'/|det M|, where dS' is the piece as it stands in the world: nothing but M's
// determinant is needed, also where it is no rigid motion. All in pixels, by the area of one.
#include "particle.h"

#include "math/elementary.h"
#include "warp.h"

static double all_round(const sagi_camera *camera, sag_vec3 w, sagi_view *view) {
    const double length = sag_length(w), pixels = camera->width * camera->height;
    const sag_vec3 d = sag_scale(w, 1 / length);
    const double cube = length * length * length;
    if (camera->camera.kind == SAG_CAMERA_EQUAL_AREA) {
        const sag_vec2 p = sagi_equal_area_from_sphere(sag_vec3_make(d.x, d.z, d.y));
        view->film = (sag_vec2){p.x * camera->width, p.y * camera->height};
        return pixels / (4 * SAGI_RENDER_PI * cube);
    }
    double phi = sagi_atan2(d.z, d.x);
    if (phi < 0) phi += 2 * SAGI_RENDER_PI;
    const double theta = sagi_acos(fmin(fmax(d.y, -1), 1)), sine = sqrt(d.x * d.x + d.z * d.z);
    view->film =
        (sag_vec2){phi / (2 * SAGI_RENDER_PI) * camera->width, theta / SAGI_RENDER_PI * camera->height};
    return pixels / (2 * SAGI_RENDER_PI * SAGI_RENDER_PI * sine * cube);
}

bool sagi_camera_connect(const sagi_camera *camera, sag_vec3 point, sag_vec2 lens, sagi_view *view) {
    const sag_affine *to_world = &camera->camera.to_world;
    const sag_camera_kind kind = camera->camera.kind;
    const sag_vec3 p = sag_affine_point(&camera->from_world, point);
    const double focus = camera->camera.focal_distance;
    const bool focused = focus > 0 && isfinite(focus);
    sag_vec3 offset = {0, 0, 0};
    if (sagi_camera_has_lens(camera)) {
        const sag_vec2 disk = sagi_warp_disk(lens);
        offset = sag_vec3_make(disk.x * camera->camera.lens_radius, disk.y * camera->camera.lens_radius, 0);
    }
    sag_vec3 from = offset, w;
    double importance;
    if (kind == SAG_CAMERA_ENVIRONMENT || kind == SAG_CAMERA_EQUAL_AREA) {
        w = p;
        importance = all_round(camera, w, view);
    } else {
        if (!(p.z > 0)) return false;
        double x, y;
        if (kind == SAG_CAMERA_PERSPECTIVE) {
            w = sag_sub(p, offset);
            x = w.x / w.z, y = w.y / w.z;
            if (focused) x += offset.x / focus, y += offset.y / focus;
            importance = 1 / (w.z * w.z * w.z);
        } else {
            w = sag_vec3_make(0, 0, 1);
            if (focused) w = sag_madd(w, -1 / focus, offset);
            from = sag_madd(p, -p.z, w);
            x = from.x - offset.x, y = from.y - offset.y;
            importance = 1;
        }
        view->film =
            (sag_vec2){(x - camera->x_min) / camera->x_per_pixel, (camera->y_max - y) / camera->y_per_pixel};
        importance /= fabs(camera->x_per_pixel * camera->y_per_pixel);
    }
    view->from = sag_affine_point(to_world, from);
    const sag_vec3 way = sag_affine_vector(to_world, w);
    view->wi = sag_neg(sag_normalize(way));
    view->importance = importance * sag_length(way) / fabs(sag_affine_determinant(to_world));
    return view->importance > 0 && isfinite(view->importance);
}
