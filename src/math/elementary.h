// SPDX-License-Identifier: MIT
// sin, exp, atan2 and the like: the same bits on every machine.
//
// IEEE 754 fixes the results of + − × ÷ √, but not of these. A C library's may differ with its version, and
// on one machine with the instructions it finds (glibc has versions with and without fused multiply-add,
// which round differently). A picture, or the clip angle of a sphere, must not. So what the library computes
// is computed by these functions, from the five operations alone and in a fixed order.
//
// Errors are below 1 ulp for sin, cos, exp, log, pow, atan, cbrt, hypot and below 3 ulp for tan, asin, acos,
// expm1, against MPFR in tests/oracle/test_elementary.c. Special arguments (0, ∞, NaN, out of the domain)
// give what C's Annex F says; subnormal results may be off by one in the last place. errno is left alone.
#ifndef SAGI_MATH_ELEMENTARY_H
#define SAGI_MATH_ELEMENTARY_H

// x in rad, of any size.
void sagi_sincos(double x, double *sine, double *cosine);
double sagi_sin(double x);
double sagi_cos(double x);
double sagi_tan(double x);
double sagi_atan2(double y, double x);
double sagi_asin(double x);
double sagi_acos(double x);
double sagi_exp(double x);
double sagi_expm1(double x);
double sagi_log(double x);
double sagi_pow(double x, double y);
double sagi_cbrt(double x);
double sagi_hypot(double x, double y);

#endif
