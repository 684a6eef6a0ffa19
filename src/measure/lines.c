// SPDX-License-Identifier: MIT
// A body's moments and area from parallel lines.
//
// Volume. The lines along an axis i that go through the body's box B make a rectangle R. By Fubini
//
//     ∫_body f dV = ∫_R (∫ over the line's intervals within the body of f dxᵢ) dA,
//
// and for f = 1, xᵢ, xᵢxⱼ the inner integral is a closed form of the intervals' ends. With length L and
// middle m, other coordinates y: L, L m, L (m² + L²/12) along the line, y L, y m L, yy' L across. So only two
// of the three dimensions are sampled, and the function that is sampled is the body's chord, continuous for
// smooth bodies, not the jump from out to in.
//
// Area. A piece of surface with unit normal n is met by the lines of family i in the proportion |nᵢ|, so
// 1/|nᵢ| for each crossing would give the area, but its square has no finite mean where surfaces turn away
// from the lines. Three families at right angles together meet every piece in the proportion
// |n_x| + |n_y| + |n_z|, between 1 and √3, so
//
//     area = Σ_families ∫_R (Σ over the line's crossings of 1/(|n_x| + |n_y| + |n_z|)) dA :
//
// weights between 0.58 and 1, with every crossing of every line used (Veach's balance heuristic). Counting
// crossings of isotropic lines instead (Cauchy and Crofton: area = twice the mean number per unit of
// projected area) is unbiased too, and needs no normals, but has four dimensions to sample and the variance
// of 0 or 2. What the three families cost is exactness in faces that are parallel to two axes, which one
// family sees exactly and the others not at all: as good as it gets.
//
// Everything is worked out in the box's units, [−1, 1]³, where sizes from 1e-30 to 1e30 make no difference.
#include "measure/measure.h"

uint64_t sagi_line_key(uint64_t seed, uint32_t replicate, int axis) {
    return sagi_measure_hash(seed, replicate, (uint64_t)axis);
}

sag_ray sagi_line(const sag_box3 *box, uint64_t key, int axis, uint64_t index, double at[3]) {
    const sag_vec2 point = sagi_measure_point(key, index);
    double origin[3], direction[3] = {0, 0, 0}, reach = 0;
    for (int i = 0; i < 3; i++) {
        const double low = sag_component(box->min, i), half = sag_component(box->max, i) / 2 - low / 2;
        at[i] = i == axis ? 0 : 2 * (i == (axis + 1) % 3 ? point.x : point.y) - 1;
        origin[i] = low + half * (1 + at[i]);
        if (i == axis) reach = half;
    }
    direction[axis] = 1;
    sag_ray ray = sag_ray_make(sag_vec3_make(origin[0], origin[1], origin[2]),
                               sag_vec3_make(direction[0], direction[1], direction[2]));
    // A little beyond the box: its middle is rounded.
    reach += 0x1p-48 * (reach + fabs(origin[axis]));
    ray.t_min = -reach, ray.t_max = reach;
    return ray;
}

// Adds the integrals over an interval of a line along `axis` in the box's units.
static void add_interval(double raw[SAGI_RAW_COUNT], int axis, const double at[3], double from, double to) {
    static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
    const double length = to - from, middle = from + length / 2;
    double x[3] = {at[0], at[1], at[2]};
    x[axis] = middle;
    raw[0] += length;
    for (int i = 0; i < 3; i++) raw[1 + i] += length * x[i];
    for (int k = 0; k < 6; k++) raw[4 + k] += length * x[row[k]] * x[column[k]];
    raw[4 + axis] += length * length * length / 12;
}

static void add_line(const sagi_target *target, int axis, const sag_ray *ray, const double at[3],
                     sagi_line_buffer *buffer, sagi_line_sums *sums) {
    const size_t count = sagi_target_cross(target, ray, buffer);
    const double unit = 2 / (sag_component(target->box.max, axis) - sag_component(target->box.min, axis));
    for (size_t i = 0; i < count; i++) {
        const sagi_boundary *b = &buffer->boundaries[i];
        sag_surface s;
        sagi_target_surface(target, ray, &b->hit, &s);
        const sag_vec3 n = sag_abs(s.geometric_normal);
        sums->area += 1 / (n.x + n.y + n.z);
        sums->boundary_count++;
        sums->turned_count += b->entering != (s.side == SAG_SIDE_FRONT);
        if (!b->entering) add_interval(sums->raw, axis, at, unit * b[-1].hit.t, unit * b->hit.t);
    }
}

void sagi_lines_sum(const sagi_target *target, uint64_t key, int axis, uint64_t first, uint64_t count,
                    sagi_line_sums *sums) {
    sagi_line_buffer buffer = {.context = target->context};
    for (uint64_t i = first; i < first + count; i++) {
        double at[3];
        const sag_ray ray = sagi_line(&target->box, key, axis, i, at);
        add_line(target, axis, &ray, at, &buffer, sums);
    }
    sums->failed = buffer.failed;
    sagi_line_buffer_release(&buffer);
}
