// SPDX-License-Identifier: MIT
// Bump maps (Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978) and normal maps.
//
// A surface p(u, v) moved along its normal n by d(u, v) has the tangents
//   ∂p/∂u + ∂d/∂u n + d ∂n/∂u,   ∂p/∂v + ∂d/∂v n + d ∂n/∂v,
// and the normal across them. The last terms are left out: they matter where the displacement is comparable
// with the radius of curvature, and there one would see that the outline stays as it was. The derivatives of
// d are differences over half the pixel's footprint, so that what is finer than a pixel does not alias, or
// over 0.0005 where there is none (pbrt-v4's rule).
//
// Tangents are taken perpendicular to the shading normal first: where normals are interpolated, dpdu and dpdv
// lie in the flat triangle. (pbrt-v4 takes there for dpdv a direction across dpdu of the same length, which
// is the same in coordinates without shear or stretch.)
#include "bump.h"

#include "math/map.h"

// The steps of u and v without a footprint.
#define SMALL_STEP 0.0005

static sag_vec3 across(sag_vec3 v, sag_vec3 n) { return sag_madd(v, -sag_dot(v, n), n); }

// Nothing that can be a frame leaves the surface as it is; the normal stays on the side of the true surface.
static sagi_shading_frame checked(const sag_surface *surface, sag_vec3 normal, sag_vec3 tangent) {
    normal = sagi_normalize(normal);
    const double length = sag_dot(normal, normal);
    if (!(length > 0.5 && length < 2)) return sagi_plain_frame(surface);
    if (sag_dot(normal, surface->geometric_normal) < 0) normal = sag_neg(normal);
    return (sagi_shading_frame){normal, tangent};
}

sagi_shading_frame sagi_bumped_frame(const sag_world *world, const sag_input *displacement,
                                     const sag_surface *surface, const sagi_spot *at) {
    const sag_vec3 n = surface->shading_normal;
    const sag_vec3 dpdu = across(surface->dpdu, n), dpdv = across(surface->dpdv, n);
    double du = 0.5 * (fabs(at->dudx) + fabs(at->dudy)), dv = 0.5 * (fabs(at->dvdx) + fabs(at->dvdy));
    if (!(du > 0)) du = SMALL_STEP;
    if (!(dv > 0)) dv = SMALL_STEP;
    sagi_spot along_u = *at, along_v = *at;
    along_u.position = sag_madd(at->position, du, dpdu), along_u.u += du;
    along_v.position = sag_madd(at->position, dv, dpdv), along_v.v += dv;
    const double here = sagi_input_number(world, displacement, at);
    const double u_slope = (sagi_input_number(world, displacement, &along_u) - here) / du;
    const double v_slope = (sagi_input_number(world, displacement, &along_v) - here) / dv;
    const sag_vec3 u = sag_madd(dpdu, u_slope, n), v = sag_madd(dpdv, v_slope, n);
    return checked(surface, sag_cross(u, v), u);
}

sagi_shading_frame sagi_mapped_frame(const sagi_mipmap *normals, const sag_surface *surface,
                                     const sagi_spot *at) {
    const sagi_lookup how = {.filter = SAG_LOOKUP_BILINEAR, .wrap = SAG_WRAP_REPEAT};
    const sagi_spot_2d in = {.s = at->u, .t = at->v};
    const sagi_texel texel = sagi_mipmap_lookup(normals, &how, &in) * 2 - 1;
    const sag_vec3 n = surface->shading_normal, s = sagi_normalize(across(surface->dpdu, n)),
                   t = sag_cross(n, s);
    const sag_vec3 normal =
        sag_madd(sag_madd(sag_scale(s, (double)texel[0]), (double)texel[1], t), (double)texel[2], n);
    return checked(surface, normal, surface->dpdu);
}
