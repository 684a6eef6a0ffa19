// SPDX-License-Identifier: MIT
// The integrators that show what a ray meets instead of the light it carries.
#include "job.h"
#include "warp.h"

// As pbrt-v4: around the true normal.
static void add_ambient_occlusion(sagi_wave *wave, sagi_path *path, const sagi_meeting *meeting) {
    const sag_settings *settings = &wave->render->settings;
    const sagi_bsdf *bsdf = &meeting->bsdf;
    const sag_vec2 u = sagi_sampler_2d(&path->sampler);
    sag_vec3 local = sagi_warp_cosine(u);
    double weight = 1;
    if (settings->occlusion_uniform) {
        local = sagi_warp_sphere(u);
        local.z = fabs(local.z);
        weight = 2 * local.z; // cos θ/π by 1/2π
    }
    const sag_vec3 n = bsdf->wo_side < 0 ? sag_neg(bsdf->geometric) : bsdf->geometric;
    sag_vec3 s, t;
    sag_frame(n, &s, &t);
    sagi_light_sample sample = {.target = SAGI_TARGET_FAR};
    sample.wi = sag_madd(sag_madd(sag_scale(s, local.x), local.y, t), local.z, n);
    if (!(sag_dot(sample.wi, n) > 0)) return;
    if (settings->occlusion_distance > 0 && isfinite(settings->occlusion_distance)) {
        sample.target = SAGI_TARGET_POINT;
        sample.point = sag_madd(meeting->surface.position, settings->occlusion_distance, sample.wi);
    }
    sagi_wave_add_light(wave, path, &meeting->surface, 0, &sample, sagi_spectrum_all(weight));
}

static sag_rgb normal_color(const sagi_bsdf *bsdf) {
    sag_vec3 n = bsdf->wo.z < 0 ? sag_neg(bsdf->n) : bsdf->n;
    return sagi_rgb((n.x + 1) / 2, (n.y + 1) / 2, (n.z + 1) / 2);
}

// Hues spread by the hash.
sag_rgb sagi_id_color(const sag_hit *hit) {
    uint64_t h = sagi_mix(hit->geometry + UINT64_C(1));
    for (uint32_t i = 0; i < hit->instance_depth; i++)
        h = sagi_mix(h ^ sagi_mix(hit->instance_path[i] + UINT64_C(1)));
    double hue = (double)(h >> 40) * 0x1p-24 * 6, value = 0.5 + 0.5 * (double)(h & 0xFF) / 255;
    sag_rgb c = sagi_rgb(fabs(hue - 3) - 1, 2 - fabs(hue - 2), 2 - fabs(hue - 4));
    return sagi_rgb_scale(sagi_rgb_add(sagi_rgb_scale(sagi_rgb_clamp(c), 0.8), sagi_rgb_grey(0.2)), value);
}

void sagi_show(sagi_wave *wave, sagi_path *path, const sagi_meeting *meeting) {
    if (wave->render->settings.integrator != SAG_INTEGRATOR_AO) path->shown = sagi_rgb_grey(0);
    if (!meeting) return;
    const sag_surface *surface = &meeting->surface;
    switch (wave->render->settings.integrator) {
    case SAG_INTEGRATOR_AO: add_ambient_occlusion(wave, path, meeting); break;
    case SAG_INTEGRATOR_NORMAL: path->shown = normal_color(&meeting->bsdf); break;
    case SAG_INTEGRATOR_UV:
        path->shown = sagi_rgb(surface->u - floor(surface->u), surface->v - floor(surface->v), 0);
        break;
    case SAG_INTEGRATOR_DEPTH: path->shown = sagi_rgb_grey(path->distance); break;
    case SAG_INTEGRATOR_ID: path->shown = sagi_id_color(meeting->hit); break;
    case SAG_INTEGRATOR_ALBEDO:
        path->shown =
            sagi_material_albedo(wave->render->world, meeting->appearance, surface, &wave->render->footprint);
        break;
    case SAG_INTEGRATOR_PATH:
    case SAG_INTEGRATOR_DIRECT:
    case SAG_INTEGRATOR_LIGHTPATH:
    case SAG_INTEGRATOR_VOLPATH: break;
    }
}
