#include "tests/hard/hard_check.h"

#include "ref/trace/all_hits.h"
#include "ref/base/float_mode.h"

#include <string.h>

void play_broken(struct hard_play *play, enum hard_property property, size_t i)
{
    struct hard_result *out = play->result;
    out->broken[property]++;
    out->outcome = HARD_FAILED;
    if (out->part_label[0])
        return;
    memcpy(out->part_label, play->part->label, sizeof out->part_label);
    out->part = play->index;
    out->ray_index = i;
    out->property = property;
    if (i == SIZE_MAX)
        return;
    out->ray = play->part->ray[i];
    out->got = play->cache->answer[i];
    out->judgement = play->cache->judged[i];
}

static bool is_hit(const struct hit *hit)
{
    return hit->prim != ABI_NO_PRIM;
}

static bool same_bits(const struct hit *a, const struct hit *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

enum status play_trace(struct hard_play *play, void *self, struct hit *out)
{
    size_t count = play->part->ray_count;
    struct hit guard;
    memset(&guard, 0xA5, sizeof guard);
    out[count] = guard;
    enum status status =
        play->member->engine->trace(self, play->part->ray, count, out, &play->report, play->reason);
    if (!status && !same_bits(&out[count], &guard))
        play_broken(play, PROPERTY_STRAY, SIZE_MAX);
    return status;
}

/* Judges every answer alone. */
static enum status judge_all(struct hard_play *play)
{
    struct hard_cache *cache = play->cache;
    struct hard_result *out = play->result;
    size_t count = play->part->ray_count;
    struct judge *judge = NULL;
    enum status status = cache_judge(cache, play->member, &play->model, &judge, play->reason);
    if (status)
        return status;
    int lost = 0;
    bool heavy = count * (uint64_t)play->part->scene.tri_count > 1000000;
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : lost) if (heavy)
    for (long long i = 0; i < (long long)count; i++)
        lost += judge_answer(judge, &play->part->ray[i], &cache->truth[i], &cache->answer[i],
                             &cache->judged[i]) != STATUS_OK;
    if (lost)
        return fail(play->reason, STATUS_MEMORY, "no memory to judge %zu rays", count);
    for (size_t i = 0; i < count; i++) {
        const struct judgement *j = &cache->judged[i];
        out->count[j->verdict]++;
        out->wrong[j->wrong] += j->verdict == VERDICT_WRONG;
        out->worst_over = j->over > out->worst_over ? j->over : out->worst_over;
        cache->open[i] = j->verdict != VERDICT_RIGHT || cache->truth[i].tie_count > 1;
        if (j->verdict == VERDICT_WRONG)
            play_broken(play, PROPERTY_VERDICT, i);
    }
    return STATUS_OK;
}

/* Checks the expectations of the case, and that every hit names a triangle and has finite
 * numbers. */
static void check_wants(struct hard_play *play)
{
    const struct hard_part *part = play->part;
    const struct hard_cache *cache = play->cache, *like = &play->stage->cache[part->like];
    struct hard_subject subject = {play->model, play->member->query != QUERY_CLOSEST};
    for (size_t i = 0; i < part->ray_count; i++) {
        const struct hit *hit = &cache->answer[i];
        const struct hard_want *want = &part->want[i];
        bool numbers =
            float_is_finite(hit->t) && float_is_finite(hit->u) && float_is_finite(hit->v);
        if (is_hit(hit) &&
            (hit->prim >= part->scene.tri_count || (!numbers && ray_in_contract(&part->ray[i]))))
            play_broken(play, PROPERTY_FINITE, i);
        bool related = want->what & WANT_LIKE && like->answered;
        bool excused = cache->open[i] || (related && like->open[want->like]);
        enum hard_property property =
            hard_check(part, i, &subject, hit, related ? &like->answer[want->like] : NULL, excused);
        if (property != PROPERTY_KEPT)
            play_broken(play, property, i);
    }
}

/* The test with the engine's formula. An engine with a test of its own uses that one, whatever the
 * member names. */
static const struct tri_test *test_of(const struct hard_play *play)
{
    for (size_t t = 0; tri_tests[t]; t++)
        if (twin_of_tri(tri_tests[t]->id) == play->model.formula)
            return tri_tests[t];
    return play->member->tri;
}

/* Boxes are conservative: if every triangle was tested in turn and one that is truly hit accepted,
 * then its leaf had to be entered, and something hit. Whatever the tests' own errors, a miss can
 * only be the tree's. */
static enum status check_culled(struct hard_play *play)
{
    struct hard_cache *cache = play->cache;
    const struct hard_part *part = play->part;
    if (!play->member->engine->needs_packed || !twin_is_own(play->model.formula) ||
        !cache->in_range)
        return STATUS_OK;
    const struct hit *brute = cache_brute(cache, test_of(play));
    if (!brute)
        return fail(play->reason, STATUS_MEMORY, "no memory for %zu rays", part->ray_count);
    for (size_t i = 0; i < part->ray_count; i++) {
        struct oracle_pair pair;
        if (is_hit(&cache->answer[i]) || !is_hit(&brute[i]) || !ray_in_contract(&part->ray[i]))
            continue;
        oracle_pair(cache->oracle, &part->ray[i], brute[i].prim, &pair);
        bool hit =
            pair.class == ORACLE_INSIDE || pair.class == ORACLE_EDGE || pair.class == ORACLE_VERTEX;
        if (hit && pair.range != ORACLE_BELOW && pair.range != ORACLE_ABOVE)
            play_broken(play, PROPERTY_CULLED, i);
    }
    return STATUS_OK;
}

/* Engines that promise engine cpu's bits; rays out of contract promise nothing. */
static enum status check_bits(struct hard_play *play)
{
    struct hard_cache *cache = play->cache;
    const struct hard_member *m = play->member;
    const struct engine *cpu = engine_reference(true);
    size_t count = play->part->ray_count;
    if (!play->model.bits)
        return STATUS_OK;
    if (m->engine == cpu) {
        memcpy(cache->cpu, cache->answer, count * sizeof *cache->cpu);
    } else if (!cache->cpu_valid || cache->cpu_box != m->box || cache->cpu_tri != m->tri ||
               cache->cpu_query != m->query) {
        enum status status = STATUS_OK;
        struct trace_report report;
        void *self = pool_get(&play->stage->pool, cpu, &status, play->reason);
        if (!status)
            status = cpu->prepare(self, &play->job, play->reason);
        if (!status)
            status = cpu->trace(self, play->part->ray, count, cache->cpu, &report, play->reason);
        if (status)
            return status;
    }
    cache->cpu_valid = true;
    cache->cpu_box = m->box;
    cache->cpu_tri = m->tri;
    cache->cpu_query = m->query;
    for (size_t i = 0; i < count; i++)
        if (!same_bits(&cache->cpu[i], &cache->answer[i]) && ray_in_contract(&play->part->ray[i]))
            play_broken(play, PROPERTY_BITS, i);
    return STATUS_OK;
}

static enum status compare_again(struct hard_play *play, void *self, enum hard_property property)
{
    struct hard_cache *cache = play->cache;
    enum status status = play_trace(play, self, cache->again);
    for (size_t i = 0; i < play->part->ray_count && !status; i++)
        if (!same_bits(&cache->answer[i], &cache->again[i]))
            play_broken(play, property, i);
    return status;
}

/* With subnormals flushed, and on more threads. The mode is the thread's own: in stage->pool the
 * calling thread does the work. */
static enum status check_modes(struct hard_play *play)
{
    const struct engine *engine = play->member->engine;
    unsigned long mode = float_mode();
    float_mode_set(mode | FLOAT_FLUSH);
    enum status status = compare_again(play, play->self, PROPERTY_MODE);
    float_mode_set(mode);
    if (status)
        return status;
    void *many = pool_get(&play->stage->many, engine, &status, play->reason);
    if (!status)
        status = engine->prepare(many, &play->job, play->reason);
    return status ? status : compare_again(play, many, PROPERTY_MODE);
}

/* The same member's closest hits beside its any-hits. */
static enum status check_any(struct hard_play *play)
{
    struct hard_cache *cache = play->cache;
    struct job job = play->job;
    job.query = QUERY_CLOSEST;
    enum status status = play->member->engine->prepare(play->self, &job, play->reason);
    if (!status)
        status = play_trace(play, play->self, cache->again);
    for (size_t i = 0; i < play->part->ray_count && !status; i++)
        if (is_hit(&cache->answer[i]) != is_hit(&cache->again[i]) &&
            (twin_is_own(play->model.formula) || !cache->open[i]))
            play_broken(play, PROPERTY_ANY, i);
    return status;
}

static enum status check_again(struct hard_play *play)
{
    unsigned flags = play->stage->one->flags;
    enum status status = STATUS_OK;
    if (flags & HARD_TWICE)
        status = compare_again(play, play->self, PROPERTY_REPEAT);
    if (!status && flags & HARD_FLOAT_MODE)
        status = check_modes(play);
    if (!status && flags & HARD_ANY_TOO && play->member->query == QUERY_ANY)
        status = check_any(play);
    return status;
}

enum status play_check(struct hard_play *play)
{
    const struct hard_part *part = play->part;
    struct hard_result *out = play->result;
    enum status status = STATUS_OK;
    if (part->boxes_most > 0 && play->report.boxes > 0 && part->ray_count > 0 &&
        (double)play->report.boxes > part->boxes_most * (double)part->ray_count)
        play_broken(play, PROPERTY_BUDGET, SIZE_MAX);
    memset(play->cache->open, part->bad_scene, part->ray_count);
    if (!part->bad_scene)
        status = judge_all(play);
    play->cache->answered = true;
    out->rays += part->ray_count;
    for (size_t i = 0; i < part->ray_count; i++)
        out->hits += is_hit(&play->cache->answer[i]);
    if (!status)
        check_wants(play);
    if (!status && !part->bad_scene)
        status = check_culled(play);
    if (!status)
        status = check_bits(play);
    if (!status)
        status = check_again(play);
    return status;
}
