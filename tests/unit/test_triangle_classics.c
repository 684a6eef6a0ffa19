// SPDX-License-Identifier: MIT
// The three classic formulations of ray against triangle, in doubles as textbooks have them, beside the exact
// one. They agree where nothing is close; docs/triangles.md quotes the figures this prints for the rest.
#include "support/exact_triangle.h"
#include "support/meshes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

typedef bool formulation(const sag_vec3 p[3], const sag_ray *ray, double *t);

static double turn(double ax, double ay, double bx, double by) { return ax * by - ay * bx; }

// 1. Where the ray meets the plane, and on which side of each edge that is.
static bool plane_and_edges(const sag_vec3 p[3], const sag_ray *ray, double *t) {
    sag_vec3 n = sag_cross(sag_sub(p[1], p[0]), sag_sub(p[2], p[0]));
    double along = sag_dot(n, ray->direction);
    if (!(along < 0 || along > 0)) return false;
    *t = sag_dot(n, sag_sub(p[0], ray->origin)) / along;
    sag_vec3 q = sag_ray_at(ray, *t);
    for (int k = 0; k < 3; k++) {
        sag_vec3 edge = sag_sub(p[(k + 1) % 3], p[k]);
        if (!(sag_dot(sag_cross(edge, sag_sub(q, p[k])), n) >= 0)) return false;
    }
    return *t >= ray->t_min && *t <= ray->t_max;
}

// 2. The same point, its barycentric weights from signed areas in the plane without the normal's largest
// axis.
static bool projection(const sag_vec3 p[3], const sag_ray *ray, double *t) {
    sag_vec3 n = sag_cross(sag_sub(p[1], p[0]), sag_sub(p[2], p[0])), size = sag_abs(n);
    double along = sag_dot(n, ray->direction);
    if (!(along < 0 || along > 0)) return false;
    *t = sag_dot(n, sag_sub(p[0], ray->origin)) / along;
    sag_vec3 q = sag_ray_at(ray, *t);
    int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    int i = (axis + 1) % 3, j = (axis + 2) % 3;
    sag_vec3 ab = sag_sub(p[1], p[0]), ac = sag_sub(p[2], p[0]), aq = sag_sub(q, p[0]);
    double bx = sag_component(ab, i), by = sag_component(ab, j), cx = sag_component(ac, i);
    double cy = sag_component(ac, j), qx = sag_component(aq, i), qy = sag_component(aq, j);
    double whole = turn(bx, by, cx, cy), beta = turn(qx, qy, cx, cy) / whole;
    double gamma = turn(bx, by, qx, qy) / whole;
    return beta >= 0 && gamma >= 0 && beta + gamma <= 1 && *t >= ray->t_min && *t <= ray->t_max;
}

// 3. Möller and Trumbore: Cramer's rule for a + β (b − a) + γ (c − a) = o + t d.
static bool cramer(const sag_vec3 p[3], const sag_ray *ray, double *t) {
    sag_vec3 ab = sag_sub(p[1], p[0]), ac = sag_sub(p[2], p[0]), ao = sag_sub(ray->origin, p[0]);
    sag_vec3 across = sag_cross(ray->direction, ac);
    double determinant = sag_dot(ab, across);
    if (!(determinant < 0 || determinant > 0)) return false;
    double beta = sag_dot(ao, across) / determinant;
    if (!(beta >= 0 && beta <= 1)) return false;
    sag_vec3 up = sag_cross(ao, ab);
    double gamma = sag_dot(ray->direction, up) / determinant;
    if (!(gamma >= 0 && beta + gamma <= 1)) return false;
    *t = sag_dot(ac, up) / determinant;
    return *t >= ray->t_min && *t <= ray->t_max;
}

static bool exact(const sag_vec3 p[3], const sag_ray *ray, double *t) {
    sag_triangle s = {p[0], p[1], p[2], false};
    sag_hit hit;
    bool result = sag_triangle_hit(&s, ray, &hit);
    if (result) *t = hit.t;
    return result;
}

enum { CLASSICS = 3, ALL = 4 };
static const struct {
    const char *name;
    formulation *hit;
} formulations[ALL] = {{"plane and edges", plane_and_edges},
                       {"projection to 2D", projection},
                       {"Cramer's rule", cramer},
                       {"exact", exact}};

// What a set of rays showed of one formulation.
typedef struct score {
    size_t wrong;  // decisions, or rays that cross a closed mesh not once but never or more than once
    size_t missed; // those of them that were never
    double t_error_ulp;
} score;

static void print_scores(const char *name, size_t rays, const score scores[ALL], bool has_t) {
    printf("%-46s %6zu rays:", name, rays);
    for (int k = 0; k < ALL; k++) {
        printf("  %s %zu", formulations[k].name, scores[k].wrong);
        if (has_t)
            printf(" (t %.3g ulp)", scores[k].t_error_ulp);
        else
            printf(" (%zu missed)", scores[k].missed);
    }
    printf("\n");
}

typedef struct ray_kind {
    const char *name;
    double origin_min, origin_max; // distance of the origin in sizes of the triangle
    double cosine;                 // at least so steep; 0: as it comes
    double flatness;               // how far off the line a b the corner c lies
} ray_kind;

// Aimed at random points in and around random triangles.
static void random_rays(const ray_kind *kind, score scores[ALL], size_t count, rng *r) {
    for (size_t i = 0; i < count; i++) {
        sag_vec3 p[3] = {rng_vec3(r, 1), rng_vec3(r, 1), rng_vec3(r, 1)};
        if (kind->flatness < 1)
            p[2] = sag_madd(sag_madd(p[0], 0.5, sag_sub(p[1], p[0])), kind->flatness, rng_vec3(r, 1));
        sag_vec3 n = sag_normalize(sag_cross(sag_sub(p[1], p[0]), sag_sub(p[2], p[0]))), d = rng_direction(r);
        if (kind->cosine > 0) {
            d = sag_madd(d, -sag_dot(d, n), n);
            d = sag_normalize(sag_madd(d, kind->cosine, n));
        }
        double u = rng_uniform(r, -0.1, 1.1), v = rng_uniform(r, -0.1, 1.1);
        sag_vec3 target = sag_madd(sag_madd(p[0], u, sag_sub(p[1], p[0])), v, sag_sub(p[2], p[0]));
        double away = rng_log_uniform(r, kind->origin_min, kind->origin_max);
        sag_ray ray = {sag_madd(target, -away, d), d, -INFINITY, INFINITY, 0};
        for (int k = 0; k < ALL; k++) {
            double t = NAN;
            bool hit = formulations[k].hit(p, &ray, &t);
            exact_triangle truth = exact_triangle_examine(&ray, p[0], p[1], p[2], t);
            scores[k].wrong += hit != (truth.side != 0);
            if (hit && truth.side != 0)
                scores[k].t_error_ulp = fmax(scores[k].t_error_ulp, truth.t_error_ulp);
        }
    }
}

static void test_random_rays(void **state) {
    (void)state;
    static const ray_kind kinds[] = {{"from 1 to 10 sizes away", 1, 10, 0, 1},
                                     {"from 1e5 to 1e6 sizes away", 1e5, 1e6, 0, 1},
                                     {"from 1e-6 sizes away", 1e-7, 1e-6, 0, 1},
                                     {"grazing by 1e-6", 1, 10, 1e-6, 1},
                                     {"needles 1e-10 wide", 1, 10, 0, 1e-10}};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        rng r = rng_make(i);
        score scores[ALL] = {{0}};
        size_t count = 3000;
        random_rays(&kinds[i], scores, count, &r);
        print_scores(kinds[i].name, count, scores, true);
        assert_int_equal(scores[CLASSICS].wrong, 0);
        assert_true(scores[CLASSICS].t_error_ulp <= 4);
        // None decides wrongly where nothing is close, and none of their t is good to 4 ulp.
        for (int k = 0; k < CLASSICS && i == 0; k++) {
            assert_int_equal(scores[k].wrong, 0);
            assert_true(scores[k].t_error_ulp > 4);
        }
    }
    exact_triangle_end();
}

static sag_vec3 vertex(const test_mesh *m, uint32_t i) {
    return sag_vec3_make(m->positions[3 * i], m->positions[3 * i + 1], m->positions[3 * i + 2]);
}

// Rays from the middle of a sphere through each vertex and each edge's middle must leave it once.
static size_t mesh_rays(const test_mesh *m, sag_vec3 middle, score scores[ALL]) {
    size_t rays = 0;
    for (uint32_t i = 0; i < m->mesh.vertex_count + 3 * m->mesh.triangle_count; i++) {
        uint32_t v = m->mesh.vertex_count;
        sag_vec3 target;
        if (i < v) {
            target = vertex(m, i);
        } else {
            uint32_t corner = i - v, next = corner % 3 == 2 ? corner - 2 : corner + 1;
            sag_vec3 a = vertex(m, m->triangles[corner]), b = vertex(m, m->triangles[next]);
            target = sag_madd(a, 0.5, sag_sub(b, a));
        }
        sag_ray ray = sag_ray_make(middle, sag_sub(target, middle));
        rays++;
        for (int k = 0; k < ALL; k++) {
            int crossings = 0;
            for (uint32_t j = 0; j < m->mesh.triangle_count; j++) {
                double t;
                sag_vec3 p[3];
                for (int c = 0; c < 3; c++) p[c] = vertex(m, m->triangles[3 * j + (uint32_t)c]);
                crossings += formulations[k].hit(p, &ray, &t);
            }
            scores[k].wrong += crossings != 1;
            scores[k].missed += crossings == 0;
        }
    }
    return rays;
}

static void test_edges_and_vertices(void **state) {
    (void)state;
    rng r = rng_make(9);
    static const struct {
        const char *name;
        sag_vec3 middle;
    } places[2] = {{"sphere at 0, through vertices and edges", {0, 0, 0}},
                   {"sphere at (148376, 1234, −223423), the same", {148376, 1234, -223423}}};
    for (int i = 0; i < 2; i++) {
        test_mesh m = test_mesh_sphere(2);
        test_mesh_move(&m, 1, places[i].middle, 0, &r);
        score scores[ALL] = {{0}};
        size_t rays = mesh_rays(&m, places[i].middle, scores);
        print_scores(places[i].name, rays, scores, false);
        assert_int_equal(scores[CLASSICS].wrong, 0);
        for (int k = 0; k < CLASSICS; k++) assert_true(scores[k].wrong > 0);
        test_mesh_free(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_rays),
                                       cmocka_unit_test(test_edges_and_vertices)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
