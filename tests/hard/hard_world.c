#include "tests/hard/hard_world.h"

/* Builds and packs both levels. *go is false if they refuse. */
static enum status pack(struct hard_play *play, bool *go)
{
    const struct hard_member *m = play->member;
    struct hard_cache *cache = play->cache;
    struct match *match = &cache->match;
    const struct build_options build = match->options.build;
    enum status status = STATUS_OK;
    if (match->options.tri != m->tri || (m->layout && match->options.builder != m->builder)) {
        cache->layout = NULL;
        status = match_rebuild(match, m->layout ? m->builder : match->options.builder, &build,
                               m->tri, &cache->reason);
    }
    if (!status && m->layout && (cache->layout != m->layout || cache->top != m->top)) {
        match->options.top_layout = m->top;
        status = match_pack(match, m->layout, &cache->reason);
        cache->layout = status ? NULL : m->layout;
        cache->top = m->top;
    }
    *go = !status;
    if (status != STATUS_LIMIT)
        return status ? fail(play->reason, status, "%s", cache->reason.text) : STATUS_OK;
    play_refused(play, &cache->reason);
    return STATUS_OK;
}

/* Adds what the judge found, and notes its first finding. */
static void tally(struct hard_play *play, const struct row *row)
{
    struct hard_result *out = play->result;
    const size_t broken[PROPERTY_COUNT] = {
        [PROPERTY_VERDICT] = row->count[VERDICT_WRONG], [PROPERTY_BITS] = row->bit_differences};
    out->rays += row->rays;
    out->hits += row->hits;
    for (int v = 0; v < VERDICT_COUNT; v++)
        out->count[v] += row->count[v];
    for (int w = 0; w < WRONG_COUNT; w++)
        out->wrong[w] += row->wrong[w];
    out->worst_over = row->worst_over > out->worst_over ? row->worst_over : out->worst_over;
    for (int p = 0; p < PROPERTY_COUNT; p++)
        for (size_t i = 0; i < broken[p]; i++)
            play_broken(play, (enum hard_property)p, SIZE_MAX);
    if (row->finding_count == 0 || out->part != play->index || out->ray_index != SIZE_MAX)
        return;
    const struct finding *first = row->finding;
    out->property = first->bits ? PROPERTY_BITS : PROPERTY_VERDICT;
    out->ray_index = first->ray_index;
    out->ray = first->ray;
    out->got = first->got;
    out->judgement = first->judgement;
}

static void check_want(struct hard_play *play, size_t i)
{
    const struct match *match = &play->cache->match;
    const struct hard_want *want = &play->part->want[i];
    const enum query query = play->member->query;
    const bool first = query == QUERY_CLOSEST && play->part->mode[i].flags & ABI_RAY_FIRST;
    const struct hard_subject subject = {play->model, query == QUERY_ANY || first};
    const struct hit *hit = &match->answer[i];
    enum hard_property property = hard_check(play->part, i, &subject, hit, NULL, false);
    if (property == PROPERTY_KEPT && want->what & WANT_TAG && hit->prim != ABI_NO_PRIM &&
        !subject.any && match->answer_tag[i] != want->tag)
        property = PROPERTY_TAG;
    if (property == PROPERTY_KEPT)
        return;
    const bool noted = play->result->part_label[0] != '\0';
    play_broken(play, property, SIZE_MAX);
    if (noted)
        return;
    play->result->ray_index = i;
    play->result->ray = play->part->ray[i];
    play->result->got = *hit;
}

/* What the engine promises, as far as wants depend on it. */
static struct model model_of(const struct hard_play *play)
{
    const struct hard_member *m = play->member;
    struct model model = engine_model(m->engine, play->self, m->tri);
    model.watertight = model.watertight && (!m->box || m->box->watertight) &&
                       !(m->layout && play->cache->match.packed_world.split);
    return model;
}

enum status play_world(struct hard_play *play)
{
    const struct hard_member *m = play->member;
    struct match *match = &play->cache->match;
    struct row row;
    bool go;
    enum status status = pack(play, &go);
    if (status || !go)
        return status;
    match->pool = &play->stage->pool;
    match_set(match, m->box ? m->box : box_tests[0], m->query);
    play->result->asked++;
    match_run(match, m->engine, &row);
    if (row.status == ROW_REFUSED || row.status == ROW_SKIPPED) {
        play->result->declined += row.declined;
        play_refused(play, &row.reason);
        return STATUS_OK;
    }
    if (row.status == ROW_FAILED)
        return fail(play->reason, row.cause, "%s", row.reason.text);
    play->result->played++;
    play->model = model_of(play);
    tally(play, &row);
    for (size_t i = 0; i < row.rays; i++)
        check_want(play, i);
    return STATUS_OK;
}
