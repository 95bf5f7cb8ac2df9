/* What a dispatch of a frame is made of, of jobs at the borders: drawn in one dispatch only where
 * no loop of a shader can end early, and what a path costs, which sizes the first batch. Nothing of
 * it needs a device. */
#include "gpu/frame/frame_dispatch.h"
#include "ref/base/rng.h"
#include "ref/layout.h"
#include "ref/primitives/primitives.h"
#include "ref/store.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#define LOOPS_MOST 65535u /* iterations that the oldest lavapipe allows in an invocation */
#define DRAWN      4000

static struct reason reason;
static const struct vk_limits limits = {.group_size = 1024};

/* A job of drawn sizes; half of them a few iterations from the border. */
static struct frame_job job_drawn(struct rng *rng, struct scene *scene, struct packed *packed)
{
    const struct frame_job job = {
        .job = {.scene = scene,
                .packed = packed,
                .box = box_tests[rng_below(rng, 3)],
                .tri = tri_tests[0]},
        .look = {.bounces = rng_below(rng, 9)},
        .width = 8,
        .height = 8,
        .light_count = rng_below(rng, 5),
    };
    const uint32_t rays = job.look.bounces * (1 + job.light_count);
    const uint32_t most = rays ? LOOPS_MOST / rays : LOOPS_MOST;
    const uint32_t steps = rng_below(rng, 2) ? rng_below(rng, 3 * most) : most - rng_below(rng, 6);
    packed->ref_count = rng_below(rng, steps / 4 + 1);
    packed->item_count = steps - 4 * packed->ref_count;
    scene->tri_count = steps;
    return job;
}

/* Iterations of all loops, if none of them is left before its end. */
static uint64_t iterations(const struct frame_job *job, bool brute)
{
    uint64_t steps = 0; /* of a ray */
    if (brute)
        steps = job->job.scene->tri_count;
    else if (job->job.box->id == ABI_BOX_RTRS) /* it culls nothing */
        steps = 4ull * job->job.packed->ref_count + job->job.packed->item_count;
    return (steps + 2) * job->look.bounces * (1 + job->light_count);
}

static void a_frame_is_one_dispatch_if_every_loop_ends(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 0);
    struct scene scene = {0};
    struct packed packed = {.layout = layout_find("f32"), .store = tri_stores[0], .stack_need = 16};
    size_t seen[2][2] = {{0}};
    for (size_t i = 0; i < DRAWN; i++) {
        struct frame_dispatch out;
        struct frame_job job = job_drawn(&rng, &scene, &packed);
        const bool brute = rng_below(&rng, 2);
        const bool whole = iterations(&job, brute) < LOOPS_MOST;
        assert_int_equal(frame_dispatch_make(&job, brute, &limits, &out, &reason), STATUS_OK);
        assert_int_equal(out.plan, whole ? FRAME_WHOLE : FRAME_STEPS);
        assert_int_equal(out.constant[ABI_SPEC_STEPS], !whole);
        const uint64_t rays = (uint64_t)job.look.bounces * (1 + job.light_count);
        assert_int_equal(out.rays, rays);
        assert_int_equal(out.cost,
                         rays * (brute ? scene.tri_count + 1ull : packed.ref_count + 1ull));
        seen[brute][whole]++;
        /* What is asked for is done, whatever it takes; without bounces there are no steps. */
        job.plan = whole ? FRAME_STEPS : FRAME_WHOLE;
        assert_int_equal(frame_dispatch_make(&job, brute, &limits, &out, &reason), STATUS_OK);
        assert_int_equal(out.plan, job.look.bounces ? job.plan : FRAME_WHOLE);
    }
    for (size_t i = 0; i < 4; i++)
        assert_true(seen[i / 2][i % 2] > DRAWN / 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_is_one_dispatch_if_every_loop_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
