// SPDX-License-Identifier: MIT
// Area and points of placed geometries, for lights.
//
// A shape samples itself uniformly by area in its own space. The map p ↦ M p + s enlarges a small piece of
// surface with unit normal n by
//     J(n) = |det M| |M⁻ᵀ n| = |det M| / |Mᵀ n'|,
// n' being the unit normal of the image (the cofactor matrix maps cross products of tangents). So a point's
// density is 1/(A J) where A is the area in the shape's space; and the area of the image is A times the mean
// of J over uniform samples: a constant for flat shapes and similarities, else taken over a grid.
#include "scene/scene.h"
#include "shapes/mesh.h"
#include "shapes/shape.h"
#include "shapes/spheres.h"

#define GRID 128 // samples a side for the mean of J

// One primitive of a geometry as a shape of its own: all but meshes.
typedef struct subject {
    const sagi_shape_class *class;
    const void *shape;
    sag_sphere sphere; // when it is one of a set
    const sagi_place *place;
    bool uniform;      // J is the same everywhere
    sagi_store *store; // that remembers the area, or NULL
} subject;

static bool is_flat(uint8_t kind) {
    return kind == SAG_SHAPE_DISK || kind == SAG_SHAPE_RECTANGLE || kind == SAG_SHAPE_POLYGON ||
           kind == SAG_SHAPE_TRIANGLE;
}

static const sagi_item *find(const sag_scene *scene, uint32_t geometry, uint32_t primitive) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    if (s == NULL || geometry >= s->count || s->items[geometry].shape == NULL) return NULL;
    const sagi_item *item = &s->items[geometry];
    if (item->kind == SAG_SHAPE_MESH && primitive >= ((const sag_mesh *)item->shape)->triangle_count)
        return NULL;
    if (item->kind == SAG_SHAPE_SPHERES && primitive >= ((const sag_spheres *)item->shape)->count)
        return NULL;
    return item;
}

static void make_subject(const sag_scene *scene, uint32_t geometry, uint32_t primitive, subject *s) {
    const sagi_item *item = &sagi_scene_snapshot(scene)->items[geometry];
    s->class = &sagi_shape_classes[item->kind];
    s->store = sagi_scene_snapshot(scene)->entries[geometry].store;
    s->shape = item->shape;
    s->place = item->place;
    s->uniform = item->place == NULL || item->place->similarity || is_flat(item->kind);
    if (item->kind == SAG_SHAPE_SPHERES) {
        s->class = &sagi_shape_classes[SAG_SHAPE_SPHERE];
        s->sphere = (sag_sphere){.center = {0, 0, 0}};
        sagi_spheres_get(item->shape, primitive, &s->sphere.center, &s->sphere.radius);
        s->shape = &s->sphere;
        s->store = NULL;
    }
}

// The area in the shape's own space. Some shapes integrate it numerically: worked out once.
static double own_area(const subject *s) {
    if (s->store == NULL) return s->class->area(s->shape);
    double area = atomic_load_explicit(&s->store->area, memory_order_relaxed);
    if (isnan(area)) {
        area = s->class->area(s->shape);
        atomic_store_explicit(&s->store->area, area, memory_order_relaxed);
    }
    return area;
}

// J at a point with this normal in the shape's space.
static double enlargement(const sagi_place *place, sag_vec3 normal) {
    if (place == NULL) return 1;
    return fabs(sag_affine_determinant(&place->to_scene)) *
           sag_length(sag_affine_transposed(&place->to_object, normal));
}

double sag_geometry_area(const sag_scene *scene, uint32_t geometry, uint32_t primitive) {
    const sagi_item *item = find(scene, geometry, primitive);
    if (item == NULL) return NAN;
    if (item->kind == SAG_SHAPE_MESH) return sagi_mesh_triangle_area(item->shape, primitive);
    subject s;
    make_subject(scene, geometry, primitive, &s);
    double area = own_area(&s), sum = 0;
    if (s.place == NULL || !(area > 0) || !isfinite(area)) return area;
    int side = s.uniform ? 1 : GRID;
    for (int i = 0; i < side; i++)
        for (int j = 0; j < side; j++) {
            sag_surface at;
            sag_vec2 random = {(i + 0.5) / side, (j + 0.5) / side};
            if (!s.class->sample(s.shape, random, &at)) return NAN;
            sum += enlargement(s.place, at.geometric_normal);
        }
    return area * (sum / ((double)side * side));
}

bool sag_geometry_sample(const sag_scene *scene, uint32_t geometry, uint32_t primitive, sag_vec2 random,
                         sag_surface *surface, double *density) {
    const sagi_item *item = find(scene, geometry, primitive);
    if (item == NULL) return false;
    sag_surface at;
    if (item->kind == SAG_SHAPE_MESH) {
        if (!sagi_mesh_triangle_sample(item->shape, primitive, random, &at)) return false;
        if (item->mirrored) sagi_surface_turn(&at);
        *density = 1 / sagi_mesh_triangle_area(item->shape, primitive);
    } else {
        subject s;
        make_subject(scene, geometry, primitive, &s);
        if (!s.class->sample(s.shape, random, &at)) return false;
        *density = 1 / (own_area(&s) * enlargement(s.place, at.geometric_normal));
        if (s.place != NULL) sagi_surface_map(s.place, &at);
        if (item->kind == SAG_SHAPE_SPHERES) at.primitive = primitive;
    }
    at.geometry = geometry;
    at.user_data = sagi_scene_snapshot(scene)->entries[geometry].user_data;
    *surface = at;
    return true;
}

double sag_geometry_density(const sag_scene *scene, uint32_t geometry, uint32_t primitive,
                            const sag_surface *surface) {
    const sagi_item *item = find(scene, geometry, primitive);
    if (item == NULL) return 0;
    if (item->kind == SAG_SHAPE_MESH) {
        double area = sagi_mesh_triangle_area(item->shape, primitive);
        return area > 0 ? 1 / area : 0;
    }
    subject s;
    make_subject(scene, geometry, primitive, &s);
    double area = own_area(&s);
    if (!(area > 0) || !isfinite(area)) return 0;
    if (s.place == NULL) return 1 / area;
    double back = sag_length(sag_affine_transposed(&s.place->to_scene, surface->geometric_normal));
    return back / (area * fabs(sag_affine_determinant(&s.place->to_scene)));
}
