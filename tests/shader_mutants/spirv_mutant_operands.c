/* Mutants of operands, and contractions. */
#include "tests/shader_mutants/spirv_mutant.h"

#include <stdio.h>
#include <string.h>

enum {
    OP_COMPOSITE_CONSTRUCT = 80,
    OP_FCONVERT = 115,
    OP_FSUB = 131,
    OP_FMUL = 133,
    OP_ANY = 154,
    OP_ALL
};

/* --- operands --------------------------------------------------------------------------------- */

static uint32_t type_of(const struct mutant_look *look, uint32_t id)
{
    const uint32_t *word = mutant_maker(look, id);
    return word && spirv_operands(word) == 3 ? word[1] : 0;
}

static bool commutes(uint32_t op)
{
    static const uint16_t ops[] = {128, 129, 132, 133, 147, 148, 149, 164, 165, 166,
                                   167, 170, 171, 180, 181, 182, 183, 197, 198, 199};
    for (size_t i = 0; i < ARRAY_COUNT(ops); i++)
        if (ops[i] == op)
            return true;
    return op < 126 || op > 205;
}

/* Comparisons are in their own table: there > is < with its operands swapped. */
static bool swaps(uint32_t op)
{
    return (!commutes(op) && !(op >= 170 && op <= 191)) || op == OP_COMPOSITE_CONSTRUCT ||
           op == OP_FUNCTION_CALL;
}

/* Whether operands may be swapped all the same: arguments of both(), which is And, of tri_sum(),
 * whose products commute; a vector of which Any or All is taken at once. */
static bool may_be_swapped(const struct mutant_look *look, size_t at)
{
    const uint32_t *word = spirv_words(look->code, at);
    const uint32_t op = spirv_op(look->code, at);
    char name[SPIRV_SAY_MOST] = "";
    if (op == OP_FUNCTION_CALL)
        spirv_function(look->code, look->maker[word[3]], name);
    const uint32_t *next = at + 1 < look->code->count ? spirv_words(look->code, at + 1) : word;
    const uint32_t taken = next[0] & 0xFFFFu;
    return strcmp(name, "both") == 0 || strcmp(name, "tri_sum") == 0 ||
           (op == OP_COMPOSITE_CONSTRUCT && (taken == OP_ANY || taken == OP_ALL) &&
            next[3] == word[2]);
}

void mutant_swap_operands(struct mutant_look *look, size_t at)
{
    const uint32_t op = spirv_op(look->code, at);
    const uint32_t *word = spirv_words(look->code, at);
    const uint32_t first = op == OP_FUNCTION_CALL || op == OP_SELECT ? 4 : 3;
    if (!swaps(op) || may_be_swapped(look, at))
        return;
    for (uint32_t k = first; k + 1 < spirv_length(look->code, at); k++) {
        struct spirv_mutant m = mutant_of(look, MUTANT_OPERANDS, at);
        char name[SPIRV_SAY_MOST];
        if (m.count > MUTANT_WORDS || word[k] == word[k + 1] ||
            type_of(look, word[k]) != type_of(look, word[k + 1]))
            continue;
        m.word[k] = word[k + 1];
        m.word[k + 1] = word[k];
        spirv_say_name(word, name);
        mutant_add(look, &m, "operands %u and %u of %.40s are swapped", k - first, k - first + 1,
                   name);
    }
}

/* --- contraction ------------------------------------------------------------------------------ */

/* What an id is once loads of a variable that is stored to once are seen through. */
static uint32_t value_of(const struct mutant_look *look, size_t at, uint32_t id)
{
    const uint32_t *load = mutant_maker(look, id);
    uint32_t value = id, stores = 0;
    if (!load || (load[0] & 0xFFFFu) != OP_LOAD || mutant_op(look, load[3]) != OP_VARIABLE)
        return id;
    for (size_t i = at; i-- > look->maker[load[3]];) {
        const uint32_t *word = spirv_words(look->code, i);
        if (spirv_op(look->code, i) == OP_STORE && word[1] == load[3]) {
            value = word[2];
            stores++;
        }
    }
    return stores == 1 ? value : id;
}

static void put_before(struct spirv_mutant *m, const uint32_t *word)
{
    memcpy(m->before + m->before_count, word, (word[0] >> 16) * sizeof *word);
    m->before_count += word[0] >> 16;
}

/* The number of components of a type of floats; 0: it is another. */
static uint32_t components(const struct mutant_look *look, uint32_t type)
{
    const uint32_t *word = mutant_maker(look, type);
    const uint32_t op = word ? word[0] & 0xFFFFu : 0;
    return op == OP_TYPE_FLOAT ? 1 : op == OP_TYPE_VECTOR ? word[3] : 0;
}

/* A sum of a product, which a driver may round once. Software drivers compute Fma with two
 * roundings, so it is computed in doubles: the product is exact there. */
void mutant_contract(struct mutant_look *look, size_t at)
{
    const uint32_t *word = spirv_words(look->code, at);
    const uint32_t op = spirv_op(look->code, at), first = look->bound;
    for (uint32_t side = 0; side < 2; side++) {
        const uint32_t *product = mutant_maker(look, value_of(look, at, word[3 + side]));
        struct spirv_mutant m = mutant_of(look, MUTANT_CONTRACTION, at);
        const uint32_t size = components(look, word[1]), type = size > 1 ? first + 1 : first;
        if (!product || (product[0] & 0xFFFFu) != OP_FMUL || size == 0)
            continue;
        const uint32_t types[] = {
            3u << 16 | OP_TYPE_FLOAT, first, 64, 4u << 16 | OP_TYPE_VECTOR, first + 1, first, size};
        const uint32_t from[] = {product[3], product[4], word[4 - side]};
        m.constant_count = size > 1 ? 7 : 3;
        memcpy(m.constant, types, m.constant_count * sizeof *types);
        for (uint32_t k = 0; k < 3; k++)
            put_before(&m,
                       (const uint32_t[]){4u << 16 | OP_FCONVERT, type, first + 2 + k, from[k]});
        put_before(&m,
                   (const uint32_t[]){5u << 16 | OP_FMUL, type, first + 5, first + 2, first + 3});
        put_before(&m,
                   (const uint32_t[]){5u << 16 | op, type, first + 6, side ? first + 4 : first + 5,
                                      side ? first + 5 : first + 4});
        m.word[0] = 4u << 16 | OP_FCONVERT;
        m.word[3] = first + 6;
        m.count = 4;
        m.ids = 7;
        m.doubles = true;
        mutant_add(look, &m, "%s and operand %u, OpFMul, are rounded once",
                   op == OP_FSUB ? "OpFSub" : "OpFAdd", side);
    }
}
