// SPDX-License-Identifier: MIT
// sagitta measure, for people: a block for each body while there are few, a line for each when there are
// many. An estimate has as many digits as its error leaves, the error two; what is exact has nine and no
// error.
#include "measure.h"

#include <langinfo.h>
#include <math.h>
#include <string.h>

#define BLOCKS_SHOWN 8
#define LINES_SHOWN  200
#define VALUE_BYTES  160

static bool is_utf8(void) { return strcmp(nl_langinfo(CODESET), "UTF-8") == 0; }

const char *measure_label(const measure_report *r, size_t index, char text[MEASURE_NAME_BYTES]) {
    const sag_body *b = &r->measurement->bodies[index];
    uint32_t depth = b->instance_depth;
    int used;
    if (b->geometry == SAG_INVALID_ID && depth > 0) {
        depth--; // the innermost instance is the solid's own name
        used = snprintf(text, MEASURE_NAME_BYTES, "solid %u", b->instance_path[depth]);
    } else if (b->geometry == SAG_INVALID_ID) {
        used = snprintf(text, MEASURE_NAME_BYTES, "solid");
    } else if (r->names[index]) {
        used = snprintf(text, MEASURE_NAME_BYTES, "%.40s", r->names[index]);
    } else {
        used = snprintf(text, MEASURE_NAME_BYTES, "%s %u", sag_shape_kind_name(b->kind), b->geometry);
    }
    for (uint32_t i = 0; i < depth && used < MEASURE_NAME_BYTES - 24; i++)
        used += snprintf(text + used, (size_t)(MEASURE_NAME_BYTES - used), "%s%u", i ? "/" : " in instance ",
                         b->instance_path[i]);
    return text;
}

const char *measure_flaw(const sag_body *b, char text[256]) {
    const sag_mesh_report *m = &b->report;
    text[0] = 0;
    if (b->state == SAG_BODY_UNBOUNDED) snprintf(text, 256, "unbounded");
    if (b->state == SAG_BODY_EMPTY) snprintf(text, 256, "empty: no ray met anything");
    if (b->state != SAG_BODY_OPEN) return text;
    if (b->kind != SAG_SHAPE_MESH) {
        snprintf(text, 256, "not closed: no volume");
    } else if (m->open_edge_count) {
        snprintf(text, 256, "not closed: no volume (open edge between vertices %u and %u; %u open edge%s)",
                 m->open_edge[0], m->open_edge[1], m->open_edge_count, m->open_edge_count == 1 ? "" : "s");
    } else {
        snprintf(text, 256, "not closed: no volume (%u edge%s of an odd number of triangles)",
                 m->crowded_edge_count, m->crowded_edge_count == 1 ? "" : "s");
    }
    return text;
}

// ---------------------------------------------------------------------------------------------------------------
// numbers

// Some numbers of one kind with their common error: "(1.0001, 1.9998) ± 0.0012". What is below 1e-12 of
// `size` and exact is 0.
static const char *text_estimates(char text[VALUE_BYTES], const sag_estimate *e, int count, double factor,
                                  double size) {
    double most = 0, error = 0;
    bool known = true;
    for (int i = 0; i < count; i++) known = known && !isnan(e[i].value);
    for (int i = 0; i < count; i++)
        most = fmax(most, fabs(factor * e[i].value)), error = fmax(error, factor * e[i].error);
    if (!known || !isfinite(most) || !isfinite(error)) {
        snprintf(text, VALUE_BYTES, "%s", known && isinf(most) ? "infinite" : "-");
        return text;
    }
    // In powers of ten where plain digits would be many; with as many decimals as the error is worth.
    const double larger = fmax(most, error);
    const int power = larger > 0 ? (int)floor(log10(larger)) : 0;
    const bool scaled = error > 0 && (power < -4 || power > 8);
    const double unit = scaled ? pow(10, power) : 1;
    int decimals = 0;
    if (error > 0) decimals = 1 - (int)floor(log10(error / unit));
    decimals = decimals < 0 ? 0 : decimals > 14 ? 14 : decimals;
    const bool list = count > 1, bracket = list || scaled;
    int used = snprintf(text, VALUE_BYTES, "%s", bracket ? "(" : "");
    for (int i = 0; i < count; i++) {
        double value = factor * e[i].value;
        if (error == 0 && fabs(value) <= 1e-12 * factor * size) value = 0;
        if (error > 0 && fabs(value / unit) < 0.5 * pow(10, -decimals)) value = 0; // not -0.000
        if (i) used += snprintf(text + used, (size_t)(VALUE_BYTES - used), ", ");
        used += error > 0
                    ? snprintf(text + used, (size_t)(VALUE_BYTES - used), "%.*f", decimals, value / unit)
                    : snprintf(text + used, (size_t)(VALUE_BYTES - used), "%.9g", value);
    }
    if (list) used += snprintf(text + used, (size_t)(VALUE_BYTES - used), ")");
    if (error > 0)
        used += snprintf(text + used, (size_t)(VALUE_BYTES - used), " %s %.*f", is_utf8() ? "±" : "+-",
                         decimals, error / unit);
    if (scaled) snprintf(text + used, (size_t)(VALUE_BYTES - used), "%se%+03d", list ? " " : ")", power);
    return text;
}

static void print_estimates(const char *label, const sag_estimate *e, int count, double factor, double size) {
    char text[VALUE_BYTES];
    printf("  %-16s %s\n", label, text_estimates(text, e, count, factor, size));
}

// ---------------------------------------------------------------------------------------------------------------
// one body

static double size_of(const sag_body *b) { return sag_length(sag_sub(b->bounds.max, b->bounds.min)); }

// The histogram as forty small columns.
static void print_histogram(const sag_thickness *t) {
    static const char *const columns[] = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    double most = 0;
    for (int i = 0; i < SAG_THICKNESS_BINS; i++) most = fmax(most, t->histogram[i]);
    if (!is_utf8() || !(most > 0)) return;
    printf("  %-16s 0 ", "");
    for (int i = 0; i < SAG_THICKNESS_BINS; i++) {
        const double height = ceil(8 * t->histogram[i] / most);
        fputs(columns[(int)height], stdout);
    }
    printf(" %.4g\n", t->max);
}

static void print_thickness(const sag_body *b) {
    const sag_thickness *t = &b->thickness;
    if (!t->sample_count) return;
    char mean[VALUE_BYTES], count[TEXT_BYTES];
    printf("  %-16s median %.5g; 1 %% below %.4g, 5 %% below %.4g, 95 %% below %.5g\n", "thickness",
           t->percentiles[3], t->percentiles[0], t->percentiles[1], t->percentiles[5]);
    printf("  %-16s mean %s; %.4g to %.5g at %s points\n", "", text_estimates(mean, &t->mean, 1, 1, 0),
           t->min, t->max, text_count(count, t->sample_count));
    printf("  %-16s thinnest at (%.9g, %.9g, %.9g)\n", "", t->thinnest.x, t->thinnest.y, t->thinnest.z);
    print_histogram(t);
}

static void print_bounds(const sag_body *b) {
    const double *low = &b->bounds.min.x, *high = &b->bounds.max.x;
    for (int i = 0; i < 3; i++)
        printf("  %-16s %c %15.9g to %-15.9g (%.6g)\n", i ? "" : "bounds", 'x' + i, low[i], high[i],
               high[i] - low[i]);
}

static void print_inertia(const measure_report *r, const sag_body *b) {
    const double factor = r->density > 0 ? r->density : 1, size = fabs(b->principal[2].value);
    static const char *const names[] = {"inertia", "", ""};
    for (int i = 0; i < 3; i++) {
        char text[VALUE_BYTES];
        printf("  %-16s %s%s\n", names[i], text_estimates(text, b->inertia[i], 3, factor, size),
               i == 0 && !(r->density > 0) ? "  (for density 1)" : "");
    }
    print_estimates("principal", b->principal, 3, factor, size);
    for (int i = 0; i < 3; i++) {
        const double v[3] = {b->axes[i].x, b->axes[i].y, b->axes[i].z};
        printf("  %-16s (%.6f, %.6f, %.6f)\n", i ? "" : "  axes", fabs(v[0]) < 5e-7 ? 0 : v[0],
               fabs(v[1]) < 5e-7 ? 0 : v[1], fabs(v[2]) < 5e-7 ? 0 : v[2]);
    }
}

static void print_how(const measure_report *r, const sag_body *b) {
    char rays[TEXT_BYTES];
    if (!b->by_rays) {
        printf("  %-16s exact\n", "measured");
        return;
    }
    printf("  %-16s by rays (%s); %g %% intervals%s\n", "measured",
           b->rays ? text_count(rays, b->rays) : "of another instance", 100 * r->confidence,
           b->reached ? "" : "; the error asked for is NOT reached: --max-rays");
}

static void print_body(const measure_report *r, size_t index) {
    const sag_body *b = &r->measurement->bodies[index];
    char text[256];
    printf("\n%s\n", measure_label(r, index, text));
    const char *flaw = measure_flaw(b, text);
    if (*flaw) {
        printf("  %s\n", flaw);
        if (b->state == SAG_BODY_OPEN) print_estimates("area", &b->area, 1, 1, 0);
        if (b->state == SAG_BODY_OPEN) print_bounds(b);
        return;
    }
    if (b->inside_out) printf("  inside out: its normals point inward\n");
    if (b->overlaps) printf("  parts of it overlap or face both ways\n");
    print_how(r, b);
    print_estimates("volume", &b->volume, 1, 1, 0);
    print_estimates("area", &b->area, 1, 1, 0);
    if (r->density > 0) print_estimates("mass", &b->volume, 1, r->density, 0);
    print_estimates("centre of mass", b->center, 3, 1, size_of(b));
    print_inertia(r, b);
    print_thickness(b);
    print_bounds(b);
}

// ---------------------------------------------------------------------------------------------------------------
// many

// The number of columns that a text takes: bytes that do not go on with a character before them.
static int width_of(const char *text) {
    int width = 0;
    for (; *text; text++) width += ((unsigned char)*text & 0xC0) != 0x80;
    return width;
}

static void print_column(const char *text, int width) {
    printf("  %*s%s", width > width_of(text) ? width - width_of(text) : 0, "", text);
}

static void print_line(const measure_report *r, size_t index) {
    const sag_body *b = &r->measurement->bodies[index];
    char label[MEASURE_NAME_BYTES], volume[VALUE_BYTES], area[VALUE_BYTES], thickness[32] = "-", flaw[256];
    measure_label(r, index, label);
    if (b->thickness.sample_count) snprintf(thickness, sizeof thickness, "%.5g", b->thickness.percentiles[3]);
    printf("  %-32.32s", label);
    print_column(text_estimates(volume, &b->volume, 1, 1, 0), 24);
    print_column(text_estimates(area, &b->area, 1, 1, 0), 24);
    print_column(thickness, 10);
    measure_flaw(b, flaw);
    printf("%s%s%s%s\n", *flaw ? "  " : "", flaw, b->inside_out ? "  inside out" : "",
           b->overlaps ? "  overlaps itself" : "");
}

static void print_lines(const measure_report *r) {
    const sag_measurement *m = r->measurement;
    char text[TEXT_BYTES];
    printf("\n  %-32s  %24s  %24s  %10s\n", "body", "volume", "area", "thickness");
    for (size_t i = 0; i < m->body_count && i < LINES_SHOWN; i++) print_line(r, i);
    if (m->body_count > LINES_SHOWN)
        printf("  ... and %s more (--json has all)\n", text_count(text, m->body_count - LINES_SHOWN));
}

static void print_total(const measure_report *r) {
    const sag_measurement *m = r->measurement;
    sag_estimate volume = {0, 0}, area = {0, 0};
    size_t closed = 0, missed = 0;
    for (size_t i = 0; i < m->body_count; i++) {
        const sag_body *b = &m->bodies[i];
        if (b->state != SAG_BODY_CLOSED) continue;
        closed++, missed += !b->reached;
        volume.value += b->volume.value, volume.error += b->volume.error;
        area.value += b->area.value, area.error += b->area.error;
    }
    if (closed > 1) {
        char text[TEXT_BYTES];
        printf("\ntotal of %s closed bodies, overlaps counted as often as they are\n",
               text_count(text, closed));
        print_estimates("volume", &volume, 1, 1, 0);
        print_estimates("area", &area, 1, 1, 0);
        if (r->density > 0) print_estimates("mass", &volume, 1, r->density, 0);
    }
    if (missed > 0 && m->body_count > BLOCKS_SHOWN)
        printf("\nThe error asked for is not reached for %zu of them: --max-rays\n", missed);
    if (closed == 0 && m->body_count > 0) printf("\nNothing here has an inside.\n");
}

void measure_print(const measure_report *r) {
    const sag_measurement *m = r->measurement;
    char count[TEXT_BYTES], rays[TEXT_BYTES], time[TEXT_BYTES], load[TEXT_BYTES];
    printf("%s: %s bod%s in the file's unit; %s rays in %s (load %s)\n", r->file,
           text_count(count, m->body_count + m->omitted_count),
           m->body_count + m->omitted_count == 1 ? "y" : "ies", text_count(rays, m->rays),
           text_seconds(time, r->seconds), text_seconds(load, r->load_seconds));
    if (m->body_count > BLOCKS_SHOWN)
        print_lines(r);
    else
        for (size_t i = 0; i < m->body_count; i++) print_body(r, i);
    print_total(r);
    if (m->omitted_count) printf("\n%s more bodies were left out.\n", text_count(count, m->omitted_count));
}
