// SPDX-License-Identifier: MIT
// Points of shining geometry, and the density of the directions to them.
//
// Flat pieces are sampled over the directions they fill (area_flat.c), balls by their cone (ball.c); all
// else, and these beyond their limits, uniformly by area or as the shape says: a density p by area is p
// d²/|cos θ| per solid angle. Which way is taken is a function of the light and of the point that is shone
// on, so that the density of a direction found in another way is known.
//
// A bent bilinear patch is sampled by its parameters, in proportion to the area element dA = |∂p/∂u × ∂p/∂v|
// at its corners and bilinear between: that is a density of p(u, v)/dA by area.
//
// Within instances a point is drawn in the instance's own scene and brought outward. The map p ↦ M p + s
// enlarges a small piece of surface of unit normal n by J = |det M| |M⁻ᵀ n|.
#include "area.h"

#include "shapes/mesh.h"
#include "warp.h"

// The corners in the world's space; of a group of the kind SAGI_AREA_FACET.
static void facet_of(const sagi_area_group *group, uint32_t primitive, sagi_facet *facet) {
    sag_vec3 corner[3];
    facet->parallelogram = false;
    if (group->shape_kind == SAG_SHAPE_MESH) {
        sagi_mesh_triangle(group->shape, primitive, corner);
    } else if (group->shape_kind == SAG_SHAPE_TRIANGLE) {
        const sag_triangle *t = group->shape;
        corner[0] = t->a, corner[1] = t->b, corner[2] = t->c;
    } else if (group->shape_kind == SAG_SHAPE_RECTANGLE) {
        const sag_rectangle *r = group->shape;
        *facet = (sagi_facet){.a = r->corner, .e = r->edge_u, .f = r->edge_v, .parallelogram = true};
    } else {
        const sag_bilinear_patch *p = group->shape;
        *facet = (sagi_facet){
            .a = p->p00, .e = sag_sub(p->p10, p->p00), .f = sag_sub(p->p01, p->p00), .parallelogram = true};
    }
    if (!facet->parallelogram)
        *facet = (sagi_facet){
            .a = corner[0], .e = sag_sub(corner[1], corner[0]), .f = sag_sub(corner[2], corner[0])};
    if (group->moved) {
        facet->a = sag_affine_point(&group->to_world, facet->a);
        facet->e = sag_affine_vector(&group->to_world, facet->e);
        facet->f = sag_affine_vector(&group->to_world, facet->f);
    }
    sagi_facet_measure(facet);
}

void sagi_area_facet(const sagi_areas *areas, uint32_t index, sagi_facet *facet) {
    const sagi_area_group *group = sagi_area_group_of(areas, index);
    facet_of(group, index - group->first, facet);
}

// The area element at the corners (0, 0), (1, 0), (0, 1), (1, 1) of a patch, or, `at` given, at that one.
static void patch_elements(const sagi_area_group *group, const sag_vec2 *at, double *elements) {
    const sag_bilinear_patch *p = group->shape;
    sag_vec3 u_edge = sag_sub(p->p10, p->p00), v_edge = sag_sub(p->p01, p->p00);
    sag_vec3 twist = sag_sub(sag_sub(p->p11, p->p10), v_edge);
    if (group->moved) {
        u_edge = sag_affine_vector(&group->to_world, u_edge);
        v_edge = sag_affine_vector(&group->to_world, v_edge);
        twist = sag_affine_vector(&group->to_world, twist);
    }
    for (int i = 0; i < (at ? 1 : 4); i++) {
        const sag_vec2 uv = at ? *at : (sag_vec2){i & 1, i >> 1};
        elements[i] = sag_length(sag_cross(sag_madd(u_edge, uv.y, twist), sag_madd(v_edge, uv.x, twist)));
    }
}

double sagi_area_of_patch(const sagi_area_group *group) {
    double sum = 0;
    for (int i = 0; i < 256; i++) {
        double element;
        const sag_vec2 at = {(i % 16 + 0.5) / 16, (i / 16 + 0.5) / 16};
        patch_elements(group, &at, &element);
        sum += element / 256;
    }
    return sum;
}

// The density by area with which the point uv of a patch is found.
static double patch_density(const sagi_area_group *group, sag_vec2 uv) {
    double weights[4], here;
    patch_elements(group, NULL, weights);
    patch_elements(group, &uv, &here);
    return sagi_warp_bilinear_pdf(weights, uv) / here;
}

double sagi_area_enlargement(const sagi_area_group *group, sag_vec3 normal) {
    if (group->depth == 0) return 1;
    return group->outward_volume * sag_length(sag_affine_transposed(&group->inward, normal));
}

void sagi_area_map_outward(const sagi_areas *areas, const sagi_area_group *group, sag_surface *surface) {
    const sag_scene *scenes[SAG_MAX_INSTANCE_DEPTH + 1] = {areas->world->scene};
    for (uint32_t i = 0; i < group->depth; i++) scenes[i + 1] = sag_instance_scene(scenes[i], group->path[i]);
    for (uint32_t i = group->depth; i-- > 0;) sag_instance_map_surface(scenes[i], group->path[i], surface);
}

void sagi_area_meet(const sagi_areas *areas, const sagi_area_group *group, uint32_t primitive, sag_vec3 from,
                    sag_vec3 wi, double t, sag_vec2 uv, sag_surface *surface) {
    const sag_ray ray = sag_ray_make(from, wi);
    sag_hit hit = {.t = t,
                   .u = uv.x,
                   .v = uv.y,
                   .primitive = primitive,
                   .geometry = group->geometry,
                   .instance_depth = group->depth};
    for (uint32_t i = 0; i < group->depth; i++) hit.instance_path[i] = group->path[i];
    sag_surface_at(areas->world->scene, &ray, &hit, surface);
}

bool sagi_area_point(const sagi_areas *areas, uint32_t index, sag_vec2 u, sag_surface *surface,
                     double *density) {
    const sagi_area_group *group = sagi_area_group_of(areas, index);
    if (!(areas->areas[index].density > 0) ||
        !sag_geometry_sample(group->scene, group->geometry, index - group->first, u, surface, density))
        return false;
    if (group->flat)
        *density = areas->areas[index].density;
    else
        *density /= sagi_area_enlargement(group, surface->geometric_normal);
    if (group->depth > 0) sagi_area_map_outward(areas, group, surface);
    return *density > 0 && isfinite(*density);
}

static bool sample_by_area(const sagi_areas *areas, uint32_t index, const sagi_shading_point *from,
                           sag_vec2 u, sag_surface *surface, sag_vec3 *wi, double *pdf) {
    double density;
    if (!sagi_area_point(areas, index, u, surface, &density)) return false;
    const sag_vec3 d = sag_sub(surface->position, from->position);
    const double distance2 = sag_dot(d, d);
    *wi = sag_scale(d, 1 / sqrt(distance2));
    *pdf = density * distance2 / fabs(sag_dot(*wi, surface->geometric_normal));
    return *pdf > 0 && isfinite(*pdf);
}

static bool sample_patch(const sagi_areas *areas, uint32_t index, const sagi_shading_point *from, sag_vec2 u,
                         sag_surface *surface, sag_vec3 *wi, double *pdf) {
    const sagi_area_group *group = sagi_area_group_of(areas, index);
    const sag_bilinear_patch *p = group->shape;
    double weights[4];
    patch_elements(group, NULL, weights);
    const sag_vec2 uv = sagi_warp_bilinear(weights, u);
    const sag_vec3 a = sag_madd(p->p00, uv.x, sag_sub(p->p10, p->p00)),
                   b = sag_madd(p->p01, uv.x, sag_sub(p->p11, p->p01));
    sag_vec3 at = sag_madd(a, uv.y, sag_sub(b, a));
    if (group->moved) at = sag_affine_point(&group->to_world, at);
    const sag_vec3 d = sag_sub(at, from->position);
    const double distance = sag_length(d);
    if (!(distance > 0)) return false;
    *wi = sag_scale(d, 1 / distance);
    sagi_area_meet(areas, group, 0, from->position, *wi, distance, uv, surface);
    *pdf = patch_density(group, uv) * distance * distance / fabs(sag_dot(*wi, surface->geometric_normal));
    return *pdf > 0 && isfinite(*pdf);
}

static bool sample_ball(const sagi_areas *areas, uint32_t index, double cone, const sagi_shading_point *from,
                        sag_vec2 u, sag_surface *surface, sag_vec3 *wi, double *pdf) {
    const sagi_area_group *group = sagi_area_group_of(areas, index);
    const sagi_ball *ball = (const sagi_ball *)areas->balls.items + areas->areas[index].ball;
    sagi_ball_sample(ball, from->position, cone, u, surface);
    surface->primitive = index - group->first;
    const sag_vec3 d = sag_sub(surface->position, from->position);
    const double distance = sag_length(d);
    *wi = sag_scale(d, 1 / distance);
    *pdf = 1 / (2 * SAGI_RENDER_PI * cone);
    // A ball's point alone has no texture coordinates.
    const sag_appearance *look = &sagi_area_appearance(areas, index)->look;
    if (group->depth > 0 || look->emission_texture || look->alpha.texture)
        sagi_area_meet(areas, group, surface->primitive, from->position, *wi, distance, (sag_vec2){0, 0},
                       surface);
    return distance > 0 && isfinite(*pdf);
}

bool sagi_area_sample(const sagi_areas *areas, uint32_t index, const sagi_shading_point *from, sag_vec2 u,
                      sag_surface *surface, sag_vec3 *wi, double *pdf) {
    const sagi_area_group *group = sagi_area_group_of(areas, index);
    const sagi_area *area = &areas->areas[index];
    if (!(area->density > 0)) return false;
    if (areas->flats && areas->flats[index].ready)
        return sagi_flat_sample(areas, index, from, u, surface, wi, pdf);
    const double cone =
        area->ball == SAG_INVALID_ID
            ? 0
            : sagi_ball_cone((const sagi_ball *)areas->balls.items + area->ball, from->position);
    sagi_facet facet;
    sagi_facet_view view;
    if (cone > 0) {
        if (!sample_ball(areas, index, cone, from, u, surface, wi, pdf)) return false;
    } else if (group->kind == SAGI_AREA_FACET &&
               (facet_of(group, index - group->first, &facet), sagi_facet_fills(&facet, from, &view))) {
        double t;
        sag_vec2 uv;
        *wi = sagi_facet_sample(&view, u, pdf);
        sagi_facet_meet(&facet, from->position, *wi, &uv.x, &uv.y, &t);
        if (!(t > 0) || !isfinite(t)) return false;
        sagi_area_meet(areas, group, index - group->first, from->position, *wi, t, uv, surface);
    } else if (group->kind == SAGI_AREA_PATCH) {
        if (!sample_patch(areas, index, from, u, surface, wi, pdf)) return false;
    } else if (!sample_by_area(areas, index, from, u, surface, wi, pdf)) {
        return false;
    }
    sagi_replace_texcoords(sagi_area_appearance(areas, index), surface);
    sagi_orient(sagi_area_appearance(areas, index), surface);
    return fabs(sag_dot(*wi, surface->geometric_normal)) > 0;
}

double sagi_area_pdf(const sagi_areas *areas, uint32_t index, const sagi_shading_point *from, sag_vec3 wi,
                     const sag_hit *hit, const sag_surface *surface) {
    const sagi_area_group *group = sagi_area_group_of(areas, index);
    const sagi_area *area = &areas->areas[index];
    if (!(area->density > 0)) return 0;
    double pdf, density = area->density;
    if (area->ball != SAG_INVALID_ID) {
        const double cone =
            sagi_ball_cone((const sagi_ball *)areas->balls.items + area->ball, from->position);
        if (cone > 0) return 1 / (2 * SAGI_RENDER_PI * cone);
    }
    if (group->kind == SAGI_AREA_FACET) {
        const sagi_flat *flat = areas->flats ? &areas->flats[index] : NULL;
        const bool ready = flat && flat->ready;
        sagi_facet facet;
        sagi_facet_view view;
        if (!ready) facet_of(group, index - group->first, &facet);
        if (sagi_facet_fills(ready ? &flat->facet : &facet, from, &view)) {
            pdf = sagi_facet_pdf(&view, wi);
            return isfinite(pdf) ? pdf : 0;
        }
    }
    if (group->kind == SAGI_AREA_PATCH) {
        density = patch_density(group, (sag_vec2){hit->u, hit->v});
    } else if (!group->flat) {
        sag_surface inner = {.geometric_normal = surface->geometric_normal};
        if (group->depth > 0)
            inner.geometric_normal =
                sag_normalize(sag_affine_transposed(&group->outward, surface->geometric_normal));
        density = sag_geometry_density(group->scene, group->geometry, hit->primitive, &inner) /
                  sagi_area_enlargement(group, inner.geometric_normal);
    }
    const sag_vec3 d = sag_sub(surface->position, from->position);
    pdf = density * sag_dot(d, d) / fabs(sag_dot(wi, surface->geometric_normal));
    return isfinite(pdf) ? pdf : 0;
}
