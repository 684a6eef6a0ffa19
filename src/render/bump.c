// SPDX-License-Identifier: MIT
// Bump maps (Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978) and normal maps.
//
// A surface p(u, v) moved along its normal n by d(u, v) has the tangents
//   ∂p/∂u + ∂d/∂u n + d ∂n/∂u,   ∂p/∂v + ∂d/∂v n + d ∂n/∂v,
// and the normal across them. The derivatives of d are differences over half the pixel's footprint, so that
// what is finer than a pixel does not alias, or over 0.0005 where there is none (pbrt-v4's rule).
//
// No shape says how its normal changes. It is asked for two more surfaces nearby instead: where the hit's own
// numbers say what point it is (meshes, patches) those of other numbers, else those of rays beside the ray.
// Their points, minus the first one, span the tangent plane, and what is a sum of them changes the normal by
// the same sum. Only bumps ask.
//
// Tangents are taken perpendicular to the shading normal first: where normals are interpolated, dpdu and dpdv
// lie in the flat triangle. On meshes with normals, pbrt-v4 takes for ∂p/∂v the direction across the normal
// and ∂p/∂u with the length of the latter; so bumps do here: they are steeper or flatter than they would be
// where coordinates are stretched.
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

// Steps to the surfaces nearby, in a triangle's own numbers and in u and v.
#define NEARBY 1e-4

// ∂n/∂u and ∂n/∂v, 0 where they cannot be found.
static void normal_changes(const sagi_origin *origin, const sag_surface *surface, sag_vec3 changes[2]) {
    const sag_vec3 tangents[2] = {surface->dpdu, surface->dpdv};
    sag_surface here;
    sag_vec3 moved[2], turned[2];
    changes[0] = changes[1] = sag_vec3_make(0, 0, 0);
    sag_surface_at(origin->scene, origin->ray, origin->hit, &here);
    for (int k = 0; k < 2; k++) {
        sag_surface beside;
        sag_hit hit = *origin->hit;
        *(k ? &hit.v : &hit.u) += NEARBY;
        sag_surface_at(origin->scene, origin->ray, &hit, &beside);
        moved[k] = sag_sub(beside.position, here.position);
        if (sag_dot(moved[k], moved[k]) == 0) {
            sag_ray ray = *origin->ray;
            moved[k] = sag_scale(tangents[k], NEARBY);
            ray.origin = sag_add(ray.origin, moved[k]);
            sag_surface_at(origin->scene, &ray, origin->hit, &beside);
        }
        turned[k] = sag_sub(beside.shading_normal, here.shading_normal);
        if (sag_dot(here.shading_normal, surface->shading_normal) < 0) turned[k] = sag_neg(turned[k]);
    }
    const sag_vec3 normal = sag_cross(moved[0], moved[1]);
    const double squared = sag_dot(normal, normal);
    for (int k = 0; k < 2; k++) {
        const double first = sag_dot(sag_cross(tangents[k], moved[1]), normal) / squared,
                     second = sag_dot(sag_cross(moved[0], tangents[k]), normal) / squared;
        const sag_vec3 change = sag_madd(sag_scale(turned[0], first), second, turned[1]);
        if (sag_is_finite(change)) changes[k] = change;
    }
}

sagi_shading_frame sagi_bumped_frame(const sag_world *world, const sag_input *displacement,
                                     const sag_surface *surface, const sagi_origin *origin,
                                     const sagi_spot *at) {
    const sag_vec3 n = surface->shading_normal, dpdu = across(surface->dpdu, n);
    const sag_vec3 dpdv = origin && origin->smooth_mesh ? sag_cross(n, dpdu) : across(surface->dpdv, n);
    double du = 0.5 * (fabs(at->dudx) + fabs(at->dudy)), dv = 0.5 * (fabs(at->dvdx) + fabs(at->dvdy));
    if (!(du > 0)) du = SMALL_STEP;
    if (!(dv > 0)) dv = SMALL_STEP;
    sagi_spot along_u = *at, along_v = *at;
    along_u.position = sag_madd(at->position, du, dpdu), along_u.u += du;
    along_v.position = sag_madd(at->position, dv, dpdv), along_v.v += dv;
    const double here = sagi_input_number(world, displacement, at);
    const double u_slope = (sagi_input_number(world, displacement, &along_u) - here) / du;
    const double v_slope = (sagi_input_number(world, displacement, &along_v) - here) / dv;
    sag_vec3 u = sag_madd(dpdu, u_slope, n), v = sag_madd(dpdv, v_slope, n);
    if (origin && here != 0) {
        sag_vec3 changes[2];
        normal_changes(origin, surface, changes);
        u = sag_madd(u, here, changes[0]), v = sag_madd(v, here, changes[1]);
    }
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
