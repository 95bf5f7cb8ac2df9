#include "cmd/common/cmd_explain_line.h"

#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/base/ray_text.h"
#include "ref/outside/plugin_shader.h"
#include "ref/store.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Appends printf-formatted text as far as it fits. */
static void append(char text[EXPLAIN_COMMAND_MOST], const char *format, const char *word)
{
    size_t used = strlen(text);
    snprintf(text + used, EXPLAIN_COMMAND_MOST - used, format, word);
}

/* How the tree was built, as far as its builder reads it. */
static void append_build(const struct explain_of *of, const struct option_use *use,
                         char text[EXPLAIN_COMMAND_MOST])
{
    const struct build_options *build = &of->build;
    const struct {
        const char *name;
        bool differs;
        double value;
    } options[] = {{"leaf", build->leaf != BUILD_LEAF_DEFAULT, build->leaf},
                   {"eps", build->eps != BUILD_EPS_DEFAULT, (double)build->eps},
                   {"bins", build->bins != 0, build->bins},
                   {"radius", build->radius != 0, build->radius},
                   {"split-budget", build->split_budget != 0, fmax(build->split_budget, 0)},
                   {"split-alpha", build->split_alpha != 0, fmax(build->split_alpha, 0)}};
    struct reason why;
    char number[32];
    for (size_t i = 0; i < ARRAY_COUNT(options); i++) {
        if (!options[i].differs || !option_is_used(use, options[i].name, &why))
            continue;
        snprintf(number, sizeof number, " %.9g", options[i].value);
        append(text, " --%s", options[i].name);
        append(text, "%s", number);
    }
    snprintf(number, sizeof number, "%u", build->passes);
    if (build->passes)
        append(text, " --optimize reinsert=%s", number);
}

void explain_command(const struct explain_of *of, const struct ray *ray,
                     char text[EXPLAIN_COMMAND_MOST])
{
    char number[32], numbers[RAY_TEXT_MOST];
    struct reason why;
    const struct list engine = list_of_one(TABLE_ENGINES, of->engine);
    const struct list builder = list_of_one(TABLE_BUILDERS, of->builder);
    char *const scene[] = {(char *)(uintptr_t)of->spec}; /* is read alone */
    const struct option_use use = {
        .engine = &engine, .builder = &builder, .scene = scene, .scene_count = 1};
    snprintf(text, EXPLAIN_COMMAND_MOST, "raydiff explain");
    command_word(text, EXPLAIN_COMMAND_MOST, of->spec);
    ray_text_write(ray, numbers);
    append(text, " --ray '%s'", numbers);
    append(text, "%s", " --engine");
    command_word(text, EXPLAIN_COMMAND_MOST, of->engine->name);
    if (of->layout) {
        plugin_command(text, EXPLAIN_COMMAND_MOST, of->layout);
        append(text, "%s", of->tree ? " --bvh" : " --builder");
        command_word(text, EXPLAIN_COMMAND_MOST, of->tree ? of->tree : of->builder->name);
        if (of->store && of->store != tri_stores[0])
            append(text, " --store %s", of->store->name);
        append(text, " --box %s", of->box->name);
        if (!of->tree)
            append_build(of, &use, text);
    }
    if (option_is_used(&use, "tri", &why))
        append(text, " --tri %s", of->tri->name);
    append(text, " --query %s", query_name(of->query));
    snprintf(number, sizeof number, "%llu", (unsigned long long)of->seed);
    if (of->seed != 1 && option_is_used(&use, "seed", &why))
        append(text, " --seed %s", number);
    if (of->driver && option_is_used(&use, "driver", &why)) {
        append(text, "%s", " --driver");
        command_word(text, EXPLAIN_COMMAND_MOST, of->driver);
    }
}

struct explain_of explain_of_row(const struct row *row, const char *spec, uint64_t seed,
                                 const char *driver)
{
    return (struct explain_of){.spec = spec,
                               .seed = seed,
                               .engine = row->engine,
                               .layout = row->layout,
                               .store = row->options.store,
                               .builder = row->options.builder,
                               .build = row->options.build,
                               .tree = row->options.tree ? row->options.tree->name : NULL,
                               .box = row->options.box,
                               .tri = row->options.tri,
                               .query = row->options.query,
                               .driver = driver};
}
