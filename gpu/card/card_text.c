/* A driver's card as text and as JSON. */
#include "gpu/card/card.h"

#include "ref/base/text.h"
#include "ref/base/json_record.h"

#include <math.h>
#include <string.h>

#define LABEL "%-22s "

static const char *nan_rule(const struct card_pair *pair)
{
    bool first = isnan(pair->first_nan), second = isnan(pair->second_nan);
    if (!first && !second)
        return "the number";
    if (first && second)
        return "NaN";
    return first ? "the first operand" : "the second operand";
}

static const char *zero_rule(const struct card_pair *pair)
{
    bool first = signbit(pair->minus_plus) != 0, second = signbit(pair->plus_minus) != 0;
    if (first == second)
        return first ? "-0" : "+0";
    return first ? "the first" : "the second";
}

static void choice_text(const char *label, const struct card_choice *choice, const char *other,
                        char *text, size_t text_bytes)
{
    text_append(text, text_bytes, LABEL, label);
    if (choice->plain == choice->telling)
        text_append(text, text_bytes, "as written, each operation rounded (%u of %u telling)\n",
                    choice->plain, choice->telling);
    else if (choice->other == choice->telling)
        text_append(text, text_bytes, "%s (%u of %u telling)\n", other, choice->other,
                    choice->telling);
    else
        text_append(text, text_bytes, "of %u telling %u as written, %u %s, %u neither\n",
                    choice->telling, choice->plain, choice->other, other, choice->neither);
}

static void root_text(const char *label, const struct card_root *root, char *text,
                      size_t text_bytes)
{
    text_append(text, text_bytes, LABEL "%u of %u differ from the nearest, at most %u ulp\n", label,
                root->differs, root->count, root->worst_ulp);
}

static void halves_text(const struct card *card, char *text, size_t text_bytes)
{
    const struct card_unpack *unpack = &card->unpack;
    const struct card_pack *pack = &card->pack;
    text_append(text, text_bytes,
                LABEL "zeros, normal, infinite, NaN: %u wrong; subnormal: %u kept, %u zero, %u "
                      "wrong\n",
                "unpackHalf2x16", unpack->wrong, unpack->kept, unpack->flushed,
                unpack->subnormal_wrong);
    text_append(text, text_bytes, LABEL "%u of %u are not the nearest half", "packHalf2x16",
                pack->differs, pack->count);
    if (pack->differs)
        text_append(text, text_bytes,
                    ": %u from 65520, %u below 2^-14, %u between; %u no neighbour; %a gives "
                    "%04x, nearest %04x",
                    pack->overflow, pack->tiny, pack->normal, pack->beyond, (double)pack->example,
                    pack->example_got, pack->example_nearest);
    text_append(text, text_bytes, "\n");
}

static bool loop_is_cut(const struct card_loop *loop)
{
    return memcmp(loop->asked, loop->ran, sizeof loop->ran) != 0;
}

static void loop_text(const struct card_loop *loop, char *text, size_t text_bytes)
{
    if (!loop_is_cut(loop)) {
        text_append(text, text_bytes, LABEL "run to their end (%u iterations)\n", "loops",
                    loop->asked[1]);
        return;
    }
    text_append(text, text_bytes,
                LABEL "ENDED EARLY, silently: %u of %u; two in turn %u of %u; nested %u of %u\n",
                "loops", loop->ran[0], loop->asked[0], loop->ran[1], loop->asked[1], loop->ran[2],
                loop->asked[2]);
}

void card_text(const struct card *card, char *text, size_t text_bytes)
{
    text[0] = '\0';
    probe_text(card->op, text, text_bytes);
    text_append(text, text_bytes, LABEL "%s\n", "subnormals",
                !card->arithmetic.flushes ? "kept"
                : card->arithmetic.bits   ? "become zeros"
                                          : "see above");
    root_text("sqrt", &card->sqrt, text, text_bytes);
    root_text("inversesqrt", &card->inversesqrt, text, text_bytes);
    text_append(text, text_bytes, LABEL "min gives %s, max %s\n", "with one NaN",
                nan_rule(&card->min), nan_rule(&card->max));
    text_append(text, text_bytes, LABEL "min gives %s, max %s\n", "of -0 and +0",
                zero_rule(&card->min), zero_rule(&card->max));
    choice_text("fma(a,b,c)", &card->fma, "fused", text, text_bytes);
    choice_text("a*b+c, if free", &card->contraction, "fused", text, text_bytes);
    choice_text("(a-b)*c, if free", &card->distribution, "as a*c-b*c", text, text_bytes);
    halves_text(card, text, text_bytes);
    loop_text(&card->loop, text, text_bytes);
    text_append(text, text_bytes, LABEL "%s\n", "the judge uses",
                probe_arithmetic_text(&card->arithmetic));
}

static json_t *choice_json(const struct card_choice *choice)
{
    return json_record("telling=%u as_written=%u other=%u neither=%u", choice->telling,
                       choice->plain, choice->other, choice->neither);
}

static json_t *root_json(const struct card_root *root)
{
    return json_record("count=%u differs=%u worst_ulp=%u", root->count, root->differs,
                       root->worst_ulp);
}

static json_t *pair_json(const struct card_pair *pair)
{
    return json_record("with_one_nan=%s of_zeros=%s", nan_rule(pair), zero_rule(pair));
}

static json_t *ops_json(const struct card *card)
{
    json_t *ops = json_array();
    for (uint32_t k = 0; k < PROBE_OPS && ops; k++) {
        const struct probe_op *op = &card->op[k];
        (void)json_array_append_new(
            ops, json_record("op=%s ordinary=%u ordinary_differs=%u worst_ulp=%u special=%u "
                             "special_differs=%u flushed=%u",
                             op->name, op->ordinary, op->ordinary_differs, op->worst_ulp,
                             op->special, op->special_differs, op->flushed));
    }
    return ops;
}

static json_t *halves_json(const struct card *card)
{
    const struct card_unpack *unpack = &card->unpack;
    const struct card_pack *pack = &card->pack;
    return json_record(
        "unpack=%p pack=%p",
        json_record("wrong=%u subnormal_kept=%u subnormal_zero=%u subnormal_wrong=%u",
                    unpack->wrong, unpack->kept, unpack->flushed, unpack->subnormal_wrong),
        json_record("count=%u not_nearest=%u no_neighbour=%u overflow=%u tiny=%u normal=%u",
                    pack->count, pack->differs, pack->beyond, pack->overflow, pack->tiny,
                    pack->normal));
}

static json_t *loop_json(const struct card_loop *loop)
{
    json_t *asked = json_array(), *ran = json_array();
    for (uint32_t i = 0; i < CARD_LOOPS; i++) {
        (void)json_array_append_new(asked, json_integer((json_int_t)loop->asked[i]));
        (void)json_array_append_new(ran, json_integer((json_int_t)loop->ran[i]));
    }
    return json_record("ended_early=%i asked=%p ran=%p", loop_is_cut(loop), asked, ran);
}

static json_t *arithmetic_json(const struct arithmetic *a)
{
    return json_record("bits=%i flushes=%i add_u=%g mul_u=%g div_u=%g", a->bits, a->flushes,
                       a->rounding.add, a->rounding.mul, a->rounding.div);
}

json_t *card_json(const struct card *card)
{
    return json_record("device=%s driver=%s judge=%p ops=%p sqrt=%p inversesqrt=%p min=%p max=%p "
                       "fma=%p free_mul_add=%p free_distribution=%p half=%p loops=%p",
                       card->limits.device, card->limits.driver, arithmetic_json(&card->arithmetic),
                       ops_json(card), root_json(&card->sqrt), root_json(&card->inversesqrt),
                       pair_json(&card->min), pair_json(&card->max), choice_json(&card->fma),
                       choice_json(&card->contraction), choice_json(&card->distribution),
                       halves_json(card), loop_json(&card->loop));
}
