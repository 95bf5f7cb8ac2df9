#include "gpu/engines/compiled.h"

#include "ref/twin/model.h"

#include <stdio.h>
#include <string.h>

#define NAME_MOST (COMPILER_NAME_MOST + 64)

/* An engine of this file: what it is made of, and what became of the last shader. */
struct compiled_place {
    char name[NAME_MOST];
    char compiler_text[COMPILER_NAME_MOST + 32];
    struct compiler compiler;
    struct vk_compiler hook;
    struct engine_compiled facts;
};

/* Called before a pipeline is made or found. */
static enum status compile(void *user, struct vk_shader *shader, struct reason *reason)
{
    struct compiled_place *place = user;
    struct compiled made;
    enum status status = compiler_run(&place->compiler, shader, &made, reason);
    place->facts.words = made.count;
    if (status)
        return status;
    place->facts.source = made.source;
    place->facts.ops = made.ops;
    place->facts.kept = made.kept;
    place->facts.signs = made.signs;
    place->facts.foreign = made.foreign;
    shader->ways = place->hook.ways;
    shader->words = made.words_of;
    shader->word = made.word;
    shader->word_count = made.count;
    return STATUS_OK;
}

/* Whether the answers must have the bits of the engine as built. A translator may have no word for
 * a decoration; what it leaves undecorated a driver may contract, which is right within the same
 * bounds. Of a translator whose module is not known yet nothing is promised. */
static bool promised(const struct compiled_place *place)
{
    const struct engine_compiled *facts = &place->facts;
    if (facts->free)
        return false;
    return !facts->translates || (facts->words > 0 && engine_compiled_loose(facts) == 0);
}

/* Traversal without a formula of ours, or of every triangle: the same driver does the same again.
 */
static bool repeats(const struct engine *raw, const struct model *model)
{
    return raw->own_tri || (raw->brute && model->rounding.div <= 1.0);
}

static struct model compiled_model(const struct engine *engine, void *self,
                                   const struct tri_test *tri)
{
    struct compiled_place *place = engine->named;
    const struct engine *raw = place->facts.raw;
    struct model model = engine_model(raw, self, tri);
    const bool keeps = promised(place);
    place->facts.equal = keeps && (model.bits || repeats(raw, &model));
    model.bits = keeps && model.bits;
    model.watertight = keeps && model.watertight;
    return model;
}

static enum status compiled_open(const struct engine *engine, const struct engine_options *options,
                                 void **self, struct reason *reason)
{
    struct compiled_place *place = engine->named;
    struct engine_options own = *options;
    own.compiler = &place->hook;
    return engine_open(place->facts.raw, &own, self, reason);
}

bool compiled_takes(const struct engine *engine)
{
    static const char *const takes[] = {"vulkan", "vulkan_brute", "vulkan_stackless", "rayquery"};
    for (size_t i = 0; i < ARRAY_COUNT(takes); i++)
        if (strcmp(engine->name, takes[i]) == 0)
            return true;
    return false;
}

const struct engine *compiled_base(const char *name)
{
    const char *colon = strchr(name, ':');
    for (size_t i = 0; colon && engines[i]; i++)
        if (strlen(engines[i]->name) == (size_t)(colon - name) &&
            strncmp(engines[i]->name, name, (size_t)(colon - name)) == 0)
            return compiled_takes(engines[i]) ? engines[i] : NULL;
    return NULL;
}

static enum status add(const struct engine *raw, const struct compiler *compiler, const char *name,
                       const struct engine **out, struct reason *reason)
{
    static struct compiled_place places[ENGINES_COMPILED_MOST];
    static size_t place_count;
    if (place_count == ARRAY_COUNT(places))
        return fail(reason, STATUS_LIMIT, "%.80s: more than %d engines with compiled shaders", name,
                    ENGINES_COMPILED_MOST);
    struct compiled_place *place = &places[place_count];
    snprintf(place->name, sizeof place->name, "%s", name);
    place->compiler = *compiler;
    compiler_name(compiler, place->compiler_text);
    place->hook = (struct vk_compiler){compile, place, compiler_ways(compiler)};
    place->facts = (struct engine_compiled){.compiler = place->compiler_text,
                                            .raw = raw,
                                            .translates = compiler_translates(compiler),
                                            .free = compiler->decorate == DECORATE_NONE};
    struct engine engine = *raw;
    engine.name = place->name;
    engine.summary = "its shaders as a compiler makes them";
    engine.named = place;
    engine.open = compiled_open;
    engine.model = compiled_model;
    engine.compiled = &place->facts;
    engine.compiles = true;
    enum status status = engine_add(&engine, out, reason);
    place_count += !status;
    return status;
}

enum status compiled_make(const struct engine *raw, const struct compiler *compiler,
                          const struct engine **out, struct reason *reason)
{
    char name[NAME_MOST], text[COMPILER_NAME_MOST + 32];
    struct reason why = {""};
    compiler_name(compiler, text);
    snprintf(name, sizeof name, "%.30s:%s", raw->name, text);
    *out = compiler_changes_nothing(compiler) ? raw : engine_find(name);
    if (*out)
        return STATUS_OK;
    enum status status = compiler_check(compiler, &why);
    if (status)
        return fail(reason, status, "%.80s: %.220s", text, why.text);
    return add(raw, compiler, name, out, reason);
}

enum status compiled_engine(const char *name, const struct engine **out, struct reason *reason)
{
    struct compiler compiler;
    const struct engine *raw = compiled_base(name);
    *out = NULL;
    if (!raw)
        return fail(reason, STATUS_INPUT,
                    "'%.60s': only vulkan, vulkan_brute, vulkan_stackless and rayquery have "
                    "shaders to compile",
                    name);
    enum status status = compiler_parse(strchr(name, ':') + 1, &compiler, reason);
    return status ? status : compiled_make(raw, &compiler, out, reason);
}

/* The compiler of an engine, as if it read storage buffers; its memory is put into *memory. */
static struct compiler compiler_of(const struct engine *engine, enum memory *memory)
{
    struct compiler compiler = {.decorate = DECORATE_SOURCE};
    if (engine->compiled)
        compiler = ((const struct compiled_place *)engine->named)->compiler;
    *memory = compiler.memory;
    compiler.memory = MEMORY_STORAGE;
    return compiler;
}

bool compiled_other_memory(const struct engine *a, const struct engine *b)
{
    char of_a[COMPILER_NAME_MOST + 32], of_b[COMPILER_NAME_MOST + 32];
    enum memory memory_a, memory_b;
    const struct compiler by_a = compiler_of(a, &memory_a), by_b = compiler_of(b, &memory_b);
    const struct engine *raw_a = a->compiled ? a->compiled->raw : a;
    const struct engine *raw_b = b->compiled ? b->compiled->raw : b;
    compiler_name(&by_a, of_a);
    compiler_name(&by_b, of_b);
    return raw_a == raw_b && compiled_takes(raw_a) && memory_a != memory_b &&
           strcmp(of_a, of_b) == 0;
}
