// SPDX-License-Identifier: MIT
// Lights of a pbrt scene. Amounts as in pbrt-v4 with its default sensor: "rgb L" is the radiance of the three
// primaries as it is; a light given as a spectrum or black body has its colour at luminance 1, "scale" is the
// amount; "power" and "illuminance" replace the amount for a light of that shape.
#include "formats/pbrt.h"
#include "math/elementary.h"

#include "render/portal.h"
#include "render/warp.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#define PI 3.14159265358979323846

static sag_rgb scaled(sag_rgb c, double s) { return (sag_rgb){c.r * s, c.g * s, c.b * s}; }

static sag_vec3 triple(sagi_params *params, const char *name, sag_vec3 otherwise) {
    double v[3];
    return sagi_params_triple(params, name, v) ? sag_vec3_make(v[0], v[1], v[2]) : otherwise;
}

static bool can_shine(sag_rgb c) {
    return c.r >= 0 && c.g >= 0 && c.b >= 0 && isfinite(c.r) && isfinite(c.g) && isfinite(c.b);
}

// Gives the light its colour (the parameter called `name`; NULL: white), puts it into the world and its
// parameters to an end.
static sag_status finish(sagi_pbrt *p, sag_light *light, const char *name, double scale) {
    sag_input color = {.value = {1, 1, 1}};
    if (name) color = sagi_pbrt_light_color(p, name);
    light->spectrum = color.spectrum;
    light->color = scaled(color.spectrum ? (sag_rgb){1, 1, 1} : color.value, scale);
    if (p->params.status == SAG_OK && !can_shine(light->color))
        sagi_params_fail(&p->params, NULL, "its light is %g %g %g: negative or too large", light->color.r,
                         light->color.g, light->color.b);
    if (p->params.status == SAG_OK && !(sag_is_finite(light->from) && sag_is_finite(light->to)))
        sagi_params_fail(&p->params, NULL, "the transform takes it to no finite place");
    sag_affine inverse;
    if (p->params.status == SAG_OK && light->image.pixels && !sag_affine_inverse(&light->to_world, &inverse))
        sagi_params_fail(&p->params, NULL, "the transform is singular");
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
        const double start = sagi_cos(cone - delta), end = sagi_cos(cone);
        scale *= power / (2 * PI * ((1 - start) + (start - end) / 2));
    }
    sag_light light = {.kind = SAG_LIGHT_SPOT,
                       .from =
                           sag_affine_point(&p->state.ctm, triple(params, "from", sag_vec3_make(0, 0, 0))),
                       .to = sag_affine_point(&p->state.ctm, triple(params, "to", sag_vec3_make(0, 0, 1))),
                       .cone_rad = cone,
                       .cone_delta_rad = delta,
                       .to_world = p->state.ctm};
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

// ---- pictures

// The relative luminance of a linear Rec. 709 colour.
static double luminance(const float *p, uint32_t channels) {
    return channels < 3 ? (double)p[0]
                        : 0.2126 * (double)p[0] + 0.7152 * (double)p[1] + 0.0722 * (double)p[2];
}

// Exchanges red and blue.
static void exchange(sag_image *image) {
    const size_t count = (size_t)image->width * image->height;
    for (size_t i = 0; image->channels >= 3 && i < count; i++) {
        float *texel = image->pixels + i * image->channels;
        const float red = texel[0];
        texel[0] = texel[2], texel[2] = red;
    }
}

static bool is_exr(sagi_params *params) {
    const sagi_param *param = sagi_params_find(params, "filename", ~0u);
    if (!param || param->string_count != 1) return false;
    const sagi_slice name = params->strings[param->first_string];
    return name.length >= 4 && strncasecmp(name.text + name.length - 4, ".exr", 4) == 0;
}

// Reads the picture that "filename" names; without that parameter *image stays empty. All numbers are finite.
static sag_status read_picture(sagi_pbrt *p, sag_image *image) {
    sagi_params *params = &p->params;
    char name[SAGI_MAX_PATH], path[SAGI_MAX_PATH];
    sagi_params_string(params, "filename", "", name, sizeof name);
    if (params->status != SAG_OK || !name[0]) return params->status;
    const sagi_param *const at = sagi_params_find(params, "filename", ~0u);
    sagi_pbrt_path(p, name, path);
    sag_error reason;
    const sag_status status = sag_image_read(p->context, path, SAG_ENCODING_DEFAULT, image, &reason);
    if (status != SAG_OK) {
        sagi_params_fail(params, at, "%.200s: %.180s", path, reason.message);
        p->error->status = status;
        return params->status = status;
    }
    const size_t count = (size_t)image->width * image->height * image->channels;
    for (size_t i = 0; i < count; i++) {
        if (isfinite(image->pixels[i])) continue;
        sagi_params_fail(params, at,
                         "%.200s has a NaN or infinite number in pixel %zu: no picture for a light", path,
                         i / image->channels);
        sag_image_clear(p->context, image);
        break;
    }
    return params->status;
}

// Fails, giving the picture back, unless it is square.
static sag_status check_square(sagi_pbrt *p, sag_image *image) {
    if (!image->pixels || image->width == image->height) return p->params.status;
    sagi_params_fail(&p->params, sagi_params_find(&p->params, "filename", ~0u),
                     "the picture is %u×%u pixels; one of all directions is square (equal-area mapping)",
                     image->width, image->height);
    sag_image_clear(p->context, image);
    return p->params.status;
}

// A weight for the light that goes to a point of a picture, in [0, 1]² from its first pixel.
typedef double (*point_weight)(const void *user, double x, double y);

// The mean over a picture's pixels of its luminance times a weight.
static double weighed_luminance(const sag_image *image, point_weight weight, const void *user) {
    double sum = 0;
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) {
            const float *texel = image->pixels + ((size_t)y * image->width + x) * image->channels;
            sum += luminance(texel, image->channels) *
                   (weight ? weight(user, (x + 0.5) / image->width, (y + 0.5) / image->height) : 1);
        }
    return sum / image->width / image->height;
}

// ---- infinite

// cos θ of the direction that a point of an equal-area picture stands for, above the horizon.
static double upward(const void *user, double x, double y) {
    (void)user;
    const double z = sagi_equal_area_to_sphere((sag_vec2){x, y}).z;
    return z > 0 ? z : 0;
}

static sag_status read_portal(sagi_pbrt *p, sag_light *light) {
    size_t count;
    const double *v = sagi_params_numbers(&p->params, "portal", SAGI_TYPE_POINT3, 3, &count);
    if (count == 0 || p->params.status != SAG_OK) return p->params.status;
    if (count != 12)
        return sagi_params_fail(&p->params, sagi_params_find(&p->params, "portal", ~0u),
                                "a portal has 4 corners, not %zu", count / 3);
    // In the world's space, whatever the current transform.
    for (int i = 0; i < 4; i++) light->portal[i] = sag_vec3_make(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    light->has_portal = true;
    if (!sagi_portal_is_rectangle(light->portal))
        return sagi_params_fail(&p->params, sagi_params_find(&p->params, "portal", ~0u),
                                "the portal is no rectangle");
    return SAG_OK;
}

static sag_status infinite_light(sagi_pbrt *p, double scale) {
    sagi_params *params = &p->params;
    const double illuminance = sagi_params_float(params, "illuminance", -1);
    sag_light light = {.kind = SAG_LIGHT_INFINITE, .to_world = p->state.ctm};
    sag_status status = read_portal(p, &light);
    if (status == SAG_OK) status = read_picture(p, &light.image);
    if (status == SAG_OK) status = check_square(p, &light.image);
    if (status != SAG_OK) return status;
    double received = PI; // by a surface that faces up, of light that is 1
    if (light.image.pixels) {
        if (sagi_params_find(params, "L", ~0u)) {
            sag_image_clear(p->context, &light.image);
            return sagi_params_fail(params, NULL, "both \"L\" and \"filename\" are given");
        }
        // pbrt takes the channels in the order of the file for red, green and blue. In EXR they are in that
        // of their names.
        const bool backwards = is_exr(params);
        if (backwards) exchange(&light.image);
        received = 4 * PI * weighed_luminance(&light.image, upward, NULL);
        if (backwards) exchange(&light.image);
        // pbrt reckons half of that, and so makes such lights twice as bright as asked for.
        received /= 2;
    }
    if (illuminance > 0 && received > 0) scale *= illuminance / received;
    return finish(p, &light, light.image.pixels ? NULL : "L", scale);
}

// ---- goniometric, projection

// Light from the current transform's origin, the picture turned as it says.
static sag_light placed_light(const sagi_pbrt *p, sag_light_kind kind) {
    sag_light light = {.kind = kind, .to_world = p->state.ctm};
    light.from = sag_affine_point(&p->state.ctm, sag_vec3_make(0, 0, 0));
    return light;
}

static sag_status goniometric_light(sagi_pbrt *p, sagi_place place, double scale) {
    sag_light light = placed_light(p, SAG_LIGHT_GONIOMETRIC);
    const double power = sagi_params_float(&p->params, "power", -1);
    sag_status status = read_picture(p, &light.image);
    if (status == SAG_OK) status = check_square(p, &light.image);
    if (status != SAG_OK) return status;
    if (!light.image.pixels) {
        sagi_pbrt_warn(
            p, place,
            "LightSource \"goniometric\": without a \"filename\" it shines alike in all directions");
        light.kind = SAG_LIGHT_POINT;
        if (power > 0) scale *= power / (4 * PI);
        return finish(p, &light, "I", scale);
    }
    // One number in each direction, the mean of the channels.
    const size_t count = (size_t)light.image.width * light.image.height;
    const uint32_t channels = light.image.channels;
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        float *texel = light.image.pixels + i * channels;
        if (channels >= 3) texel[0] = texel[1] = texel[2] = (texel[0] + texel[1] + texel[2]) / 3;
        sum += (double)texel[0];
    }
    if (power > 0 && sum > 0) scale *= power / (4 * PI * sum / (double)count);
    // The picture's pole is the light's y axis.
    const sag_affine swap = {{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}}};
    light.to_world = sag_affine_multiply(&light.to_world, &swap);
    return finish(p, &light, "I", scale);
}

// What a projected picture is as wide and high as, at distance 1.
typedef struct screen {
    double x, y; // half its sizes
} screen;

// dω/dA at a point of the screen: cos³.
static double screen_weight(const void *user, double x, double y) {
    const screen *s = user;
    const double px = (2 * x - 1) * s->x, py = (2 * y - 1) * s->y;
    return sagi_pow(1 + px * px + py * py, -1.5);
}

static sag_status projection_light(sagi_pbrt *p, double scale) {
    sagi_params *params = &p->params;
    const double power = sagi_params_float(params, "power", -1), fov = sagi_params_float(params, "fov", 90);
    sag_light light = placed_light(p, SAG_LIGHT_PROJECTION);
    if (!(fov > 0 && fov < 180))
        return sagi_params_fail(params, sagi_params_find(params, "fov", ~0u),
                                "fov %g: it must be in (0, 180)", fov);
    const sag_status status = read_picture(p, &light.image);
    if (status != SAG_OK) return status;
    if (!light.image.pixels) return sagi_params_fail(params, NULL, "the picture's \"filename\" is missing");
    light.fov_rad = fov * (PI / 180);
    if (power > 0) {
        const double opposite = sagi_tan(light.fov_rad / 2),
                     aspect = (double)light.image.width / light.image.height;
        const screen s = {opposite * fmax(1, aspect), opposite * fmax(1, 1 / aspect)};
        const double whole = 4 * s.x * s.y * weighed_luminance(&light.image, screen_weight, &s);
        if (whole > 0) scale *= power / whole;
    }
    // The first row is the lowest, as the light's y axis goes down.
    const sag_affine flip = {{{1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}}};
    light.to_world = sag_affine_multiply(&light.to_world, &flip);
    return finish(p, &light, NULL, scale);
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
    if (strcmp(name, "infinite") == 0) return infinite_light(p, scale);
    if (strcmp(name, "goniometric") == 0) return goniometric_light(p, place, scale);
    if (strcmp(name, "projection") == 0) return projection_light(p, scale);
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
    sag_image picture = {0};
    status = read_picture(p, &picture);
    if (status != SAG_OK) return status;
    sagi_area_light light = {.on = true,
                             .two_sided = sagi_params_bool(params, "twosided", false),
                             .radiance = {.value = {1, 1, 1}},
                             .scale = scale,
                             .power = sagi_params_float(params, "power", -1),
                             .luminance = 1};
    if (picture.pixels) {
        if (sagi_params_find(params, "L", ~0u))
            sagi_params_fail(params, NULL, "both \"L\" and \"filename\" are given");
        light.luminance = weighed_luminance(&picture, NULL, NULL);
        const sag_texture texture = {
            .kind = SAG_TEXTURE_IMAGE, .image = picture, .wrap = SAG_WRAP_CLAMP, .scale = 1};
        light.picture = sag_world_add_texture(p->world, &texture);
        if (!light.picture) return sagi_pbrt_out_of_memory(p);
    } else {
        light.radiance = sagi_pbrt_light_color(p, "L");
    }
    if (!can_shine(scaled(light.radiance.value, scale)))
        return sagi_params_fail(params, NULL, "its light is negative or too large");
    p->state.area_light = light;
    return sagi_pbrt_parameters_done(p);
}
