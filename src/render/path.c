// SPDX-License-Identifier: MIT
// The path tracer (Kajiya 1986; PBR 4th ed. §13.4).
//
// A path is followed from the camera. At each surface one light is sampled (next-event estimation) and one
// direction is drawn from the surface's own scattering, which carries the path on; light that this direction
// meets by itself counts too, and multiple importance sampling weights the two. From the second bounce on a
// path of weight β goes on with probability max β (Russian roulette), divided by it: the mean stays. β is
// taken without the compression η² of radiance in glass, or paths inside glass would be cut too often.
//
// The direct integrator is the same path cut off after the first surface that is no mirror or glass.
#include "job.h"

// State of one path.
typedef struct path {
    sag_rgb radiance, weight;
    sagi_shading_point from; // the last surface that scattered
    double surface_pdf;      // with which it chose this ray
    bool exact;              // no surface, a mirror or glass chose it: light is counted in full
    bool scattered;          // it has met a surface that is no mirror or glass
    double eta2;             // product of the η² crossed
} path;

static void add(path *p, sag_rgb light) {
    p->radiance = sagi_rgb_add(p->radiance, sagi_rgb_mul(p->weight, light));
}

// Light of the surface the path came to by itself.
static void add_emission(sagi_tracer *tracer, path *p, sag_vec3 wo, const sag_hit *hit,
                         const sag_surface *surface, const sagi_appearance *appearance) {
    sag_rgb emission = sagi_emission(appearance, surface, wo);
    if (sagi_rgb_is_black(emission)) return;
    if (!p->exact) {
        const sagi_lights *lights = &tracer->render->lights;
        double pdf = sagi_lights_area_pdf(lights, p->from.position, sag_neg(wo), hit, surface);
        emission = sagi_rgb_scale(emission, sagi_surface_weight(lights, p->surface_pdf, pdf));
    }
    add(p, emission);
}

// Light of one sampled light at this surface.
static void add_light(sagi_tracer *tracer, path *p, const sag_surface *surface, const sagi_bsdf *bsdf) {
    const sagi_lights *lights = &tracer->render->lights;
    double choose = sagi_sampler_1d(&tracer->sampler);
    sag_vec2 u = sagi_sampler_2d(&tracer->sampler);
    sagi_light_sample sample;
    if (!sagi_lights_sample(lights, &p->from, choose, u, &sample)) return;
    double surface_pdf;
    sag_rgb value = sagi_bsdf_eval(bsdf, sample.wi, &surface_pdf);
    double weight = sagi_light_weight(lights, surface_pdf, &sample);
    value = sagi_rgb_scale(sagi_rgb_mul(value, sample.radiance), weight / sample.pdf);
    if (sagi_rgb_is_black(value) && sagi_rgb_is_finite(value)) return;
    if (sagi_visible(tracer, surface, &sample)) add(p, value);
}

// Draws the next direction. False when the path ends.
static bool scatter(sagi_tracer *tracer, path *p, const sag_surface *surface, const sagi_bsdf *bsdf,
                    sag_ray *ray) {
    double choose = sagi_sampler_1d(&tracer->sampler);
    sag_vec2 u = sagi_sampler_2d(&tracer->sampler);
    sagi_bsdf_sample sample;
    if (!sagi_bsdf_sample_wi(bsdf, choose, u, &sample)) return false;
    p->weight = sagi_rgb_mul(p->weight, sample.weight);
    p->surface_pdf = sample.pdf;
    p->exact = sample.specular;
    p->scattered |= !sample.specular;
    p->eta2 *= sample.eta * sample.eta;
    *ray = sag_spawn_ray(surface, sample.wi);
    ray->mask = sample.transmission                  ? SAG_RAY_REFRACTION
                : bsdf->kind == SAG_MATERIAL_DIFFUSE ? SAG_RAY_DIFFUSE
                                                     : SAG_RAY_REFLECTION;
    return true;
}

static bool survives(sagi_tracer *tracer, path *p, uint32_t depth) {
    double survival = sagi_rgb_max(p->weight) * p->eta2;
    if (!(survival < 1) || depth < 2) return true;
    if (!(sagi_sampler_1d(&tracer->sampler) < survival)) return false;
    p->weight = sagi_rgb_scale(p->weight, 1 / survival);
    return true;
}

sag_rgb sagi_path_radiance(sagi_tracer *tracer, sag_ray ray) {
    const sag_render *render = tracer->render;
    bool direct = render->settings.integrator == SAG_INTEGRATOR_DIRECT;
    path p = {.weight = {1, 1, 1}, .exact = true, .eta2 = 1};
    sag_hit hit;
    sag_surface surface;
    sagi_bsdf bsdf;
    const sagi_appearance *appearance;
    double distance;
    for (uint32_t depth = 0;; depth++) {
        if (!sagi_trace(tracer, ray, &hit, &surface, &appearance, &bsdf, &distance)) {
            add(&p, sagi_lights_far(&render->lights, p.exact ? NULL : &p.from, ray.direction, p.surface_pdf));
            break;
        }
        add_emission(tracer, &p, sag_neg(ray.direction), &hit, &surface, appearance);
        if (p.scattered && render->settings.regularize) sagi_bsdf_regularize(&bsdf);
        if (depth >= render->settings.max_depth || (direct && !p.exact)) break;
        p.from.position = surface.position;
        p.from.normal = bsdf.wo.z < 0 ? sag_neg(bsdf.n) : bsdf.n;
        p.from.reflects_only = bsdf.kind != SAG_MATERIAL_DIELECTRIC;
        if (!bsdf.specular) add_light(tracer, &p, &surface, &bsdf);
        if (!scatter(tracer, &p, &surface, &bsdf, &ray)) break;
        if (!survives(tracer, &p, depth + 1)) break;
    }
    return p.radiance;
}
