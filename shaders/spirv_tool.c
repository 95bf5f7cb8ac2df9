/* Build step for SPIR-V: checks a module against our rules, decorates its float arithmetic, and
 * writes modules as C.
 *   spirv_tool fix IN.spv OUT.spv       checks, decorates
 *   spirv_tool embed OUT.c A.spv ...    table of gpu/shaders.h
 * glslang loses `precise` inside helper functions and struct returns and never decorates dot or
 * cross products, so every float operation gets its NoContraction here, and what cannot be
 * decorated is refused in tracing shaders, those whose file name begins with trace_, and in those
 * that render, with render_, beside a square root (as an estimate) and a power (of colours).
 * Shaders whose name begins with query_ may use ray queries, and nothing else beyond the baseline.
 */
#include "ref/mutant.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC          0x07230203u
#define HEADER_WORDS   5u
#define NO_CONTRACTION 42u
#define RAY_QUERY      4472u /* the capability RayQueryKHR */

enum {
    OP_EXTENSION = 10,
    OP_EXT_INST_IMPORT = 11,
    OP_EXT_INST = 12,
    OP_MEMORY_MODEL = 14,
    OP_ENTRY_POINT = 15,
    OP_EXECUTION_MODE = 16,
    OP_CAPABILITY = 17,
    OP_TYPE_INT = 21,
    OP_TYPE_FLOAT = 22,
    OP_SPEC_CONSTANT_OP = 52,
    OP_FUNCTION_END = 56,
    OP_DECORATE = 71,
    OP_MODULE_PROCESSED = 330,
    OP_EXECUTION_MODE_ID = 331,
};

struct module {
    const char *file;
    uint32_t *word;
    size_t count;
    bool tracing;
    bool render;
    bool query; /* uses ray queries */
    bool free;  /* its arithmetic stays as it is: the driver's freedom is what it measures */
};

/* One instruction: opcode, its words (the first holds opcode and count). */
struct instruction {
    uint32_t op;
    uint32_t count;
    const uint32_t *word;
};

struct rule {
    uint32_t number;
    const char *name;
};

/* Float arithmetic that NoContraction pins down; the result id is word 2. */
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

/* Sums whose order nobody promises, and derivatives. */
static const struct rule refused[] = {
    {144, "OpVectorTimesMatrix"},
    {145, "OpMatrixTimesVector"},
    {146, "OpMatrixTimesMatrix"},
    {148, "OpDot"},
};

/* The extended instructions that are exact: everything else is refused in tracing shaders. */
static const struct rule exact_ext[] = {
    {4, "FAbs"},      {5, "SAbs"},    {38, "UMin"},   {39, "SMin"},           {41, "UMax"},
    {42, "SMax"},     {44, "UClamp"}, {45, "SClamp"}, {62, "UnpackHalf2x16"}, {73, "FindILsb"},
    {75, "FindUMsb"},
};

/* What is allowed beside them where shaders render. */
static const struct rule render_ext[] = {{26, "Pow"}, {31, "Sqrt"}};

/* Names for messages only. */
static const struct rule refused_ext[] = {
    {37, "FMin"},  {40, "FMax"},         {43, "FClamp"},  {46, "FMix"},
    {50, "Fma"},   {58, "PackHalf2x16"}, {66, "Length"},  {67, "Distance"},
    {68, "Cross"}, {69, "Normalize"},    {71, "Reflect"}, {79, "NMin"},
    {80, "NMax"},  {81, "NClamp"},       {31, "Sqrt"},    {32, "InverseSqrt"},
};

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

static const char *find(const struct rule *rule, size_t count, uint32_t number)
{
    for (size_t i = 0; i < count; i++)
        if (rule[i].number == number)
            return rule[i].name;
    return NULL;
}

/* Prints one line and returns false, so that checks can end with it. */
static bool complain(const struct module *m, size_t at, const char *what, const char *rule)
{
    fprintf(stderr, "%s: word %zu: %s: %s\n", m->file, at, what, rule);
    return false;
}

static bool read_module(const char *file, struct module *m)
{
    *m = (struct module){.file = file};
    const char *slash = strrchr(file, '/');
    m->tracing = strncmp(slash ? slash + 1 : file, "trace_", 6) == 0;
    m->render = strncmp(slash ? slash + 1 : file, "render_", 7) == 0;
    m->query = strncmp(slash ? slash + 1 : file, "query_", 6) == 0;
    m->free = strcmp(slash ? slash + 1 : file, "probe_free.spv") == 0;
    FILE *in = fopen(file, "rb");
    if (!in) {
        perror(file);
        return false;
    }
    size_t capacity = 0;
    for (size_t got = 1; got > 0; m->count += got) {
        if (m->count == capacity) {
            capacity = capacity ? 2 * capacity : 4096;
            uint32_t *grown = realloc(m->word, capacity * sizeof *grown);
            if (!grown) {
                perror(file);
                fclose(in);
                return false;
            }
            m->word = grown;
        }
        got = fread(m->word + m->count, sizeof *m->word, capacity - m->count, in);
    }
    bool failed = ferror(in) != 0;
    bool whole = ftell(in) % 4 == 0;
    fclose(in);
    if (failed)
        return complain(m, m->count, "read error", "the file must be readable");
    if (!whole)
        return complain(m, m->count, "file length", "it must be whole words of four bytes");
    if (m->count < HEADER_WORDS || m->word[0] != MAGIC)
        return complain(m, 0, "no SPIR-V header", "a module in this machine's byte order");
    return true;
}

/* Steps to the instruction at *at; false at the end or if the module is malformed (*ok). */
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
        !(i->count == 2 && (i->word[1] == 1 || (m->query && i->word[1] == RAY_QUERY))))
        return complain(m, at, "OpCapability", "only Shader is promised everywhere");
    if (i->op == OP_EXTENSION &&
        !(m->query && i->count == 6 && memcmp(i->word + 1, "SPV_KHR_ray_query", 18) == 0))
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
    const char *name = find(refused, COUNT(refused), i->op);
    if (name)
        return complain(m, at, name, "refused in tracing shaders: the order of its sum is open");
    if (i->op == OP_SPEC_CONSTANT_OP && i->count > 3 &&
        (find(decorated, COUNT(decorated), i->word[3]) ||
         find(refused, COUNT(refused), i->word[3])))
        return complain(m, at, "OpSpecConstantOp on floats",
                        "refused in tracing shaders: the driver folds it as it likes");
    if (i->op != OP_EXT_INST)
        return true;
    if (i->count < 5)
        return complain(m, at, "OpExtInst", "it has at least five words");
    if (find(exact_ext, COUNT(exact_ext), i->word[4]) ||
        (m->render && find(render_ext, COUNT(render_ext), i->word[4])))
        return true;
    char what[64];
    name = find(refused_ext, COUNT(refused_ext), i->word[4]);
    (void)snprintf(what, sizeof what, "GLSL.std.450 %s (%u)", name ? name : "instruction",
                   (unsigned)i->word[4]);
    return complain(m, at, what, "refused in tracing shaders: its rounding is not promised");
}

static bool check(const struct module *m)
{
    struct instruction i;
    uint32_t last = 0;
    bool ok = true;
    for (size_t at = HEADER_WORDS, here = at; ok && next(m, &at, &i, &ok); here = at) {
        ok = check_baseline(m, here, &i) &&
             (!(m->tracing || m->render) || check_tracing(m, here, &i));
        last = i.op;
    }
    if (ok && last != OP_FUNCTION_END)
        return complain(m, m->count, "end of module", "it must come after OpFunctionEnd");
    return ok;
}

/* True for instructions that must precede the annotations. */
static bool is_preamble(uint32_t op)
{
    return op <= 7 || op == OP_EXTENSION || op == OP_EXT_INST_IMPORT ||
           (op >= OP_MEMORY_MODEL && op <= OP_CAPABILITY) || op == OP_MODULE_PROCESSED ||
           op == OP_EXECUTION_MODE_ID;
}

static void write_decorations(const struct module *m, FILE *out)
{
    struct instruction i;
    bool ok = true;
#if MUTANT == MUTANT_NO_PRECISE
    bool drop = m->tracing;
#else
    bool drop = false;
#endif
    for (size_t at = HEADER_WORDS; next(m, &at, &i, &ok);) {
        if (!find(decorated, COUNT(decorated), i.op) || i.count < 3)
            continue;
        if (!drop)
            fwrite((const uint32_t[]){3u << 16 | OP_DECORATE, i.word[2], NO_CONTRACTION}, 4, 3,
                   out);
        drop = false;
    }
}

/* Copies the module; every NoContraction in it is replaced by our own. */
static void write_module(const struct module *m, FILE *out)
{
    struct instruction i;
    bool ok = true, done = false;
    fwrite(m->word, 4, HEADER_WORDS, out);
    for (size_t at = HEADER_WORDS; next(m, &at, &i, &ok);) {
        if (!done && !m->free && !is_preamble(i.op)) {
            write_decorations(m, out);
            done = true;
        }
        if (i.op == OP_DECORATE && i.count == 3 && i.word[2] == NO_CONTRACTION && !m->free)
            continue;
        fwrite(i.word, 4, i.count, out);
    }
}

/* Closes and reports; a file that could not be written whole is removed. */
static bool finish(FILE *out, const char *file)
{
    bool failed = ferror(out) != 0;
    failed = fclose(out) != 0 || failed;
    if (failed) {
        fprintf(stderr, "%s: write error\n", file);
        remove(file);
    }
    return !failed;
}

static bool fix(const char *from, const char *to)
{
    struct module m;
    bool ok = read_module(from, &m) && check(&m);
    if (ok) {
        FILE *out = fopen(to, "wb");
        ok = out != NULL;
        if (!ok)
            perror(to);
        if (ok) {
            write_module(&m, out);
            ok = finish(out, to);
        }
    }
    free(m.word);
    return ok;
}

/* Copies the file's stem to `name`; false unless it is a C identifier. */
static bool stem(const char *file, char name[64])
{
    const char *slash = strrchr(file, '/');
    const char *start = slash ? slash + 1 : file;
    size_t length = strcspn(start, ".");
    bool ok = length > 0 && length < 64 && isalpha((unsigned char)start[0]);
    for (size_t i = 0; i < length && ok; i++)
        ok = isalnum((unsigned char)start[i]) || start[i] == '_';
    if (!ok) {
        fprintf(stderr, "%s: the name of a shader must be a C identifier\n", file);
        return false;
    }
    memcpy(name, start, length);
    name[length] = '\0';
    return true;
}

static bool embed_words(FILE *out, const char *file)
{
    struct module m;
    char name[64];
    bool ok = stem(file, name) && read_module(file, &m);
    if (!ok)
        return false;
    fprintf(out, "static const uint32_t %s[] = {", name);
    for (size_t i = 0; i < m.count; i++)
        fprintf(out, "%s0x%08x,", i % 8 ? " " : "\n    ", (unsigned)m.word[i]);
    fprintf(out, "\n};\n\n");
    free(m.word);
    return true;
}

static bool embed(const char *to, char **file, int count)
{
    FILE *out = fopen(to, "w");
    if (!out) {
        perror(to);
        return false;
    }
    bool ok = true;
    fprintf(out, "#include \"gpu/shaders.h\"\n\n");
    for (int i = 0; i < count && ok; i++)
        ok = embed_words(out, file[i]);
    fprintf(out, "const struct shader shaders[] = {\n");
    for (int i = 0; i < count && ok; i++) {
        char name[64];
        ok = stem(file[i], name);
        fprintf(out, "    {\"%s\", %s, (uint32_t)(sizeof %s / 4), %s},\n", name, name, name,
                strncmp(name, "trace_", 6) == 0 ? "true" : "false");
    }
    fprintf(out, "    {0},\n};\n");
    if (!ok) {
        fclose(out);
        remove(to);
        return false;
    }
    return finish(out, to);
}

int main(int argc, char **argv)
{
    bool ok;
    if (argc == 4 && strcmp(argv[1], "fix") == 0) {
        ok = fix(argv[2], argv[3]);
    } else if (argc >= 3 && strcmp(argv[1], "embed") == 0) {
        ok = embed(argv[2], argv + 3, argc - 3);
    } else {
        fprintf(stderr, "usage: spirv_tool fix IN OUT | spirv_tool embed OUT.c MODULE...\n");
        return 2;
    }
    return ok ? 0 : 1;
}
