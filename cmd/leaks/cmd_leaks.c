/* raydiff leaks: rays from inside closed meshes, aimed at edges and vertices. */
#include "cmd/leaks/cmd_leaks.h"

#include "gpu/build/device_builders.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_tree.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/two_level/braid.h"

#include <stdlib.h>
#include <string.h>

/* The names of profiles are those in leak_profiles[]. */
static enum status take_profile(void *options, const struct option_value *given,
                                struct reason *reason)
{
    struct leaks_options *o = options;
    o->profile = leak_profile_find(given->text);
    if (o->profile)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "--profile: unknown name '%s'; profiles are: %s, %s",
                given->text, leak_profiles[0]->name, leak_profiles[1]->name);
}

#define ROWS_OF struct leaks_options

static const struct option_row rows[] = {
    {"layout", "L,..", "layouts, or 'all'", OF_LIST(layout, TABLE_LAYOUTS), .value = "f32,rf16"},
    {"store", "S,..", "triangle storages, see raydiff list storages", OF_LIST(store, TABLE_STORES),
     .value = "indexed"},
    {"engine", "E,..", "engines, or 'all'", OF_LIST(engine, TABLE_ENGINES),
     .shown = "all that can run here but brute"},
    {"builder", "B,..", "builders", OF_LIST(builder, TABLE_BUILDERS), .value = "median"},
    {"leaf", "N", "items per leaf, 1 or more", OF_COUNT(build.leaf, 1, 1u << 20),
     .standard = BUILD_LEAF_DEFAULT},
    TREE_ROW(bvh),
    BRAID_ROW(braid),
    {"box", "B,..", "box tests", OF_LIST(box, TABLE_BOX_TESTS), .value = "robust,watertight"},
    {"tri", "T,..", "triangle tests", OF_LIST(tri, TABLE_TRI_TESTS), .value = "mt,woop"},
    {"count", "N", "rays, 1 or more; fewer than 1000 prove nothing", OF_COUNT(count, 1, 1u << 28),
     .value = "100000"},
    SEED_ROW(seed),
    {"profile", "P", "vulkan or dxr, see below", OF_OWN(take_profile), .value = "vulkan"},
    {"json", "FILE", "all rows, for machines", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "leaks",
    .usage = "leaks SCENE... [OPTIONS]",
    .about =
        "Aims rays from inside a closed mesh at its vertices, edge middles, edge points and "
        "a hair beside them. Every such ray must leave the mesh: counted are those that hit "
        "nothing (misses), those that hit two triangles where the edge or vertex they share "
        "has room for one (double), and those that cross the mesh an even number of times. Of a "
        "world, rays start inside its instances, and misses alone are counted; where instances "
        "are closed only together, nothing is judged.",
    .group = {GROUP(rows), GROUP_AT(build_rows, build), GROUP_AT(engine_rows, engines),
              GROUP_AT(outside_rows, engines), GROUP_AT(screen_rows, screen)},
    .notes = " profile  miss        double hit  range of t        degenerate triangles\n"
             "  vulkan  should not  should not  tmin < t < tmax   culled: no area for the ray\n"
             "  dxr     must not    must not    TMin < t < TMax   never hit\n"
             "Both know two faces and cull none. Vulkan constrains edges whose two triangles "
             "have one winding, and closed fans of them. DXR constrains all, and at an edge of "
             "more than two triangles those on one side. No ray here ends near a triangle, so "
             "that open and closed ranges are the same. A row that promises (tri woop; on a tree "
             "also box watertight, and no member as published) must not miss under any profile "
             "and fails if it does. In other rows, what a profile says should not be is counted; "
             "what must not be fails. Woop takes an edge function of zero for inside, so it hits "
             "both triangles of an edge and fails under dxr.",
    .codes =
        "0 kept, 1 broken or vacuous, 2 bad input, an open mesh, a named layout that refuses the "
        "scene, or nothing but layouts that do, 3 engine failed, 77 skipped",
    .example = "leaks sphere:n=20 --layout f32 --engine cpu,embree --tri woop",
};

static int leaks_all(const struct leaks_options *o, char *const *spec, size_t count)
{
    int code = EXIT_AGREE;
    struct reason reason = {""};
    struct pool pool = {.options = o->engines};
    struct progress progress = progress_make("leaks");
    const struct screen screen = screen_make(&o->screen);
    struct leak_scene *results = alloc_zeroed(count, sizeof *results);
    static struct turnout turnout;
    if (!results)
        return EXIT_INTERNAL;
    turnout_expect(&turnout, o->engine_named ? &o->engine : NULL, &o->engine,
                   o->layout_named ? &o->layout : NULL);
    for (size_t i = 0; i < count; i++) {
        enum status status = leaks_play(o, &pool, &progress, spec[i], &results[i], &reason);
        progress_end(&progress);
        code = exit_worse(code, exit_with_reason("leaks", status, &reason));
        if (status)
            continue;
        leaks_print(&results[i], &screen);
        fflush(stdout);
        leaks_count_turnout(&results[i], &turnout);
        code = exit_worse(code, leaks_exit(&results[i], o->layout_named, o->engine_named));
    }
    turnout_print(&turnout, &screen);
    code = exit_worse(code, turnout_exit(&turnout));
    if (o->json) {
        enum status status = leaks_write_json(o->json, results, count, &turnout, code, &reason);
        code = exit_worse(code, exit_with_reason("leaks", status, &reason));
    }
    leaks_print_conclusion(results, count, code, &screen);
    for (size_t i = 0; i < count; i++)
        free(results[i].row);
    free(results);
    pool_free(&pool);
    return code;
}

int cmd_leaks(int argc, char **argv)
{
    struct leaks_options options = {
        .build = build_options_default(),
        .engines = engine_options_default(),
    };
    /* Brute force takes minutes on a real mesh, so it runs only if it is named. */
    for (size_t i = 0; engines[i]; i++)
        if (!strstr(engines[i]->name, "brute"))
            options.engine.index[options.engine.count++] = i;
    int first, code = options_read(&set, &options, argc, argv, &first);
    if (code >= 0)
        return code;
    options.layout_named = option_was_given("layout") && !options.layout.all;
    options.engine_named = option_was_given("engine") && !options.engine.all;
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
    device_builders_use(&options.engines);
    code = options_refused("leaks", &use);
    if (code >= 0)
        return code;
    return leaks_all(&options, argv + first, (size_t)(argc - first));
}
