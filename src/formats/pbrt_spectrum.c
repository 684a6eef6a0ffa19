// SPDX-License-Identifier: MIT
// Parameters of a pbrt scene that may be colours, numbers, spectra or textures.
//
// What they stand for is as in pbrt-v4: "rgb" is a reflectance, an amount without bound or light in the
// colour space of the moment (ColorSpace), made a smooth spectrum; pairs of numbers are linear between and 0
// beyond; the names of spectra and of files with such pairs are known; a black body is 1 at its peak. A
// light's spectrum, other than an rgb's, is brought to luminance 1, so that the light's scale and power say
// how much there is.
#include "formats/number.h"
#include "formats/pbrt_promise.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MAX_SAMPLES 4096

sag_status sagi_pbrt_read_numbers(sagi_pbrt *p, const sagi_param *param, sagi_slice name, double *numbers,
                                  size_t most, size_t *count) {
    char text[SAGI_MAX_PATH], path[SAGI_MAX_PATH];
    snprintf(text, sizeof text, "%.*s", (int)(name.length < SAGI_MAX_PATH ? name.length : SAGI_MAX_PATH - 1),
             name.text);
    sagi_pbrt_path(p, text, path);
    sagi_source source = {.file = {0}};
    sag_error reason;
    const sag_status opened = sagi_file_open(p->context, path, &source.file, &reason);
    if (opened != SAG_OK && opened != SAG_ERROR_IO)
        return sagi_params_fail(&p->params, param, "%.200s: %.200s", text, reason.message);
    if (opened != SAG_OK)
        return sagi_params_fail(&p->params, param, "there is no %sfile called \"%.200s\"",
                                param->type == SAGI_TYPE_SPECTRUM ? "spectrum and no " : "", text);
    snprintf(source.path, sizeof source.path, "%s", path);
    const char *begin = (const char *)source.file.bytes;
    sagi_cursor cursor = {&source, begin, begin + source.file.size};
    sag_status status;
    sagi_token token;
    *count = 0;
    while ((status = sagi_cursor_next(&cursor, &token, p->error)) == SAG_OK && token.kind != SAGI_TOKEN_END) {
        const char *const end = token.text.text + token.text.length;
        if (*count == most)
            status = sagi_place_error(token.place, p->error, "more than %zu numbers", most);
        else if (token.kind != SAGI_TOKEN_WORD ||
                 sagi_parse_number(token.text.text, end, &numbers[(*count)++]) != end)
            status = sagi_place_error(token.place, p->error, "a number expected");
        if (status != SAG_OK) break;
    }
    if (status == SAG_OK && param->type == SAGI_TYPE_SPECTRUM) {
        if (*count < 2 || *count % 2)
            status = sagi_place_error(token.place, p->error, "pairs of a wavelength and a value expected");
        for (size_t i = 2; status == SAG_OK && i < *count; i += 2)
            if (!(numbers[i] > numbers[i - 2]))
                status = sagi_place_error(token.place, p->error, "the wavelengths do not rise: %g after %g",
                                          numbers[i], numbers[i - 2]);
    }
    sagi_file_close(&source.file);
    return p->params.status = status;
}

// Puts the spectrum of a parameter into the world.
static void add_spectrum(sagi_pbrt *p, const sagi_param *param, sag_spectrum *spectrum, sag_input *input) {
    const sag_status status = sag_world_add_spectrum(p->world, spectrum, &input->spectrum);
    if (status == SAG_ERROR_MEMORY)
        p->params.status = sagi_pbrt_out_of_memory(p);
    else if (status != SAG_OK)
        sagi_params_fail(&p->params, param,
                         "\"%.*s\" is no spectrum: finite numbers and rising wavelengths expected",
                         (int)param->name.length, param->name.text);
}

static void read_rgb(sagi_pbrt *p, const sagi_param *param, sagi_spectrum_use use, const double *numbers,
                     sag_input *input) {
    const sag_rgb rgb = {numbers[0], numbers[1], numbers[2]};
    if (!(isfinite(rgb.r) && isfinite(rgb.g) && isfinite(rgb.b))) {
        sagi_params_fail(&p->params, param, "\"%.*s\" is not finite", (int)param->name.length,
                         param->name.text);
    } else if (p->state.color_space == SAG_COLOR_SRGB) {
        input->value = rgb;
    } else {
        sag_spectrum spectrum = {.kind = use == SAGI_SPECTRUM_REFLECTANCE ? SAG_SPECTRUM_ALBEDO
                                         : use == SAGI_SPECTRUM_LIGHT     ? SAG_SPECTRUM_ILLUMINANT
                                                                          : SAG_SPECTRUM_UNBOUNDED,
                                 .rgb = rgb,
                                 .space = p->state.color_space};
        add_spectrum(p, param, &spectrum, input);
    }
}

// A name, of a spectrum or a file.
static void read_name(sagi_pbrt *p, const sagi_param *param, sag_spectrum *spectrum, sag_input *input) {
    const sagi_slice name = p->params.strings[param->first_string];
    char text[64];
    snprintf(text, sizeof text, "%.*s", (int)(name.length < sizeof text ? name.length : sizeof text - 1),
             name.text);
    spectrum->kind = SAG_SPECTRUM_NAMED;
    spectrum->name = text;
    const sag_status status = sag_world_add_spectrum(p->world, spectrum, &input->spectrum);
    spectrum->name = NULL;
    if (status == SAG_OK) return;
    if (status == SAG_ERROR_MEMORY) {
        p->params.status = sagi_pbrt_out_of_memory(p);
        return;
    }
    double *pairs = sag_allocate(p->context, 2 * MAX_SAMPLES * sizeof *pairs);
    if (!pairs) {
        p->params.status = sagi_pbrt_out_of_memory(p);
        return;
    }
    size_t count;
    if (sagi_pbrt_read_numbers(p, param, name, pairs, 2 * (size_t)MAX_SAMPLES, &count) == SAG_OK) {
        spectrum->kind = SAG_SPECTRUM_SAMPLED;
        spectrum->pairs = pairs;
        spectrum->pair_count = count / 2;
        add_spectrum(p, param, spectrum, input);
    }
    sag_release(p->context, pairs, 2 * MAX_SAMPLES * sizeof *pairs);
}

static sag_input read_color(sagi_pbrt *p, const sagi_param *param, sagi_spectrum_use use, double otherwise) {
    sagi_params *params = &p->params;
    const double *numbers = params->numbers + param->first_number;
    const size_t count = param->number_count;
    sag_input input = {.value = {otherwise, otherwise, otherwise}};
    sag_spectrum spectrum = {.normalize = use == SAGI_SPECTRUM_LIGHT};
    if (param->type == SAGI_TYPE_RGB) {
        if (count != 3)
            sagi_params_fail(params, param, "a colour has 3 numbers, not %zu", count);
        else
            read_rgb(p, param, use, numbers, &input);
    } else if (param->type == SAGI_TYPE_BLACKBODY) {
        spectrum.kind = SAG_SPECTRUM_BLACKBODY;
        spectrum.value = count > 0 ? numbers[0] : 0;
        if (count != 1)
            sagi_params_fail(params, param, "a black body has one temperature, not %zu", count);
        else if (!(spectrum.value > 0))
            sagi_params_fail(params, param, "a black body of %g K", spectrum.value);
        else
            add_spectrum(p, param, &spectrum, &input);
    } else if (param->type == SAGI_TYPE_SPECTRUM && param->string_count == 1 && count == 0) {
        read_name(p, param, &spectrum, &input);
    } else if (param->type == SAGI_TYPE_SPECTRUM && param->string_count == 0 && count >= 2 &&
               count % 2 == 0) {
        spectrum.kind = SAG_SPECTRUM_SAMPLED;
        spectrum.pairs = numbers;
        spectrum.pair_count = count / 2;
        add_spectrum(p, param, &spectrum, &input);
    } else if ((param->type == SAGI_TYPE_FLOAT || param->type == SAGI_TYPE_INTEGER) && count == 1) {
        input.value = (sag_rgb){numbers[0], numbers[0], numbers[0]};
        if (!isfinite(numbers[0]))
            sagi_params_fail(params, param, "\"%.*s\" is not finite", (int)param->name.length,
                             param->name.text);
    } else {
        sagi_params_fail(params, param, "\"%.*s\": a name or pairs of a wavelength and a value expected",
                         (int)param->name.length, param->name.text);
    }
    return input;
}

#define COLOR_TYPES (SAGI_TYPE_RGB | SAGI_TYPE_SPECTRUM | SAGI_TYPE_BLACKBODY | SAGI_TYPE_FLOAT)

sag_input sagi_pbrt_light_color(sagi_pbrt *p, const char *name) {
    const sagi_param *param = sagi_params_find(&p->params, name, COLOR_TYPES);
    if (param) return read_color(p, param, SAGI_SPECTRUM_LIGHT, 1);
    // The white of the colour space.
    sag_input input = {.value = {1, 1, 1}};
    if (p->state.color_space == SAG_COLOR_SRGB) return input;
    const sag_spectrum white = {
        .kind = SAG_SPECTRUM_ILLUMINANT, .rgb = {1, 1, 1}, .space = p->state.color_space};
    if (sag_world_add_spectrum(p->world, &white, &input.spectrum) != SAG_OK)
        p->params.status = sagi_pbrt_out_of_memory(p);
    return input;
}

sag_spectrum_id sagi_pbrt_named_spectrum(sagi_pbrt *p, const char *name) {
    sag_spectrum_id id;
    const sag_spectrum spectrum = {.kind = SAG_SPECTRUM_NAMED, .name = name};
    if (sag_world_add_spectrum(p->world, &spectrum, &id) != SAG_OK)
        p->params.status = sagi_pbrt_out_of_memory(p);
    return id;
}

// The texture a parameter names, in the map of its class or the other; one that is to come, in the former.
static sag_texture_id texture_of(sagi_pbrt *p, const sagi_param *param, sagi_names *first,
                                 const sagi_names *second) {
    sagi_params *params = &p->params;
    uint32_t id = 0;
    if (param->string_count != 1) {
        sagi_params_fail(params, param, "the name of one texture expected");
        return 0;
    }
    char room[SAGI_MAX_NAME];
    const sagi_slice name = sagi_params_name(params, param->first_string, room);
    if (!sagi_pbrt_find(p, first, name, &id) && !sagi_pbrt_find(p, second, name, &id)) {
        const sag_status status = sagi_pbrt_promise(p, param->place, first, name, &id);
        if (status != SAG_OK) params->status = status;
    }
    return id;
}

sag_input sagi_pbrt_spectrum_input(sagi_pbrt *p, const char *name, sagi_spectrum_use use, double otherwise) {
    const sagi_param *param = sagi_params_find(&p->params, name, COLOR_TYPES | SAGI_TYPE_TEXTURE);
    sag_input input = {.value = {otherwise, otherwise, otherwise}};
    if (param && param->type == SAGI_TYPE_TEXTURE)
        input.texture = texture_of(p, param, &p->spectrum_textures, &p->float_textures);
    else if (param)
        input = read_color(p, param, use, otherwise);
    return input;
}

sag_input sagi_pbrt_float_input(sagi_pbrt *p, const char *name, double otherwise) {
    const sagi_param *param =
        sagi_params_find(&p->params, name, SAGI_TYPE_FLOAT | SAGI_TYPE_INTEGER | SAGI_TYPE_TEXTURE);
    sag_input input = {.value = {otherwise, otherwise, otherwise}};
    if (param && param->type == SAGI_TYPE_TEXTURE)
        input.texture = texture_of(p, param, &p->float_textures, &p->spectrum_textures);
    else if (param)
        input = read_color(p, param, SAGI_SPECTRUM_INDEX, otherwise);
    return input;
}
