// SPDX-License-Identifier: MIT
// Two intervals of a ray in each of the thirteen relations they can have to each other (Allen, "Maintaining
// Knowledge about Temporal Intervals", CACM 26(11), 1983), under each operator, in both orders, made by every
// pair of shapes whose ends on the axis are exact: the boundaries must be those of the intervals' sum,
// overlap, rest or symmetric difference, in number, place and owner, with nothing where ends coincide. And
// ends that nearly coincide: below the tolerance of solid.h they are one, above it they are two.
#include "support/context.h"
#include "support/solid_check.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>
// clang-format on

// Ends of A and B in steps; between the steps lie any lengths.
static const struct {
    const char *name;
    int a0, a1, b0, b1;
} relations[13] = {{"before", 0, 1, 2, 3},    {"after", 2, 3, 0, 1},         {"meets", 0, 1, 1, 2},
                   {"is met by", 1, 2, 0, 1}, {"overlaps", 0, 2, 1, 3},      {"is overlapped by", 1, 3, 0, 2},
                   {"starts", 0, 1, 0, 2},    {"is started by", 0, 2, 0, 1}, {"during", 1, 2, 0, 3},
                   {"contains", 0, 3, 1, 2},  {"finishes", 1, 2, 0, 2},      {"is finished by", 0, 2, 1, 2},
                   {"equals", 0, 1, 0, 1}};

typedef enum figure {
    FIGURE_BOX,
    FIGURE_ORIENTED_BOX,
    FIGURE_POLYHEDRON,
    FIGURE_MESH,
    FIGURE_CYLINDER,
    FIGURE_HYPERBOLOID,
    FIGURE_SOLID, // two boxes, one on the other
    FIGURE_CONE,  // from here on not with flat ends across
    FIGURE_PARABOLOID,
    FIGURE_SPHERE,
    FIGURE_ELLIPSOID,
    FIGURE_QUADRIC,
    FIGURE_CAPSULE,
    FIGURE_COUNT
} figure;

static void cube_mesh(random_shape *s, double w, double low, double high) {
    static const uint32_t faces[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                       2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    for (int i = 0; i < 8; i++) {
        s->doubles[3 * i] = i & 1 ? w : -w, s->doubles[3 * i + 1] = i & 2 ? w : -w;
        s->doubles[3 * i + 2] = i & 4 ? high : low;
    }
    memcpy(s->indices, faces, sizeof faces);
    s->kind = SAG_SHAPE_MESH;
    s->as.mesh = (sag_mesh){
        .positions_f64 = s->doubles, .triangles = s->indices, .vertex_count = 8, .triangle_count = 12};
}

static void slab_planes(random_shape *s, double w, double low, double high) {
    for (int i = 0; i < 6; i++) {
        double sign = i % 2 ? 1 : -1;
        s->planes[i].normal = (sag_vec3){sign * (i / 2 == 0), sign * (i / 2 == 1), sign * (i / 2 == 2)};
        s->planes[i].offset = i < 4 ? w : i == 4 ? -low : high;
    }
    s->kind = SAG_SHAPE_POLYHEDRON;
    s->as.polyhedron = (sag_polyhedron){s->planes, 6};
}

static void put_box(model_part *part, double w, double low, double high) {
    part->shape.kind = SAG_SHAPE_BOX;
    part->shape.as.box = (sag_box){{-w, -w, low}, {w, w, high}};
}

static void put_two_boxes(model_part *part, double w, double low, double high) {
    solid_model *child = solid_model_create();
    double middle = 0.5 * (low + high);
    put_box(solid_model_add(child), w, low, middle);
    put_box(solid_model_add(child), w, middle, high);
    solid_model_step(child, SAG_SOLID_UNION, 2);
    rng r = rng_make(1);
    assert_int_equal(solid_model_finish(child, context, &r, NULL), SAG_OK);
    part->child = child;
}

// The figure that the z axis meets from low to high, w wide.
static void put(model_part *part, figure f, double w, double low, double high) {
    random_shape *s = &part->shape;
    double half = 0.5 * (high - low), middle = low + half;
    sag_vec3 center = {0, 0, middle};
    sag_affine shift = sag_affine_translate((sag_vec3){0, 0, low});
    switch (f) {
    case FIGURE_BOX: put_box(part, w, low, high); break;
    case FIGURE_ORIENTED_BOX:
        s->kind = SAG_SHAPE_ORIENTED_BOX;
        s->as.oriented_box = (sag_oriented_box){center, {{w, 0, 0}, {0, w, 0}, {0, 0, half}}};
        break;
    case FIGURE_POLYHEDRON: slab_planes(s, w, low, high); break;
    case FIGURE_MESH: cube_mesh(s, w, low, high); break;
    case FIGURE_CYLINDER:
        s->kind = SAG_SHAPE_CYLINDER, s->as.cylinder = (sag_cylinder){w, low, high, 0, true};
        break;
    case FIGURE_HYPERBOLOID:
        s->kind = SAG_SHAPE_HYPERBOLOID;
        s->as.hyperboloid = (sag_hyperboloid){{w, 0, low}, {w, 0.5 * w, high}, 0, true};
        break;
    case FIGURE_SOLID: put_two_boxes(part, w, low, high); break;
    case FIGURE_CONE:
        s->kind = SAG_SHAPE_CONE, s->as.cone = (sag_cone){w, high - low, 0, true};
        solid_model_map(part, &shift);
        break;
    case FIGURE_PARABOLOID:
        s->kind = SAG_SHAPE_PARABOLOID, s->as.paraboloid = (sag_paraboloid){w, 0, high - low, 0, true};
        solid_model_map(part, &shift);
        break;
    case FIGURE_SPHERE:
        s->kind = SAG_SHAPE_SPHERE, s->as.sphere = (sag_sphere){.center = center, .radius = half};
        break;
    case FIGURE_ELLIPSOID:
        s->kind = SAG_SHAPE_ELLIPSOID, s->as.ellipsoid = (sag_ellipsoid){center, {w, w, half}};
        break;
    case FIGURE_QUADRIC: // (z − low)(z − high) + x² + y² ≤ 0
        s->kind = SAG_SHAPE_QUADRIC;
        s->as.quadric =
            (sag_quadric){{1, 1, 1, 0, 0, 0, 0, 0, -middle, low * high},
                          {{-2 * half, -2 * half, low - half}, {2 * half, 2 * half, high + half}}};
        break;
    case FIGURE_CAPSULE:
        s->kind = SAG_SHAPE_CAPSULE;
        s->as.capsule = (sag_capsule){{0, 0, low + 0.5 * half}, {0, 0, high - 0.5 * half}, 0.5 * half};
        break;
    case FIGURE_COUNT: break;
    }
}

// The intervals and what the operator makes of them: where the value changes along the axis, in order.
typedef struct line {
    double end[2][2];
    sag_solid_operation operation;
} line;

static membership within(const line *l, int which, double z) {
    return z > l->end[which][0] && z < l->end[which][1] ? MEMBER_IN : MEMBER_OUT;
}
static bool value(const line *l, double z) {
    bool a = within(l, 0, z) == MEMBER_IN, b = within(l, 1, z) == MEMBER_IN;
    switch (l->operation) {
    case SAG_SOLID_PART: break;
    case SAG_SOLID_UNION: return a || b;
    case SAG_SOLID_INTERSECTION: return a && b;
    case SAG_SOLID_DIFFERENCE: return a && !b;
    case SAG_SOLID_XOR: return a != b;
    }
    return false;
}

static int changes(const line *l, double place[4], double step) {
    double z[4] = {l->end[0][0], l->end[0][1], l->end[1][0], l->end[1][1]};
    int count = 0;
    for (int i = 0; i < 4; i++)
        for (int k = i + 1; k < 4; k++)
            if (z[k] < z[i]) {
                double swap = z[i];
                z[i] = z[k], z[k] = swap;
            }
    for (int i = 0; i < 4; i++)
        if ((i == 0 || z[i] > z[i - 1]) && value(l, z[i] - step) != value(l, z[i] + step))
            place[count++] = z[i];
    return count;
}

// The boundaries along a ray at height z = o.z + t d.z are those of the intervals that lie in its range.
static void check_line(solid_world *w, const line *l, const sag_ray *ray, double step, solid_tally *tally) {
    double place[4];
    int count = changes(l, place, step), expected = 0;
    double o = ray->origin.z, d = ray->direction.z;
    sag_hit hits[8];
    size_t found = sag_intersect_all(w->scene, ray, hits, 8);
    for (int k = 0; k < count; k++) {
        double z = d > 0 ? place[k] : place[count - 1 - k], t = (z - o) / d;
        if (!(t >= ray->t_min && t <= ray->t_max)) continue;
        size_t i = (size_t)expected++;
        if (i >= found) continue;
        double reach = (fabs(o) + fabs(t * d)) / fabs(d);
        bool enters = value(l, z + copysign(step, d));
        sag_surface s;
        sag_surface_at(w->scene, ray, &hits[i], &s);
        if (!(fabs(hits[i].t - t) <= 0x1p-48 * reach) || (s.side == SAG_SIDE_FRONT) != enters) tally->wrong++;
        if (w->model->parts[0]->child || w->model->parts[1]->child) continue; // solid_check_ray knows them
        membership before[2], after[2];
        for (int p = 0; p < 2; p++) {
            before[p] = within(l, p, z - copysign(step, d));
            after[p] = within(l, p, z + copysign(step, d));
        }
        uint32_t owner = solid_model_owner(w->model, before, after), named;
        solid_model_find(w->model, hits[i].instance_path + 1, hits[i].instance_depth - 1, hits[i].geometry,
                         &named);
        if (named != owner || hits[i].flipped != ((after[owner] == MEMBER_IN) != enters)) {
            print_message("owner %u, not %u, flipped %u\n", named, owner, hits[i].flipped);
            tally->wrong++;
        }
    }
    if (found != (size_t)expected) {
        tally->wrong++;
        print_message("%zu boundaries, not %d\n", found, expected);
    }
    tally->decisions += found;
}

static void check_pair(rng *r, figure f, figure g, int relation, sag_solid_operation operation, bool swapped,
                       solid_tally *tally) {
    double unit = ldexp(1, (int)rng_below(r, 40) - 20), at[4], w = 4 * unit;
    at[0] = rng_one_in(r, 2) ? 0 : unit * ((double)rng_below(r, 1 << 16) - (1 << 15));
    for (int i = 1; i < 4; i++) at[i] = at[i - 1] + 4 * unit * (1 + rng_below(r, 4));
    line l = {{{at[relations[relation].a0], at[relations[relation].a1]},
               {at[relations[relation].b0], at[relations[relation].b1]}},
              operation};
    if (swapped) {
        line turned = {{{l.end[1][0], l.end[1][1]}, {l.end[0][0], l.end[0][1]}}, operation};
        l = turned;
    }
    solid_model *model = solid_model_create();
    put(solid_model_add(model), f, w, l.end[0][0], l.end[0][1]);
    put(solid_model_add(model), g, w, l.end[1][0], l.end[1][1]);
    solid_model_step(model, operation, 2);
    sag_error error = {0};
    if (solid_model_finish(model, context, r, &error) != SAG_OK) fail_msg("%s", error.message);
    solid_world world;
    solid_world_make(&world, context, model, NULL, at[3] - at[0]);
    size_t wrong = tally->wrong;
    for (int k = 0; k < 8; k++) {
        double sign = k % 2 ? -1 : 1, start = k % 2 ? at[3] + 8 * unit : at[0] - 8 * unit;
        sag_ray ray = {.origin = {0, 0, start}, .direction = {0, 0, sign * ldexp(1, k)}, .t_max = INFINITY};
        if (k == 2 || k == 3) // where something begins or ends: both ends belong to the range
            ray.t_min = (at[1 + rng_below(r, 2)] - start) / ray.direction.z,
            ray.t_max = ray.t_min + 64 * unit;
        if (k == 4) ray.t_max = (at[1 + rng_below(r, 3)] - start) / ray.direction.z;
        if (k == 5) ray.origin.z = at[rng_below(r, 4)];
        if (k >= 6 && f < FIGURE_CONE && g < FIGURE_CONE) { // across the flat ends, with any t
            sag_vec3 from = {rng_uniform(r, -0.1, 0.1) * w, rng_uniform(r, -0.1, 0.1) * w, start};
            sag_vec3 to = {rng_uniform(r, -0.1, 0.1) * w, rng_uniform(r, -0.1, 0.1) * w,
                           at[0] + at[3] - start};
            ray.origin = from, ray.direction = sag_scale(sag_sub(to, from), rng_uniform(r, 0.5, 2));
        }
        check_line(&world, &l, &ray, unit, tally);
        solid_check_ray(&world, &ray, r, false, tally);
    }
    if (tally->wrong != wrong)
        print_message("%s %s %s, operator %d, figures %d %d\n", swapped ? "B" : "A", relations[relation].name,
                      swapped ? "A" : "B", (int)operation, (int)f, (int)g);
    solid_world_free(&world);
}

static void every_relation(void **state) {
    (void)state;
    rng r = rng_make(13);
    solid_tally tally = {0};
    static const sag_solid_operation operators[4] = {SAG_SOLID_UNION, SAG_SOLID_INTERSECTION,
                                                     SAG_SOLID_DIFFERENCE, SAG_SOLID_XOR};
    for (int f = 0; f < FIGURE_COUNT; f++)
        for (int g = 0; g < FIGURE_COUNT; g++)
            for (int k = 0; k < 13 * 8; k++)
                check_pair(&r, (figure)f, (figure)g, k % 13, operators[k / 13 % 4], k >= 52, &tally);
    solid_tally_finish(&tally, "Allen");
}

// Boxes whose ends differ by some times the tolerance: a gap or a sliver of a quarter of it is not there,
// one of four times it is.
static void nearly_coincident(void **state) {
    (void)state;
    rng r = rng_make(14);
    size_t decisions = 0;
    for (int i = 0; i < 20000; i++) {
        double scale = ldexp(1, (int)rng_below(&r, 60) - 30), face = rng_uniform(&r, 1, 2) * scale;
        double start = -rng_log_uniform(&r, 4, 1e6) * scale, times = i % 2 ? 0.25 : 4;
        double gap = times * 0x1p-49 * (fabs(start) + (face - start)), other = face + gap;
        if (i % 2 == 0 && other == face) continue;
        sag_box low = {{-scale, -scale, 0}, {scale, scale, i % 4 < 2 ? face : other}};
        sag_box high = {{-scale, -scale, i % 4 < 2 ? other : face}, {scale, scale, 4 * scale}};
        bool overlap = i % 4 >= 2, seen = i % 2 == 0;
        for (int k = 0; k < 4; k++) {
            sag_solid_operation operation = (sag_solid_operation)(SAG_SOLID_UNION + k);
            sag_scene *solid = sag_scene_create(context);
            sag_solid_step steps[3] = {{SAG_SOLID_PART, sag_add_box(solid, &low)},
                                       {SAG_SOLID_PART, sag_add_box(solid, &high)},
                                       {operation, 2}};
            assert_int_equal(sag_scene_set_solid(solid, &(sag_solid){steps, 3}, NULL), SAG_OK);
            assert_int_equal(sag_scene_commit(solid, NULL), SAG_OK);
            sag_scene *scene = sag_scene_create(context);
            sag_affine here = sag_affine_identity();
            sag_add_instance(scene, solid, &here);
            assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
            size_t expected = 2;
            if (operation == SAG_SOLID_UNION && seen && !overlap) expected = 4;
            if (operation == SAG_SOLID_XOR && seen) expected = 4;
            if (operation == SAG_SOLID_INTERSECTION) expected = seen && overlap ? 2 : 0;
            for (int way = 0; way < 2; way++) {
                double d = rng_uniform(&r, 0.5, 2);
                sag_ray ray = sag_ray_make((sag_vec3){0.1 * scale, 0.2 * scale, start}, (sag_vec3){0, 0, d});
                if (way) ray.origin.z = face - start, ray.direction.z = -d;
                size_t count = sag_count_crossings(scene, &ray);
                if (count != expected)
                    fail_msg("%zu boundaries, not %zu: faces %a %a, from %a, operator %d", count, expected,
                             face, other, ray.origin.z, (int)operation);
                decisions++;
            }
            sag_scene_destroy(scene), sag_scene_destroy(solid);
        }
    }
    print_message("%zu decisions\n", decisions);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_relation), cmocka_unit_test(nearly_coincident)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
