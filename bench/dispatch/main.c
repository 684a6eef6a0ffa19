// SPDX-License-Identifier: MIT
// bench-dispatch [SCENE…]: closest hits and shadow rays of scenes of many kinds of shapes, on one thread,
// with each way of dispatch.h in turns (the first one in turns, too); the median of the repeats. Prints rows
// of the table in bench/results/dispatch.md. The exit code is 1 when two ways differ in a bit of an answer.
#include "dispatch.h"
#include "scene/scene.h"
#include "shapes/shape.h"
#include "support/random_shape.h"
#include <stdio.h>
#include <string.h>

enum { RAYS = 40000, REPEATS = 25, WAYS = 5 };
static const sagi_kernel *const ways[WAYS] = {&dispatch_leaf, &dispatch_again, &dispatch_run,
                                              &dispatch_primitive, &dispatch_pointer};

// Shapes in the cube [−1, 1]³. Kinds are from the list in turns; sorted: each in a slab of its own.
// Triangles, spheres and boxes stand where they do by their own numbers, the rest by a translation.
typedef struct recipe {
    const char *name;
    uint32_t count, kind_count;
    double size;
    uint32_t together; // so many at one place, in boxes of one size: no tree can part them
    bool sorted;
    uint8_t kinds[18];
} recipe;
#define ALL_KINDS                                                                                            \
    {                                                                                                        \
        SAG_SHAPE_DISK, SAG_SHAPE_RECTANGLE, SAG_SHAPE_POLYGON, SAG_SHAPE_SPHERE, SAG_SHAPE_ELLIPSOID,       \
            SAG_SHAPE_CYLINDER, SAG_SHAPE_CONE, SAG_SHAPE_PARABOLOID, SAG_SHAPE_HYPERBOLOID,                 \
            SAG_SHAPE_HYPERBOLOID2, SAG_SHAPE_QUADRIC, SAG_SHAPE_BOX, SAG_SHAPE_ORIENTED_BOX,                \
            SAG_SHAPE_POLYHEDRON, SAG_SHAPE_CAPSULE, SAG_SHAPE_TRIANGLE, SAG_SHAPE_BILINEAR_PATCH,           \
            SAG_SHAPE_TORUS                                                                                  \
    }
#define THREE_KINDS                                                                                          \
    { SAG_SHAPE_SPHERE, SAG_SHAPE_BOX, SAG_SHAPE_TRIANGLE }
#define TWO_KINDS                                                                                            \
    { SAG_SHAPE_SPHERE, SAG_SHAPE_BOX }
static const recipe recipes[] = {
    {"mixed", 20000, 18, 0.04, 1, false, ALL_KINDS},  {"sorted", 20000, 18, 0.04, 1, true, ALL_KINDS},
    {"three", 20000, 3, 0.04, 1, false, THREE_KINDS}, {"three-sorted", 20000, 3, 0.04, 1, true, THREE_KINDS},
    {"stacks", 20000, 2, 0.08, 8, false, TWO_KINDS},  {"stacks-sorted", 20000, 2, 0.08, 8, true, TWO_KINDS},
    {"few", 12, 12, 0.4, 1, false, ALL_KINDS},        {"planes", 12, 1, 1, 1, false, {SAG_SHAPE_PLANE}},
};

static uint32_t add(rng *r, sag_scene *scene, sag_shape_kind kind, double size, sag_vec3 at) {
    random_shape s;
    do random_shape_make(r, kind, size, &s);
    while (sagi_shape_classes[kind].validate(&s.as, NULL) != SAG_OK);
    sag_vec3 half = {size / 2, size / 2, size / 2};
    sag_vec3 a = rng_vec3(r, size), b = rng_vec3(r, size), c = rng_vec3(r, size);
    bool placed = false;
    if (kind == SAG_SHAPE_SPHERE)
        s.as.sphere = (sag_sphere){.center = at, .radius = size / 2};
    else if (kind == SAG_SHAPE_TRIANGLE)
        s.as.triangle = (sag_triangle){sag_add(at, a), sag_add(at, b), sag_add(at, c), false};
    else if (kind == SAG_SHAPE_BOX)
        s.as.box = (sag_box){sag_sub(at, half), sag_add(at, half)};
    else
        placed = kind != SAG_SHAPE_PLANE;
    uint32_t id = sag_add_shape(scene, kind, &s.as);
    sag_affine move = sag_affine_translate(at);
    if (placed && id != SAG_INVALID_ID) sag_geometry_set_transform(scene, id, &move);
    return id;
}

static sag_scene *make_scene(sag_context *context, const recipe *p) {
    rng r = rng_make(1);
    sag_vec3 at = {0, 0, 0};
    sag_scene *scene = sag_scene_create(context);
    for (uint32_t i = 0; scene != NULL && i < p->count; i++) {
        uint32_t k = (p->sorted ? i / p->together : i) % p->kind_count;
        if (i % p->together == 0) {
            at = rng_vec3(&r, 1);
            if (p->sorted) at.x = 2 * (k + (at.x + 1) / 2) / p->kind_count - 1;
        }
        add(&r, scene, (sag_shape_kind)p->kinds[k], p->size, at);
    }
    if (scene != NULL && sag_scene_commit(scene, NULL) == SAG_OK) return scene;
    sag_scene_destroy(scene);
    return NULL;
}

// References to a list, and to a run of one kind in it, on average.
static void count_runs(const sagi_world *world, double *list, double *run) {
    const sagi_bvh *tree = &world->tree;
    double references = world->unbounded_count, runs = references > 0, lists = runs;
    for (uint32_t n = 0; n < tree->node_count; n++)
        for (int k = 0; k < SAGI_BVH_WIDTH; k++) {
            const sagi_bvh_node *node = &tree->nodes[n];
            if (!(node->plane[0][k] <= node->plane[3][k]) || !sagi_bvh_is_leaf(node->child[k])) continue;
            const sagi_block *block = sagi_leaf(tree, node->child[k]);
            lists++;
            for (uint32_t i = 0; i < block->count; i++, references++) {
                uint32_t now = sagi_block_reference(block, i).geometry;
                uint32_t before = sagi_block_reference(block, i > 0 ? i - 1 : 0).geometry;
                runs += i == 0 || world->items[now].kind != world->items[before].kind;
            }
        }
    *list = references / lists, *run = references / runs;
}

static void make_rays(bool camera, sag_ray *rays) {
    rng r = rng_make(2);
    sag_vec3 eye = {4, 3, 2};
    for (uint32_t i = 0; i < RAYS; i++) {
        sag_vec3 from = camera ? eye : sag_scale(rng_direction(&r), 2), to = sag_scale(rng_direction(&r), 2);
        if (camera) to = sag_vec3_make(0, (i % 200) / 100.0 - 1, (i / 200) / 100.0 - 1); // NOLINT
        rays[i] = sag_ray_make(from, sag_sub(to, from));
    }
}

static double trace(const sagi_kernel *way, const sagi_world *world, bool any, const sag_ray *rays,
                    sag_hit *hits) {
    memset(hits, 0, RAYS * sizeof *hits);
    double start = sagi_seconds();
    for (uint32_t i = 0; i < RAYS; i++)
        if (any)
            hits[i].t = way->occluded(world, &rays[i]);
        else
            way->intersect(world, &rays[i], &hits[i]);
    return sagi_seconds() - start;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// One row; false when answers differ.
static bool measure(const char *name, const sagi_world *world, bool camera, bool any, sag_ray *rays,
                    sag_hit *hits[2]) {
    double seconds[WAYS][REPEATS], list, run;
    make_rays(camera, rays);
    count_runs(world, &list, &run);
    for (int w = 0; w < WAYS; w++) { // not timed
        trace(ways[w], world, any, rays, hits[w > 0]);
        if (w > 0 && memcmp(hits[0], hits[1], RAYS * sizeof **hits) != 0) return false;
    }
    for (int i = 0; i < REPEATS; i++)
        for (int k = 0; k < WAYS; k++) {
            int w = (i + k) % WAYS;
            seconds[w][i] = trace(ways[w], world, any, rays, hits[1]);
        }
    for (int w = 0; w < WAYS; w++) qsort(seconds[w], REPEATS, sizeof(double), by_size);
    printf("| %s | %s | %.2f | %.2f | %.0f |", name,
           any      ? "shadow"
           : camera ? "camera"
                    : "chord",
           list, run, seconds[0][REPEATS / 2] / RAYS * 1e9);
    for (int w = 1; w < WAYS; w++) printf(" %.3f |", seconds[w][REPEATS / 2] / seconds[0][REPEATS / 2]);
    printf("\n");
    return true;
}

static bool measure_scene(sag_context *context, const recipe *p, sag_ray *rays, sag_hit *hits[2]) {
    sag_scene *scene = make_scene(context, p);
    if (scene == NULL) return false;
    sagi_world world = sagi_scene_snapshot(scene)->world;
    sagi_item *items = malloc(world.item_count * sizeof *items);
    bool same = items != NULL;
    for (uint32_t i = 0; same && i < world.item_count; i++) {
        items[i] = world.items[i];
        items[i].child = (const void *)&sagi_shape_classes[items[i].kind];
    }
    world.items = items;
    for (int set = 0; same && set < 3; set++) same = measure(p->name, &world, set == 0, set == 2, rays, hits);
    free(items);
    sag_scene_destroy(scene);
    return same;
}

int main(int argc, char **argv) {
    sag_context *context = sag_context_create(NULL);
    sag_ray *rays = malloc(RAYS * sizeof *rays);
    sag_hit *hits[2] = {malloc(RAYS * sizeof(sag_hit)), malloc(RAYS * sizeof(sag_hit))};
    bool good = context != NULL && rays != NULL && hits[0] != NULL && hits[1] != NULL;
    printf("| scene | rays | list | run | ns | again | per run | per primitive | pointer |\n");
    for (size_t i = 0; good && i < sizeof recipes / sizeof *recipes; i++) {
        bool wanted = argc == 1;
        for (int k = 1; k < argc; k++) wanted |= strcmp(argv[k], recipes[i].name) == 0;
        if (wanted) good = measure_scene(context, &recipes[i], rays, hits);
    }
    if (!good) fprintf(stderr, "bench-dispatch: answers differ, or memory is short\n");
    free(hits[0]), free(hits[1]), free(rays);
    sag_context_destroy(context);
    return good ? 0 : 1;
}
