// SPDX-License-Identifier: MIT
// The primitives of a geometry, and the box of each where it stands in the scene.
//
// A placed shape's box is the image of its own box, or for some shapes closer (shapes/reach.h). (Rays are
// brought to the shape's space in double; by how much that ray, taken back, is off the ray itself is not the
// box's matter but the ray's: kernel/ray.h.)
#include "scene/scene.h"
#include "shapes/mesh.h"
#include "shapes/reach.h"
#include "shapes/shape.h"
#include "shapes/sphere.h"
#include "shapes/spheres.h"

uint32_t sagi_shape_primitive_count(sag_shape_kind kind, const void *shape) {
    switch (kind) {
    case SAG_SHAPE_MESH: return ((const sag_mesh *)shape)->triangle_count;
    case SAG_SHAPE_SPHERES: return ((const sag_spheres *)shape)->count;
    case SAG_SHAPE_USER: return ((const sag_user *)shape)->primitive_count;
    case SAG_SHAPE_PLANE:
    case SAG_SHAPE_DISK:
    case SAG_SHAPE_RECTANGLE:
    case SAG_SHAPE_POLYGON:
    case SAG_SHAPE_SPHERE:
    case SAG_SHAPE_ELLIPSOID:
    case SAG_SHAPE_CYLINDER:
    case SAG_SHAPE_CONE:
    case SAG_SHAPE_PARABOLOID:
    case SAG_SHAPE_HYPERBOLOID:
    case SAG_SHAPE_HYPERBOLOID2:
    case SAG_SHAPE_QUADRIC:
    case SAG_SHAPE_BOX:
    case SAG_SHAPE_ORIENTED_BOX:
    case SAG_SHAPE_POLYHEDRON:
    case SAG_SHAPE_CAPSULE:
    case SAG_SHAPE_TRIANGLE:
    case SAG_SHAPE_BILINEAR_PATCH:
    case SAG_SHAPE_TORUS:
    case SAG_SHAPE_INSTANCE: break;
    }
    return 1;
}

uint32_t sagi_primitive_count(const sagi_snapshot *snapshot, uint32_t geometry) {
    const sagi_item *item = &snapshot->items[geometry];
    if (!snapshot->entries[geometry].present) return 0;
    return snapshot->solid != NULL ? 1 : sagi_shape_primitive_count((sag_shape_kind)item->kind, item->shape);
}

static sagi_primitive_state triangle_box(const sag_mesh *mesh, uint32_t triangle, sag_box3 *box) {
    sag_vec3 p[3];
    switch (sagi_mesh_triangle_state(mesh, triangle, p)) {
    case SAGI_TRIANGLE_NOT_FINITE: return SAGI_PRIMITIVE_NOT_FINITE;
    case SAGI_TRIANGLE_NO_AREA: return SAGI_PRIMITIVE_DEGENERATE;
    case SAGI_TRIANGLE_GOOD: break;
    }
    *box = sagi_corners_box(p);
    return SAGI_PRIMITIVE_GOOD;
}

// Within what floats can hold after scaling, with much room: beyond it a box culls nothing anyway.
static bool is_bounded(const sag_box3 *box) {
    sag_vec3 lo = sag_abs(box->min), hi = sag_abs(box->max);
    return sag_max_component(lo) <= 0x1p110 && sag_max_component(hi) <= 0x1p110;
}

static bool is_nan(sag_vec3 v) { return isnan(v.x) || isnan(v.y) || isnan(v.z); }

sagi_primitive_state sagi_own_box(const sagi_snapshot *snapshot, uint32_t geometry, uint32_t primitive,
                                  sag_box3 *box) {
    const sagi_item *item = &snapshot->items[geometry];
    const sagi_entry *entry = &snapshot->entries[geometry];
    sag_box3 own;
    if (item->kind == SAG_SHAPE_MESH) return triangle_box(item->shape, primitive, box);
    if (item->kind == SAG_SHAPE_SPHERES) {
        sag_vec3 center;
        double radius;
        if (!sagi_spheres_get(item->shape, primitive, &center, &radius)) return SAGI_PRIMITIVE_NOT_FINITE;
        own = sagi_sphere_bounds(center, radius);
    } else if (item->kind == SAG_SHAPE_USER) {
        const sag_user *user = item->shape;
        own = user->bounds(user->user, primitive);
        if (!sag_is_finite(own.min) || !sag_is_finite(own.max)) return SAGI_PRIMITIVE_NOT_FINITE;
        if (sag_box3_is_empty(&own)) return SAGI_PRIMITIVE_DEGENERATE;
    } else if (item->kind == SAG_SHAPE_INSTANCE) {
        if (entry->child->world.unbounded_count > 0) return SAGI_PRIMITIVE_UNBOUNDED;
        own = entry->child->stats.bounds;
        if (sag_box3_is_empty(&own)) return SAGI_PRIMITIVE_EMPTY;
    } else {
        own = sagi_shape_classes[item->kind].bounds(item->shape);
        if (is_nan(own.min) || is_nan(own.max)) return SAGI_PRIMITIVE_NOT_FINITE;
        if (sag_box3_is_empty(&own)) return SAGI_PRIMITIVE_DEGENERATE;
    }
    if (!is_bounded(&own)) return SAGI_PRIMITIVE_UNBOUNDED;
    *box = item->place != NULL
               ? sagi_shape_turned_box((sag_shape_kind)item->kind, item->shape, &own, &item->place->to_scene)
               : own;
    return is_bounded(box) ? SAGI_PRIMITIVE_GOOD : SAGI_PRIMITIVE_UNBOUNDED;
}

sagi_primitive_state sagi_primitive_box(const sagi_snapshot *snapshot, uint32_t geometry, uint32_t primitive,
                                        sag_box3 *box) {
    if (snapshot->solid == NULL) return sagi_own_box(snapshot, geometry, primitive, box);
    const sag_box3 *part = &snapshot->part_boxes[sagi_solid_part_of(snapshot->solid)[geometry]];
    if (sag_box3_is_empty(part)) return SAGI_PRIMITIVE_EMPTY;
    if (!is_bounded(part)) return SAGI_PRIMITIVE_UNBOUNDED;
    *box = *part;
    return SAGI_PRIMITIVE_GOOD;
}

sag_box3 sag_geometry_bounds(const sag_scene *scene, uint32_t geometry, uint32_t primitive) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    sag_box3 box = sag_box3_empty();
    if (s == NULL || geometry >= s->count || !s->entries[geometry].present) return box;
    const sagi_item *item = &s->items[geometry];
    if (s->entries[geometry].child == NULL &&
        primitive >= sagi_shape_primitive_count((sag_shape_kind)item->kind, item->shape) &&
        (item->kind == SAG_SHAPE_MESH || item->kind == SAG_SHAPE_SPHERES || item->kind == SAG_SHAPE_USER))
        return box;
    switch (sagi_own_box(s, geometry, primitive, &box)) {
    case SAGI_PRIMITIVE_GOOD: return box;
    case SAGI_PRIMITIVE_UNBOUNDED:
        return (sag_box3){{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
    case SAGI_PRIMITIVE_NOT_FINITE:
    case SAGI_PRIMITIVE_DEGENERATE:
    case SAGI_PRIMITIVE_EMPTY: break;
    }
    return sag_box3_empty();
}
