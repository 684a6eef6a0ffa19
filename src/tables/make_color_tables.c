// SPDX-License-Identifier: MIT
// Run while the library is built: writes the colour spaces and, for each, the coefficients of reflectances
// for a grid of colours (rgb_solve.c), as a C file. The same bytes on every machine.
//
// A colour's largest component z and the ratios of the two others to it span a cube; coefficients are found
// along z from the middle up and down, each the first guess of its neighbour. Beside them stands 0: four
// floats are loaded at once.
#include "render/colorspace.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LEVELS  SAGI_COLOR_LEVELS
#define RATIOS  SAGI_COLOR_RATIOS
#define STEP_NM 5

static sagi_color_table table;

static void expand(const char *lamp_name, float illuminant[SAGI_WAVELENGTH_COUNT]) {
    for (int l = 0; l < SAGI_LAMP_COUNT; l++) {
        const sagi_lamp *lamp = &sagi_lamps[l];
        if (strcmp(lamp->name, lamp_name) != 0) continue;
        for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) {
            const int offset = SAGI_WAVELENGTH_MIN + i - lamp->first, k = offset / lamp->step;
            const double part = (double)(offset % lamp->step) / lamp->step;
            const double next = (double)lamp->values[k + 1 < lamp->count ? k + 1 : k];
            illuminant[i] = (float)((1 - part) * (double)lamp->values[k] + part * next);
        }
    }
}

static void fill_column(const sagi_color_solver *solver, int largest, int y, int x, int from, int to) {
    double c[3] = {0, 0, 0};
    for (int z = from; z != to; z += from < to ? 1 : -1) {
        // Black has no coefficients, but c √z has a limit.
        const double value = z > 0 ? sagi_color_level(z) : sagi_color_level(1) / 1024;
        double rgb[3];
        rgb[largest] = value;
        rgb[(largest + 1) % 3] = value * x / (RATIOS - 1.0);
        rgb[(largest + 2) % 3] = value * y / (RATIOS - 1.0);
        sagi_color_solve(solver, rgb, c);
        for (int k = 0; k < 3; k++) table[largest][z][y][x][k] = (float)(c[k] * sqrt(value));
    }
}

static void print_floats(FILE *file, const float *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        fprintf(file, "%.9g%s", (double)values[i], i + 1 == count ? "" : i % 12 == 11 ? ",\n" : ",");
}

static void print_space(FILE *file, const sagi_color_space *s) {
    fprintf(file, "{{{%.17g,%.17g},{%.17g,%.17g},{%.17g,%.17g}},\n", s->primaries[0][0], s->primaries[0][1],
            s->primaries[1][0], s->primaries[1][1], s->primaries[2][0], s->primaries[2][1]);
    fprintf(file, "{%.17g,%.17g,%.17g},\n", s->white[0], s->white[1], s->white[2]);
    const double(*const matrices[2])[3] = {s->to_xyz, s->from_xyz};
    for (int m = 0; m < 2; m++) {
        fprintf(file, "{");
        for (int i = 0; i < 3; i++)
            fprintf(file, "{%.17g,%.17g,%.17g}%s", matrices[m][i][0], matrices[m][i][1], matrices[m][i][2],
                    i < 2 ? "," : "},\n");
    }
    fprintf(file, "{");
    print_floats(file, s->illuminant, SAGI_WAVELENGTH_COUNT);
    fprintf(file, "}},\n");
}

static void print_levels(FILE *file) {
    fprintf(file, "const float sagi_color_levels[SAGI_COLOR_LEVELS] = {\n");
    for (int i = 0; i < LEVELS; i++) fprintf(file, "%.9g,\n", sagi_color_level(i));
    fprintf(file, "};\nconst unsigned char sagi_color_guide[SAGI_COLOR_GUIDE + 1] = {\n");
    for (int i = 0, level = 0; i <= SAGI_COLOR_GUIDE; i++) {
        while (level < LEVELS - 2 && (float)sagi_color_level(level + 1) <= (float)i / SAGI_COLOR_GUIDE)
            level++;
        fprintf(file, "%d,\n", level);
    }
    fprintf(file, "};\n");
}

int main(int argc, char **argv) {
    // In the order of sag_color_space. Rec. ITU-R BT.709; P3 with the white of D65 (Display P3, SMPTE EG
    // 432-1); Rec. ITU-R BT.2020; SMPTE ST 2065-1.
    static const struct {
        const char *white;
        double primaries[3][2];
    } descriptions[SAGI_COLOR_SPACE_COUNT] = {
        {"stdillum-D65", {{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}}},
        {"stdillum-D65", {{0.68, 0.32}, {0.265, 0.69}, {0.15, 0.06}}},
        {"stdillum-D65", {{0.708, 0.292}, {0.17, 0.797}, {0.131, 0.046}}},
        {"illum-acesD60", {{0.7347, 0.2653}, {0, 1}, {0.0001, -0.077}}},
    };
    static sagi_color_space spaces[SAGI_COLOR_SPACE_COUNT];
    FILE *file = argc == 2 ? fopen(argv[1], "w") : NULL;
    if (!file) return 1;
    fprintf(file, "// Made by src/tables/make_color_tables.c.\n#include \"render/colorspace.h\"\n\n");
    fprintf(file, "const sagi_color_space sagi_color_spaces[SAGI_COLOR_SPACE_COUNT] = {\n");
    for (int i = 0; i < SAGI_COLOR_SPACE_COUNT; i++) {
        float illuminant[SAGI_WAVELENGTH_COUNT] = {0};
        expand(descriptions[i].white, illuminant);
        sagi_color_space_init(&spaces[i], descriptions[i].primaries, illuminant);
        print_space(file, &spaces[i]);
    }
    fprintf(file, "};\n\nconst sagi_color_table sagi_color_tables[SAGI_COLOR_SPACE_COUNT] = {\n");
    for (int i = 0; i < SAGI_COLOR_SPACE_COUNT; i++) {
        sagi_color_solver solver;
        sagi_color_solver_init(&solver, &spaces[i], STEP_NM);
        for (int largest = 0; largest < 3; largest++)
            for (int y = 0; y < RATIOS; y++)
                for (int x = 0; x < RATIOS; x++) {
                    fill_column(&solver, largest, y, x, LEVELS / 3, LEVELS);
                    fill_column(&solver, largest, y, x, LEVELS / 3, -1);
                }
        fprintf(file, "{");
        for (int largest = 0; largest < 3; largest++) {
            fprintf(file, "{");
            for (int z = 0; z < LEVELS; z++) {
                fprintf(file, "{");
                for (int y = 0; y < RATIOS; y++) {
                    fprintf(file, "{");
                    for (int x = 0; x < RATIOS; x++) {
                        fprintf(file, "{");
                        const sagi_coefficients c = table[largest][z][y][x];
                        fprintf(file, "%.9g,%.9g,%.9g", (double)c[0], (double)c[1], (double)c[2]);
                        fprintf(file, "}%s", x + 1 < RATIOS ? "," : "");
                    }
                    fprintf(file, "},\n");
                }
                fprintf(file, "},\n");
            }
            fprintf(file, "},\n");
        }
        fprintf(file, "},\n");
    }
    fprintf(file, "};\n");
    print_levels(file);
    return fclose(file) == 0 ? 0 : 1;
}
