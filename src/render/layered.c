// SPDX-License-Identifier: MIT
// A base under a coat, by random walks (Guo, Hašan & Zhao, "Position-Free Monte Carlo Simulation for
// Arbitrary Layered BSDFs", SIGGRAPH Asia 2018; PBR 4th ed. §14.3): what there is no formula for. The coat is
// a smooth or rough dielectric boundary of index η at height τ, a medium that scatters the share `albedo` of
// what it takes, and at height 0 the base: a metal or a Lambertian one. Surfaces are endless, so a path
// through them has a height and a direction, no place.
//
// f(wo, wi) is an integral over such paths. One is begun from wo, through the coat; from wi another one, of
// the one crossing only, draws w2, by which light comes in. At each scattering event below the boundary light
// is connected to w2, and where the boundary is rough also found by the event's own direction, which the
// boundary bends into wi; the power heuristic weights the two (both densities are of the inner direction).
// With a smooth boundary, which would find wi by chance only, the first is all there is. pbrt-v4 weights the
// second one by the density of wi, outside, with which the event's own direction would go there: its weights
// do not add up to 1. Pictures that shall agree with its get the same (lit_as_pbrt).
//
// Radiance is compressed by 1/η² on entering and expanded by η² on leaving. A walk that comes out again has
// both, so neither is in the weights here; the connection to w2 uses the crossing from wi, backwards, which
// has none, so that 1/η² of the entrance is left there.
//
// A mirror under a mirror without scattering between has a formula: all orders go the same way,
// R = F + (1 − F)² A (1 + FA + …), A the mirror's reflectance dimmed on both ways.
//
// The walk gives weights near 1 when it is used to draw wi; of its density only an estimate is known. It
// serves to weight lights against the walk, where any number will do that both sides agree on
// (layered_pdf).
#include "bsdf.h"
#include "fresnel.h"
#include "math/elementary.h"
#include "math/hash.h"
#include "medium.h"
#include "warp.h"

// A walk that goes on for longer than this has no light left.
#define MAX_EVENTS 1000u

typedef struct walk {
    sagi_bsdf base; // the base alone; its wo changes
    const sagi_bsdf *whole;
    uint64_t state;
    bool rough, scatters;
    uint32_t events; // at most
} walk;

static double number(walk *l) {
    l->state += UINT64_C(0x9E3779B97F4A7C15);
    return (double)(sagi_mix(l->state) >> 11) * 0x1p-53;
}

static sag_vec2 pair(walk *l) {
    const double x = number(l);
    return (sag_vec2){x, number(l)};
}

static void begin(walk *l, const sagi_bsdf *whole, uint64_t stream) {
    l->whole = whole;
    l->base = *whole;
    l->base.kind =
        whole->kind == SAG_MATERIAL_COATED_CONDUCTOR ? SAG_MATERIAL_CONDUCTOR : SAG_MATERIAL_DIFFUSE;
    l->base.specular = l->base.kind == SAG_MATERIAL_CONDUCTOR && !(whole->facets.ax > 0);
    l->state = sagi_mix(whole->seed + sagi_mix(stream));
    l->rough = whole->coat.ax > 0;
    l->scatters = whole->thickness > 0 && !sagi_spectrum_is_black(whole->albedo);
    l->events = whole->events > 0 && whole->events < MAX_EVENTS ? whole->events : MAX_EVENTS;
}

// What passes the coat's medium over a height in direction w.
static double passing(double height, sag_vec3 w) { return height > 0 ? sagi_exp(-height / fabs(w.z)) : 1; }

static double power_heuristic(double a, double b) { return a > 0 ? a * a / (a * a + b * b) : 0; }

// ---- the boundary, from either side; directions point away from it

typedef struct crossing {
    sag_vec3 w;
    double weight; // of what goes this way, without the compression of radiance
    double pdf;    // among what goes this way; of no meaning when smooth
} crossing;

static bool go_through(const sagi_bsdf *b, sag_vec3 w, sag_vec2 u, crossing *out) {
    double ratio;
    if (!(b->coat.ax > 0)) {
        out->weight = 1 - sagi_fresnel_dielectric(w.z, b->ior);
        return out->weight > 0 && sagi_refract(w, sag_vec3_make(0, 0, 1), b->ior, &ratio, &out->w);
    }
    const sag_vec3 m = sagi_microfacet_sample(b->coat, w, u);
    if (!sagi_refract(w, m, b->ior, &ratio, &out->w) || !(out->w.z * w.z < 0)) return false;
    const double cos_w = sag_dot(w, m), cos_out = sag_dot(out->w, m);
    out->weight = (1 - sagi_fresnel_dielectric(cos_w, b->ior)) * sagi_microfacet_g(b->coat, w, out->w) /
                  sagi_microfacet_g1(b->coat, w);
    out->pdf = sagi_microfacet_pdf(b->coat, w, m) * fabs(cos_out) / sagi_square(cos_out + cos_w / ratio);
    return out->weight > 0;
}

static bool turn_back(const sagi_bsdf *b, sag_vec3 w, sag_vec2 u, crossing *out) {
    if (!(b->coat.ax > 0)) {
        out->w = sag_vec3_make(-w.x, -w.y, w.z);
        out->weight = sagi_fresnel_dielectric(w.z, b->ior);
        return out->weight > 0;
    }
    const sag_vec3 m = sagi_microfacet_sample(b->coat, w, u);
    const double cos_m = sag_dot(w, m);
    out->w = sag_madd(sag_neg(w), 2 * cos_m, m);
    if (!(out->w.z * w.z > 0)) return false;
    out->weight = sagi_fresnel_dielectric(cos_m, b->ior) * sagi_microfacet_g(b->coat, w, out->w) /
                  sagi_microfacet_g1(b->coat, w);
    return out->weight > 0;
}

// The rough boundary's transmission from w to `out`, without compression, and the density with which
// go_through would find it.
static double transmission(const sagi_bsdf *b, sag_vec3 w, sag_vec3 out, double *pdf) {
    const double ratio = w.z > 0 ? b->ior : 1 / b->ior;
    sag_vec3 m = sag_normalize(sag_madd(w, ratio, out));
    if (m.z < 0) m = sag_neg(m);
    const double cos_w = sag_dot(w, m), cos_out = sag_dot(out, m);
    *pdf = 0;
    if (!(m.z > 0) || !(cos_w * w.z > 0) || !(cos_out * out.z > 0)) return 0;
    const double q = sagi_square(cos_out + cos_w / ratio);
    *pdf = sagi_microfacet_pdf(b->coat, w, m) * fabs(cos_out) / q;
    return (1 - sagi_fresnel_dielectric(cos_w, b->ior)) * sagi_microfacet_d(b->coat, m) *
           sagi_microfacet_g(b->coat, w, out) * fabs(cos_w * cos_out / (w.z * out.z * q));
}

// The rough boundary's own reflection of wo > 0 into wi > 0, f |cos θi|; and its density but for Fresnel's
// share.
static double outer_reflection(const sagi_bsdf *b, sag_vec3 wo, sag_vec3 wi, double *pdf) {
    const sag_vec3 m = sag_normalize(sag_add(wo, wi));
    const double cos_m = sag_dot(wo, m);
    *pdf = sagi_microfacet_pdf(b->coat, wo, m) / (4 * cos_m);
    return sagi_fresnel_dielectric(cos_m, b->ior) * sagi_microfacet_d(b->coat, m) *
           sagi_microfacet_g(b->coat, wo, wi) / (4 * wo.z);
}

// ---- the base

static sagi_spectrum base_eval(walk *l, sag_vec3 wo, sag_vec3 wi, double *pdf) {
    l->base.wo = wo;
    return l->base.kind == SAG_MATERIAL_CONDUCTOR ? sagi_conductor_eval(&l->base, wi, pdf)
                                                  : sagi_diffuse_eval(&l->base, wi, pdf);
}

static bool base_sample(walk *l, sag_vec3 wo, sagi_bsdf_sample *sample) {
    *sample = (sagi_bsdf_sample){.eta = 1};
    l->base.wo = wo;
    if (l->base.kind == SAG_MATERIAL_CONDUCTOR) return sagi_conductor_sample(&l->base, pair(l), sample);
    sample->wi = sagi_warp_cosine(pair(l));
    sample->pdf = sample->wi.z * SAGI_INV_PI;
    sample->weight = l->base.color;
    return sample->wi.z > 0;
}

// ---- what both uses share

// Brings the walk at height *z, direction w, to where it is scattered next: true at a particle, false at a
// boundary.
static bool fly(walk *l, sag_vec3 w, double *z, sagi_spectrum *weight) {
    const double thickness = l->whole->thickness;
    if (l->scatters) {
        const double step = -sagi_log(1 - number(l)) * w.z, next = *z + step;
        if (next > 0 && next < thickness) {
            *z = next;
            *weight *= l->whole->albedo;
            return true;
        }
    } else {
        *weight *= (float)passing(thickness, w);
    }
    *z = w.z > 0 ? thickness : 0;
    return false;
}

// pbrt's rule: from the fifth event on, what has little weight.
static bool survives(walk *l, uint32_t event, sagi_spectrum *weight) {
    const double most = (double)sagi_spectrum_max(*weight);
    if (!(most > 0)) return false;
    if (event <= 3 || most >= 0.25) return true;
    if (!(number(l) < most)) return false;
    *weight *= (float)(1 / most);
    return true;
}

static sag_vec3 inner(sag_vec3 w, double ior) {
    const double s = 1 / ior, rest = 1 - (1 - w.z * w.z) * s * s;
    return sag_vec3_make(w.x * s, w.y * s, sqrt(fmax(rest, 0)));
}

// An estimate of the walk's density: the boundary's reflection; the base seen through it, with the roughness
// of both; and a little of everything.
static double layered_pdf(const sagi_bsdf *b, sag_vec3 wo, sag_vec3 wi) {
    const double reflected = sagi_fresnel_dielectric(wo.z, b->ior), cosine = wi.z * SAGI_INV_PI;
    double top = 0, below = cosine;
    if (b->coat.ax > 0) outer_reflection(b, wo, wi, &top);
    const sagi_microfacet both = {sqrt(b->coat.ax * b->coat.ax + b->facets.ax * b->facets.ax),
                                  sqrt(b->coat.ay * b->coat.ay + b->facets.ay * b->facets.ay)};
    if (b->kind == SAG_MATERIAL_COATED_CONDUCTOR && both.ax > 0) {
        const sag_vec3 o = inner(wo, b->ior), i = inner(wi, b->ior), m = sag_normalize(sag_add(o, i));
        const double facets = sagi_microfacet_pdf(both, o, m) / (4 * sag_dot(o, m));
        below = 0.1 * cosine + 0.9 * facets * wi.z / (i.z * b->ior * b->ior);
    }
    return reflected * top + (1 - reflected) * below;
}

// ---- eval

// The walk's connection to wi at an event that sends w2's light on with `value` (f |cos θ2| at the base, the
// phase function at a particle) and density `pdf`. The crossing's weight is its f |cos θ2|/pdf; the cosine
// stands in the event's value already, or does not belong there.
static sagi_spectrum connected(const walk *l, double z, sagi_spectrum value, double pdf, const crossing *in) {
    const double share = l->rough ? power_heuristic(in->pdf, pdf) : 1;
    return value * (float)(share * in->weight / fabs(in->w.z) * passing(l->whole->thickness - z, in->w));
}

// The same by the direction w that the event drew with this density (0: no other could).
static double found(const walk *l, double z, sag_vec3 w, double pdf, bool certain, sag_vec3 wi) {
    if (!l->rough || !(w.z > 0)) return 0;
    double other;
    const double value = transmission(l->whole, wi, sag_neg(w), &other);
    if (!(value > 0)) return 0;
    if (l->whole->lit_as_pbrt) transmission(l->whole, sag_neg(w), wi, &other);
    return value * passing(l->whole->thickness - z, w) * (certain ? 1 : power_heuristic(pdf, other));
}

// Between two mirrors neither way finds light that a particle sends down to the base, or up and down again:
// of the light that goes with w2 the share that comes so, for what is sent up and for what is sent down.
typedef struct echo {
    sagi_spectrum up, down;
} echo;

static echo echo_of(const walk *l, const crossing *in) {
    if (l->rough || !l->base.specular || l->whole->lit_as_pbrt) return (echo){{1, 1, 1, 1}, {0, 0, 0, 0}};
    const float way = (float)passing(l->whole->thickness, in->w);
    const sagi_spectrum once = sagi_fresnel_conductor_spectrum(in->w.z, l->base.eta, l->base.k) * way;
    const sagi_spectrum all = 1 / (1 - once * way * (float)(1 - in->weight));
    return (echo){all, once * all};
}

// The phase function of a particle at height z, from w to w2 and its echoes, as seen by `connected`.
static sagi_spectrum phase_towards(const walk *l, double z, sag_vec3 w, sag_vec3 light, const echo *e) {
    const sagi_spectrum up = (float)sagi_phase(l->whole->g, -sag_dot(w, light)) * e->up;
    if (sagi_spectrum_is_black(e->down)) return up;
    const sag_vec3 down = sag_vec3_make(light.x, light.y, -light.z);
    const double left = passing(l->whole->thickness - z, light);
    if (!(left > 0)) return up;
    return up + (float)(sagi_phase(l->whole->g, -sag_dot(w, down)) * passing(z, down) / left) * e->down;
}

// One walk; f without |cos θi|, times η².
static sagi_spectrum eval_walk(walk *l, sag_vec3 wo, sag_vec3 wi) {
    sagi_spectrum sum = {0, 0, 0, 0}, weight;
    crossing first, in, turned;
    const bool entered = go_through(l->whole, wo, pair(l), &first);
    if (!go_through(l->whole, wi, pair(l), &in) || !entered) return sum;
    weight = sagi_spectrum_all(first.weight);
    sag_vec3 w = first.w;
    const sag_vec3 light = sag_neg(in.w); // up
    const echo echoes = echo_of(l, &in);
    double z = l->whole->thickness, pdf;
    for (uint32_t event = 0; event < l->events && survives(l, event, &weight) && w.z != 0; event++) {
        if (fly(l, w, &z, &weight)) {
            const double phase = sagi_phase(l->whole->g, -sag_dot(w, light));
            sum += weight * connected(l, z, phase_towards(l, z, w, light, &echoes), phase, &in);
            sag_vec3 next;
            pdf = sagi_phase_sample(l->whole->g, sag_neg(w), pair(l), &next);
            w = next;
            sum += weight * (float)found(l, z, w, pdf, false, wi);
        } else if (w.z < 0) {
            if (!l->base.specular) {
                const sagi_spectrum value = base_eval(l, sag_neg(w), light, &pdf);
                sum += weight * connected(l, 0, value, pdf, &in);
            }
            sagi_bsdf_sample sample;
            if (!base_sample(l, sag_neg(w), &sample)) break;
            weight *= sample.weight;
            w = sample.wi;
            sum += weight * (float)found(l, 0, w, sample.pdf, sample.specular, wi);
        } else {
            if (!turn_back(l->whole, sag_neg(w), pair(l), &turned)) break;
            weight *= (float)turned.weight;
            w = turned.w;
        }
    }
    return sum;
}

static uint64_t stream_of(sag_vec3 w) { return sagi_fingerprint_of(w).part[0]; }

static sagi_spectrum eval_upward(const sagi_bsdf *b, sag_vec3 wo, sag_vec3 wi, double *pdf) {
    walk l;
    begin(&l, b, stream_of(wi));
    sagi_spectrum sum = {0, 0, 0, 0};
    for (uint32_t i = 0; i < b->walks; i++) sum += eval_walk(&l, wo, wi);
    sum *= (float)(wi.z / (b->ior * b->ior * b->walks));
    double ignored;
    if (l.rough) sum += (float)outer_reflection(b, wo, wi, &ignored);
    *pdf = layered_pdf(b, wo, wi);
    return sum;
}

static sag_vec3 upward(const sagi_bsdf *bsdf, sag_vec3 w) { return bsdf->wo.z < 0 ? sag_neg(w) : w; }

sagi_spectrum sagi_layered_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf) {
    if (!(wi.z * bsdf->wo.z > 0)) return (sagi_spectrum){0, 0, 0, 0};
    return eval_upward(bsdf, upward(bsdf, bsdf->wo), upward(bsdf, wi), pdf);
}

// ---- sample

// All that a mirror under a clear smooth coat reflects.
static sagi_spectrum mirrors(const sagi_bsdf *b, sag_vec3 wo) {
    const double f = sagi_fresnel_dielectric(wo.z, b->ior);
    const sag_vec3 w = inner(wo, b->ior);
    const sagi_spectrum once =
        sagi_fresnel_conductor_spectrum(w.z, b->eta, b->k) * (float)sagi_square(passing(b->thickness, w));
    const sagi_spectrum again = once * (float)f;
    sagi_spectrum power = {1, 1, 1, 1}, square = again;
    for (uint32_t rest = b->events / 2; rest != 0; rest >>= 1, square *= square)
        if (rest & 1) power *= square;
    if (b->events == 0) power *= 0;
    return (float)f + (float)sagi_square(1 - f) * once * (1 - power) / (1 - again);
}

// Follows light that entered in direction w until it leaves. False when it does not.
static bool walk_out(walk *l, sag_vec3 w, sagi_spectrum weight, sagi_bsdf_sample *sample) {
    double z = l->whole->thickness;
    bool specular = !l->rough;
    for (uint32_t event = 0; event < l->events && survives(l, event, &weight) && w.z != 0; event++) {
        if (fly(l, w, &z, &weight)) {
            sag_vec3 next;
            sagi_phase_sample(l->whole->g, sag_neg(w), pair(l), &next);
            w = next;
            specular = false;
        } else if (w.z < 0) {
            sagi_bsdf_sample bounce;
            if (!base_sample(l, sag_neg(w), &bounce)) return false;
            weight *= bounce.weight;
            specular &= bounce.specular;
            w = bounce.wi;
        } else {
            // Facets are drawn first, then what they do; both branches draw the same facet.
            const sag_vec2 u = pair(l);
            const double leaves = number(l);
            crossing out, back;
            const bool can_leave = go_through(l->whole, sag_neg(w), u, &out);
            const bool can_turn = turn_back(l->whole, sag_neg(w), u, &back);
            const double through = can_leave ? out.weight : 0, turned = can_turn ? back.weight : 0;
            const double total = through + turned;
            if (!(total > 0)) return false;
            weight *= (float)total;
            if (leaves * total < through) {
                sample->wi = out.w;
                sample->weight = weight;
                sample->specular = specular;
                return true;
            }
            w = back.w;
        }
    }
    return false;
}

bool sagi_layered_sample(const sagi_bsdf *bsdf, double choose, sag_vec2 u, sagi_bsdf_sample *sample) {
    const sag_vec3 wo = upward(bsdf, bsdf->wo);
    if (bsdf->specular) {
        sample->wi = upward(bsdf, sag_vec3_make(-wo.x, -wo.y, wo.z));
        sample->weight = mirrors(bsdf, wo);
        sample->specular = true;
        return true;
    }
    crossing in, back;
    const bool can_turn = turn_back(bsdf, wo, u, &back), can_enter = go_through(bsdf, wo, u, &in);
    const double turned = can_turn ? back.weight : 0, through = can_enter ? in.weight : 0;
    const double total = turned + through;
    if (choose * total < turned) {
        sample->wi = back.w;
        sample->weight = sagi_spectrum_all(total);
        sample->specular = !(bsdf->coat.ax > 0);
    } else {
        walk l;
        begin(&l, bsdf, stream_of(sag_vec3_make(choose, u.x, u.y)) + 1);
        if (!(through > 0) || !walk_out(&l, in.w, sagi_spectrum_all(total), sample)) return false;
    }
    if (!(sample->wi.z > 0)) return false;
    if (!sample->specular) {
        sample->pdf = layered_pdf(bsdf, wo, sample->wi);
        if (!(sample->pdf > 0)) return false;
    }
    sample->wi = upward(bsdf, sample->wi);
    return true;
}

// ---- what a rough coat lets through

// pbrt-v4's light by both ways, in terms of that which this crossing from wi finds: with the weights of
// eval_walk, over a Lambertian base whose light goes to the coat by the cosine, E[c.weight (of the one + of
// the other)] is the integral of both. They would add up to 1.
static double lit_weight(const sagi_bsdf *coat, sag_vec3 wi, const crossing *c) {
    const double cosine = fabs(c->w.z) * SAGI_INV_PI;
    double outward;
    transmission(coat, c->w, wi, &outward);
    return power_heuristic(c->pdf, cosine) + power_heuristic(cosine, outward);
}

// Means over facets, by their visible normals; then over the cosine-weighted hemisphere inside.
double sagi_coat_table(const sagi_bsdf *coat, float shares[SAGI_COAT_STEPS], float lit[SAGI_COAT_STEPS]) {
    enum { COUNT = 512 };
    double inner_mean = 0;
    for (int i = 0; i < SAGI_COAT_STEPS; i++) {
        const double z = (i + 0.5) / SAGI_COAT_STEPS, across = sqrt(1 - z * z);
        const sag_vec3 outside = sag_vec3_make(across, 0, z), inside = sag_vec3_make(across, 0, -z);
        double through = 0, shining = 0, back = 0;
        for (int k = 0; k < COUNT; k++) {
            // Roberts' R₂ sequence.
            const double x = 0.5 + k * 0.7548776662466927, y = 0.5 + k * 0.5698402909980532;
            const sag_vec2 u = {x - floor(x), y - floor(y)};
            crossing c;
            if (go_through(coat, outside, u, &c)) {
                const double passed = c.weight * passing(coat->thickness, c.w);
                through += passed;
                shining += passed * lit_weight(coat, outside, &c);
            }
            if (turn_back(coat, inside, u, &c)) back += c.weight * passing(coat->thickness, c.w);
        }
        through /= COUNT, shining /= COUNT, back /= COUNT;
        const double smooth = sagi_coat_transmittance(coat, outside, sagi_fresnel_dielectric(z, coat->ior));
        shares[i] = (float)(through / smooth);
        lit[i] = (float)(shining / smooth);
        inner_mean += back * passing(coat->thickness, inside) * 2 * z / SAGI_COAT_STEPS;
    }
    return inner_mean;
}
