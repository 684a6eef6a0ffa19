// SPDX-License-Identifier: MIT
// The flat polygon with holes.
//
// Inside. Cut each loop into a fan of triangles from its first point. A point lies in an odd number of all
// those triangles exactly when it lies inside an odd number of loops: the fan's inner edges are shared by two
// triangles and cancel. So the line pierces the polygon when it pierces an odd number of fan triangles, and
// that is decided exactly, ties included (triangle_test.c): polygons and triangles that share whole edges
// make a watertight surface, and a ray in the polygon's plane misses. The points need not be quite in a
// plane; the triangles of a fan are seen along the ray and only their outlines count.
//
// t is that of the plane (polygon_plane.c). A line almost in a plane that is not quite one could be inside by
// the outline and meet the plane far away: what lies outside the bounds is not a hit.
#include "shapes/polygon.h"
#include "shapes/cut.h"
#include "shapes/triangle.h"

static bool is_inside(const sag_polygon *s, const sag_ray *ray) {
    sagi_triangle_ray prepared = sagi_triangle_prepare(ray);
    bool odd = false;
    uint32_t first = 0;
    for (uint32_t l = 0; l < s->loop_count; first += s->loop_sizes[l++])
        for (uint32_t i = first + 1; i + 1 < first + s->loop_sizes[l]; i++)
            if (sagi_triangle_side(&prepared, &s->positions[first], &s->positions[i], &s->positions[i + 1]))
                odd = !odd;
    return odd;
}

static int dropped_axis(const sagi_polygon_plane *plane) {
    sag_vec3 n = sag_abs(plane->unit);
    return n.x > n.y ? (n.x > n.z ? 0 : 2) : (n.y > n.z ? 1 : 2);
}

static sag_status check_loops(const sag_polygon *s, sag_error *error) {
    if (!s->positions || !s->loop_sizes || s->loop_count == 0)
        return sag_error_set(error, SAG_ERROR_GEOMETRY,
                             "polygon: positions, loop_sizes and loop_count must be given");
    uint64_t total = 0;
    for (uint32_t l = 0; l < s->loop_count; l++) {
        if (s->loop_sizes[l] < 3)
            return sag_error_set(error, SAG_ERROR_GEOMETRY, "polygon.loop_sizes[%u] is %u: at least 3 points",
                                 l, s->loop_sizes[l]);
        total += s->loop_sizes[l];
    }
    if (total != s->position_count)
        return sag_error_set(error, SAG_ERROR_GEOMETRY,
                             "polygon.loop_sizes add up to %llu, position_count is %u",
                             (unsigned long long)total, s->position_count);
    return SAG_OK;
}

sag_status sag_polygon_validate(const sag_polygon *s, sag_error *error) {
    sag_status status = check_loops(s, error);
    if (status != SAG_OK) return status;
    for (uint32_t i = 0; i < s->position_count; i++) {
        sag_vec3 p = s->positions[i];
        if (!sag_is_finite(p) || !(sag_max_component(sag_abs(p)) <= SAG_MAX_COORDINATE))
            return sag_error_set(
                error, SAG_ERROR_GEOMETRY,
                "polygon.positions[%u] is (%g, %g, %g): not finite or beyond SAG_MAX_COORDINATE", i, p.x, p.y,
                p.z);
    }
    sagi_polygon_plane plane;
    if (!sagi_polygon_make_plane(s, &plane))
        return sag_error_set(error, SAG_ERROR_GEOMETRY, "polygon: the first loop has no area");
    double extent = ldexp(plane.size, plane.scale_exponent), off = sagi_polygon_deviation(s, &plane);
    if (!(off <= 1e-9 * extent))
        return sag_error_set(error, SAG_ERROR_GEOMETRY,
                             "polygon is not planar: a point lies %g off the plane, of an extent of %g", off,
                             extent);
    uint32_t edges[2];
    if (sagi_polygon_crosses_itself(s, dropped_axis(&plane), edges))
        return sag_error_set(error, SAG_ERROR_GEOMETRY,
                             "polygon crosses itself: the edges from positions[%u] and positions[%u]",
                             edges[0], edges[1]);
    return SAG_OK;
}

// The box of the points, and of their projections on the plane.
static sag_box3 bounds(const sag_polygon *s, const sagi_polygon_plane *plane) {
    sag_box3 box = sag_box3_empty();
    for (uint32_t i = 0; i < s->position_count; i++) box = sag_box3_extend(box, s->positions[i]);
    double off = 2 * sagi_polygon_deviation(s, plane);
    sag_vec3 margin = sag_scale(sag_abs(plane->unit), off);
    box.min = sag_sub(box.min, margin);
    box.max = sag_add(box.max, margin);
    return sagi_box3_round_out(box, 2);
}

sag_box3 sag_polygon_bounds(const sag_polygon *s) {
    sagi_polygon_plane plane;
    if (!sagi_polygon_is_readable(s) || !sagi_polygon_make_plane(s, &plane)) return sag_box3_empty();
    return bounds(s, &plane);
}

static bool near_box(const sag_box3 *box, const sag_ray *ray, double t) {
    for (int axis = 0; axis < 3; axis++) {
        double o = sag_component(ray->origin, axis), way = t * sag_component(ray->direction, axis);
        double slack = 8 * SAGI_EPSILON * (fabs(o) + fabs(way)), p = o + way;
        if (!(p + slack >= sag_component(box->min, axis) && p - slack <= sag_component(box->max, axis)))
            return false;
    }
    return true;
}

bool sag_polygon_hit(const sag_polygon *s, const sag_ray *ray, sag_hit *hit) {
    if (!sag_ray_is_valid(ray) || !sagi_polygon_is_readable(s)) return false;
    sagi_polygon_plane plane;
    if (!is_inside(s, ray) || !sagi_polygon_make_plane(s, &plane)) return false;
    double t = sagi_polygon_plane_t(s, &plane, ray);
    if (!sagi_in_range(ray, t)) return false;
    sag_box3 box = bounds(s, &plane);
    if (!near_box(&box, ray, t)) return false;
    *hit = sagi_hit_make(t, 0, 0, 0);
    return true;
}

bool sag_polygon_occluded(const sag_polygon *s, const sag_ray *ray) {
    sag_hit hit;
    return sag_polygon_hit(s, ray, &hit);
}

size_t sag_polygon_crossings(const sag_polygon *s, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sag_hit hit;
    if (!sag_polygon_hit(s, ray, &hit)) return 0;
    if (capacity > 0) hits[0] = hit;
    return 1;
}

static sag_vec3 plane_middle(const sag_polygon *s, const sagi_polygon_plane *plane) {
    sag_vec3 way = {plane->middle[0].hi, plane->middle[1].hi, plane->middle[2].hi};
    return sag_madd(s->positions[0], ldexp(1, plane->scale_exponent), way);
}

// Everything but side and ids at a point near the plane. The point is moved onto the plane; what is left is
// the rounding of that step, 8ε (|p| + the polygon's size), ε = 2⁻⁵³, and that is its distance from the
// polygon.
static void make_surface(const sag_polygon *s, const sagi_polygon_plane *plane, sag_vec3 p,
                         sag_surface *surface) {
    sag_vec3 n = plane->unit;
    double off = sag_dot(sag_sub(p, plane_middle(s, plane)), n);
    p = sag_madd(p, -off, n);
    double size = 8 * SAGI_EPSILON * ldexp(plane->size, plane->scale_exponent);
    sag_vec3 u_axis = sag_sub(s->positions[1], s->positions[0]);
    u_axis = sag_normalize(sag_madd(u_axis, -sag_dot(u_axis, n), n));
    if (!(sag_dot(u_axis, u_axis) > 0)) { // positions[0] and [1] are the same
        sag_vec3 unused;
        sag_frame(n, &u_axis, &unused);
    }
    surface->position = p;
    surface->position_error = sag_madd(sag_vec3_make(size, size, size), 8 * SAGI_EPSILON, sag_abs(p));
    surface->geometric_normal = n;
    surface->dpdu = u_axis;
    surface->dpdv = sag_cross(n, u_axis);
    sag_vec3 from_first = sag_sub(p, s->positions[0]);
    surface->u = sag_dot(from_first, surface->dpdu);
    surface->v = sag_dot(from_first, surface->dpdv);
}

void sag_polygon_surface(const sag_polygon *s, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    sagi_polygon_plane plane;
    if (!sagi_polygon_is_readable(s) || !sagi_polygon_make_plane(s, &plane)) return;
    // Where the ray cuts the plane, in double-double: t alone, rounded, puts the point of a ray from far away
    // beside the polygon.
    sag_ray line = *ray;
    line.t_min = -INFINITY, line.t_max = INFINITY;
    sagi_cut cut;
    sag_vec3 point = sag_ray_at(ray, hit->t), unused;
    if (sagi_cut_plane(plane.unit, plane_middle(s, &plane), &line, &cut))
        sagi_point_at(ray, cut, &point, &unused);
    make_surface(s, &plane, point, surface);
    sagi_surface_finish(surface, ray, hit);
}

// Seen along an axis an area shrinks by that component of the normal.
double sag_polygon_area(const sag_polygon *s) {
    sagi_polygon_plane plane;
    if (!sagi_polygon_is_readable(s) || !sagi_polygon_make_plane(s, &plane)) return 0;
    int axis = dropped_axis(&plane);
    return sagi_polygon_flat_area(s, axis) / fabs(sag_component(plane.unit, axis));
}

bool sag_polygon_sample(const sag_polygon *s, sag_vec2 random, sag_surface *surface) {
    sagi_polygon_plane plane;
    if (!sagi_polygon_is_readable(s) || !sagi_polygon_make_plane(s, &plane)) return false;
    int axis = dropped_axis(&plane);
    if (!(sagi_polygon_flat_area(s, axis) > 0)) return false;
    sag_vec2 flat = sagi_polygon_flat_sample(s, axis, random);
    sag_vec3 n = plane.unit, m = plane_middle(s, &plane), p;
    if (axis == 0)
        p = sag_vec3_make(m.x - (n.y * (flat.x - m.y) + n.z * (flat.y - m.z)) / n.x, flat.x, flat.y);
    else if (axis == 1)
        p = sag_vec3_make(flat.y, m.y - (n.z * (flat.x - m.z) + n.x * (flat.y - m.x)) / n.y, flat.x);
    else
        p = sag_vec3_make(flat.x, flat.y, m.z - (n.x * (flat.x - m.x) + n.y * (flat.y - m.y)) / n.z);
    make_surface(s, &plane, p, surface);
    sagi_surface_finish_sample(surface, 0);
    return true;
}

static sag_vec3 nearest_on_edge(sag_vec3 a, sag_vec3 b, sag_vec3 p) {
    sag_vec3 ab = sag_sub(b, a);
    double along = sag_dot(sag_sub(p, a), ab), square = sag_dot(ab, ab);
    if (!(along > 0)) return a;
    return along < square ? sag_madd(a, along / square, ab) : b;
}

// The foot of the perpendicular when it is inside, else the nearest point of the boundary.
sag_vec3 sag_polygon_closest_point(const sag_polygon *s, sag_vec3 point) {
    sagi_polygon_plane plane;
    sag_vec3 best = {NAN, NAN, NAN};
    if (!sagi_polygon_is_readable(s) || !sagi_polygon_make_plane(s, &plane)) return best;
    sag_ray perpendicular = sag_ray_make(point, plane.unit);
    if (sag_ray_is_valid(&perpendicular) && is_inside(s, &perpendicular))
        return sag_madd(point, -sag_dot(sag_sub(point, plane_middle(s, &plane)), plane.unit), plane.unit);
    double best_square = INFINITY;
    uint32_t first = 0;
    for (uint32_t l = 0; l < s->loop_count; first += s->loop_sizes[l++])
        for (uint32_t i = first; i < first + s->loop_sizes[l]; i++) {
            uint32_t next = sagi_polygon_next(i, first, s->loop_sizes[l]);
            sag_vec3 near = nearest_on_edge(s->positions[i], s->positions[next], point);
            sag_vec3 way = sag_sub(near, point);
            if (!(sag_dot(way, way) < best_square)) continue;
            best_square = sag_dot(way, way);
            best = near;
        }
    return best;
}
