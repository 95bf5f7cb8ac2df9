/* The options of raydiff explain. */
#include "cmd/explain/cmd_explain_inner.h"

#include "cmd/common/cmd_tree.h"
#include "ref/base/nearest_name.h"
#include "ref/two_level/braid.h"
#include "scenes/rays/ray_modes.h"

#include <string.h>

static enum status take_cause(void *options, const struct option_value *given,
                              struct reason *reason)
{
    struct explain_options *o = options;
    char hint[NEAREST_HINT];
    struct nearest_name nearest = nearest_make(given->text, strlen(given->text));
    for (enum cause cause = CAUSE_NONE + 1; cause < CAUSE_COUNT; cause++)
        nearest_try(&nearest, cause_name(cause));
    o->has_cause = cause_find(given->text, &o->cause);
    if (!o->has_cause || o->cause == CAUSE_NONE)
        return fail(reason, STATUS_INPUT,
                    "--cause: unknown cause '%.60s'; docs/causes.md has all%s", given->text,
                    nearest_hint(&nearest, hint));
    return STATUS_OK;
}

static const char *const modes[] = {"all", "mixed", "drawn", NULL}; /* as ray_modes_name */

#define ROWS_OF struct explain_options

static const struct option_row rows[] = {
    {"ray", "R", "numbers in decimal or hexadecimal (0x1.8p+1), or inf, nan", OF_TEXT(ray_text)},
    {"rays", "SET", "ray set, as raydiff check takes it", OF_MEMBER(rays, TABLE_RAY_SETS),
     .value = "mixed"},
    {"count", "N", "its rays", OF_COUNT(count, 1, 1u << 30), .value = "100000",
     .shown = "100000; of a trial 1000"},
    {"index", "I", "which of them", OF_COUNT(index, 0, (1u << 30) - 1),
     .shown = "the first one with a wrong answer"},
    {"cause", "C", "look for a ray with this cause, such as rounded_inward", OF_OWN(take_cause),
     .shown = "any"},
    SEED_ROW(of.seed),
    {"engine", "E", "engine; pipe:COMMAND and FILE.so are tracers of your own",
     OF_MEMBER(of.engine, TABLE_ENGINES), .value = "cpu"},
    {"layout", "L", "layout", OF_MEMBER(of.layout, TABLE_LAYOUTS), .value = "rf16",
     .shown = "rf16, or " EXPLAIN_LARGE_LAYOUT " where that cannot hold the scene"},
    {"store", "S", "triangle storage, see raydiff list storages", OF_MEMBER(of.store, TABLE_STORES),
     .value = "indexed"},
    {"builder", "B", "builder", OF_MEMBER(of.builder, TABLE_BUILDERS), .value = "median"},
    TREE_ROW(of.tree),
    {"box", "B", "box test", OF_MEMBER(of.box, TABLE_BOX_TESTS), .value = "robust"},
    {"tri", "T", "triangle test", OF_MEMBER(of.tri, TABLE_TRI_TESTS), .value = "mt"},
    {"modes", "M", "of a world, what rays may meet: all, mixed or drawn", OF_CHOICE(modes, modes),
     .value = "mixed"},
    BRAID_ROW(braid),
    {"query", "Q", "closest, any, or all: the list of every hit", OF_ONE(of.query, TABLE_QUERIES),
     .value = "closest"},
    {"html", "FILE", "the page with pictures that turn; fetches nothing", OF_WRITTEN(html)},
    {"svg", "FILE", "the pictures alone", OF_WRITTEN(svg)},
    {"json", "FILE", "the page, for machines", OF_DATA(json)},
    {0},
};

const struct option_set explain_set = {
    .command = "explain",
    .usage = "explain SCENE --ray 'OX,OY,OZ DX,DY,DZ [TMIN,TMAX]' [OPTIONS]\n"
             "explain SCENE --rays SET [--index I] [OPTIONS]\n"
             "explain TRIAL [--index I] [OPTIONS]     (a name of raydiff conform)\n"
             "explain FILE.trial [--index I] [--engine E] [--layout L]     (a finding)\n"
             "explain WORLD [--rays SET] [--modes M] [OPTIONS]",
    .about = "Prints what a ray exactly hits, what the engine answers, and if that is wrong, why: "
             "which node turned the ray away, its bounds in the triangles, in the tree and in the "
             "bytes, and the one thing that, made right, makes the answer right.",
    .group = {GROUP(rows), GROUP_AT(leaf_rows, of.build), GROUP_AT(build_rows, of.build),
              GROUP_AT(engine_rows, engines), GROUP_AT(outside_rows, engines),
              GROUP_AT(screen_rows, screen)},
    .notes = "Of a world all answers are explained together: by the defect of a tracer that gives "
             "them, such as masks that are compared by ==. "
             "Of a layout from outside with --shader it also compares what its C and its GLSL "
             "decode, record by record, and names the first that differs. A finding about a tree "
             "is explained by the record. Members as published are held to what their repaired "
             "forms promise.",
    .codes = "0 the answer is allowed, 1 wrong and explained, 2 bad input, 3 the engine did not "
             "finish (explained too), 77 the engine cannot run here",
    .example = "explain soup:n=300 --rays vertices --layout rtrs_rf_paper",
};
