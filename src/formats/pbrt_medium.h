// SPDX-License-Identifier: MIT
// Names of participating media in a pbrt scene. MediumInterface may name a medium before MakeNamedMedium
// makes it, so a name gets its number wherever it is first seen: p->state.inside and .outside are such
// numbers, 0 for vacuum, and p->media[number - 1] says what is known of the medium.
#ifndef SAGI_FORMATS_PBRT_MEDIUM_H
#define SAGI_FORMATS_PBRT_MEDIUM_H

#include "formats/pbrt.h"

sag_status sagi_pbrt_make_named_medium(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_medium_interface(sagi_pbrt *p, sagi_place place);
// An error for the first medium that is used and never made; when all has been read.
sag_status sagi_pbrt_check_media(sagi_pbrt *p);

// A material that another stands for (pbrt_stand_in.c); false for a kind that is none of those.
bool sagi_pbrt_stand_in(sagi_pbrt *p, sagi_place place, const char *kind, sag_material *material);
// "roughness" or "uroughness" and "vroughness", as "remaproughness" says (pbrt_material.c).
void sagi_pbrt_roughness(sagi_pbrt *p, sag_material *material);

// The coefficients per millimetre of a substance pbrt knows by name (pbrt_substances.c); false for another.
bool sagi_pbrt_substance(const char *name, sag_rgb *absorption, sag_rgb *scattering);

#endif
