// SPDX-License-Identifier: MIT
// Which primitives splits of space (bvh/spatial.c) may cut: triangles of meshes alone. Long thin ones are
// what such splits are for; and a ray crosses a triangle once, so that its crossings, found in several
// leaves, can be told by its numbers (kernel/collect.c).
#include "scene/scene.h"
#include "shapes/mesh.h"

// (x − C)·2⁻ᵏ: the difference is rounded once, and at most 1 when scaled; scaling is exact.
bool sagi_primitive_corners(const void *snapshot, const sagi_bvh_primitive *primitive, double corner[3][3]) {
    const sagi_snapshot *s = snapshot;
    if (primitive->geometry == SAGI_LONE_SPHERES) return false;
    const sagi_item *item = &s->items[primitive->geometry];
    if (item->kind != SAG_SHAPE_MESH || s->solid != NULL) return false;
    sag_vec3 vertex[3];
    sagi_mesh_triangle(item->shape, primitive->primitive, vertex);
    for (int i = 0; i < 3; i++) {
        sag_vec3 d = sag_sub(vertex[i], s->world.origin);
        corner[i][0] = d.x * s->world.scale;
        corner[i][1] = d.y * s->world.scale;
        corner[i][2] = d.z * s->world.scale;
    }
    return true;
}
