// SPDX-License-Identifier: MIT
// The world: a scene and what belongs to a picture of it, in growing arrays. Nothing here is in the way of a
// ray; src/render/render.c prepares what is.
#include "fresnel.h"
#include "medium.h"

#include <string.h>

void *sagi_list_grow(const sag_context *context, sagi_list *list, size_t item_bytes) {
    if (list->count == list->capacity) {
        size_t capacity = list->capacity ? list->capacity * 2 : 16;
        if (capacity > SIZE_MAX / item_bytes) return NULL;
        void *items = sag_allocate(context, capacity * item_bytes);
        if (!items) return NULL;
        if (list->count) memcpy(items, list->items, list->count * item_bytes);
        sag_release(context, list->items, list->capacity * item_bytes);
        list->items = items;
        list->capacity = capacity;
    }
    void *item = (char *)list->items + list->count * item_bytes;
    memset(item, 0, item_bytes);
    return item;
}

void sagi_list_clear(const sag_context *context, sagi_list *list, size_t item_bytes) {
    sag_release(context, list->items, list->capacity * item_bytes);
    *list = (sagi_list){NULL, 0, 0};
}

sag_world *sag_world_create(sag_context *context) {
    if (!context) return NULL;
    sag_world *world = sag_allocate(context, sizeof *world);
    if (!world) return NULL;
    memset(world, 0, sizeof *world);
    world->context = context;
    world->scene = sag_scene_create(context);
    if (!world->scene) {
        sag_release(context, world, sizeof *world);
        return NULL;
    }
    world->settings.camera.to_world = sag_affine_identity();
    world->settings.film.width = 1280;
    world->settings.film.height = 720;
    world->settings.samples_per_pixel = 16;
    world->settings.max_depth = 5;
    return world;
}

void sag_world_destroy(sag_world *world) {
    if (!world) return;
    sag_context *context = world->context;
    sagi_world_clear_pictures(world);
    sag_light *lights = world->lights.items;
    for (size_t i = 0; i < world->lights.count; i++) sag_image_clear(context, &lights[i].image);
    sag_scene_destroy(world->scene);
    sagi_world_object *objects = world->objects.items;
    for (size_t i = 0; i < world->objects.count; i++) sag_scene_destroy(objects[i].scene);
    sagi_spectrum_entry *spectra = world->spectra.items;
    for (size_t i = 0; i < world->spectra.count; i++) sagi_spectrum_clear(context, &spectra[i]);
    sagi_list_clear(context, &world->spectra, sizeof(sagi_spectrum_entry));
    sagi_list_clear(context, &world->textures, sizeof(sagi_texture));
    sagi_list_clear(context, &world->materials, sizeof(sagi_material));
    sagi_list_clear(context, &world->coats, sizeof(sagi_coat));
    sagi_list_clear(context, &world->media, sizeof(sagi_medium));
    sagi_list_clear(context, &world->lights, sizeof(sag_light));
    sagi_list_clear(context, &world->appearances, sizeof(sagi_appearance));
    sagi_list_clear(context, &world->objects, sizeof(sagi_world_object));
    sag_release(context, world, sizeof *world);
}

sag_context *sag_world_context(const sag_world *world) { return world->context; }
sag_scene *sag_world_scene(sag_world *world) { return world->scene; }
sag_settings *sag_world_settings(sag_world *world) { return &world->settings; }

sag_scene *sag_world_add_object(sag_world *world) {
    sagi_world_object *slot = sagi_list_grow(world->context, &world->objects, sizeof *slot);
    if (!slot) return NULL;
    slot->scene = sag_scene_create(world->context);
    if (slot->scene) world->objects.count++;
    return slot->scene;
}

sag_scene *sag_world_object(const sag_world *world, uint32_t index) {
    const sagi_world_object *objects = world->objects.items;
    return index < world->objects.count ? objects[index].scene : NULL;
}

sag_status sag_world_add_spectrum(sag_world *world, const sag_spectrum *spectrum, sag_spectrum_id *id) {
    *id = 0;
    sagi_spectrum_entry *slot = sagi_list_grow(world->context, &world->spectra, sizeof *slot);
    if (!slot || world->spectra.count == UINT32_MAX) return SAG_ERROR_MEMORY;
    const sag_status status = sagi_spectrum_make(world->context, spectrum, slot);
    if (status == SAG_OK) *id = (sag_spectrum_id)++world->spectra.count;
    return status;
}

double sag_world_spectrum_value(const sag_world *world, sag_spectrum_id id, double wavelength_nm) {
    const sagi_spectrum_entry *entry = sagi_spectrum_of(world, id);
    if (!entry || !(wavelength_nm >= SAGI_WAVELENGTH_MIN && wavelength_nm <= SAGI_WAVELENGTH_MAX)) return 0;
    return (double)sagi_color_at(&entry->color, sagi_spectrum_all(wavelength_nm))[0];
}

double sag_world_spectrum_luminance(const sag_world *world, sag_spectrum_id id) {
    const sagi_spectrum_entry *entry = sagi_spectrum_of(world, id);
    return entry ? entry->luminance : 0;
}

sag_rgb sag_world_spectrum_color(const sag_world *world, sag_spectrum_id id, bool as_light) {
    const sagi_spectrum_entry *entry = sagi_spectrum_of(world, id);
    return entry ? (as_light ? entry->light : entry->reflectance) : (sag_rgb){0, 0, 0};
}

sag_texture_id sag_world_add_texture(sag_world *world, const sag_texture *texture) {
    sag_texture made = *texture;
    sagi_texture entry;
    bool good = sagi_texture_prepare(world, texture, &entry);
    if (good && made.kind == SAG_TEXTURE_IMAGE && made.picture == 0) {
        entry.texture.picture = sag_world_add_picture(world, &made.image);
        good = entry.texture.picture != 0;
    }
    sag_image_clear(world->context, &made.image);
    sagi_texture *slot = good ? sagi_list_grow(world->context, &world->textures, sizeof *slot) : NULL;
    if (!slot) return 0;
    *slot = entry;
    return (sag_texture_id)++world->textures.count;
}

// The index of refraction of glass and coats: of a plain colour, its first component.
static sagi_color index_color(const sag_world *world, const sag_input *eta) {
    if (eta->spectrum) return sagi_input_color(world, eta, SAGI_RGB_UNBOUNDED);
    return (sagi_color){.scale = (float)(eta->value.r > 0 ? eta->value.r : 1.5)};
}

// The colour of a metal at normal incidence.
static sag_rgb mirror_color(const sagi_color *eta, const sagi_color *k) {
    float table[SAGI_WAVELENGTH_COUNT];
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) {
        const sagi_spectrum at = sagi_spectrum_all(SAGI_WAVELENGTH_MIN + i);
        table[i] = sagi_fresnel_conductor_spectrum(1, sagi_color_at(eta, at), sagi_color_at(k, at))[0];
    }
    const sagi_color color = {.scale = 1, .table = table, .varies = true};
    return sagi_color_to_rgb(&color, SAG_COLOR_SRGB, false);
}

// The facets of a coat that are the same everywhere and in all directions; else 0.
static sagi_microfacet plain_facets(const sag_material *material) {
    const sag_input *u = &material->roughness_u, *v = &material->roughness_v;
    double alpha = u->value.r;
    if (u->texture || v->texture || u->spectrum || v->spectrum || alpha != v->value.r)
        return (sagi_microfacet){0, 0};
    if (material->roughness_is_root) alpha = sqrt(fmax(alpha, 0));
    if (!(alpha >= SAGI_SMOOTH_ALPHA)) return (sagi_microfacet){0, 0};
    alpha = fmin(alpha, 1e3);
    return (sagi_microfacet){alpha, alpha};
}

// The number of a rough coat's table, which takes milliseconds to make: one of the last few, or a new one. 0
// when memory is short.
static uint32_t coat_table(sag_world *world, const sagi_bsdf *coat) {
    const sagi_coat *coats = world->coats.items;
    const size_t count = world->coats.count;
    for (size_t i = count; i > 0 && count - i < 64; i--) {
        const sagi_coat *other = &coats[i - 1];
        if (other->ior == coat->ior && other->alpha == coat->coat.ax && other->thickness == coat->thickness)
            return (uint32_t)i;
    }
    sagi_coat *slot = sagi_list_grow(world->context, &world->coats, sizeof *slot);
    if (!slot) return 0;
    slot->ior = coat->ior, slot->alpha = coat->coat.ax, slot->thickness = coat->thickness;
    slot->inner_mean = sagi_coat_table(coat, slot->rough_share, slot->lit_share);
    return (uint32_t)++world->coats.count;
}

// What of a material does not change over the surface. False when memory is short.
static bool prepare_material(sag_world *world, sagi_material *entry) {
    const sag_material *material = &entry->material;
    entry->reflectance = sagi_input_color_soon(world, &material->reflectance, SAGI_RGB_ALBEDO);
    entry->transmittance = sagi_input_color_soon(world, &material->transmittance, SAGI_RGB_ALBEDO);
    entry->coat_albedo = sagi_input_color_soon(world, &material->coat_albedo, SAGI_RGB_ALBEDO);
    entry->coat_eta = index_color(world, &material->coat_eta);
    if (material->kind == SAG_MATERIAL_CONDUCTOR || material->kind == SAG_MATERIAL_COATED_CONDUCTOR) {
        entry->eta = sagi_input_color(world, &material->eta, SAGI_RGB_UNBOUNDED);
        entry->k = sagi_input_color(world, &material->k, SAGI_RGB_UNBOUNDED);
        entry->mirror = mirror_color(&entry->eta, &entry->k);
        return true;
    }
    entry->eta = index_color(world, &material->eta);
    if (material->kind != SAG_MATERIAL_COATED_DIFFUSE) return true;
    const double eta = sagi_color_at_first(&entry->eta, sagi_spectrum_all(560));
    const sagi_bsdf coat = {.ior = eta > 0 ? eta : 1.5,
                            .thickness = fmax(material->thickness.value.r, 0),
                            .coat = plain_facets(material)};
    if (!(coat.coat.ax > 0 && coat.ior != 1)) {
        entry->inner_mean = sagi_fresnel_inner_mean(coat.ior, coat.thickness);
        return true;
    }
    entry->coat = coat_table(world, &coat);
    if (entry->coat) entry->inner_mean = ((const sagi_coat *)world->coats.items)[entry->coat - 1].inner_mean;
    return entry->coat != 0;
}

static bool is_mixable(const sag_world *world, uint32_t id) {
    const sagi_material *materials = world->materials.items;
    return id != 0 && id <= world->materials.count &&
           materials[id - 1].material.kind != SAG_MATERIAL_INTERFACE;
}

uint32_t sag_world_add_material(sag_world *world, const sag_material *material) {
    const sag_input *inputs[] = {&material->reflectance,
                                 &material->transmittance,
                                 &material->eta,
                                 &material->k,
                                 &material->roughness_u,
                                 &material->roughness_v,
                                 &material->coat_eta,
                                 &material->coat_roughness_u,
                                 &material->coat_roughness_v,
                                 &material->thickness,
                                 &material->coat_albedo,
                                 &material->coat_g,
                                 &material->displacement,
                                 &material->amount};
    const sagi_texture *textures = world->textures.items;
    bool textured = material->normal_map != 0, wants_footprint = false;
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++) {
        const sag_texture_id id = inputs[i]->texture;
        if (id > world->textures.count || inputs[i]->spectrum > world->spectra.count) return 0;
        textured |= id != 0;
        wants_footprint |= id != 0 && textures[id - 1].wants_footprint;
    }
    if (material->normal_map > world->pictures.count) return 0;
    if (material->kind == SAG_MATERIAL_MIX &&
        !(is_mixable(world, material->materials[0]) && is_mixable(world, material->materials[1])))
        return 0;
    sagi_material *slot = sagi_list_grow(world->context, &world->materials, sizeof *slot);
    if (!slot) return 0;
    slot->material = *material;
    // Coats may be walked through, by random numbers of the place.
    slot->wants_spot = textured || material->kind == SAG_MATERIAL_COATED_DIFFUSE ||
                       material->kind == SAG_MATERIAL_COATED_CONDUCTOR;
    slot->wants_footprint = wants_footprint;
    slot->bent = material->normal_map != 0 || material->displacement.texture != 0;
    slot->plain = material->kind == SAG_MATERIAL_DIFFUSE && !slot->wants_spot && !slot->bent;
    if (!prepare_material(world, slot)) return 0;
    world->materials.count++;
    return (uint32_t)world->materials.count;
}

static bool read_medium(const sag_world *world, const sag_medium *medium, sagi_medium *made) {
    const sag_input *inputs[] = {&medium->absorption, &medium->scattering, &medium->emission};
    for (int i = 0; i < 3; i++)
        if (inputs[i]->texture || inputs[i]->spectrum > world->spectra.count) return false;
    return sagi_medium_prepare(world, medium, made);
}

uint32_t sag_world_add_medium(sag_world *world, const sag_medium *medium) {
    sagi_medium made;
    sagi_medium *slot = NULL;
    if (read_medium(world, medium, &made)) slot = sagi_list_grow(world->context, &world->media, sizeof *slot);
    if (!slot) return 0;
    *slot = made;
    return (uint32_t)++world->media.count;
}

sag_status sag_world_set_medium(sag_world *world, uint32_t id, const sag_medium *medium) {
    sagi_medium made;
    if (id == 0 || id > world->media.count || !read_medium(world, medium, &made)) return SAG_ERROR_ARGUMENT;
    ((sagi_medium *)world->media.items)[id - 1] = made;
    return SAG_OK;
}

uint32_t sag_world_add_light(sag_world *world, const sag_light *light) {
    sag_light *slot = NULL;
    if (light->spectrum <= world->spectra.count)
        slot = sagi_list_grow(world->context, &world->lights, sizeof *slot);
    if (!slot) {
        sag_image image = light->image;
        sag_image_clear(world->context, &image);
        return 0;
    }
    *slot = *light;
    world->lights.count++;
    return (uint32_t)world->lights.count;
}

// Where the latest appearance of a scene is written down; loaders ask for the newest objects.
static uint32_t *latest_of(sag_world *world, const sag_scene *scene) {
    if (scene == world->scene) return &world->latest;
    sagi_world_object *objects = world->objects.items;
    for (size_t i = world->objects.count; i-- > 0;)
        if (objects[i].scene == scene) return &objects[i].latest;
    return NULL;
}

// The appearance of a geometry that has one already, from the latest of its scene backward. Loaders set each
// geometry's once and in order: an id above all that its scene has seen so far needs no search.
static sagi_appearance *find_appearance(const sag_world *world, uint32_t latest, uint32_t geometry) {
    sagi_appearance *all = world->appearances.items;
    for (uint32_t i = latest; i != 0 && all[i - 1].highest >= geometry; i = all[i - 1].previous)
        if (all[i - 1].geometry == geometry) return &all[i - 1];
    return NULL;
}

static void set_look(const sag_world *world, sagi_appearance *entry, const sag_appearance *look) {
    entry->world = world;
    entry->look = *look;
    sagi_emission_init(world, entry);
}

sag_status sag_world_set_appearance(sag_world *world, sag_scene *scene, uint32_t geometry,
                                    const sag_appearance *appearance) {
    if (appearance->material > world->materials.count || appearance->alpha.texture > world->textures.count ||
        appearance->emission_texture > world->textures.count ||
        appearance->emission_spectrum > world->spectra.count || appearance->inside > world->media.count ||
        appearance->outside > world->media.count)
        return SAG_ERROR_ARGUMENT;
    uint32_t *const latest = latest_of(world, scene);
    if (!latest) return SAG_ERROR_ARGUMENT;
    sagi_appearance *found = find_appearance(world, *latest, geometry);
    if (found) {
        set_look(world, found, appearance);
        return SAG_OK;
    }
    sagi_appearance *slot = sagi_list_grow(world->context, &world->appearances, sizeof *slot);
    if (!slot || world->appearances.count == UINT32_MAX) return SAG_ERROR_MEMORY;
    sag_status status = sag_geometry_set_user_data(scene, geometry, world->appearances.count + 1);
    if (status != SAG_OK) return status;
    const sagi_appearance *all = world->appearances.items;
    const uint32_t highest = *latest ? all[*latest - 1].highest : geometry;
    set_look(world, slot, appearance);
    slot->scene = scene;
    slot->geometry = geometry;
    slot->highest = highest > geometry ? highest : geometry;
    slot->previous = *latest;
    *latest = (uint32_t)++world->appearances.count;
    return SAG_OK;
}

void sagi_world_darken(sag_world *world, const sag_scene *scene, uint32_t geometry) {
    const uint32_t *const latest = latest_of(world, scene);
    sagi_appearance *const found = latest ? find_appearance(world, *latest, geometry) : NULL;
    if (!found) return;
    sag_appearance look = found->look;
    look.emission = (sag_rgb){0, 0, 0};
    look.emission_spectrum = 0;
    set_look(world, found, &look);
}

bool sagi_world_shines(const sag_world *world) {
    const sagi_appearance *all = world->appearances.items;
    for (size_t i = 0; i < world->appearances.count; i++)
        if (all[i].brightness > 0) return true;
    return false;
}
