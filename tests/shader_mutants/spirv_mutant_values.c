/* Mutants of literals, indices and conversions. */
#include "tests/shader_mutants/spirv_mutant.h"

#include <stdio.h>
#include <string.h>

enum {
    OP_VECTOR_SHUFFLE = 79,
    OP_COMPOSITE_CONSTRUCT_OF = 80,
    OP_COMPOSITE_INSERT = 82,
    OP_CONVERT_F_TO_U = 109,
    OP_CONVERT_F_TO_S,
    OP_CONVERT_S_TO_F,
    OP_CONVERT_U_TO_F,
    OP_CONSTANT_COMPOSITE = 44,
    OP_RETURN_VALUE = 254,
    FIRST_VALUE = 124, /* OpBitcast */
    LAST_VALUE = 205,  /* OpBitCount */
};

/* The first operand that may be a constant which is computed with; 0: there is none. */
static uint32_t first_value(uint32_t op)
{
    switch (op) {
    case OP_SPEC_CONSTANT_OP:
    case OP_FUNCTION_CALL:
        return 4;
    case OP_EXT_INST:
        return 5;
    case OP_STORE:
        return 2;
    case OP_RETURN_VALUE:
        return 1;
    case OP_COMPOSITE_CONSTRUCT_OF:
    case OP_CONSTANT_COMPOSITE:
        return 3;
    default:
        return op >= FIRST_VALUE && op <= LAST_VALUE ? 3 : 0;
    }
}

/* Makes operand k another constant. */
static void use(struct mutant_look *look, enum mutant_kind kind, size_t at, uint32_t k,
                uint32_t value, const char *what)
{
    struct spirv_mutant m = mutant_of(look, kind, at);
    const uint32_t *constant = mutant_maker(look, m.word[k]);
    const uint32_t made[] = {4u << 16 | OP_CONSTANT, constant[1], look->bound, value};
    char name[SPIRV_SAY_MOST];
    spirv_say_name(m.word, name);
    if (at < look->functions) {
        memcpy(m.before, made, sizeof made);
        m.before_count = 4;
    } else {
        memcpy(m.constant, made, sizeof made);
        m.constant_count = 4;
    }
    m.ids = 1;
    m.word[k] = look->bound;
    mutant_add(look, &m, "operand %u of %.40s: 0x%X became 0x%X, %s", k - spirv_operands(m.word),
               name, constant[3], value, what);
}

static const uint32_t *number_of(const struct mutant_look *look, uint32_t id)
{
    const uint32_t *word = mutant_maker(look, id);
    return word && (word[0] & 0xFFFFu) == OP_CONSTANT && word[0] >> 16 == 4 ? word : NULL;
}

static void literal(struct mutant_look *look, size_t at, uint32_t k)
{
    const uint32_t *word = number_of(look, spirv_words(look->code, at)[k]);
    const uint32_t type = word ? mutant_op(look, word[1]) : 0, value = word ? word[3] : 0;
    const uint32_t exponent = value >> 23 & 0xFFu;
    if (type == OP_TYPE_INT) {
        use(look, MUTANT_LITERAL, at, k, value + 1, "one more");
        if (value != 0)
            use(look, MUTANT_LITERAL, at, k, value - 1, "one less");
        if (value >= 3 && (value & (value + 1)) == 0 && value != UINT32_MAX)
            use(look, MUTANT_LITERAL, at, k, 2 * value + 1, "widened");
    } else if (type == OP_TYPE_FLOAT) {
        use(look, MUTANT_LITERAL, at, k, value + 1, "an ulp more");
        if (exponent > 0 && exponent < 0xFEu)
            use(look, MUTANT_LITERAL, at, k, value + (1u << 23), "twice");
    }
}

/* A constant index of an access chain. */
static void index_by_constant(struct mutant_look *look, size_t at, uint32_t k)
{
    const uint32_t *word = number_of(look, spirv_words(look->code, at)[k]);
    if (!word || mutant_op(look, word[1]) != OP_TYPE_INT)
        return;
    use(look, MUTANT_INDEX, at, k, word[3] + 1, "the next");
    if (word[3] > 0)
        use(look, MUTANT_INDEX, at, k, word[3] - 1, "the one before");
}

/* Number k of an instruction that has indices as numbers. */
static void index_by_number(struct mutant_look *look, size_t at, uint32_t k)
{
    for (int step = -1; step <= 1; step += 2) {
        struct spirv_mutant m = mutant_of(look, MUTANT_INDEX, at);
        char name[SPIRV_SAY_MOST];
        if (m.count > MUTANT_WORDS || (step < 0 && m.word[k] == 0))
            continue;
        spirv_say_name(m.word, name);
        m.word[k] += (uint32_t)step;
        mutant_add(look, &m, "index %u of %.40s became %u", m.word[k] - (uint32_t)step, name,
                   m.word[k]);
    }
}

static bool is_float(const struct mutant_look *look, uint32_t type)
{
    const uint32_t *word = mutant_maker(look, type);
    if (word && (word[0] & 0xFFFFu) == OP_TYPE_VECTOR)
        word = mutant_maker(look, word[2]);
    return word && (word[0] & 0xFFFFu) == OP_TYPE_FLOAT;
}

static void convert(struct mutant_look *look, size_t at)
{
    struct spirv_mutant m = mutant_of(look, MUTANT_CONVERSION, at);
    const uint32_t op = m.word[0] & 0xFFFFu;
    uint32_t to = 0;
    char from[SPIRV_SAY_MOST], name[SPIRV_SAY_MOST];
    if (op == OP_BITCAST) {
        const uint32_t *operand = mutant_maker(look, m.word[3]);
        const bool result = is_float(look, m.word[1]);
        if (operand && result != is_float(look, operand[1]))
            to = result ? OP_CONVERT_U_TO_F : OP_CONVERT_F_TO_U;
    } else if (op >= OP_CONVERT_F_TO_U && op <= OP_CONVERT_U_TO_F) {
        static const uint32_t other[] = {OP_CONVERT_F_TO_S, OP_CONVERT_F_TO_U, OP_CONVERT_U_TO_F,
                                         OP_CONVERT_S_TO_F};
        to = other[op - OP_CONVERT_F_TO_U];
    }
    if (!to)
        return;
    spirv_say_name(m.word, from);
    m.word[0] = (m.word[0] & 0xFFFF0000u) | to;
    spirv_say_name(m.word, name);
    mutant_add(look, &m, "%.40s became %.40s", from, name);
}

void mutant_values(struct mutant_look *look, size_t at)
{
    const uint32_t op = spirv_op(look->code, at), length = (uint32_t)spirv_length(look->code, at);
    const uint32_t first = first_value(op);
    if (length > MUTANT_WORDS)
        return;
    for (uint32_t k = first; first && k < length; k++)
        literal(look, at, k);
    for (uint32_t k = 4; (op == OP_ACCESS_CHAIN || op == OP_IN_BOUNDS_ACCESS_CHAIN) && k < length;
         k++)
        index_by_constant(look, at, k);
    const uint32_t numbers = op == OP_COMPOSITE_EXTRACT                             ? 4
                             : op == OP_VECTOR_SHUFFLE || op == OP_COMPOSITE_INSERT ? 5
                                                                                    : length;
    for (uint32_t k = numbers; k < length; k++)
        index_by_number(look, at, k);
    convert(look, at);
}
