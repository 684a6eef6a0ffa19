// SPDX-License-Identifier: MIT
// What the files of `sagitta measure` share: measure.c runs it, measure_text.c writes for people,
// measure_json.c for programs.
#ifndef SAGITTA_TOOLS_MEASURE_H
#define SAGITTA_TOOLS_MEASURE_H

#include "tool.h"
#include <sagitta/measure.h>

#define MEASURE_NAME_BYTES 96

typedef struct measure_report {
    const char *file, *json; // json: NULL for none, "-" for the standard output
    const sag_context *context;
    const sag_measurement *measurement;
    const char **names; // of each body, in the file; NULL where it has none
    double error, confidence;
    double density; // 0: none given
    uint64_t seed;
    double load_seconds, seconds;
} measure_report;

// "wing" or "sphere 3" or "solid 5 in instance 2".
const char *measure_label(const measure_report *r, size_t body, char text[MEASURE_NAME_BYTES]);
// What keeps a body from having a volume, in words; "" for one that has.
const char *measure_flaw(const sag_body *body, char text[256]);

void measure_print(const measure_report *r);
// To the file, or to the standard output.
sag_status measure_write_json(const measure_report *r, sag_error *error);

#endif
