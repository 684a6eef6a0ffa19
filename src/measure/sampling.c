// SPDX-License-Identifier: MIT
// How sure: confidence intervals for what lines give, and when there are enough of them.
//
// R = 32 independent randomisations of the points each give a mean over N lines of each family; N starts at
// 256 and doubles. From R independent, nearly normal means follow the result, their mean, and its interval,
// ± t s/√R with Student's t for R − 1 degrees of freedom: of all ways to an interval with quasi-Monte Carlo
// points this plain one holds best what it promises (L'Ecuyer, Nakayama, Owen & Tuffin, "Confidence Intervals
// for Randomized Quasi-Monte Carlo Estimators", Winter Simulation Conference 2023). All in all the error
// falls nearly like 1/(rays^0.75), not 1/√rays.
//
// Centre, inertia and principal moments are no means but functions θ of the means of the raw sums. For those
// the jackknife: with θ₋ᵣ from all randomisations but the r-th,
//
//     s²/R ≈ (R − 1)/R Σᵣ (θ₋ᵣ − θ₋)²,
//
// which for a mean is the same as above (Miller, "The jackknife: a review", Biometrika 61(1), 1974).
//
// When to stop. An interval that is looked at again and again until it is narrow enough is narrow by luck now
// and then, and holds the truth less often than it says. With 32 randomisations the estimated deviation is
// within 13 % of the true one, each doubling makes it 1.7 times less, so luck decides about one doubling in a
// few; and the quantity that takes longest decides for all others. tests/oracle/test_measure_coverage.c
// counts.
//
// A task is one family of one randomisation and 512 of its lines at most; sums are added in the tasks' order.
#include "math/elementary.h"
#include "measure/measure.h"

#define FIRST_LINES  ((uint64_t)256)  // of each family and randomisation
#define PIECE_LINES  ((uint64_t)512)  // of a task
#define ROUND_LINES  ((uint64_t)4096) // between two reports
#define FAMILIES     (SAGI_REPLICATES * SAGI_AXES)
#define RAW_AND_AREA (SAGI_RAW_COUNT + 1)

// Derived quantities: volume, area, centre, inertia (xx yy zz xy xz yz), principal moments.
enum { VOLUME, AREA, CENTER, INERTIA = CENTER + 3, PRINCIPAL = INERTIA + 6, DERIVED = PRINCIPAL + 3 };

typedef struct sampler {
    const sagi_target *target;
    uint64_t seed;
    uint64_t first, count, pieces; // of this round, of each family
    sagi_line_sums *sums;          // of its tasks
    sagi_line_sums families[FAMILIES];
    uint64_t lines; // of each family so far
} sampler;

static void sum_task(void *argument, size_t index) {
    const sampler *s = argument;
    const size_t family = index / s->pieces;
    const uint64_t offset = index % s->pieces * PIECE_LINES;
    const uint64_t count = s->count - offset < PIECE_LINES ? s->count - offset : PIECE_LINES;
    const int axis = (int)(family % SAGI_AXES);
    s->sums[index] = (sagi_line_sums){0};
    sagi_lines_sum(s->target, sagi_line_key(s->seed, (uint32_t)(family / SAGI_AXES), axis), axis,
                   s->first + offset, count, &s->sums[index]);
}

static void add_sums(sagi_line_sums *all, const sagi_line_sums *more) {
    for (int k = 0; k < SAGI_RAW_COUNT; k++) all->raw[k] += more->raw[k];
    all->area += more->area;
    all->boundary_count += more->boundary_count, all->turned_count += more->turned_count;
    all->failed |= more->failed;
}

// Sends lines until each family has so many; false when memory is short or somebody stops it.
static bool extend(sampler *s, uint64_t lines, double fraction, sagi_reporter *reporter) {
    while (s->lines < lines) {
        s->first = s->lines;
        s->count = lines - s->lines < ROUND_LINES ? lines - s->lines : ROUND_LINES;
        s->pieces = (s->count - 1) / PIECE_LINES + 1;
        sag_parallel_for(s->target->context, FAMILIES * s->pieces, sum_task, s);
        for (size_t i = 0; i < FAMILIES * s->pieces; i++) {
            add_sums(&s->families[i / s->pieces], &s->sums[i]);
            if (s->sums[i].failed) return false;
        }
        s->lines += s->count;
        if (!sagi_report(reporter, fraction, FAMILIES * s->count)) return false;
    }
    return true;
}

// The mean raw sums and area of one randomisation, in the box's units but the area.
static void replicate_means(const sampler *s, int replicate, double means[RAW_AND_AREA]) {
    const sag_vec3 size = sag_sub(s->target->box.max, s->target->box.min);
    const double faces[3] = {size.y * size.z, size.z * size.x, size.x * size.y};
    for (int k = 0; k < RAW_AND_AREA; k++) means[k] = 0;
    for (int axis = 0; axis < SAGI_AXES; axis++) {
        const sagi_line_sums *f = &s->families[replicate * SAGI_AXES + axis];
        // The rectangle is 4 in the box's units; the families' volumes agree, their areas add up.
        for (int k = 0; k < SAGI_RAW_COUNT; k++) means[k] += 4 * f->raw[k] / ((double)s->lines * SAGI_AXES);
        means[SAGI_RAW_COUNT] += faces[axis] * f->area / (double)s->lines;
    }
}

static sagi_moments moments_of(const sag_box3 *box, const double means[RAW_AND_AREA]) {
    const sag_vec3 half = sag_scale(sag_sub(box->max, box->min), 0.5);
    const double h[3] = {half.x, half.y, half.z}, unit = h[0] * h[1] * h[2];
    static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
    sagi_raw_moments raw;
    raw.m[0] = unit * means[0];
    for (int i = 0; i < 3; i++) raw.m[1 + i] = unit * h[i] * means[1 + i];
    for (int k = 0; k < 6; k++) raw.m[4 + k] = unit * h[row[k]] * h[column[k]] * means[4 + k];
    return sagi_moments_from_raw(&raw, sag_add(box->min, half));
}

// All that follows from mean sums. The centre counts from `near`.
static void derive(const sag_box3 *box, const double means[RAW_AND_AREA], sag_vec3 near,
                   double derived[DERIVED]) {
    const sagi_moments m = moments_of(box, means);
    const sag_vec3 center = sag_sub(m.center, near);
    double inertia[3][3];
    sag_vec3 axes[3];
    sagi_moments_inertia(&m, inertia);
    derived[VOLUME] = m.volume, derived[AREA] = means[SAGI_RAW_COUNT];
    derived[CENTER] = center.x, derived[CENTER + 1] = center.y, derived[CENTER + 2] = center.z;
    for (int i = 0; i < 3; i++) derived[INERTIA + i] = inertia[i][i];
    derived[INERTIA + 3] = inertia[0][1], derived[INERTIA + 4] = inertia[0][2];
    derived[INERTIA + 5] = inertia[1][2];
    sagi_symmetric_eigen(inertia, &derived[PRINCIPAL], axes);
}

// Half widths of the derived quantities' intervals.
static void jackknife(const sampler *s, double quantile, sag_vec3 near, double half[DERIVED],
                      double means[RAW_AND_AREA]) {
    const double r = SAGI_REPLICATES;
    double single[SAGI_REPLICATES][RAW_AND_AREA], values[SAGI_REPLICATES][DERIVED], mean[DERIVED] = {0};
    for (int k = 0; k < RAW_AND_AREA; k++) means[k] = 0;
    for (int i = 0; i < SAGI_REPLICATES; i++) {
        replicate_means(s, i, single[i]);
        for (int k = 0; k < RAW_AND_AREA; k++) means[k] += single[i][k] / r;
    }
    for (int i = 0; i < SAGI_REPLICATES; i++) {
        double others[RAW_AND_AREA];
        for (int k = 0; k < RAW_AND_AREA; k++) others[k] = means[k] + (means[k] - single[i][k]) / (r - 1);
        derive(&s->target->box, others, near, values[i]);
        for (int k = 0; k < DERIVED; k++) mean[k] += values[i][k] / r;
    }
    for (int k = 0; k < DERIVED; k++) {
        double sum = 0;
        for (int i = 0; i < SAGI_REPLICATES; i++) sum += (values[i][k] - mean[k]) * (values[i][k] - mean[k]);
        half[k] = quantile * sqrt((r - 1) / r * sum);
    }
}

// The largest half width, relative to what is asked for: volume and area themselves, the radius of gyration,
// the largest moment.
static double worst(const sagi_moments *m, double area, const double half[DERIVED]) {
    const double trace = m->central[0] + m->central[1] + m->central[2];
    double inertia[3][3];
    sagi_moments_inertia(m, inertia);
    const double largest = fmax(inertia[0][0], fmax(inertia[1][1], inertia[2][2]));
    double result = fmax(half[VOLUME] / m->volume, half[AREA] / area);
    for (int i = 0; i < 3; i++) result = fmax(result, half[CENTER + i] / sqrt(trace / m->volume));
    for (int i = INERTIA; i < DERIVED; i++) result = fmax(result, half[i] / largest);
    return result;
}

// Principal moments that are equal are estimated apart: the larger one too large, the smaller one too small,
// which the jackknife does not see. Where intervals of neighbours meet, both get Weyl's bound: no eigenvalue
// moves by more than the norm of the matrix's own error.
static void widen_equal(const sagi_moments *m, const sagi_result *result, double error[3]) {
    double inertia[3][3], values[3], norm = 0;
    sag_vec3 axes[3];
    sagi_moments_inertia(m, inertia);
    sagi_symmetric_eigen(inertia, values, axes);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) norm += result->inertia_error[i][k] * result->inertia_error[i][k];
    norm = sqrt(norm);
    const double own[3] = {error[0], error[1], error[2]};
    for (int i = 0; i < 2; i++)
        if (values[i + 1] - values[i] <= own[i] + own[i + 1])
            error[i] = fmax(error[i], norm), error[i + 1] = fmax(error[i + 1], norm);
}

static void write_result(const sampler *s, const sagi_moments *moments, const double means[RAW_AND_AREA],
                         const double half[DERIVED], sagi_result *result) {
    static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
    uint64_t boundaries = 0, turned = 0;
    for (int i = 0; i < FAMILIES; i++)
        boundaries += s->families[i].boundary_count, turned += s->families[i].turned_count;
    result->by_rays = true;
    result->rays += FAMILIES * s->lines;
    result->inside_out = boundaries > 0 && turned == boundaries;
    result->overlaps = turned > 0 && turned < boundaries;
    result->moments = *moments;
    result->area = (sag_estimate){means[SAGI_RAW_COUNT], half[AREA]};
    result->volume_error = half[VOLUME];
    for (int i = 0; i < 3; i++)
        result->center_error[i] = half[CENTER + i], result->principal_error[i] = half[PRINCIPAL + i];
    for (int k = 0; k < 6; k++)
        result->inertia_error[row[k]][column[k]] = result->inertia_error[column[k]][row[k]] =
            half[INERTIA + k];
    widen_equal(moments, result, result->principal_error);
}

static bool sample(sampler *s, sagi_reporter *reporter, sagi_result *result) {
    const sag_measure_options *o = reporter->options;
    const double quantile = sagi_student_quantile(o->confidence, SAGI_REPLICATES - 1);
    const uint64_t most = o->max_rays / FAMILIES > FIRST_LINES ? o->max_rays / FAMILIES : FIRST_LINES;
    double fraction = 0;
    for (uint64_t lines = FIRST_LINES;; lines = 2 * lines < most ? 2 * lines : most) {
        if (!extend(s, lines, fraction, reporter)) return false;
        double means[RAW_AND_AREA], half[DERIVED];
        jackknife(s, quantile, sag_scale(sag_add(s->target->box.min, s->target->box.max), 0.5), half, means);
        const sagi_moments m = moments_of(&s->target->box, means);
        const double error = worst(&m, means[SAGI_RAW_COUNT], half);
        write_result(s, &m, means, half, result);
        result->rays = FAMILIES * s->lines;
        result->state = m.volume > 0 ? SAG_BODY_CLOSED : SAG_BODY_EMPTY;
        result->reached = error <= o->error;
        if (result->reached || lines == most || !(m.volume > 0)) return true;
        fraction = fmin(sagi_pow(o->error / error, 4 / 3.0), 0.99); // the error falls like rays^-0.75
    }
}

bool sagi_sample_body(const sagi_target *target, uint64_t seed, sagi_reporter *reporter,
                      sagi_result *result) {
    const size_t bytes = sizeof(sampler);
    const size_t sum_bytes = FAMILIES * (ROUND_LINES / PIECE_LINES) * sizeof(sagi_line_sums);
    sampler *s = sag_allocate(target->context, bytes);
    sagi_line_sums *sums = sag_allocate(target->context, sum_bytes);
    bool good = false;
    if (s != NULL && sums != NULL) {
        *s = (sampler){.target = target, .seed = seed, .sums = sums};
        good = sample(s, reporter, result);
    }
    sag_release(target->context, s, bytes);
    sag_release(target->context, sums, sum_bytes);
    return good;
}

sag_estimate sagi_mean_estimate(const double *values, int count, double confidence) {
    double mean = 0, sum = 0;
    for (int i = 0; i < count; i++) mean += values[i] / count;
    for (int i = 0; i < count; i++) sum += (values[i] - mean) * (values[i] - mean);
    return (sag_estimate){mean,
                          sagi_student_quantile(confidence, count - 1) * sqrt(sum / count / (count - 1))};
}
