#include "ref/match/match_lists.h"

#include "ref/trace/all_hits.h"
#include "ref/judge/judge_all.h"
#include "ref/match/match_edges.h"
#include "ref/match/match_judge.h"

#include <stdlib.h>
#include <string.h>

/* The judgement of one list. */
struct said {
    struct list_judgement list;
    struct list_mesh mesh;
    bool unstable, failed;
    bool bits; /* the bits differ from engine cpu's; the first such hits: */
    struct hit got, expected;
};

/* One row of lists. */
struct playing {
    struct match *match;
    const struct engine *engine;
    void *self, *cpu;
    struct row *row;
    struct judge *judge;
    struct topology topology;
    struct all_hits hits, again, theirs; /* the engine's, twice, and cpu's */
    struct said *said;                   /* of the rays of one batch */
    struct match_tally tally;
    uint64_t ns[2];
};

/* Lists the hits of rays from `at` on, sorted; lowers *done to the number of rays. */
static enum status list_part(const struct playing *p, const struct engine *engine, void *self,
                             size_t at, struct all_hits *out, size_t *done, uint64_t *ns)
{
    uint64_t start = time_ns();
    enum status status =
        all_hits_next(engine, self, p->match->ray + at, p->row->rays - at, out, &p->row->reason);
    *ns += time_ns() - start;
    for (size_t i = 0; i < out->done && !status; i++)
        all_hits_sort(out->hit + out->first[i], out->first[i + 1] - out->first[i]);
    if (!status && out->done < *done)
        *done = out->done;
    return status;
}

/* The first hits that differ in a bit; false if none does. */
static bool differ(const struct all_hits *a, const struct all_hits *b, size_t i, struct hit *one,
                   struct hit *other)
{
    size_t m = a->first[i + 1] - a->first[i], n = b->first[i + 1] - b->first[i];
    for (size_t k = 0; k < m || k < n; k++) {
        *one = k < m ? a->hit[a->first[i] + k] : hit_none();
        *other = k < n ? b->hit[b->first[i] + k] : hit_none();
        if (memcmp(one, other, sizeof *one) != 0)
            return true;
    }
    return false;
}

/* Judges one list in every way. */
static void judge_one(const struct playing *p, size_t at, size_t i, bool closed, struct said *out)
{
    const struct ray *ray = &p->match->ray[at + i];
    const struct hit *hit = p->hits.hit + p->hits.first[i];
    size_t count = p->hits.first[i + 1] - p->hits.first[i];
    struct hit one, other;
    *out = (struct said){.unstable = differ(&p->hits, &p->again, i, &one, &other)};
    enum status status = judge_list(p->judge, ray, hit, count, &out->list);
    struct judgement *judgement = &out->list.judgement;
    if (!status && judgement->verdict != VERDICT_OUT_OF_CONTRACT && ray_in_contract(ray))
        status =
            judge_list_mesh(p->match->oracle, &p->topology, closed, ray, hit, count, &out->mesh);
    if (judgement->verdict == VERDICT_BORDER) /* which side of an end a wall is on is chance */
        out->mesh.parity = out->mesh.parity_off = false;
    if (out->unstable) { /* whatever the ray */
        judge_set_wrong(judgement, WRONG_NOT_REPEATABLE);
        out->list.at_fault = one;
    }
    out->bits = p->cpu && differ(&p->hits, &p->theirs, i, &out->got, &out->expected) &&
                ray_in_contract(ray);
    out->failed = status != STATUS_OK;
}

static void keep_finding(struct playing *p, size_t ray, const struct said *said, bool bits)
{
    const struct finding what = {.got = bits ? said->got : said->list.at_fault,
                                 .judgement = said->list.judgement,
                                 .expected = said->expected,
                                 .bits = bits};
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
    if (said->bits) {
        row->bit_differences++;
        keep_finding(p, at + i, said, true);
    }
    if (judgement->verdict == VERDICT_WRONG && row->judged)
        keep_finding(p, at + i, said, false);
    p->match->answer[at + i] = count ? p->hits.hit[p->hits.first[i]] : hit_none();
}

/* Gets some lists from `at` on, judges and counts them; sets *done to how many. */
static enum status play_part(struct playing *p, size_t at, bool closed, size_t *done)
{
    uint64_t theirs = 0;
    *done = ALL_HITS_RAYS;
    enum status status = list_part(p, p->engine, p->self, at, &p->hits, done, &p->ns[0]);
    if (!status)
        status = list_part(p, p->engine, p->self, at, &p->again, done, &p->ns[1]);
    if (!status && p->cpu)
        status = list_part(p, engine_reference(true), p->cpu, at, &p->theirs, done, &theirs);
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
    enum status status = topology_make(match->scene, &p->topology, &row->reason);
    if (!status)
        status = judge_make(match->oracle, model, QUERY_ALL, &p->judge, &row->reason);
    bool started = match_tally_start(row, model, &p->tally);
    p->said = alloc_zeroed(ALL_HITS_RAYS, sizeof *p->said);
    if (!status && (!p->said || !started))
        status = fail(&row->reason, STATUS_MEMORY, "no memory to judge %zu lists", row->rays);
    row->lists.closed =
        !status && match->scene->tri_count > 0 && topology_open_edge(&p->topology) == TOPOLOGY_NONE;
    for (size_t at = 0; at < row->rays && !status; at += done)
        status = play_part(p, at, row->lists.closed, &done);
    return match_tally_end(&p->tally, match, status);
}

enum status match_lists(struct match *match, const struct engine *engine, void *self, void *cpu,
                        const struct model *model, struct row *row)
{
    bool once = engine->needs_packed && match->packed.split;
    struct playing p = {.match = match,
                        .engine = engine,
                        .self = self,
                        .cpu = cpu,
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
