// SPDX-License-Identifier: MIT
// Lights of a pbrt scene. Amounts as in pbrt-v4 with its default sensor: "rgb L" is the radiance of the three
// primaries as it is; a light given as a spectrum or black body has its colour at luminance 1, "scale" is the
// amount; "power" and "illuminance" replace the amount for a light of that shape.
#include "formats/pbrt.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

static sag_rgb scaled(sag_rgb c, double s) { return (sag_rgb){c.r * s, c.g * s, c.b * s}; }

static sag_vec3 triple(sagi_params *params, const char *name, sag_vec3 otherwise) {
    double v[3];
    return sagi_params_triple(params, name, v) ? sag_vec3_make(v[0], v[1], v[2]) : otherwise;
}

static bool can_shine(sag_rgb c) {
    return c.r >= 0 && c.g >= 0 && c.b >= 0 && isfinite(c.r) && isfinite(c.g) && isfinite(c.b);
}

// Gives the light its colour (the parameter called `name`), puts it into the world and its parameters to an
// end.
static sag_status finish(sagi_pbrt *p, sag_light *light, const char *name, double scale) {
    const sag_input color = sagi_pbrt_light_color(p, name);
    light->spectrum = color.spectrum;
    light->color = scaled(color.spectrum ? (sag_rgb){1, 1, 1} : color.value, scale);
    if (p->params.status == SAG_OK && !can_shine(light->color))
        sagi_params_fail(&p->params, NULL, "its light is %g %g %g: negative or too large", light->color.r,
                         light->color.g, light->color.b);
    const sag_status status = sagi_pbrt_parameters_done(p);
    if (status != SAG_OK) {
        sag_image_clear(p->context, &light->image);
        return status;
    }
    return sag_world_add_light(p->world, light) ? SAG_OK : sagi_pbrt_out_of_memory(p);
}

static sag_status point_light(sagi_pbrt *p, double scale) {
    sagi_params *params = &p->params;
    const double power = sagi_params_float(params, "power", -1);
    if (power > 0) scale *= power / (4 * PI);
    sag_light light = {.kind = SAG_LIGHT_POINT,
                       .from =
                           sag_affine_point(&p->state.ctm, triple(params, "from", sag_vec3_make(0, 0, 0)))};
    return finish(p, &light, "I", scale);
}

static sag_status spot_light(sagi_pbrt *p, double scale) {
    sagi_params *params = &p->params;
    const double degrees = sagi_params_float(params, "coneangle", 30), cone = degrees * (PI / 180);
    double delta = sagi_params_float(params, "conedeltaangle", 5) * (PI / 180);
    if (!(degrees > 0 && degrees <= 180) || !(delta >= 0))
        return sagi_params_fail(params, sagi_params_find(params, "coneangle", ~0u),
                                "coneangle %g: it must be in (0, 180], conedeltaangle not negative", degrees);
    // pbrt takes the cosine of cone - delta, which forgets a sign.
    if (delta > cone) delta = fmax(0, cone - fabs(cone - delta));
    const double power = sagi_params_float(params, "power", -1);
    if (power > 0) {
        const double start = cos(cone - delta), end = cos(cone);
        scale *= power / (2 * PI * ((1 - start) + (start - end) / 2));
    }
    sag_light light = {.kind = SAG_LIGHT_SPOT,
                       .from =
                           sag_affine_point(&p->state.ctm, triple(params, "from", sag_vec3_make(0, 0, 0))),
                       .to = sag_affine_point(&p->state.ctm, triple(params, "to", sag_vec3_make(0, 0, 1))),
                       .cone_rad = cone,
                       .cone_delta_rad = delta};
    if (!(sag_length(sag_sub(light.to, light.from)) > 0))
        return sagi_params_fail(params, NULL, "from and to are the same point");
    return finish(p, &light, "I", scale);
}

static sag_status distant_light(sagi_pbrt *p, double scale) {
    sagi_params *params = &p->params;
    const double illuminance = sagi_params_float(params, "illuminance", -1);
    if (illuminance > 0) scale *= illuminance;
    const sag_vec3 from = triple(params, "from", sag_vec3_make(0, 0, 0)),
                   to = triple(params, "to", sag_vec3_make(0, 0, 1));
    const sag_vec3 direction = sag_affine_vector(&p->state.ctm, sag_sub(from, to));
    if (!(sag_length(direction) > 0)) return sagi_params_fail(params, NULL, "from and to are the same point");
    sag_light light = {.kind = SAG_LIGHT_DISTANT, .from = direction};
    return finish(p, &light, "L", scale);
}

static sag_status infinite_light(sagi_pbrt *p, sagi_place place, double scale) {
    sagi_params *params = &p->params;
    char name[SAGI_MAX_PATH], path[SAGI_MAX_PATH];
    sagi_params_string(params, "filename", "", name, sizeof name);
    const double illuminance = sagi_params_float(params, "illuminance", -1);
    sagi_pbrt_ignore(p, "portal", "is not supported: the light comes from everywhere");
    sag_light light = {.kind = SAG_LIGHT_INFINITE, .to_world = p->state.ctm};
    if (!name[0]) {
        if (illuminance > 0) scale *= illuminance / PI;
        return finish(p, &light, "L", scale);
    }
    if (illuminance > 0)
        sagi_pbrt_warn_once(p, place, "illuminance",
                            "LightSource \"infinite\": illuminance of a picture is not supported");
    sag_status status = params->status;
    if (status != SAG_OK) return status;
    sagi_pbrt_path(p, name, path);
    sag_error reason;
    status = sag_image_read(p->context, path, SAG_ENCODING_DEFAULT, &light.image, &reason);
    if (status != SAG_OK) {
        sagi_params_fail(params, sagi_params_find(params, "filename", ~0u), "%.200s: %.180s", path,
                         reason.message);
        p->error->status = status;
        return params->status = status;
    }
    if (light.image.width != light.image.height) {
        const sag_status wrong =
            sagi_params_fail(params, sagi_params_find(params, "filename", ~0u),
                             "%.200s is %u×%u pixels; a light's picture is square (equal-area mapping)", path,
                             light.image.width, light.image.height);
        sag_image_clear(p->context, &light.image);
        return wrong;
    }
    return finish(p, &light, "L", scale);
}

sag_status sagi_pbrt_light_source(sagi_pbrt *p, sagi_place place) {
    char name[64];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    if (p->solid.scene)
        return sagi_place_error(place, p->error,
                                "LightSource within a solid, of which it can be no part: put it outside");
    status = sagi_pbrt_parameters(p, place, SAGI_TARGET_LIGHT, "LightSource \"%.60s\"", name);
    if (status != SAG_OK || p->options->geometry_only) return status;
    const double scale = sagi_params_float(&p->params, "scale", 1);
    if (strcmp(name, "point") == 0) return point_light(p, scale);
    if (strcmp(name, "spot") == 0) return spot_light(p, scale);
    if (strcmp(name, "distant") == 0) return distant_light(p, scale);
    if (strcmp(name, "infinite") == 0) return infinite_light(p, place, scale);
    if (strcmp(name, "goniometric") == 0 || strcmp(name, "projection") == 0) {
        sagi_pbrt_warn_once(p, place, name, "LightSource \"%s\" is not supported: left out", name);
        return SAG_OK;
    }
    return sagi_place_error(place, p->error, "unknown light \"%.60s\"", name);
}

sag_status sagi_pbrt_area_light_source(sagi_pbrt *p, sagi_place place) {
    char name[64];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    status = sagi_pbrt_parameters(p, place, SAGI_TARGET_LIGHT, "AreaLightSource \"%.60s\"", name);
    if (status != SAG_OK || p->options->geometry_only) return status;
    if (strcmp(name, "diffuse") != 0)
        return sagi_place_error(place, p->error, "unknown area light \"%.60s\"", name);
    sagi_params *params = &p->params;
    const double scale = sagi_params_float(params, "scale", 1);
    p->state.area_light = (sagi_area_light){.on = true,
                                            .two_sided = sagi_params_bool(params, "twosided", false),
                                            .radiance = sagi_pbrt_light_color(p, "L"),
                                            .scale = scale,
                                            .power = sagi_params_float(params, "power", -1)};
    if (!can_shine(scaled(p->state.area_light.radiance.value, scale)))
        return sagi_params_fail(params, NULL, "its light is negative or too large");
    sagi_pbrt_ignore(p, "filename", "is not supported: the light has one colour");
    return sagi_pbrt_parameters_done(p);
}
