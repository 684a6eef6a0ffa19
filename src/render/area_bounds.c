// SPDX-License-Identifier: MIT
// What the tree of lights is told of shining geometry: a box, how bright it is at most, and the cone of its
// normals. Flat pieces have one normal; bent ones are taken to have all, and then to show about a quarter of
// their area (what a convex body shows on average, by Cauchy).
#include "area.h"

#include "shapes/mesh.h"

// Whether the vertices' normals agree which side of the triangle is the front.
static bool normals_agree(const sag_mesh *mesh, uint32_t i, sag_vec3 normal) {
    if (!mesh->normals_f32) return true;
    int ahead = 0, behind = 0;
    for (size_t k = 0; k < 3; k++) {
        const float *n = &mesh->normals_f32[3 * (size_t)mesh->triangles[3 * (size_t)i + k]];
        const double side = sag_dot(normal, sag_vec3_make(n[0], n[1], n[2]));
        ahead += side > 0, behind += side < 0;
    }
    return ahead == 0 || behind == 0;
}

static sag_box3 facet_box(const sagi_facet *facet) {
    const sag_vec3 b = sag_add(facet->a, facet->e), c = sag_add(facet->a, facet->f);
    sag_box3 box = sag_box3_extend(sag_box3_extend((sag_box3){facet->a, facet->a}, b), c);
    return facet->parallelogram ? sag_box3_extend(box, sag_add(b, facet->f)) : box;
}

sagi_light_bounds sagi_area_bounds(const sagi_areas *areas, uint32_t index) {
    const sagi_area *area = &areas->areas[index];
    const sagi_area_group *group = sagi_area_group_of(areas, index);
    const sagi_appearance *appearance = sagi_area_appearance(areas, index);
    const uint32_t primitive = index - group->first;
    sagi_light_bounds bounds = {
        .axis = {0, 0, 1}, .cos_normals = -1, .two_sided = appearance->look.two_sided};
    if (!(area->density > 0)) return bounds;
    bounds.intensity = appearance->brightness;
    if (!appearance->look.emission_over_area) bounds.intensity /= area->density;
    if (group->kind == SAGI_AREA_FACET) {
        sagi_facet facet;
        sagi_area_facet(areas, index, &facet);
        bounds.box = facet_box(&facet);
    } else if (area->ball != SAG_INVALID_ID) {
        const sagi_ball *ball = (const sagi_ball *)areas->balls.items + area->ball;
        const sag_vec3 r = {ball->radius, ball->radius, ball->radius};
        bounds.box = (sag_box3){sag_sub(ball->center, r), sag_add(ball->center, r)};
    } else {
        const sag_box3 box = sag_geometry_bounds(group->scene, group->geometry, primitive);
        bounds.box = group->depth > 0 ? sag_affine_box(&group->outward, &box) : box;
    }
    sag_surface at;
    double density;
    if (!sag_is_finite(bounds.box.min) || !sag_is_finite(bounds.box.max)) bounds.intensity = 0;
    if (!group->flat) {
        bounds.intensity /= 4;
        return bounds;
    }
    if (!sag_geometry_sample(group->scene, group->geometry, primitive, (sag_vec2){0.5, 0.5}, &at, &density)) {
        bounds.intensity = 0;
        return bounds;
    }
    const sag_vec3 own = at.geometric_normal;
    if (group->depth > 0) sagi_area_map_outward(areas, group, &at);
    sagi_orient(appearance, &at);
    bounds.axis = at.geometric_normal;
    bounds.cos_normals = 1;
    // (A mesh's normals are in its own space, where `own` may be mirrored: only whether they agree matters.)
    if (group->shape_kind == SAG_SHAPE_MESH && !normals_agree(group->shape, primitive, own))
        bounds.two_sided = true;
    return bounds;
}
