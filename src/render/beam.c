// SPDX-License-Identifier: MIT
// Lights that shine from a point through a picture: goniometric ones, whose picture has all directions
// (equal-area mapping), and projectors, whose picture stands at distance 1 on the axis z and is as high as 2
// tan(fov/2), or as wide, whichever is less. A projected pixel of area dA is seen under dω = cos³θ dA.
#include "light.h"
#include "math/elementary.h"
#include "warp.h"

static double cube_of_cosine(double x, double y) {
    const double s = 1 + x * x + y * y;
    return 1 / (s * sqrt(s));
}

sag_status sagi_beam_init(sagi_light *light, sag_error *error) {
    const sag_image *image = &light->light.image;
    if (!image->pixels)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "a goniometric or projection light has no picture");
    const bool projects = light->light.kind == SAG_LIGHT_PROJECTION;
    if (!projects && image->width != image->height)
        return sag_error_set(error, SAG_ERROR_ARGUMENT,
                             "a goniometric light's picture must be square, not %ux%u", image->width,
                             image->height);
    const double fov = light->light.fov_rad == 0 ? SAGI_RENDER_PI / 2 : light->light.fov_rad;
    if (!(fov > 0 && fov < SAGI_RENDER_PI))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "a projection light's fov is %g rad", fov);
    const sag_status status = sagi_light_place(light, error);
    if (status != SAG_OK) return status;
    const double opposite = sagi_tan(fov / 2), aspect = (double)image->width / image->height;
    light->screen = (sag_vec2){opposite * fmax(1, aspect), opposite * fmax(1, 1 / aspect)};
    double sum = 0, all = 0;
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) {
            const double brightness = sagi_rgb_mean(sagi_picture_texel(image, (size_t)y * image->width + x));
            const double weight = projects
                                      ? cube_of_cosine((2 * (x + 0.5) / image->width - 1) * light->screen.x,
                                                       (2 * (y + 0.5) / image->height - 1) * light->screen.y)
                                      : 1;
            if (brightness > 0 && isfinite(brightness)) sum += weight * brightness;
            all += weight;
        }
    light->mean = sum / all;
    light->solid_angle = 4 * SAGI_RENDER_PI;
    if (projects)
        light->solid_angle =
            4 * light->screen.x * light->screen.y * all / ((double)image->width * image->height);
    return SAG_OK;
}

sagi_spectrum sagi_beam_intensity(const sagi_light *light, sag_vec3 away, sagi_spectrum lambda) {
    const sag_image *image = &light->light.image;
    const sag_vec3 d = sag_normalize(sag_affine_vector(&light->from_world, away));
    sag_vec2 p;
    if (light->light.kind == SAG_LIGHT_PROJECTION) {
        if (!(d.z > 1e-3)) return (sagi_spectrum){0, 0, 0, 0}; // pbrt-v4's bound
        p = (sag_vec2){(d.x / (d.z * light->screen.x) + 1) / 2, (d.y / (d.z * light->screen.y) + 1) / 2};
        if (!(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1)) return (sagi_spectrum){0, 0, 0, 0};
    } else {
        p = sagi_equal_area_from_sphere(d);
    }
    const double x = sagi_clamp(p.x * image->width, 0, image->width - 1.0),
                 y = sagi_clamp(p.y * image->height, 0, image->height - 1.0);
    const sag_rgb texel = sagi_picture_texel(image, (size_t)y * image->width + (size_t)x);
    if (light->light.kind == SAG_LIGHT_GONIOMETRIC)
        return sagi_color_at(&light->color, lambda) * (float)sagi_rgb_mean(texel);
    return sagi_light_through(light, texel, lambda);
}
