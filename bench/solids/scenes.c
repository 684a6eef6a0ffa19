// SPDX-License-Identifier: MIT
// A scene as two files, with the same numbers in both. The same camera: POV-Ray's is given by the vectors
// that pbrt's LookAt makes, and pixels are sampled at their centres (a filter of no width on Sagitta's side).
//
// Depth. Every surface of POV-Ray's scene shines by itself with a pigment that falls linearly with the
// distance from the eye: "spherical" is 1 − |p| within the unit sphere; scaled by the far distance and moved
// to the eye it is what is wanted, whatever the surface and its transform, as it is the default texture that
// objects get when all their transforms are done. At +Q1 it is not looked at: then all surfaces are grey.
#include "solids.h"
#include <math.h>
#include <string.h>

static sag_vec3 cross_of(sag_vec3 a, sag_vec3 b) { return sag_normalize(sag_cross(a, b)); }

static void begin_pov(FILE *file, const view *v, double aspect) {
    const sag_vec3 z = sag_normalize(sag_sub(v->target, v->eye)), x = cross_of(v->up, z), y = cross_of(z, x);
    const double height = 2 * tan(v->fov_rad / 2);
    fprintf(file, "#version 3.7;\nglobal_settings { assumed_gamma 1 }\n");
    fprintf(file, "camera {\n  perspective location <%.17g, %.17g, %.17g>\n", v->eye.x, v->eye.y, v->eye.z);
    const sag_vec3 right = sag_scale(x, height * aspect), top = sag_scale(y, height);
    fprintf(file,
            "  right <%.17g, %.17g, %.17g> up <%.17g, %.17g, %.17g>\n  direction <%.17g, %.17g, %.17g>\n}\n",
            right.x, right.y, right.z, top.x, top.y, top.z, z.x, z.y, z.z);
    fprintf(file,
            "#default { texture {\n"
            "  pigment { spherical color_map { [0 rgb 0] [%.17g rgb 1] } scale %.17g translate <%.17g, "
            "%.17g, %.17g> }\n"
            "  finish { ambient 1 diffuse 0 }\n} }\n",
            1 - v->near / v->far, v->far, v->eye.x, v->eye.y, v->eye.z);
}

static void begin_pbrt(FILE *file, const view *v, size film) {
    fprintf(file, "LookAt %.17g %.17g %.17g  %.17g %.17g %.17g  %g %g %g\n", v->eye.x, v->eye.y, v->eye.z,
            v->target.x, v->target.y, v->target.z, v->up.x, v->up.y, v->up.z);
    fprintf(file, "Camera \"perspective\" \"float fov\" %.17g\n", v->fov_rad * 180 / acos(-1));
    fprintf(file, "Film \"rgb\" \"integer xresolution\" %u \"integer yresolution\" %u\n", film.width,
            film.height);
    fprintf(file, "PixelFilter \"box\" \"float xradius\" 1e-12 \"float yradius\" 1e-12\n"
                  "Sampler \"independent\" \"integer pixelsamples\" 1\nWorldBegin\n");
}

static FILE *open_file(const char *folder, const char *name, const char *ending) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.%s", folder, name, ending);
    FILE *file = fopen(path, "w");
    if (file == NULL) fprintf(stderr, "bench-solids: %s cannot be written\n", path);
    return file;
}

bool scene_write(const scene_kind *kind, const char *folder, size film) {
    scene_files files = {open_file(folder, kind->name, "pov"), open_file(folder, kind->name, "pbrt")};
    if (files.pov != NULL && files.pbrt != NULL) {
        begin_pov(files.pov, &kind->view, (double)film.width / film.height);
        begin_pbrt(files.pbrt, &kind->view, film);
        kind->write(&files);
    }
    bool good = files.pov != NULL && fclose(files.pov) == 0;
    return files.pbrt != NULL && fclose(files.pbrt) == 0 && good;
}

void write_matrix_pov(FILE *file, const sag_affine *map) {
    fprintf(file, "matrix <");
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 3; i++) fprintf(file, "%.17g%s", map->m[i][j], i == 2 && j == 3 ? ">" : ", ");
}

void write_matrix_pbrt(FILE *file, const sag_affine *map) {
    fprintf(file, "ConcatTransform [");
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 3; i++)
            fprintf(file, "%.17g %s", map->m[i][j], i < 2 ? "" : j < 3 ? "0  " : "1]");
}

sag_affine tumbled(unsigned number, sag_vec3 to) {
    // Angles that fill their range evenly: multiples of the golden ratio and of roots.
    const double turn = 2 * acos(-1), a = turn * fmod(number * 0.6180339887498949, 1),
                 b = turn * fmod(number * 0.4142135623730950, 1),
                 c = turn * fmod(number * 0.7320508075688772, 1);
    const sag_affine turns[] = {sag_affine_rotate(b, (sag_vec3){0, 1, 0}),
                                sag_affine_rotate(c, (sag_vec3){0, 0, 1}), sag_affine_translate(to)};
    sag_affine map = sag_affine_rotate(a, (sag_vec3){1, 0, 0});
    for (int i = 0; i < 3; i++) map = sag_affine_multiply(&turns[i], &map);
    return map;
}
