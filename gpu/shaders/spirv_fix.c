#include "gpu/shaders/spirv_fix.h"

#include "gpu/shaders/spirv_words.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RAY_QUERY 4472u /* the capability RayQueryKHR */
#define RAY_SKIPS 4478u /* RayTraversalPrimitiveCullingKHR: devices with ray queries have it */

struct module {
    const uint32_t *word;
    size_t count;
    struct spirv_rules rules;
    struct reason *reason;
};

/* One instruction: opcode and words. The first word holds opcode and word count. */
struct instruction {
    uint32_t op;
    uint32_t count;
    const uint32_t *word;
};

struct rule {
    uint32_t number;
    const char *name;
};

/* Float arithmetic that is decorated with NoContraction. The result id is word 2. */
static const struct rule decorated[] = {
    {127, "OpFNegate"},
    {129, "OpFAdd"},
    {131, "OpFSub"},
    {133, "OpFMul"},
    {136, "OpFDiv"},
    {140, "OpFRem"},
    {141, "OpFMod"},
    {142, "OpVectorTimesScalar"},
    {143, "OpMatrixTimesScalar"},
    {147, "OpOuterProduct"},
};

/* Sums whose order is not specified. */
static const struct rule refused[] = {
    {144, "OpVectorTimesMatrix"},
    {145, "OpMatrixTimesVector"},
    {146, "OpMatrixTimesMatrix"},
    {148, "OpDot"},
};

/* The exact extended instructions. All others are rejected in tracing shaders. */
static const struct rule exact_ext[] = {
    {4, "FAbs"},      {5, "SAbs"},    {38, "UMin"},   {39, "SMin"},           {41, "UMax"},
    {42, "SMax"},     {44, "UClamp"}, {45, "SClamp"}, {62, "UnpackHalf2x16"}, {73, "FindILsb"},
    {75, "FindUMsb"},
};

/* Additional instructions for rendering shaders. */
static const struct rule render_ext[] = {{26, "Pow"}, {31, "Sqrt"}};

/* Names of rejected instructions, for messages only. */
static const struct rule refused_ext[] = {
    {37, "FMin"},  {40, "FMax"},         {43, "FClamp"},  {46, "FMix"},
    {50, "Fma"},   {58, "PackHalf2x16"}, {66, "Length"},  {67, "Distance"},
    {68, "Cross"}, {69, "Normalize"},    {71, "Reflect"}, {79, "NMin"},
    {80, "NMax"},  {81, "NClamp"},       {31, "Sqrt"},    {32, "InverseSqrt"},
};

static const char *find(const struct rule *rule, size_t count, uint32_t number)
{
    for (size_t i = 0; i < count; i++)
        if (rule[i].number == number)
            return rule[i].name;
    return NULL;
}

/* Sets the reason and returns false. */
static bool complain(const struct module *m, size_t at, const char *what, const char *rule)
{
    return fail(m->reason, STATUS_INPUT, "word %zu: %s: %s", at, what, rule) == STATUS_OK;
}

/* Reads the instruction at *at and moves to the next. Returns false at the end or if the module is
 * malformed (then *ok is false). */
static bool next(const struct module *m, size_t *at, struct instruction *out, bool *ok)
{
    if (*at >= m->count)
        return false;
    out->word = m->word + *at;
    out->op = out->word[0] & 0xFFFFu;
    out->count = out->word[0] >> 16;
    if (out->count == 0 || out->count > m->count - *at) {
        *ok = complain(m, *at, "instruction length", "it must be 1 or more and end in the module");
        return false;
    }
    *at += out->count;
    return true;
}

/* The portable baseline: no capability beyond Shader, no extension, 32-bit numbers only. */
static bool check_baseline(const struct module *m, size_t at, const struct instruction *i)
{
    if (i->op == OP_CAPABILITY &&
        !(i->count == 2 && (i->word[1] == 1 || (m->rules.query && (i->word[1] == RAY_QUERY ||
                                                                   i->word[1] == RAY_SKIPS)))))
        return complain(m, at, "OpCapability", "only Shader is promised everywhere");
    if (i->op == OP_EXTENSION &&
        !(m->rules.query && i->count == 6 && memcmp(i->word + 1, "SPV_KHR_ray_query", 18) == 0))
        return complain(m, at, "OpExtension", "no extension is promised everywhere");
    if ((i->op == OP_TYPE_FLOAT || i->op == OP_TYPE_INT) && !(i->count > 2 && i->word[2] == 32))
        return complain(m, at, i->op == OP_TYPE_INT ? "OpTypeInt" : "OpTypeFloat",
                        "only numbers of 32 bits are promised everywhere");
    if (i->op == OP_EXT_INST_IMPORT &&
        !(i->count == 6 && memcmp(i->word + 2, "GLSL.std.450", 13) == 0))
        return complain(m, at, "OpExtInstImport", "only GLSL.std.450 is promised everywhere");
    return true;
}

static bool check_tracing(const struct module *m, size_t at, const struct instruction *i)
{
    const char *name = find(refused, ARRAY_COUNT(refused), i->op);
    if (name)
        return complain(m, at, name, "refused in tracing shaders: the order of its sum is open");
    if (i->op == OP_SPEC_CONSTANT_OP && i->count > 3 &&
        (find(decorated, ARRAY_COUNT(decorated), i->word[3]) ||
         find(refused, ARRAY_COUNT(refused), i->word[3])))
        return complain(m, at, "OpSpecConstantOp on floats",
                        "refused in tracing shaders: the driver folds it as it likes");
    if (i->op != OP_EXT_INST)
        return true;
    if (i->count < 5)
        return complain(m, at, "OpExtInst", "it has at least five words");
    if (find(exact_ext, ARRAY_COUNT(exact_ext), i->word[4]) ||
        (m->rules.render && find(render_ext, ARRAY_COUNT(render_ext), i->word[4])))
        return true;
    char what[64];
    name = find(refused_ext, ARRAY_COUNT(refused_ext), i->word[4]);
    snprintf(what, sizeof what, "GLSL.std.450 %s (%u)", name ? name : "instruction", i->word[4]);
    return complain(m, at, what, "refused in tracing shaders: its rounding is not promised");
}

static bool check(const struct module *m)
{
    struct instruction i;
    uint32_t last = 0;
    bool ok = true;
    for (size_t at = SPIRV_HEADER_WORDS, here = at; ok && next(m, &at, &i, &ok); here = at) {
        ok = check_baseline(m, here, &i) &&
             (!(m->rules.tracing || m->rules.render) || check_tracing(m, here, &i));
        last = i.op;
    }
    if (ok && last != OP_FUNCTION_END)
        return complain(m, m->count, "end of module", "it must come after OpFunctionEnd");
    return ok;
}

/* Returns true for instructions that must precede the annotations. */
static bool is_preamble(uint32_t op)
{
    return op <= 7 || op == OP_EXTENSION || op == OP_EXT_INST_IMPORT ||
           (op >= OP_MEMORY_MODEL && op <= OP_CAPABILITY) || op == OP_MODULE_PROCESSED ||
           op == OP_EXECUTION_MODE_ID;
}

/* The output, which has room for all words. */
struct sink {
    uint32_t *word;
    size_t count;
};

static void put(struct sink *out, const uint32_t *word, size_t count)
{
    memcpy(out->word + out->count, word, count * sizeof *word);
    out->count += count;
}

static void put_decorations(const struct module *m, struct sink *out)
{
    struct instruction i;
    bool ok = true;
    for (size_t at = SPIRV_HEADER_WORDS; next(m, &at, &i, &ok);) {
        if (!find(decorated, ARRAY_COUNT(decorated), i.op) || i.count < 3)
            continue;
        put(out, (const uint32_t[]){3u << 16 | OP_DECORATE, i.word[2], NO_CONTRACTION}, 3);
    }
}

/* Whether an id is that of a function. */
static bool is_function(const struct module *m, uint32_t id)
{
    struct instruction i;
    bool ok = true;
    for (size_t at = SPIRV_HEADER_WORDS; next(m, &at, &i, &ok);)
        if (i.op == OP_FUNCTION && i.count > 2 && i.word[2] == id)
            return true;
    return false;
}

/* Whether an instruction is for people alone. Names of functions stay: they say where something is
 * (raydiff bisect). */
static bool is_debug(const struct module *m, const struct instruction *i)
{
    if (i->op == OP_NAME)
        return i->count < 3 || !is_function(m, i->word[1]);
    return (i->op >= OP_SOURCE_CONTINUED && i->op <= OP_LINE) || i->op == OP_NO_LINE ||
           i->op == OP_MODULE_PROCESSED;
}

/* Copies the module without what is_debug, replacing its NoContraction decorations with those of
 * put_decorations. */
static void put_module(const struct module *m, struct sink *out)
{
    struct instruction i;
    bool ok = true, done = false;
    put(out, m->word, SPIRV_HEADER_WORDS);
    for (size_t at = SPIRV_HEADER_WORDS; next(m, &at, &i, &ok);) {
        if (!done && !m->rules.free && !is_preamble(i.op)) {
            put_decorations(m, out);
            done = true;
        }
        if (i.op == OP_DECORATE && i.count == 3 && i.word[2] == NO_CONTRACTION && !m->rules.free)
            continue;
        if (!is_debug(m, &i))
            put(out, i.word, i.count);
    }
}

enum status spirv_fix(const uint32_t *word, size_t count, const struct spirv_rules *rules,
                      uint32_t **out, size_t *out_count, struct reason *reason)
{
    struct module m = {word, count, *rules, reason};
    *out = NULL;
    *out_count = 0;
    if (count < SPIRV_HEADER_WORDS || word[0] != SPIRV_MAGIC)
        return fail(reason, STATUS_INPUT,
                    "word 0: no SPIR-V header: a module in this machine's byte order");
    if (!check(&m))
        return STATUS_INPUT;
    /* A decoration has three words, and an operation that gets one has at least three. */
    struct sink sink = {.word = alloc_zeroed(count, 2 * sizeof *sink.word)};
    if (!sink.word)
        return fail(reason, STATUS_MEMORY, "no memory for %zu words of SPIR-V", 2 * count);
    put_module(&m, &sink);
    *out = sink.word;
    *out_count = sink.count;
    return STATUS_OK;
}

enum status spirv_strip(const uint32_t *word, size_t count, uint32_t **out, size_t *out_count,
                        struct reason *reason)
{
    const struct module m = {.word = word, .count = count, .reason = reason};
    struct instruction i;
    bool ok = true;
    *out = NULL;
    *out_count = 0;
    if (count < SPIRV_HEADER_WORDS || word[0] != SPIRV_MAGIC)
        return fail(reason, STATUS_INPUT, "word 0: no SPIR-V header");
    struct sink sink = {.word = alloc_zeroed(count, sizeof *sink.word)};
    if (!sink.word)
        return fail(reason, STATUS_MEMORY, "no memory for %zu words of SPIR-V", count);
    put(&sink, word, SPIRV_HEADER_WORDS);
    for (size_t at = SPIRV_HEADER_WORDS; next(&m, &at, &i, &ok);)
        if (!(i.op == OP_DECORATE && i.count == 3 && i.word[2] == NO_CONTRACTION))
            put(&sink, i.word, i.count);
    if (!ok) {
        free(sink.word);
        return STATUS_INPUT;
    }
    *out = sink.word;
    *out_count = sink.count;
    return STATUS_OK;
}
