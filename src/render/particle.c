// SPDX-License-Identifier: MIT
// Light tracing (Arvo 1986; Dutré, Lafortune & Willems 1993; PBR 4th ed. §13.3.4 online): each sample is a
// particle that leaves a lamp and is scattered from surface to surface; at each it is connected with the
// camera, and what arrives there is added wherever on the film that is. Caustics that no path from the camera
// finds come out well; what is seen in mirrors and through smooth glass is missing, since no connection goes
// that way, and so is the light behind all things.
//
// Scattering goes the other way round than in path.c. A BSDF is the same both ways but for two things (Veach
// 1997, §5.2 and §5.3.2): light that is followed forward is not compressed where it enters glass: the 1/η² of
// radiance is taken back; and where shading normals differ from the surface's, with i where the light comes
// from and o where it goes to, the factor is
//
//     |i · ns| |o · ng| / (|i · ng| |o · ns|).
#include "particle.h"

// Towards the camera, if it sees the point and nothing is between. `light`: what goes there, by area.
static void splat(sagi_wave *wave, sagi_path *p, const sag_surface *from, const sagi_view *view,
                  sagi_spectrum light) {
    const sagi_light_sample sample = {.wi = view->wi, .target = SAGI_TARGET_POINT, .point = view->from};
    if (sagi_spectrum_is_black(light) && sagi_spectrum_is_finite(light)) return;
    wave->places[wave->shadow_count] = view->film;
    sagi_wave_add_light(wave, p, from, 0, &sample, light);
}

bool sagi_particle_start(sagi_wave *wave, sagi_path *p, sag_ray *ray) {
    const sag_render *render = wave->render;
    const double choose = sagi_sampler_1d(&p->sampler);
    const sag_vec2 u = sagi_sampler_2d(&p->sampler), v = sagi_sampler_2d(&p->sampler),
                   lens = sagi_sampler_2d(&p->sampler);
    sagi_leaving leaving;
    if (!sagi_lights_leave(&render->lights, p->wavelengths.lambda, choose, u, v, &leaving)) return false;
    sagi_view view;
    if (leaving.on_surface && sagi_camera_connect(&render->camera, leaving.surface.position, lens, &view)) {
        const sagi_spectrum seen =
            sagi_emission(leaving.of, &leaving.surface, view.wi, p->wavelengths.lambda);
        const double area = fabs(sag_dot(leaving.surface.geometric_normal, view.wi));
        splat(wave, p, &leaving.surface, &view, seen * (float)(area * view.importance / leaving.density));
    }
    p->radiance = leaving.power;
    p->surface_pdf = leaving.window;
    *ray = leaving.ray;
    ray->mask = SAG_RAY_DIFFUSE;
    return !sagi_spectrum_is_black(leaving.power) || !sagi_spectrum_is_finite(leaving.power);
}

// What turns the BSDF for the light's way back into that for its way there; `through`: to the other side.
static double adjoint(const sagi_bsdf *bsdf, sag_vec3 wo, sag_vec3 wi, double eta) {
    const double there = fabs(bsdf->wo.z * sag_dot(wi, bsdf->geometric)),
                 back = fabs(sag_dot(wo, bsdf->geometric) * sag_dot(wi, bsdf->n));
    return back > 0 ? there / back * (eta * eta) : 0;
}

static void connect(sagi_wave *wave, sagi_path *p, const sagi_meeting *m, sag_vec3 wo) {
    const sag_vec2 lens = sagi_sampler_2d(&p->sampler);
    const sagi_bsdf *bsdf = &m->bsdf;
    sagi_view view;
    if (bsdf->specular || !sagi_camera_connect(&wave->render->camera, m->surface.position, lens, &view))
        return;
    double pdf, eta = 1;
    const sagi_spectrum value = sagi_bsdf_eval(bsdf, view.wi, &pdf);
    if (bsdf->kind == SAG_MATERIAL_DIELECTRIC && sag_dot(view.wi, bsdf->n) * bsdf->wo.z < 0)
        eta = bsdf->wo.z > 0 ? bsdf->ior : 1 / bsdf->ior;
    splat(wave, p, &m->surface, &view,
          p->radiance * value * (float)(view.importance * adjoint(bsdf, wo, view.wi, eta)));
}

bool sagi_particle_step(sagi_wave *wave, sagi_path *p, sagi_meeting *m, sag_ray *ray) {
    if (!m || p->depth >= wave->render->settings.max_depth) return false;
    if (p->depth == 0 && p->distance < p->surface_pdf) return false; // before the light's window
    if (m->bsdf.dispersed && !p->dispersed) {
        p->weight = sagi_spectrum_first(p->weight, 4);
        p->dispersed = true;
    }
    const sag_vec3 wo = sag_neg(ray->direction);
    connect(wave, p, m, wo);
    const double choose = sagi_sampler_1d(&p->sampler);
    const sag_vec2 u = sagi_sampler_2d(&p->sampler);
    sagi_bsdf_sample sample;
    if (!sagi_bsdf_sample_wi(&m->bsdf, choose, u, &sample)) return false;
    p->weight *= sample.weight * (float)adjoint(&m->bsdf, wo, sample.wi, sample.eta);
    p->depth++;
    *ray = sag_spawn_ray(&m->surface, sample.wi);
    ray->mask = sample.transmission ? SAG_RAY_REFRACTION : SAG_RAY_DIFFUSE;
    return !sagi_spectrum_is_black(p->weight) && sagi_path_survives(p);
}
