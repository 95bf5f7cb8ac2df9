#include "gpu/shaders/compiler_tools.h"

#include "ref/outside/tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TOOL_MS     120000u
#define MODULE_MOST ((size_t)64 << 20)
#define ARGS_MOST   (COMPILER_PASSES_MOST + 8)

/* Programs by the compilers that run them: bit 1 << kind. */
#define OF(kind) (1u << COMPILER_##kind)
#define OF_ALL   (OF(OPT) | OF(SIZE) | OF(PASSES) | OF(CROSS) | OF(SHADERC))

static const struct {
    const char *program, *package;
    unsigned kinds;
} tools[] = {{"spirv-opt", "spirv-tools", OF(OPT) | OF(SIZE) | OF(PASSES)},
             {"spirv-cross", "spirv-cross", OF(CROSS) | OF(SHADERC)},
             {"glslangValidator", "glslang-tools", OF(CROSS)},
             {"glslc", "glslc", OF(SHADERC)},
             {"spirv-val", "spirv-tools", OF_ALL}};

enum status compiler_tools_are_here(const struct compiler *compiler, struct reason *reason)
{
    char path[1024];
    for (size_t i = 0; i < ARRAY_COUNT(tools); i++)
        if (tools[i].kinds & 1u << compiler->kind &&
            !tool_find(tools[i].program, path, sizeof path))
            return fail(reason, STATUS_UNSUPPORTED, "there is no program %s (Debian package %s)",
                        tools[i].program, tools[i].package);
    return STATUS_OK;
}

/* Bytes between two tools: a module or a text. */
struct between {
    char *bytes;
    size_t size;
};

/* Replaces the bytes by what the tool makes of them. */
static enum status run(const char *const *argv, struct between *io, struct reason *reason)
{
    const struct tool_order order = {
        .argv = argv, .in = io->bytes, .in_size = io->size, .most = MODULE_MOST, .ms = TOOL_MS};
    struct tool_answer answer;
    enum status status = tool_run(&order, &answer, reason);
    if (!status) {
        free(io->bytes);
        *io = (struct between){answer.out, answer.size};
        answer.out = NULL;
    }
    tool_free(&answer);
    return status;
}

/* SPIR-V 1.4 is of Vulkan 1.2, what is older of 1.1. */
static const char *target_of(const void *module)
{
    uint32_t header[2];
    memcpy(header, module, sizeof header);
    return header[1] >= 0x00010400u ? "vulkan1.2" : "vulkan1.1";
}

/* spirv-opt writes warnings to the same output, before the module: the lines before it are left
 * out. */
static bool is_module(struct between *io)
{
    static const char magic[] = {0x03, 0x02, 0x23, 0x07};
    size_t at = 0;
    while (at + sizeof magic <= io->size && memcmp(io->bytes + at, magic, sizeof magic) != 0) {
        const char *end = memchr(io->bytes + at, '\n', io->size - at);
        at = end ? (size_t)(end - io->bytes) + 1 : io->size;
    }
    if (io->size - at < 20 || (io->size - at) % 4 != 0)
        return false;
    memmove(io->bytes, io->bytes + at, io->size - at);
    io->size -= at;
    return true;
}

/* --- spirv-opt and programs ------------------------------------------------------------------- */

/* A command line being made: its words point into `text`. */
struct tool_line {
    const char *argv[ARGS_MOST];
    size_t count;
    char text[2 * COMPILER_NAME_MOST + 4 * COMPILER_PASSES_MOST + 64];
    size_t used;
};

static void add(struct tool_line *line, const char *prefix, const char *word, size_t length)
{
    char *at = line->text + line->used;
    const int wrote =
        snprintf(at, sizeof line->text - line->used, "%s%.*s", prefix, (int)length, word);
    line->argv[line->count++] = at;
    line->argv[line->count] = NULL;
    line->used += (size_t)wrote + 1;
}

static void optimizer(struct tool_line *line, const char *target)
{
    *line = (struct tool_line){.count = 0};
    add(line, "", "spirv-opt", 9);
    add(line, "--target-env=", target, strlen(target));
}

static enum status optimize(struct tool_line *line, struct between *io, struct reason *reason)
{
    add(line, "", "-o", 2);
    add(line, "", "-", 1);
    add(line, "", "-", 1);
    enum status status = run(line->argv, io, reason);
    if (!status && !is_module(io))
        status = fail(reason, STATUS_DEVICE, "spirv-opt wrote no SPIR-V module");
    return status;
}

/* Runs the passes in order; those between two programs in one go. */
static enum status run_passes(const char *passes, struct between *io, struct reason *reason)
{
    const char *target = target_of(io->bytes);
    struct tool_line line;
    size_t waiting = 0;
    enum status status = STATUS_OK;
    optimizer(&line, target);
    for (const char *at = passes; *at && !status;) {
        const size_t length = strcspn(at, "+");
        const bool program = memchr(at, '/', length) != NULL;
        if (program && waiting > 0)
            status = optimize(&line, io, reason);
        if (program && !status) {
            line = (struct tool_line){.count = 0};
            add(&line, "", at, length);
            status = run(line.argv, io, reason);
            if (!status && !is_module(io))
                status = fail(reason, STATUS_DEVICE, "%.*s wrote no SPIR-V module",
                              (int)(length < 100 ? length : 100), at);
            optimizer(&line, target);
        } else if (!status) {
            add(&line, "--", at, length);
        }
        waiting = program ? 0 : waiting + 1;
        at += length + (at[length] == '+');
    }
    return !status && waiting > 0 ? optimize(&line, io, reason) : status;
}

static enum status run_level(const char *level, struct between *io, struct reason *reason)
{
    struct tool_line line;
    optimizer(&line, target_of(io->bytes));
    add(&line, "", level, strlen(level));
    return optimize(&line, io, reason);
}

/* --- translators ------------------------------------------------------------------------------ */

static enum status translate(bool shaderc, struct between *io, struct reason *reason)
{
    char target[32];
    const char *const cross[] = {"spirv-cross",        "--version", "460",
                                 "--vulkan-semantics", "-",         NULL};
    /* glslang takes --stdin at the beginning alone. */
    const char *const glslang[] = {
        "glslangValidator", "--stdin", "-S", "comp",        "--quiet", "-V", "-g0",
        "--target-env",     target,    "-o", "/dev/stdout", NULL};
    char environment[48];
    const char *const glslc[] = {"glslc", environment, "-fshader-stage=compute", "-O", "-o", "-",
                                 "-",     NULL};
    snprintf(target, sizeof target, "%s", target_of(io->bytes));
    snprintf(environment, sizeof environment, "--target-env=%s", target);
    enum status status = run(cross, io, reason);
    return status ? status : run(shaderc ? glslc : glslang, io, reason);
}

/* --- all of it -------------------------------------------------------------------------------- */

static enum status run_tools(const struct compiler *compiler, struct between *io,
                             struct reason *reason)
{
    switch (compiler->kind) {
    case COMPILER_OPT:
        return run_level("-O", io, reason);
    case COMPILER_SIZE:
        return run_level("-Os", io, reason);
    case COMPILER_PASSES:
        return run_passes(compiler->passes, io, reason);
    case COMPILER_CROSS:
    case COMPILER_SHADERC:
        return translate(compiler->kind == COMPILER_SHADERC, io, reason);
    case COMPILER_RAW:
    case COMPILER_KINDS:
        break;
    }
    return STATUS_OK;
}

enum status compiler_tools(const struct compiler *compiler, const uint32_t *word, size_t count,
                           uint32_t **out, size_t *out_count, struct reason *reason)
{
    struct between io = {alloc_copy(word, count, sizeof *word), count * sizeof *word};
    *out = NULL;
    *out_count = 0;
    if (!io.bytes)
        return fail(reason, STATUS_MEMORY, "no memory for a shader");
    enum status status = compiler_tools_are_here(compiler, reason);
    if (!status)
        status = run_tools(compiler, &io, reason);
    if (!status && !is_module(&io))
        status = fail(reason, STATUS_DEVICE, "its last tool wrote no SPIR-V module");
    if (!status) {
        *out_count = io.size / sizeof **out;
        *out = alloc_copy(io.bytes, *out_count, sizeof **out);
        if (!*out)
            status = fail(reason, STATUS_MEMORY, "no memory for a shader");
    }
    free(io.bytes);
    return status;
}

enum status compiler_validate(const uint32_t *word, size_t count, struct reason *reason)
{
    const char *const argv[] = {"spirv-val", "--target-env", target_of(word), "-", NULL};
    const struct tool_order order = {.argv = argv,
                                     .in = word,
                                     .in_size = count * sizeof *word,
                                     .most = MODULE_MOST,
                                     .ms = TOOL_MS};
    struct tool_answer answer;
    enum status status = tool_run(&order, &answer, reason);
    tool_free(&answer);
    return status;
}
