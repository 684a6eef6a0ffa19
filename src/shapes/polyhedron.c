// SPDX-License-Identifier: MIT
// The convex polyhedron nᵢ·p ≤ cᵢ: along the ray num = cᵢ − nᵢ·o, den = nᵢ·d (clip.c, exact). Everything that
// needs vertices goes face by face (polyhedron_face.c). An unbounded polyhedron has an unbounded face; one
// with a single face is a half-space.
#include "shapes/clip.h"
#include "shapes/polyhedron_face.h"
#include "shapes/validate.h"

static bool is_usable(const sag_polyhedron *polyhedron) {
    return polyhedron->planes != NULL && polyhedron->plane_count > 0 &&
           polyhedron->plane_count <= SAG_MAX_POLYHEDRON_PLANES;
}

static void quick(const void *solid, const sag_ray *ray, uint32_t face, sagi_clip_face *out) {
    const sag_half_space *h = &((const sag_polyhedron *)solid)->planes[face];
    sag_vec3 n = sag_abs(h->normal);
    // Three products and three sums, then three and two: at most 4u and 3u of the terms' sum.
    out->num = h->offset - sag_dot(h->normal, ray->origin);
    out->num_error = 5 * SAGI_EPSILON * (fabs(h->offset) + sag_dot(n, sag_abs(ray->origin)));
    out->den = sag_dot(h->normal, ray->direction);
    out->den_error = 4 * SAGI_EPSILON * sag_dot(n, sag_abs(ray->direction));
    if (sagi_is_zero3(h->normal) || !sagi_is_coordinate3(h->normal) || !sagi_is_coordinate(h->offset))
        out->num = NAN; // not a half-space: nothing is inside
}

static void accurate(const void *solid, const sag_ray *ray, uint32_t face, sagi_clip_dd *out) {
    const sag_half_space *h = &((const sag_polyhedron *)solid)->planes[face];
    sagi_clip_face size;
    quick(solid, ray, face, &size);
    sagi_dd3 n = sagi_dd3_from(h->normal);
    out->num = sagi_dd_sub(sagi_dd_from(h->offset), sagi_dot_dd(n, sagi_dd3_from(ray->origin)));
    out->den = sagi_dot_dd(n, sagi_dd3_from(ray->direction));
    out->num_error = 0x1p-51 * size.num_error, out->den_error = 0x1p-51 * size.den_error;
}

static void exact(const void *solid, const sag_ray *ray, uint32_t face, sagi_clip_real *out) {
    const sag_half_space *h = &((const sag_polyhedron *)solid)->planes[face];
    sagi_dd3 n = sagi_dd3_from(h->normal);
    out->num = sagi_real_sub(sagi_real_from(h->offset), sagi_dot_real(n, sagi_dd3_from(ray->origin)));
    out->den = sagi_dot_real(n, sagi_dd3_from(ray->direction));
}

static sagi_clip_solid solid_of(const sag_polyhedron *polyhedron) {
    return (sagi_clip_solid){polyhedron, polyhedron->plane_count, quick, accurate, exact};
}

static bool find(const sag_polyhedron *polyhedron, const sag_ray *ray, sagi_clip_span *span) {
    if (!sag_ray_is_valid(ray) || !is_usable(polyhedron)) return false;
    const sagi_clip_solid solid = solid_of(polyhedron);
    return sagi_clip_find(&solid, ray, span);
}

static sag_status check_planes(const sag_polyhedron *polyhedron, sag_error *error) {
    if (!is_usable(polyhedron))
        return sag_error_set(error, SAG_ERROR_GEOMETRY, "polyhedron: plane_count %u must be 1 to %d",
                             polyhedron->planes == NULL ? 0 : polyhedron->plane_count,
                             SAG_MAX_POLYHEDRON_PLANES);
    for (uint32_t i = 0; i < polyhedron->plane_count; i++) {
        const sag_half_space *h = &polyhedron->planes[i];
        if (sagi_is_zero3(h->normal) || !sagi_is_coordinate3(h->normal) || !sagi_is_coordinate(h->offset))
            return sag_error_set(error, SAG_ERROR_GEOMETRY,
                                 "polyhedron: planes[%u] normal (%.17g, %.17g, %.17g) offset %.17g must be "
                                 "finite, the normal not 0",
                                 i, h->normal.x, h->normal.y, h->normal.z, h->offset);
    }
    return SAG_OK;
}

sag_status sag_polyhedron_validate(const sag_polyhedron *polyhedron, sag_error *error) {
    sag_status status = check_planes(polyhedron, error);
    if (status != SAG_OK) return status;
    // A polyhedron with an inside has a face, and of one that is flat or empty no face has an area.
    sagi_polyhedron_face face;
    for (uint32_t i = 0; i < polyhedron->plane_count; i++) {
        sagi_polyhedron_face_find(polyhedron, i, &face);
        if (face.count > 2 && sagi_polyhedron_face_area(&face) > 0) return SAG_OK;
    }
    return sag_error_set(error, SAG_ERROR_GEOMETRY,
                         "polyhedron: the %u half-spaces of planes have no common inside",
                         polyhedron->plane_count);
}

static void widen(double lo, double hi, double far, double *min, double *max) {
    *min = fmin(*min, lo < -far ? -INFINITY : lo);
    *max = fmax(*max, hi > far ? INFINITY : hi);
}

sag_box3 sag_polyhedron_bounds(const sag_polyhedron *polyhedron) {
    sag_box3 box = sag_box3_empty();
    if (check_planes(polyhedron, NULL) != SAG_OK) return box;
    uint32_t faces = 0, only = 0;
    double size = 0;
    sagi_polyhedron_face face;
    for (uint32_t i = 0; i < polyhedron->plane_count; i++) {
        sagi_polyhedron_face_find(polyhedron, i, &face);
        if (face.count < 3) continue;
        faces++, only = i;
        for (int k = 0; k < face.count; k++) {
            sag_vec3 v = face.vertices[k];
            widen(v.x, v.x, face.far, &box.min.x, &box.max.x);
            widen(v.y, v.y, face.far, &box.min.y, &box.max.y);
            widen(v.z, v.z, face.far, &box.min.z, &box.max.z);
            double largest = sag_max_component(sag_abs(v));
            if (largest < face.far) size = fmax(size, largest);
        }
    }
    if (faces == 1) { // a half-space: the solid goes on behind its one face
        sag_vec3 n = polyhedron->planes[only].normal;
        if (n.x > 0) box.min.x = -INFINITY;
        if (n.x < 0) box.max.x = INFINITY;
        if (n.y > 0) box.min.y = -INFINITY;
        if (n.y < 0) box.max.y = INFINITY;
        if (n.z > 0) box.min.z = -INFINITY;
        if (n.z < 0) box.max.z = INFINITY;
    }
    // The vertices are rounded, and one within rounding of a third plane may have been cut off.
    sag_vec3 slack = {0x1p-45 * size, 0x1p-45 * size, 0x1p-45 * size};
    return faces == 0 ? box : (sag_box3){sag_sub(box.min, slack), sag_add(box.max, slack)};
}

bool sag_polyhedron_hit(const sag_polyhedron *polyhedron, const sag_ray *ray, sag_hit *hit) {
    sagi_clip_span span;
    if (!find(polyhedron, ray, &span)) return false;
    sagi_crossings list = sagi_clip_crossings(&span, ray);
    return sagi_crossings_first(&list, hit);
}

bool sag_polyhedron_occluded(const sag_polyhedron *polyhedron, const sag_ray *ray) {
    sag_hit hit;
    return sag_polyhedron_hit(polyhedron, ray, &hit);
}

size_t sag_polyhedron_crossings(const sag_polyhedron *polyhedron, const sag_ray *ray, sag_hit *hits,
                                size_t capacity) {
    sagi_clip_span span;
    if (!find(polyhedron, ray, &span)) return 0;
    sagi_crossings list = sagi_clip_crossings(&span, ray);
    return sagi_crossings_write(&list, hits, capacity);
}

static void finish_face(const sag_polyhedron *polyhedron, uint32_t face, sag_surface *surface) {
    surface->geometric_normal = sag_normalize(polyhedron->planes[face].normal);
    const sagi_clip_solid solid = solid_of(polyhedron);
    sagi_clip_clear(&solid, face, surface);
    sag_frame(surface->geometric_normal, &surface->dpdu, &surface->dpdv);
    // The plane's point nearest 0 is along the normal, so it adds nothing to the in-plane coordinates.
    surface->u = sag_dot(surface->position, surface->dpdu);
    surface->v = sag_dot(surface->position, surface->dpdv);
}

void sag_polyhedron_surface(const sag_polyhedron *polyhedron, const sag_ray *ray, const sag_hit *hit,
                            sag_surface *surface) {
    sagi_clip_span span;
    sagi_cut cut = {{hit->t, 0}, 2 * SAGI_EPSILON * fabs(hit->t)};
    if (find(polyhedron, ray, &span)) {
        if (span.enter_face == hit->primitive) cut = span.enter;
        if (span.leave_face == hit->primitive) cut = span.leave;
    }
    sagi_point_at(ray, cut, &surface->position, &surface->position_error);
    finish_face(polyhedron, hit->primitive % polyhedron->plane_count, surface);
    sagi_surface_finish(surface, ray, hit);
}

double sag_polyhedron_area(const sag_polyhedron *polyhedron) {
    if (check_planes(polyhedron, NULL) != SAG_OK) return 0;
    double area = 0;
    sagi_polyhedron_face face;
    for (uint32_t i = 0; i < polyhedron->plane_count; i++) {
        sagi_polyhedron_face_find(polyhedron, i, &face);
        if (face.count < 3) continue;
        if (face.unbounded) return INFINITY;
        area += sagi_polyhedron_face_area(&face);
    }
    return area;
}

// A uniform point of a triangle from two numbers (Turk, Graphics Gems I, 1990).
static sag_vec3 in_triangle(sag_vec3 a, sag_vec3 b, sag_vec3 c, double x, double y) {
    double root = sqrt(x);
    return sag_madd(sag_madd(a, root * (1 - y), sag_sub(b, a)), root * y, sag_sub(c, a));
}

static double fan_area(const sagi_polyhedron_face *face, int k) {
    return sag_length(sag_cross(sag_sub(face->vertices[k - 1], face->vertices[0]),
                                sag_sub(face->vertices[k], face->vertices[0]))) /
           2;
}

bool sag_polyhedron_sample(const sag_polyhedron *polyhedron, sag_vec2 random, sag_surface *surface) {
    double area = sag_polyhedron_area(polyhedron);
    if (!(area > 0) || isinf(area)) return false;
    // The first number picks a triangle of a face by area and is stretched to be used again within it.
    double at = random.x * area, size = 0, x = 0;
    uint32_t chosen = 0;
    sag_vec3 triangle[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    bool done = false;
    sagi_polyhedron_face face;
    for (uint32_t i = 0; i < polyhedron->plane_count && !done; i++) {
        sagi_polyhedron_face_find(polyhedron, i, &face);
        for (int k = 2; k < face.count && !done; k++) {
            double part = fan_area(&face, k);
            if (!(part > 0)) continue;
            triangle[0] = face.vertices[0], triangle[1] = face.vertices[k - 1],
            triangle[2] = face.vertices[k];
            chosen = i, done = at < part, x = fmin(at / part, 1);
            if (!done) at -= part;
        }
    }
    surface->position = in_triangle(triangle[0], triangle[1], triangle[2], x, random.y);
    for (int k = 0; k < 3; k++) size = fmax(size, sag_max_component(sag_abs(triangle[k])));
    surface->position_error = sag_scale((sag_vec3){size, size, size}, 16 * SAGI_EPSILON);
    finish_face(polyhedron, chosen, surface);
    sagi_surface_finish_sample(surface, chosen);
    return true;
}

bool sag_polyhedron_contains(const sag_polyhedron *polyhedron, sag_vec3 point) {
    if (!sag_is_finite(point) || !is_usable(polyhedron)) return false;
    sag_ray ray = {.origin = point};
    for (uint32_t i = 0; i < polyhedron->plane_count; i++) {
        sagi_clip_face f;
        quick(polyhedron, &ray, i, &f);
        if (f.num > f.num_error) continue;
        if (!(f.num >= -f.num_error)) return false;
        sagi_clip_real r;
        exact(polyhedron, &ray, i, &r);
        if (sagi_real_sign(&r.num) < 0) return false;
    }
    return true;
}

double sag_polyhedron_volume(const sag_polyhedron *polyhedron) {
    if (check_planes(polyhedron, NULL) != SAG_OK) return 0;
    // Pyramids from one vertex of the solid to each face.
    double volume = 0;
    bool has_apex = false;
    sag_vec3 apex = {0, 0, 0};
    sagi_polyhedron_face face;
    for (uint32_t i = 0; i < polyhedron->plane_count; i++) {
        sagi_polyhedron_face_find(polyhedron, i, &face);
        if (face.count < 3) continue;
        if (face.unbounded) return INFINITY;
        if (!has_apex) apex = face.vertices[0], has_apex = true;
        sag_vec3 n = sag_normalize(polyhedron->planes[i].normal);
        volume += sag_dot(n, sag_sub(face.vertices[0], apex)) * sagi_polyhedron_face_area(&face) / 3;
    }
    return volume;
}

// The nearest point of a convex outline with the unit normal n.
static sag_vec3 nearest_on_face(const sagi_polyhedron_face *face, sag_vec3 n, sag_vec3 point) {
    double height = sag_dot(n, sag_sub(face->vertices[0], point));
    sag_vec3 best = sag_madd(point, height, n), foot = best;
    double best_distance = INFINITY;
    int left = 0, right = 0;
    for (int k = 0; k < face->count; k++) {
        sag_vec3 a = face->vertices[k], b = face->vertices[(k + 1) % face->count];
        // From the end nearer to the point: the other may be very far away.
        if (sag_length(sag_sub(b, point)) < sag_length(sag_sub(a, point))) {
            sag_vec3 swap = a;
            a = b, b = swap;
        }
        sag_vec3 along = sag_sub(b, a), w = sag_sub(foot, a);
        double turn = sag_dot(n, sag_cross(along, w));
        if (sag_dot(along, sag_sub(face->vertices[(k + 1) % face->count], face->vertices[k])) < 0)
            turn = -turn;
        if (turn > 0) left++;
        if (turn < 0) right++;
        double length = sag_length(along), s = length > 0 ? sag_dot(w, along) / length / length : 0;
        sag_vec3 q = sag_madd(a, fmax(0, fmin(s, 1)), along);
        double distance = sag_length(sag_sub(q, point));
        if (distance < best_distance) best = q, best_distance = distance;
    }
    return left == 0 || right == 0 ? foot : best;
}

sag_vec3 sag_polyhedron_closest_point(const sag_polyhedron *polyhedron, sag_vec3 point) {
    sag_vec3 best = point;
    double best_distance = INFINITY;
    if (check_planes(polyhedron, NULL) != SAG_OK) return best;
    sagi_polyhedron_face face;
    for (uint32_t i = 0; i < polyhedron->plane_count; i++) {
        sagi_polyhedron_face_find(polyhedron, i, &face);
        if (face.count < 3) continue;
        sag_vec3 q = nearest_on_face(&face, sag_normalize(polyhedron->planes[i].normal), point);
        double distance = sag_length(sag_sub(q, point));
        if (distance < best_distance) best = q, best_distance = distance;
    }
    return best;
}
