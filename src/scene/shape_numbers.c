// SPDX-License-Identifier: MIT
// A shape's struct without its arrays as numbers for a file. Most kinds are some doubles, then perhaps a
// bool: a table says how many. The four that have arrays say what they have of each.
#include "scene/file.h"
#include "shapes/shape.h"
#include <string.h>

// `doubles` from the beginning of the struct on; `flag`: a bool follows them.
typedef struct layout {
    uint8_t doubles;
    bool flag;
} layout;

static const layout layouts[SAGI_SHAPE_KIND_COUNT] = {
    [SAG_SHAPE_PLANE] = {12, false},        [SAG_SHAPE_DISK] = {12, false},
    [SAG_SHAPE_RECTANGLE] = {9, false},     [SAG_SHAPE_SPHERE] = {7, false},
    [SAG_SHAPE_ELLIPSOID] = {6, false},     [SAG_SHAPE_CYLINDER] = {4, true},
    [SAG_SHAPE_CONE] = {3, true},           [SAG_SHAPE_PARABOLOID] = {4, true},
    [SAG_SHAPE_HYPERBOLOID] = {7, true},    [SAG_SHAPE_HYPERBOLOID2] = {5, true},
    [SAG_SHAPE_QUADRIC] = {16, false},      [SAG_SHAPE_BOX] = {6, false},
    [SAG_SHAPE_ORIENTED_BOX] = {12, false}, [SAG_SHAPE_CAPSULE] = {7, false},
    [SAG_SHAPE_TRIANGLE] = {9, true},       [SAG_SHAPE_BILINEAR_PATCH] = {12, false},
    [SAG_SHAPE_TORUS] = {2, false},
};

// A struct that changes shall be noticed here.
#define DOUBLES(X, count)                                                                                    \
    _Static_assert(sizeof(sag_##X) == (count) * sizeof(double), "only doubles, as many as the table says")
#define DOUBLES_AND_FLAG(X, count, field)                                                                    \
    _Static_assert(offsetof(sag_##X, field) == (count) * sizeof(double) &&                                   \
                       sizeof(sag_##X) == ((count) + 1) * sizeof(double),                                    \
                   "doubles, as many as the table says, and a bool")
DOUBLES(plane, 12);
DOUBLES(disk, 12);
DOUBLES(rectangle, 9);
DOUBLES(sphere, 7);
DOUBLES(ellipsoid, 6);
DOUBLES_AND_FLAG(cylinder, 4, closed);
DOUBLES_AND_FLAG(cone, 3, closed);
DOUBLES_AND_FLAG(paraboloid, 4, closed);
DOUBLES_AND_FLAG(hyperboloid, 7, closed);
DOUBLES_AND_FLAG(hyperboloid2, 5, closed);
DOUBLES(quadric, 16);
DOUBLES(box, 6);
DOUBLES(oriented_box, 12);
DOUBLES(capsule, 7);
DOUBLES_AND_FLAG(triangle, 9, one_sided);
DOUBLES(bilinear_patch, 12);
DOUBLES(torus, 2);

void sagi_shape_encode(sag_shape_kind kind, const void *shape, sagi_file_geometry *g) {
    if (kind == SAG_SHAPE_MESH) {
        const sag_mesh *m = shape;
        g->counts[0] = m->vertex_count, g->counts[1] = m->triangle_count;
        g->flag = m->one_sided, g->wide = m->positions_f64 != NULL;
        g->arrays = (uint8_t)(9 | (m->normals_f32 != NULL) << 1 | (m->texcoords_f32 != NULL) << 2);
    } else if (kind == SAG_SHAPE_SPHERES) {
        const sag_spheres *s = shape;
        g->counts[0] = s->count, g->number[0] = s->radius, g->wide = s->centers_f64 != NULL;
        g->arrays = (uint8_t)(1 | (s->radii_f32 != NULL) << 1);
    } else if (kind == SAG_SHAPE_POLYGON) {
        const sag_polygon *p = shape;
        g->counts[0] = p->position_count, g->counts[1] = p->loop_count, g->arrays = 3;
    } else if (kind == SAG_SHAPE_POLYHEDRON) {
        g->counts[0] = ((const sag_polyhedron *)shape)->plane_count, g->arrays = 1;
    } else {
        const layout *l = &layouts[kind];
        bool flag = false;
        memcpy(g->number, shape, l->doubles * sizeof(double));
        if (l->flag) memcpy(&flag, (const char *)shape + l->doubles * sizeof(double), sizeof flag);
        g->flag = flag;
    }
}

bool sagi_shape_decode(const sagi_file_geometry *g, sagi_any_shape *shape) {
    static const double somewhere = 0;
    const void *array[4];
    memset(shape, 0, sizeof *shape);
    for (int i = 0; i < 4; i++) array[i] = g->arrays >> i & 1 ? &somewhere : NULL;
    if (g->flag > 1 || g->wide > 1) return false;
    if (g->kind == SAG_SHAPE_MESH) {
        shape->mesh = (sag_mesh){.positions_f32 = g->wide ? NULL : array[0],
                                 .positions_f64 = g->wide ? array[0] : NULL,
                                 .normals_f32 = array[1],
                                 .texcoords_f32 = array[2],
                                 .triangles = array[3],
                                 .vertex_count = g->counts[0],
                                 .triangle_count = g->counts[1],
                                 .one_sided = g->flag != 0};
        return (g->arrays & 9) == 9 && g->arrays < 16;
    }
    if (g->kind == SAG_SHAPE_SPHERES) {
        shape->spheres = (sag_spheres){.centers_f32 = g->wide ? NULL : array[0],
                                       .centers_f64 = g->wide ? array[0] : NULL,
                                       .radii_f32 = array[1],
                                       .radius = g->number[0],
                                       .count = g->counts[0]};
        return (g->arrays & 1) == 1 && g->arrays < 4;
    }
    if (g->kind == SAG_SHAPE_POLYGON) {
        shape->polygon = (sag_polygon){array[0], g->counts[0], array[1], g->counts[1]};
        return g->arrays == 3;
    }
    if (g->kind == SAG_SHAPE_POLYHEDRON) {
        shape->polyhedron = (sag_polyhedron){array[0], g->counts[0]};
        return g->arrays == 1;
    }
    const layout *l = &layouts[g->kind];
    bool flag = g->flag != 0;
    memcpy(shape->bytes, g->number, l->doubles * sizeof(double));
    if (l->flag) memcpy(shape->bytes + l->doubles * sizeof(double), &flag, sizeof flag);
    return l->doubles > 0 && g->arrays == 0 && (l->flag || !flag);
}
