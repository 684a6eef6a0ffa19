// SPDX-License-Identifier: MIT
// Texture mappings, as pbrt-v4 defines them, each with its derivatives by the chain rule:
//   uv           (u·scale + offset, v·scale + offset)
//   spherical    (θ/π, φ/2π), θ from +z, φ from +x to +y in [0, 2π)
//   cylindrical  ((π + φ)/2π, z), φ in (−π, π]
//   planar       (p·v1 + offset, p·v2 + offset)
// the last three of the point in the texture's space.
//
// How (u, v) changes over a pixel follows from how the point does: dp ≈ dpdu du + dpdv dv has three equations
// for two unknowns, since dp was found in the tangent plane of another point or of the flat triangle. The
// least-squares solution is that of the normal equations, 2×2.
#include "mapping.h"

#include "color.h"
#include "math/map.h"

#include <string.h>

void sagi_mapping_init(sagi_mapping *mapping, const sag_mapping *description) {
    mapping->mapping = *description;
    sag_mapping *m = &mapping->mapping;
    static const sag_affine zero;
    mapping->moved = memcmp(&m->world_to_texture, &zero, sizeof zero) != 0 &&
                     !sag_affine_is_identity(&m->world_to_texture);
    if (m->u_scale == 0) m->u_scale = 1;
    if (m->v_scale == 0) m->v_scale = 1;
    if (m->v1.x == 0 && m->v1.y == 0 && m->v1.z == 0) m->v1.x = 1;
    if (m->v2.x == 0 && m->v2.y == 0 && m->v2.z == 0) m->v2.y = 1;
}

sagi_spot_3d sagi_mapping_3d(const sagi_mapping *mapping, const sagi_spot *at) {
    if (!mapping->moved) return (sagi_spot_3d){at->position, at->dpdx, at->dpdy};
    const sag_affine *a = &mapping->mapping.world_to_texture;
    return (sagi_spot_3d){sagi_affine_point(a, at->position), sagi_affine_vector(a, at->dpdx),
                          sagi_affine_vector(a, at->dpdy)};
}

// s, t and their gradients in texture space to the coordinates there.
static sagi_spot_2d with_gradients(const sagi_spot_3d *at, double s, double t, sag_vec3 ds, sag_vec3 dt) {
    return (sagi_spot_2d){
        s, t, sag_dot(ds, at->dpdx), sag_dot(ds, at->dpdy), sag_dot(dt, at->dpdx), sag_dot(dt, at->dpdy)};
}

static bool has_extent(const sagi_spot_3d *at) {
    return !(sag_dot(at->dpdx, at->dpdx) + sag_dot(at->dpdy, at->dpdy) == 0);
}

// On the axis, where φ has no derivative, the coordinates are taken for a point's.
static sagi_spot_2d spherical(const sagi_spot_3d *at) {
    const sag_vec3 p = at->p;
    const double across2 = p.x * p.x + p.y * p.y, across = sqrt(across2), r2 = across2 + p.z * p.z;
    double phi = sagi_atan2(p.y, p.x);
    if (phi < 0) phi += 2 * SAGI_RENDER_PI;
    const double s = sagi_atan2(across, p.z) * SAGI_INV_PI, t = phi * (SAGI_INV_PI / 2);
    if (!(across2 > 0) || !has_extent(at)) return (sagi_spot_2d){.s = s, .t = t};
    const double a = SAGI_INV_PI / (r2 * across), b = SAGI_INV_PI / 2 / across2;
    const sag_vec3 ds = {p.x * p.z * a, p.y * p.z * a, -across2 * a}, dt = {-p.y * b, p.x * b, 0};
    return with_gradients(at, s, t, ds, dt);
}

static sagi_spot_2d cylindrical(const sagi_spot_3d *at) {
    const sag_vec3 p = at->p;
    const double across2 = p.x * p.x + p.y * p.y,
                 s = (SAGI_RENDER_PI + sagi_atan2(p.y, p.x)) * (SAGI_INV_PI / 2);
    if (!(across2 > 0) || !has_extent(at)) return (sagi_spot_2d){.s = s, .t = p.z};
    const double b = SAGI_INV_PI / 2 / across2;
    const sag_vec3 ds = {-p.y * b, p.x * b, 0}, dt = {0, 0, 1};
    return with_gradients(at, s, p.z, ds, dt);
}

sagi_spot_2d sagi_mapping_2d(const sagi_mapping *mapping, const sagi_spot *at) {
    const sag_mapping *m = &mapping->mapping;
    if (m->kind == SAG_MAPPING_UV)
        return (sagi_spot_2d){m->u_scale * at->u + m->u_offset,
                              m->v_scale * at->v + m->v_offset,
                              m->u_scale * at->dudx,
                              m->u_scale * at->dudy,
                              m->v_scale * at->dvdx,
                              m->v_scale * at->dvdy};
    const sagi_spot_3d in = sagi_mapping_3d(mapping, at);
    switch (m->kind) {
    case SAG_MAPPING_UV: break;
    case SAG_MAPPING_SPHERICAL: return spherical(&in);
    case SAG_MAPPING_CYLINDRICAL: return cylindrical(&in);
    case SAG_MAPPING_PLANAR:
        return with_gradients(&in, sag_dot(in.p, m->v1) + m->u_offset, sag_dot(in.p, m->v2) + m->v_offset,
                              m->v1, m->v2);
    }
    return (sagi_spot_2d){0};
}

void sagi_spot_at(sagi_spot *spot, const sag_surface *surface) {
    spot->position = surface->position, spot->normal = surface->geometric_normal;
    spot->u = surface->u, spot->v = surface->v;
    spot->dpdx = spot->dpdy = sag_vec3_make(0, 0, 0);
    spot->dudx = spot->dudy = spot->dvdx = spot->dvdy = 0;
}

// Changes beyond this bound, as pbrt-v4's, come from degenerate coordinates only.
static double bounded(double x) { return isfinite(x) ? sagi_clamp(x, -1e8, 1e8) : 0; }

void sagi_spot_set_uv(sagi_spot *spot, sag_vec3 dpdu, sag_vec3 dpdv) {
    const double uu = sag_dot(dpdu, dpdu), uv = sag_dot(dpdu, dpdv), vv = sag_dot(dpdv, dpdv);
    const double inverse = 1 / (uu * vv - uv * uv);
    if (!isfinite(inverse)) {
        spot->dudx = spot->dudy = spot->dvdx = spot->dvdy = 0;
        return;
    }
    const double ux = sag_dot(dpdu, spot->dpdx), vx = sag_dot(dpdv, spot->dpdx);
    const double uy = sag_dot(dpdu, spot->dpdy), vy = sag_dot(dpdv, spot->dpdy);
    spot->dudx = bounded((vv * ux - uv * vx) * inverse);
    spot->dvdx = bounded((uu * vx - uv * ux) * inverse);
    spot->dudy = bounded((vv * uy - uv * vy) * inverse);
    spot->dvdy = bounded((uu * vy - uv * uy) * inverse);
}
