/* Where rays, hits and stacks of a run lie: with caches that hold everything, DRAM moves each burst
 * of them once, so that its bytes count the places. */
#include "tests/traffic/traffic_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#define BURST_BYTES 64u
#define LANES       9u

static struct traffic_machine roomy(uint32_t lanes)
{
    struct traffic_machine m = traffic_small();
    m.memory.cache[0] = m.memory.cache[1] = (struct traffic_cache_size){1 << 24, 16, BURST_BYTES};
    m.memory.units = 1;
    m.lanes = lanes;
    return m;
}

static void must_be_places(uint64_t bytes, uint64_t places, uint64_t each, const char *what)
{
    if (bytes < places * each || bytes >= places * each + BURST_BYTES)
        fail_msg("%s: %llu bytes of %llu places of %llu", what, (unsigned long long)bytes,
                 (unsigned long long)places, (unsigned long long)each);
}

/* Waves take turns in two halves: the second begins where the first wave ends. */
static void rays_and_hits_have_a_place_each(void **state)
{
    (void)state;
    static const char *const same[] = {"depth_first", "packets", "raycore"};
    struct traffic_case c;
    assert_true(traffic_case_open("soup:n=900,size=0.5", "f32", "indexed", &c));
    traffic_case_start(&c, 500, 4, 2000);
    assert_true(c.paths.depth == 4 && c.paths.wave[1].count > 30);
    const uint64_t places = c.paths.wave[0].count + c.paths.wave[1].count;
    for (size_t i = 0; i < ARRAY_COUNT(same); i++) {
        const struct traffic_machine m = roomy(LANES);
        const struct traffic_result r = traffic_case_play(&c, same[i], &m);
        const struct traffic_count *dram = &r.count[TRAFFIC_DRAM];
        must_be_places(dram->in[TRAFFIC_RAYS], places, TRAFFIC_RAY_BYTES, same[i]);
        must_be_places(dram->out[TRAFFIC_HITS], places, TRAFFIC_HIT_BYTES, same[i]);
        assert_int_equal(dram->out[TRAFFIC_RAYS] + dram->in[TRAFFIC_HITS], 0);
    }
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

/* A lane's stack has room for the deepest way down, so that two lanes share a burst at most where
 * one ends and the next begins. */
static void stacks_of_lanes_lie_apart(void **state)
{
    (void)state;
    struct traffic_case c;
    assert_true(traffic_case_open("soup:n=900,size=0.5", "f32", "indexed", &c));
    traffic_case_start(&c, 500, 2, 2000);
    const uint64_t room = (uint64_t)c.packed.stack_need * TRAFFIC_STACK_ENTRY;
    assert_true(room >= BURST_BYTES);
    for (uint32_t lanes = 1; lanes <= 64; lanes *= 4) {
        const struct traffic_machine m = roomy(lanes);
        const struct traffic_result r = traffic_case_play(&c, "depth_first", &m);
        assert_in_range(r.count[TRAFFIC_DRAM].out[TRAFFIC_STACK], lanes * BURST_BYTES,
                        lanes * room + BURST_BYTES);
    }
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_and_hits_have_a_place_each),
        cmocka_unit_test(stacks_of_lanes_lie_apart),
    };
    return cmocka_run_group_tests_name("traffic_places", tests, NULL, NULL) ? 1 : 0;
}
