// SPDX-License-Identifier: MIT
/// @file light.h
/// Lights that are not geometries, and media: what fills the space between surfaces. Geometries that shine do
/// so by their sag_appearance (world.h).
#ifndef SAGITTA_RENDER_LIGHT_H
#define SAGITTA_RENDER_LIGHT_H

#include <sagitta/math.h>
#include <sagitta/render/texture.h>

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
    /// Turns the picture (its translation does not count); zero-initialised: the identity. Of a spot:
    /// stretches its cone, which is round before; pbrt-v4's, under a transform that is no similarity.
    sag_affine to_world;
    double fov_rad;     ///< projection: of the shorter side; 0 counts as 90°
    sag_vec3 portal[4]; ///< infinite, with has_portal: only what comes in through this rectangle, to points
                        ///< that (portal[3] − portal[0]) × (portal[1] − portal[0]) looks away from
    bool has_portal;
} sag_light;

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

#endif
