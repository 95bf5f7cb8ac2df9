/* raydiff leaks: rays from inside closed meshes, aimed at edges and vertices. */
#include "cmd/leaks/cmd_leaks.h"

#include "cmd/common/cmd_tree.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"

#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: raydiff leaks SCENE... [OPTIONS]\n"
    "Aims rays from inside a closed mesh at its vertices, edge middles, edge points and a hair\n"
    "beside them. Every such ray must leave the mesh: counted are those that hit nothing "
    "(misses),\n"
    "those that hit two triangles where the edge or vertex they share has room for one (double),\n"
    "and those that cross the mesh an even number of times.\n\n"
    "  --layout L,..   layouts, or 'all'                                         [f32,rf16]\n"
    "  --store S,..    triangle storages, see raydiff list storages              [indexed]\n"
    "  --engine E,..   engines, or 'all'                       [all that can run here but brute]\n"
    "  --builder B,..  builders                                                  [median]\n"
    "  --leaf N        items per leaf, 1 or more                                 "
    "[4]\n" BUILD_OPTIONS_HELP TREE_OPTION_HELP
    "  --box B,..      box tests                                        [robust,watertight]\n"
    "  --tri T,..      triangle tests                                            [mt,woop]\n"
    "  --count N       rays, 1 or more; fewer than 1000 say nothing              [100000]\n"
    "  --seed S        of rays and generators                                    [1]\n"
    "  --profile P     vulkan or dxr, see below                                  "
    "[vulkan]\n" ENGINE_OPTIONS_HELP "  --json FILE     all rows, for machines\n\n"
    "profile   miss        double hit   range of t          degenerate triangles\n"
    "  vulkan  should not  should not   tmin < t < tmax     culled: no area as the ray sees it\n"
    "  dxr     must not    must not     TMin < t < TMax     never hit\n"
    "Both know two faces and cull none. Vulkan speaks of edges whose two triangles have one "
    "winding\n"
    "and of closed fans of them; DXR of all, and at an edge of more than two triangles of those "
    "on\n"
    "one side. No ray here ends near a triangle, so that open and closed ranges are the same.\n"
    "A row that promises (tri woop; on a tree also box watertight, and no member as published)\n"
    "must not miss under any profile and fails if it does. Of other rows what a profile says "
    "should\n"
    "not be is counted, and what must not be fails, whatever they promise. Woop takes an edge\n"
    "function of zero for inside, so that it hits both triangles of an edge: under dxr it fails.\n"
    "exit codes: 0 kept, 1 broken or vacuous, 2 bad input or an open mesh, 3 engine failed,\n"
    "            77 skipped\n"
    "example: raydiff leaks sphere scenes/fetched/bunny.obj --tri woop --count 1e6\n";

enum {
    OPT_LAYOUT = 256,
    OPT_STORE,
    OPT_ENGINE,
    OPT_BUILDER,
    OPT_LEAF,
    OPT_BOX,
    OPT_TRI,
    OPT_COUNT,
    OPT_SEED,
    OPT_PROFILE,
    OPT_JSON
};

static const struct option long_options[] = {{"layout", 1, NULL, OPT_LAYOUT},
                                             {"store", 1, NULL, OPT_STORE},
                                             {"engine", 1, NULL, OPT_ENGINE},
                                             {"builder", 1, NULL, OPT_BUILDER},
                                             {"leaf", 1, NULL, OPT_LEAF},
                                             {"box", 1, NULL, OPT_BOX},
                                             {"tri", 1, NULL, OPT_TRI},
                                             {"count", 1, NULL, OPT_COUNT},
                                             {"seed", 1, NULL, OPT_SEED},
                                             {"profile", 1, NULL, OPT_PROFILE},
                                             {"json", 1, NULL, OPT_JSON},
                                             BUILD_OPTIONS,
                                             TREE_OPTION,
                                             ENGINE_OPTIONS};

static struct leaks_options default_options(void)
{
    struct reason reason;
    struct leaks_options o = {
        .build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT},
        .count = 100000,
        .seed = 1,
        .profile = leak_profiles[0],
        .engines = engine_options_default(),
    };
    /* Brute force takes minutes on a real mesh: it plays when it is named. */
    for (size_t i = 0; engines[i]; i++)
        if (!strstr(engines[i]->name, "brute"))
            o.engine.index[o.engine.count++] = i;
    bool ok = table_parse(TABLE_LAYOUTS, "", "f32,rf16", &o.layout, &reason) == STATUS_OK &&
              table_parse(TABLE_STORES, "", "indexed", &o.store, &reason) == STATUS_OK &&
              table_parse(TABLE_BUILDERS, "", "median", &o.builder, &reason) == STATUS_OK &&
              table_parse(TABLE_BOX_TESTS, "", "robust,watertight", &o.box, &reason) == STATUS_OK &&
              table_parse(TABLE_TRI_TESTS, "", "mt,woop", &o.tri, &reason) == STATUS_OK;
    if (!ok)
        abort(); /* a default that no table names is our bug */
    return o;
}

static enum status take_profile(struct leaks_options *o, const char *text, struct reason *reason)
{
    o->profile = leak_profile_find(text);
    if (o->profile)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "--profile: unknown name '%s'; profiles are: %s, %s", text,
                leak_profiles[0]->name, leak_profiles[1]->name);
}

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    struct leaks_options *o = user;
    uint64_t n = 0;
    enum status status;
    switch (option) {
    case OPT_LAYOUT:
        o->layout_named = strcmp(text, "all") != 0;
        return table_parse(TABLE_LAYOUTS, "--layout", text, &o->layout, reason);
    case OPT_STORE:
        o->build_flag = "--store";
        return table_parse(TABLE_STORES, "--store", text, &o->store, reason);
    case OPT_ENGINE:
        o->engine_named = strcmp(text, "all") != 0;
        return table_parse(TABLE_ENGINES, "--engine", text, &o->engine, reason);
    case OPT_BUILDER:
        o->build_flag = "--builder";
        return table_parse(TABLE_BUILDERS, "--builder", text, &o->builder, reason);
    case OPT_LEAF:
        o->build_flag = "--leaf";
        status = parse_count("--leaf", text, 1, 1u << 20, &n, reason);
        o->build.leaf = (uint32_t)n;
        return status;
    case OPT_BINS:
    case OPT_RADIUS:
    case OPT_SPLIT_BUDGET:
    case OPT_SPLIT_ALPHA:
    case OPT_OPTIMIZE:
        return build_option_take(option, text, &o->build, &o->build_flag, reason);
    case OPT_BVH:
        o->bvh = text;
        return STATUS_OK;
    case OPT_BOX:
        return table_parse(TABLE_BOX_TESTS, "--box", text, &o->box, reason);
    case OPT_TRI:
        return table_parse(TABLE_TRI_TESTS, "--tri", text, &o->tri, reason);
    case OPT_COUNT:
        return parse_count("--count", text, 1, 1u << 28, &o->count, reason);
    case OPT_SEED:
        return parse_count("--seed", text, 0, UINT64_MAX, &o->seed, reason);
    case OPT_PROFILE:
        return take_profile(o, text, reason);
    case OPT_JSON:
        o->json = text;
        return STATUS_OK;
    default:
        return engine_option_take(option, text, &o->engines, reason);
    }
}

static int leaks_all(const struct leaks_options *o, char *const *spec, size_t count)
{
    int code = EXIT_AGREE;
    struct reason reason = {""};
    struct pool pool = {.options = o->engines};
    struct progress progress = progress_make("leaks");
    struct leak_scene *results = alloc_zeroed(count, sizeof *results);
    static struct turnout turnout;
    if (!results)
        return EXIT_INTERNAL;
    turnout_expect(&turnout, o->engine_named ? &o->engine : NULL, &o->engine,
                   o->layout_named ? &o->layout : NULL);
    for (size_t i = 0; i < count; i++) {
        enum status status = leaks_play(o, &pool, &progress, spec[i], &results[i], &reason);
        progress_end(&progress);
        if (status) {
            fprintf(stderr, "raydiff leaks: %s\n", reason.text);
            code = exit_worse(code, exit_of_status(status));
            continue;
        }
        leaks_print(&results[i]);
        fflush(stdout);
        leaks_count_turnout(&results[i], &turnout);
        code = exit_worse(code, leaks_exit(&results[i], o->layout_named, o->engine_named));
    }
    turnout_print(&turnout);
    code = exit_worse(code, turnout_exit(&turnout));
    if (o->json) {
        enum status status = leaks_write_json(o->json, results, count, &turnout, code, &reason);
        if (status) {
            fprintf(stderr, "raydiff leaks: %s\n", reason.text);
            code = exit_worse(code, exit_of_status(status));
        }
    }
    for (size_t i = 0; i < count; i++)
        free(results[i].row);
    free(results);
    pool_free(&pool);
    return code;
}

static void print_help(void)
{
    fputs(help, stdout);
}

int cmd_leaks(int argc, char **argv)
{
    struct leaks_options options = default_options();
    int first, code = options_take("leaks", print_help, long_options, take_option, &options, argc,
                                   argv, &first);
    if (code >= 0)
        return code;
    if (first == argc)
        return usage_error("leaks", "no scene given");
    struct reason reason;
    if (tree_check_options(options.bvh, (size_t)(argc - first), &reason))
        return usage_error("leaks", "%s", reason.text);
    const struct option_use use = {.engine = &options.engine,
                                   .layout = &options.layout,
                                   .builder = &options.builder,
                                   .store = &options.store,
                                   .seeded = true};
    code = options_refused("leaks", &use);
    if (code >= 0)
        return code;
    return leaks_all(&options, argv + first, (size_t)(argc - first));
}
