/* Boxes of the triangles, their codes and the order of these, in C. */
#include "ref/staged/staged_inner.h"

#include "ref/base/text.h"
#include "ref/build/morton.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FRAME_BITS 29

/* floor(|x| / unit) with the sign of x, where 2^29 units are beyond the largest coordinate. The
 * exact quotient is representable, so ldexp rounds nothing but what trunc drops. */
int32_t frame_coordinate(const struct staged_frame *frame, float x)
{
    return (int32_t)trunc(ldexp((double)x, FRAME_BITS + 126 - (int)frame->exponent));
}

void staged_box_join(const uint32_t a[6], const uint32_t b[6], uint32_t out[6])
{
    for (int k = 0; k < 3; k++) {
        float lo[2] = {float_from_bits(a[k]), float_from_bits(b[k])};
        float hi[2] = {float_from_bits(a[3 + k]), float_from_bits(b[3 + k])};
        out[k] = float_bits(lo[0] < lo[1] ? lo[0] : lo[1]);
        out[3 + k] = float_bits(hi[0] > hi[1] ? hi[0] : hi[1]);
    }
}

static void leaf_boxes(const struct scene *scene, uint32_t (*box)[6])
{
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        struct box bounds = scene_tri_bounds(scene, i);
        for (int k = 0; k < 3; k++) {
            box[i][k] = float_bits(bounds.lo[k] + 0.0f); /* -0 becomes 0 */
            box[i][3 + k] = float_bits(bounds.hi[k] + 0.0f);
        }
    }
}

struct staged_frame staged_frame_of(const uint32_t all[6])
{
    struct staged_frame frame = {1};
    for (int k = 0; k < 6; k++) {
        uint32_t exponent = all[k] >> 23 & 0xFFu;
        frame.exponent = exponent > frame.exponent ? exponent : frame.exponent;
    }
    return frame;
}

/* Cells are cubes: the longest side of the scene, doubled as centres are, has just fewer than
 * 2^axis_bits of a power of two of units. */
static void make_codes(const struct staged_frame *frame, const uint32_t all[6], uint32_t axis_bits,
                       struct staged *staged)
{
    int64_t base[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        base[k] = 2 * (int64_t)frame_coordinate(frame, float_from_bits(all[k]));
        int64_t side = 2 * (int64_t)frame_coordinate(frame, float_from_bits(all[3 + k])) - base[k];
        longest = side > longest ? side : longest;
    }
    int64_t cell_size = 1, cells = (int64_t)1 << axis_bits, finer = 1;
    while (longest / cell_size >= cells)
        cell_size *= 2;
    while (longest > 0 && longest * finer * 2 < cells)
        finer *= 2;
    for (uint32_t i = 0; i < staged->count; i++) {
        const uint32_t *box = staged->box[staged->count - 1 + i];
        uint32_t cell[3];
        for (int k = 0; k < 3; k++) {
            int64_t twice = (int64_t)frame_coordinate(frame, float_from_bits(box[k])) +
                            frame_coordinate(frame, float_from_bits(box[3 + k]));
            cell[k] = (uint32_t)((twice - base[k]) * finer / cell_size);
        }
        staged->code[i] =
            morton_spread(cell[0]) << 2 | morton_spread(cell[1]) << 1 | morton_spread(cell[2]);
    }
}

/* Merges the sorted halves from .. middle - 1 and middle .. end - 1. */
static void merge(const struct staged *staged, const uint32_t *in, uint32_t from, uint32_t middle,
                  uint32_t end, uint32_t *out)
{
    uint32_t a = from, b = middle;
    for (uint32_t i = from; i < end; i++) {
        bool first = b == end || (a < middle && staged->code[in[a]] <= staged->code[in[b]]);
        out[i] = in[first ? a++ : b++];
    }
}

static enum status sort_codes(struct staged *staged)
{
    uint32_t n = staged->count, *to = malloc(n * sizeof *to);
    uint32_t *in = staged->order;
    if (!to)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < n; i++)
        in[i] = i;
    for (uint64_t run = 1; run < n; run *= 2) {
        for (uint64_t from = 0; from < n; from += 2 * run) {
            uint64_t middle = from + run < n ? from + run : n;
            uint64_t end = from + 2 * run < n ? from + 2 * run : n;
            merge(staged, in, (uint32_t)from, (uint32_t)middle, (uint32_t)end, to);
        }
        uint32_t *other = in;
        in = to;
        to = other;
    }
    staged->order = in;
    free(to);
    return STATUS_OK;
}

void stage_codes(const struct scene *scene, uint32_t axis_bits, struct staged *staged,
                 struct staged_frame *frame)
{
    const uint32_t n = staged->count;
    uint32_t(*leaf)[6] = staged->box + (n - 1), all[6];
    leaf_boxes(scene, leaf);
    memcpy(all, leaf[0], sizeof all);
    for (uint32_t i = 1; i < n; i++)
        staged_box_join(all, leaf[i], all);
    *frame = staged_frame_of(all);
    make_codes(frame, all, axis_bits, staged);
}

enum status stage_order(struct staged *staged)
{
    const uint32_t n = staged->count;
    uint32_t(*leaf)[6] = staged->box + (n - 1);
    enum status status = sort_codes(staged);
    uint32_t(*sorted)[6] = status ? NULL : malloc(n * sizeof *sorted);
    if (!sorted)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < n; i++)
        memcpy(sorted[i], leaf[staged->order[i]], sizeof *sorted);
    memcpy(leaf, sorted, n * sizeof *sorted);
    free(sorted);
    return STATUS_OK;
}

uint32_t stage_cut(const struct staged *staged, uint32_t first, uint32_t last)
{
    uint64_t differs = staged->code[staged->order[first]] ^ staged->code[staged->order[last]];
    if (!differs) {
        uint32_t bit = 31u - (uint32_t)__builtin_clz(first ^ last);
        return (last >> bit << bit) - 1;
    }
    uint64_t bit = (uint64_t)1 << (63 - __builtin_clzll(differs));
    uint32_t lo = first, hi = last; /* the code at lo lacks the bit, that at hi has it */
    while (hi - lo > 1) {
        uint32_t middle = lo + (hi - lo) / 2;
        if (staged->code[staged->order[middle]] & bit)
            hi = middle;
        else
            lo = middle;
    }
    return lo;
}
