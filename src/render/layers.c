// SPDX-License-Identifier: MIT
// Layers (arbitrary output variables): albedo, normals, depth, position, uv, ids and variance, from the same
// samples as the picture and in the same pass. Each sample's path notes the first surface it meets; with its
// colour that is added to the pixel's sums when the wave is over, in the order of samples, so that nothing
// depends on waves and threads.
//
// Means are over the samples, weighted as the picture's. Albedo counts samples that meet nothing as black;
// position, depth and uv leave them out, as a mean with nothing has no meaning; normals are summed and made
// units. Ids cannot be averaged: each pixel gets those that most of its samples met, by Boyer and Moore's
// majority vote (1981): equal ids add a vote, others take one away, and who has none left is replaced. (Who
// has more than half of all samples always wins.)
#include "job.h"

#include <string.h>

static void keep(float out[3], sag_vec3 v) { out[0] = (float)v.x, out[1] = (float)v.y, out[2] = (float)v.z; }

// A plane's normal goes by the inverse's transpose, here that of to_world.
static sag_vec3 normal_to_camera(const sagi_camera *camera, sag_vec3 n) {
    const double(*m)[4] = camera->camera.to_world.m;
    return sag_normalize(sag_vec3_make(m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z,
                                       m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
                                       m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z));
}

// Instances nest: all of the path counts.
static uint32_t instance_id(const sag_hit *hit) {
    if (hit->instance_depth == 0) return 0;
    uint64_t id = hit->instance_path[0] + UINT64_C(1);
    for (uint32_t i = 1; i < hit->instance_depth; i++)
        id = sagi_mix(id ^ sagi_mix(hit->instance_path[i])) >> 32;
    return (uint32_t)id;
}

void sagi_layers_note(const sag_render *render, const sagi_path *path, const sag_ray *ray,
                      const sagi_meeting *meeting, sagi_first *first) {
    const sag_surface *surface = &meeting->surface;
    const sagi_camera *camera = &render->camera;
    const bool in_camera = render->settings.film.layers_in_camera_space;
    first->met = true;
    const sag_rgb albedo =
        sagi_material_albedo(render->world, meeting->appearance, surface, &render->footprint);
    keep(first->albedo, (sag_vec3){albedo.r, albedo.g, albedo.b});
    sag_vec3 n = surface->geometric_normal, ns = meeting->bsdf.n, p = surface->position;
    if (sag_dot(n, ray->direction) > 0) n = sag_neg(n);
    if (sag_dot(ns, ray->direction) > 0) ns = sag_neg(ns);
    const bool flat =
        camera->camera.kind == SAG_CAMERA_PERSPECTIVE || camera->camera.kind == SAG_CAMERA_ORTHOGRAPHIC;
    first->depth = (float)(flat ? sag_dot(sag_sub(p, camera->eye), camera->forward) : path->distance);
    if (in_camera) {
        p = sag_affine_point(&camera->from_world, p);
        n = normal_to_camera(camera, n);
        ns = normal_to_camera(camera, ns);
    }
    keep(first->normal, n);
    keep(first->shading_normal, ns);
    keep(first->position, p);
    first->uv[0] = (float)surface->u, first->uv[1] = (float)surface->v;
    first->ids[0] = meeting->hit->geometry + 1;
    first->ids[1] = instance_id(meeting->hit);
    first->ids[2] = meeting->appearance ? meeting->appearance->look.material : 0;
}

static void add(float *sum, float weight, const float *value, int count) {
    for (int i = 0; i < count; i++) sum[i] += weight * value[i];
}

static void vote(sagi_layer_pixel *pixel, const uint32_t ids[3]) {
    if (pixel->votes == 0) memcpy(pixel->ids, ids, sizeof pixel->ids);
    if (memcmp(pixel->ids, ids, sizeof pixel->ids) == 0)
        pixel->votes++;
    else
        pixel->votes--;
}

void sagi_layers_add(sag_render *render, const sagi_pixel *at, const sagi_first *first, double weight,
                     sag_rgb value) {
    if (!sagi_rgb_is_finite(value)) return;
    sagi_layer_pixel *pixel = &render->layers[at - render->pixels];
    const float w = (float)weight;
    const double most = render->max_component, largest = sagi_rgb_max(value);
    const double dimmed = largest > most ? most / largest : 1;
    const double measured[3] = {value.r * dimmed, value.g * dimmed, value.b * dimmed};
    double color[3] = {measured[0], measured[1], measured[2]};
    if (sagi_is_spectral(render)) sagi_matrix_apply(render->sensor.output, measured, color);
    for (int i = 0; i < 3; i++) pixel->sum[i] += color[i], pixel->square[i] += color[i] * color[i];
    vote(pixel, first->ids);
    if (!first->met) return;
    pixel->weight += w;
    add(pixel->albedo, w, first->albedo, 3);
    add(pixel->normal, w, first->normal, 3);
    add(pixel->shading_normal, w, first->shading_normal, 3);
    add(pixel->position, w, first->position, 3);
    add(&pixel->depth, w, &first->depth, 1);
    add(pixel->uv, w, first->uv, 2);
}

// The channels of each layer, in the order in which write_pixel gives them.
static const struct {
    sag_layer layer;
    const char *names[6];
} channels[] = {
    {SAG_LAYER_PICTURE, {"R", "G", "B"}},
    {SAG_LAYER_ALBEDO, {"Albedo.R", "Albedo.G", "Albedo.B"}},
    {SAG_LAYER_NORMAL, {"N.X", "N.Y", "N.Z", "Ns.X", "Ns.Y", "Ns.Z"}},
    {SAG_LAYER_DEPTH, {"Z"}},
    {SAG_LAYER_POSITION, {"P.X", "P.Y", "P.Z"}},
    {SAG_LAYER_UV, {"u", "v"}},
    {SAG_LAYER_ID, {"id.geometry", "id.instance", "id.material"}},
    {SAG_LAYER_VARIANCE, {"Variance.R", "Variance.G", "Variance.B"}},
};

static float *give(float *out, const float *value, int count, float scale) {
    for (int i = 0; i < count; i++) *out++ = value[i] * scale;
    return out;
}

static float *give_unit(float *out, const float value[3]) {
    const sag_vec3 unit = sag_normalize(sag_vec3_make((double)value[0], (double)value[1], (double)value[2]));
    keep(out, unit);
    return out + 3;
}

static float *give_layer(const sag_render *render, size_t at, sag_layer layer, float *out) {
    static const sagi_layer_pixel none;
    const sagi_pixel *pixel = &render->pixels[at];
    const sagi_layer_pixel *sums = render->layers ? &render->layers[at] : &none;
    const double weight = sagi_pixel_weight(pixel, render->filter.mean_weight);
    const float scale = pixel->count ? (float)(1 / weight) : 0;
    // Those that met something may weigh next to nothing together, by a filter's negative lobes.
    const bool met = fabsf(sums->weight) > 1e-3F * (float)pixel->count;
    const float met_scale = met ? 1 / sums->weight : 0;
    switch (layer) {
    case SAG_LAYER_PICTURE: {
        const sag_rgb value = sagi_film_value(render, pixel);
        keep(out, (sag_vec3){value.r, value.g, value.b});
        return out + 3;
    }
    case SAG_LAYER_ALBEDO: return give(out, sums->albedo, 3, scale);
    case SAG_LAYER_NORMAL: return give_unit(give_unit(out, sums->normal), sums->shading_normal);
    case SAG_LAYER_DEPTH: return give(out, &sums->depth, 1, met_scale);
    case SAG_LAYER_POSITION: return give(out, sums->position, 3, met_scale);
    case SAG_LAYER_UV: return give(out, sums->uv, 2, met_scale);
    case SAG_LAYER_ID: memcpy(out, sums->ids, sizeof sums->ids); return out + 3;
    case SAG_LAYER_VARIANCE:
        for (int i = 0; i < 3; i++) {
            const double n = pixel->count, mean = n > 0 ? sums->sum[i] / n : 0;
            *out++ = (float)(n > 1 ? fmax(0, sums->square[i] - n * mean * mean) / (n - 1) : 0);
        }
        return out;
    case SAG_LAYER_ALL: break;
    }
    return out;
}

sag_status sag_render_get_layers(const sag_render *render, sag_layers *layers, sag_error *error) {
    sag_layers made = {.width = render->width,
                       .height = render->height,
                       .x = render->first_x,
                       .y = render->first_y,
                       .full_width = render->settings.film.width,
                       .full_height = render->settings.film.height,
                       .color_space =
                           sagi_is_spectral(render) ? render->settings.film.color_space : (sag_color_space)0};
    const uint32_t wanted = render->settings.film.layers | SAG_LAYER_PICTURE;
    const size_t kinds = sizeof channels / sizeof *channels, count = (size_t)made.width * made.height;
    for (size_t k = 0; k < kinds; k++)
        for (int i = 0; i < 6 && (wanted & channels[k].layer) && channels[k].names[i]; i++) {
            made.is_id[made.channel_count] = channels[k].layer == SAG_LAYER_ID;
            made.names[made.channel_count++] = channels[k].names[i];
        }
    made.pixels = sag_allocate(render->context, count * made.channel_count * sizeof *made.pixels);
    if (!made.pixels)
        return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for %u layers' channels",
                             made.channel_count);
    float *out = made.pixels;
    for (size_t at = 0; at < count; at++)
        for (size_t k = 0; k < kinds; k++)
            if (wanted & channels[k].layer) out = give_layer(render, at, channels[k].layer, out);
    *layers = made;
    return SAG_OK;
}

void sag_layers_clear(const sag_context *context, sag_layers *layers) {
    const size_t count = (size_t)layers->width * layers->height * layers->channel_count;
    sag_release(context, layers->pixels, count * sizeof *layers->pixels);
    *layers = (sag_layers){0};
}
