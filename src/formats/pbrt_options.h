// SPDX-License-Identifier: MIT
// Option "name" value.
#ifndef SAGI_FORMATS_PBRT_OPTIONS_H
#define SAGI_FORMATS_PBRT_OPTIONS_H

#include "formats/pbrt.h"

sag_status sagi_pbrt_option(sagi_pbrt *p, sagi_place place);
// The sampler's seed, when it has none of its own; at WorldBegin, since an Option may follow the Sampler.
void sagi_pbrt_apply_seed(sagi_pbrt *p);

#endif
