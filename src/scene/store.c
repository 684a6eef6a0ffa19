// SPDX-License-Identifier: MIT
// Deep copies of shapes: the struct and every array it points to, in one block, so that freeing is one call
// and a shape's data lie together.
#include "scene/scene.h"
#include "shapes/shape.h"
#include <string.h>

static size_t aligned(size_t bytes) { return (bytes + 15) & ~(size_t)15; }

// In the order in which they are put back in place below. The kinds that are not named have none; a test adds
// every kind and frees the original. (A mesh's triangles come after its vertices: kernels read four numbers
// where a vertex has three.)
int sagi_shape_parts(sag_shape_kind kind, const void *shape, sagi_part parts[SAGI_MAX_PARTS]) {
    if (kind == SAG_SHAPE_MESH) {
        const sag_mesh *m = shape;
        bool wide = m->positions_f64 != NULL;
        parts[0] = (sagi_part){wide ? (const void *)m->positions_f64 : m->positions_f32,
                               (size_t)m->vertex_count * 3 * (wide ? sizeof(double) : sizeof(float))};
        parts[1] = (sagi_part){m->normals_f32, (size_t)m->vertex_count * 3 * sizeof(float)};
        parts[2] = (sagi_part){m->texcoords_f32, (size_t)m->vertex_count * 2 * sizeof(float)};
        parts[3] = (sagi_part){m->triangles, (size_t)m->triangle_count * 3 * sizeof(uint32_t)};
        return 4;
    }
    if (kind == SAG_SHAPE_SPHERES) {
        const sag_spheres *s = shape;
        bool wide = s->centers_f64 != NULL;
        parts[0] = (sagi_part){wide ? (const void *)s->centers_f64 : s->centers_f32,
                               (size_t)s->count * 3 * (wide ? sizeof(double) : sizeof(float))};
        parts[1] = (sagi_part){s->radii_f32, (size_t)s->count * sizeof(float)};
        return 2;
    }
    if (kind == SAG_SHAPE_POLYGON) {
        const sag_polygon *p = shape;
        parts[0] = (sagi_part){p->positions, (size_t)p->position_count * sizeof(sag_vec3)};
        parts[1] = (sagi_part){p->loop_sizes, (size_t)p->loop_count * sizeof(uint32_t)};
        return 2;
    }
    if (kind == SAG_SHAPE_POLYHEDRON) {
        const sag_polyhedron *p = shape;
        parts[0] = (sagi_part){p->planes, (size_t)p->plane_count * sizeof(sag_half_space)};
        return 1;
    }
    return 0;
}

static void point_at_copies(sag_shape_kind kind, void *shape, const void *const copies[SAGI_MAX_PARTS]) {
    if (kind == SAG_SHAPE_MESH) {
        sag_mesh *m = shape;
        if (m->positions_f64 != NULL)
            m->positions_f64 = copies[0];
        else
            m->positions_f32 = copies[0];
        m->normals_f32 = copies[1], m->texcoords_f32 = copies[2], m->triangles = copies[3];
    } else if (kind == SAG_SHAPE_SPHERES) {
        sag_spheres *s = shape;
        if (s->centers_f64 != NULL)
            s->centers_f64 = copies[0];
        else
            s->centers_f32 = copies[0];
        s->radii_f32 = copies[1];
    } else if (kind == SAG_SHAPE_POLYGON) {
        sag_polygon *p = shape;
        p->positions = copies[0], p->loop_sizes = copies[1];
    } else if (kind == SAG_SHAPE_POLYHEDRON) {
        sag_polyhedron *p = shape;
        p->planes = copies[0];
    }
}

// A block for the store itself and `bytes` more, which begin at *rest.
static sagi_store *allocate(const sag_context *context, size_t bytes, unsigned char **rest) {
    size_t head = aligned(sizeof(sagi_store));
    sagi_store *store = sag_allocate(context, head + bytes);
    if (store == NULL) return NULL;
    atomic_init(&store->references, 1);
    atomic_init(&store->area, NAN);
    atomic_init(&store->closedness, 0);
    store->context = context;
    store->bytes = head + bytes;
    store->outline = NULL;
    *rest = (unsigned char *)store + head;
    return store;
}

sagi_store *sagi_store_create_empty(const sag_context *context, sag_shape_kind kind, const void *shape) {
    sagi_part parts[SAGI_MAX_PARTS] = {{NULL, 0}};
    int count = sagi_shape_parts(kind, shape, parts);
    sagi_outline outline;
    const bool has_outline = sagi_shape_has_outline(kind) && sagi_shape_outline(kind, shape, &outline);
    size_t struct_bytes = sagi_shape_classes[kind].struct_bytes, bytes = aligned(struct_bytes);
    if (has_outline) bytes += aligned(sizeof outline);
    for (int i = 0; i < count; i++) bytes += parts[i].from != NULL ? aligned(parts[i].bytes) : 0;
    unsigned char *at;
    sagi_store *store = allocate(context, bytes, &at);
    if (store == NULL) return NULL;
    void *copy = at;
    const void *copies[SAGI_MAX_PARTS] = {NULL};
    memcpy(copy, shape, struct_bytes);
    at += aligned(struct_bytes);
    for (int i = 0; i < count; i++) {
        if (parts[i].from == NULL) continue;
        copies[i] = at;
        at += aligned(parts[i].bytes);
    }
    point_at_copies(kind, copy, copies);
    store->shape = copy;
    if (has_outline) store->outline = memcpy(at, &outline, sizeof outline);
    return store;
}

sagi_store *sagi_store_create(const sag_context *context, sag_shape_kind kind, const void *shape) {
    sagi_store *store = sagi_store_create_empty(context, kind, shape);
    if (store == NULL) return NULL;
    sagi_part from[SAGI_MAX_PARTS], to[SAGI_MAX_PARTS];
    int count = sagi_shape_parts(kind, shape, from);
    sagi_shape_parts(kind, store->shape, to);
    for (int i = 0; i < count; i++)
        if (from[i].from != NULL) memcpy((void *)to[i].from, from[i].from, from[i].bytes);
    return store;
}

sagi_store *sagi_store_retain(sagi_store *store) {
    if (store != NULL) atomic_fetch_add(&store->references, 1);
    return store;
}

void sagi_store_release(sagi_store *store) {
    if (store != NULL && atomic_fetch_sub(&store->references, 1) == 1)
        sag_release(store->context, store, store->bytes);
}

// What the threads need that move a mesh.
typedef struct mover {
    const sag_mesh *from;
    const sagi_place *place;
    double *positions;
    float *normals;
} mover;

#define VERTICES_AT_A_TIME 16384u

// Normals go by the inverse transpose. They are made unit first and afterwards, so that no scale of the map
// leaves float's range. For a mirrored mesh they are turned: sagi_surface turns both normals back together
// (surface.c).
static void move_normal(const mover *m, size_t i) {
    const float *n = m->from->normals_f32 + 3 * i;
    sag_vec3 normal = sag_normalize(sag_vec3_make(n[0], n[1], n[2]));
    normal = sag_normalize(sag_affine_transposed(&m->place->to_object, normal));
    if (m->place->mirrored) normal = sag_neg(normal);
    m->normals[3 * i] = (float)normal.x;
    m->normals[3 * i + 1] = (float)normal.y;
    m->normals[3 * i + 2] = (float)normal.z;
}

static void move_vertices(void *argument, size_t index) {
    const mover *m = argument;
    size_t first = index * VERTICES_AT_A_TIME, end = first + VERTICES_AT_A_TIME;
    for (size_t i = first; i < end && i < m->from->vertex_count; i++) {
        sag_vec3 p = m->from->positions_f64 != NULL
                         ? sag_vec3_make(m->from->positions_f64[3 * i], m->from->positions_f64[3 * i + 1],
                                         m->from->positions_f64[3 * i + 2])
                         : sag_vec3_make(m->from->positions_f32[3 * i], m->from->positions_f32[3 * i + 1],
                                         m->from->positions_f32[3 * i + 2]);
        p = sag_affine_point(&m->place->to_scene, p);
        m->positions[3 * i] = p.x, m->positions[3 * i + 1] = p.y, m->positions[3 * i + 2] = p.z;
        if (m->normals != NULL) move_normal(m, i);
    }
}

sagi_store *sagi_store_create_moved_mesh(const sag_context *context, const sag_mesh *mesh,
                                         const sagi_place *place) {
    size_t n = mesh->vertex_count, head = aligned(sizeof(sag_mesh));
    // One number more than there are: a vertex is read with what follows it (sagi_mesh_corners).
    size_t position_bytes = aligned((n * 3 + 1) * sizeof(double));
    size_t normal_bytes = mesh->normals_f32 != NULL ? n * 3 * sizeof(float) : 0;
    unsigned char *at;
    sagi_store *store = allocate(context, head + position_bytes + normal_bytes, &at);
    if (store == NULL) return NULL;
    sag_mesh *moved = (sag_mesh *)(void *)at;
    mover m = {.from = mesh, .place = place};
    m.positions = (double *)(void *)(at + head);
    m.normals = normal_bytes > 0 ? (float *)(void *)(at + head + position_bytes) : NULL;
    sag_parallel_for(context, n / VERTICES_AT_A_TIME + 1, move_vertices, &m);
    *moved = *mesh; // indices and texture coordinates stay where they are
    moved->positions_f32 = NULL;
    moved->positions_f64 = m.positions;
    moved->normals_f32 = m.normals;
    store->shape = moved;
    return store;
}
