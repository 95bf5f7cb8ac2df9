/* The options of raydiff check. */
#include "cmd/check/cmd_check.h"

#include "ref/base/command.h"
#include "ref/two_level/braid.h"

#include <math.h>
#include <string.h>

static enum status take_layouts(void *options, const struct option_value *given,
                                struct reason *reason)
{
    struct check_options *o = options;
    o->layout_auto = strcmp(given->text, "auto") == 0;
    return o->layout_auto ? STATUS_OK
                          : table_parse(TABLE_LAYOUTS, "--layout", given->text, &o->layout, reason);
}

static enum status take_steps(void *options, const struct option_value *given,
                              struct reason *reason)
{
    struct check_options *o = options;
    struct reason why;
    enum status status = steps_parse(given->text, o->step, &o->step_count, &why);
    return status ? fail(reason, status, "--steps: %s", why.text) : STATUS_OK;
}

#define ROWS_OF struct check_options

/* As ray_modes_name. */
static const char *const modes[] = {"all", "mixed", "drawn", NULL};

static const struct option_row rows[] = {
    {"layout", "L,..",
     "layouts, or patterns such as 'bvh8_*'; 'all' that products run over, 'every' one, or 'auto' "
     "(the first that fits)",
     OF_OWN(take_layouts), .table = 1 + TABLE_LAYOUTS, .value = "f32,rf16"},
    {"engine", "E,..",
     "engines, or 'all'; FILE.so, inside:FILE.so, shader:FILE and, as the last, pipe:COMMAND are "
     "tracers of "
     "your own (docs/my-engine.md); embree:MODE, such as embree:avx2:8, is a mode of Embree, "
     "rayquery:VARIANT, such as rayquery:update:u16, one of the driver's trees (docs/variants.md)",
     OF_LIST(engine, TABLE_ENGINES), .shown = "every engine that can run here"},
    {"store", "S,..", "triangle storages, see raydiff list storages", OF_LIST(store, TABLE_STORES),
     .value = "indexed"},
    {"bits", "N",
     "stores quantised, dgf1: bits an axis of the grid, 8 to 21, else 16; truncated: low bits "
     "of the fraction that are dropped, 1 to 23, else 8",
     OF_COUNT(bits, 1, TRUNCATE_BITS_MOST), .shown = "the storage's"},
    {"builder", "B,..", "builders", OF_LIST(builder, TABLE_BUILDERS), .value = "median"},
    {"move", "AMOUNT",
     "after packing, moves vertices by up to so many extents of the scene, from the seed, and "
     "refits the packed trees to where they are",
     OF_REAL(move, 0, INFINITY), .value = "0"},
    {"steps", "S,..",
     "traces after each of these steps, too: ACT, ACT:MOTION or ACT:MOTION:SEED. The vertices move "
     "(still, jitter, one, mirror, swap, far, point, zero, subnormal), or the instances of a world "
     "(drift, turn, reflect, scale, exchange, gather, away, masks, hide), then trees are updated "
     "(refit) or built again (rebuild), and engines with them",
     OF_OWN(take_steps)},
    {"box", "B,..", "box tests", OF_LIST(box, TABLE_BOX_TESTS), .value = "robust"},
    {"tri", "T,..", "triangle tests", OF_LIST(tri, TABLE_TRI_TESTS), .value = "mt"},
    {"query", "Q,..", "closest, any, all (every triangle along the ray)",
     OF_LIST(query, TABLE_QUERIES), .value = "closest"},
    {"rays", "SET", "ray set", OF_ONE(rays, TABLE_RAY_SETS), .value = "mixed"},
    {"modes", "M",
     "of a world, what rays may meet: all of it, what masks and flags drawn at random admit, or "
     "mixed: every second ray",
     OF_CHOICE(modes, modes), .value = "mixed"},
    BRAID_ROW(braid),
    {"count", "N", "rays, 1 or more; 1e6 is accepted", OF_COUNT(count, 1, 1u << 30),
     .value = "100000"},
    SEED_ROW(seed),
    {"repeat", "N", "timed runs per engine: median, least, most", OF_COUNT(repeats, 1, REPEAT_MOST),
     .value = "3"},
    {"brute", "N", "ray-triangle pairs that brute force may decide", OF_COUNT(brute, 0, UINT64_MAX),
     .value = "2e8"},
    {"brute-rays", "N", "the most rays it decides, 0 is all it can afford",
     OF_COUNT(brute_rays, 0, UINT64_MAX), .value = "0"},
    TREE_ROW(bvh),
    {"json", "FILE", "all rows, for machines", OF_DATA(json)},
    {0},
};

const struct option_set check_set = {
    .command = "check",
    .usage = "check SCENE... [OPTIONS]",
    .about = "Runs engines and node layouts on every SCENE and compares them: which agree, which "
             "differ, how fast each is and how many bytes each needs. A SCENE is a mesh file "
             "(.json .obj .ply .stl, also .gz), a world (.gltf .glb .json) or a generator such as "
             "soup:n=1000, see raydiff list scenes.",
    .group = {GROUP(rows), GROUP_AT(leaf_rows, build), GROUP_AT(build_rows, build),
              GROUP_AT(displacement_rows, demands), GROUP_AT(watertight_rows, demands),
              GROUP_AT(engine_rows, engines), GROUP_AT(outside_rows, engines),
              GROUP_AT(compiler_rows, compilers), GROUP_AT(screen_rows, screen)},
    .notes =
        "Columns: the verdict (agrees, WRONG, BITS: bits differ from engine cpu's or, of compiled "
        "shaders, from those of the shaders as built, PRECISE: a compiler lost NoContraction or "
        "fused, LOST: more hits lost beside edges than rounding explains, counted: as published, "
        "not judged, vacuous, "
        "refused, skipped, failed); answers WRONG and allowed; bits that differ; hits; bytes a "
        "triangle that a traversal reads; the largest error over its proven bound; speed. What "
        "does not fit the screen is left out. --wide has all of it, answers by allowed class, too "
        "(docs/verdicts.md).\n"
        "A named layout that refuses the scene, or must be built anew after a motion, exits with "
        "2, a named engine that cannot run with 77. A run that could play nothing, or nothing of "
        "a named storage, exits with 2.",
    .codes = "0 agree, 1 mismatch or vacuous, 2 bad input, 3 engine failed, 77 skipped",
    .example = "check sphere:n=20 --layout f32,rf16 --engine cpu,embree --rays vertices\ncheck "
               "sphere --engine vulkan --compiler raw,opt,passes:ccp+if-conversion\ncheck "
               "sphere --engine cpu,embree:refit --steps refit:jitter:3,rebuild:mirror",
};
