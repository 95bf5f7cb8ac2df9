#include "ref/match/match_lists.h"

#include "ref/trace/all_hits.h"
#include "ref/judge/judge_world.h"
#include "ref/match/match_edges.h"
#include "ref/match/match_engine.h"
#include "ref/match/match_judge.h"

#include <stdlib.h>
#include <string.h>

/* A hit and, of a world, its tag; else 0. */
struct tagged_hit {
    struct hit hit;
    uint32_t tag;
};

/* The judgement of one list. */
struct said {
    struct list_judgement list;
    struct list_mesh mesh;
    bool unstable, failed;
    bool bits; /* the bits differ from row->against's; the first such hits: */
    struct tagged_hit got, expected;
};

/* One row of lists. */
struct playing {
    struct match *match;
    const struct engine *engine;
    void *self, *beside; /* beside: row->against's; NULL: not compared */
    struct row *row;
    struct judge *judge;
    struct topology topology;
    struct all_hits hits, again, theirs; /* the engine's, twice, and row->against's */
    struct said *said;                   /* of the rays of one batch */
    struct match_tally tally;
    uint64_t ns[2];
};

/* Lists the hits of rays from `at` on, sorted; lowers *done to the number of rays. */
static enum status list_part(const struct playing *p, const struct engine *engine, void *self,
                             size_t at, struct all_hits *out, size_t *done, uint64_t *ns)
{
    const struct match *match = p->match;
    const struct ray *ray = match->ray + at;
    const size_t rays = p->row->rays - at;
    struct reason *reason = &p->row->reason;
    uint64_t start = time_ns();
    enum status status =
        match->world ? all_hits_next_world(engine, self, ray, match->mode ? match->mode + at : NULL,
                                           rays, out, reason)
                     : all_hits_next(engine, self, ray, rays, out, reason);
    *ns += time_ns() - start;
    for (size_t i = 0; i < out->done && !status; i++) {
        const size_t first = out->first[i], count = out->first[i + 1] - first;
        if (match->world)
            all_hits_sort_tagged(out->hit + first, out->tag + first, count);
        else
            all_hits_sort(out->hit + first, count);
    }
    if (!status && out->done < *done)
        *done = out->done;
    return status;
}

/* Hit k of list i; a miss behind its end. */
static struct tagged_hit hit_at(const struct playing *p, const struct all_hits *lists, size_t i,
                                size_t k)
{
    const size_t at = lists->first[i] + k;
    if (at >= lists->first[i + 1])
        return (struct tagged_hit){.hit = hit_none()};
    return (struct tagged_hit){lists->hit[at], p->match->world ? lists->tag[at] : 0};
}

/* The first hits that differ in a bit; false if none does. */
static bool differ(const struct playing *p, const struct all_hits *a, const struct all_hits *b,
                   size_t i, struct tagged_hit *one, struct tagged_hit *other)
{
    size_t m = a->first[i + 1] - a->first[i], n = b->first[i + 1] - b->first[i];
    for (size_t k = 0; k < m || k < n; k++) {
        *one = hit_at(p, a, i, k);
        *other = hit_at(p, b, i, k);
        if (memcmp(&one->hit, &other->hit, sizeof one->hit) != 0 || one->tag != other->tag)
            return true;
    }
    return false;
}

/* Judges one list by itself, and a scene's by its mesh, too: meshes of a world promise nothing
 * together. */
static enum status judge_by_kind(const struct playing *p, size_t at, size_t i, bool closed,
                                 struct said *out)
{
    const struct match *match = p->match;
    const struct ray *ray = &match->ray[at + i];
    const struct hit *hit = p->hits.hit + p->hits.first[i];
    const size_t count = p->hits.first[i + 1] - p->hits.first[i];
    if (match->world)
        return judge_world_list(p->judge, ray, match_mode(match, at + i), hit,
                                p->hits.tag + p->hits.first[i], count, &out->list);
    enum status status = judge_list(p->judge, ray, hit, count, &out->list);
    if (!status && out->list.judgement.verdict != VERDICT_OUT_OF_CONTRACT && ray_in_contract(ray))
        status = judge_list_mesh(match->oracle, &p->topology, closed, ray, hit, count, &out->mesh);
    return status;
}

/* Judges one list in every way. */
static void judge_one(const struct playing *p, size_t at, size_t i, bool closed, struct said *out)
{
    struct tagged_hit one, other;
    *out = (struct said){.unstable = differ(p, &p->hits, &p->again, i, &one, &other)};
    enum status status = judge_by_kind(p, at, i, closed, out);
    struct judgement *judgement = &out->list.judgement;
    if (judgement->verdict == VERDICT_BORDER) /* which side of an end a wall is on is chance */
        out->mesh.parity = out->mesh.parity_off = false;
    if (out->unstable) { /* whatever the ray */
        judge_set_wrong(judgement, WRONG_NOT_REPEATABLE);
        out->list.at_fault = one.hit;
        out->list.tag = one.tag;
    }
    out->bits = p->beside && differ(p, &p->hits, &p->theirs, i, &out->got, &out->expected) &&
                ray_in_contract(&p->match->ray[at + i]);
    out->failed = status != STATUS_OK;
}

static void keep_finding(struct playing *p, size_t ray, const struct said *said, bool bits)
{
    const struct finding what = {.got = bits ? said->got.hit : said->list.at_fault,
                                 .judgement = said->list.judgement,
                                 .expected = said->expected.hit,
                                 .bits = bits,
                                 .world = {.tag = bits ? said->got.tag : said->list.tag,
                                           .expected_tag = bits ? said->expected.tag : 0}};
    match_keep_finding(p->match, ray, &what, p->row);
}

static void count_one(struct playing *p, size_t at, size_t i)
{
    struct row *row = p->row;
    const struct said *said = &p->said[i];
    const struct judgement *judgement = &said->list.judgement;
    size_t count = p->hits.first[i + 1] - p->hits.first[i];
    match_tally_add(&p->tally, at + i, count > 0, judgement);
    row->lists.triangles += count;
    row->lists.doubles += said->mesh.doubled;
    row->lists.parity += said->mesh.parity;
    row->lists.parity_off += said->mesh.parity_off;
    row->moved += said->bits && !row->bits;
    if (said->bits && row->bits) {
        row->bit_differences++;
        keep_finding(p, at + i, said, true);
    }
    if (judgement->verdict == VERDICT_WRONG && row->judged)
        keep_finding(p, at + i, said, false);
    const struct tagged_hit first = hit_at(p, &p->hits, i, 0);
    p->match->answer[at + i] = first.hit;
    if (p->match->world)
        p->match->answer_tag[at + i] = first.tag;
}

/* Gets some lists from `at` on, judges and counts them; sets *done to how many. */
static enum status play_part(struct playing *p, size_t at, bool closed, size_t *done)
{
    uint64_t theirs = 0;
    *done = ALL_HITS_RAYS;
    enum status status = list_part(p, p->engine, p->self, at, &p->hits, done, &p->ns[0]);
    if (!status)
        status = list_part(p, p->engine, p->self, at, &p->again, done, &p->ns[1]);
    if (!status && p->beside)
        status = list_part(p, p->row->against, p->beside, at, &p->theirs, done, &theirs);
    if (status)
        return status;
#pragma omp parallel for schedule(dynamic, 64)
    for (long long i = 0; i < (long long)*done; i++)
        judge_one(p, at, (size_t)i, closed, &p->said[i]);
    for (size_t i = 0; i < *done; i++) {
        if (p->said[i].failed)
            return fail(&p->row->reason, STATUS_MEMORY, "no memory to judge lists");
        count_one(p, at, i);
    }
    return STATUS_OK;
}

static enum status play(struct playing *p, const struct model *model)
{
    const struct match *match = p->match;
    struct row *row = p->row;
    size_t done;
    enum status status = STATUS_OK;
    if (match->scene)
        status = topology_make(match->scene, &p->topology, &row->reason);
    if (!status)
        status = judge_make(match->oracle, model, QUERY_ALL, &p->judge, &row->reason);
    bool started = match_tally_start(row, &p->tally);
    p->said = alloc_zeroed(ALL_HITS_RAYS, sizeof *p->said);
    if (!status && (!p->said || !started))
        status = fail(&row->reason, STATUS_MEMORY, "no memory to judge %zu lists", row->rays);
    row->lists.closed = !status && match->scene && match->scene->tri_count > 0 &&
                        topology_open_edge(&p->topology) == TOPOLOGY_NONE;
    for (size_t at = 0; at < row->rays && !status; at += done)
        status = play_part(p, at, row->lists.closed, &done);
    return match_tally_end(&p->tally, match, status);
}

enum status match_lists(struct match *match, const struct engine *engine, void *self, void *beside,
                        const struct model *model, struct row *row)
{
    bool split = match->world ? match->packed_world.split : match->packed.split;
    bool once = engine->needs_packed && split;
    struct playing p = {.match = match,
                        .engine = engine,
                        .self = self,
                        .beside = beside,
                        .row = row,
                        .hits.once = once,
                        .again.once = once,
                        .theirs.once = once};
    enum status status = play(&p, model);
    double speed[2];
    for (int i = 0; i < 2; i++)
        speed[i] = 1e3 * (double)row->rays / (double)(p.ns[i] ? p.ns[i] : 1);
    row->mrays[0] = 0.5 * (speed[0] + speed[1]);
    row->mrays[1] = speed[0] < speed[1] ? speed[0] : speed[1];
    row->mrays[2] = speed[0] < speed[1] ? speed[1] : speed[0];
    judge_free(p.judge);
    topology_free(&p.topology);
    all_hits_free(&p.hits);
    all_hits_free(&p.again);
    all_hits_free(&p.theirs);
    free(p.said);
    return status;
}
