// SPDX-License-Identifier: MIT
/// @file world.h
/// A world: a scene with its materials, textures, lights and media, and how to look at it. Built by hand, or
/// read from a file by sag_world_load. One thread at a time builds a world; once rendering it must not
/// change.
#ifndef SAGITTA_RENDER_WORLD_H
#define SAGITTA_RENDER_WORLD_H

#include <sagitta/render/light.h>
#include <sagitta/render/material.h>
#include <sagitta/render/settings.h>
#include <sagitta/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sag_world sag_world;

/// An empty world; NULL when memory is short. The context must outlive it.
SAG_API sag_world *sag_world_create(sag_context *context);
/// Frees the world, its scenes and pictures. NULL does nothing.
SAG_API void sag_world_destroy(sag_world *world);
/// The context the world was created with. Thread-safe.
SAG_API sag_context *sag_world_context(const sag_world *world);

/// The scene rays are sent into; owned by the world. sag_render_create commits it.
SAG_API sag_scene *sag_world_scene(sag_world *world);
/// Another scene owned by the world, to be placed by instances; NULL when memory is short. Commit it before
/// instancing.
SAG_API sag_scene *sag_world_add_object(sag_world *world);
/// The scenes sag_world_add_object made, in order, counted from 0; NULL beyond the last.
SAG_API sag_scene *sag_world_object(const sag_world *world, uint32_t index);

/// Adds a spectrum (copied, pairs and all). SAG_ERROR_ARGUMENT for a description that is none: numbers that
/// are not finite, wavelengths that do not rise, a temperature that is not positive, an unknown name;
/// SAG_ERROR_MEMORY. Test: tests/render/test_spectrum.c.
SAG_API sag_status sag_world_add_spectrum(sag_world *world, const sag_spectrum *spectrum,
                                          sag_spectrum_id *id);
/// A spectrum's value at a wavelength in nm (to the nearest nanometre; 0 beyond 360 … 830), and for an
/// unknown id.
SAG_API double sag_world_spectrum_value(const sag_world *world, sag_spectrum_id id, double wavelength_nm);
/// A spectrum's luminance as light: ∫ ȳ S dλ/∫ ȳ dλ. 0 for an unknown id.
SAG_API double sag_world_spectrum_luminance(const sag_world *world, sag_spectrum_id id);
/// A spectrum's linear RGB colour in Rec. 709: as light or, as a reflectance, under D65. Black for an unknown
/// id.
SAG_API sag_rgb sag_world_spectrum_color(const sag_world *world, sag_spectrum_id id, bool as_light);

/// Takes a picture over (also on failure) for textures to show. Its id, or 0 when memory is short or there is
/// no picture.
SAG_API sag_picture_id sag_world_add_picture(sag_world *world, sag_image *image);
/// Reads a picture as sag_image_read does, and keeps it as small as its numbers are: bytes stay bytes. The
/// encoding (SAG_ENCODING_DEFAULT: sRGB; gamma > 0: that power instead) counts for PNG; as in pbrt-v4, other
/// formats of 8 bits are what they say (QOI) or sRGB. A file that was read before in the same way is not read
/// again.
SAG_API sag_status sag_world_load_picture(sag_world *world, const char *path, sag_encoding encoding,
                                          double gamma, sag_picture_id *id, sag_error *error);

/// Adds a texture, material or light (copied; pictures are taken over, also on failure). Returns its id
/// (each kind counts from 1) or 0 when memory is short, an input names a texture or spectrum that was not
/// added before, or textures nest more than 32 deep or are made of more than 4096, counted as often as they
/// are used.
SAG_API sag_texture_id sag_world_add_texture(sag_world *world, const sag_texture *texture);
/// As sag_world_add_texture, for a material.
SAG_API uint32_t sag_world_add_material(sag_world *world, const sag_material *material);
/// As sag_world_add_texture, for a light; numbers out of range are reported by sag_render_create.
SAG_API uint32_t sag_world_add_light(sag_world *world, const sag_light *light);

/// As sag_world_add_texture, for a medium; 0 also for negative or infinite coefficients and |g| ≥ 1.
SAG_API uint32_t sag_world_add_medium(sag_world *world, const sag_medium *medium);
/// Puts another medium in the place of one. SAG_ERROR_ARGUMENT for what add refuses and an unknown id.
SAG_API sag_status sag_world_set_medium(sag_world *world, uint32_t id, const sag_medium *medium);

/// How a geometry looks. Zero-initialised: the default material, grey diffuse. The front is where the
/// geometric normal points, turned to the side of the shading normal where a mesh brings normals of its own
/// (as pbrt does), then turned by `flip`.
typedef struct sag_appearance {
    uint32_t material; ///< 0: 50 % grey diffuse
    sag_rgb emission;  ///< radiance W/(m² sr); not black: the geometry is an area light, on its front
    sag_spectrum_id emission_spectrum; ///< ≠ 0: this times emission_scale, in place of `emission`
    double emission_scale;
    sag_texture_id emission_texture; ///< ≠ 0: multiplies the emission, over u, v
    bool emission_over_area; ///< of a mesh or set of spheres: each triangle's (sphere's) emission is divided
                             ///< by its area, as if it were given in W/sr
    bool two_sided;          ///< emits on both sides
    bool flip;               ///< the front is the back (pbrt's ReverseOrientation)
    /// Media on the sides; 0: vacuum. Where both are the same the surface does not divide media, and what
    /// surrounds it is on both sides.
    uint32_t inside, outside;
    bool has_uv;    ///< texture coordinates are by the next, in place of the surface's own u, v ∈ [0, 1]:
    float uv[4][2]; ///< those at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1), and bilinear between
    bool square_uv; ///< of meshes without texture coordinates: (0, 0), (1, 0), (1, 1) at a triangle's
                    ///< corners, as pbrt has them, not (0, 0), (1, 0), (0, 1)
    /// With texture ≠ 0: the share of the surface that is there, and of the rays that see it. A shape whose
    /// alpha is a constant texture of 0 shines all the same: a light that is not seen.
    sag_input alpha;
} sag_appearance;

/// Binds a look to a geometry of one of the world's scenes, in place of an earlier one. It sets the
/// geometry's user data, so it comes before the scene's commit. SAG_ERROR_ARGUMENT for a scene that is none
/// of the world's and an unknown geometry, material or texture, SAG_ERROR_MEMORY. A shining
/// geometry in an instanced scene is a light in every instance. (Parts of solids light the world too, but
/// only surfaces' own sampling finds them.)
SAG_API sag_status sag_world_set_appearance(sag_world *world, sag_scene *scene, uint32_t geometry,
                                            const sag_appearance *appearance);

/// The world's settings, to read and to change until a render is made.
SAG_API sag_settings *sag_world_settings(sag_world *world);

// -----------------------------------------------------------------------------------------------------------
// files

/// Reads a scene: pbrt-v4 by the ending .pbrt (or .pbrt.gz), anything else through Assimp, framed by a
/// default camera, ground and sky. Adds to the world. Warnings go to the context's log as "file:line:col:
/// warning: …"; the error has the place.
SAG_API sag_status sag_world_load(sag_world *world, const char *path, sag_error *error);

/// Called for each mesh that a file brings, before it is added; for `sagitta info`.
typedef void (*sag_mesh_callback)(void *user, const char *name, const sag_mesh *mesh);
/// As sag_world_load, without camera, ground, sky, materials and pictures: only the geometry, for casting
/// rays.
SAG_API sag_status sag_world_load_geometry(sag_world *world, const char *path, sag_mesh_callback on_mesh,
                                           void *user, sag_error *error);

#ifdef __cplusplus
}
#endif
#endif
