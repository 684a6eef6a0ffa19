// SPDX-License-Identifier: MIT
// A mesh of triangles, by going through them all: the plain meaning of what a scene answers with a tree. The
// test of one triangle is in triangle_test.c and triangle_solve.h, its surface in mesh_surface.h.
#include "math/dd.h"
#include "shapes/mesh_surface.h"

static bool is_readable(const sag_mesh *s) {
    return s->triangles && (s->positions_f32 != NULL) != (s->positions_f64 != NULL);
}

static bool in_range(const sag_mesh *s, uint32_t i) {
    if (!is_readable(s) || i >= s->triangle_count) return false;
    const uint32_t *corner = &s->triangles[3 * (size_t)i];
    return corner[0] < s->vertex_count && corner[1] < s->vertex_count && corner[2] < s->vertex_count;
}

sag_status sag_mesh_validate(const sag_mesh *s, sag_error *error) {
    if (!s->positions_f32 == !s->positions_f64)
        return sag_error_set(error, SAG_ERROR_GEOMETRY,
                             "mesh: exactly one of positions_f32 and positions_f64 must be given, not %s",
                             s->positions_f32 ? "both" : "neither");
    if (!s->triangles || s->triangle_count == 0)
        return sag_error_set(error, SAG_ERROR_GEOMETRY, "mesh.triangle_count is 0: no triangles");
    for (uint32_t i = 0; i < s->triangle_count; i++)
        if (!in_range(s, i)) {
            const uint32_t *corner = &s->triangles[3 * (size_t)i];
            return sag_error_set(
                error, SAG_ERROR_GEOMETRY,
                "mesh.triangles: triangle %u is (%u, %u, %u), an index out of range: vertex_count is %u", i,
                corner[0], corner[1], corner[2], s->vertex_count);
        }
    return SAG_OK;
}

sagi_triangle_state sagi_mesh_triangle_state(const sag_mesh *s, uint32_t i, sag_vec3 out[3]) {
    if (!in_range(s, i)) return SAGI_TRIANGLE_NOT_FINITE;
    sagi_mesh_triangle(s, i, out);
    if (!sagi_triangle_is_finite(&out[0], &out[1], &out[2])) return SAGI_TRIANGLE_NOT_FINITE;
    return sagi_triangle_has_area(&out[0], &out[1], &out[2]) ? SAGI_TRIANGLE_GOOD : SAGI_TRIANGLE_NO_AREA;
}

sag_box3 sagi_mesh_triangle_bounds(const sag_mesh *s, uint32_t i) {
    sag_box3 box = sag_box3_empty();
    sag_vec3 p[3];
    if (sagi_mesh_triangle_state(s, i, p) != SAGI_TRIANGLE_GOOD) return box;
    for (int k = 0; k < 3; k++) box = sag_box3_extend(box, p[k]);
    return box;
}

sag_box3 sag_mesh_bounds(const sag_mesh *s) {
    sag_box3 box = sag_box3_empty();
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        sag_box3 one = sagi_mesh_triangle_bounds(s, i);
        box = sag_box3_union(box, one);
    }
    return box;
}

// One triangle's crossing with the prepared ray.
static bool hit_one(const sag_mesh *s, const sagi_triangle_ray *ray, uint32_t i, sag_hit *hit) {
    if (!in_range(s, i)) return false;
    sag_vec3 p[3];
    sagi_mesh_triangle(s, i, p);
    double t, u, v;
    if (!sagi_triangle_hit(ray, &p[0], &p[1], &p[2], s->one_sided, &t, &u, &v)) return false;
    *hit = sagi_hit_make(t, u, v, i);
    return true;
}

bool sag_mesh_hit(const sag_mesh *s, const sag_ray *ray, sag_hit *hit) {
    if (!sag_ray_is_valid(ray)) return false;
    sagi_triangle_ray prepared = sagi_triangle_prepare(ray);
    bool found = false;
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        sag_hit one;
        if (!hit_one(s, &prepared, i, &one)) continue;
        if (found && !(one.t < hit->t)) continue;
        *hit = one;
        prepared.t_max = one.t;
        found = true;
    }
    return found;
}

bool sag_mesh_occluded(const sag_mesh *s, const sag_ray *ray) {
    if (!sag_ray_is_valid(ray)) return false;
    sagi_triangle_ray prepared = sagi_triangle_prepare(ray);
    sag_hit hit;
    for (uint32_t i = 0; i < s->triangle_count; i++)
        if (hit_one(s, &prepared, i, &hit)) return true;
    return false;
}

size_t sag_mesh_crossings(const sag_mesh *s, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    if (!sag_ray_is_valid(ray)) return 0;
    sagi_triangle_ray prepared = sagi_triangle_prepare(ray);
    size_t count = 0;
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        sag_hit one;
        if (!hit_one(s, &prepared, i, &one)) continue;
        size_t at = count < capacity ? count : capacity; // those kept so far
        count++;
        if (at == capacity && (at == 0 || !(one.t < hits[at - 1].t))) continue;
        if (at == capacity) at--;
        for (; at > 0 && hits[at - 1].t > one.t; at--) hits[at] = hits[at - 1];
        hits[at] = one;
    }
    return count;
}

void sagi_mesh_shading_normal(const sag_mesh *s, uint32_t i, double u, double v, sag_vec3 *normal) {
    if (!s->normals_f32) return;
    const sagi_d4 before = sagi_d4_of(normal->x, normal->y, normal->z, 0);
    *normal = sagi_d4_vec3(sagi_mesh_normal(s, &s->triangles[3 * (size_t)i], u, v, before));
}

void sag_mesh_surface(const sag_mesh *s, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    if (in_range(s, hit->primitive)) sagi_mesh_surface(s, ray, hit, surface);
}

double sagi_mesh_triangle_area(const sag_mesh *s, uint32_t i) {
    sag_vec3 p[3], unit;
    if (sagi_mesh_triangle_state(s, i, p) != SAGI_TRIANGLE_GOOD) return 0;
    return 0.5 * sagi_triangle_normal(&p[0], &p[1], &p[2], &unit);
}

double sag_mesh_area(const sag_mesh *s) {
    sagi_dd sum = {0, 0};
    for (uint32_t i = 0; i < s->triangle_count; i++)
        sum = sagi_dd_add_double(sum, sagi_mesh_triangle_area(s, i));
    return sagi_dd_to_double(sum);
}

bool sagi_mesh_triangle_sample(const sag_mesh *s, uint32_t i, sag_vec2 random, sag_surface *surface) {
    sag_vec3 p[3];
    if (sagi_mesh_triangle_state(s, i, p) != SAGI_TRIANGLE_GOOD) return false;
    double u, v;
    sagi_triangle_sample_weights(random, &u, &v);
    sagi_mesh_point(s, i, u, v, surface);
    surface->side = SAG_SIDE_FRONT;
    return true;
}

// The triangle by the cumulated areas; what is left of random.x within it is uniform again.
bool sag_mesh_sample(const sag_mesh *s, sag_vec2 random, sag_surface *surface) {
    double target = random.x * sag_mesh_area(s), below = 0;
    uint32_t chosen = s->triangle_count;
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        double area = sagi_mesh_triangle_area(s, i);
        if (!(area > 0)) continue;
        chosen = i;
        random.x = fmin(fmax((target - below) / area, 0), 1 - SAGI_EPSILON);
        below += area;
        if (target < below) break;
    }
    return chosen < s->triangle_count && sagi_mesh_triangle_sample(s, chosen, random, surface);
}

// Parity along one ray: any direction is as good as another, since crossings are counted exactly. A crossing
// at t = 0 means that the point is on the surface.
bool sag_mesh_contains(const sag_mesh *s, sag_vec3 point) {
    sag_ray ray = sag_ray_make(point, sag_vec3_make(0.8660254037844386, 0.4330127018922193, 0.25));
    if (!sag_ray_is_valid(&ray)) return false;
    sagi_triangle_ray prepared = sagi_triangle_prepare(&ray);
    sag_mesh both_sides = *s; // the way out is through the backs
    both_sides.one_sided = false;
    bool inside = false;
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        sag_hit hit;
        if (!hit_one(&both_sides, &prepared, i, &hit)) continue;
        if (hit.t == 0) return true;
        inside = !inside;
    }
    return inside;
}

// By the divergence theorem the volume is the sum of the signed tetrahedra over any one point; the box's
// middle keeps them small.
double sag_mesh_volume(const sag_mesh *s) {
    sag_box3 box = sag_mesh_bounds(s);
    if (sag_box3_is_empty(&box)) return 0;
    sag_vec3 middle = sag_madd(box.min, 0.5, sag_sub(box.max, box.min));
    sagi_dd sum = {0, 0};
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        sag_vec3 p[3];
        if (sagi_mesh_triangle_state(s, i, p) != SAGI_TRIANGLE_GOOD) continue;
        sag_vec3 a = sag_sub(p[0], middle), b = sag_sub(p[1], middle), c = sag_sub(p[2], middle);
        sum = sagi_dd_add_double(sum, sag_dot(a, sag_cross(b, c)));
    }
    return sagi_dd_to_double(sum) / 6;
}

sag_vec3 sag_mesh_closest_point(const sag_mesh *s, sag_vec3 point) {
    sag_vec3 best = {NAN, NAN, NAN};
    double best_square = INFINITY;
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        sag_vec3 p[3];
        if (sagi_mesh_triangle_state(s, i, p) != SAGI_TRIANGLE_GOOD) continue;
        sag_vec3 near = sagi_triangle_closest_point(&p[0], &p[1], &p[2], point);
        sag_vec3 way = sag_sub(near, point);
        double square = sag_dot(way, way);
        if (!(square < best_square)) continue;
        best_square = square;
        best = near;
    }
    return best;
}
