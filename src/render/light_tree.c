// SPDX-License-Identifier: MIT
// Walking down the tree of lights.
//
// At a node each of the four children is weighed by what it could send at most, and one is chosen in
// proportion. Of a cluster within radius r around c, at distance d from the point, seen in direction −ω
// (ω points from c to the point), intensity I, normals within θo of the axis a, light within θe of the
// normals:
//
//     I cos θ' cos θi' / max(d, r/2)²,     0 where θ' ≥ θe,
//     θ'  = max(0, ∠(a, ω) − θo − θb)      the least angle between a normal and a direction to the point,
//     θi' = max(0, ∠(n, −ω) − θb)          the least angle of incidence,
//     sin θb = r/d                         the half angle that the cluster fills (all directions within it).
//
// With these bounds for the cosines alone, clusters near by and at a slant are chosen too often; so what is
// weighed lies between the bound and the cosine for the middle of the cluster (half way at the light, 15 % of
// the way at the receiver: the variance of one sample among 1024 lamps then is 0.54 to 0.87 of what it is
// with the bounds).
//
// No angle is needed, only their sines and cosines: cos max(0, x − y) = 1 where cos x > cos y, else
// cos x cos y + sin x sin y. A beam's light counts in full within its cone (cos θ' is at least FLOOR), or
// wide spots would be lost behind their planes.
//
// All this is in single precision: it decides how often a light is chosen and never how bright it is. But a
// light must not be weighed 0 where it shines; so the tree has units of its own (the lights' box is about
// one wide), far points are brought nearer, and the bounds are loosened by more than rounding when they are
// written (light_tree_build.c). The probability of a given light is worked out by the same calculations, so
// it is the same to the bit.
#include "light_tree.h"

#define FAR_AWAY  1e12 // in the tree's units; further points choose as if they were there
#define LEAST     1e-30f
#define FLOOR     0.05f
#define ONE_MINUS 0x1.fffffffffffffp-1

static inline sagi_f4 fill(float x) { return (sagi_f4){x, x, x, x}; }
static inline sagi_f4 select(sagi_w4 mask, sagi_f4 a, sagi_f4 b) {
    return (sagi_f4)((mask & (sagi_w4)a) | (~mask & (sagi_w4)b));
}
static inline sagi_f4 positive(sagi_f4 a) { return sagi_f4_max(a, fill(0)); }
static inline sagi_f4 absolute(sagi_f4 a) { return (sagi_f4)((sagi_w4)a & INT32_MAX); }
static inline sagi_f4 sine(sagi_f4 cosine) { return sagi_f4_sqrt(positive(fill(1) - cosine * cosine)); }

// The point in the tree's units, four times.
typedef struct place {
    sagi_f4 x, y, z, normal_x, normal_y, normal_z;
    bool facing, front_only;
} place;

static inline place make_place(const sagi_light_tree *tree, const sagi_light_view *view) {
    sag_vec3 p = sag_scale(sag_sub(view->position, tree->origin), tree->scale);
    if (!(fabs(p.x) < FAR_AWAY && fabs(p.y) < FAR_AWAY && fabs(p.z) < FAR_AWAY))
        p = sag_scale(sag_normalize(p), FAR_AWAY);
    const sag_vec3 n = view->normal;
    return (place){
        .x = fill((float)p.x),
        .y = fill((float)p.y),
        .z = fill((float)p.z),
        .normal_x = fill((float)n.x),
        .normal_y = fill((float)n.y),
        .normal_z = fill((float)n.z),
        .facing = n.x != 0 || n.y != 0 || n.z != 0,
        .front_only = view->front_only,
    };
}

// The weights of a node's children.
static inline sagi_f4 weigh(const sagi_light_node *node, const place *at) {
    const sagi_f4 dx = at->x - node->x, dy = at->y - node->y, dz = at->z - node->z;
    const sagi_f4 d2 = sagi_f4_max(dx * dx + dy * dy + dz * dz, fill(LEAST));
    const sagi_f4 inverse = fill(1) / sagi_f4_sqrt(d2);
    const sagi_f4 sin_b = node->radius * inverse, rest = fill(1) - sin_b * sin_b;
    const sagi_f4 cos_b = select(rest > fill(0), sagi_f4_sqrt(positive(rest)), fill(-1));
    const sagi_f4 sin_bound = (sagi_f4)((rest > fill(0)) & (sagi_w4)sin_b);

    sagi_f4 cos_w = (node->axis_x * dx + node->axis_y * dy + node->axis_z * dz) * inverse;
    cos_w = select(node->intensity < fill(0), absolute(cos_w), cos_w);
    const sagi_f4 sin_w = sine(cos_w);
    const sagi_w4 within = cos_w > node->cos_normals;
    const sagi_f4 cos_x = select(within, fill(1), cos_w * node->cos_normals + sin_w * node->sin_normals);
    const sagi_f4 sin_x =
        (sagi_f4)(~within & (sagi_w4)(sin_w * node->cos_normals - cos_w * node->sin_normals));
    const sagi_f4 cos_least = select(cos_x > cos_b, fill(1), cos_x * cos_b + sin_x * sin_bound);

    const sagi_f4 cos_out = (cos_least + cos_x) * fill(0.5F);
    sagi_f4 weight = absolute(node->intensity) * sagi_f4_max(cos_out, fill(FLOOR)) /
                     sagi_f4_max(d2, fill(0.25f) * node->radius * node->radius);
    weight = (sagi_f4)((cos_least > node->cos_spread) & (sagi_w4)weight);
    if (at->facing) {
        sagi_f4 cos_i = -(at->normal_x * dx + at->normal_y * dy + at->normal_z * dz) * inverse;
        if (!at->front_only) cos_i = absolute(cos_i);
        const sagi_f4 sin_i = sine(cos_i);
        const sagi_f4 most = select(cos_i > cos_b, fill(1), cos_i * cos_b + sin_i * sin_bound);
        const sagi_f4 cos_in = positive(cos_i) * fill(0.85F) + most * fill(0.15F);
        weight *= (sagi_f4)((most > fill(0)) & (sagi_w4)cos_in);
    }
    return positive(weight);
}

// What comes before each of the four weights, and all of them.
typedef struct sums {
    double before[4], all;
} sums;

static inline sums sum_up(sagi_f4 w) {
    const double a = (double)w[0], b = a + (double)w[1], c = b + (double)w[2];
    return (sums){{0, a, b, c}, c + (double)w[3]};
}

bool sagi_light_tree_sample(const sagi_light_tree *tree, const sagi_light_view *view, double *u,
                            uint32_t *light, double *probability) {
    if (tree->node_count == 0) return false;
    const place at = make_place(tree, view);
    double p = 1, random = *u;
    for (uint32_t index = 0;;) {
        const sagi_light_node *node = &tree->nodes[index];
        const sagi_f4 weights = weigh(node, &at);
        const sums s = sum_up(weights);
        if (!(s.all > 0)) return false;
        const double target = random * s.all;
        int chosen = (target >= s.before[1]) + (target >= s.before[2]) + (target >= s.before[3]);
        while (!(weights[chosen] > 0)) chosen--; // (only where the product is rounded up to all)
        const double weight = (double)weights[chosen];
        random = (target - s.before[chosen]) / weight;
        if (!(random < ONE_MINUS)) random = ONE_MINUS;
        p *= weight / s.all;
        index = node->child[chosen];
        if (!(index & SAGI_LIGHT_LEAF)) continue;
        *u = random;
        *light = index & ~SAGI_LIGHT_LEAF;
        *probability = p;
        return p > 0;
    }
}

double sagi_light_tree_probability(const sagi_light_tree *tree, const sagi_light_view *view, uint32_t light) {
    if (light >= tree->light_count || tree->trails[light] == UINT64_MAX) return 0;
    const place at = make_place(tree, view);
    double p = 1;
    uint64_t trail = tree->trails[light];
    for (uint32_t index = 0; !(index & SAGI_LIGHT_LEAF); trail >>= 2) {
        const sagi_light_node *node = &tree->nodes[index];
        const sagi_f4 weights = weigh(node, &at);
        const int chosen = (int)(trail & 3);
        if (!(weights[chosen] > 0)) return 0;
        p *= (double)weights[chosen] / sum_up(weights).all;
        index = node->child[chosen];
    }
    return p;
}
