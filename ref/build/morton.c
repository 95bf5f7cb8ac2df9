#include "ref/build/morton.h"

#include "ref/build/grow.h"
#include "ref/build/keys.h"
#include "ref/build/room.h"

static void codes_make(const struct ref *ref, uint32_t count, const struct lane_box *centres,
                       uint32_t threads, uint64_t *key, uint32_t index_bits)
{
    uint32_t axis_bits = (64 - index_bits) / 3 < 21 ? (64 - index_bits) / 3 : 21;
    lanes extent = centres->hi - centres->lo;
    float most = extent[0] > extent[1] ? extent[0] : extent[1];
    most = most > extent[2] ? most : extent[2];
    /* The cells are cubes, not boxes of the scene's shape: so the longest side is split first. */
    lanes scale = lanes_all(most > 1e-30f ? (float)(1u << axis_bits) / most : 0);
    lanes last = lanes_all((float)((1u << axis_bits) - 1));
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (uint32_t i = 0; i < count; i++) {
        lanes at = lanes_min((ref_centre(&ref[i]) - centres->lo) * scale, last);
        at[3] = 0;
        lanes_int cell = lanes_to_int(at);
        uint64_t code = morton_spread((uint32_t)cell[0]) << 2 |
                        morton_spread((uint32_t)cell[1]) << 1 | morton_spread((uint32_t)cell[2]);
        key[i] = code << index_bits | i;
    }
}

enum status morton_order(const struct ref *ref, uint32_t count, const struct lane_box *centres,
                         uint32_t threads, uint64_t **out, uint32_t *index_bits)
{
    *index_bits = log2_ceil(count);
    *out = room_make(count, sizeof **out);
    if (!*out)
        return STATUS_MEMORY;
    codes_make(ref, count, centres, threads, *out, *index_bits);
    /* The keys are in the order of their indices; the sort preserves this for equal codes. */
    enum status status = keys_sort(out, count, *index_bits, threads);
    if (status) {
        room_free(*out);
        *out = NULL;
    }
    return status;
}
