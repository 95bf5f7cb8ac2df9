#include "gpu/shaders/compiler.h"

#include "gpu/shaders/compiler_tools.h"
#include "gpu/shaders/shaders.h"
#include "gpu/shaders/spirv_fix.h"
#include "gpu/shaders/spirv_look.h"
#include "gpu/shaders/spirv_memory.h"
#include "ref/abi_world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const decorate_names[DECORATE_COUNT + 1] = {"source", "final", "none", NULL};
const char *const memory_names[MEMORY_COUNT + 1] = {"storage", "texel", "reference", NULL};

#define INPUTS                                                                                     \
    (1u << ABI_BIND_RAYS | 1u << ABI_BIND_NODES | 1u << ABI_BIND_ITEMS | 1u << ABI_BIND_TRIS |     \
     1u << ABI_BIND_WORLD)

static const char *const kind_names[COMPILER_KINDS] = {
    [COMPILER_RAW] = "raw",        [COMPILER_OPT] = "opt",     [COMPILER_SIZE] = "size",
    [COMPILER_PASSES] = "passes",  [COMPILER_CROSS] = "cross", [COMPILER_HLSL] = "hlsl",
    [COMPILER_SHADERC] = "shaderc"};

/* --- names ------------------------------------------------------------------------------------ */

static bool is_word(const char *text, size_t length, const char *word)
{
    return strlen(word) == length && memcmp(text, word, length) == 0;
}

static enum status parse_kind(const char *text, size_t length, struct compiler *out,
                              struct reason *reason)
{
    for (enum compiler_kind kind = 0; kind < COMPILER_KINDS; kind++)
        if (is_word(text, length, kind_names[kind])) {
            out->kind = kind;
            return STATUS_OK;
        }
    return fail(reason, STATUS_INPUT,
                "'%.*s' is no compiler: raw, opt, size, passes:A+B, cross, hlsl or shaderc",
                (int)(length < 60 ? length : 60), text);
}

static enum status parse_passes(const char *text, size_t length, struct compiler *out,
                                struct reason *reason)
{
    size_t passes = 1;
    for (size_t i = 0; i < length; i++) {
        const bool between = text[i] == '+';
        if (text[i] <= ' ' || text[i] > '~' || text[i] == '\'' || text[i] == '"')
            return fail(reason, STATUS_INPUT, "passes: '%.60s' has a character that no pass has",
                        text);
        if (between && (i == 0 || i + 1 == length || text[i - 1] == '+'))
            return fail(reason, STATUS_INPUT, "passes: '%.60s' has an empty pass", text);
        passes += between;
    }
    if (length == 0 || length >= sizeof out->passes || passes > COMPILER_PASSES_MOST)
        return fail(reason, STATUS_INPUT,
                    "passes: takes names such as passes:ccp+if-conversion, at most %d of %zu "
                    "characters together",
                    COMPILER_PASSES_MOST, sizeof out->passes - 1);
    memcpy(out->passes, text, length);
    return STATUS_OK;
}

/* Takes "texel", "reference" or either with a colon off the beginning of a name; returns what is
 * left. */
static const char *parse_memory(const char *text, enum memory *out)
{
    const size_t length = strcspn(text, ":");
    *out = MEMORY_STORAGE;
    for (enum memory m = MEMORY_STORAGE + 1; m < MEMORY_COUNT; m++)
        if (is_word(text, length, memory_names[m])) {
            *out = m;
            return text[length] ? text + length + 1 : "raw";
        }
    return text;
}

enum status compiler_parse(const char *text, struct compiler *out, struct reason *reason)
{
    enum memory memory;
    text = parse_memory(text, &memory);
    const char *last = strrchr(text, ':'), *colon = strchr(text, ':');
    size_t length = strlen(text);
    *out = (struct compiler){.memory = memory, .decorate = DECORATE_SOURCE};
    for (enum decorate d = 0; last && d < DECORATE_COUNT; d++)
        if (strcmp(last + 1, decorate_names[d]) == 0) {
            out->decorate = d;
            out->decorated = true;
            length = (size_t)(last - text);
        }
    if (!colon || colon >= text + length)
        colon = NULL;
    enum status status = parse_kind(text, colon ? (size_t)(colon - text) : length, out, reason);
    if (status)
        return status;
    if (out->kind != COMPILER_PASSES && colon)
        return fail(reason, STATUS_INPUT, "'%.60s': %s takes no list", text, kind_names[out->kind]);
    if (out->kind != COMPILER_PASSES)
        return STATUS_OK;
    const char *list = colon ? colon + 1 : text + length;
    return parse_passes(list, length - (size_t)(list - text), out, reason);
}

void compiler_name(const struct compiler *compiler, char text[COMPILER_NAME_MOST + 32])
{
    const bool source = compiler->decorate == DECORATE_SOURCE;
    const bool storage = compiler->memory == MEMORY_STORAGE;
    if (!storage && compiler->kind == COMPILER_RAW && source) {
        snprintf(text, COMPILER_NAME_MOST + 32, "%s", memory_names[compiler->memory]);
        return;
    }
    snprintf(text, COMPILER_NAME_MOST + 32, "%s%s%s%s%s%s%s",
             storage ? "" : memory_names[compiler->memory], storage ? "" : ":",
             kind_names[compiler->kind], compiler->kind == COMPILER_PASSES ? ":" : "",
             compiler->passes, source ? "" : ":", source ? "" : decorate_names[compiler->decorate]);
}

struct vk_ways compiler_ways(const struct compiler *compiler)
{
    return (struct vk_ways){compiler->memory == MEMORY_TEXEL ? INPUTS : 0,
                            compiler->memory == MEMORY_REFERENCE ? INPUTS : 0};
}

bool compiler_changes_nothing(const struct compiler *compiler)
{
    return compiler->kind == COMPILER_RAW && compiler->memory == MEMORY_STORAGE &&
           compiler->decorate != DECORATE_NONE;
}

bool compiler_translates(const struct compiler *compiler)
{
    return compiler->kind >= COMPILER_CROSS;
}

/* --- modules ---------------------------------------------------------------------------------- */

/* A module that is passed on from step to step. */
struct module_passed {
    uint32_t *word;
    size_t count;
};

static void replace(struct module_passed *module, uint32_t *word, size_t count)
{
    free(module->word);
    *module = (struct module_passed){word, count};
}

enum status compiler_begin(const struct compiler *compiler, const struct vk_shader *shader,
                           uint32_t **word, size_t *count, struct reason *reason)
{
    if (compiler->decorate != DECORATE_SOURCE)
        return spirv_strip(shader->word, shader->word_count, word, count, reason);
    *word = alloc_copy(shader->word, shader->word_count, sizeof *shader->word);
    *count = shader->word_count;
    return *word ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for a shader");
}

enum status compiler_finish(const struct compiler *compiler, uint32_t **word, size_t *count,
                            struct reason *reason)
{
    const struct spirv_rules rules = {.query = true}; /* its baseline: what the device has */
    uint32_t *made;
    size_t made_count;
    if (compiler->decorate != DECORATE_FINAL)
        return STATUS_OK;
    if (spirv_fix(*word, *count, &rules, &made, &made_count, reason))
        return STATUS_DEVICE;
    free(*word);
    *word = made;
    *count = made_count;
    return STATUS_OK;
}

enum status compiler_look(const struct vk_shader *shader, const uint32_t *word, size_t count,
                          struct compiled *out, struct reason *reason)
{
    struct spirv_found before, after;
    enum status status = spirv_look(shader->word, shader->word_count, &before, reason);
    if (!status)
        status = spirv_look(word, (uint32_t)count, &after, reason);
    if (status)
        return status;
    const uint32_t open = before.sums + before.open_ext, now = after.sums + after.open_ext;
    *out = (struct compiled){.word = word,
                             .count = (uint32_t)count,
                             .source = before.float_ops,
                             .ops = after.float_ops,
                             .kept = after.float_ops - after.bare,
                             .signs = after.bare_signs,
                             .foreign = now > open ? now - open : 0};
    return STATUS_OK;
}

static struct vk_shader with_words(const struct vk_shader *shader,
                                   const struct module_passed *module)
{
    struct vk_shader out = *shader;
    out.word = module->word;
    out.word_count = (uint32_t)module->count;
    return out;
}

/* Makes the shader's module one that reads its inputs in the compiler's way; *made is to be freed
 * once the shader was used. */
static enum status read_otherwise(const struct compiler *compiler, struct vk_shader *shader,
                                  struct module_passed *made, uint32_t *words_of,
                                  struct reason *reason)
{
    enum status status = STATUS_OK;
    if (compiler->memory == MEMORY_TEXEL)
        status = spirv_texels(shader->word, shader->word_count, INPUTS, &made->word, &made->count,
                              words_of, reason);
    else if (compiler->memory == MEMORY_REFERENCE)
        status = spirv_references(shader->word, shader->word_count, INPUTS, &made->word,
                                  &made->count, reason);
    if (!status && made->word)
        *shader = with_words(shader, made);
    return status;
}

/* Everything that a compiler does to a module; on success its words are the caller's. */
static enum status make(const struct compiler *compiler, const struct vk_shader *shader,
                        struct compiled *out, struct reason *reason)
{
    struct module_passed module = {0}, read = {0};
    struct vk_shader begun = *shader;
    uint32_t words_of = 0;
    enum status status = read_otherwise(compiler, &begun, &read, &words_of, reason);
    if (!status)
        status = compiler_begin(compiler, &begun, &module.word, &module.count, reason);
    free(read.word);
    if (!status && compiler->kind != COMPILER_RAW) {
        uint32_t *word = NULL;
        size_t count = 0;
        const struct vk_shader input = with_words(shader, &module);
        status = compiler_tools(compiler, &input, &word, &count, reason);
        if (!status)
            replace(&module, word, count);
    }
    if (!status)
        status = compiler_finish(compiler, &module.word, &module.count, reason);
    if (!status && compiler->kind != COMPILER_RAW)
        status = compiler_validate(module.word, module.count, reason);
    if (!status)
        status = compiler_look(shader, module.word, module.count, out, reason);
    out->words_of = words_of;
    if (status)
        free(module.word);
    return status;
}

/* --- what was made ---------------------------------------------------------------------------- */

static struct kept {
    char compiler[COMPILER_NAME_MOST + 32];
    const uint32_t *word;
    uint32_t constant[VK_CONSTANTS_MAX]; /* 0 but of hlsl */
    struct compiled compiled;
} * kept;
static size_t kept_count, kept_capacity;

enum status compiler_run(const struct compiler *compiler, const struct vk_shader *shader,
                         struct compiled *out, struct reason *reason)
{
    struct kept one = {.word = shader->word};
    struct reason why = {""};
    compiler_name(compiler, one.compiler);
    if (compiler->kind == COMPILER_HLSL)
        memcpy(one.constant, shader->constant, shader->constant_count * sizeof one.constant[0]);
    for (size_t i = 0; i < kept_count; i++)
        if (kept[i].word == shader->word && strcmp(kept[i].compiler, one.compiler) == 0 &&
            memcmp(kept[i].constant, one.constant, sizeof one.constant) == 0) {
            *out = kept[i].compiled;
            return STATUS_OK;
        }
    *out = (struct compiled){0};
    if (array_reserve(&kept, &kept_capacity, kept_count + 1, sizeof one))
        return fail(reason, STATUS_MEMORY, "no memory for the list of compiled shaders");
    enum status status = make(compiler, shader, &one.compiled, &why);
    if (status)
        return fail(reason, status, "compiler %.100s, shader %s: %.220s", one.compiler,
                    shader->name, why.text);
    kept[kept_count++] = one;
    *out = one.compiled;
    return STATUS_OK;
}

enum status compiler_check(const struct compiler *compiler, struct reason *reason)
{
    enum status status = compiler_tools_are_here(compiler, reason);
    if (status || compiler->kind != COMPILER_PASSES)
        return status;
    const struct shader *found = shader_find("probe_free");
    const struct vk_shader small = {.word = found->word, .word_count = found->word_count};
    uint32_t *word = NULL;
    size_t count;
    status = compiler_tools(compiler, &small, &word, &count, reason);
    free(word);
    /* The tools are here: it is a pass or a program that is not. */
    return status == STATUS_DEVICE || status == STATUS_UNSUPPORTED ? STATUS_INPUT : status;
}
