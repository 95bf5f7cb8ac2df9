#include "ref/explain/imitate.h"

#include "ref/rng.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Relative distance within which t is the same of an engine that need not have C's bits. */
#define T_ALIKE 0x1p-18f

static bool alike(const struct explain_case *the, const struct hit *a, const struct hit *b)
{
    if (the->bits)
        return memcmp(a, b, sizeof *a) == 0;
    if (a->prim != b->prim)
        return false;
    return a->prim == ABI_NO_PRIM || fabsf(a->t - b->t) <= T_ALIKE * fabsf(a->t);
}

/* An engine that need not have C's bits may differ from the imitation in one witness in so many. */
#define STRAY_ONE_IN 20u

/* More witnesses are heard while two causes are as good. */
#define ROUNDS_MOST 40u

/* How a witness is aimed; they take turns. */
enum aim { AIM_FROM_RAY, AIM_MIRRORED, AIM_OUTSIDE, AIM_IN_RANGE, AIM_BESIDE, AIM_COUNT };

/* x moved by at most three floats. */
static float nudged(float x, struct rng *rng)
{
    return float_from_bits(float_bits(x) + rng_below(rng, 7) - 3u);
}

/* A point around the scene, outside of it. */
static void outside(const struct box *bounds, uint32_t i, float out[3])
{
    for (int k = 0; k < 3; k++) {
        float side = bounds->hi[k] - bounds->lo[k] + 1.0f;
        float away = 0.25f + 0.125f * (float)((i >> k) % 5);
        out[k] = i >> k & 1u ? bounds->hi[k] + away * side : bounds->lo[k] - away * side;
    }
}

/* Rays through all of the scene, at middles and at vertices of triangles: from where the ray starts
 * (also in its own range), from the other side, from outside; and the ray itself, a few floats
 * beside. */
static void make_witnesses(const struct explain_case *the, uint32_t round, struct ray *ray)
{
    const struct scene *scene = the->replay.scene;
    const uint32_t aimed = 2 * AIM_COUNT;
    struct rng rng = rng_make(1, round);
    uint32_t prim = 0;
    struct box bounds = scene_bounds(scene);
    for (uint32_t i = 0; i < EXPLAIN_WITNESSES; i++) {
        enum aim aim = (enum aim)(i % AIM_COUNT);
        uint32_t place = i / aimed;
        if (i % aimed == 0) /* at random: neighbours in order are neighbours in slots */
            prim = rng_below(&rng, scene->tri_count);
        float v[3][3], from[3];
        scene_tri(scene, prim, v);
        outside(&bounds, place, from);
        ray[i] = the->ray;
        if (aim == AIM_BESIDE) {
            for (int k = 0; k < 3; k++)
                ray[i].dir[k] = nudged(the->ray.dir[k], &rng);
            continue;
        }
        if (aim != AIM_IN_RANGE) {
            ray[i].tmin = 0;
            ray[i].tmax = 1e30f;
        }
        for (int k = 0; k < 3; k++) {
            float at = v[place % 3][k];
            if (i % aimed < AIM_COUNT)
                at = (v[0][k] + v[1][k] + v[2][k]) / 3.0f;
            ray[i].org[k] = aim == AIM_OUTSIDE ? from[k] : the->ray.org[k];
            if (aim == AIM_MIRRORED)
                ray[i].org[k] = at + (at - the->ray.org[k]);
            ray[i].dir[k] = at - ray[i].org[k];
        }
    }
}

/* What C answers with the defect. */
static struct hit imitated(const struct explain_case *the, const struct explain_imitation *one,
                           const struct ray *ray)
{
    struct replay_change change = {.defect = one->defect, .parameter = one->parameter};
    struct hit hit;
    (void)replay_run(&the->replay, &change, ray, &hit, NULL);
    return hit;
}

/* Witnesses and the engine's answers to them. */
struct witnesses {
    struct ray ray[EXPLAIN_WITNESSES];
    struct hit hit[EXPLAIN_WITNESSES];
    uint32_t count;
};

static void ask_witnesses(const struct explain_case *the, uint32_t round, struct witnesses *w)
{
    w->count = 0;
    if (!the->ask || the->replay.scene->tri_count == 0)
        return;
    make_witnesses(the, round, w->ray);
    if (the->ask(the->ask_user, w->ray, EXPLAIN_WITNESSES, w->hit))
        w->count = EXPLAIN_WITNESSES;
}

/* Counts the witnesses that an imitation answers as the engine does. */
static void hear(const struct explain_case *the, const struct witnesses *w,
                 struct explain_imitation *one)
{
    for (uint32_t i = 0; i < w->count; i++) {
        struct hit answer = imitated(the, one, &w->ray[i]);
        one->witnesses += alike(the, &answer, &w->hit[i]);
    }
}

static void try_defect(const struct explain_case *the, const struct hit *hit,
                       const struct witnesses *w, enum defect defect, uint32_t parameter,
                       struct explanation *out)
{
    if (out->imitation_count == EXPLAIN_IMITATIONS)
        return;
    struct explain_imitation *one = &out->imitation[out->imitation_count++];
    *one = (struct explain_imitation){.defect = defect, .parameter = parameter};
    struct hit answer = imitated(the, one, &the->ray);
    one->same = alike(the, &answer, hit);
    if (one->same)
        hear(the, w, one);
}

/* Parameters of a defect are tried in the order of this table. */
static void try_all(const struct explain_case *the, const struct hit *hit,
                    const struct witnesses *w, struct explanation *out)
{
    static const uint32_t caps[] = {65535, 65536, 32767, 16383, 4095, 1023, 255};
    const struct explain_tree *tree = the->replay.tree;
    for (enum defect defect = DEFECT_NONE + 1; defect < DEFECT_COUNT; defect++) {
        if (defect == DEFECT_SLOT) {
            for (uint32_t slot = 8; tree && slot-- > 0;)
                try_defect(the, hit, w, defect, slot, out);
        } else if (defect == DEFECT_FAR_DROPPED) {
            uint32_t need = tree ? tree->packed->stack_need : 0;
            for (uint32_t most = need < ABI_STACK_MAX ? need : ABI_STACK_MAX; most-- > 0;)
                try_defect(the, hit, w, defect, most, out);
        } else if (defect == DEFECT_LOOP) {
            for (size_t i = 0; i < ARRAY_COUNT(caps); i++)
                try_defect(the, hit, w, defect, caps[i], out);
        } else if (tree || defect == DEFECT_ZERO || defect == DEFECT_EDGE_FUSED ||
                   defect == DEFECT_LAST_WINS) {
            try_defect(the, hit, w, defect, 0, out);
        }
    }
}

/* The imitation with the most witnesses, the earliest if several have. *rivals: whether another
 * cause has as many. */
static size_t best(const struct explanation *out, bool *rivals)
{
    size_t at = out->imitation_count;
    for (size_t i = 0; i < out->imitation_count; i++)
        if (out->imitation[i].same && (at == out->imitation_count ||
                                       out->imitation[i].witnesses > out->imitation[at].witnesses))
            at = i;
    *rivals = false;
    for (size_t i = at + 1; i < out->imitation_count; i++)
        *rivals = *rivals || (out->imitation[i].same &&
                              out->imitation[i].witnesses == out->imitation[at].witnesses &&
                              defect_cause(out->imitation[i].defect) !=
                                  defect_cause(out->imitation[at].defect));
    return at;
}

enum status explain_imitate(const struct explain_case *the, const struct hit *hit,
                            struct explanation *out)
{
    bool rivals;
    struct witnesses *w = alloc_zeroed(1, sizeof *w);
    if (!w)
        return STATUS_MEMORY;
    ask_witnesses(the, 0, w);
    out->witness_count = w->count;
    try_all(the, hit, w, out);
    out->imitated = best(out, &rivals);
    for (uint32_t round = 1; rivals && w->count > 0 && round < ROUNDS_MOST; round++) {
        ask_witnesses(the, round, w);
        out->witness_count += w->count;
        for (size_t i = 0; i < out->imitation_count; i++)
            if (out->imitation[i].same)
                hear(the, w, &out->imitation[i]);
        out->imitated = best(out, &rivals);
    }
    uint32_t stray = the->bits ? 0 : out->witness_count / STRAY_ONE_IN;
    if (out->imitated < out->imitation_count &&
        out->imitation[out->imitated].witnesses + stray >= out->witness_count)
        out->cause = defect_cause(out->imitation[out->imitated].defect);
    else
        out->cause = the->exact ? CAUSE_SHADER : CAUSE_DRIVER_ARITHMETIC;
    free(w);
    return STATUS_OK;
}
