#include "tests/shader_mutants/spirv_mutant.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BOUND   3u  /* word of the header */
#define FLOAT64 10u /* a capability */

const char *const mutant_kind_names[MUTANT_KINDS + 1] = {
    "decoration", "contraction", "operands", "comparison", "literal", "operation",
    "store",      "branch",      "index",    "conversion", "barrier", NULL};

enum {
    OP_CONTROL_BARRIER = 224,
    OP_MEMORY_BARRIER = 225,
    OP_BRANCH_CONDITIONAL = 250,
    OP_FADD_OF = 129,
    OP_FSUB_OF = 131,
};

const uint32_t *mutant_maker(const struct mutant_look *look, uint32_t id)
{
    return id < look->bound && look->maker[id] != SIZE_MAX
               ? spirv_words(look->code, look->maker[id])
               : NULL;
}

uint32_t mutant_op(const struct mutant_look *look, uint32_t id)
{
    const uint32_t *word = mutant_maker(look, id);
    return word ? word[0] & 0xFFFFu : 0;
}

struct spirv_mutant mutant_of(const struct mutant_look *look, enum mutant_kind kind, size_t at)
{
    struct spirv_mutant m = {
        .kind = kind, .at = at, .count = (uint32_t)spirv_length(look->code, at)};
    if (m.count <= MUTANT_WORDS)
        memcpy(m.word, spirv_words(look->code, at), m.count * sizeof *m.word);
    return m;
}

void mutant_add(struct mutant_look *look, struct spirv_mutant *m, const char *format, ...)
{
    struct spirv_mutants *out = look->out;
    va_list values;
    if (m->count > MUTANT_WORDS || look->status)
        return;
    va_start(values, format);
    vsnprintf(m->text, sizeof m->text, format, values);
    va_end(values);
    strcpy(m->function, look->function);
    for (size_t i = out->count; i-- > 0;)
        if (out->one[i].kind == m->kind && strcmp(out->one[i].function, m->function) == 0) {
            m->number = out->one[i].number + 1;
            break;
        }
    look->status = array_reserve(&out->one, &out->capacity, out->count + 1, sizeof *m);
    if (!look->status)
        out->one[out->count++] = *m;
}

void spirv_mutant_name(const struct spirv_mutant *m, char text[MUTANT_TEXT])
{
    snprintf(text, MUTANT_TEXT, "%s.%s.%u", m->function, mutant_kind_names[m->kind], m->number);
}

/* --- one instruction in place of another ------------------------------------------------------ */

/* An opcode and what it becomes. */
struct becomes {
    uint16_t from, to;
};

static const struct becomes comparisons[] = {
    {164, 165}, {165, 164},             /* LogicalEqual */
    {170, 171}, {171, 170},             /* IEqual */
    {172, 174}, {172, 176},             /* UGreaterThan */
    {173, 175}, {173, 177},             /* SGreaterThan */
    {174, 172}, {174, 178},             /* UGreaterThanEqual */
    {175, 173}, {175, 179},             /* SGreaterThanEqual */
    {176, 178}, {176, 172},             /* ULessThan */
    {177, 179}, {177, 173},             /* SLessThan */
    {178, 176}, {178, 174},             /* ULessThanEqual */
    {179, 177}, {179, 175},             /* SLessThanEqual */
    {180, 182}, {180, 181},             /* FOrdEqual */
    {182, 180}, {182, 183},             /* FOrdNotEqual */
    {183, 181}, {183, 182},             /* FUnordNotEqual */
    {184, 188}, {184, 186}, {184, 185}, /* FOrdLessThan */
    {186, 190}, {186, 184}, {186, 187}, /* FOrdGreaterThan */
    {188, 184}, {188, 190}, {188, 189}, /* FOrdLessThanEqual */
    {190, 186}, {190, 188}, {190, 191}, /* FOrdGreaterThanEqual */
};

static const struct becomes operations[] = {
    {126, OP_COPY_OBJECT},
    {OP_FNEGATE, OP_COPY_OBJECT},
    {128, 130},
    {130, 128},
    {129, 131},
    {131, 129},
    {132, 128},
    {133, 136},
    {134, 132},
    {136, 133},
    {137, 134},
    {154, 155},
    {155, 154},
    {166, 167},
    {167, 166},
    {168, OP_COPY_OBJECT},
    {194, 196},
    {195, 194},
    {196, 194},
    {197, 199},
    {198, 197},
    {199, 197},
    {200, OP_COPY_OBJECT},
};

/* Of extended instructions: to 0 is a copy. */
static const struct becomes extended[] = {{4, 0},   {5, 0},   {38, 41}, {41, 38},
                                          {39, 42}, {42, 39}, {73, 75}, {75, 73}};

static void replace(struct mutant_look *look, size_t at, enum mutant_kind kind,
                    const struct becomes *table, size_t count)
{
    const uint32_t op = spirv_op(look->code, at);
    for (size_t i = 0; i < count; i++) {
        struct spirv_mutant m = mutant_of(look, kind, at);
        char from[SPIRV_SAY_MOST], to[SPIRV_SAY_MOST];
        if (table[i].from != op)
            continue;
        spirv_say_name(m.word, from);
        m.word[0] = (m.word[0] & 0xFFFF0000u) | table[i].to;
        spirv_say_name(m.word, to);
        mutant_add(look, &m, "%.40s became %.40s", from, to);
    }
}

static void replace_extended(struct mutant_look *look, size_t at)
{
    for (size_t i = 0; i < ARRAY_COUNT(extended); i++) {
        struct spirv_mutant m = mutant_of(look, MUTANT_OPERATION, at);
        char from[SPIRV_SAY_MOST], to[SPIRV_SAY_MOST];
        if (m.word[4] != extended[i].from)
            continue;
        spirv_say_name(m.word, from);
        m.word[4] = extended[i].to;
        if (extended[i].to == 0) {
            m.word[3] = m.word[5];
            m.count = 4;
            m.word[0] = 4u << 16 | OP_COPY_OBJECT;
        }
        spirv_say_name(m.word, to);
        mutant_add(look, &m, "%.40s became %.40s", from, to);
    }
}

/* The comparison that decides at compile time. */
static void replace_special(struct mutant_look *look, size_t at)
{
    for (size_t i = 0; i < ARRAY_COUNT(comparisons); i++) {
        struct spirv_mutant m = mutant_of(look, MUTANT_COMPARISON, at);
        if (m.word[3] != comparisons[i].from)
            continue;
        m.word[3] = comparisons[i].to;
        mutant_add(look, &m, "opcode %u of OpSpecConstantOp became %u", comparisons[i].from,
                   comparisons[i].to);
    }
}

/* --- a module --------------------------------------------------------------------------------- */

/* A condition is negated by where it leads to, since nothing may stand behind OpSelectionMerge. */
static void negate_branch(struct mutant_look *look, size_t at)
{
    struct spirv_mutant m = mutant_of(look, MUTANT_BRANCH, at);
    const uint32_t label = m.word[2];
    m.word[2] = m.word[3];
    m.word[3] = label;
    mutant_add(look, &m, "the condition of OpBranchConditional is negated");
}

static void drop(struct mutant_look *look, size_t at, enum mutant_kind kind)
{
    struct spirv_mutant m = mutant_of(look, kind, at);
    char name[SPIRV_SAY_MOST];
    spirv_say_name(m.word, name);
    m.count = 0;
    mutant_add(look, &m, "%.40s is gone", name);
}

static void drop_decoration(struct mutant_look *look, size_t at)
{
    struct spirv_mutant m = mutant_of(look, MUTANT_DECORATION, at);
    const uint32_t *maker = mutant_maker(look, m.word[1]);
    char name[SPIRV_SAY_MOST];
    if (m.count != 3 || m.word[2] != NO_CONTRACTION || !maker)
        return;
    spirv_function(look->code, look->maker[m.word[1]], name);
    snprintf(look->function, sizeof look->function, "%.40s", name);
    spirv_say_name(maker, name);
    m.count = 0;
    mutant_add(look, &m, "NoContraction of %.40s is gone", name);
    strcpy(look->function, "module");
}

static void mutate_at(struct mutant_look *look, size_t at)
{
    const uint32_t op = spirv_op(look->code, at);
    if (op == OP_DECORATE)
        drop_decoration(look, at);
    if (op == OP_SPEC_CONSTANT_OP)
        replace_special(look, at);
    if (at >= look->functions) {
        replace(look, at, MUTANT_COMPARISON, comparisons, ARRAY_COUNT(comparisons));
        replace(look, at, MUTANT_OPERATION, operations, ARRAY_COUNT(operations));
        mutant_swap_operands(look, at);
    }
    if (op == OP_EXT_INST && spirv_length(look->code, at) > 5)
        replace_extended(look, at);
    if (op == OP_FADD_OF || op == OP_FSUB_OF)
        mutant_contract(look, at);
    if (op == OP_BRANCH_CONDITIONAL)
        negate_branch(look, at);
    if (op == OP_STORE)
        drop(look, at, MUTANT_STORE);
    if (op == OP_CONTROL_BARRIER || op == OP_MEMORY_BARRIER)
        drop(look, at, MUTANT_BARRIER);
    mutant_values(look, at);
}

static void look_through(struct mutant_look *look)
{
    const struct spirv_code *code = look->code;
    for (size_t i = 0; i < look->bound; i++)
        look->maker[i] = SIZE_MAX;
    look->functions = code->count;
    for (size_t i = code->count; i-- > 0;) {
        const uint32_t *word = spirv_words(code, i);
        const uint32_t id = spirv_result(word);
        if (spirv_op(code, i) == OP_EXT_INST_IMPORT)
            look->extended = word[1];
        if (spirv_op(code, i) == OP_FUNCTION)
            look->functions = i;
        if (id && id < look->bound)
            look->maker[id] = i;
    }
}

enum status spirv_mutants_make(const struct spirv_code *code, struct spirv_mutants *out,
                               struct reason *reason)
{
    struct mutant_look look = {
        .code = code, .bound = code->word[BOUND], .function = "module", .out = out};
    *out = (struct spirv_mutants){0};
    if (look.bound > SPIRV_BOUND_MOST)
        return fail(reason, STATUS_INPUT, "no SPIR-V module");
    look.maker = alloc_zeroed(look.bound, sizeof *look.maker);
    if (!look.maker)
        return fail(reason, STATUS_MEMORY, "no memory for mutants");
    look_through(&look);
    for (size_t i = 0; i < code->count && !look.status; i++) {
        char name[SPIRV_SAY_MOST];
        if (spirv_op(code, i) == OP_FUNCTION) {
            spirv_function(code, i, name);
            snprintf(look.function, sizeof look.function, "%.40s", name);
        }
        mutate_at(&look, i);
    }
    free(look.maker);
    return look.status ? fail(reason, look.status, "no memory for mutants") : STATUS_OK;
}

void spirv_mutants_free(struct spirv_mutants *mutants)
{
    free(mutants->one);
    *mutants = (struct spirv_mutants){0};
}

static size_t put(uint32_t *out, size_t count, const uint32_t *word, size_t words)
{
    memcpy(out + count, word, words * sizeof *out);
    return count + words;
}

enum status spirv_mutate(const struct spirv_code *code, const struct spirv_mutant *m,
                         uint32_t **out, size_t *out_count, struct reason *reason)
{
    const size_t room =
        code->at[code->count] + MUTANT_WORDS + ARRAY_COUNT(m->before) + ARRAY_COUNT(m->constant);
    bool declared = false;
    size_t count = 0;
    *out_count = 0;
    *out = alloc_zeroed(room, sizeof **out);
    if (!*out)
        return fail(reason, STATUS_MEMORY, "no memory for a mutant");
    count = put(*out, count, code->word, SPIRV_HEADER_WORDS);
    (*out)[BOUND] += m->ids;
    if (m->doubles)
        count = put(*out, count, (const uint32_t[]){2u << 16 | OP_CAPABILITY, FLOAT64}, 2);
    for (size_t i = 0; i < code->count; i++) {
        if (spirv_op(code, i) == OP_FUNCTION && !declared) {
            count = put(*out, count, m->constant, m->constant_count);
            declared = true;
        }
        if (i == m->at) {
            count = put(*out, count, m->before, m->before_count);
            count = put(*out, count, m->word, m->count);
        } else {
            count = put(*out, count, spirv_words(code, i), spirv_length(code, i));
        }
    }
    *out_count = count;
    return STATUS_OK;
}
