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
//
// A step is what happens at one surface; who traces the rays between, and when, is wave.c's matter. What a
// path does there is a chain: to find a direction to a lamp takes some five hundred instructions, nearly each
// of which waits for the one before. So several paths that have nothing to do with each other go through it
// together, stage by stage: while one waits, the processor is at the next.
#include "job.h"
#include "medium.h"
#include "shapes/spawn.h"

static void add(sagi_path *p, sagi_spectrum light) { p->radiance += p->weight * light; }

// Light of the surface the path came to by itself.
static void add_emission(const sagi_lights *lights, sagi_path *p, sag_vec3 wo, const sagi_meeting *m) {
    if (!m->appearance || !(m->appearance->brightness > 0)) return;
    sagi_spectrum emission = sagi_emission(m->appearance, &m->surface, wo, p->wavelengths.lambda);
    if (sagi_spectrum_is_black(emission)) return;
    if (!p->exact) {
        double pdf = sagi_lights_area_pdf(lights, &p->from, sag_neg(wo), m->hit, &m->surface);
        emission *= (float)sagi_surface_weight(lights, p->surface_pdf, pdf);
    }
    add(p, emission);
}

// Chooses a lamp for the surface, if that has any use for one.
static void choose_light(const sagi_lights *lights, sagi_visit *v) {
    sagi_path *p = v->path;
    v->lit = !v->meeting.bsdf.specular;
    if (!v->lit) return;
    double choose = sagi_sampler_1d(&p->sampler);
    v->u = sagi_sampler_2d(&p->sampler);
    v->lit = sagi_lights_choose(lights, &p->from, &choose, &v->lamp, &v->light.pdf);
}

// The light of the sampled direction, as the surface scatters it.
static void add_light(sagi_wave *wave, const sagi_visit *v) {
    sagi_path *p = v->path;
    const sagi_meeting *m = &v->meeting;
    const sagi_light_sample *sample = &v->light;
    double surface_pdf;
    sagi_spectrum value = sagi_bsdf_eval(&m->bsdf, sample->wi, &surface_pdf);
    double weight = sagi_light_weight(&wave->render->lights, surface_pdf, sample);
    value *= sample->radiance * (float)(weight / sample->pdf);
    if (sagi_spectrum_is_black(value) && sagi_spectrum_is_finite(value)) return;
    const uint32_t medium =
        wave->render->has_media ? sagi_medium_beyond(m->appearance, &m->surface, sample->wi, p->medium) : 0;
    sagi_wave_add_light(wave, p, &m->surface, medium, sample, value);
}

// Draws the next direction. False when the path ends.
static bool scatter(const sag_render *render, sagi_visit *v) {
    sagi_path *p = v->path;
    const sagi_meeting *m = &v->meeting;
    double choose = sagi_sampler_1d(&p->sampler);
    sag_vec2 u = sagi_sampler_2d(&p->sampler);
    sagi_bsdf_sample sample;
    if (!sagi_bsdf_sample_wi(&m->bsdf, choose, u, &sample)) return false;
    p->weight *= sample.weight;
    p->surface_pdf = sample.pdf;
    p->exact = sample.specular;
    p->scattered |= !sample.specular;
    p->eta2 *= sample.eta * sample.eta;
    p->depth++;
    p->distance = 0;
    p->passed = 0;
    if (render->has_media) p->medium = sagi_medium_beyond(m->appearance, &m->surface, sample.wi, p->medium);
    sagi_spawn(&m->surface, sample.wi, v->ray);
    const bool diffuse = m->bsdf.kind == SAG_MATERIAL_DIFFUSE ||
                         (m->bsdf.kind == SAG_MATERIAL_DIFFUSE_TRANSMISSION && !sample.transmission);
    v->ray->mask = sample.transmission ? SAG_RAY_REFRACTION : diffuse ? SAG_RAY_DIFFUSE : SAG_RAY_REFLECTION;
    return true;
}

bool sagi_path_survives(sagi_path *p) {
    double survival = (double)sagi_spectrum_max(p->weight) * p->eta2;
    if (p->dispersed) survival /= 4; // one wavelength stands for four
    if (!(survival < 1) || p->depth < 2) return true;
    if (!(sagi_sampler_1d(&p->sampler) < survival)) return false;
    p->weight *= (float)(1 / survival);
    return true;
}

bool sagi_path_arrive(sagi_wave *wave, sagi_path *p, sagi_meeting *m, const sag_ray *ray) {
    const sag_render *render = wave->render;
    bool direct = render->settings.integrator == SAG_INTEGRATOR_DIRECT;
    if (!m) {
        add(p, sagi_lights_far(&render->lights, p->exact ? NULL : &p->from, ray->origin, ray->direction,
                               p->wavelengths.lambda, p->surface_pdf));
        return false;
    }
    add_emission(&render->lights, p, sag_neg(ray->direction), m);
    if (m->bsdf.dispersed && !p->dispersed) {
        // From here on each wavelength would go its own way: the first one goes on and stands for all.
        p->weight = sagi_spectrum_first(p->weight, 4);
        p->dispersed = true;
    }
    if (p->scattered && render->settings.regularize) sagi_bsdf_regularize(&m->bsdf);
    if (p->depth >= render->settings.max_depth || (direct && !p->exact)) return false;
    p->from.position = m->surface.position;
    p->from.normal = m->bsdf.wo.z < 0 ? sag_neg(m->bsdf.n) : m->bsdf.n;
    p->from.reflects_only =
        m->bsdf.kind != SAG_MATERIAL_DIELECTRIC && m->bsdf.kind != SAG_MATERIAL_DIFFUSE_TRANSMISSION;
    return true;
}

void sagi_path_scatter(sagi_wave *wave, sagi_visit *const visits[], uint32_t count) {
    const sagi_lights *lights = &wave->render->lights;
    for (uint32_t i = 0; i < count; i++) choose_light(lights, visits[i]);
    for (uint32_t i = 0; i < count; i++) {
        sagi_visit *v = visits[i];
        if (v->lit)
            v->lit = sagi_lights_sample_one(lights, v->lamp, &v->path->from, v->path->wavelengths.lambda,
                                            v->u, &v->light);
    }
    for (uint32_t i = 0; i < count; i++)
        if (visits[i]->lit) add_light(wave, visits[i]);
    for (uint32_t i = 0; i < count; i++)
        visits[i]->goes_on = scatter(wave->render, visits[i]) && sagi_path_survives(visits[i]->path);
}
