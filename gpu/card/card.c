#include "gpu/card/card.h"

#include "gpu/card/probe_once.h"
#include "ref/base/half.h"
#include "ref/base/rng.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define GROUP       64u
#define TRIPLES     8192u
#define FUNCTIONS   5u /* sqrt, inversesqrt, fma, min, max: results of probe_card */
#define PAIRS       4u /* the first triples: operands for min and max */
#define WORDS       (3u * 65536u)
#define CODES       65536u
#define LOOP_STEPS  100000u
#define LOOP_NESTED 100u

/* Runs an embedded probe. */
static enum status run(struct vk *vk, const char *name, uint32_t group, const void *push,
                       uint32_t push_bytes, uint32_t groups, const void *in, uint64_t in_bytes,
                       void *out, uint64_t out_bytes, struct reason *reason)
{
    const struct probe_job job = {.shader = shader_find(name),
                                  .group = group,
                                  .groups = groups,
                                  .push = push,
                                  .push_bytes = push_bytes,
                                  .in = in,
                                  .in_bytes = in_bytes,
                                  .out = out,
                                  .out_bytes = out_bytes};
    return probe_once(vk, &job, reason);
}

struct triple {
    float a, b, c;
};

/* Similar magnitudes, so that sums cancel and rounding errors show. */
static float ordinary(struct rng *rng)
{
    float x = rng_scaled(rng, 1, 2, -3, 6);
    return rng_below(rng, 2) ? -x : x;
}

static void make_triples(struct triple *triple)
{
    struct rng rng = rng_make(2, 0);
    triple[0] = (struct triple){1.0f, NAN, 0};
    triple[1] = (struct triple){NAN, 1.0f, 0};
    triple[2] = (struct triple){-0.0f, 0.0f, 0};
    triple[3] = (struct triple){0.0f, -0.0f, 0};
    for (uint32_t i = PAIRS; i < TRIPLES; i++) {
        const float a = ordinary(&rng), b = ordinary(&rng), c = ordinary(&rng); /* in this order */
        triple[i] = (struct triple){a, b, c};
        if (i % 2) /* the sum cancels */
            triple[i].c = -(triple[i].a * triple[i].b);
    }
}

static void choose(struct card_choice *choice, float plain, float other, float got)
{
    if (float_bits(plain) == float_bits(other) && float_bits(plain) == float_bits(got))
        return;
    choice->telling++;
    if (float_bits(got) == float_bits(plain))
        choice->plain++;
    else if (float_bits(got) == float_bits(other))
        choice->other++;
    else
        choice->neither++;
}

static void judge_root(struct card_root *root, double want, float got)
{
    int64_t apart = llabs((int64_t)float_bits((float)want) - (int64_t)float_bits(got));
    uint32_t ulp = apart > UINT32_MAX ? UINT32_MAX : (uint32_t)apart;
    root->count++;
    root->differs += ulp > 0;
    root->worst_ulp = ulp > root->worst_ulp ? ulp : root->worst_ulp;
}

/* Collects one operator's results for the first triples, which are FUNCTIONS floats apart. */
static struct card_pair pair_of(const float *got)
{
    return (struct card_pair){got[FUNCTIONS], got[0], got[2 * FUNCTIONS], got[3 * FUNCTIONS]};
}

/* Runs a probe on all triples. *out has `columns` floats for each; the caller frees it. */
static enum status run_on_triples(struct vk *vk, const char *name, const struct triple *triple,
                                  uint32_t columns, float **out, struct reason *reason)
{
    const uint32_t count = TRIPLES;
    *out = alloc_zeroed(TRIPLES, columns * sizeof **out);
    if (!*out)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for a probe");
    return run(vk, name, GROUP, &count, sizeof count, TRIPLES / GROUP, triple,
               TRIPLES * sizeof *triple, *out, TRIPLES * columns * sizeof **out, reason);
}

static enum status measure_functions(struct vk *vk, const struct triple *triple, struct card *out,
                                     struct reason *reason)
{
    float *all;
    enum status status = run_on_triples(vk, "probe_card", triple, FUNCTIONS, &all, reason);
    for (uint32_t i = PAIRS; i < TRIPLES && !status; i++) {
        const struct triple *t = triple + i;
        const float *got = all + FUNCTIONS * i;
        float product = t->a * t->b;
        choose(&out->fma, product + t->c, fmaf(t->a, t->b, t->c), got[2]);
        if (t->a > 0) {
            judge_root(&out->sqrt, sqrt((double)t->a), got[0]);
            judge_root(&out->inversesqrt, 1.0 / sqrt((double)t->a), got[1]);
        }
    }
    if (!status) {
        out->min = pair_of(all + 3);
        out->max = pair_of(all + 4);
    }
    free(all);
    return status;
}

static enum status measure_freedom(struct vk *vk, const struct triple *triple, struct card *out,
                                   struct reason *reason)
{
    float *got;
    enum status status = run_on_triples(vk, "probe_free", triple, 2, &got, reason);
    for (uint32_t i = PAIRS; i < TRIPLES && !status; i++) {
        const struct triple *t = triple + i;
        float product = t->a * t->b, difference = t->a - t->b;
        float ac = t->a * t->c, bc = t->b * t->c;
        choose(&out->contraction, product + t->c, fmaf(t->a, t->b, t->c), got[2 * i]);
        choose(&out->distribution, difference * t->c, ac - bc, got[2 * i + 1]);
    }
    free(got);
    return status;
}

static bool is_half_nan(uint32_t code)
{
    return (code & 0x7FFFu) > 0x7C00u;
}

static void judge_unpack(struct card_unpack *out, uint32_t code, uint32_t got)
{
    uint32_t want = float_bits(half_to_float((struct half){(uint16_t)code}));
    uint32_t magnitude = code & 0x7FFFu;
    bool subnormal = magnitude > 0 && magnitude < 0x400u;
    if (is_half_nan(code))
        out->wrong += (got & 0x7FFFFFFFu) <= 0x7F800000u;
    else if (!subnormal)
        out->wrong += got != want;
    else if (got == want)
        out->kept++;
    else if ((got & 0x7FFFFFFFu) == 0)
        out->flushed++;
    else
        out->subnormal_wrong++;
}

static void judge_pack(struct card_pack *out, uint32_t bits, uint32_t got)
{
    const float x = float_from_bits(bits), size = fabsf(x);
    const uint32_t nearest = half_nearest(x).bits;
    out->count++;
    if (isnan(x) ? is_half_nan(got) : got == nearest)
        return;
    out->differs++;
    out->beyond += got != half_down(x).bits && got != half_up(x).bits;
    bool normal = size >= 0x1p-14f && size < 65520.0f;
    out->overflow += size >= 65520.0f;
    out->tiny += size < 0x1p-14f;
    out->normal += normal;
    if (out->differs > 1 && !(normal && out->normal == 1))
        return;
    out->example = x;
    out->example_got = got;
    out->example_nearest = nearest;
}

/* Every upper half of a float with a zero lower half; random floats in the range of halves; and the
 * midpoints of neighbouring halves, each also with the next float above it. That is where rounding
 * is decided. */
static void make_words(uint32_t *word)
{
    struct rng rng = rng_make(3, 0);
    for (uint32_t i = 0; i < CODES; i++) {
        word[i] = i << 16;
        float x = rng_scaled(&rng, 1, 2, -26, 42);
        word[CODES + i] = float_bits(rng_below(&rng, 2) ? -x : x);
        uint16_t code = (uint16_t)(i / 2 < 0x7C00u ? i / 2 : i / 2 - 0x7C00u);
        float below = half_to_float((struct half){code});
        float above =
            code == 0x7BFFu ? 65536.0f : half_to_float((struct half){(uint16_t)(code + 1)});
        word[2 * CODES + i] = float_bits((below + above) / 2) + i % 2;
    }
}

static enum status measure_halves(struct vk *vk, struct card *out, struct reason *reason)
{
    const uint32_t count = WORDS;
    uint32_t *word = alloc_zeroed(WORDS, sizeof *word);
    uint32_t(*got)[3] = alloc_zeroed(WORDS, sizeof *got);
    enum status status = STATUS_OK;
    if (!word || !got)
        status = fail(reason, STATUS_MEMORY, "vulkan: no memory for a probe");
    /* Pass 0 packs; pass 1 unpacks every code in both halves. */
    for (int pass = 0; pass < 2 && !status; pass++) {
        if (pass == 0)
            make_words(word);
        for (uint32_t i = 0; i < CODES && pass == 1; i++)
            word[i] = i | (i ^ 0x8000u) << 16;
        status = run(vk, "probe_pack", GROUP, &count, sizeof count, WORDS / GROUP, word,
                     WORDS * sizeof *word, got, WORDS * sizeof *got, reason);
        for (uint32_t i = 0; i < WORDS && !status && pass == 0; i++) {
            judge_pack(&out->pack, word[i], got[i][0] & 0xFFFFu);
            if (got[i][0] >> 16 != (got[i][0] & 0xFFFFu)) /* both halves convert the same number */
                judge_pack(&out->pack, word[i], got[i][0] >> 16);
        }
        for (uint32_t i = 0; i < CODES && !status && pass == 1; i++) {
            judge_unpack(&out->unpack, i, got[i][1]);
            judge_unpack(&out->unpack, i ^ 0x8000u, got[i][2]);
        }
    }
    free(word);
    free(got);
    return status;
}

/* Uses one invocation per workgroup: lanes that run together may share a driver's loop count. */
static enum status measure_loops(struct vk *vk, struct card *out, struct reason *reason)
{
    const uint32_t push[2] = {LOOP_STEPS, LOOP_NESTED}, seed = 12345;
    uint32_t got[CARD_LOOPS][3] = {{0}};
    enum status status = run(vk, "probe_loop", 1, push, sizeof push, CARD_LOOPS, &seed, sizeof seed,
                             got, sizeof got, reason);
    out->loop = (struct card_loop){
        {LOOP_STEPS, 2 * LOOP_STEPS, LOOP_STEPS},
        {got[0][0], got[1][0] + got[1][1], got[2][1]},
    };
    return status;
}

enum status card_make(struct vk *vk, struct card *out, struct reason *reason)
{
    *out = (struct card){.limits = *vk_limits(vk)};
    struct triple *triple = alloc_zeroed(TRIPLES, sizeof *triple);
    if (!triple)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for a probe");
    make_triples(triple);
    enum status status = probe_run(vk, out->op, reason);
    if (!status)
        out->arithmetic = probe_arithmetic(out->op);
    if (!status)
        status = measure_functions(vk, triple, out, reason);
    if (!status)
        status = measure_freedom(vk, triple, out, reason);
    if (!status)
        status = measure_halves(vk, out, reason);
    if (!status)
        status = measure_loops(vk, out, reason);
    free(triple);
    return status;
}
