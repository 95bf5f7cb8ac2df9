#include "ref/dual/dual_cost.h"

/* True if the part ends within that side of `in`; *at is where. */
static bool is_loose(const struct dual_part *part, const struct box *in, uint32_t side, float *at)
{
    uint32_t k = side % 3;
    *at = side < 3 ? part->box.lo[k] : part->box.hi[k];
    return side < 3 ? *at > in->lo[k] : *at < in->hi[k];
}

/* Carves the side that leaves the least area; false if none is loose. */
static bool carve_one(const struct dual_part *part, struct box *in, uint32_t *side, float *at)
{
    struct box best = *in;
    bool any = false;
    for (uint32_t s = 0; s < 6; s++) {
        struct box cut = *in;
        float plane;
        if (!is_loose(part, in, s, &plane))
            continue;
        *dual_side(&cut, s) = plane;
        if (any && !(box_half_area(&cut) < box_half_area(&best)))
            continue;
        best = cut;
        any = true;
        *side = s;
        *at = plane;
    }
    *in = best;
    return any;
}

bool dual_carve_find(const struct dual_part *part, bool always, struct box *in,
                     struct dual_carve *out)
{
    struct box cut = *in;
    if (!carve_one(part, &cut, &out->side[0], &out->at[0]))
        return false;
    out->side[1] = out->side[0];
    out->at[1] = out->at[0];
    (void)carve_one(part, &cut, &out->side[1], &out->at[1]);
    double step = DUAL_COST_STEP * box_half_area(in);
    if (!always && !(step + dual_work(part, &cut) < dual_work(part, in)))
        return false;
    *in = cut;
    return true;
}

/* The expected work of a child in `in`. */
static double child_work(const struct dual_part *part, const struct box *in)
{
    double whole = dual_work(part, in);
    double carved = DUAL_COST_STEP * box_half_area_or_none(in) + dual_work(part, &part->box);
    return carved < whole ? carved : whole;
}

struct dual_split dual_split_find(const struct dual_part *fst, const struct dual_part *snd,
                                  const struct box *in)
{
    struct dual_split best = {0, false};
    double least = 0;
    for (uint32_t i = 0; i < 6; i++) {
        uint32_t k = i / 2;
        const struct dual_part *lower = i % 2 ? snd : fst, *upper = i % 2 ? fst : snd;
        struct box below = *in, above = *in;
        below.hi[k] = lower->box.hi[k];
        above.lo[k] = upper->box.lo[k];
        double work = child_work(lower, &below) + child_work(upper, &above);
        if (i > 0 && !(work < least))
            continue;
        least = work;
        best = (struct dual_split){k, i % 2 == 1};
    }
    return best;
}
