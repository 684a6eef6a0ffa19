// SPDX-License-Identifier: MIT
// 16-bit floats: a sign, 5 bits of exponent (bias 15), 10 of fraction. Moved 13 bits up they are the 32-bit
// float of the same fraction whose exponent, bias 127, is too small by 112, subnormal ones included; a
// multiplication by 2¹¹² mends that exactly. Downward a multiplication by 2⁻¹¹² lets the machine do the same,
// but for the rounding, which is done on the bits.
#include "mipmap.h"

#include <string.h>

float sagi_half_to_float(uint16_t half) {
    uint32_t bits = (uint32_t)(half & 0x7FFF) << 13;
    float value;
    if (bits >= UINT32_C(0x7C00) << 13) { // infinite or NaN
        bits |= UINT32_C(0x7F800000);
        memcpy(&value, &bits, 4);
    } else {
        memcpy(&value, &bits, 4);
        value *= 0x1p112F;
    }
    return half & 0x8000 ? -value : value;
}

uint16_t sagi_half_from_float(float value) {
    uint32_t bits;
    memcpy(&bits, &value, 4);
    const uint32_t sign = bits >> 16 & 0x8000;
    bits &= UINT32_C(0x7FFFFFFF);
    if (bits > UINT32_C(0x7F800000)) return (uint16_t)(sign | 0x7E00);  // NaN
    if (bits >= UINT32_C(0x477FF000)) return (uint16_t)(sign | 0x7C00); // 65520 and more
    if (bits < UINT32_C(0x38800000)) {
        // Subnormal, in steps of 2⁻²⁴: adding 1.5·2²³ steps rounds to a whole number of them.
        float magnitude;
        memcpy(&magnitude, &bits, 4);
        const float rounded = magnitude * 0x1p24F + 0x1.8p23F;
        memcpy(&bits, &rounded, 4);
        return (uint16_t)(sign | (bits & 0x7FFF));
    }
    bits += 0xFFF + (bits >> 13 & 1) - (UINT32_C(112) << 23);
    return (uint16_t)(sign | bits >> 13);
}
