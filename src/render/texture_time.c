// SPDX-License-Identifier: MIT
// How long textures take. They are looked up in the middle of shading, a hundred nanoseconds at a time, and
// a clock takes a fifth of that: timing each would cost more than it tells. So of every SAGI_TIMED_HITS hits
// one is looked at beforehand, textures alone, with the clock running; the time of reading the clock is known
// from reading it twice. What this finds in the memory, the shading that follows finds in the cache: nothing
// is fetched twice. No random number is touched, nothing is written: the picture is the same.
#include "bump.h"
#include "job.h"

static bool has_textures(const sag_material *m, const sagi_appearance *look) {
    return m->reflectance.texture || m->transmittance.texture || m->eta.texture || m->k.texture ||
           m->coat_albedo.texture || m->roughness_u.texture || m->roughness_v.texture ||
           m->coat_roughness_u.texture || m->coat_roughness_v.texture || m->thickness.texture ||
           m->coat_g.texture || m->amount.texture || m->displacement.texture || m->normal_map ||
           look->look.emission_texture || look->look.alpha.texture;
}

// Looks up all that shading would; what comes of it is asked for, so that it is worked out.
static double look_up(const sag_world *world, const sagi_material *entry, const sagi_appearance *look,
                      const sag_surface *surface, const sagi_footprint *footprint, sagi_spectrum lambda) {
    const sag_material *m = &entry->material;
    sagi_spot at;
    sagi_spot_at(&at, surface);
    if (entry->wants_footprint) sagi_footprint_at(footprint, surface->dpdu, surface->dpdv, &at);
    const sag_input emission = {.texture = look->look.emission_texture};
    const sag_input *const colors[] = {&m->reflectance, &m->transmittance, &m->eta, &m->k, &m->coat_albedo};
    const sag_input *const numbers[] = {&m->roughness_u,      &m->roughness_v,  &m->coat_roughness_u,
                                        &m->coat_roughness_v, &m->thickness,    &m->coat_g,
                                        &m->amount,           &look->look.alpha};
    const sagi_color none = {.scale = 0};
    double sum = 0;
    for (size_t i = 0; i < sizeof colors / sizeof *colors; i++)
        if (colors[i]->texture)
            sum += (double)sagi_input_spectrum(world, colors[i], &none, SAGI_RGB_ALBEDO, &at, lambda)[0];
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (numbers[i]->texture) sum += sagi_input_number(world, numbers[i], &at);
    if (emission.texture) sum += sagi_input_rgb(world, &emission, &at).r;
    const sagi_mipmap *normals = sagi_world_picture(world, m->normal_map);
    if (normals)
        sum += sagi_mapped_frame(normals, surface, &at).normal.x;
    else if (m->displacement.texture)
        sum += sagi_bumped_frame(world, &m->displacement, surface, NULL, &at).normal.x;
    return sum;
}

void sagi_time_textures(sagi_wave *wave, const sagi_path *path, const sag_ray *ray, const sag_hit *hit) {
    const sag_render *render = wave->render;
    const sag_world *world = render->world;
    if (hit->geometry == SAG_INVALID_ID) return;
    sag_surface surface;
    sag_surface_at(render->scene, ray, hit, &surface);
    const sagi_appearance *look = sagi_appearance_of(world, &surface);
    if (!look || look->look.material == 0) return;
    const sagi_material *materials = world->materials.items, *entry = &materials[look->look.material - 1];
    for (uint64_t which = wave->hits_seen / SAGI_TIMED_HITS; entry->material.kind == SAG_MATERIAL_MIX;
         which /= 2)
        entry = &materials[entry->material.materials[which & 1] - 1]; // each about as often
    if (!has_textures(&entry->material, look)) return;
    sagi_replace_texcoords(look, &surface);
    sagi_orient(look, &surface);
    const double first = sagi_clock_seconds(), second = sagi_clock_seconds();
    const double sum = look_up(world, entry, look, &surface, &render->footprint, path->wavelengths.lambda);
    const double seconds = sagi_clock_seconds() - second - (second - first);
    if (seconds > 0 && sum > -INFINITY) wave->texture_seconds += seconds * SAGI_TIMED_HITS;
}
