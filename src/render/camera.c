// SPDX-License-Identifier: MIT
// Cameras, with pbrt-v4's conventions: camera space is left-handed, x right, y up, looking along z.
//
// Perspective: the film stands at z = 1, its shorter side 2 tan(fov/2) long. With a lens, all rays through a
// film point meet where the pinhole's ray pierces the plane of focus z = f: the point that is seen sharp.
// So also orthographic (where pbrt lets all rays start on one lens in the middle of the film, and thus makes
// a perspective picture of it). Environment: longitude runs 0 … 2π from left to right, starting at +x and
// turning towards +z; the polar angle 0 … π from top to bottom, from +y. Equal area: Clarberg's map
// (warp.c), whose middle is +y and whose rim is −y; what filters reach beyond the rim is folded back.
#include "camera.h"

#include "math/elementary.h"
#include "math/map.h"
#include "warp.h"

sag_affine sag_camera_look_at(sag_vec3 eye, sag_vec3 target, sag_vec3 up) {
    sag_vec3 z = sag_normalize(sag_sub(target, eye));
    if (z.x == 0 && z.y == 0 && z.z == 0) z.z = 1;
    sag_vec3 right = sag_cross(z, sag_normalize(up)), other;
    if (right.x == 0 && right.y == 0 && right.z == 0) sag_frame(z, &right, &other);
    right = sag_normalize(right);
    return sag_affine_from_columns(right, sag_cross(right, z), z, eye);
}

sag_status sagi_camera_init(sagi_camera *camera, const sag_camera *description, uint32_t width,
                            uint32_t height, sag_error *error) {
    if (width == 0 || height == 0 || width > SAG_MAX_IMAGE_SIZE || height > SAG_MAX_IMAGE_SIZE)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "film size %ux%u is not within 1 to %u", width,
                             height, SAG_MAX_IMAGE_SIZE);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!isfinite(description->to_world.m[i][j]))
                return sag_error_set(error, SAG_ERROR_ARGUMENT, "the camera's to_world is not finite");
    double fov = description->fov_rad == 0 ? SAGI_RENDER_PI / 2 : description->fov_rad;
    if (description->kind == SAG_CAMERA_PERSPECTIVE && !(fov > 0 && fov < SAGI_RENDER_PI))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "the camera's fov of %g rad is not within (0, pi)",
                             fov);
    *camera = (sagi_camera){.camera = *description, .width = width, .height = height};
    double aspect = (double)width / height;
    const double *window = description->screen_window;
    double x_min = window[0], x_max = window[1], y_min = window[2], y_max = window[3];
    if (x_min == x_max || y_min == y_max) {
        x_max = aspect > 1 ? aspect : 1;
        y_max = aspect > 1 ? 1 : 1 / aspect;
        x_min = -x_max;
        y_min = -y_max;
    }
    double scale = description->kind == SAG_CAMERA_PERSPECTIVE ? sagi_tan(fov / 2) : 1;
    camera->x_min = x_min * scale;
    camera->y_max = y_max * scale;
    camera->x_per_pixel = (x_max - x_min) * scale / width;
    camera->y_per_pixel = (y_max - y_min) * scale / height;
    camera->pinhole = description->kind == SAG_CAMERA_PERSPECTIVE && !sagi_camera_has_lens(camera);
    camera->eye = sag_affine_point(&description->to_world, (sag_vec3){0, 0, 0});
    camera->forward = sag_normalize(sag_affine_vector(&description->to_world, (sag_vec3){0, 0, 1}));
    if (!sag_affine_inverse(&description->to_world, &camera->from_world))
        camera->from_world = sag_affine_identity();
    return SAG_OK;
}

bool sagi_camera_has_lens(const sagi_camera *camera) {
    const sag_camera_kind kind = camera->camera.kind;
    return camera->camera.lens_radius > 0 &&
           (kind == SAG_CAMERA_PERSPECTIVE || kind == SAG_CAMERA_ORTHOGRAPHIC);
}

static sag_vec3 environment_direction(const sagi_camera *camera, double x, double y) {
    double theta = SAGI_RENDER_PI * y / camera->height, phi = 2 * SAGI_RENDER_PI * x / camera->width;
    double sin_theta, cos_theta, sin_phi, cos_phi;
    sagi_sincos(theta, &sin_theta, &cos_theta);
    sagi_sincos(phi, &sin_phi, &cos_phi);
    return sag_vec3_make(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi);
}

// The map's edges are each folded in its middle: past an edge one comes in again, mirrored, on the same edge.
static sag_vec3 equal_area_direction(const sagi_camera *camera, double x, double y) {
    double u = x / camera->width, v = y / camera->height;
    if (u < 0 || u > 1) u = u < 0 ? -u : 2 - u, v = 1 - v;
    if (v < 0 || v > 1) v = v < 0 ? -v : 2 - v, u = 1 - u;
    u = fmin(fmax(u, 0), 1), v = fmin(fmax(v, 0), 1); // a filter wider than the film
    const sag_vec3 d = sagi_equal_area_to_sphere((sag_vec2){u, v});
    return sag_vec3_make(d.x, d.z, d.y);
}

sag_ray sagi_camera_ray(const sagi_camera *camera, double x, double y, sag_vec2 lens) {
    sag_vec3 on_film =
        sag_vec3_make(camera->x_min + x * camera->x_per_pixel, camera->y_max - y * camera->y_per_pixel, 0);
    sag_vec3 origin = {0, 0, 0}, direction = {0, 0, 1};
    switch (camera->camera.kind) {
    case SAG_CAMERA_PERSPECTIVE: direction = sag_vec3_make(on_film.x, on_film.y, 1); break;
    case SAG_CAMERA_ORTHOGRAPHIC: origin = on_film; break;
    case SAG_CAMERA_ENVIRONMENT: direction = environment_direction(camera, x, y); break;
    case SAG_CAMERA_EQUAL_AREA: direction = equal_area_direction(camera, x, y); break;
    }
    if (sagi_camera_has_lens(camera)) {
        sag_vec2 disk = sagi_warp_disk(lens);
        sag_vec3 offset =
            sag_vec3_make(disk.x * camera->camera.lens_radius, disk.y * camera->camera.lens_radius, 0);
        double focus = camera->camera.focal_distance;
        // direction.z is 1: the sharp point is origin + focus·direction.
        if (focus > 0 && isfinite(focus)) direction = sag_madd(direction, -1 / focus, offset);
        origin = sag_add(origin, offset);
    }
    const sag_affine *to_world = &camera->camera.to_world;
    return (sag_ray){.origin = sagi_affine_point(to_world, origin),
                     .direction = sagi_normalize(sagi_affine_vector(to_world, direction)),
                     .t_max = INFINITY};
}
