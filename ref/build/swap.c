#include "ref/build/swap.h"

#define PARTS 64u
#define APART 65536u /* above it references are divided in PARTS */

static bool is_fst(const struct ref_cut *cut, const struct ref *ref)
{
    return bin_of(cut->map, ref)[cut->axis] < cut->bin;
}

static void grow_centres(struct lane_box *box, const struct ref *ref)
{
    lanes centre = ref_centre(ref);
    lane_box_add(box, &(struct lane_box){centre, centre});
}

static uint32_t divide_part(struct ref *ref, uint32_t count, const struct ref_cut *cut,
                            struct lane_box *fst, struct lane_box *snd)
{
    uint32_t i = 0, end = count;
    struct lane_box a = lane_box_empty(), b = lane_box_empty();
    for (;;) {
        for (; i < end && is_fst(cut, &ref[i]); i++)
            grow_centres(&a, &ref[i]);
        for (; i < end && !is_fst(cut, &ref[end - 1]); end--)
            grow_centres(&b, &ref[end - 1]);
        if (i >= end)
            break;
        struct ref swap = ref[i];
        ref[i] = ref[end - 1];
        ref[end - 1] = swap;
    }
    *fst = a;
    *snd = b;
    return i;
}

/* Parts of a range: part i is ref[begin[i] .. begin[i + 1]); its first left[i] references go to the
 * first side. */
struct swap_parts {
    uint32_t begin[PARTS + 1], left[PARTS];
    struct lane_box fst[PARTS], snd[PARTS];
};

/* A run of references on the wrong side of the middle. */
struct swap_run {
    uint32_t first, count;
};

/* Finds the runs of second-side references before `middle`, and of first-side ones after it. */
static void runs_of(const struct swap_parts *parts, uint32_t middle, struct swap_run *early,
                    struct swap_run *late)
{
    for (uint32_t i = 0; i < PARTS; i++) {
        uint32_t begin = parts->begin[i], cut = begin + parts->left[i], end = parts->begin[i + 1];
        uint32_t stop = end < middle ? end : middle, start = begin > middle ? begin : middle;
        early[i] = (struct swap_run){cut, stop > cut ? stop - cut : 0};
        late[i] = (struct swap_run){start, cut > start ? cut - start : 0};
    }
}

/* Exchanges the runs' references, one by one in order. */
static void swap_runs(struct ref *ref, struct swap_run *early, struct swap_run *late)
{
    uint32_t a = 0, b = 0;
    for (;;) {
        while (a < PARTS && early[a].count == 0)
            a++;
        while (b < PARTS && late[b].count == 0)
            b++;
        if (a == PARTS || b == PARTS)
            return;
        uint32_t n = early[a].count < late[b].count ? early[a].count : late[b].count;
        for (uint32_t i = 0; i < n; i++) {
            struct ref swap = ref[early[a].first + i];
            ref[early[a].first + i] = ref[late[b].first + i];
            ref[late[b].first + i] = swap;
        }
        early[a] = (struct swap_run){early[a].first + n, early[a].count - n};
        late[b] = (struct swap_run){late[b].first + n, late[b].count - n};
    }
}

static uint32_t divide_parts(struct ref *ref, uint32_t count, const struct ref_cut *cut,
                             uint32_t threads, struct lane_box *fst, struct lane_box *snd)
{
    struct swap_parts parts;
    struct swap_run early[PARTS], late[PARTS];
    uint32_t middle = 0;
    for (uint32_t i = 0; i <= PARTS; i++)
        parts.begin[i] = (uint32_t)((uint64_t)count * i / PARTS);
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) if (threads > 1)
    for (uint32_t i = 0; i < PARTS; i++)
        parts.left[i] = divide_part(ref + parts.begin[i], parts.begin[i + 1] - parts.begin[i], cut,
                                    &parts.fst[i], &parts.snd[i]);
    *fst = *snd = lane_box_empty();
    for (uint32_t i = 0; i < PARTS; i++) {
        middle += parts.left[i];
        lane_box_add(fst, &parts.fst[i]);
        lane_box_add(snd, &parts.snd[i]);
    }
    runs_of(&parts, middle, early, late);
    swap_runs(ref, early, late);
    return middle;
}

uint32_t refs_divide(struct ref *ref, uint32_t count, const struct ref_cut *cut, uint32_t threads,
                     struct lane_box *fst, struct lane_box *snd)
{
    if (count <= APART)
        return divide_part(ref, count, cut, fst, snd);
    return divide_parts(ref, count, cut, threads, fst, snd);
}

static uint32_t longest_axis(const struct lane_box *box)
{
    lanes side = box->hi - box->lo;
    uint32_t axis = side[1] > side[0] ? 1 : 0;
    return side[2] > side[axis] ? 2 : axis;
}

uint32_t refs_halve(struct ref *ref, uint32_t count, const struct lane_box *centres,
                    struct lane_box *fst, struct lane_box *snd)
{
    uint32_t axis = longest_axis(centres), half = count / 2, lo = 0, hi = count;
    /* Divides the range that contains the middle, bit by bit. */
    for (uint32_t bit = 0x80000000u; bit && hi - lo > 1; bit >>= 1) {
        uint32_t i = lo, end = hi;
        while (i < end) {
            if (!(order_key(ref_centre(&ref[i])[axis]) & bit)) {
                i++;
                continue;
            }
            struct ref swap = ref[i];
            ref[i] = ref[--end];
            ref[end] = swap;
        }
        if (i <= half)
            lo = i;
        else
            hi = i;
    }
    *fst = *snd = lane_box_empty();
    for (uint32_t i = 0; i < count; i++)
        grow_centres(i < half ? fst : snd, &ref[i]);
    return half;
}
