#include "ref/look/numbers.h"

#include "ref/explain/replay.h"
#include "ref/look/around.h"

#include <math.h>
#include <stdlib.h>

struct numbers {
    struct explain_tree tree;
    struct explain_replay replay;
    struct around *around;
    double *growth; /* of each record's box; NAN where there is none */
};

/* One ray being counted. */
struct counting {
    const struct numbers *numbers;
    struct ray_numbers *out;
    double grown;
    uint32_t grown_count;
};

double box_growth(const struct box *box, const struct box *exact)
{
    double area[2], length[2];
    const struct box *both[2] = {box, exact};
    for (int i = 0; i < 2; i++) {
        double side[3];
        for (int k = 0; k < 3; k++) {
            side[k] = (double)both[i]->hi[k] - (double)both[i]->lo[k];
            if (isnan(side[k]))
                return NAN;
            side[k] = fmax(side[k], 0.0);
        }
        area[i] = side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
        length[i] = side[0] + side[1] + side[2];
    }
    if (isnan(area[0])) /* 0 times infinity */
        return INFINITY;
    if (area[1] > 0.0)
        return area[0] / area[1];
    return length[1] > 0.0 ? length[0] / length[1] : NAN;
}

static void measure_growth(struct numbers *numbers)
{
    const struct packed *packed = numbers->tree.packed;
    for (uint32_t ref = 0; ref < packed->ref_count; ref++) {
        uint32_t node = numbers->tree.node[ref];
        struct box box = packed->layout->box(packed, ref);
        if (numbers->tree.box && node != EXPLAIN_NONE)
            box = numbers->tree.box[node];
        numbers->growth[ref] =
            node == EXPLAIN_NONE ? (double)NAN : box_growth(&box, &numbers->tree.exact[node]);
    }
}

enum status numbers_make(const struct scene *scene, const struct bvh *bvh,
                         const struct packed *packed, const struct box_test *box,
                         const struct tri_test *tri, struct numbers **out, struct reason *reason)
{
    struct numbers *numbers = alloc_zeroed(1, sizeof *numbers);
    *out = NULL;
    if (!numbers)
        return fail(reason, STATUS_MEMORY, "no memory to count rays");
    enum status status = explain_tree_make(scene, bvh, packed, &numbers->tree, reason);
    if (!status)
        status = around_make(packed, &numbers->around);
    numbers->growth = alloc_zeroed(packed->ref_count, sizeof *numbers->growth);
    if (status || !numbers->growth) {
        numbers_free(numbers);
        return fail(reason, STATUS_MEMORY, "no memory to look at %u records", packed->node_count);
    }
    measure_growth(numbers);
    numbers->replay = (struct explain_replay){.scene = scene,
                                              .tree = &numbers->tree,
                                              .box_id = box->id,
                                              .tri_id = tri->id,
                                              .query = QUERY_CLOSEST};
    *out = numbers;
    return STATUS_OK;
}

void numbers_free(struct numbers *numbers)
{
    if (!numbers)
        return;
    explain_tree_free(&numbers->tree);
    around_free(numbers->around);
    free(numbers->growth);
    free(numbers);
}

static void count_box(void *user, uint32_t ref)
{
    struct counting *counting = user;
    double growth = counting->numbers->growth[ref];
    counting->out->boxes++;
    if (isnan(growth))
        return;
    counting->grown += growth;
    counting->grown_count++;
}

static void count_tri(void *user, uint32_t prim)
{
    struct counting *counting = user;
    (void)prim;
    counting->out->tris++;
}

static void count_push(void *user, uint32_t depth)
{
    struct ray_numbers *out = ((struct counting *)user)->out;
    out->depth = depth > out->depth ? depth : out->depth;
}

/* The point of a hit, in the bounds of its triangle. */
static void hit_point(const struct scene *scene, const struct hit *hit, double p[3])
{
    float v[3][3];
    struct box bounds = scene_tri_bounds(scene, hit->prim);
    scene_tri(scene, hit->prim, v);
    for (int k = 0; k < 3; k++) {
        double a = (double)v[0][k], e1 = (double)v[1][k] - a, e2 = (double)v[2][k] - a;
        p[k] = a + (e1 * (double)hit->u + e2 * (double)hit->v);
        p[k] = fmin(fmax(p[k], (double)bounds.lo[k]), (double)bounds.hi[k]);
    }
}

void numbers_of_ray(const struct numbers *numbers, const struct ray *ray, struct ray_numbers *out)
{
    struct counting counting = {numbers, out, 0.0, 0};
    const struct replay_change plain = {0};
    const struct replay_watch watch = {&counting, count_box, count_tri, count_push};
    struct replay_notes notes = {.prim = ABI_NO_PRIM, .watch = &watch};
    *out = (struct ray_numbers){0};
    out->finished = replay_run(&numbers->replay, &plain, ray, &out->hit, &notes) == REPLAY_DONE;
    out->inflation =
        counting.grown_count > 0 ? counting.grown / (double)counting.grown_count : (double)NAN;
    if (out->hit.prim == ABI_NO_PRIM)
        return;
    double p[3];
    hit_point(numbers->replay.scene, &out->hit, p);
    around_count(numbers->around, p, &out->around, &out->around_leaves);
}
