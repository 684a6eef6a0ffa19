// SPDX-License-Identifier: MIT
// The nearest point: branch and bound. Nodes are visited nearest first, and one that is certainly farther
// away than the best point so far is left out.
//
// Distances are measured in the scene's space. A node of a world under the map M (an instance, or instances
// in instances) is compared in its own space, where its boxes are boxes: |M v| ≥ stretch_min |v|, so
//     distance ≥ stretch_min · distance there.
// The bound is lowered by the roundings: 2⁻⁴⁸ of itself, and the error of the point's own image there,
// 2⁻⁵⁰(|M⁻¹||p| + |s⁻¹|) in each coordinate.
//
// Triangles are brought to the scene's space, so they are exact under any map. The other shapes answer in
// their own space, which is the same question only when the map keeps ratios of lengths.
#include "kernel/block.h"
#include "math/elementary.h"
#include "scene/scene.h"
#include "shapes/mesh.h"
#include "shapes/shape.h"
#include "shapes/sphere.h"
#include "shapes/spheres.h"

typedef struct search {
    sag_vec3 point;
    double bound; // the best distance so far, at first max_distance
    bool found;
    sag_closest best;
    uint32_t path_length;
    uint32_t path[SAG_MAX_INSTANCE_DEPTH];
} search;

// A world and how it stands in the scene.
typedef struct level {
    const sagi_snapshot *snapshot;
    bool placed; // else the maps are not looked at
    sag_affine to_scene, to_object;
    double stretch_min;
    bool similarity;
} level;

static double length_of(sag_vec3 v) {
    double square = sag_dot(v, v);
    return square > 0x1p-900 && square < 0x1p900 ? sqrt(square) : sagi_hypot(sagi_hypot(v.x, v.y), v.z);
}

// The order of hits, with distance for t.
static bool comes_before(const sag_closest *a, const sag_closest *b) {
    sag_hit x = {.t = a->distance, .geometry = a->geometry, .primitive = a->primitive};
    sag_hit y = {.t = b->distance, .geometry = b->geometry, .primitive = b->primitive};
    x.instance_depth = a->instance_depth, y.instance_depth = b->instance_depth;
    for (uint32_t i = 0; i < SAG_MAX_INSTANCE_DEPTH; i++)
        x.instance_path[i] = a->instance_path[i], y.instance_path[i] = b->instance_path[i];
    return sagi_hit_before(&x, &y);
}

// Takes note of a point in the scene's space.
static void consider(search *s, sag_vec3 point, uint32_t geometry, uint32_t primitive) {
    sag_closest c = {.point = point,
                     .distance = length_of(sag_sub(point, s->point)),
                     .geometry = geometry,
                     .primitive = primitive,
                     .instance_depth = s->path_length};
    if (!(c.distance <= s->bound)) return;
    for (uint32_t i = 0; i < SAG_MAX_INSTANCE_DEPTH; i++)
        c.instance_path[i] = i < s->path_length ? s->path[i] : SAG_INVALID_ID;
    if (s->found && !comes_before(&c, &s->best)) return;
    s->best = c, s->found = true;
    s->bound = c.distance;
}

static void walk(const level *here, search *s);

// A world below this one, or an object's own space. False when the composition is singular in doubles.
static bool enter(const level *here, const sagi_place *place, level *below) {
    below->placed = here->placed || place != NULL;
    below->similarity = here->similarity && (place == NULL || place->similarity);
    below->stretch_min = here->stretch_min * (place == NULL ? 1 : place->stretch_min);
    if (place == NULL) {
        below->to_scene = here->to_scene, below->to_object = here->to_object;
        return true;
    }
    below->to_scene = here->placed ? sag_affine_multiply(&here->to_scene, &place->to_scene) : place->to_scene;
    return sag_affine_inverse(&below->to_scene, &below->to_object);
}

static void try_triangle(const level *here, search *s, const sagi_bvh_reference *r, const sag_vec3 at[3]) {
    sag_vec3 p[3] = {at[0], at[1], at[2]};
    for (int i = 0; here->placed && i < 3; i++) p[i] = sag_affine_point(&here->to_scene, p[i]);
    consider(s, sagi_triangle_closest_point(&p[0], &p[1], &p[2], s->point), r->geometry, r->primitive);
}

// A shape that answers in its own space.
static void try_shape(const level *there, search *s, const sagi_item *item, const sagi_bvh_reference *r) {
    if (!there->similarity) return;
    sag_vec3 p = there->placed ? sag_affine_point(&there->to_object, s->point) : s->point;
    if (item->kind == SAG_SHAPE_SPHERES) {
        sag_vec3 center;
        double radius;
        sagi_spheres_get(item->shape, r->primitive, &center, &radius);
        p = sagi_sphere_closest_point(center, radius, p);
    } else {
        p = sagi_shape_classes[item->kind].closest_point(item->shape, p);
    }
    consider(s, there->placed ? sag_affine_point(&there->to_scene, p) : p, r->geometry, r->primitive);
}

static void try_reference(const level *here, search *s, const sagi_bvh_reference *r) {
    const sagi_item *item = &here->snapshot->items[r->geometry];
    if (item->kind == SAG_SHAPE_MESH) {
        sag_vec3 p[3];
        sagi_mesh_triangle(item->shape, r->primitive, p);
        try_triangle(here, s, r, p);
        return;
    }
    level there = {.snapshot = here->snapshot};
    if (!enter(here, item->place, &there)) return;
    if (item->kind == SAG_SHAPE_INSTANCE) {
        there.snapshot = here->snapshot->entries[r->geometry].child;
        s->path[s->path_length++] = r->geometry;
        walk(&there, s);
        s->path_length--;
    } else if (item->kind == SAG_SHAPE_TRIANGLE) {
        const sag_triangle *t = item->shape;
        sag_vec3 p[3] = {t->a, t->b, t->c};
        try_triangle(&there, s, r, p);
    } else if (sagi_shape_classes[item->kind].closest_point != NULL) {
        try_shape(&there, s, item, r);
    }
}

// The point in a world's own units, the error of each coordinate, and what a unit is at least in the scene.
typedef struct probe {
    double q[3], error, unit;
} probe;

static probe make_probe(const level *here, sag_vec3 point) {
    const sagi_world *w = &here->snapshot->world;
    const sag_affine *m = &here->to_object;
    double in[3] = {point.x, point.y, point.z}, p[3] = {point.x, point.y, point.z};
    double origin[3] = {w->origin.x, w->origin.y, w->origin.z};
    probe b = {.unit = here->stretch_min / w->scale};
    for (int i = 0; i < 3; i++) {
        double magnitude = fabs(p[i]);
        if (here->placed) {
            p[i] = m->m[i][0] * in[0] + m->m[i][1] * in[1] + m->m[i][2] * in[2] + m->m[i][3];
            magnitude = fabs(m->m[i][0] * in[0]) + fabs(m->m[i][1] * in[1]) + fabs(m->m[i][2] * in[2]) +
                        fabs(m->m[i][3]);
        }
        b.q[i] = (p[i] - origin[i]) * w->scale;
        b.error += 0x1p-50 * (magnitude * w->scale + fabs(b.q[i]));
    }
    return b;
}

// A lower bound of the distance to child i, in the scene's space. NaN (absurd maps) counts as 0.
static double least_distance(const probe *b, const sagi_bvh_node *node, int i) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double d = fmax(fmax(node->plane[k][i] - b->q[k], b->q[k] - node->plane[3 + k][i]), 0);
        square += d * d;
    }
    double bound = (sqrt(square) * (1 - 0x1p-48) - b->error) * b->unit * (1 - 0x1p-48);
    return bound > 0 ? bound : 0;
}

typedef struct waiting {
    double distance;
    uint32_t child;
} waiting;

static void walk(const level *here, search *s) {
    const sagi_world *w = &here->snapshot->world;
    if (w->solid != NULL) return; // passed over
    for (uint32_t i = 0; i < w->unbounded_count; i++) try_reference(here, s, &w->unbounded[i]);
    if (w->tree.node_count == 0) return;
    probe b = make_probe(here, s->point);
    waiting stack[SAGI_BVH_STACK_SIZE];
    int height = 0;
    stack[height++] = (waiting){0, 0};
    while (height > 0) {
        waiting next = stack[--height];
        if (next.distance > s->bound) continue;
        if (sagi_bvh_is_leaf(next.child)) {
            const sagi_block *leaf = sagi_leaf(&w->tree, next.child);
            for (uint32_t i = 0; i < leaf->count; i++) {
                sagi_bvh_reference r = sagi_block_reference(leaf, i);
                try_reference(here, s, &r);
            }
            continue;
        }
        const sagi_bvh_node *node = sagi_bvh_node_at(&w->tree, next.child);
        for (int i = 0, base = height; i < SAGI_BVH_WIDTH; i++) {
            if (!(node->plane[0][i] <= node->plane[3][i])) continue; // not there
            double distance = least_distance(&b, node, i);
            if (distance > s->bound) continue;
            int place = height++;
            for (; place > base && stack[place - 1].distance < distance; place--)
                stack[place] = stack[place - 1];
            stack[place] = (waiting){distance, node->child[i]};
        }
    }
}

bool sag_closest_point(const sag_scene *scene, sag_vec3 point, double max_distance, sag_closest *closest) {
    const sagi_snapshot *snapshot = sagi_scene_snapshot(scene);
    if (snapshot == NULL || !sag_is_finite(point) || !(max_distance >= 0)) return false;
    search s = {.point = point, .bound = max_distance};
    level top = {.snapshot = snapshot, .stretch_min = 1, .similarity = true};
    walk(&top, &s);
    if (s.found) *closest = s.best;
    return s.found;
}
