/* Crossings of a closed mesh: an even number, and every engine lists those that are clear. */
#include "tests/hard/hard_crossings.h"

#include "ref/trace/all_hits.h"

#include <stdlib.h>

/* A crossing whose smallest barycentric is below this may be listed or not. */
#define CLEAR 0x1p-10

/* What is exact about one ray. */
struct crossings_exact {
    struct oracle_crossing *list;
    size_t capacity, count;
    bool clear; /* all crossings are inside their triangles, by CLEAR */
};

static enum status exact_of(const struct hard_play *play, size_t i, struct crossings_exact *out)
{
    enum status status =
        oracle_crossings(play->cache->oracle, &play->part->ray[i], (double)play->part->ray[i].tmax,
                         &out->list, &out->capacity, &out->count, play->reason);
    out->clear = true;
    for (size_t k = 0; k < out->count && !status; k++)
        out->clear &= out->list[k].pair.class == ORACLE_INSIDE && out->list[k].pair.margin > CLEAR;
    return status;
}

static bool listed(const struct crossings_exact *exact, const struct hit *hit, size_t count,
                   size_t *twice)
{
    for (size_t k = 0; k < exact->count; k++) {
        size_t times = 0;
        for (size_t h = 0; h < count; h++)
            times += hit[h].prim == exact->list[k].prim;
        *twice += times > 1;
        if (times == 0)
            return false;
    }
    return true;
}

static enum status check_ray(struct hard_play *play, size_t i, struct crossings_exact *exact,
                             const struct hit *hit, size_t count)
{
    size_t twice = 0;
    enum status status = exact_of(play, i, exact);
    if (status || !exact->clear)
        return status;
    play->result->hits += exact->count;
    play->cache->judged[i] = (struct judgement){.expected = ABI_NO_PRIM};
    play->cache->answer[i] = count ? hit[0] : (struct hit){.prim = ABI_NO_PRIM};
    bool all = listed(exact, hit, count, &twice);
    if (exact->count % 2 != 0 || !all || twice > 0 || count != exact->count)
        play_broken(play, PROPERTY_PARITY, i);
    return STATUS_OK;
}

enum status play_crossings(struct hard_play *play)
{
    const struct hard_part *part = play->part;
    struct all_hits all = {.once = play->job.packed && play->job.packed->split};
    struct crossings_exact exact = {0};
    enum status status = STATUS_OK;
    for (size_t done = 0; done < part->ray_count && !status; done += all.done) {
        status = all_hits_next(play->member->engine, play->self, part->ray + done,
                               part->ray_count - done, &all, play->reason);
        for (size_t i = 0; !status && i < all.done; i++)
            status = check_ray(play, done + i, &exact, all.hit + all.first[i],
                               all.first[i + 1] - all.first[i]);
    }
    play->result->rays += part->ray_count;
    free(exact.list);
    all_hits_free(&all);
    return status;
}
