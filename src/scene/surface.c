// SPDX-License-Identifier: MIT
// Everything about a hit, in the scene's space.
//
// The shape works out its surface in its own space, for the very ray the kernel gave it: the same maps
// applied in the same order give the same bits. Then the surface is mapped outward, level by level:
//
//     position  p' = M p + s          tangents  M dp/du, M dp/dv          normals  M⁻ᵀ n, made unit
//
// M⁻ᵀ n is perpendicular to M v for every v perpendicular to n, and on the side n was on also when M mirrors,
// so outward stays outward.
//
// The position's error bound e is there for rays spawned at the surface. Such a ray starts at p' + w with
// n'·w = Σ|n'ᵢ| e'ᵢ at least (src/shapes/spawn.h), and is brought back by the computed inverse X = M⁻¹(1 + ε)
// in double. Let it be off by r in each coordinate then. Along the object's unit normal n, which is Mᵀn'
// scaled by 1/|Mᵀn'|, the start is (n'·w)/|Mᵀn'| away from where p' comes back to, and it must be
// Σ|nᵢ|(eᵢ + rᵢ) away to be clear of the surface. Because
//     Σᵢ |(Mᵀn')ᵢ| (eᵢ + rᵢ) ≤ Σⱼ |n'ⱼ| (|M|(e + r))ⱼ,
// e' = |M|(e + r) is enough. r is the rounding of both ways: forth 4u(|M||p| + |s|), which counts in the
// scene's space; back 6u(|X|(|M||p| + |s|) + |x|), x being the translation back, three products, three sums
// and the last bit of X's own elements. With 2⁻⁵⁰ = 8u for both,
//     e' = |M| (e + 2⁻⁵⁰ (|X| g + |x|)) + 2⁻⁵⁰ g,   g = |M||p| + |s|.
// tests/unit/test_scene_surface.c spawns rays from surfaces under nested transforms of all sizes.
#include "scene/scene.h"
#include "shapes/shape.h"

static sag_vec3 absolute_linear(const sag_affine *a, sag_vec3 v) { // |A| v
    double r[3];
    for (int i = 0; i < 3; i++)
        r[i] = fabs(a->m[i][0]) * v.x + fabs(a->m[i][1]) * v.y + fabs(a->m[i][2]) * v.z;
    return sag_vec3_make(r[0], r[1], r[2]);
}

static sag_vec3 absolute_translation(const sag_affine *a) {
    return sag_vec3_make(fabs(a->m[0][3]), fabs(a->m[1][3]), fabs(a->m[2][3]));
}

void sagi_surface_map(const sagi_place *place, sag_surface *s) {
    const sag_affine *m = &place->to_scene, *x = &place->to_object;
    sag_vec3 g = sag_add(absolute_linear(m, sag_abs(s->position)), absolute_translation(m));
    sag_vec3 r = sag_add(absolute_linear(x, g), absolute_translation(x));
    s->position = sag_affine_point(m, s->position);
    s->position_error = sag_madd(absolute_linear(m, sag_madd(s->position_error, 0x1p-50, r)), 0x1p-50, g);
    s->geometric_normal = sag_normalize(sag_affine_transposed(x, s->geometric_normal));
    s->shading_normal = sag_normalize(sag_affine_transposed(x, s->shading_normal));
    s->dpdu = sag_affine_vector(m, s->dpdu);
    s->dpdv = sag_affine_vector(m, s->dpdv);
}

void sagi_surface_turn(sag_surface *s) {
    s->geometric_normal = sag_neg(s->geometric_normal);
    s->shading_normal = sag_neg(s->shading_normal);
}

static void turn_over(sag_surface *s) {
    sagi_surface_turn(s);
    s->side = s->side == SAG_SIDE_FRONT ? SAG_SIDE_BACK : SAG_SIDE_FRONT;
}

// The surface in the space of one snapshot. A mirrored mesh's vertices stand where they stand, so its
// triangles' own normals point the other way round: both normals and the side are turned.
static void surface_here(const sagi_kernel *kernel, const sagi_snapshot *s, const sag_ray *ray,
                         const sag_hit *hit, sag_surface *surface) {
    const sagi_item *item = &s->items[hit->geometry];
    if (item->kind == SAG_SHAPE_MESH) {
        kernel->mesh_surface(item->shape, ray, hit, surface);
        if (item->mirrored) turn_over(surface);
        return;
    }
    *surface = (sag_surface){.geometry = SAG_INVALID_ID}; // whatever a user's shape leaves out
    sag_ray local = item->place != NULL ? sag_ray_transform(&item->place->to_object, ray) : *ray;
    sagi_shape_classes[item->kind].surface(item->shape, &local, hit, surface);
    if (item->place != NULL) sagi_surface_map(item->place, surface);
}

void sag_instance_map_surface(const sag_scene *scene, uint32_t instance, sag_surface *surface) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    if (s == NULL || instance >= s->count || s->entries[instance].child == NULL) return;
    if (s->items[instance].place != NULL) sagi_surface_map(s->items[instance].place, surface);
}

// In a solid's space: crossings within 2⁻⁴⁹ (t|dᵢ| + |oᵢ|) of each other are one boundary (solid.h), which a
// ray spawned there must leave behind as a whole. Along the ray they are at most √3 times as far apart as the
// largest coordinate says: twice that covers them, whichever way their faces look.
static void clear_group(const sag_ray *ray, double t, sag_surface *surface) {
    double reach =
        sag_max_component(sag_abs(ray->origin)) + fabs(t) * sag_max_component(sag_abs(ray->direction));
    double error = 0x1p-48 * reach;
    surface->position_error = sag_add(surface->position_error, sag_vec3_make(error, error, error));
}

// Whether the hit names something that is there: it may be from before a commit.
static bool has(const sagi_snapshot *s, const sag_hit *hit) {
    if (hit->geometry >= s->count || s->items[hit->geometry].shape == NULL) return false;
    const sagi_item *item = &s->items[hit->geometry];
    if (item->kind == SAG_SHAPE_MESH) return hit->primitive < ((const sag_mesh *)item->shape)->triangle_count;
    bool many = item->kind == SAG_SHAPE_SPHERES || item->kind == SAG_SHAPE_USER;
    return !many || hit->primitive < sagi_shape_primitive_count((sag_shape_kind)item->kind, item->shape);
}

// The surface in the scene's space of a hit in an instance. False: it is not there. *found: in this snapshot.
static bool surface_within(const sag_scene *scene, const sag_ray *ray, const sag_hit *hit,
                           sag_surface *surface, const sagi_snapshot **found) {
    const sagi_snapshot *s = *found;
    const sagi_place *places[SAG_MAX_INSTANCE_DEPTH];
    const sagi_snapshot *levels[SAG_MAX_INSTANCE_DEPTH];
    sag_ray rays[SAG_MAX_INSTANCE_DEPTH];
    const uint32_t depth = hit->instance_depth;
    if (depth > SAG_MAX_INSTANCE_DEPTH) return false;
    sag_ray here = *ray;
    for (uint32_t i = 0; i < depth; i++) {
        uint32_t id = hit->instance_path[i];
        if (id >= s->count || s->entries[id].child == NULL) return false;
        levels[i] = s, rays[i] = here;
        places[i] = s->items[id].place;
        if (places[i] != NULL) here = sag_ray_transform(&places[i]->to_object, &here);
        s = s->entries[id].child;
    }
    if (!has(s, hit)) return false;
    surface_here(scene->kernel, s, &here, hit, surface);
    if (s->solid != NULL) clear_group(&here, hit->t, surface);
    for (uint32_t i = depth; i-- > 0;) {
        if (places[i] != NULL) sagi_surface_map(places[i], surface);
        if (levels[i]->solid != NULL) clear_group(&rays[i], hit->t, surface);
    }
    *found = s;
    return true;
}

static bool surface_without(const sag_scene *scene, const sag_ray *ray, const sag_hit *hit,
                            sag_surface *surface, const sagi_snapshot *s) {
    if (!has(s, hit)) return false;
    surface_here(scene->kernel, s, ray, hit, surface);
    if (s->solid != NULL) clear_group(ray, hit->t, surface);
    return true;
}

void sag_surface_at(const sag_scene *scene, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    const bool there = s != NULL && (hit->instance_depth == 0 ? surface_without(scene, ray, hit, surface, s)
                                                              : surface_within(scene, ray, hit, surface, &s));
    if (!there) {
        *surface = (sag_surface){.geometry = SAG_INVALID_ID};
        return;
    }
    if (hit->flipped) turn_over(surface);
    const sagi_entry *entry = &s->entries[hit->geometry];
    surface->geometry = hit->geometry;
    surface->user_data = entry->user_data;
    if (entry->face_forward && surface->side == SAG_SIDE_BACK) sagi_surface_turn(surface);
}
