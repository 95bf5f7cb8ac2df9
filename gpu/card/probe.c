#include "gpu/card/probe.h"

#include "gpu/card/probe_once.h"
#include "ref/base/text.h"
#include "ref/base/rng.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TRIPLES PROBE_TRIPLES
#define GROUP   64u

/* A quarter of the triples contain at least one special number. */
#define IS_SPECIAL(i) ((i) % 4 == 3)

static const char *const names[PROBE_OPS] = {"a+b", "a-b", "a*b", "a/b", "1/b", "a*b+c", "a<b?a:b"};

static float ordinary(struct rng *rng)
{
    float x = rng_scaled(rng, 1, 2, -40, 80);
    return rng_below(rng, 2) ? -x : x;
}

static float special(struct rng *rng)
{
    static const uint32_t bits[] = {0x00000000u, 0x80000000u, 0x00000001u, 0x807FFFFFu,
                                    0x00800000u, 0x7F7FFFFFu, 0xFF7FFFFFu, 0x7F800000u,
                                    0xFF800000u, 0x7FC00000u, 0x3F800000u, 0x00400000u};
    return float_from_bits(bits[rng_below(rng, ARRAY_COUNT(bits))]);
}

bool probe_is_ordinary(uint32_t i)
{
    return !IS_SPECIAL(i);
}

void probe_triples(struct probe_triple *triple)
{
    struct rng rng = rng_make(1, 0);
    for (uint32_t i = 0; i < TRIPLES; i++) {
        const float a = ordinary(&rng), b = ordinary(&rng), c = ordinary(&rng); /* in this order */
        triple[i] = (struct probe_triple){a, b, c};
        if (!IS_SPECIAL(i))
            continue;
        triple[i].a = special(&rng);
        triple[i].b = rng_below(&rng, 2) ? special(&rng) : triple[i].b;
        triple[i].c = rng_below(&rng, 2) ? special(&rng) : triple[i].c;
    }
}

/* Whether subnormal operands (in) and results (out) are flushed to zero. */
struct flush {
    bool in, out;
};

static const struct flush flushes[] = {{true, false}, {false, true}, {true, true}};

static float zero_if(bool flush, float x)
{
    bool subnormal = (float_bits(x) & 0x7F800000u) == 0;
    return flush && subnormal ? float_from_bits(float_bits(x) & 0x80000000u) : x;
}

/* The operations in C, compiled without contraction. */
static void evaluate(const struct probe_triple *t, struct flush flush, float out[PROBE_OPS])
{
    const float a = zero_if(flush.in, t->a), b = zero_if(flush.in, t->b);
    const float c = zero_if(flush.in, t->c);
    float product = zero_if(flush.in || flush.out, a * b);
    out[PROBE_ADD] = a + b;
    out[PROBE_SUB] = a - b;
    out[PROBE_MUL] = a * b;
    out[PROBE_DIV] = a / b;
    out[PROBE_RECIPROCAL] = 1.0f / b;
    out[PROBE_MUL_ADD] = product + c;
    out[PROBE_LESS] = a < b ? t->a : t->b;
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        out[k] = zero_if(flush.out, out[k]);
}

/* Maps a float's bits to an integer that is ordered like the numbers. */
static int64_t ordered(float x)
{
    uint32_t bits = float_bits(x);
    return bits & 0x80000000u ? -(int64_t)(bits & 0x7FFFFFFFu) : (int64_t)bits;
}

static bool is_same(float want, float got)
{
    return float_bits(want) == float_bits(got) || (isnan(want) && isnan(got));
}

static void judge_ordinary(struct probe_op *op, float want, float got)
{
    op->ordinary++;
    op->ordinary_differs += !is_same(want, got);
    int64_t apart = llabs(ordered(want) - ordered(got));
    if (apart > op->worst_ulp)
        op->worst_ulp = apart > UINT32_MAX ? UINT32_MAX : (uint32_t)apart;
}

/* Returns true if flushing explains the result. A flushed subnormal may have either sign. */
static bool is_flushed(const struct probe_triple *t, uint32_t op, float got)
{
    for (size_t i = 0; i < ARRAY_COUNT(flushes); i++) {
        float want[PROBE_OPS];
        evaluate(t, flushes[i], want);
        if (is_same(want[op], got) || (want[op] == 0 && got == 0))
            return true;
    }
    return false;
}

void probe_compare(const struct probe_triple *triple, const float *got,
                   struct probe_op out[PROBE_OPS])
{
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        out[k] = (struct probe_op){.name = names[k]};
    for (uint32_t i = 0; i < TRIPLES; i++) {
        float want[PROBE_OPS];
        evaluate(triple + i, (struct flush){false, false}, want);
        for (uint32_t k = 0; k < PROBE_OPS; k++) {
            float x = got[PROBE_OPS * i + k];
            if (!IS_SPECIAL(i)) {
                judge_ordinary(out + k, want[k], x);
                continue;
            }
            out[k].special++;
            if (!is_same(want[k], x)) {
                out[k].special_differs++;
                out[k].flushed += is_flushed(triple + i, k, x);
            }
        }
    }
}

enum status probe_run_shader(struct vk *vk, const struct shader *shader,
                             struct probe_op out[PROBE_OPS], struct reason *reason)
{
    struct probe_triple *triple = alloc_zeroed(TRIPLES, sizeof *triple);
    float *got = alloc_zeroed(TRIPLES, PROBE_OPS * sizeof *got);
    enum status status = STATUS_OK;
    memset(out, 0, PROBE_OPS * sizeof *out);
    if (!triple || !got) {
        status = fail(reason, STATUS_MEMORY, "vulkan: no memory for the operator probe");
    } else {
        probe_triples(triple);
        const uint32_t count = TRIPLES;
        const struct probe_job job = {.shader = shader,
                                      .group = GROUP,
                                      .groups = TRIPLES / GROUP,
                                      .push = &count,
                                      .push_bytes = sizeof count,
                                      .in = triple,
                                      .in_bytes = TRIPLES * sizeof *triple,
                                      .out = got,
                                      .out_bytes = TRIPLES * PROBE_OPS * sizeof *got};
        status = probe_once(vk, &job, reason);
        if (!status)
            probe_compare(triple, got, out);
    }
    free(triple);
    free(got);
    return status;
}

enum status probe_run(struct vk *vk, struct probe_op out[PROBE_OPS], struct reason *reason)
{
    return probe_run_shader(vk, shader_find("probe_ops"), out, reason);
}

/* An operation's error in units of u; half an ulp is 1. */
static double error_of(const struct probe_op *op, double specified)
{
    double seen = 2.0 * op->worst_ulp + 1.0;
    if (!op->ordinary_differs)
        return 1.0;
    return seen > specified ? seen : specified;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

struct arithmetic probe_arithmetic(const struct probe_op op[PROBE_OPS])
{
    const struct rounding spec = ROUNDING_VULKAN;
    struct arithmetic out = {.rounding = ROUNDING_IEEE, .bits = true};
    for (uint32_t k = 0; k < PROBE_OPS; k++) {
        out.bits = out.bits && !op[k].ordinary_differs && op[k].flushed == op[k].special_differs;
        out.flushes = out.flushes || op[k].special_differs;
    }
    if (out.flushes)
        out.rounding.tiny = spec.tiny;
    if (out.bits)
        return out;
    out.rounding.add =
        larger(error_of(&op[PROBE_ADD], spec.add), error_of(&op[PROBE_SUB], spec.add));
    out.rounding.mul = error_of(&op[PROBE_MUL], spec.mul);
    out.rounding.div =
        larger(error_of(&op[PROBE_DIV], spec.div), error_of(&op[PROBE_RECIPROCAL], spec.div));
    return out;
}

struct arithmetic probe_measure(struct vk *vk)
{
    struct probe_op op[PROBE_OPS];
    if (probe_run(vk, op, NULL))
        return (struct arithmetic){.rounding = ROUNDING_VULKAN, .flushes = true};
    return probe_arithmetic(op);
}

const char *probe_arithmetic_text(const struct arithmetic *arithmetic)
{
    if (arithmetic->bits && !arithmetic->flushes)
        return "IEEE; C's bits are demanded";
    if (arithmetic->bits)
        return "IEEE with subnormals as zeros; C's bits are demanded";
    return "measured errors or Vulkan's promises; C's bits are not demanded";
}

void probe_text(const struct probe_op op[PROBE_OPS], char *text, size_t text_bytes)
{
    const char *lead = "as in C to the bit:";
    text[0] = '\0';
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        if (!op[k].ordinary_differs && !op[k].special_differs) {
            text_append(text, text_bytes, "%s %s", lead, op[k].name);
            lead = "";
        }
    if (text[0])
        text_append(text, text_bytes, "\n");
    lead = "as in C but for subnormals, which are zeros:";
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        if (!op[k].ordinary_differs && op[k].special_differs &&
            op[k].flushed == op[k].special_differs) {
            text_append(text, text_bytes, "%s %s (%u of %u)", lead, op[k].name, op[k].flushed,
                        op[k].special);
            lead = "";
        }
    if (!lead[0])
        text_append(text, text_bytes, "\n");
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        if (op[k].ordinary_differs || op[k].special_differs > op[k].flushed)
            text_append(text, text_bytes,
                        "%s: %u of %u differ, at most %u ulp; %u of %u with zeros, subnormals, "
                        "infinities or NaN, %u of them by flushing\n",
                        op[k].name, op[k].ordinary_differs, op[k].ordinary, op[k].worst_ulp,
                        op[k].special_differs, op[k].special, op[k].flushed);
}
