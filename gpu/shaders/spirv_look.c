#include "gpu/shaders/spirv_look.h"

#include "gpu/shaders/spirv_words.h"

#include <stdlib.h>

enum {
    OP_FIRST_ARITHMETIC = 126, /* OpSNegate */
    OP_FIRST_SUM = 144,        /* OpVectorTimesMatrix; OpOuterProduct is in the range, but no sum */
    OP_LAST_SUM = 148,         /* OpDot */
    OP_LAST_ARITHMETIC = 152,  /* OpSMulExtended */
    UNPACK_HALF = 62,
    CAPABILITY_SHADER = 1,
};

/* Marks of an id. */
enum { IS_FLOAT = 1, IS_PINNED = 2 };

/* An instruction. Words beyond its end and ids beyond the module's bound are read as 0. */
struct look_instruction {
    const uint32_t *word;
    uint32_t op, count;
};

static uint32_t word_at(const struct look_instruction *i, uint32_t at)
{
    return at < i->count ? i->word[at] : 0;
}

static uint32_t id_at(const struct look_instruction *i, uint32_t at, uint32_t bound)
{
    uint32_t id = word_at(i, at);
    return id < bound ? id : 0;
}

static void mark(const struct look_instruction *i, uint8_t *id, uint32_t bound)
{
    if (i->op == OP_TYPE_FLOAT ||
        ((i->op == OP_TYPE_VECTOR || i->op == OP_TYPE_MATRIX) && id[id_at(i, 2, bound)] & IS_FLOAT))
        id[id_at(i, 1, bound)] |= IS_FLOAT;
    if (i->op == OP_DECORATE && i->count == 3 && i->word[2] == NO_CONTRACTION)
        id[id_at(i, 1, bound)] |= IS_PINNED;
}

/* Instructions whose result is a float32 for every operand, so that nothing is rounded. */
static bool is_exact(uint32_t extended)
{
    static const uint32_t exact[] = {2 /* RoundEven */, 3 /* Trunc */, 4 /* FAbs */, 6 /* FSign */,
                                     8 /* Floor */,     9 /* Ceil */,  UNPACK_HALF};
    for (size_t i = 0; i < ARRAY_COUNT(exact); i++)
        if (exact[i] == extended)
            return true;
    return false;
}

static void judge(const struct look_instruction *i, const uint8_t *id, uint32_t bound,
                  struct spirv_found *out)
{
    if (i->op >= OP_FIRST_ARITHMETIC && i->op <= OP_LAST_ARITHMETIC &&
        id[id_at(i, 1, bound)] & IS_FLOAT) {
        out->float_ops++;
        const bool bare = !(id[id_at(i, 2, bound)] & IS_PINNED);
        out->bare += bare;
        out->bare_signs += bare && i->op == OP_FNEGATE;
        out->sums += i->op >= OP_FIRST_SUM && i->op <= OP_LAST_SUM && i->op != OP_OUTER_PRODUCT;
    }
    if (i->op == OP_EXT_INST) {
        out->inexact_ext += word_at(i, 4) != UNPACK_HALF;
        out->open_ext += id[id_at(i, 1, bound)] & IS_FLOAT && !is_exact(word_at(i, 4));
    }
    if (i->op == OP_CAPABILITY)
        out->other_capabilities += word_at(i, 1) != CAPABILITY_SHADER;
}

enum status spirv_look(const uint32_t *word, uint32_t count, struct spirv_found *out,
                       struct reason *reason)
{
    *out = (struct spirv_found){0};
    if (count < SPIRV_HEADER_WORDS || word[0] != SPIRV_MAGIC || word[3] == 0 ||
        word[3] > SPIRV_BOUND_MOST)
        return fail(reason, STATUS_INPUT, "no SPIR-V module");
    const uint32_t bound = word[3];
    uint8_t *id = alloc_zeroed(bound, 1);
    if (!id)
        return fail(reason, STATUS_MEMORY, "no memory for %u SPIR-V ids", bound);
    enum status status = STATUS_OK;
    for (int pass = 0; pass < 2 && !status; pass++) /* decorations precede their ids */
        for (uint32_t at = SPIRV_HEADER_WORDS; at < count && !status;) {
            struct look_instruction i = {word + at, word[at] & 0xFFFFu, word[at] >> 16};
            if (i.count == 0 || i.count > count - at)
                status = fail(reason, STATUS_INPUT, "word %u: no SPIR-V instruction", at);
            else if (pass == 0)
                mark(&i, id, bound);
            else
                judge(&i, id, bound, out);
            at += i.count;
        }
    free(id);
    return status;
}

enum status spirv_check_tracing(struct reason *reason)
{
    for (const struct shader *shader = shaders; shader->name; shader++) {
        struct spirv_found found;
        if (!shader->tracing)
            continue;
        enum status status = spirv_look(shader->word, shader->word_count, &found, reason);
        if (status)
            return status;
        if (found.bare)
            return fail(reason, STATUS_INTERNAL,
                        "shader %s: %u of %u float operations without NoContraction", shader->name,
                        found.bare, found.float_ops);
    }
    return STATUS_OK;
}
