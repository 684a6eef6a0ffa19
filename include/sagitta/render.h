// SPDX-License-Identifier: MIT
/// @file render.h
/// From a scene to a picture (libsagitta-render): a world is a scene with materials, textures, lights, a
/// camera and a film; a render makes its picture. sag_world_load reads one from a file.
///
/// A world is built by one thread at a time; once rendering it must not change. Light is followed by
/// wavelength; plain colours are linear RGB with Rec. 709 primaries and the white of D65, and stand for
/// smooth spectra that look so (Jakob & Hanika 2019): reflectances, indices and other amounts, or light of
/// which (1, 1, 1) is D65 at luminance 1.
#ifndef SAGITTA_RENDER_H
#define SAGITTA_RENDER_H

#include <sagitta/image.h>
#include <sagitta/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sag_rgb {
    double r, g, b;
} sag_rgb;

// -----------------------------------------------------------------------------------------------------------
// spectra

/// A spectrum of a world, counted from 1; 0 is "none".
typedef uint32_t sag_spectrum_id;

typedef enum sag_spectrum_kind {
    SAG_SPECTRUM_CONSTANT,  ///< `value` at all wavelengths
    SAG_SPECTRUM_SAMPLED,   ///< `pairs`, linear between; 0 beyond or, with `extend`, as at the ends
    SAG_SPECTRUM_BLACKBODY, ///< Planck's law at `value` kelvin, 1 at its peak
    SAG_SPECTRUM_ALBEDO, ///< a reflectance of the colour `rgb`, cut off at 0 and 1, under the space's white
    SAG_SPECTRUM_UNBOUNDED,  ///< the same without a bound above
    SAG_SPECTRUM_ILLUMINANT, ///< light of the colour `rgb`: that times the space's white at luminance 1
    SAG_SPECTRUM_NAMED, ///< one of pbrt-v4's: metal-Ag-eta, metal-Ag-k (Ag, Al, Au, Cu, CuZn, MgO, TiO2),
                        ///< glass-BK7 (BK7, BAF10, FK51A, LASF9, F5, F10, F11), stdillum-A (A, D50, D65, F1 …
                        ///< F12), illum-acesD60; lamps are at luminance 1
} sag_spectrum_kind;

/// Numbers by wavelength, from 360 to 830 nm. Used as light, 1 at every wavelength has luminance 1.
typedef struct sag_spectrum {
    sag_spectrum_kind kind;
    double value;
    sag_rgb rgb;
    sag_color_space space;
    const double *pairs; ///< wavelength in nm, rising, and value, pair_count times
    size_t pair_count;
    bool extend;
    const char *name;
    bool normalize; ///< brought to luminance 1 first
    double scale;   ///< multiplies the values; 0 counts as 1
} sag_spectrum;

// -----------------------------------------------------------------------------------------------------------
// textures

/// A texture of a world, counted from 1; 0 is "none", so that zero-initialised inputs are constants.
typedef uint32_t sag_texture_id;

/// A colour or number that may vary over the surface: the texture's value where texture ≠ 0, else the
/// spectrum where spectrum ≠ 0, else `value`.
typedef struct sag_input {
    sag_rgb value; ///< a number is kept in r (and g, b)
    sag_texture_id texture;
    sag_spectrum_id spectrum;
} sag_input;

typedef enum sag_texture_kind {
    SAG_TEXTURE_CONSTANT, ///< a
    SAG_TEXTURE_SCALE,    ///< a · b; b a number where it is grey or made of numbers
    SAG_TEXTURE_MIX,      ///< a (1 − amount) + b amount
    SAG_TEXTURE_CHECKERBOARD, ///< a where ⌊s⌋ + ⌊t⌋ (or ⌊x⌋ + ⌊y⌋ + ⌊z⌋ when dimension is 3) is even, else b;
                              ///< their mean over the footprint
    SAG_TEXTURE_IMAGE,         ///< a picture
    SAG_TEXTURE_DIRECTION_MIX, ///< a c + b (1 − c), c the |cosine| between the surface's normal and
                               ///< `direction`
    SAG_TEXTURE_BILERP,        ///< a at (s, t) = (0, 0), b at (0, 1), c at (1, 0), d at (1, 1), between and
                               ///< beyond bilinear
    SAG_TEXTURE_DOTS,     ///< a, and b within round spots of radius 0.35, at most one in each unit square
                          ///< of (s, t), in about two of five
    SAG_TEXTURE_FBM,      ///< sum of octaves of noise in the texture's space, about −1 … 1
    SAG_TEXTURE_WRINKLED, ///< sum of octaves of |noise|
    SAG_TEXTURE_WINDY,    ///< waves on water: noise of 6 octaves, the stronger the more a slow one of 3 is
    SAG_TEXTURE_MARBLE,   ///< veins along x and z: a colour of its own
} sag_texture_kind;

/// How a point gets its texture coordinates (s, t). The last three start from the point in the texture's
/// space.
typedef enum sag_mapping_kind {
    SAG_MAPPING_UV,          ///< (u · u_scale + u_offset, v · v_scale + v_offset)
    SAG_MAPPING_SPHERICAL,   ///< (θ/π, φ/2π): θ from +z, φ around it from +x
    SAG_MAPPING_CYLINDRICAL, ///< ((π + φ)/2π, z)
    SAG_MAPPING_PLANAR,      ///< (p·v1 + u_offset, p·v2 + v_offset)
} sag_mapping_kind;

typedef struct sag_mapping {
    sag_mapping_kind kind;
    double u_scale, v_scale; ///< 0 counts as 1
    double u_offset, v_offset;
    sag_vec3 v1, v2;             ///< zero vectors count as x and y
    sag_affine world_to_texture; ///< zero-initialised: the identity
} sag_mapping;

/// What is beyond a picture's edges.
typedef enum sag_wrap {
    SAG_WRAP_REPEAT,
    SAG_WRAP_BLACK,
    SAG_WRAP_CLAMP,
    SAG_WRAP_OCTAHEDRAL, ///< the other side of the edge of an octahedral map of the sphere
} sag_wrap;

/// How a picture that is seen smaller or at a slant is averaged over the footprint of a pixel.
typedef enum sag_texture_filter {
    SAG_LOOKUP_BILINEAR,  ///< between four texels of the level that is just fine enough
    SAG_LOOKUP_POINT,     ///< one texel of that level
    SAG_LOOKUP_TRILINEAR, ///< between two levels
    SAG_LOOKUP_EWA,       ///< an ellipse with Gaussian weights (Heckbert 1989)
} sag_texture_filter;

/// A picture of a world, for textures to share, counted from 1.
typedef uint32_t sag_picture_id;

/// One texture.
typedef struct sag_texture {
    sag_texture_kind kind;
    bool is_number; ///< of numbers, not colours: also asked for a colour it gives what is one number of a
                    ///< picture, its fourth channel or else the mean of the others
    sag_input a, b, c, d, amount;
    sag_mapping mapping;
    uint32_t dimension;     ///< of the checkerboard: 2 or 3; 0 counts as 2
    sag_vec3 direction;     ///< of the direction mix: a unit in world space; zero: y
    uint32_t octaves;       ///< of fbm, wrinkled, marble; 0 counts as 8
    double omega;           ///< how much weaker each octave is; 0 counts as 0.5
    double variation;       ///< of marble: how much noise bends the veins; 0 counts as 0.2
    sag_picture_id picture; ///< 0: `image`
    sag_image image;        ///< the world takes it over (its pixels come from the world's context)
    sag_wrap wrap;
    sag_texture_filter filter;
    double max_anisotropy; ///< of EWA: how long its ellipse may be; 0 counts as 8, at most 64
    double scale;          ///< multiplies the picture, and the space of marble; 0 counts as 1
    bool invert;           ///< of a picture: max(0, 1 − scale · value)
} sag_texture;

// -----------------------------------------------------------------------------------------------------------
// materials

typedef enum sag_material_kind {
    SAG_MATERIAL_DIFFUSE,    ///< Lambertian: reflectance
    SAG_MATERIAL_CONDUCTOR,  ///< metal: eta, k (or reflectance when both are 0); roughness
    SAG_MATERIAL_DIELECTRIC, ///< glass: eta is the index of refraction (r of a plain colour); both sides. A
                             ///< spectrum that is not constant bends each wavelength on its own way
    SAG_MATERIAL_THIN_DIELECTRIC, ///< a pane: reflection and straight transmission, all inner bounces
    SAG_MATERIAL_COATED_DIFFUSE,  ///< plastic: diffuse under a smooth or rough coat of index eta (0: 1.5)
    SAG_MATERIAL_INTERFACE,       ///< not there at all: rays go on
    SAG_MATERIAL_DIFFUSE_TRANSMISSION, ///< paper, leaves: reflectance back, transmittance through
    SAG_MATERIAL_COATED_CONDUCTOR, ///< lacquered metal: eta, k (or reflectance), roughness as a conductor,
                                   ///< under a coat of coat_eta (0: 1.5) and coat_roughness
    SAG_MATERIAL_MIX,              ///< at each point one of two materials, the second with the share `amount`
} sag_material_kind;

/// What a surface does to light. Zero-initialised: black diffuse.
typedef struct sag_material {
    sag_material_kind kind;
    sag_input reflectance;
    sag_input transmittance; ///< of what scatters to the other side; where both add up to more than 1, light
                             ///< is made
    sag_input eta, k;
    sag_input roughness_u, roughness_v; ///< Trowbridge–Reitz α; 0 is a perfect mirror
    /// Of a coated conductor's coat; a coated diffuse one has eta and roughness for it.
    sag_input coat_eta, coat_roughness_u, coat_roughness_v;
    /// Of a coat: its thickness in mean free paths of light (it takes 1 − exp(−thickness/cos) on the way; 0:
    /// clear), the share of that which it scatters (coat_albedo; 0: it absorbs all) with the mean cosine
    /// coat_g, and how many times light leaves the base at most (0: as often as it likes). pbrt-v4's defaults
    /// amount to thickness 0.01 and 5 bounces. Where there is no formula the coat's scattering is itself
    /// found by following `samples` random paths through it (0 counts as 1).
    sag_input thickness, coat_albedo, coat_g;
    uint32_t bounces, samples;
    bool roughness_is_root; ///< α is the square root of what roughness_u and roughness_v (of coats too) say
    uint32_t materials[2];  ///< of a mix, added before, neither an interface; mixes may be mixed
    sag_input amount;       ///< of the second one, cut off at 0 and 1
    sag_input displacement; ///< with texture ≠ 0: shaded as if moved so far along the normal (a number)
    sag_picture_id normal_map; ///< ≠ 0, before displacement: (x + 1)/2, (y + 1)/2, (z + 1)/2 of the normal,
                               ///< by (u, v), z along the surface's own and x along dpdu
} sag_material;

// -----------------------------------------------------------------------------------------------------------
// lights

typedef enum sag_light_kind {
    SAG_LIGHT_POINT,       ///< intensity at `from`
    SAG_LIGHT_SPOT,        ///< intensity from `from` to `to`, full within cone − delta, nothing beyond cone
    SAG_LIGHT_DISTANT,     ///< radiance arriving from the direction from − to, on a surface facing it
    SAG_LIGHT_INFINITE,    ///< from all directions: the same radiance, or a picture's
    SAG_LIGHT_GONIOMETRIC, ///< intensity at `from`, times a picture's by the direction
    SAG_LIGHT_PROJECTION,  ///< intensity at `from`, times a picture's, thrown as from a projector
    SAG_LIGHT_SKY,         ///< radiance changing from `horizon` (and below) to `color` with the height of the
                           ///< direction (y up); for default scenes
} sag_light_kind;

/// A light that is not a geometry (those shine by their sag_appearance).
typedef struct sag_light {
    sag_light_kind kind;
    sag_rgb color; ///< W/sr (point, spot), W/m² (distant), W/(m² sr) (infinite, sky) in the three primaries
    sag_spectrum_id spectrum; ///< ≠ 0: the light is of this spectrum, times the mean of `color`; of all but
                              ///< the sky
    sag_rgb horizon;          ///< of the sky
    sag_vec3 from, to;        ///< in the scene's space
    double cone_rad, cone_delta_rad; ///< half angles of the spot; pbrt's coneangle and conedeltaangle
    /// Multiplies `color`; the world takes it over. Infinite (where it may be empty: constant), goniometric:
    /// square, in the equal-area octahedral mapping (Clarberg 2008), as pbrt-v4's. Projection: looks along +z
    /// of the light's space, +x right and +y down, the first row at −y.
    sag_image image;
    sag_affine
        to_world;   ///< turns the picture (its translation does not count); zero-initialised: the identity
    double fov_rad; ///< projection: of the shorter side; 0 counts as 90°
    sag_vec3 portal[4]; ///< infinite, with has_portal: only what comes in through this rectangle, to points
                        ///< that (portal[3] − portal[0]) × (portal[1] − portal[0]) looks away from
    bool has_portal;
} sag_light;

// -----------------------------------------------------------------------------------------------------------
// media

/// What fills space between surfaces, the same everywhere: fog, coloured glass, juice. Light loses
/// exp(−(σa + σs) d) over a distance d; what is scattered goes on by Henyey and Greenstein's phase function.
/// Seen by SAG_INTEGRATOR_VOLPATH only. Zero-initialised: vacuum.
typedef struct sag_medium {
    sag_input absorption, scattering; ///< σa, σs per unit of length, ≥ 0; no textures
    double scale;                     ///< multiplies both; 0 counts as 1
    double g;           ///< mean cosine of the angle by which light is turned, in (−1, 1): 0 all ways alike
    sag_input emission; ///< radiance that the medium would have were it endless and did not scatter
    double emission_scale; ///< multiplies it; 0 counts as 1
} sag_medium;

// -----------------------------------------------------------------------------------------------------------
// world

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

// -----------------------------------------------------------------------------------------------------------
// camera, film and settings

typedef enum sag_camera_kind {
    SAG_CAMERA_PERSPECTIVE,
    SAG_CAMERA_ORTHOGRAPHIC,
    SAG_CAMERA_ENVIRONMENT, ///< all directions: longitude 0 … 2π from left to right, the pole y at the top
    SAG_CAMERA_EQUAL_AREA,  ///< all directions, each pixel the same solid angle: Clarberg's mapping as of
                            ///< infinite lights' pictures, with y and z exchanged (pbrt's); best square
} sag_camera_kind;

/// Looks along +z with +x right and +y up in its own space (pbrt's: left-handed), which to_world places.
typedef struct sag_camera {
    sag_camera_kind kind;
    sag_affine to_world;
    double fov_rad;          ///< of the shorter image side (perspective); 0 counts as 90°
    double screen_window[4]; ///< x_min x_max y_min y_max; all 0: [−1, 1] on the shorter side, as pbrt
    double lens_radius;      ///< depth of field; 0: none
    double focal_distance;   ///< what is sharp with a lens; 0: infinity
} sag_camera;

/// The to_world of a camera at `eye` that looks at `target` with `up` (of any length) upward in the picture,
/// in a right-handed world: its columns are right = z × up, right × z and z, the direction to the target.
/// Since camera space is left-handed the map mirrors. (pbrt takes the world to be left-handed: there right is
/// up × z.) When up is along z, any upright will do; when eye and target are equal, z = (0, 0, 1). Not finite
/// in, not finite out. Thread-safe. Test: tests/render/test_camera.c.
SAG_API sag_affine sag_camera_look_at(sag_vec3 eye, sag_vec3 target, sag_vec3 up);

/// How samples around a pixel count towards it: pbrt's curves (src/render/filter.c has them). Samples are
/// drawn as the curve is high, and count alike, those where it is negative negatively. Test:
/// tests/render/test_filter.c.
typedef enum sag_filter_kind {
    SAG_FILTER_BOX,      ///< default radius 0.5
    SAG_FILTER_TRIANGLE, ///< 2
    SAG_FILTER_GAUSSIAN, ///< 1.5
    SAG_FILTER_MITCHELL, ///< 2
    SAG_FILTER_SINC,     ///< sinc in Lanczos’ window; 4
} sag_filter_kind;

/// What can be kept beside the picture, from the same samples; bits of sag_film.layers. What the camera's ray
/// meets first counts, after surfaces that are not there.
typedef enum sag_layer {
    SAG_LAYER_ALBEDO = 1 << 0,   ///< Albedo.R/G/B: reflectance; 1 for glass, 0 where nothing is
    SAG_LAYER_NORMAL = 1 << 1,   ///< N.X/Y/Z and Ns.X/Y/Z: geometric and shading normal, units, on the
                                 ///< camera's side
    SAG_LAYER_DEPTH = 1 << 2,    ///< Z: along the viewing direction (cameras that see all around: distance)
    SAG_LAYER_POSITION = 1 << 3, ///< P.X/Y/Z
    SAG_LAYER_UV = 1 << 4,       ///< u, v
    SAG_LAYER_ID = 1 << 5, ///< id.geometry, id.instance, id.material, counted from 1 (0: none), those of
                           ///< most of the pixel's samples
    SAG_LAYER_VARIANCE = 1 << 6, ///< Variance.R/G/B: of the samples; divided by their number, of the pixel
    SAG_LAYER_PICTURE = 1 << 7,  ///< R, G, B: always there
    SAG_LAYER_ALL = 0xFF,
} sag_layer;

typedef struct sag_film {
    uint32_t width, height;
    sag_filter_kind filter;
    double filter_radius_x, filter_radius_y; ///< in pixels; 0: pbrt's default for the kind
    double filter_sigma;                     ///< Gaussian; 0 counts as 0.5
    sag_color_space color_space;             ///< of the picture
    char sensor[64]; ///< "" or "cie1931": the eye's; or one of pbrt-v4's cameras, such as "canon_eos_5d_mkiv"
    double iso;      ///< 0 counts as 100
    double exposure_seconds;     ///< 0 counts as 1. The picture is scaled by this · iso/100
    double white_balance_kelvin; ///< daylight that becomes white; 0: none for the eye, 6500 for cameras
    double filter_b, filter_c;   ///< Mitchell; both 0 count as 1/3
    double filter_tau;           ///< sinc; 0 counts as 3
    /// What part of the picture is made: x_min x_max y_min y_max as shares of width and height, each edge
    /// rounded up to a pixel; all 0: all of it. Each pixel has the bits that it has in the whole picture.
    double crop_window[4];
    /// The same in pixels, first and past the last, for what the crop window leaves open; beyond the film
    /// counts as its edge.
    uint32_t pixel_bounds[4];
    double max_component; ///< a brighter sample is dimmed until its largest component is this; 0: never
    uint32_t layers;      ///< bits of sag_layer
    bool layers_in_camera_space; ///< positions and normals; else in the scene's space
    char file[512];              ///< the name the scene asks for; may be empty
} sag_film;

/// Where the random numbers come from. Each number is a pure function of seed, pixel, sample and dimension.
/// Test: tests/render/test_sampler.c.
typedef enum sag_sampler_kind {
    SAG_SAMPLER_INDEPENDENT, ///< uniform, unrelated
    SAG_SAMPLER_STRATIFIED,  ///< one in each of samples_per_pixel strata, in every dimension (pair)
    SAG_SAMPLER_SOBOL, ///< Sobol’ points, each number of its own dimension (the first 32; then as ZSOBOL)
    SAG_SAMPLER_PADDED_SOBOL, ///< Sobol’ points in every dimension pair, of each pixel by itself (Burley,
                              ///< JCGT 9(4), 2020)
    SAG_SAMPLER_ZSOBOL, ///< the same, neighbouring pixels sharing out a net, so that noise is blue: what one
                        ///< has too much of the next has too little (Ahmed & Wonka 2020)
    SAG_SAMPLER_HALTON, ///< Halton’s sequence over 128×128 pixels
} sag_sampler_kind;

/// How low-discrepancy points are made random.
typedef enum sag_randomization {
    SAG_RANDOMIZATION_DEFAULT,        ///< fast Owen; Halton: permuted digits
    SAG_RANDOMIZATION_NONE,           ///< not at all (but for the order in which samples take them)
    SAG_RANDOMIZATION_PERMUTE_DIGITS, ///< digit by digit, for all points alike
    SAG_RANDOMIZATION_FAST_OWEN,      ///< nested, by Laine and Karras’ hash; not for Halton
    SAG_RANDOMIZATION_OWEN,           ///< nested, by a better and slower hash
} sag_randomization;

typedef enum sag_integrator_kind {
    SAG_INTEGRATOR_PATH,   ///< all light paths: next-event estimation, multiple importance sampling, Russian
                           ///< roulette
    SAG_INTEGRATOR_DIRECT, ///< light that bounces once, mirrors and glass followed
    SAG_INTEGRATOR_AO, ///< ambient occlusion: the visible share of the cosine-weighted hemisphere; 0 where
                       ///< nothing is hit
    SAG_INTEGRATOR_NORMAL,  ///< (n + 1)/2 of the shading normal, turned to the camera
    SAG_INTEGRATOR_UV,      ///< texture coordinates (u, v, 0), wrapped to [0, 1]
    SAG_INTEGRATOR_DEPTH,   ///< distance from the camera's origin; 0 where nothing is hit
    SAG_INTEGRATOR_ID,      ///< a colour for each geometry (and instance)
    SAG_INTEGRATOR_ALBEDO,  ///< reflectance
    SAG_INTEGRATOR_VOLPATH, ///< as path, through media
} sag_integrator_kind;

/// How the path tracer finds the light that reaches a surface. All three have the same mean; for comparison.
typedef enum sag_strategy {
    SAG_STRATEGY_MIS,      ///< lights and surfaces sampled, weighted by the power heuristic (Veach 1995)
    SAG_STRATEGY_LIGHTS,   ///< lights sampled; surfaces only for mirrors and glass
    SAG_STRATEGY_SURFACES, ///< surfaces sampled; point, spot and distant lights, which no ray finds, sampled
} sag_strategy;

/// How one of the lights is chosen at a surface. All have the same mean.
typedef enum sag_light_sampler {
    SAG_LIGHT_SAMPLER_BVH,   ///< by a tree of lights: what each may send there (Conty Estévez & Kulla 2018)
    SAG_LIGHT_SAMPLER_POWER, ///< by its power
    SAG_LIGHT_SAMPLER_UNIFORM, ///< all alike
} sag_light_sampler;

/// Everything about how to look: what a scene file says above WorldBegin. sag_world_create fills the
/// defaults: 1280×720, box filter, independent sampler, 16 samples, path, depth 5.
typedef struct sag_settings {
    sag_camera camera;
    sag_film film;
    sag_sampler_kind sampler;
    sag_randomization randomization;
    uint32_t samples_per_pixel;  ///< 1 … 2³¹
    uint32_t strata_x, strata_y; ///< stratified: the strata of a pair, where their product is
                                 ///< samples_per_pixel; else the most nearly square grid
    bool no_jitter;              ///< stratified: in the middle of each stratum
    uint64_t seed;
    sag_integrator_kind integrator;
    uint32_t max_depth;    ///< bounces; 0: only what shines by itself
    bool regularize;       ///< roughen what a path meets after its first rough surface (pbrt's): less sharp
                           ///< caustics for far less noise. Off by default
    sag_strategy strategy; ///< path and direct only
    sag_light_sampler light_sampler; ///< path and direct only
    uint32_t camera_medium;          ///< the medium the camera stands in; 0: vacuum
} sag_settings;

/// Whether sag_film.sensor may have this name.
SAG_API bool sag_sensor_is_known(const char *name);

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

// -----------------------------------------------------------------------------------------------------------
// render

/// How far a render is; samples counts camera samples over all pixels.
typedef struct sag_progress {
    uint64_t samples_done, samples_total;
    double seconds; ///< spent in sag_render_run so far
} sag_progress;

/// Called now and then, one call at a time, from any of the context's threads. Return false to stop the
/// render.
typedef bool (*sag_progress_callback)(void *user, const sag_progress *progress);

/// A sample of a pixel of the (whole) film: `sagitta render --crop 1x1+X+Y` takes it again.
typedef struct sag_bad_sample {
    uint32_t x, y, sample;
} sag_bad_sample;

/// How many of the bad samples are told.
#define SAG_BAD_SAMPLES 8

typedef struct sag_render_stats {
    uint32_t width, height;  ///< of the picture: what is made of the film
    uint64_t rays;           ///< traced, shadow rays included
    uint64_t camera_samples; ///< taken
    uint64_t bad_samples;    ///< NaN or infinite: counted and dropped, the pixel is the mean of the others
    uint32_t bad_told;       ///< how many are in bad[]
    sag_bad_sample bad[SAG_BAD_SAMPLES]; ///< the first ones, by row, column and sample
    double build_seconds, trace_seconds;
    double thread_seconds;    ///< of tracing, all threads together
    double traversal_seconds; ///< of those, in finding what rays hit
} sag_render_stats;

typedef struct sag_render sag_render;

/// Prepares a picture of the world as it is now: commits its scene, sorts its lights. NULL with *error on
/// failure. The world must outlive the render and not change meanwhile.
SAG_API sag_render *sag_render_create(sag_world *world, sag_error *error);
/// Frees the render, not its world. NULL does nothing. It must not be running.
SAG_API void sag_render_destroy(sag_render *render);
/// Takes the samples that are not taken yet, on all the context's threads. SAG_ERROR_CANCELLED when the
/// callback stopped it; what is done stays, and a further call goes on from there. The same bits however many
/// threads there are.
SAG_API sag_status sag_render_run(sag_render *render, sag_progress_callback progress, void *user,
                                  sag_error *error);
/// The picture from the samples taken so far: linear RGB of the film's colour space; black where there are
/// none yet. Makes *image (sag_image_clear it). Between runs.
SAG_API sag_status sag_render_get_image(const sag_render *render, sag_image *image, sag_error *error);
/// Room for all layers' channels.
#define SAG_MAX_CHANNELS 32

/// The picture and its layers, pixel by pixel from the top left, each pixel's channels one after the other.
typedef struct sag_layers {
    uint32_t width, height;           ///< of what was made of the film
    uint32_t x, y;                    ///< its first column and row there
    uint32_t full_width, full_height; ///< of the film
    uint32_t channel_count;
    const char *names[SAG_MAX_CHANNELS]; ///< constant strings, such as "Albedo.R"
    bool is_id[SAG_MAX_CHANNELS];        ///< the floats are the bits of a uint32_t
    sag_color_space color_space;         ///< of R G B
    float *pixels;                       ///< width · height · channel_count
} sag_layers;

/// The picture as sag_render_get_image has it and the layers that the film asks for, from the samples taken
/// so far; all means are weighted by the filter. Makes *layers (sag_layers_clear it). Between runs. Test:
/// tests/render/test_layers.c.
SAG_API sag_status sag_render_get_layers(const sag_render *render, sag_layers *layers, sag_error *error);
/// Frees the pixels and zeroes the rest. Zeroed ones are left alone.
SAG_API void sag_layers_clear(const sag_context *context, sag_layers *layers);
/// Writes an OpenEXR file of one part with these channels: 32-bit floats, ids 32-bit whole numbers, ZIP. The
/// data window is what was made, the display window the film. The file appears whole or not at all.
/// SAG_ERROR_ARGUMENT for another ending than .exr or a build without OpenEXR, SAG_ERROR_IO with the system's
/// reason.
SAG_API sag_status sag_layers_write(const sag_context *context, const sag_layers *layers, const char *path,
                                    sag_error *error);
/// Counts and times so far. Between runs or from the progress callback.
SAG_API void sag_render_get_stats(const sag_render *render, sag_render_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
