// SPDX-License-Identifier: MIT
// Lights at infinity in all directions: constant, sky, and a picture of the surroundings.
//
// The smooth ones are sampled as the surface receives them: with the cosine's density around its normal (or
// uniformly over the sphere where light may also come through). A picture is sampled by the brightness of its
// texels, which the equal-area mapping gives all the same solid angle 4π/n: the density of a direction is its
// texel's probability times n/4π.
#include "light.h"
#include "warp.h"

#define MAX_PICTURE_SIZE 32768u // its texels are counted in 32 bits

static bool has_picture(const sagi_light *light) { return light->light.image.pixels != NULL; }

static sag_rgb texel_value(const sag_image *image, size_t index) {
    const float *p = image->pixels + index * image->channels;
    return image->channels < 3 ? sagi_rgb_grey(p[0]) : sagi_rgb(p[0], p[1], p[2]);
}

sag_status sagi_sky_init(sagi_light *light, const sag_context *context, sag_error *error) {
    if (!has_picture(light)) return SAG_OK;
    const sag_image *image = &light->light.image;
    if (image->width != image->height)
        return sag_error_set(error, SAG_ERROR_ARGUMENT,
                             "an infinite light's picture must be square, not %ux%u", image->width,
                             image->height);
    if (image->width > MAX_PICTURE_SIZE)
        return sag_error_set(error, SAG_ERROR_ARGUMENT,
                             "an infinite light's picture is at most %u pixels wide", MAX_PICTURE_SIZE);
    light->placed = false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) light->placed |= light->light.to_world.m[i][j] != 0;
    if (!light->placed) light->light.to_world = sag_affine_identity();
    // Directions only: where the picture is placed does not matter.
    for (int i = 0; i < 3; i++) light->light.to_world.m[i][3] = 0;
    if (!sag_affine_inverse(&light->light.to_world, &light->from_world))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "an infinite light's to_world is singular");
    uint32_t count = image->width * image->height;
    double *weights = sag_allocate(context, count * sizeof *weights);
    if (!weights) return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
    for (uint32_t i = 0; i < count; i++) {
        double brightness = sagi_rgb_mean(texel_value(image, i));
        weights[i] = brightness > 0 && isfinite(brightness) ? brightness : 0;
    }
    bool made = sagi_alias_init(&light->texels, context, weights, count);
    sag_release(context, weights, count * sizeof *weights);
    return made ? SAG_OK : sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
}

// The texel in direction wi; 0 ≤ index < width².
static size_t texel_at(const sagi_light *light, sag_vec3 wi) {
    sag_vec2 p = sagi_equal_area_from_sphere(sag_normalize(sag_affine_vector(&light->from_world, wi)));
    uint32_t n = light->light.image.width;
    double x = sagi_clamp(p.x * n, 0, n - 1.0), y = sagi_clamp(p.y * n, 0, n - 1.0);
    return (size_t)y * n + (size_t)x;
}

sagi_spectrum sagi_sky_radiance(const sagi_light *light, sag_vec3 wi, sagi_spectrum lambda) {
    if (light->light.kind == SAG_LIGHT_SKY) {
        double height = sagi_clamp(wi.y, 0, 1);
        return sagi_color_at(&light->horizon, lambda) * (float)(1 - height) +
               sagi_color_at(&light->color, lambda) * (float)height;
    }
    if (!has_picture(light)) return sagi_color_at(&light->color, lambda);
    const sag_rgb texel = texel_value(&light->light.image, texel_at(light, wi));
    const sag_color_space space = light->light.image.color_space;
    if (light->light.spectrum) {
        const sagi_color filter = sagi_color_of_texel(space, texel, SAGI_RGB_UNBOUNDED);
        return sagi_color_at(&light->color, lambda) * sagi_color_at(&filter, lambda);
    }
    const sagi_color shown =
        sagi_color_of_texel(space, sagi_rgb_mul(light->light.color, texel), SAGI_RGB_ILLUMINANT);
    return sagi_color_at(&shown, lambda);
}

double sagi_sky_pdf(const sagi_light *light, const sagi_shading_point *from, sag_vec3 wi) {
    if (has_picture(light)) {
        if (light->texels.count == 0) return 0;
        double probability = light->texels.entries[texel_at(light, wi)].probability;
        return probability * light->texels.count / (4 * SAGI_RENDER_PI);
    }
    if (!from->reflects_only) return 1 / (4 * SAGI_RENDER_PI);
    return fmax(0, sag_dot(from->normal, wi)) * SAGI_INV_PI;
}

bool sagi_sky_sample(const sagi_light *light, const sagi_shading_point *from, sag_vec2 u, sag_vec3 *wi) {
    if (has_picture(light)) {
        if (light->texels.count == 0) return false;
        double inside_x;
        uint32_t n = light->light.image.width;
        uint32_t index = sagi_alias_sample(&light->texels, u.x, &inside_x);
        uint32_t row = index / n;
        sag_vec2 p = {(index % n + inside_x) / n, (row + u.y) / n};
        *wi = sag_normalize(sag_affine_vector(&light->light.to_world, sagi_equal_area_to_sphere(p)));
        return true;
    }
    if (!from->reflects_only) {
        *wi = sagi_warp_sphere(u);
        return true;
    }
    sag_vec3 s, t, local = sagi_warp_cosine(u);
    sag_frame(from->normal, &s, &t);
    *wi = sag_madd(sag_madd(sag_scale(s, local.x), local.y, t), local.z, from->normal);
    return local.z > 0;
}
