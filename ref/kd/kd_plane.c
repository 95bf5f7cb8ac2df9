#include "ref/kd/kd_plane.h"

/* Parts on the left of a plane, in it and on its right. */
struct sides {
    uint32_t left, flat, right;
};

static double cost_of(double left_share, double right_share, uint32_t left, uint32_t right)
{
    double cost =
        KD_COST_STEP + KD_COST_TRI * (left_share * (double)left + right_share * (double)right);
    return left == 0 || right == 0 ? KD_COST_EMPTY * cost : cost;
}

static void try_plane(const struct box *voxel, int axis, float at, const struct sides *n,
                      struct kd_plane *best)
{
    struct box left = *voxel, right = *voxel;
    double whole = box_half_area(voxel);
    if (!(voxel->lo[axis] < at && at < voxel->hi[axis]))
        return;
    left.hi[axis] = right.lo[axis] = at;
    double l = box_half_area(&left) / whole, r = box_half_area(&right) / whole;
    double with_left = cost_of(l, r, n->left + n->flat, n->right);
    double with_right = cost_of(l, r, n->left, n->flat + n->right);
    bool flat_right = with_right < with_left;
    double cost = flat_right ? with_right : with_left;
    if (best->axis < 0 || cost < best->cost)
        *best = (struct kd_plane){axis, at, flat_right, cost};
}

static float place_of(kd_event event)
{
    uint32_t key = (uint32_t)(event >> 32);
    return float_from_bits(key & 0x80000000u ? key & 0x7FFFFFFFu : ~key);
}

struct kd_plane kd_plane_find(const struct kd_set *set, const struct box *voxel)
{
    struct kd_plane best = {.axis = -1};
    if (!(box_half_area(voxel) > 0))
        return best;
    for (int axis = 0; axis < 3; axis++) {
        const kd_event *event = set->event[axis];
        struct sides n = {.right = set->count};
        for (uint32_t i = 0, end = set->events[axis]; i < end;) {
            const kd_event at = event[i] >> 32;
            uint32_t kind[3] = {0};
            for (; i < end && event[i] >> 32 == at; i++)
                kind[event[i] >> 30 & 3]++;
            n.flat = kind[KD_FLAT];
            n.right -= kind[KD_FLAT] + kind[KD_ENDS];
            try_plane(voxel, axis, place_of(at << 32), &n, &best);
            n.left += kind[KD_FLAT] + kind[KD_BEGINS];
        }
    }
    return best;
}
