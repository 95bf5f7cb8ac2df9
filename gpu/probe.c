#include "gpu/probe.h"

#include "gpu/shaders.h"
#include "ref/rng.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRIPLES 16384u
#define GROUP   64u

/* A quarter of the triples has at least one special number. */
#define IS_SPECIAL(i) ((i) % 4 == 3)

static const char *const names[PROBE_OPS] = {"a+b", "a-b", "a*b", "a/b", "1/b", "a*b+c", "a<b?a:b"};

struct triple {
    float a, b, c;
};

static float ordinary(struct rng *rng)
{
    float x = ldexpf(1.0f + rng_float(rng), (int)rng_below(rng, 80) - 40);
    return rng_below(rng, 2) ? -x : x;
}

static float special(struct rng *rng)
{
    static const uint32_t bits[] = {0x00000000u, 0x80000000u, 0x00000001u, 0x807FFFFFu,
                                    0x00800000u, 0x7F7FFFFFu, 0xFF7FFFFFu, 0x7F800000u,
                                    0xFF800000u, 0x7FC00000u, 0x3F800000u, 0x00400000u};
    return float_from_bits(bits[rng_below(rng, ARRAY_COUNT(bits))]);
}

static void make_triples(struct triple *triple)
{
    struct rng rng = rng_make(1, 0);
    for (uint32_t i = 0; i < TRIPLES; i++) {
        triple[i] = (struct triple){ordinary(&rng), ordinary(&rng), ordinary(&rng)};
        if (!IS_SPECIAL(i))
            continue;
        triple[i].a = special(&rng);
        triple[i].b = rng_below(&rng, 2) ? special(&rng) : triple[i].b;
        triple[i].c = rng_below(&rng, 2) ? special(&rng) : triple[i].c;
    }
}

/* The same operations, compiled without contraction. */
static void evaluate(const struct triple *t, float out[PROBE_OPS])
{
    out[0] = t->a + t->b;
    out[1] = t->a - t->b;
    out[2] = t->a * t->b;
    out[3] = t->a / t->b;
    out[4] = 1.0f / t->b;
    out[5] = t->a * t->b + t->c;
    out[6] = t->a < t->b ? t->a : t->b;
}

/* Bit patterns in the order of the numbers. */
static int64_t ordered(float x)
{
    uint32_t bits = float_bits(x);
    return bits & 0x80000000u ? -(int64_t)(bits & 0x7FFFFFFFu) : (int64_t)bits;
}

static void judge(struct probe_op *op, bool is_special, float want, float got)
{
    bool same = float_bits(want) == float_bits(got) || (isnan(want) && isnan(got));
    if (is_special) {
        op->special++;
        op->special_differs += !same;
        return;
    }
    op->ordinary++;
    op->ordinary_differs += !same;
    int64_t apart = llabs(ordered(want) - ordered(got));
    if (apart > op->worst_ulp)
        op->worst_ulp = apart > UINT32_MAX ? UINT32_MAX : (uint32_t)apart;
}

static void compare(const struct triple *triple, const float *got, struct probe_op out[PROBE_OPS])
{
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        out[k] = (struct probe_op){.name = names[k]};
    for (uint32_t i = 0; i < TRIPLES; i++) {
        float want[PROBE_OPS];
        evaluate(triple + i, want);
        for (uint32_t k = 0; k < PROBE_OPS; k++)
            judge(out + k, IS_SPECIAL(i), want[k], got[PROBE_OPS * i + k]);
    }
}

static enum status dispatch(struct vk *vk, const struct triple *triple, float *got,
                            struct reason *reason)
{
    const struct shader *shader = shader_find("probe_ops");
    const uint64_t in_bytes = TRIPLES * sizeof *triple;
    const uint64_t out_bytes = TRIPLES * PROBE_OPS * sizeof *got;
    const uint32_t group = GROUP, count = TRIPLES;
    struct vk_shader make = {.name = shader->name,
                             .word = shader->word,
                             .word_count = shader->word_count,
                             .binding_count = 2,
                             .push_bytes = sizeof count,
                             .constant = &group,
                             .constant_count = 1};
    struct vk_pipeline *pipeline = NULL;
    struct vk_buffer *buffer[2] = {NULL, NULL};
    struct vk_time time;
    enum status status = vk_pipeline_make(vk, &make, &pipeline, reason);
    if (!status)
        status = vk_buffer_make(vk, in_bytes, &buffer[0], reason);
    if (!status)
        status = vk_buffer_make(vk, out_bytes, &buffer[1], reason);
    if (!status)
        status = vk_buffer_write(vk, buffer[0], 0, triple, in_bytes, reason);
    if (!status)
        status = vk_dispatch(vk, pipeline, buffer, &count, TRIPLES / GROUP, &time, reason);
    if (!status)
        status = vk_buffer_read(vk, buffer[1], 0, got, out_bytes, reason);
    vk_buffer_free(vk, buffer[0]);
    vk_buffer_free(vk, buffer[1]);
    vk_pipeline_free(vk, pipeline);
    return status;
}

enum status probe_run(struct vk *vk, struct probe_op out[PROBE_OPS], struct reason *reason)
{
    struct triple *triple = alloc_zeroed(TRIPLES, sizeof *triple);
    float *got = alloc_zeroed(TRIPLES, PROBE_OPS * sizeof *got);
    enum status status = STATUS_OK;
    memset(out, 0, PROBE_OPS * sizeof *out);
    if (!triple || !got) {
        status = fail(reason, STATUS_MEMORY, "vulkan: no memory for the operator probe");
    } else {
        make_triples(triple);
        status = dispatch(vk, triple, got, reason);
        if (!status)
            compare(triple, got, out);
    }
    free(triple);
    free(got);
    return status;
}

void probe_text(const struct probe_op op[PROBE_OPS], char *text, size_t text_bytes)
{
    size_t used = 0;
    const char *lead = "as in C to the bit:";
    text[0] = '\0';
    for (uint32_t k = 0; k < PROBE_OPS && used < text_bytes; k++)
        if (!op[k].ordinary_differs && !op[k].special_differs) {
            used += (size_t)snprintf(text + used, text_bytes - used, "%s %s", lead, op[k].name);
            lead = "";
        }
    if (used > 0 && used < text_bytes)
        used += (size_t)snprintf(text + used, text_bytes - used, "\n");
    for (uint32_t k = 0; k < PROBE_OPS && used < text_bytes; k++)
        if (op[k].ordinary_differs || op[k].special_differs)
            used += (size_t)snprintf(text + used, text_bytes - used,
                                     "%s: %u of %u differ, at most %u ulp; %u of %u with zeros, "
                                     "subnormals, infinities or NaN\n",
                                     op[k].name, (unsigned)op[k].ordinary_differs,
                                     (unsigned)op[k].ordinary, (unsigned)op[k].worst_ulp,
                                     (unsigned)op[k].special_differs, (unsigned)op[k].special);
}
