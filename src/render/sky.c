// SPDX-License-Identifier: MIT
// Lights at infinity in all directions: constant, sky, and a picture of the surroundings.
//
// The smooth ones are sampled as the surface receives them: with the cosine's density around its normal (or
// uniformly over the sphere where light may also come through). A picture is sampled by the brightness of its
// texels, which the equal-area mapping gives all the same solid angle: the density of a direction is that of
// its point in the unit square by 4π. With multiple importance sampling the mean brightness is first taken
// off (Karlík et al., "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling",
// 2019): what is left is what surfaces' own samples are unlikely to find.
//
// A direction that is drawn is of the texel it was drawn from, so neither its light nor its density is looked
// up by the direction again. (At a texel's edge rounding may take the direction to the next one; that is one
// sample in 2^40.) What spectrum stands for each texel's colour is worked out once, unless they are very
// many.
#include "light.h"
#include "math/map.h"
#include "warp.h"

#define MAX_PICTURE_SIZE 32768u     // its texels are counted in 32 bits
#define MOST_TEXELS      (1u << 22) // that are made ready: 64 MiB

static bool has_picture(const sagi_light *light) { return light->light.image.pixels != NULL; }

sag_status sagi_light_place(sagi_light *light, sag_error *error) {
    sag_affine *place = &light->light.to_world;
    bool placed = false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) placed |= place->m[i][j] != 0;
    if (!placed) *place = sag_affine_identity();
    // Directions only: where the picture is placed does not matter.
    for (int i = 0; i < 3; i++) place->m[i][3] = 0;
    if (sag_affine_inverse(place, &light->from_world)) return SAG_OK;
    return sag_error_set(error, SAG_ERROR_ARGUMENT, "the to_world of a light with a picture is singular");
}

static bool make_table(sagi_light *light, const sag_context *context, bool compensated) {
    const sag_image *image = &light->light.image;
    const size_t count = (size_t)image->width * image->height;
    double *weights = sag_allocate(context, count * sizeof *weights), sum = 0, left = 0;
    if (!weights) return false;
    for (size_t i = 0; i < count; i++) {
        const double brightness = sagi_rgb_mean(sagi_picture_texel(image, i));
        weights[i] = brightness > 0 && isfinite(brightness) ? brightness : 0;
        sum += weights[i];
    }
    const double mean = compensated ? sum / (double)count : 0;
    for (size_t i = 0; i < count; i++) left += fmax(weights[i] - mean, 0);
    for (size_t i = 0; i < count; i++) weights[i] = left > 0 ? fmax(weights[i] - mean, 0) : 1; // (all alike)
    const bool made = sagi_window_table_init(&light->table, context, weights, image->width, image->height) &&
                      sagi_window_table_guide(&light->table, context);
    sag_release(context, weights, count * sizeof *weights);
    return made;
}

// The light of a texel's colour, apart from the light's own spectrum.
static sagi_color texel_color(const sagi_light *light, sag_rgb texel) {
    const sag_color_space space = light->light.image.color_space;
    if (light->light.spectrum) return sagi_color_of_texel(space, texel, SAGI_RGB_UNBOUNDED);
    return sagi_color_of_texel(space, sagi_rgb_mul(light->light.color, texel), SAGI_RGB_ILLUMINANT);
}

static bool make_texels(sagi_light *light, const sag_context *context) {
    const sag_image *image = &light->light.image;
    const size_t count = (size_t)image->width * image->height;
    if (count > MOST_TEXELS) return true;
    light->texels = sag_allocate(context, count * sizeof *light->texels);
    if (!light->texels) return false;
    light->texel_count = count;
    for (size_t i = 0; i < count; i++) {
        const sagi_color color = texel_color(light, sagi_picture_texel(image, i));
        light->texels[i] =
            (sagi_glow){color.scale, {color.c[0], color.c[1], color.curved ? color.c[2] : INFINITY}};
    }
    return true;
}

sag_status sagi_sky_init(sagi_light *light, const sag_context *context, bool compensated, sag_error *error) {
    const sag_image *image = &light->light.image;
    if (image->pixels && image->width != image->height)
        return sag_error_set(error, SAG_ERROR_ARGUMENT,
                             "an infinite light's picture must be square, not %ux%u", image->width,
                             image->height);
    if (image->width > MAX_PICTURE_SIZE)
        return sag_error_set(error, SAG_ERROR_ARGUMENT,
                             "an infinite light's picture is at most %u pixels wide", MAX_PICTURE_SIZE);
    const sag_status status = sagi_light_place(light, error);
    if (status != SAG_OK) return status;
    bool made = true;
    if (light->light.has_portal) {
        if (!sagi_portal_is_rectangle(light->light.portal))
            return sag_error_set(error, SAG_ERROR_ARGUMENT, "an infinite light's portal is no rectangle");
        made = sagi_portal_init(&light->portal, context, light->light.portal, image, &light->from_world);
    } else if (has_picture(light)) {
        made = make_table(light, context, compensated) && make_texels(light, context);
    }
    return made ? SAG_OK : sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
}

void sagi_sky_clear(sagi_light *light, const sag_context *context) {
    sag_release(context, light->texels, light->texel_count * sizeof *light->texels);
    sagi_window_table_clear(&light->table, context);
    sagi_portal_clear(&light->portal, context);
}

// The texel in direction wi; 0 ≤ index < width².
static size_t texel_at(const sagi_light *light, sag_vec3 wi) {
    const sag_vec2 p =
        sagi_equal_area_from_sphere(sagi_normalize(sagi_affine_vector(&light->from_world, wi)));
    uint32_t n = light->light.image.width;
    double x = sagi_clamp(p.x * n, 0, n - 1.0), y = sagi_clamp(p.y * n, 0, n - 1.0);
    return (size_t)y * n + (size_t)x;
}

sagi_spectrum sagi_light_through(const sagi_light *light, sag_rgb texel, sagi_spectrum lambda) {
    const sagi_color shown = texel_color(light, texel);
    const sagi_spectrum value = sagi_color_at(&shown, lambda);
    return light->light.spectrum ? value * sagi_color_at(&light->color, lambda) : value;
}

// The light of a texel of the picture.
static sagi_spectrum texel_light(const sagi_light *light, size_t index, sagi_spectrum lambda) {
    if (!light->texels)
        return sagi_light_through(light, sagi_picture_texel(&light->light.image, index), lambda);
    const sagi_glow *texel = &light->texels[index];
    sagi_spectrum value = sagi_spectrum_all((double)texel->scale);
    if (texel->c[2] < INFINITY) value *= sagi_curve_at(texel->c, lambda);
    if (light->light.spectrum) return value * sagi_color_at(&light->color, lambda);
    return value * sagi_table_at(sagi_color_spaces[light->light.image.color_space].illuminant, lambda);
}

sagi_spectrum sagi_sky_radiance(const sagi_light *light, sag_vec3 from, sag_vec3 wi, sagi_spectrum lambda) {
    if (light->light.kind == SAG_LIGHT_SKY) {
        double height = sagi_clamp(wi.y, 0, 1);
        return sagi_color_at(&light->horizon, lambda) * (float)(1 - height) +
               sagi_color_at(&light->color, lambda) * (float)height;
    }
    if (light->light.has_portal) {
        sag_rgb texel;
        if (!sagi_portal_look(&light->portal, from, wi, &texel)) return (sagi_spectrum){0, 0, 0, 0};
        if (has_picture(light)) return sagi_light_through(light, texel, lambda);
        return sagi_color_at(&light->color, lambda);
    }
    if (!has_picture(light)) return sagi_color_at(&light->color, lambda);
    return texel_light(light, texel_at(light, wi), lambda);
}

double sagi_sky_pdf(const sagi_light *light, const sagi_shading_point *from, sag_vec3 wi) {
    if (light->light.has_portal) return sagi_portal_pdf(&light->portal, from->position, wi);
    if (has_picture(light))
        return sagi_window_pdf_whole(&light->table, texel_at(light, wi)) / (4 * SAGI_RENDER_PI);
    if (!from->reflects_only) return 1 / (4 * SAGI_RENDER_PI);
    const double cosine = sag_dot(from->normal, wi);
    return cosine > 0 ? cosine * SAGI_INV_PI : 0;
}

sagi_spectrum sagi_sky_look(const sagi_light *light, const sagi_shading_point *from, sag_vec3 origin,
                            sag_vec3 wi, sagi_spectrum lambda, double *pdf) {
    *pdf = 0;
    if (has_picture(light) && !light->light.has_portal) {
        const size_t texel = texel_at(light, wi);
        if (from) *pdf = sagi_window_pdf_whole(&light->table, texel) / (4 * SAGI_RENDER_PI);
        return texel_light(light, texel, lambda);
    }
    if (from) *pdf = sagi_sky_pdf(light, from, wi);
    return sagi_sky_radiance(light, origin, wi, lambda);
}

bool sagi_sky_sample(const sagi_light *light, const sagi_shading_point *from, sag_vec2 u,
                     sagi_spectrum lambda, sag_vec3 *wi, double *pdf, sagi_spectrum *radiance) {
    if (has_picture(light) && !light->light.has_portal) {
        sag_vec2 p;
        size_t texel;
        if (!sagi_window_sample_whole(&light->table, u, &p, pdf, &texel)) return false;
        *wi = sagi_normalize(sagi_affine_vector(&light->light.to_world, sagi_equal_area_to_sphere(p)));
        *pdf /= 4 * SAGI_RENDER_PI;
        *radiance = texel_light(light, texel, lambda);
        return *pdf > 0;
    }
    if (light->light.has_portal) {
        if (!sagi_portal_sample(&light->portal, from->position, u, wi)) return false;
    } else if (!from->reflects_only) {
        *wi = sagi_warp_sphere(u);
    } else {
        sag_vec3 s, t, local = sagi_warp_cosine(u);
        sag_frame(from->normal, &s, &t);
        *wi = sag_madd(sag_madd(sag_scale(s, local.x), local.y, t), local.z, from->normal);
        if (!(local.z > 0)) return false;
    }
    *pdf = sagi_sky_pdf(light, from, *wi);
    *radiance = sagi_sky_radiance(light, from->position, *wi, lambda);
    return *pdf > 0;
}
