// SPDX-License-Identifier: MIT
// What stands for pbrt's materials that the renderer has no model for, with a warning that names them: paint
// of the whole reflectance for light that comes out elsewhere than it went in, and surfaces of the right
// colour for hair.
#include "formats/pbrt_medium.h"

#include "math/elementary.h"
#include "render/fresnel.h"

#include <math.h>
#include <string.h>

// The reflectance of an endless depth of a medium that scatters alike to all sides the share `albedo` of what
// it takes (van de Hulst, "Multiple Light Scattering", 1980, vol. 2, ch. 14; to 0.002).
static double deep_reflectance(double absorption, double scattering, double g) {
    const double reduced = scattering * (1 - g);
    if (!(reduced > 0)) return 0;
    const double s = sqrt(fmax(absorption, 0) / (fmax(absorption, 0) + reduced));
    return (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
}

// The base that, under a coat which sends back the share `inner` of what comes from below, lets as much out:
// r = (1 − inner) b/(1 − inner b).
static double base_below(double r, double inner) { return r / (1 - inner + inner * r); }

static void read_subsurface(sagi_pbrt *p, sag_material *m) {
    sagi_params *params = &p->params;
    const double g = sagi_params_float(params, "g", 0);
    char name[128];
    sagi_params_string(params, "name", "", name, sizeof name);
    m->kind = SAG_MATERIAL_COATED_DIFFUSE;
    m->eta = sagi_pbrt_spectrum_input(p, "eta", SAGI_SPECTRUM_INDEX, 1.33);
    sagi_pbrt_roughness(p, m);
    const bool by_coefficients =
        sagi_params_find(params, "sigma_a", ~0u) && sagi_params_find(params, "sigma_s", ~0u);
    if (!name[0] && !by_coefficients && sagi_params_find(params, "reflectance", ~0u)) {
        m->reflectance = sagi_pbrt_spectrum_input(p, "reflectance", SAGI_SPECTRUM_REFLECTANCE, 0.5);
        sag_rgb *r = &m->reflectance.value;
        const double inner = m->eta.value.r > 0 ? sagi_fresnel_inner_mean(m->eta.value.r, 0) : 0;
        *r = (sag_rgb){base_below(r->r, inner), base_below(r->g, inner), base_below(r->b, inner)};
        return;
    }
    sag_rgb absorption = {0.0011, 0.0024, 0.014}, scattering = {2.55, 3.21, 3.77};
    if (by_coefficients && !name[0]) {
        absorption = sagi_pbrt_spectrum_input(p, "sigma_a", SAGI_SPECTRUM_INDEX, 1).value;
        scattering = sagi_pbrt_spectrum_input(p, "sigma_s", SAGI_SPECTRUM_INDEX, 1).value;
    } else if (name[0] && !sagi_pbrt_substance(name, &absorption, &scattering)) {
        sagi_params_fail(params, sagi_params_find(params, "name", ~0u), "there is no substance \"%.100s\"",
                         name);
    }
    m->reflectance.value = (sag_rgb){deep_reflectance(absorption.r, scattering.r, g),
                                     deep_reflectance(absorption.g, scattering.g, g),
                                     deep_reflectance(absorption.b, scattering.b, g)};
}

// The colour of many hairs with this absorption (Chiang et al., "A Practical and Controllable Hair and Fur
// Model for Production Path Tracing", CGF 35(2), 2016, (9); d'Eon et al. 2011 for the pigments).
static void read_hair(sagi_pbrt *p, sag_material *m) {
    sagi_params *params = &p->params;
    const bool by_absorption = sagi_params_find(params, "sigma_a", ~0u) != NULL;
    for (int i = 0; i < 2 && !by_absorption; i++) {
        const char *const name = i ? "color" : "reflectance";
        if (!sagi_params_find(params, name, ~0u)) continue;
        m->reflectance = sagi_pbrt_spectrum_input(p, name, SAGI_SPECTRUM_REFLECTANCE, 0.5);
        return;
    }
    sag_rgb a = sagi_pbrt_spectrum_input(p, "sigma_a", SAGI_SPECTRUM_INDEX, 0).value;
    if (!by_absorption) {
        const bool given =
            sagi_params_find(params, "eumelanin", ~0u) || sagi_params_find(params, "pheomelanin", ~0u);
        const double eu = sagi_pbrt_float_input(p, "eumelanin", given ? 0 : 1.3).value.r,
                     pheo = sagi_pbrt_float_input(p, "pheomelanin", 0).value.r;
        a = (sag_rgb){0.419 * eu + 0.187 * pheo, 0.697 * eu + 0.4 * pheo, 1.37 * eu + 1.05 * pheo};
    }
    const double b = sagi_pbrt_float_input(p, "beta_n", 0.3).value.r;
    const double scale = 5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245))));
    m->reflectance.value =
        (sag_rgb){sagi_exp(-scale * sqrt(fmax(a.r, 0))), sagi_exp(-scale * sqrt(fmax(a.g, 0))),
                  sagi_exp(-scale * sqrt(fmax(a.b, 0)))};
}

bool sagi_pbrt_stand_in(sagi_pbrt *p, sagi_place place, const char *kind, sag_material *m) {
    const char *nearest = "a diffuse one";
    if (strcmp(kind, "subsurface") == 0) {
        read_subsurface(p, m);
        nearest = "a coated diffuse one of its whole reflectance";
    } else if (strcmp(kind, "hair") == 0) {
        read_hair(p, m);
        nearest = "a diffuse one of its colour";
    } else if (strcmp(kind, "measured") == 0) {
        m->reflectance.value = (sag_rgb){0.5, 0.5, 0.5};
    } else {
        return false;
    }
    sagi_pbrt_warn_once(p, place, kind, "the material \"%s\" is not supported: %s takes its place", kind,
                        nearest);
    for (size_t i = 0; i < p->params.count; i++) p->params.items[i].used = true;
    return true;
}
