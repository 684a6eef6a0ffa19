// SPDX-License-Identifier: MIT
/// @file sagitta.h
/// Everything in libsagitta: what does this ray hit? (Pictures and files are in libsagitta-render: render.h,
/// image.h.)
#ifndef SAGITTA_H
#define SAGITTA_H

#include <sagitta/base.h>
#include <sagitta/math.h>
#include <sagitta/measure.h>
#include <sagitta/scene.h>
#include <sagitta/shapes.h>
#include <sagitta/solid.h>

#endif
