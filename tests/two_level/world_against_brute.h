/* A packed world against its world without trees. Include after world_stand.h. */
#ifndef TWO_LEVEL_WORLD_AGAINST_BRUTE_H
#define TWO_LEVEL_WORLD_AGAINST_BRUTE_H

static inline struct instance_record *records(const struct world *world)
{
    struct instance_record *record;
    assert_int_equal(world_records_make(world, &record, NULL), STATUS_OK);
    return record;
}

/* What a world looks like without trees. */
struct brute_answers {
    struct tagged nearest;
    struct tagged_list all;
};

static inline void brute_answer(const struct world *world, const struct instance_record *record,
                                const struct tri_test *tri, const struct ray *ray,
                                struct brute_answers *out)
{
    static struct hit hit[STAND_LIST];
    static uint32_t tag[STAND_LIST];
    trace_world_brute(world, record, tri, QUERY_CLOSEST, ray, ray_mode_all(), &out->nearest.hit,
                      &out->nearest.tag);
    out->all.count =
        trace_world_brute_all(world, record, tri, ray, ray_mode_all(), STAND_LIST, hit, tag);
    assert_true(out->all.count <= STAND_LIST);
    tagged_fill(&out->all, hit, tag, false);
}

static inline bool is_listed(const struct tagged_list *all, const struct tagged *hit)
{
    for (uint32_t i = 0; i < all->count; i++)
        if (memcmp(&all->entry[i], hit, sizeof *hit) == 0)
            return true;
    return false;
}

/* The same answers but for the choice among equally near hits. */
static inline void assert_answers(struct world_job job, const struct ray *ray,
                                  const struct brute_answers *expected)
{
    static struct tagged_list all;
    job.query = QUERY_CLOSEST;
    struct tagged hit = stand_trace(&job, ray, ray_mode_all());
    if (float_bits(hit.hit.t) != float_bits(expected->nearest.hit.t) ||
        (hit.hit.prim == ABI_NO_PRIM) != (expected->all.count == 0))
        fail_msg("%s over %s: triangle %u at %a, without trees %u at %a",
                 job.packed->top.layout->name, job.packed->bottom->layout->name, hit.hit.prim,
                 (double)hit.hit.t, expected->nearest.hit.prim, (double)expected->nearest.hit.t);
    assert_true(hit.hit.prim == ABI_NO_PRIM || is_listed(&expected->all, &hit));
    stand_all(&job, ray, ray_mode_all(), &all);
    assert_int_equal(all.count, expected->all.count);
    assert_memory_equal(all.entry, expected->all.entry, all.count * sizeof *all.entry);
    job.query = QUERY_ANY;
    hit = stand_trace(&job, ray, ray_mode_all());
    assert_int_equal(hit.hit.prim != ABI_NO_PRIM, expected->all.count > 0);
    assert_true(hit.hit.prim == ABI_NO_PRIM || is_listed(&expected->all, &hit));
}

static inline void assert_trees(const struct world *world, const char *builder, const char *top,
                                const char *bottom, uint64_t seed, uint32_t rays)
{
    static struct brute_answers expected;
    struct world_trees trees = stand_trees(world, builder, 2);
    struct packed_world packed = stand_packed(world, &trees, top, bottom);
    struct instance_record *record = records(world);
    struct world_job job = stand_job(world, &packed, QUERY_CLOSEST);
    uint32_t hits = 0;
    static const char *const tests[] = {"mt", "woop"};
    for (uint64_t i = 0; i < rays; i++) {
        struct ray ray = stand_aim(&packed, seed, i);
        job.tri = tri_test_find(tests[i % 2]);
        brute_answer(world, record, job.tri, &ray, &expected);
        assert_answers(job, &ray, &expected);
        hits += expected.all.count > 0;
    }
    assert_true(hits > rays / 8);
    free(record);
    packed_world_free(&packed);
    world_trees_free(&trees);
}

#endif
