// SPDX-License-Identifier: MIT
// What a world holds. Ids of textures, materials and appearances count from 1: id i is at [i - 1].
#ifndef SAGI_RENDER_WORLD_H
#define SAGI_RENDER_WORLD_H

#include "bsdf.h"
#include "footprint.h"
#include "picture.h"

// A growing array: see sagi_list_grow.
typedef struct sagi_list {
    void *items;
    size_t count, capacity;
} sagi_list;

// How deep textures may nest.
#define SAGI_MAX_TEXTURE_DEPTH 32
// How many textures one may be made of, itself and each as often as it is used.
#define SAGI_MAX_TEXTURE_PARTS 4096

typedef struct sagi_texture {
    sag_texture texture; // its zeros replaced by what they count as
    sagi_mapping mapping;
    sagi_lookup lookup;
    sagi_color colors[2]
                     [4]; // of a … d where they are no textures: as reflectances, as amounts without a bound
    uint32_t depth, parts;
    bool wants_footprint; // it or one of its inputs
} sagi_texture;

// What gets through a rough coat, for all materials that have such a one.
typedef struct sagi_coat {
    double ior, alpha, thickness, inner_mean;
    float rough_share[SAGI_COAT_STEPS], lit_share[SAGI_COAT_STEPS];
} sagi_coat;

typedef struct sagi_material {
    sag_material material;
    sagi_color reflectance, transmittance, eta, k, coat_eta, coat_albedo; // where they are no textures
    sag_rgb mirror;       // of a metal without textures: its colour at normal incidence
    double inner_mean;    // of a coat
    uint32_t coat;        // a rough coat's table, of the world; 0: it has none
    bool wants_spot;      // it has textures, or what it does follows from the place
    bool wants_footprint; // of one of its textures
    bool plain;           // diffuse, of one colour
    bool bent;            // its shading frame is not the surface's own
} sagi_material;

// The look of one geometry; its user data is the id.
typedef struct sagi_appearance {
    const sag_world *world;
    sag_appearance look;
    sagi_color emission;
    double brightness; // of the emission; 0: it does not shine
    bool square_uv;    // the look's, and it is such a mesh
    bool smooth_mesh;  // such a mesh, with normals
    sag_scene *scene;
    uint32_t geometry;
    uint32_t highest;  // id of this scene that had an appearance by then, this one included
    uint32_t previous; // of this scene; 0: none
} sagi_appearance;

// A scene besides the world's own.
typedef struct sagi_world_object {
    sag_scene *scene;
    uint32_t latest; // appearance; 0: none
} sagi_world_object;

struct sag_world {
    sag_context *context;
    sag_scene *scene;
    sag_settings settings;
    sagi_list spectra;     // sagi_spectrum_entry
    sagi_list pictures;    // sagi_picture
    sagi_list textures;    // sagi_texture
    sagi_list materials;   // sagi_material
    sagi_list coats;       // sagi_coat
    sagi_list media;       // sagi_medium
    sagi_list lights;      // sag_light
    sagi_list appearances; // sagi_appearance
    sagi_list objects;     // sagi_world_object
    uint32_t latest;       // appearance of the world's own scene
};

// Room for one more item at the end (not counted yet), zeroed; NULL when memory is short.
void *sagi_list_grow(const sag_context *context, sagi_list *list, size_t item_bytes);
void sagi_list_clear(const sag_context *context, sagi_list *list, size_t item_bytes);

// The value of what may be a texture: as a number, as a colour, and by wavelength, where `color` is the input
// made ready.
double sagi_input_looked_up(const sag_world *world, const sag_input *input, const sagi_spot *at);
static inline double sagi_input_number(const sag_world *world, const sag_input *input, const sagi_spot *at) {
    if (input->texture == 0 && input->spectrum == 0) return input->value.r;
    return sagi_input_looked_up(world, input, at);
}
sag_rgb sagi_input_rgb(const sag_world *world, const sag_input *input, const sagi_spot *at);
sagi_spectrum sagi_input_textured(const sag_world *world, const sag_input *input, const sagi_color *color,
                                  sagi_rgb_use use, const sagi_spot *at, sagi_spectrum lambda);
static inline sagi_spectrum sagi_input_spectrum(const sag_world *world, const sag_input *input,
                                                const sagi_color *color, sagi_rgb_use use,
                                                const sagi_spot *at, sagi_spectrum lambda) {
    if (input->texture == 0) return sagi_color_at(color, lambda);
    return sagi_input_textured(world, input, color, use, at, lambda);
}
// An input that is no texture, made ready, and as RGB.
sagi_color sagi_input_color(const sag_world *world, const sag_input *input, sagi_rgb_use use);
// The same for materials and textures, of which there may be a million: exact not now, but when all of them
// are, on all threads.
sagi_color sagi_input_color_soon(const sag_world *world, const sag_input *input, sagi_rgb_use use);
void sagi_world_solve_colors(sag_world *world);
sag_rgb sagi_input_plain(const sag_world *world, const sag_input *input);
// NULL for an id that is none.
const sagi_spectrum_entry *sagi_spectrum_of(const sag_world *world, sag_spectrum_id id);
// Makes a texture ready in *entry. False for inputs that are none and too many levels or parts.
bool sagi_texture_prepare(const sag_world *world, const sag_texture *texture, sagi_texture *entry);
// Ids of textures and materials that are not known yet (reserve.c): 0 when memory is short. Setting one fails
// as adding it does; a material may not be mixed of such. At the end sagi_textures_settle returns a texture
// that nests too deep, or in a circle; else 0.
sag_texture_id sagi_texture_reserve(sag_world *world, bool is_number);
bool sagi_texture_set(sag_world *world, sag_texture_id id, const sag_texture *texture);
sag_texture_id sagi_textures_settle(sag_world *world);
uint32_t sagi_material_reserve(sag_world *world);
bool sagi_material_set(sag_world *world, uint32_t id, const sag_material *material);
// By which hit a surface was found: bumps ask how its normal changes around it.
typedef struct sagi_origin {
    const sag_scene *scene;
    const sag_ray *ray;
    const sag_hit *hit;
    bool smooth_mesh; // the appearance's
} sagi_origin;

// sagi_material_evaluate for any material.
bool sagi_material_look_up(const sag_world *world, const sagi_material *entry, const sag_surface *surface,
                           const sagi_origin *origin, const sagi_footprint *footprint, sag_vec3 wo,
                           sagi_spectrum lambda, sagi_bsdf *bsdf);
// What the material of a surface (appearance 0: the default) scatters there; of this origin, or NULL: it is
// taken for flat; with the pixel's footprint, or NULL: textures are looked up at points. False: nothing is
// there (interface).
static inline bool sagi_material_evaluate(const sag_world *world, const sagi_appearance *appearance,
                                          const sag_surface *surface, const sagi_origin *origin,
                                          const sagi_footprint *footprint, sag_vec3 wo, sagi_spectrum lambda,
                                          sagi_bsdf *bsdf) {
    const uint32_t id = appearance ? appearance->look.material : 0;
    const sagi_material *entry = id ? (const sagi_material *)world->materials.items + (id - 1) : NULL;
    if (entry && !entry->plain)
        return sagi_material_look_up(world, entry, surface, origin, footprint, wo, lambda, bsdf);
    sagi_bsdf_begin(bsdf);
    if (entry) bsdf->color = sagi_spectrum_clamp(sagi_color_at(&entry->reflectance, lambda));
    sagi_bsdf_set_frame(bsdf, surface->geometric_normal, surface->shading_normal, surface->dpdu, wo);
    return true;
}
// What the albedo integrator shows: the colour of the surface, without the noise of wavelengths.
sag_rgb sagi_material_albedo(const sag_world *world, const sagi_appearance *appearance,
                             const sag_surface *surface, const sagi_footprint *footprint);

// Whether any geometry shines: as a light that is sampled or, as parts of solids do, one that is only found.
bool sagi_world_shines(const sag_world *world);
// Turns a geometry's light off, if it has a look.
void sagi_world_darken(sag_world *world, const sag_scene *scene, uint32_t geometry);
// The emission of a look made ready, and how bright it is; emission.c.
void sagi_emission_init(const sag_world *world, sagi_appearance *entry);
// Whether the surface is there for this ray: where its alpha is below 1, for as many as alpha says. And
// whether no ray finds any of it, by a constant alpha of 0: if it shines, it does so unseen.
bool sagi_alpha_is_there(const sagi_appearance *entry, const sag_surface *surface, const sag_ray *ray);
bool sagi_alpha_is_nowhere(const sagi_appearance *entry);

// The appearance a surface's user data names, or NULL.
static inline const sagi_appearance *sagi_appearance_of(const sag_world *world, const sag_surface *surface) {
    uint64_t id = surface->user_data;
    if (id == 0 || id > world->appearances.count) return NULL;
    return (const sagi_appearance *)world->appearances.items + (id - 1);
}

// Gives the surface the texture coordinates that its appearance (or NULL) has instead: given, or pbrt's.
void sagi_given_texcoords(const sagi_appearance *appearance, sag_surface *surface);
static inline void sagi_replace_texcoords(const sagi_appearance *appearance, sag_surface *surface) {
    if (appearance && (appearance->square_uv || appearance->look.has_uv))
        sagi_given_texcoords(appearance, surface);
}
// Turns the normals to the front: the shading normal's side, then the appearance's flip.
static inline void sagi_orient(const sagi_appearance *appearance, sag_surface *surface) {
    if (sag_dot(surface->geometric_normal, surface->shading_normal) < 0)
        surface->geometric_normal = sag_neg(surface->geometric_normal);
    if (appearance && appearance->look.flip) {
        surface->geometric_normal = sag_neg(surface->geometric_normal);
        surface->shading_normal = sag_neg(surface->shading_normal);
    }
}

#endif
