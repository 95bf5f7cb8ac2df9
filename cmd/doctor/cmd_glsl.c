/* Compiles the shader of a layout from outside, with glslang's C interface. This is part of the
 * program, since the library is not linked with glslang. */
#include "cmd/doctor/cmd_glsl.h"

#include "ref/outside/plugin_shader.h"
#include "gpu/shaders/glsl_text.h"
#include "gpu/shaders/shaders.h"
#include "ref/files/file.h"

#include "have_glslang.h"

#include <stdio.h>
#include <stdlib.h>

#if HAVE_GLSLANG
#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>

static enum status read_whole(const char *path, char **bytes, size_t *size, struct reason *reason)
{
    return file_read_most(path, GLSL_TEXT_MOST, bytes, size, reason);
}

/* The modules of one text; *program is freed by the caller, and holds *word. */
static enum status link(const struct glsl_text *text, glslang_shader_t *shader, int messages,
                        glslang_program_t *program, struct reason *reason)
{
    glslang_spv_options_t options = {.disable_optimizer = true};
    glslang_program_add_shader(program, shader);
    if (!glslang_program_link(program, messages))
        return glsl_text_blame(text, glslang_program_get_info_log(program), reason);
    glslang_program_SPIRV_generate_with_options(program, GLSLANG_STAGE_COMPUTE, &options);
    return STATUS_OK;
}

/* What is done with a module. */
typedef enum status take_fn(const struct glsl_text *text, const uint32_t *word, size_t count,
                            void *user, struct reason *reason);

static enum status compile(const struct glsl_text *text, take_fn *take, void *user,
                           struct reason *reason)
{
    const glslang_input_t input = {
        .language = GLSLANG_SOURCE_GLSL,
        .stage = GLSLANG_STAGE_COMPUTE,
        .client = GLSLANG_CLIENT_VULKAN,
        .client_version = GLSLANG_TARGET_VULKAN_1_1,
        .target_language = GLSLANG_TARGET_SPV,
        .target_language_version = GLSLANG_TARGET_SPV_1_3,
        .code = text->text,
        .default_version = 450,
        .default_profile = GLSLANG_NO_PROFILE,
        .messages = GLSLANG_MSG_SPV_RULES_BIT | GLSLANG_MSG_VULKAN_RULES_BIT,
        .resource = glslang_default_resource(),
    };
    glslang_shader_t *shader = glslang_shader_create(&input);
    enum status status;
    if (!shader)
        return fail(reason, STATUS_MEMORY, "glslang: no memory for a shader");
    if (!glslang_shader_preprocess(shader, &input) || !glslang_shader_parse(shader, &input)) {
        status = glsl_text_blame(text, glslang_shader_get_info_log(shader), reason);
    } else {
        glslang_program_t *program = glslang_program_create();
        status = link(text, shader, (int)input.messages, program, reason);
        if (!status)
            status = take(text, glslang_program_SPIRV_get_ptr(program),
                          glslang_program_SPIRV_get_size(program), user, reason);
        glslang_program_delete(program);
    }
    glslang_shader_delete(shader);
    return status;
}

struct of_layout {
    const struct layout *layout;
    enum glsl_use use;
};

static enum status add_to_layout(const struct glsl_text *text, const uint32_t *word, size_t count,
                                 void *user, struct reason *reason)
{
    const struct of_layout *of = user;
    return shader_add(of->layout->name, of->use, text->file[0], word, count, reason);
}

struct copied {
    uint32_t *word;
    size_t count;
};

static enum status copy(const struct glsl_text *text, const uint32_t *word, size_t count,
                        void *user, struct reason *reason)
{
    struct copied *out = user;
    out->word = alloc_copy(word, count, sizeof *word);
    out->count = count;
    return out->word ? STATUS_OK : fail(reason, STATUS_MEMORY, "%.120s: no memory", text->file[0]);
}

enum status cmd_glsl_tracer(const char *path, uint32_t **word, size_t *count, struct reason *reason)
{
    struct copied out = {NULL, 0};
    struct glsl_text text = {.files = 1};
    snprintf(text.file[0], sizeof text.file[0], "%s", path);
    enum status status = read_whole(path, &text.text, &text.size, reason);
    if (!status && !glslang_initialize_process())
        status = fail(reason, STATUS_INTERNAL, "glslang cannot be initialized");
    else if (!status) {
        status = compile(&text, copy, &out, reason);
        glslang_finalize_process();
    }
    glsl_text_free(&text);
    *word = out.word;
    *count = out.count;
    return status;
}

enum status cmd_glsl_compile(const struct layout *layout, const char *file, struct reason *reason)
{
    enum status status = STATUS_OK;
    if (!glslang_initialize_process())
        return fail(reason, STATUS_INTERNAL, "glslang cannot be initialized");
    for (enum glsl_use use = 0; use < GLSL_USES && !status; use++) {
        struct glsl_text text;
        status = glsl_text_make(file, use, read_whole, &text, reason);
        if (!status)
            status = compile(&text, add_to_layout, &(struct of_layout){layout, use}, reason);
        glsl_text_free(&text);
        if (use == GLSL_DECODE && status == STATUS_INPUT) { /* tracing works without it */
            shader_lacks(layout->name, reason->text);
            status = STATUS_OK;
        }
    }
    glslang_finalize_process();
    return status;
}
#else
enum status cmd_glsl_tracer(const char *path, uint32_t **word, size_t *count, struct reason *reason)
{
    *word = NULL;
    *count = 0;
    return fail(reason, STATUS_UNSUPPORTED,
                "cannot compile %.120s: raydiff was built without glslang (Debian package "
                "glslang-dev); name a .spv",
                path);
}

enum status cmd_glsl_compile(const struct layout *layout, const char *file, struct reason *reason)
{
    char *bytes = NULL;
    size_t size;
    struct reason why;
    enum status status = file_read_most(file, GLSL_TEXT_MOST, &bytes, &size, reason);
    free(bytes);
    if (status)
        return status;
    (void)fail(&why, STATUS_UNSUPPORTED,
               "cannot compile %.120s: raydiff was built without glslang (Debian package "
               "glslang-dev)",
               file);
    shader_lacks(layout->name, why.text);
    return STATUS_OK;
}
#endif
