#include "gpu/shaders/compiler_tools.h"

#include "ref/outside/tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TOOL_MS     120000u
#define MODULE_MOST ((size_t)64 << 20)
#define ARGS_MOST   (COMPILER_LIST_MOST + 8)

/* Programs by the compilers that run them: bit 1 << kind. */
#define OF(kind) (1u << COMPILER_##kind)
#define OF_ALL   (OF(OPT) | OF(SIZE) | OF(PASSES) | OF(CROSS) | OF(HLSL) | OF(SHADERC))

static const struct {
    const char *program, *package;
    unsigned kinds;
} tools[] = {{"spirv-opt", "spirv-tools", OF(OPT) | OF(SIZE) | OF(PASSES)},
             {"spirv-cross", "spirv-cross", OF(CROSS) | OF(HLSL) | OF(SHADERC)},
             {"glslangValidator", "glslang-tools", OF(CROSS) | OF(HLSL)},
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
    char text[COMPILER_LIST_BYTES];
    size_t used;
};

/* The passes of a list take at most half of the bytes: see compiler_list. */
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

static enum status run_program(const char *program, struct between *io, struct reason *reason)
{
    const char *const argv[] = {program, NULL};
    enum status status = run(argv, io, reason);
    if (!status && !is_module(io))
        status = fail(reason, STATUS_DEVICE, "%.100s wrote no SPIR-V module", program);
    return status;
}

/* Runs the passes in order; those between two programs in one go. */
static enum status run_list(const char *const *pass, size_t count, struct between *io,
                            struct reason *reason)
{
    const char *target = target_of(io->bytes);
    struct tool_line line;
    size_t waiting = 0;
    enum status status = STATUS_OK;
    optimizer(&line, target);
    for (size_t i = 0; i < count && !status; i++) {
        const bool program = strchr(pass[i], '/') != NULL;
        if (program && waiting > 0) {
            status = optimize(&line, io, reason);
            optimizer(&line, target);
        }
        if (program && !status)
            status = run_program(pass[i], io, reason);
        else if (!program)
            add(&line, "--", pass[i], strlen(pass[i]));
        waiting = program ? 0 : waiting + 1;
    }
    return !status && waiting > 0 ? optimize(&line, io, reason) : status;
}

static enum status run_passes(const char *passes, struct between *io, struct reason *reason)
{
    char text[COMPILER_NAME_MOST];
    const char *pass[COMPILER_PASSES_MOST];
    const size_t count = compiler_split(passes, text, pass);
    return run_list(pass, count, io, reason);
}

static enum status run_level(const char *level, struct between *io, struct reason *reason)
{
    struct tool_line line;
    optimizer(&line, target_of(io->bytes));
    add(&line, "", level, strlen(level));
    return optimize(&line, io, reason);
}

/* --- translators ------------------------------------------------------------------------------ */

/* What a translator says is wrong with a shader is what its language lacks. */
static enum status cannot(enum status status, const char *to, struct reason *reason)
{
    const struct reason why = *reason;
    return status == STATUS_DEVICE
               ? fail(reason, STATUS_UNSUPPORTED, "no way through %s: %.200s", to, why.text)
               : status;
}

static enum status glslang(const char *const *more, const char *target, struct between *io,
                           struct reason *reason)
{
    /* --stdin is taken at the beginning alone. */
    const char *argv[ARGS_MOST] = {
        "glslangValidator", "--stdin", "-S", "comp",       "--quiet", "-V",
        "--target-env",     target,    "-o", "/dev/stdout"};
    size_t count = 0;
    while (argv[count])
        count++;
    while (more && *more)
        argv[count++] = *more++;
    return run(argv, io, reason);
}

static enum status through_glsl(bool shaderc, struct between *io, struct reason *reason)
{
    char environment[48];
    const char *target = target_of(io->bytes);
    const char *const cross[] = {"spirv-cross",        "--version", "460",
                                 "--vulkan-semantics", "-",         NULL};
    const char *const glslc[] = {"glslc", environment, "-fshader-stage=compute", "-O", "-o", "-",
                                 "-",     NULL};
    snprintf(environment, sizeof environment, "--target-env=%s", target);
    enum status status = run(cross, io, reason);
    if (!status)
        status = shaderc ? run(glslc, io, reason) : glslang(NULL, target, io, reason);
    return cannot(status, "GLSL", reason);
}

/* HLSL has no push constants: SPIRV-Cross makes a buffer of them, which is marked. */
static enum status mark_push(struct between *io, struct reason *reason)
{
    static const char buffer[] = "\ncbuffer ", mark[] = "\n[[vk::push_constant]] cbuffer ";
    char *at = strstr(io->bytes, buffer);
    if (!at)
        return STATUS_OK;
    const size_t before = (size_t)(at - io->bytes), more = sizeof mark - sizeof buffer;
    char *text = alloc_zeroed(io->size + more + 1, 1);
    if (!text)
        return fail(reason, STATUS_MEMORY, "no memory for a shader");
    memcpy(text, io->bytes, before);
    memcpy(text + before, mark, sizeof mark - 1);
    memcpy(text + before + sizeof mark - 1, at + sizeof buffer - 1,
           io->size - before - (sizeof buffer - 1));
    free(io->bytes);
    *io = (struct between){text, io->size + more};
    return STATUS_OK;
}

static enum status through_hlsl(const struct vk_shader *shader, struct between *io,
                                struct reason *reason)
{
    const char *const cross[] = {"spirv-cross", "--hlsl", "--shader-model", "60", "-", NULL};
    char value[VK_CONSTANTS_MAX][64];
    const char *more[VK_CONSTANTS_MAX + 4] = {"-D", "-e", "main"};
    const char *target = target_of(io->bytes);
    for (uint32_t i = 0; i < shader->constant_count; i++) {
        snprintf(value[i], sizeof value[i], "-DSPIRV_CROSS_CONSTANT_ID_%u=%uu", i,
                 shader->constant[i]);
        more[3 + i] = value[i];
    }
    enum status status = run(cross, io, reason);
    if (!status)
        status = mark_push(io, reason);
    if (!status)
        status = glslang(more, target, io, reason);
    return cannot(status, "HLSL", reason);
}

/* --- all of it -------------------------------------------------------------------------------- */

static enum status run_tools(const struct compiler *compiler, const struct vk_shader *shader,
                             struct between *io, struct reason *reason)
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
        return through_glsl(compiler->kind == COMPILER_SHADERC, io, reason);
    case COMPILER_HLSL:
        return through_hlsl(shader, io, reason);
    case COMPILER_RAW:
    case COMPILER_KINDS:
        break;
    }
    return STATUS_OK;
}

size_t compiler_split(const char *passes, char text[COMPILER_NAME_MOST],
                      const char *pass[COMPILER_PASSES_MOST])
{
    size_t count = 0;
    snprintf(text, COMPILER_NAME_MOST, "%s", passes);
    for (char *rest = text, *at; *rest && count < COMPILER_PASSES_MOST;) {
        at = rest;
        rest += strcspn(rest, "+");
        if (*rest)
            *rest++ = '\0';
        pass[count++] = at;
    }
    return count;
}

/* Words of a tool's bytes, in memory of their own. */
static enum status words_of(const struct between *io, uint32_t **out, size_t *count,
                            struct reason *reason)
{
    *count = io->size / sizeof **out;
    *out = alloc_copy(io->bytes, *count, sizeof **out);
    return *out ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for a shader");
}

enum status compiler_list(const char *const *pass, size_t count, const uint32_t *word,
                          size_t word_count, uint32_t **out, size_t *out_count,
                          struct reason *reason)
{
    size_t bytes = 0;
    *out = NULL;
    *out_count = 0;
    for (size_t i = 0; i < count; i++)
        bytes += strlen(pass[i]) + 3;
    if (count > COMPILER_LIST_MOST || bytes > COMPILER_LIST_BYTES / 2)
        return fail(reason, STATUS_LIMIT, "more than %d passes, or %d bytes of their names",
                    COMPILER_LIST_MOST, COMPILER_LIST_BYTES / 2);
    struct between io = {alloc_copy(word, word_count, sizeof *word), word_count * sizeof *word};
    if (!io.bytes)
        return fail(reason, STATUS_MEMORY, "no memory for a shader");
    enum status status = run_list(pass, count, &io, reason);
    if (!status)
        status = words_of(&io, out, out_count, reason);
    free(io.bytes);
    return status;
}

enum status compiler_level_passes(const struct compiler *compiler, char **text,
                                  struct reason *reason)
{
    static const char *const argv[] = {"spirv-opt", "--help", NULL};
    const struct tool_order order = {.argv = argv, .most = MODULE_MOST, .ms = TOOL_MS};
    const char *const head = compiler->kind == COMPILER_SIZE ? "\n  -Os\n" : "\n  -O\n";
    struct tool_answer answer;
    *text = NULL;
    enum status status = tool_run(&order, &answer, reason);
    const char *at = status ? NULL : strstr(answer.out, head);
    char *out = at ? alloc_zeroed(strlen(at) + 1, 1) : NULL;
    if (!status && !at)
        status = fail(reason, STATUS_DEVICE, "spirv-opt --help does not say what %.4s stands for",
                      head + 3);
    else if (!status && !out)
        status = fail(reason, STATUS_MEMORY, "no memory for a list of passes");
    /* The names stand in lines of their own behind two tabs. */
    for (bool begun = false; out && *at; at += strcspn(at, "\n"), at += *at == '\n') {
        const bool name = strncmp(at, "\t\t", 2) == 0;
        if (begun && !name)
            break;
        begun = name;
        if (name)
            snprintf(out + strlen(out), strlen(at) + 1, "%.*s\n", (int)strcspn(at + 2, "\n"),
                     at + 2);
    }
    tool_free(&answer);
    *text = out;
    return status;
}

enum status compiler_tools(const struct compiler *compiler, const struct vk_shader *shader,
                           uint32_t **out, size_t *out_count, struct reason *reason)
{
    struct between io = {alloc_copy(shader->word, shader->word_count, sizeof *shader->word),
                         shader->word_count * sizeof *shader->word};
    *out = NULL;
    *out_count = 0;
    if (!io.bytes)
        return fail(reason, STATUS_MEMORY, "no memory for a shader");
    enum status status = compiler_tools_are_here(compiler, reason);
    if (!status)
        status = run_tools(compiler, shader, &io, reason);
    if (!status && !is_module(&io))
        status = fail(reason, STATUS_DEVICE, "its last tool wrote no SPIR-V module");
    if (!status)
        status = words_of(&io, out, out_count, reason);
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
