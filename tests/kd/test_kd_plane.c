/* The plane that divides a voxel is the cheapest, by a second reckoning that counts boxes at each
 * place in turn. */
#include "ref/kd/kd_plane.h"
#include "ref/base/rng.h"

#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define PARTS 24
#define SIDE  8 /* of the voxel, in units in which all boxes begin and end */

struct plane_case {
    struct part part[PARTS];
    uint32_t count;
    struct box voxel;
};

/* Boxes from place to place of a lattice, many of them flat, some in the voxel's faces. */
static struct plane_case draw(struct rng *rng)
{
    struct plane_case boxes = {.count = 1 + rng_below(rng, PARTS),
                               .voxel = {{0, 0, 0}, {SIDE, SIDE, SIDE}}};
    for (uint32_t i = 0; i < boxes.count; i++) {
        boxes.part[i].prim = i;
        for (int k = 0; k < 3; k++) {
            uint32_t a = rng_below(rng, SIDE + 1), b = rng_below(rng, 3);
            boxes.part[i].box.lo[k] = (float)a;
            boxes.part[i].box.hi[k] = (float)(a + b > SIDE ? SIDE : a + b);
        }
    }
    return boxes;
}

static int by_number(const void *a, const void *b)
{
    const kd_event *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static struct kd_plane found(struct plane_case *boxes)
{
    kd_event event[3][2 * PARTS];
    struct kd_set set = {.part = boxes->part, .count = boxes->count};
    for (int k = 0; k < 3; k++) {
        set.event[k] = event[k];
        for (uint32_t i = 0; i < boxes->count; i++)
            set.events[k] += kd_events(&boxes->part[i], i, k, event[k] + set.events[k]);
        qsort(event[k], set.events[k], sizeof event[k][0], by_number);
    }
    return kd_plane_find(&set, &boxes->voxel);
}

/* A step is 15 and a triangle 20; a fifth less where a side has none. */
static double cost(int at, uint32_t left, uint32_t right)
{
    const double whole = SIDE * SIDE * 3;
    double lower = SIDE * SIDE + 2.0 * at * SIDE;
    double upper = SIDE * SIDE + 2.0 * (SIDE - at) * SIDE;
    double sum = 15.0 + 20.0 * (lower / whole * left + upper / whole * right);
    return left == 0 || right == 0 ? 0.8 * sum : sum;
}

/* The first of the cheapest: axis by axis, from below, flat ones to the left if that is no dearer.
 * A plane lies where a box begins or ends, inside of the voxel. */
static struct kd_plane expected(const struct plane_case *boxes)
{
    struct kd_plane best = {.axis = -1};
    for (int k = 0; k < 3; k++)
        for (int at = 1; at < SIDE; at++) {
            uint32_t left = 0, flat = 0, right = 0, bounds = 0;
            for (uint32_t i = 0; i < boxes->count; i++) {
                int lo = (int)boxes->part[i].box.lo[k], hi = (int)boxes->part[i].box.hi[k];
                bounds += lo == at || hi == at;
                left += lo < at;
                right += hi > at;
                flat += lo == at && hi == at;
            }
            double with_left = cost(at, left + flat, right);
            double with_right = cost(at, left, right + flat);
            double least = with_left < with_right ? with_left : with_right;
            if (bounds && (best.axis < 0 || least < best.cost))
                best = (struct kd_plane){k, (float)at, with_right < with_left, least};
        }
    return best;
}

static void the_cheapest_plane_is_found(void **state)
{
    (void)state;
    uint32_t none = 0, empty = 0, flats = 0;
    struct rng rng = rng_make(11, 1);
    for (int round = 0; round < 20000; round++) {
        struct plane_case boxes = draw(&rng);
        struct kd_plane want = expected(&boxes), got = found(&boxes);
        assert_int_equal(got.axis, want.axis);
        if (want.axis < 0) {
            none++;
            continue;
        }
        assert_true(got.at == want.at);
        assert_true(got.cost == want.cost);
        assert_int_equal(got.flat_right, want.flat_right);
        flats += want.flat_right;
        empty += boxes.count == 1;
    }
    assert_true(none > 0 && empty > 100 && flats > 100); /* the law was not vacuous */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_cheapest_plane_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
