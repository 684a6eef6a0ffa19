// SPDX-License-Identifier: MIT
// A mesh's triangles on their way to the tree: the two rounds of structure.c for many at a time. Vertices of
// floats go three coordinates at once; a chunk in which every triangle is good, which is nearly every one, is
// not examined again in the second round.
#include "bvh/lanes.h"
#include "scene/scene.h"
#include "shapes/mesh.h"

static void count_state(sagi_survey *survey, sagi_triangle_state state) {
    switch (state) {
    case SAGI_TRIANGLE_GOOD: survey->good++; break;
    case SAGI_TRIANGLE_NOT_FINITE: survey->not_finite++; break;
    case SAGI_TRIANGLE_NO_AREA: survey->degenerate++; break;
    }
}

sag_box3 sagi_corners_box(const sag_vec3 p[3]) {
    sag_box3 box = {p[0], p[0]};
    for (int i = 1; i < 3; i++) {
        if (p[i].x < box.min.x) box.min.x = p[i].x;
        if (p[i].y < box.min.y) box.min.y = p[i].y;
        if (p[i].z < box.min.z) box.min.z = p[i].z;
        if (p[i].x > box.max.x) box.max.x = p[i].x;
        if (p[i].y > box.max.y) box.max.y = p[i].y;
        if (p[i].z > box.max.z) box.max.z = p[i].z;
    }
    return box;
}

// The corners of triangle i, whose indices are in range.
typedef struct corners {
    sagi_lanes a, b, c;
} corners;

static inline corners corners_of(const sag_mesh *mesh, uint32_t i) {
    const uint32_t *corner = &mesh->triangles[3 * (size_t)i];
    const float *p = mesh->positions_f32;
    return (corners){sagi_lanes_load3(p + 3 * (size_t)corner[0]), sagi_lanes_load3(p + 3 * (size_t)corner[1]),
                     sagi_lanes_load3(p + 3 * (size_t)corner[2])};
}
static inline sagi_lanes least(const corners *t) { return sagi_lanes_min(sagi_lanes_min(t->a, t->b), t->c); }
static inline sagi_lanes most(const corners *t) { return sagi_lanes_max(sagi_lanes_max(t->a, t->b), t->c); }

// sagi_mesh_triangle_state for floats.
static inline sagi_triangle_state examine(const sag_mesh *mesh, uint32_t i, corners *t) {
    const uint32_t *corner = &mesh->triangles[3 * (size_t)i], n = mesh->vertex_count;
    if (!(corner[0] < n && corner[1] < n && corner[2] < n)) return SAGI_TRIANGLE_NOT_FINITE;
    *t = corners_of(mesh, i);
    const float limit = (float)SAG_MAX_COORDINATE;
    if (!sagi_lanes_within(t->a, limit) || !sagi_lanes_within(t->b, limit) || !sagi_lanes_within(t->c, limit))
        return SAGI_TRIANGLE_NOT_FINITE;
    sag_vec3 p[3];
    sagi_mesh_triangle(mesh, i, p);
    return sagi_triangle_has_area(&p[0], &p[1], &p[2]) ? SAGI_TRIANGLE_GOOD : SAGI_TRIANGLE_NO_AREA;
}

static void survey_floats(const sag_mesh *mesh, uint32_t first, uint32_t count, sagi_survey *survey) {
    sagi_lanes lo = sagi_lanes_fill(INFINITY), hi = sagi_lanes_fill(-INFINITY);
    for (uint32_t i = first; i < first + count; i++) {
        corners t;
        sagi_triangle_state state = examine(mesh, i, &t);
        count_state(survey, state);
        if (state != SAGI_TRIANGLE_GOOD) continue;
        lo = sagi_lanes_min(least(&t), lo), hi = sagi_lanes_max(most(&t), hi);
    }
    float l[4], h[4];
    sagi_lanes_store(l, lo), sagi_lanes_store(h, hi);
    const sag_box3 box = {{(double)l[0], (double)l[1], (double)l[2]},
                          {(double)h[0], (double)h[1], (double)h[2]}};
    survey->bounds = sag_box3_union(survey->bounds, box);
}

void sagi_mesh_survey(const sag_mesh *mesh, uint32_t first, uint32_t count, sagi_survey *survey) {
    if (mesh->positions_f32) {
        survey_floats(mesh, first, count, survey);
        return;
    }
    for (uint32_t i = first; i < first + count; i++) {
        sag_vec3 p[3];
        sagi_triangle_state state = sagi_mesh_triangle_state(mesh, i, p);
        count_state(survey, state);
        if (state == SAGI_TRIANGLE_GOOD) survey->bounds = sag_box3_union(survey->bounds, sagi_corners_box(p));
    }
}

// (x − origin)·scale as a float: the difference and the scaling err by less than 2⁻⁵², the conversion by half
// a step between floats, or anything below 2⁻¹²⁶. A step outward is |f| 2⁻²³ + 2⁻¹²⁶ (box.h); so rounded it
// is at least one step, half of which is left for all the rest.
static inline sagi_lanes step_of(sagi_lanes f) {
    return sagi_lanes_add(sagi_lanes_mul(sagi_lanes_abs(f), sagi_lanes_fill(0x1p-23f)),
                          sagi_lanes_fill(0x1p-126f));
}

static sagi_bvh_primitive *write_floats(const sagi_world *world, uint32_t geometry, uint32_t first,
                                        uint32_t count, bool all_good, sagi_bvh_primitive *out) {
    const sag_mesh *mesh = world->items[geometry].shape;
    const double origin[4] = {world->origin.x, world->origin.y, world->origin.z, 0};
    const double scale = world->scale;
    for (uint32_t i = first; i < first + count; i++) {
        corners t;
        if (all_good)
            t = corners_of(mesh, i);
        else if (examine(mesh, i, &t) != SAGI_TRIANGLE_GOOD)
            continue;
        sagi_lanes lo = sagi_lanes_place(least(&t), origin, scale);
        sagi_lanes hi = sagi_lanes_place(most(&t), origin, scale);
        float l[4], h[4];
        sagi_lanes_store(l, sagi_lanes_sub(lo, step_of(lo)));
        sagi_lanes_store(h, sagi_lanes_add(hi, step_of(hi)));
        *out++ = (sagi_bvh_primitive){
            .lo = {l[0], l[1], l[2]}, .geometry = geometry, .hi = {h[0], h[1], h[2]}, .primitive = i};
    }
    return out;
}

sagi_bvh_primitive *sagi_mesh_boxes(const sagi_world *world, uint32_t geometry, uint32_t first,
                                    uint32_t count, bool all_good, sagi_bvh_primitive *out) {
    const sag_mesh *mesh = world->items[geometry].shape;
    if (mesh->positions_f32) return write_floats(world, geometry, first, count, all_good, out);
    for (uint32_t i = first; i < first + count; i++) {
        sag_vec3 p[3];
        if (all_good)
            sagi_mesh_triangle(mesh, i, p);
        else if (sagi_mesh_triangle_state(mesh, i, p) != SAGI_TRIANGLE_GOOD)
            continue;
        sag_box3 box = sagi_corners_box(p);
        *out++ = sagi_world_primitive(world, &box, geometry, i);
    }
    return out;
}
