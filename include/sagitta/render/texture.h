// SPDX-License-Identifier: MIT
/// @file texture.h
/// Textures: colours and numbers that vary over a surface, and how its points get their coordinates.
/// sag_world_add_texture (world.h) adds one to a world.
#ifndef SAGITTA_RENDER_TEXTURE_H
#define SAGITTA_RENDER_TEXTURE_H

#include <sagitta/math.h>
#include <sagitta/render/spectrum.h>

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

#endif
