// SPDX-License-Identifier: MIT
// Building the tree of lights: from above, splitting the lights of a node in two, and the dearer part again,
// until there are four parts.
//
// A part costs what light it may waste (Conty Estévez & Kulla 2018, eq. 2): its intensity times the size of
// its box times a measure of the directions it shines in,
//     M = 2π (1 − cos θo) + π/2 (2 θw sin θo − sagi_cos(θo − 2 θw) − 2 θo sin θo + cos θo),  θw = min(θo +
//     θe, π).
// The size is the square of the diagonal, not the area: lamps in a row have none. Splits are tried between
// twelve bins along each axis. There the spread of the axes is not bounded but reckoned from the length of
// their mean R, which sums can tell: a cone of half angle θo filled evenly has R = (1 + cos θo)/2.
//
// Below DEEP levels parts are halved by number, so that no tree is deeper than a trail is long.
#include "light_tree.h"

#include "math/elementary.h"

#include <string.h>

#define PI    3.14159265358979323846
#define BINS  12
#define DEEP  12    // levels; then at most 16 more until 2³¹ lights are told apart
#define SLACK 1e-6f // by which a cosine may be off in single precision

typedef struct bin {
    sag_box3 box;
    sag_vec3 axes; // sum, weighted by intensity
    double intensity, cos_normals, cos_spread;
    uint32_t count;
} bin;

// Lights order[first … first + count) of a node.
typedef struct part {
    uint32_t first, count;
    double cost;
} part;

typedef struct builder {
    sagi_light_tree *tree;
    const sag_context *context;
    const sagi_light_bounds *lights;
    uint32_t *order;
    double intensity; // of all
    bool failed;
} builder;

static sag_vec3 middle(const sag_box3 *box) {
    return sag_add(sag_scale(box->min, 0.5), sag_scale(box->max, 0.5));
}

static double diagonal2(const sag_box3 *box) {
    const sag_vec3 d = sag_sub(box->max, box->min);
    return sag_dot(d, d);
}

// The cone of directions that holds two cones.
static void join_cones(sag_vec3 *axis, double *cosine, sag_vec3 b, double cos_b) {
    const double theta_a = sagi_acos(fmin(fmax(*cosine, -1), 1)),
                 theta_b = sagi_acos(fmin(fmax(cos_b, -1), 1));
    const double between = sagi_atan2(sag_length(sag_cross(*axis, b)), sag_dot(*axis, b));
    if (fmin(between + theta_b, PI) <= theta_a) return;
    if (fmin(between + theta_a, PI) <= theta_b) {
        *axis = b, *cosine = cos_b;
        return;
    }
    const double theta = (theta_a + between + theta_b) / 2;
    const sag_vec3 across = sag_madd(b, -sag_dot(*axis, b), *axis);
    if (!(theta < PI) || !(sag_dot(across, across) > 0)) {
        *cosine = -1;
        return;
    }
    const double turn = theta - theta_a;
    *axis = sag_normalize(sag_madd(sag_scale(*axis, sagi_cos(turn)), sagi_sin(turn), sag_normalize(across)));
    *cosine = sagi_cos(theta);
}

sagi_light_bounds sagi_light_bounds_union(const sagi_light_bounds *a, const sagi_light_bounds *b) {
    if (!(a->intensity > 0)) return *b;
    if (!(b->intensity > 0)) return *a;
    sagi_light_bounds both = *a;
    sag_vec3 axis = b->axis; // of lights that shine to both sides, either way round
    if (a->two_sided && b->two_sided && sag_dot(a->axis, axis) < 0) axis = sag_neg(axis);
    join_cones(&both.axis, &both.cos_normals, axis, b->cos_normals);
    both.box = sag_box3_union(a->box, b->box);
    both.cos_spread = fmin(a->cos_spread, b->cos_spread);
    both.intensity += b->intensity;
    both.two_sided |= b->two_sided;
    return both;
}

static double direction_measure(double cos_normals, double cos_spread) {
    const double o = sagi_acos(fmin(fmax(cos_normals, -1), 1)), e = sagi_acos(fmin(fmax(cos_spread, -1), 1));
    const double w = fmin(o + e, PI);
    return 2 * PI * (1 - sagi_cos(o)) +
           PI / 2 * (2 * w * sagi_sin(o) - sagi_cos(o - 2 * w) - 2 * o * sagi_sin(o) + sagi_cos(o));
}

static void bin_add(bin *sum, const bin *b) {
    if (b->count == 0) return;
    if (sum->count == 0) {
        *sum = *b;
        return;
    }
    sum->box = sag_box3_union(sum->box, b->box);
    sum->axes = sag_add(sum->axes, b->axes);
    sum->intensity += b->intensity;
    sum->cos_normals = fmin(sum->cos_normals, b->cos_normals);
    sum->cos_spread = fmin(sum->cos_spread, b->cos_spread);
    sum->count += b->count;
}

static double bin_cost(const bin *b) {
    const double mean = sag_length(b->axes) / b->intensity;
    const double cos_normals = fmin(2 * mean - 1, b->cos_normals);
    return b->intensity * diagonal2(&b->box) * direction_measure(cos_normals, b->cos_spread);
}

static bin light_bin(const sagi_light_bounds *light) {
    return (bin){.box = light->box,
                 .axes = sag_scale(light->axis, light->intensity),
                 .intensity = light->intensity,
                 .cos_normals = light->cos_normals,
                 .cos_spread = light->cos_spread,
                 .count = 1};
}

typedef struct split {
    int axis; // −1: none found
    double least, per_width;
    int last; // bin of the first part
    double cost, cost_first, cost_second;
} split;

static int bin_of(const split *s, const sagi_light_bounds *light) {
    const double place = (sag_component(middle(&light->box), s->axis) - s->least) * s->per_width;
    return place < BINS ? (place > 0 ? (int)place : 0) : BINS - 1;
}

// The best split along one axis, if it is better than *best.
static void try_axis(const builder *b, const part *p, const sag_box3 *centres, double stretch, split tried,
                     split *best) {
    tried.least = sag_component(centres->min, tried.axis);
    const double width = sag_component(centres->max, tried.axis) - tried.least;
    tried.per_width = BINS / width;
    if (!(width > 0) || !isfinite(tried.per_width)) return;
    bin bins[BINS] = {{.count = 0}}, above[BINS] = {{.count = 0}}, below = {.count = 0};
    for (uint32_t i = 0; i < p->count; i++) {
        const sagi_light_bounds *light = &b->lights[b->order[p->first + i]];
        const bin one = light_bin(light);
        bin_add(&bins[bin_of(&tried, light)], &one);
    }
    for (int i = BINS - 1; i > 0; i--) {
        if (i < BINS - 1) above[i] = above[i + 1];
        bin_add(&above[i], &bins[i]);
    }
    for (int i = 0; i < BINS - 1; i++) {
        bin_add(&below, &bins[i]);
        if (below.count == 0 || above[i + 1].count == 0) continue;
        tried.last = i;
        tried.cost_first = bin_cost(&below), tried.cost_second = bin_cost(&above[i + 1]);
        tried.cost = stretch * (tried.cost_first + tried.cost_second);
        if (tried.cost < best->cost) *best = tried;
    }
}

// Splits a part in two; both have at least one light.
static void split_part(builder *b, bool halve, part *p, part *second) {
    sag_box3 centres = sag_box3_empty(), all = sag_box3_empty();
    for (uint32_t i = 0; i < p->count; i++) {
        const sag_box3 *box = &b->lights[b->order[p->first + i]].box;
        centres = sag_box3_extend(centres, middle(box));
        all = sag_box3_union(all, *box);
    }
    split best = {.axis = -1, .cost = INFINITY};
    const sag_vec3 size = sag_sub(all.max, all.min);
    for (int axis = 0; axis < 3 && !halve; axis++)
        if (sag_component(size, axis) > 0)
            try_axis(b, p, &centres, sag_max_component(size) / sag_component(size, axis),
                     (split){.axis = axis}, &best);
    uint32_t *const order = b->order + p->first;
    uint32_t kept = 0;
    if (best.axis >= 0) {
        for (uint32_t i = 0; i < p->count; i++) {
            const uint32_t light = order[i];
            if (bin_of(&best, &b->lights[light]) > best.last) continue;
            order[i] = order[kept];
            order[kept++] = light;
        }
    }
    if (kept == 0 || kept == p->count) {
        kept = p->count / 2;
        best.cost_first = best.cost_second = p->cost / 2;
    }
    *second = (part){p->first + kept, p->count - kept, best.cost_second};
    *p = (part){p->first, kept, best.cost_first};
}

// Room for one more node at the end, zeroed.
static bool grow(builder *b) {
    sagi_light_tree *tree = b->tree;
    if (tree->node_count == tree->node_capacity) {
        const uint32_t capacity = tree->node_capacity ? 2 * tree->node_capacity : 16;
        sagi_light_node *nodes = sag_allocate(b->context, capacity * sizeof *nodes);
        if (!nodes) return false;
        if (tree->node_count) memcpy(nodes, tree->nodes, tree->node_count * sizeof *nodes);
        sag_release(b->context, tree->nodes, tree->node_capacity * sizeof *nodes);
        tree->nodes = nodes;
        tree->node_capacity = capacity;
    }
    memset(&tree->nodes[tree->node_count++], 0, sizeof *tree->nodes);
    return true;
}

// Writes a child, loosened by what single precision may lose.
static void write_child(const builder *b, sagi_light_node *node, int i, const sagi_light_bounds *bounds) {
    const sagi_light_tree *tree = b->tree;
    const sag_vec3 c = sag_scale(sag_sub(middle(&bounds->box), tree->origin), tree->scale);
    node->x[i] = (float)c.x, node->y[i] = (float)c.y, node->z[i] = (float)c.z;
    const double radius = sqrt(diagonal2(&bounds->box)) / 2 * tree->scale;
    node->radius[i] = (float)radius * (1 + SLACK) + 0x1p-22f * (float)sag_max_component(sag_abs(c));
    node->axis_x[i] = (float)bounds->axis.x;
    node->axis_y[i] = (float)bounds->axis.y;
    node->axis_z[i] = (float)bounds->axis.z;
    node->cos_normals[i] = fmaxf((float)bounds->cos_normals - SLACK, -1);
    node->sin_normals[i] = sqrtf(fmaxf(0, 1 - node->cos_normals[i] * node->cos_normals[i]));
    node->cos_spread[i] = (float)bounds->cos_spread - SLACK;
    const float intensity = fmaxf((float)(bounds->intensity / b->intensity), 1e-12f);
    node->intensity[i] = bounds->two_sided ? -intensity : intensity;
}

// A node for the part, its children's before it has all of its own. Not deeper than 28 levels.
static sagi_light_bounds build(builder *b, part all, uint32_t level, uint64_t trail, uint32_t *index) {
    sagi_light_bounds sum = {.intensity = 0};
    part parts[4] = {all};
    int count = 1;
    while (count < 4) {
        int dearest = -1;
        for (int i = 0; i < count; i++) {
            if (parts[i].count < 2) continue;
            if (dearest < 0 ||
                (level < DEEP ? parts[i].cost > parts[dearest].cost : parts[i].count > parts[dearest].count))
                dearest = i;
        }
        if (dearest < 0) break;
        split_part(b, level >= DEEP, &parts[dearest], &parts[count++]);
    }
    *index = b->tree->node_count;
    if (!grow(b)) b->failed = true;
    for (int i = 0; i < count && !b->failed; i++) {
        const uint64_t here = trail | (uint64_t)i << 2 * level;
        const uint32_t light = b->order[parts[i].first];
        uint32_t child = SAGI_LIGHT_LEAF | light;
        sagi_light_bounds bounds = b->lights[light];
        if (parts[i].count > 1)
            bounds = build(b, parts[i], level + 1, here, &child);
        else
            b->tree->trails[light] = here;
        if (b->failed) break;
        sagi_light_node *node = &b->tree->nodes[*index];
        node->child[i] = child;
        write_child(b, node, i, &bounds);
        sum = sagi_light_bounds_union(&sum, &bounds);
    }
    return sum;
}

bool sagi_light_tree_init(sagi_light_tree *tree, const sag_context *context, const sagi_light_bounds *lights,
                          uint32_t count) {
    *tree = (sagi_light_tree){.scale = 1};
    if (count == 0) return true;
    if (count >= SAGI_LIGHT_LEAF) return false;
    uint32_t *order = sag_allocate(context, count * sizeof *order);
    tree->trails = sag_allocate(context, count * sizeof *tree->trails);
    tree->light_count = tree->trails ? count : 0;
    if (!order || !tree->trails) {
        sag_release(context, order, count * sizeof *order);
        return false;
    }
    builder b = {.tree = tree, .context = context, .lights = lights, .order = order};
    sag_box3 box = sag_box3_empty();
    uint32_t used = 0;
    for (uint32_t i = 0; i < count; i++) {
        tree->trails[i] = UINT64_MAX;
        if (!(lights[i].intensity > 0) || !isfinite(lights[i].intensity)) continue;
        order[used++] = i;
        b.intensity += lights[i].intensity;
        box = sag_box3_union(box, lights[i].box);
    }
    if (used > 0) {
        tree->origin = middle(&box);
        const double size = sag_max_component(sag_sub(box.max, box.min));
        if (size > 0 && isfinite(1 / size)) tree->scale = 1 / size;
        uint32_t root;
        build(&b, (part){0, used, 0}, 0, 0, &root);
    }
    sag_release(context, order, count * sizeof *order);
    return !b.failed;
}

void sagi_light_tree_clear(sagi_light_tree *tree, const sag_context *context) {
    sag_release(context, tree->nodes, tree->node_capacity * sizeof *tree->nodes);
    sag_release(context, tree->trails, tree->light_count * sizeof *tree->trails);
    *tree = (sagi_light_tree){.scale = 1};
}
