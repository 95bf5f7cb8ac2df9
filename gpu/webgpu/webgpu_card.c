#include "gpu/webgpu/webgpu_card.h"

#include "gpu/webgpu/webgpu_peer.h"
#include "gpu/webgpu/webgpu_text.h"
#include "ref/base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void choose(struct webgpu_choice *choice, float plain, float other, float got)
{
    if (float_bits(plain) == float_bits(other))
        return;
    choice->telling++;
    choice->plain += float_bits(got) == float_bits(plain);
    choice->other += float_bits(got) == float_bits(other);
    choice->neither += float_bits(got) != float_bits(plain) && float_bits(got) != float_bits(other);
}

void webgpu_card_of(const struct probe_triple *triple, const float *got, struct webgpu_card *out)
{
    float *own = alloc_zeroed(PROBE_TRIPLES, PROBE_OPS * sizeof *own);
    for (uint32_t i = 0; own && i < PROBE_TRIPLES; i++) {
        const struct probe_triple *t = &triple[i];
        const float *free_form = got + WEBGPU_PROBED * i + PROBE_OPS;
        memcpy(own + PROBE_OPS * i, got + WEBGPU_PROBED * i, PROBE_OPS * sizeof *own);
        if (!probe_is_ordinary(i))
            continue;
        const float product = t->a * t->b, difference = t->a - t->b, sum = t->a + t->b;
        const float ac = t->a * t->c, bc = t->b * t->c, right = t->b + t->c;
        choose(&out->contraction, product + t->c, fmaf(t->a, t->b, t->c), free_form[0]);
        choose(&out->distribution, difference * t->c, ac - bc, free_form[1]);
        choose(&out->reassociation, sum + t->c, t->a + right, free_form[2]);
    }
    if (own)
        probe_compare(triple, own, out->op);
    out->arithmetic = probe_arithmetic(out->op);
    free(own);
}

static enum status measure(struct webgpu_peer *peer, struct webgpu_card *out, struct reason *reason)
{
    struct webgpu_program program = {.into_words = 3, .out_words = WEBGPU_PROBED};
    struct probe_triple *triple = alloc_zeroed(PROBE_TRIPLES, sizeof *triple);
    float *got = alloc_zeroed(PROBE_TRIPLES, WEBGPU_PROBED * sizeof *got);
    char *text = NULL;
    enum status status = triple && got
                             ? webgpu_probe_text(&text, reason)
                             : fail(reason, STATUS_MEMORY, "webgpu: no memory for a probe");
    program.text = text;
    if (!status)
        status = webgpu_give(peer, &program, reason);
    if (!status) {
        probe_triples(triple);
        status = webgpu_run(peer, 0, PROBE_TRIPLES, triple, got, reason);
    }
    if (!status)
        webgpu_card_of(triple, got, out);
    free(text);
    free(triple);
    free(got);
    return status;
}

enum status webgpu_card_make(const struct engine_options *options, struct webgpu_card *out,
                             struct reason *reason)
{
    struct webgpu_peer peer;
    *out = (struct webgpu_card){.device = ""};
    enum status status = webgpu_start(options, &peer, reason);
    if (status)
        return status;
    status = measure(&peer, out, reason);
    webgpu_stop(&peer);
    return status;
}

static void choice_text(const char *what, const struct webgpu_choice *choice, const char *other,
                        char *text, size_t text_bytes)
{
    if (choice->plain == choice->telling)
        text_append(text, text_bytes, "%s without a fence: as written, %u of %u\n", what,
                    choice->plain, choice->telling);
    else
        text_append(text, text_bytes,
                    "%s without a fence: as written %u, %s %u, neither %u of %u\n", what,
                    choice->plain, other, choice->other, choice->neither, choice->telling);
}

void webgpu_card_text(const struct webgpu_card *card, char *text, size_t text_bytes)
{
    char ops[2048];
    probe_text(card->op, ops, sizeof ops);
    text_append(text, text_bytes, "between fences: %s", ops);
    choice_text("a*b+c", &card->contraction, "fused", text, text_bytes);
    choice_text("(a-b)*c", &card->distribution, "as a*c-b*c", text, text_bytes);
    choice_text("(a+b)+c", &card->reassociation, "as a+(b+c)", text, text_bytes);
    text_append(text, text_bytes, "the judge uses WGSL's bounds; C's bits are not demanded\n");
}
