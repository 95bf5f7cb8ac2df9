#include "tests/truth/play.h"

#include <stdlib.h>
#include <string.h>

/* Triangles of all tries together: each try builds the scene anew. */
#define WORK_MOST 1000000u

/* The triangles of `scene` whose index is in keep[0 .. count - 1]. */
static bool subset(const struct scene *scene, const uint32_t *keep, uint32_t count,
                   struct scene *out)
{
    if (scene_make(3 * count, count, out))
        return false;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t c = 0; c < 3; c++) {
            uint32_t to = 3 * i + c, from = scene->index[3 * (size_t)keep[i] + c];
            memcpy(out->vertex + 3 * (size_t)to, scene->vertex + 3 * (size_t)from,
                   3 * sizeof(float));
            out->index[to] = to;
        }
    return true;
}

/* Welded again, since shared vertices are part of what the judge knows. */
static bool still_wrong(const struct wrong_answer *wrong, const struct scene *scene, void *self,
                        struct wrong_answer *out)
{
    struct play_stand stand = {0};
    struct bvh bvh = {0};
    struct oracle *oracle = NULL;
    struct reason reason;
    struct judged_ray one;
    bool same = false;
    if (!stand_tree(scene, &bvh, &reason) && !oracle_make(scene, &oracle, &reason) &&
        stand_make(&wrong->who, self, scene, &bvh, oracle, &stand, &reason) &&
        !judged_explain(&stand.judged, &wrong->ray, &one, &reason)) {
        same = one.answer.finished && one.judgement.verdict == VERDICT_WRONG &&
               one.judgement.wrong == wrong->judgement.wrong && one.why.cause == wrong->cause;
        *out = *wrong;
        out->hit = one.answer.hit;
        out->judgement = one.judgement;
        out->opinion =
            exact_gmp_redecide(scene, &wrong->ray, &stand.judged.model, false, &one.answer.hit)
                .opinion;
        explain_free(&one.why);
    }
    stand_free(&stand);
    oracle_free(oracle);
    bvh_free(&bvh);
    return same;
}

/* One pass that takes `step` triangles away at a time; true if any could go. */
static bool pass(const struct wrong_answer *wrong, const struct scene *scene, void *self,
                 uint32_t *keep, uint32_t *count, uint32_t step, uint64_t *work,
                 struct smallest *out)
{
    bool gone = false;
    uint32_t *left = malloc((*count ? *count : 1) * sizeof *left);
    for (uint32_t at = 0; left && at < *count && *work<WORK_MOST && * count> 1;) {
        uint32_t n = 0;
        for (uint32_t i = 0; i < *count; i++)
            if (i < at || i >= at + step)
                left[n++] = keep[i];
        struct scene smaller;
        struct wrong_answer answer;
        *work += n + 50;
        if (n > 0 && subset(scene, left, n, &smaller)) {
            if (still_wrong(wrong, &smaller, self, &answer)) {
                memcpy(keep, left, n * sizeof *left);
                *count = n;
                gone = true;
                if (out->scene.tri_count == 0 || n < out->scene.tri_count) {
                    scene_free(&out->scene);
                    *out = (struct smallest){.answer = answer, .scene = smaller};
                    smaller = (struct scene){0};
                }
                scene_free(&smaller);
                continue;
            }
            scene_free(&smaller);
        }
        at += step;
    }
    free(left);
    return gone;
}

void reduce(const struct wrong_answer *wrong, const struct scene *scene, void *self,
            struct smallest *out)
{
    uint32_t count = scene->tri_count;
    uint64_t work = 0;
    uint32_t *keep = malloc((count ? count : 1) * sizeof *keep);
    if (!keep)
        return;
    for (uint32_t i = 0; i < count; i++)
        keep[i] = i;
    for (uint32_t step = (count + 1) / 2; step > 0 && work < WORK_MOST; step /= 2)
        while (pass(wrong, scene, self, keep, &count, step, &work, out) && step == 1)
            continue;
    free(keep);
}
