// SPDX-License-Identifier: MIT
// Scenes that change from commit to commit, with trees kept, renewed and built anew: every answer has the
// same bits as that of a scene made from nothing.
#include "scene/scene.h"
#include "support/context.h"
#include "support/failing_allocator.h"
#include "support/meshes.h"
#include "support/random_scene.h"
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#define MEMBERS 24

// A geometry as the test knows it.
typedef struct member {
    sag_shape_kind kind;
    test_mesh mesh;     // a mesh of its own
    random_shape shape; // or a random shape
    double *centers;    // or a set of spheres
    sag_spheres spheres;
    bool removed, disabled, face_forward;
    bool placed;
    sag_affine map;
    uint32_t mask;
    uint64_t user_data;
} member;

typedef struct model {
    member members[MEMBERS];
    uint32_t count;
    sag_scene *child; // that instances show
} model;

static const void *shape_of(const member *m) {
    if (m->kind == SAG_SHAPE_MESH && m->mesh.positions != NULL) return &m->mesh.mesh;
    if (m->kind == SAG_SHAPE_SPHERES && m->centers != NULL) return &m->spheres;
    return &m->shape.as;
}

static uint32_t add_to(sag_scene *scene, const model *all, const member *m) {
    if (m->kind == SAG_SHAPE_INSTANCE) return sag_add_instance(scene, all->child, m->placed ? &m->map : NULL);
    uint32_t id = sag_add_shape(scene, m->kind, shape_of(m));
    if (id != SAG_INVALID_ID && m->placed) sag_geometry_set_transform(scene, id, &m->map);
    return id;
}

static void describe_to(sag_scene *scene, uint32_t id, const member *m) {
    sag_geometry_set_mask(scene, id, m->mask);
    sag_geometry_set_user_data(scene, id, m->user_data);
    sag_geometry_set_face_forward(scene, id, m->face_forward);
    sag_geometry_set_enabled(scene, id, !m->disabled);
    if (m->removed) sag_geometry_remove(scene, id);
}

// The scene that the model describes, made from nothing.
static sag_scene *fresh(const model *all) {
    sag_scene *scene = sag_scene_create(context);
    for (uint32_t i = 0; i < all->count; i++) {
        assert_int_equal(add_to(scene, all, &all->members[i]), i);
        describe_to(scene, i, &all->members[i]);
    }
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    return scene;
}

static void random_member(rng *r, model *all, member *m) {
    memset(m, 0, sizeof *m);
    switch (rng_below(r, 6)) {
    case 0:
    case 1: // large meshes
        m->kind = SAG_SHAPE_MESH;
        m->mesh = rng_one_in(r, 2) ? test_mesh_sphere(2 + (int)rng_below(r, 2)) : test_mesh_torus(17, 11);
        test_mesh_move(&m->mesh, rng_log_uniform(r, 0.1, 2), rng_vec3(r, 2), 0.01, r);
        break;
    case 2: // large sets of spheres
        m->kind = SAG_SHAPE_SPHERES;
        m->spheres = (sag_spheres){.radius = 0.05, .count = 260 + rng_below(r, 300)};
        m->centers = malloc(m->spheres.count * 3 * sizeof *m->centers);
        for (uint32_t i = 0; i < 3 * m->spheres.count; i++) m->centers[i] = rng_uniform(r, -2, 2);
        m->spheres.centers_f64 = m->centers;
        break;
    case 3: m->kind = SAG_SHAPE_INSTANCE; break;
    default:
        do random_shape_make(r, m->kind = (sag_shape_kind)rng_below(r, SAG_SHAPE_USER), 1, &m->shape);
        while (sag_add_shape(all->child, m->kind, &m->shape.as) == SAG_INVALID_ID);
    }
    m->placed = random_place(r, 2, &m->map) && !sag_affine_is_identity(&m->map);
    m->mask = rng_one_in(r, 3) ? rng_below(r, 8) : 0;
    m->user_data = rng_bits(r);
}

static void add_member(rng *r, model *all, sag_scene *scene) {
    if (all->count == MEMBERS) return;
    member *m = &all->members[all->count];
    random_member(r, all, m);
    assert_int_equal(add_to(scene, all, m), all->count);
    describe_to(scene, all->count, m);
    assert_int_equal(sag_geometry_set_update(scene, all->count, (sag_update)rng_below(r, 3)), SAG_OK);
    all->count++;
}

// Moves the numbers of a description; some become NaN, some triangles lose their area, some things go far
// away.
static void deform(rng *r, sag_scene *scene, member *m, uint32_t id) {
    double by = rng_one_in(r, 6) ? 20 : 0.05;
    if (m->kind == SAG_SHAPE_MESH && m->mesh.positions != NULL) {
        uint32_t n = 3 * m->mesh.mesh.vertex_count;
        for (uint32_t i = 0; i < n; i++) m->mesh.positions[i] += rng_uniform(r, -by, by);
        if (rng_one_in(r, 4)) m->mesh.positions[rng_below(r, n)] = NAN;
        if (rng_one_in(r, 4))
            for (uint32_t i = 0; i < n; i++)
                if (isnan(m->mesh.positions[i])) m->mesh.positions[i] = 0.5;
        if (rng_one_in(r, 4)) memcpy(m->mesh.positions, m->mesh.positions + 3, 3 * sizeof(double));
    } else if (m->kind == SAG_SHAPE_SPHERES && m->centers != NULL) {
        for (uint32_t i = 0; i < 3 * m->spheres.count; i++) m->centers[i] += rng_uniform(r, -by, by);
        if (rng_one_in(r, 4)) m->centers[rng_below(r, 3 * m->spheres.count)] = INFINITY;
        if (rng_one_in(r, 4)) m->spheres.radius *= 1.1;
        if (rng_one_in(r, 6)) m->spheres.count -= 1;
    } else {
        return;
    }
    sag_error error = {0};
    assert_int_equal(sag_geometry_set_shape(scene, id, m->kind, shape_of(m), &error), SAG_OK);
}

static void change(rng *r, model *all, sag_scene *scene) {
    uint32_t id = rng_below(r, all->count);
    member *m = &all->members[id];
    if (m->removed) return;
    switch (rng_below(r, 13)) {
    case 0: add_member(r, all, scene); break;
    case 11: assert_int_equal(sag_scene_set_quality(scene, (sag_quality)rng_below(r, 3)), SAG_OK); break;
    case 1:
    case 2:
    case 3:
    case 4: deform(r, scene, m, id); break;
    case 5:
    case 6:
        m->placed = random_place(r, 2, &m->map) && !sag_affine_is_identity(&m->map);
        assert_int_equal(sag_geometry_set_transform(scene, id, m->placed ? &m->map : NULL), SAG_OK);
        break;
    case 7: m->disabled = !m->disabled; break;
    case 8: m->removed = rng_one_in(r, 3); break;
    case 9: m->mask = rng_below(r, 8), m->user_data = rng_bits(r); break;
    case 10: assert_int_equal(sag_geometry_set_update(scene, id, (sag_update)rng_below(r, 3)), SAG_OK); break;
    default: // the scene that instances show
        random_scene_add(r, all->child, (sag_shape_kind)rng_below(r, SAG_SHAPE_USER), 1);
        assert_int_equal(sag_scene_commit(all->child, NULL), SAG_OK);
    }
    describe_to(scene, id, m);
}

static void free_model(model *all) {
    for (uint32_t i = 0; i < all->count; i++) {
        test_mesh_free(&all->members[i].mesh);
        free(all->members[i].centers);
    }
    sag_scene_destroy(all->child);
}

static model *make_model(rng *r) {
    model *all = calloc(1, sizeof *all);
    all->child = random_scene(r, context, 20, 1);
    assert_non_null(all->child);
    return all;
}

static void any_changes(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= soak(12); seed++) {
        rng r = rng_make(seed);
        model *all = make_model(&r);
        sag_scene *scene = sag_scene_create(context);
        for (int i = 0; i < 8; i++) add_member(&r, all, scene);
        for (int step = 0; step < 12; step++) {
            assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
            sag_scene *other = fresh(all);
            assert_same_answers(scene, other, &r, 30, 1);
            sag_scene_stats a, b;
            sag_scene_get_stats(scene, &a), sag_scene_get_stats(other, &b);
            assert_true(a.primitive_count == b.primitive_count && a.geometry_count == b.geometry_count);
            assert_true(a.dropped_not_finite == b.dropped_not_finite);
            assert_true(a.dropped_degenerate == b.dropped_degenerate);
            sag_scene_destroy(other);
            for (uint32_t k = 1 + rng_below(&r, 3); k > 0; k--) change(&r, all, scene);
        }
        sag_scene_destroy(scene);
        free_model(all);
        free(all);
    }
}

static uint32_t add_sphere_mesh(sag_scene *scene, int levels, sag_vec3 at, sag_update update,
                                test_mesh *mesh) {
    rng r = rng_make(9);
    *mesh = test_mesh_sphere(levels);
    test_mesh_move(mesh, 1, at, 0, &r);
    uint32_t id = sag_add_mesh(scene, &mesh->mesh);
    assert_int_equal(sag_geometry_set_update(scene, id, update), SAG_OK);
    return id;
}

static const sagi_group *group_of(const sag_scene *scene, uint32_t id) {
    const sagi_snapshot *s = scene->cell->current;
    for (uint32_t i = 0; i < s->group_count; i++)
        for (uint32_t k = 0; k < s->groups[i].member_count; k++)
            if (s->members[s->groups[i].member_first + k] == id) return &s->groups[i];
    fail();
    return NULL;
}

// The nodes of a geometry's tree, their children counted from their own first.
static sagi_bvh_node *nodes_of(const sag_scene *scene, uint32_t id, uint32_t *count) {
    const sagi_group *g = group_of(scene, id);
    *count = g->tree.node_count;
    sagi_bvh_node *nodes = malloc(*count * sizeof *nodes);
    memcpy(nodes, scene->cell->current->world.tree.nodes + g->node_first, *count * sizeof *nodes);
    for (uint32_t n = 0; n < *count; n++)
        for (int i = 0; i < SAGI_BVH_WIDTH; i++)
            if (nodes[n].plane[0][i] <= nodes[n].plane[3][i])
                nodes[n].child[i] -=
                    sagi_bvh_is_leaf(nodes[n].child[i]) ? g->unit_first : sagi_bvh_child_node(g->node_first);
    return nodes;
}

// What does not change keeps its very nodes; what is refitted keeps its tree; what is to be built has a new
// one.
static void trees_are_kept(void **state) {
    (void)state;
    rng r = rng_make(21);
    test_mesh meshes[4];
    sag_scene *scene = sag_scene_create(context);
    uint32_t still = add_sphere_mesh(scene, 3, sag_vec3_make(-3, 0, 0), SAG_UPDATE_STATIC, &meshes[0]);
    uint32_t refit = add_sphere_mesh(scene, 3, sag_vec3_make(0, 0, 0), SAG_UPDATE_REFIT, &meshes[1]);
    uint32_t rebuild = add_sphere_mesh(scene, 3, sag_vec3_make(3, 0, 0), SAG_UPDATE_REBUILD, &meshes[2]);
    uint32_t other = add_sphere_mesh(scene, 3, sag_vec3_make(0, 3, 0), SAG_UPDATE_REBUILD, &meshes[3]);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    uint32_t counts[4], now[4], ids[4] = {still, refit, rebuild, other};
    sagi_bvh_node *before[4], *after[4];
    for (int i = 0; i < 4; i++) before[i] = nodes_of(scene, ids[i], &counts[i]);
    for (int i = 1; i < 3; i++) {
        test_mesh_move(&meshes[i], 1, sag_vec3_make(0, 0, 0), 0.1, &r);
        assert_int_equal(sag_geometry_set_shape(scene, ids[i], SAG_SHAPE_MESH, &meshes[i].mesh, NULL),
                         SAG_OK);
    }
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    for (int i = 0; i < 4; i++) {
        after[i] = nodes_of(scene, ids[i], &now[i]);
        bool same = now[i] == counts[i] && memcmp(before[i], after[i], now[i] * sizeof *after[i]) == 0;
        assert_int_equal(same, ids[i] == still || ids[i] == other);
    }
    assert_int_equal(now[1], counts[1]);
    for (uint32_t n = 0; n < now[1]; n++)
        assert_memory_equal(before[1][n].child, after[1][n].child, sizeof after[1][n].child);
    assert_true(group_of(scene, refit)->is_refitted);
    // To be had anew once.
    float worse = group_of(scene, refit)->tree.sah;
    assert_int_equal(sag_geometry_set_update(scene, refit, SAG_UPDATE_REBUILD), SAG_OK);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    assert_false(group_of(scene, refit)->is_refitted);
    assert_true(group_of(scene, refit)->tree.sah <= worse);
    for (int i = 0; i < 4; i++) free(before[i]), free(after[i]), test_mesh_free(&meshes[i]);
    sag_scene_destroy(scene);
}

// Units stay while everything fits, and change when it does not.
static void scene_that_grows(void **state) {
    (void)state;
    rng r = rng_make(22);
    test_mesh meshes[2];
    sag_scene *scene = sag_scene_create(context);
    add_sphere_mesh(scene, 3, sag_vec3_make(-3, 0, 0), SAG_UPDATE_STATIC, &meshes[0]);
    uint32_t id = add_sphere_mesh(scene, 3, sag_vec3_make(3, 0, 0), SAG_UPDATE_REFIT, &meshes[1]);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    for (int step = 0; step < 40; step++) {
        double scale = step < 20 ? 1.7 : 0.6;
        test_mesh_move(&meshes[1], scale, sag_vec3_make(0.1, -0.2, 0.3), 0.001, &r);
        assert_int_equal(sag_geometry_set_shape(scene, id, SAG_SHAPE_MESH, &meshes[1].mesh, NULL), SAG_OK);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        sag_scene *other = sag_scene_create(context);
        sag_add_mesh(other, &meshes[0].mesh), sag_add_mesh(other, &meshes[1].mesh);
        assert_int_equal(sag_scene_commit(other, NULL), SAG_OK);
        assert_same_answers(scene, other, &r, 30, 3);
        sag_scene_destroy(other);
    }
    test_mesh_free(&meshes[0]), test_mesh_free(&meshes[1]);
    sag_scene_destroy(scene);
}

// An instance shows the scene as it was when its own scene was committed, whatever becomes of it.
static void snapshots_of_before(void **state) {
    (void)state;
    rng r = rng_make(23);
    test_mesh mesh;
    sag_scene *child = sag_scene_create(context), *parent = sag_scene_create(context);
    uint32_t id = add_sphere_mesh(child, 3, sag_vec3_make(0, 0, 0), SAG_UPDATE_REFIT, &mesh);
    assert_int_equal(sag_scene_commit(child, NULL), SAG_OK);
    sag_scene *first = scene_of(&mesh.mesh);
    sag_add_instance(parent, child, NULL);
    assert_int_equal(sag_scene_commit(parent, NULL), SAG_OK);
    sag_ray ray = sag_ray_make(sag_vec3_make(0.1, 0.2, 5), sag_vec3_make(0, 0, -1));
    sag_hit was, is, moved;
    assert_true(sag_intersect(first, &ray, &was));
    for (int step = 0; step < 5; step++) {
        test_mesh_move(&mesh, 1.1, sag_vec3_make(0, 0, 0), 0.01, &r);
        assert_int_equal(sag_geometry_set_shape(child, id, SAG_SHAPE_MESH, &mesh.mesh, NULL), SAG_OK);
        assert_int_equal(sag_scene_commit(child, NULL), SAG_OK);
        assert_true(sag_intersect(parent, &ray, &is));
        assert_true(is.t == was.t && is.primitive == was.primitive);
        assert_true(sag_intersect(child, &ray, &moved) && moved.t != was.t);
    }
    assert_int_equal(sag_scene_commit(parent, NULL), SAG_OK);
    assert_true(sag_intersect(parent, &ray, &is) && is.t == moved.t);
    test_mesh_free(&mesh);
    sag_scene_destroy(child), sag_scene_destroy(parent), sag_scene_destroy(first);
}

// Boxes that the caller's callbacks change unseen.
static double user_at;
static sag_box3 user_bounds(void *user, uint32_t primitive) {
    (void)user;
    double x = user_at + primitive;
    return (sag_box3){{x, 0, 0}, {x + 0.5, 1, 1}};
}
static void user_crossings(void *user, const uint32_t *primitives, size_t count, const sag_ray *ray,
                           sag_user_report *report) {
    for (size_t i = 0; i < count; i++) {
        sag_hit hits[2];
        sag_box3 b = user_bounds(user, primitives[i]);
        size_t n = sag_box_crossings(&(sag_box){b.min, b.max}, ray, hits, 2);
        for (size_t k = 0; k < n; k++) sag_user_report_hit(report, primitives[i], hits[k].t, 0, 0);
    }
}
static void user_surface(void *user, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    (void)user, (void)ray, (void)hit, (void)surface;
}

static void callbacks_are_asked_every_time(void **state) {
    (void)state;
    for (int update = SAG_UPDATE_STATIC; update <= SAG_UPDATE_REFIT; update++)
        for (uint32_t count = 10; count <= 1000; count *= 10) {
            sag_scene *scene = sag_scene_create(context);
            uint32_t id =
                sag_add_user(scene, &(sag_user){count, NULL, user_bounds, user_crossings, user_surface});
            sag_geometry_set_update(scene, id, (sag_update)update);
            for (user_at = 0; user_at < 1; user_at += 0.1) {
                assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
                sag_ray ray = sag_ray_make(sag_vec3_make(user_at + 7.25, 0.5, -1), sag_vec3_make(0, 0, 1));
                sag_hit hit;
                assert_true(sag_intersect(scene, &ray, &hit));
                assert_int_equal(hit.primitive, 7);
            }
            sag_scene_destroy(scene);
        }
}

static void what_cannot_be_set(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    sag_error error = {0};
    sag_sphere ball = {.radius = 1}, flat = {.radius = -1};
    uint32_t id = sag_add_sphere(scene, &ball);
    assert_int_equal(sag_geometry_set_shape(scene, id + 1, SAG_SHAPE_SPHERE, &ball, &error),
                     SAG_ERROR_ARGUMENT);
    assert_int_equal(sag_geometry_set_shape(scene, id, SAG_SHAPE_BOX, &ball, &error), SAG_ERROR_ARGUMENT);
    assert_int_equal(sag_geometry_set_shape(scene, id, SAG_SHAPE_SPHERE, NULL, &error), SAG_ERROR_ARGUMENT);
    assert_int_equal(sag_geometry_set_shape(scene, id, SAG_SHAPE_SPHERE, &flat, &error), SAG_ERROR_GEOMETRY);
    assert_int_equal(sag_geometry_set_update(scene, id, (sag_update)3), SAG_ERROR_ARGUMENT);
    assert_int_equal(sag_geometry_set_update(scene, id + 1, SAG_UPDATE_REFIT), SAG_ERROR_ARGUMENT);
    ball.radius = 2;
    assert_int_equal(sag_geometry_set_shape(scene, id, SAG_SHAPE_SPHERE, &ball, &error), SAG_OK);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    sag_ray ray = sag_ray_make(sag_vec3_make(0, 0, -5), sag_vec3_make(0, 0, 1));
    sag_hit hit;
    assert_true(sag_intersect(scene, &ray, &hit) && hit.t == 3);
    sag_scene_destroy(scene);
}

// A commit that fails for want of memory leaves the answers of the last one, wherever it failed.
static void memory_ends_anywhere(void **state) {
    (void)state;
    for (size_t k = 0;; k++) {
        failing_allocator books = {.fail_at = NEVER};
        sag_context_options options = {.allocator = failing_allocator_make(&books), .thread_count = 1};
        sag_context *own = sag_context_create(&options);
        test_mesh meshes[3];
        rng r = rng_make(24);
        sag_scene *scene = sag_scene_create(own);
        add_sphere_mesh(scene, 2, sag_vec3_make(-3, 0, 0), SAG_UPDATE_STATIC, &meshes[0]);
        uint32_t refit = add_sphere_mesh(scene, 2, sag_vec3_make(0, 0, 0), SAG_UPDATE_REFIT, &meshes[1]);
        uint32_t rebuild = add_sphere_mesh(scene, 2, sag_vec3_make(3, 0, 0), SAG_UPDATE_REBUILD, &meshes[2]);
        sag_add_plane(scene, &(sag_plane){.point = {0, 0, -3}, .normal = {0, 0, 1}});
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        sag_scene *first = scene_of(&meshes[1].mesh);
        test_mesh_move(&meshes[1], 1, sag_vec3_make(0, 0, 0), 0.1, &r);
        sag_affine map = sag_affine_translate(sag_vec3_make(0, 0, 1));
        sag_geometry_set_shape(scene, refit, SAG_SHAPE_MESH, &meshes[1].mesh, NULL);
        sag_geometry_set_transform(scene, rebuild, &map);
        books.fail_at = atomic_load(&books.calls) + k;
        sag_status status = sag_scene_commit(scene, NULL);
        books.fail_at = NEVER;
        sag_ray ray = sag_ray_make(sag_vec3_make(0.1, 0.2, 5), sag_vec3_make(0, 0, -1));
        sag_hit a, b;
        assert_true(sag_intersect(scene, &ray, &a) && sag_intersect(first, &ray, &b));
        if (status != SAG_OK) assert_int_equal(status, SAG_ERROR_MEMORY);
        assert_int_equal(a.t == b.t, status != SAG_OK);
        for (int i = 0; i < 3; i++) test_mesh_free(&meshes[i]);
        sag_scene_destroy(first);
        sag_scene_destroy(scene);
        sag_context_destroy(own);
        failing_allocator_assert_empty(&books);
        if (status == SAG_OK) break;
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_changes),
        cmocka_unit_test(trees_are_kept),
        cmocka_unit_test(scene_that_grows),
        cmocka_unit_test(snapshots_of_before),
        cmocka_unit_test(callbacks_are_asked_every_time),
        cmocka_unit_test(what_cannot_be_set),
        cmocka_unit_test(memory_ends_anywhere),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
