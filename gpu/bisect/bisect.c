#include "gpu/bisect/bisect_inner.h"

#include "gpu/shaders/compiler_tools.h"

#include <stdlib.h>
#include <string.h>

const char *const symptom_names[SYMPTOM_COUNT + 1] = {"wrong", "bits", "precise", NULL};

enum status bisect_loses(const struct compiler *compiler, const struct vk_shader *shader,
                         const uint32_t *word, size_t count, unsigned *loss, struct reason *reason)
{
    struct compiled found;
    enum status status = compiler_look(shader, word, count, &found, reason);
    *loss = 0;
    if (status || compiler->decorate == DECORATE_NONE)
        return status;
    const uint32_t signs = compiler_translates(compiler) ? found.signs : 0;
    if (found.ops - found.kept > signs)
        *loss |= LOSS_DECORATION;
    if (found.foreign > 0)
        *loss |= LOSS_OPEN;
    return STATUS_OK;
}

enum delta_answer bisect_stop(struct bisect_search *search, enum status status,
                              const struct reason *reason)
{
    if (!search->status) {
        search->status = status;
        if (reason)
            *search->reason = *reason;
    }
    return DELTA_STOP;
}

/* --- modules that were tried ------------------------------------------------------------------ */

static uint64_t hash_of(const struct bisect_module *module)
{
    uint64_t hash = 0xCBF29CE484222325u;
    for (size_t i = 0; i < module->count; i++)
        hash = (hash ^ module->word[i]) * 0x100000001B3u;
    return hash;
}

static const struct bisect_tried *find_tried(const struct bisect_search *search, uint64_t hash,
                                             const struct bisect_module *module)
{
    for (size_t i = 0; i < search->tried_count; i++) {
        const struct bisect_tried *tried = &search->tried[i];
        if (tried->hash == hash && tried->module.count == module->count &&
            memcmp(tried->module.word, module->word, 4 * module->count) == 0)
            return tried;
    }
    return NULL;
}

/* Keeps the module, or frees it. */
static void keep(struct bisect_search *search, uint64_t hash, struct bisect_module module,
                 enum delta_answer answer)
{
    if (answer == DELTA_STOP || array_reserve(&search->tried, &search->tried_capacity,
                                              search->tried_count + 1, sizeof *search->tried))
        free(module.word);
    else
        search->tried[search->tried_count++] = (struct bisect_tried){hash, module, answer};
}

/* --- one module ------------------------------------------------------------------------------- */

static enum delta_answer ask_whole(struct bisect_search *search, const struct bisect_module *module)
{
    const struct bisect_job *job = search->job;
    struct reason reason = {""};
    enum status status = compiler_validate(module->word, module->count, &reason);
    if (status == STATUS_DEVICE)
        return DELTA_UNRESOLVED;
    if (status)
        return bisect_stop(search, status, &reason);
    if (job->symptom != SYMPTOM_PRECISE)
        return job->play(job->user, module->word, module->count);
    unsigned loss;
    status =
        bisect_loses(&job->compiler, &job->shader, module->word, module->count, &loss, &reason);
    if (status)
        return bisect_stop(search, status, &reason);
    return loss & job->loss ? DELTA_SHOWS : DELTA_SHOWS_NOT;
}

enum delta_answer bisect_ask(struct bisect_search *search, struct bisect_module module)
{
    struct reason reason = {""};
    enum status status =
        compiler_finish(&search->job->compiler, &module.word, &module.count, &reason);
    if (status == STATUS_MEMORY)
        bisect_stop(search, status, &reason);
    if (status) {
        free(module.word);
        return search->status ? DELTA_STOP : DELTA_UNRESOLVED;
    }
    const uint64_t hash = hash_of(&module);
    const struct bisect_tried *tried = find_tried(search, hash, &module);
    if (tried) {
        free(module.word);
        return tried->answer;
    }
    const enum delta_answer answer = ask_whole(search, &module);
    if (answer == DELTA_STOP)
        bisect_stop(search, STATUS_DEVICE, NULL);
    keep(search, hash, module, answer);
    return answer;
}

enum status bisect_make(const struct bisect_search *search, const bool *in,
                        struct bisect_module *out, struct reason *reason)
{
    const struct bisect *bisect = search->out;
    const char *pass[COMPILER_LIST_MOST];
    size_t count = 0;
    *out = (struct bisect_module){0};
    for (size_t i = 0; in && i < bisect->pass_count; i++)
        if (in[i])
            pass[count++] = bisect->pass[i];
    return compiler_list(pass, count, search->begun.word, search->begun.count, &out->word,
                         &out->count, reason);
}

/* --- all of it -------------------------------------------------------------------------------- */

static enum status split(const char *text, char between, struct bisect *out, struct reason *reason)
{
    size_t most = 1, count = 0;
    for (const char *at = text; *at; at++)
        most += *at == between;
    out->text = alloc_copy(text, strlen(text) + 1, 1);
    out->pass = alloc_zeroed(most, sizeof *out->pass);
    out->in = alloc_zeroed(most, sizeof *out->in);
    if (!out->text || !out->pass || !out->in)
        return fail(reason, STATUS_MEMORY, "no memory for a list of passes");
    for (char *at = out->text; *at;) {
        char *end = strchr(at, between);
        out->pass[count++] = at;
        at = end ? end + 1 : at + strlen(at);
        if (end)
            *end = '\0';
    }
    out->pass_count = count;
    return count > COMPILER_LIST_MOST
               ? fail(reason, STATUS_LIMIT, "more than %d passes", COMPILER_LIST_MOST)
               : STATUS_OK;
}

static enum status list_passes(const struct compiler *compiler, struct bisect *out,
                               struct reason *reason)
{
    if (compiler->kind == COMPILER_PASSES || compiler->kind == COMPILER_RAW) /* raw has none */
        return split(compiler->passes, '+', out, reason);
    char *text;
    enum status status = compiler_level_passes(compiler, &text, reason);
    if (!status)
        status = split(text, '\n', out, reason);
    free(text);
    return status;
}

/* The compiler's own module, before decorations that come last. */
static enum status whole_module(const struct bisect_search *search, struct bisect_module *out,
                                struct reason *reason)
{
    struct vk_shader shader = search->job->shader;
    shader.word = search->begun.word;
    shader.word_count = (uint32_t)search->begun.count;
    return compiler_tools(&search->job->compiler, &shader, &out->word, &out->count, reason);
}

/* Whether its work is a list of passes; else it is a translator's. */
static bool is_list(const struct compiler *compiler)
{
    return compiler->kind == COMPILER_RAW || compiler->kind == COMPILER_OPT ||
           compiler->kind == COMPILER_SIZE || compiler->kind == COMPILER_PASSES;
}

enum status bisect_run(const struct bisect_job *job, struct bisect *out, struct reason *reason)
{
    struct bisect_search search = {.job = job, .out = out, .reason = reason};
    struct bisect_module module = {0};
    *out = (struct bisect){0};
    enum status status = compiler_begin(&job->compiler, &job->shader, &search.begun.word,
                                        &search.begun.count, reason);
    if (!status && is_list(&job->compiler)) {
        status = list_passes(&job->compiler, out, reason);
        if (!status)
            bisect_passes(&search);
    } else if (!status) {
        status = whole_module(&search, &module, reason);
        if (!status)
            bisect_decorations(&search, module);
    }
    for (size_t i = 0; i < search.tried_count; i++)
        free(search.tried[i].module.word);
    free(search.tried);
    free(search.begun.word);
    return status ? status : search.status;
}

void bisect_free(struct bisect *bisect)
{
    free(bisect->text);
    free(bisect->pass);
    free(bisect->in);
    *bisect = (struct bisect){0};
}
