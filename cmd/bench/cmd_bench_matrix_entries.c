/* The contestants of the matrix. */
#include "cmd/bench/cmd_bench_matrix.h"

#include "ref/engines/embree_modes.h"
#include "ref/store.h"

#include <string.h>

/* The default contestants: modes of Embree, and engines on trees. */
static const struct {
    const char *engine;
    bool compact, avx512;
} own_modes[] = {{"embree", false, false},        {"embree", false, true},
                 {"embree_robust", false, false}, {"embree", true, false},
                 {"embree_16", false, false},     {"embree_high", false, false}};

static const struct {
    const char *engine, *layout, *store, *builder;
    uint32_t passes;
} own_trees[] = {
    {"fast", "f32", "indexed", "sah_binned", 0},
    {"fast", "f32", "indexed", "sah_binned", BUILD_PASSES_DEFAULT},
    {"fast", "f32", "indexed", "sah_sweep", 0},
    {"fast", "f32", "indexed", "sbvh", 0},
    {"cpu", "f32", "indexed", "sah_binned", 0},
    {"cpu", "f32", "gathered", "sah_binned", 0},
    {"cpu", "f32", "compact", "sah_binned", 0},
    {"cpu", "rf16", "indexed", "sah_binned", 0},
    {"cpu", "bvh8_u8_node", "indexed", "sah_binned", 0},
    {"cpu", "cwbvh80", "indexed", "sah_binned", 0},
    {"cpu", "tiny8", "indexed", "sah_binned", 0},
    {"cpu", "tiny8_l14", "indexed", "sah_binned", 0},
};

bool matrix_entry_is_gpu(const struct matrix_entry *entry)
{
    return entry->engine->gpu;
}

bool matrix_collapses(const struct engine *engine)
{
    return engine->needs_packed && engine->own_tree && engine->own_tri;
}

static const struct engine *engine_of(const char *name)
{
    for (size_t i = 0; embree_modes[i]; i++)
        if (strcmp(embree_modes[i]->name, name) == 0)
            return embree_modes[i];
    return engine_find(name);
}

/* Writes the name: "cpu tiny8 compact", "fast sah_binned reinsert=4", "embree compact". */
static void name_entry(struct matrix_entry *e)
{
    bool fast = matrix_collapses(e->engine);
    const char *store = e->store && e->store != tri_stores[0] ? e->store->name : NULL;
    char name[BENCH_ENGINE_NAME];
    int used = snprintf(e->name, sizeof e->name, "%s%s%s", bench_engine_name(e->engine, name),
                        e->compact ? " compact" : "", e->avx512 ? " avx512" : "");
    if (e->layout && !fast)
        used += snprintf(e->name + used, sizeof e->name - (size_t)used, " %.20s%s%.16s",
                         e->layout->name, store ? " " : "", store ? store : "");
    if (e->builder && fast)
        used += snprintf(e->name + used, sizeof e->name - (size_t)used, " %.16s", e->builder->name);
    if (e->passes)
        (void)snprintf(e->name + used, sizeof e->name - (size_t)used, " reinsert=%u", e->passes);
}

static enum status add(struct matrix_entries *out, const struct matrix_entry *entry,
                       struct reason *reason)
{
    if (out->count == CONTESTANTS)
        return fail(reason, STATUS_LIMIT,
                    "more than %d contestants: --engine, --layout and --store name fewer",
                    CONTESTANTS);
    out->entry[out->count] = *entry;
    name_entry(&out->entry[out->count++]);
    return STATUS_OK;
}

static enum status add_own(struct matrix_entries *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < ARRAY_COUNT(own_modes) && !status; i++) {
        const struct matrix_entry entry = {.engine = engine_of(own_modes[i].engine),
                                           .compact = own_modes[i].compact,
                                           .avx512 = own_modes[i].avx512};
        status = add(out, &entry, reason);
    }
    for (size_t i = 0; i < ARRAY_COUNT(own_trees) && !status; i++) {
        const struct matrix_entry entry = {.engine = engine_find(own_trees[i].engine),
                                           .layout = layout_find(own_trees[i].layout),
                                           .store = tri_store_find(own_trees[i].store),
                                           .builder = builder_find(own_trees[i].builder),
                                           .passes = own_trees[i].passes};
        status = add(out, &entry, reason);
    }
    return status;
}

/* Adds the entry's layout on each named storage. With `once`, `indexed` was added before and is
 * skipped. */
static enum status add_stores(const struct bench *bench, const struct matrix_entry *entry,
                              bool once, struct matrix_entries *out, struct reason *reason)
{
    const struct list *list = &bench->store;
    struct matrix_entry stored = *entry;
    enum status status = STATUS_OK;
    for (size_t i = 0; i < (list->count ? list->count : 1) && !status; i++) {
        stored.store = tri_stores[list->count ? list->index[i] : 0];
        if (!once || stored.store != tri_stores[0])
            status = add(out, &stored, reason);
    }
    return status;
}

static enum status add_layouts(const struct bench *bench, const struct engine *engine,
                               struct matrix_entries *out, struct reason *reason)
{
    const struct list *list = &bench->layout;
    struct matrix_entry entry = {
        .engine = engine, .store = tri_stores[0], .builder = builder_find("sah_binned")};
    enum status status = STATUS_OK;
    entry.layout = layouts[0];
    bool fast = matrix_collapses(engine);
    if (fast || matrix_entry_is_gpu(&entry))
        status = add(out, &entry, reason);
    for (size_t l = 0; layouts_all[l] && !fast && !status; l++) {
        bool f32 = layouts_all[l] == layouts[0];
        bool named =
            list->count == 0 && !layouts_all[l]->faithful && (bench->store.count == 0 || f32);
        if (!named && !list_has(list, l))
            continue;
        entry.layout = layouts_all[l];
        status = add_stores(bench, &entry, f32 && matrix_entry_is_gpu(&entry), out, reason);
    }
    return status;
}

bool matrix_is_gpu(const struct bench *bench)
{
    const struct list *list = &bench->engine;
    bool gpu = list->count > 0;
    for (size_t i = 0; i < list->count; i++)
        gpu = gpu && engines[list->index[i]]->gpu;
    return gpu;
}

enum status matrix_entries_make(const struct bench *bench, struct matrix_entries *out,
                                struct reason *reason)
{
    const struct list *list = &bench->engine;
    enum status status = STATUS_OK;
    out->count = 0;
    if (list->count == 0 && bench->layout.count == 0 && bench->store.count == 0)
        return add_own(out, reason);
    const struct matrix_entry embree = {.engine = engine_of("embree")};
    if (!matrix_is_gpu(bench))
        status = add(out, &embree, reason);
    if (list->count == 0 && !status)
        status = add_layouts(bench, engine_reference(true), out, reason);
    for (size_t i = 0; i < list->count && !status; i++) {
        const struct engine *engine = engines[list->index[i]];
        const struct matrix_entry entry = {.engine = engine};
        if (engine->brute)
            return fail(reason, STATUS_INPUT, "--engine %s: tests every triangle", engine->name);
        if (list->count == 1 && engine->own_tree && engine->own_tri && bench->store.count > 0)
            return fail(reason, STATUS_INPUT, "--store: engine %s stores triangles its own way",
                        engine->name);
        if (engine->needs_packed)
            status = add_layouts(bench, engine, out, reason);
        else if (engine != embree.engine)
            status = add(out, &entry, reason);
    }
    return status;
}
