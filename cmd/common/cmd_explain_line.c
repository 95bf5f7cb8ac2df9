#include "cmd/common/cmd_explain_line.h"

#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/base/ray_text.h"
#include "ref/base/text.h"
#include "ref/outside/plugin_shader.h"
#include "ref/store.h"
#include "scenes/rays/rays.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

void print_float(FILE *out, float x)
{
    char text[32];
    float_text_write(x, text);
    fprintf(out, "%s (%.9g)", text, (double)x);
}

void print_floats(FILE *out, int indent, const char *title, const float *x, int count)
{
    fprintf(out, "%*s%-9s ", indent, "", title);
    for (int k = 0; k < count; k++) {
        print_float(out, x[k]);
        fputs(k + 1 < count ? "  " : "\n", out);
    }
}

/* Appends the build options that differ from the defaults and that the builder reads. */
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
                   {"split-alpha", build->split_alpha != 0, fmax(build->split_alpha, 0)},
                   {"presplit", build->presplit > 0, (double)build->presplit}};
    struct reason why;
    for (size_t i = 0; i < ARRAY_COUNT(options); i++)
        if (options[i].differs && option_is_used(use, options[i].name, &why))
            text_append(text, EXPLAIN_COMMAND_MOST, " --%s %.9g", options[i].name,
                        options[i].value);
    if (build->passes)
        text_append(text, EXPLAIN_COMMAND_MOST, " --optimize %s=%u", build_optimization(build),
                    build->passes);
}

/* Appends all but the ray, after it. */
static void append_rest(const struct explain_of *of, const struct option_use *use,
                        char text[EXPLAIN_COMMAND_MOST])
{
    struct reason why;
    text_append(text, EXPLAIN_COMMAND_MOST, " --engine");
    command_word(text, EXPLAIN_COMMAND_MOST, of->engine->name);
    if (of->layout) {
        plugin_command(text, EXPLAIN_COMMAND_MOST, of->layout);
        text_append(text, EXPLAIN_COMMAND_MOST, of->tree ? " --bvh" : " --builder");
        command_word(text, EXPLAIN_COMMAND_MOST, of->tree ? of->tree : of->builder->name);
        if (of->store && of->store != tri_stores[0])
            text_append(text, EXPLAIN_COMMAND_MOST, " --store %s", of->store->name);
        text_append(text, EXPLAIN_COMMAND_MOST, " --box %s", of->box->name);
        if (!of->tree)
            append_build(of, use, text);
    }
    if (option_is_used(use, "tri", &why))
        text_append(text, EXPLAIN_COMMAND_MOST, " --tri %s", of->tri->name);
    text_append(text, EXPLAIN_COMMAND_MOST, " --query %s", query_name(of->query));
    if (of->seed != 1 && option_is_used(use, "seed", &why))
        text_append(text, EXPLAIN_COMMAND_MOST, " --seed %" PRIu64, of->seed);
    if (of->driver && option_is_used(use, "driver", &why)) {
        text_append(text, EXPLAIN_COMMAND_MOST, " --driver");
        command_word(text, EXPLAIN_COMMAND_MOST, of->driver);
    }
}

/* Writes the whole command; `seeded`: the ray depends on the seed. */
static void write_command(const struct explain_of *of, const char *ray, bool seeded,
                          char text[EXPLAIN_COMMAND_MOST])
{
    const struct list engine = list_of_one(TABLE_ENGINES, of->engine);
    const struct list builder = list_of_one(TABLE_BUILDERS, of->builder);
    char *const scene[] = {(char *)(uintptr_t)of->spec}; /* only read */
    const struct option_use use = {
        .engine = &engine, .builder = &builder, .scene = scene, .scene_count = 1, .seeded = seeded};
    snprintf(text, EXPLAIN_COMMAND_MOST, "raydiff explain");
    command_word(text, EXPLAIN_COMMAND_MOST, of->spec);
    text_append(text, EXPLAIN_COMMAND_MOST, "%s", ray);
    append_rest(of, &use, text);
}

void explain_command(const struct explain_of *of, const struct ray *ray,
                     char text[EXPLAIN_COMMAND_MOST])
{
    char numbers[RAY_TEXT_MOST], words[RAY_TEXT_MOST + 16];
    ray_text_write(ray, numbers);
    snprintf(words, sizeof words, " --ray '%s'", numbers);
    write_command(of, words, false, text);
}

void explain_command_among(const struct explain_of *of, const struct explain_set *set, size_t index,
                           char text[EXPLAIN_COMMAND_MOST])
{
    char words[128];
    snprintf(words, sizeof words, " --rays %s --count %zu --index %zu", set->rays, set->count,
             index);
    write_command(of, words, !ray_set_find(set->rays)->seedless, text);
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
