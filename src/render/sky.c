// SPDX-License-Identifier: MIT
// Lights at infinity in all directions: constant, sky, and a picture of the surroundings.
//
// The smooth ones are sampled as the surface receives them: with the cosine's density around its normal (or
// uniformly over the sphere where light may also come through). A picture is sampled by the brightness of its
// texels, which the equal-area mapping gives all the same solid angle: the density of a direction is that of
// its point in the unit square by 4π. With multiple importance sampling the mean brightness is first taken
// off (Karlík et al., "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling",
// 2019): what is left is what surfaces' own samples are unlikely to find.
#include "light.h"
#include "warp.h"

#define MAX_PICTURE_SIZE 32768u // its texels are counted in 32 bits

static bool has_picture(const sagi_light *light) { return light->light.image.pixels != NULL; }

static const sagi_window whole = {{0, 0}, {1, 1}};

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
    const bool made = sagi_window_table_init(&light->table, context, weights, image->width, image->height);
    sag_release(context, weights, count * sizeof *weights);
    return made;
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
        made = make_table(light, context, compensated);
    }
    return made ? SAG_OK : sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
}

// The point of the picture in direction wi.
static sag_vec2 point_at(const sagi_light *light, sag_vec3 wi) {
    return sagi_equal_area_from_sphere(sag_normalize(sag_affine_vector(&light->from_world, wi)));
}

// Its texel; 0 ≤ index < width².
static size_t texel_at(const sagi_light *light, sag_vec3 wi) {
    const sag_vec2 p = point_at(light, wi);
    uint32_t n = light->light.image.width;
    double x = sagi_clamp(p.x * n, 0, n - 1.0), y = sagi_clamp(p.y * n, 0, n - 1.0);
    return (size_t)y * n + (size_t)x;
}

sagi_spectrum sagi_light_through(const sagi_light *light, sag_rgb texel, sagi_spectrum lambda) {
    const sag_color_space space = light->light.image.color_space;
    if (light->light.spectrum) {
        const sagi_color filter = sagi_color_of_texel(space, texel, SAGI_RGB_UNBOUNDED);
        return sagi_color_at(&light->color, lambda) * sagi_color_at(&filter, lambda);
    }
    const sagi_color shown =
        sagi_color_of_texel(space, sagi_rgb_mul(light->light.color, texel), SAGI_RGB_ILLUMINANT);
    return sagi_color_at(&shown, lambda);
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
    return sagi_light_through(light, sagi_picture_texel(&light->light.image, texel_at(light, wi)), lambda);
}

double sagi_sky_pdf(const sagi_light *light, const sagi_shading_point *from, sag_vec3 wi) {
    if (light->light.has_portal) return sagi_portal_pdf(&light->portal, from->position, wi);
    if (has_picture(light))
        return sagi_window_pdf(&light->table, &whole, point_at(light, wi)) / (4 * SAGI_RENDER_PI);
    if (!from->reflects_only) return 1 / (4 * SAGI_RENDER_PI);
    return fmax(0, sag_dot(from->normal, wi)) * SAGI_INV_PI;
}

bool sagi_sky_sample(const sagi_light *light, const sagi_shading_point *from, sag_vec2 u, sag_vec3 *wi) {
    if (light->light.has_portal) return sagi_portal_sample(&light->portal, from->position, u, wi);
    if (has_picture(light)) {
        sag_vec2 p;
        if (!sagi_window_sample_whole(&light->table, u, &p)) return false;
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
