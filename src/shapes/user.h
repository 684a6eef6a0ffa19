// SPDX-License-Identifier: MIT
// What a user-defined shape's callback reports to (sets.h): whoever asks fills one in.
#ifndef SAGI_SHAPES_USER_H
#define SAGI_SHAPES_USER_H

#include <sagitta/shapes.h>

struct sag_user_report {
    double t_min, t_max; // t outside, or NaN, is ignored (sag_user_report_hit); `take` says how t_max shrinks
    // Takes a crossing in range; returns the t beyond which crossings are of no interest any more.
    double (*take)(void *sink, uint32_t primitive, double t, double u, double v);
    void *sink;
};

#endif
