// SPDX-License-Identifier: MIT
// What shining surfaces send out, and which parts of a surface are there at all.
#include "light.h"

#include "math/hash.h"

#define MEAN_SIDE 32 // points a side for the mean of a texture

// How bright a texture is on average over the unit square.
static double texture_mean(const sag_world *world, sag_texture_id texture) {
    const sag_input input = {.texture = texture};
    double sum = 0;
    for (int i = 0; i < MEAN_SIDE * MEAN_SIDE; i++) {
        const sagi_spot at = {.u = (i % MEAN_SIDE + 0.5) / MEAN_SIDE,
                              .v = (i / MEAN_SIDE + 0.5) / MEAN_SIDE,
                              .normal = {0, 0, 1}};
        const double brightness = sagi_rgb_mean(sagi_input_rgb(world, &input, &at));
        if (brightness > 0 && isfinite(brightness)) sum += brightness;
    }
    return sum / (MEAN_SIDE * MEAN_SIDE);
}

void sagi_emission_init(const sag_world *world, sagi_appearance *entry) {
    const sag_appearance *look = &entry->look;
    const sagi_spectrum_entry *spectrum = sagi_spectrum_of(world, look->emission_spectrum);
    if (spectrum) {
        entry->emission = spectrum->color;
        entry->emission.scale = (float)((double)spectrum->color.scale * look->emission_scale);
        entry->brightness = spectrum->brightness * look->emission_scale;
    } else {
        entry->emission = sagi_color_of_rgb(SAG_COLOR_SRGB, look->emission, SAGI_RGB_ILLUMINANT);
        entry->brightness = sagi_rgb_mean(look->emission);
    }
    if (look->emission_texture == 0 || !(entry->brightness > 0)) return;
    // (A picture that is dark in most places may still shine between the points that were looked at.)
    entry->brightness *= fmax(texture_mean(world, look->emission_texture), 1e-6);
}

// The emission times a texel's colour: light of that colour or, where the emission has a spectrum, a filter.
static sagi_spectrum textured(const sagi_appearance *entry, const sag_surface *surface,
                              sagi_spectrum lambda) {
    const sag_input input = {.texture = entry->look.emission_texture};
    sagi_spot at;
    sagi_spot_at(&at, surface);
    sag_rgb texel = sagi_input_rgb(entry->world, &input, &at);
    if (entry->look.emission_spectrum) {
        const sagi_color filter = sagi_color_of_texel(SAG_COLOR_SRGB, texel, SAGI_RGB_UNBOUNDED);
        return sagi_color_at(&entry->emission, lambda) * sagi_color_at(&filter, lambda);
    }
    texel = sagi_rgb_mul(texel, entry->look.emission);
    const sagi_color shown = sagi_color_of_texel(SAG_COLOR_SRGB, texel, SAGI_RGB_ILLUMINANT);
    return sagi_color_at(&shown, lambda);
}

sagi_spectrum sagi_emission(const sagi_appearance *entry, const sag_surface *surface, sag_vec3 wo,
                            sagi_spectrum lambda) {
    const sagi_spectrum black = {0, 0, 0, 0};
    if (!entry || !(entry->brightness > 0)) return black;
    if (!entry->look.two_sided && !(sag_dot(surface->geometric_normal, wo) > 0)) return black;
    sagi_spectrum emission = entry->look.emission_texture ? textured(entry, surface, lambda)
                                                          : sagi_color_at(&entry->emission, lambda);
    if (entry->look.emission_over_area) {
        const double area = sag_geometry_area(entry->scene, entry->geometry, surface->primitive);
        emission *= area > 0 ? (float)(1 / area) : 0;
    }
    return emission;
}

// A number in [0, 1) of the ray, as good as random: so that what is half there is there for half of the rays,
// the same ones however often and in whatever order they are traced.
static double number_of(const sag_ray *ray) {
    const sagi_fingerprint origin = sagi_fingerprint_of(ray->origin),
                           way = sagi_fingerprint_of(ray->direction);
    return (double)(sagi_mix(origin.part[0] + sagi_mix(way.part[1])) >> 11) * 0x1p-53;
}

bool sagi_alpha_is_there(const sagi_appearance *entry, const sag_surface *surface, const sag_ray *ray) {
    if (entry->look.alpha.texture == 0) return true;
    sagi_spot at;
    sagi_spot_at(&at, surface);
    const double value = sagi_input_number(entry->world, &entry->look.alpha, &at);
    return value >= 1 || (value > 0 && number_of(ray) < value);
}

bool sagi_alpha_is_nowhere(const sagi_appearance *entry) {
    const sag_texture_id id = entry->look.alpha.texture;
    if (id == 0) return false;
    const sag_texture *texture = &((const sagi_texture *)entry->world->textures.items)[id - 1].texture;
    return texture->kind == SAG_TEXTURE_CONSTANT && texture->a.texture == 0 && !(texture->a.value.r > 0);
}
