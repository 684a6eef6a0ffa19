// SPDX-License-Identifier: MIT
// A colour space is given by the chromaticities of its primaries and its white. Columns of the matrix to XYZ
// are the primaries' XYZ, each as bright as it takes for (1, 1, 1) to be the white: with the columns (x, y, 1
// − x − y)/y, the amounts solve a 3×3 system (Glassner 1995, §3.4; SMPTE RP 177). The white's XYZ is summed
// from its light's spectrum, nanometre by nanometre, as all colours here are: white is white to the last
// digit.
#include "colorspace.h"

double sagi_luminance_norm(void) {
    double sum = 0;
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) sum += (double)sagi_cie_xyz[i][1];
    return sum;
}

void sagi_matrix_multiply(const double a[3][3], const double b[3][3], double product[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) product[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

void sagi_matrix_apply(const double m[3][3], const double v[3], double product[3]) {
    for (int i = 0; i < 3; i++) product[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
}

bool sagi_matrix_invert(const double m[3][3], double inverse[3][3]) {
    double cofactor[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            cofactor[i][j] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    const double determinant = m[0][0] * cofactor[0][0] + m[0][1] * cofactor[0][1] + m[0][2] * cofactor[0][2];
    if (!(determinant < 0 || determinant > 0)) return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) inverse[i][j] = cofactor[j][i] / determinant;
    return true;
}

void sagi_color_space_init(sagi_color_space *space, const double primaries[3][2],
                           const float illuminant[SAGI_WAVELENGTH_COUNT]) {
    double white[3] = {0, 0, 0}, columns[3][3], inverse[3][3], amounts[3];
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++)
        for (int k = 0; k < 3; k++) white[k] += (double)sagi_cie_xyz[i][k] * (double)illuminant[i];
    const double scale = sagi_luminance_norm() / white[1];
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++)
        space->illuminant[i] = (float)((double)illuminant[i] * scale);
    for (int k = 0; k < 3; k++) {
        const double x = primaries[k][0], y = primaries[k][1];
        space->primaries[k][0] = x, space->primaries[k][1] = y;
        space->white[k] = white[k] / white[1];
        columns[0][k] = x / y, columns[1][k] = 1, columns[2][k] = (1 - x - y) / y;
    }
    sagi_matrix_invert(columns, inverse);
    sagi_matrix_apply(inverse, space->white, amounts);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) space->to_xyz[i][k] = columns[i][k] * amounts[k];
    sagi_matrix_invert(space->to_xyz, space->from_xyz);
}
