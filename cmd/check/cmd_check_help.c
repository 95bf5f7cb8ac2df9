/* What raydiff check --help says, and what it does where the user asks for nothing. */
#include "cmd/check/cmd_check.h"

#include "cmd/common/cmd_options.h"
#include "cmd/common/cmd_tree.h"

#include <stdio.h>
#include <stdlib.h>

static const char help[] =
    "usage: raydiff check SCENE... [OPTIONS]\n"
    "Plays engines and node layouts against each other on every SCENE (a mesh file: .json .obj\n"
    ".ply, also .gz; or a generator such as soup:n=1000, see raydiff list scenes) and says who\n"
    "agrees, who differs, how fast each is and how many bytes each needs.\n\n"
    "  --layout L,..   layouts, or patterns such as 'bvh8_*'; 'all' that products run over,\n"
    "                  'every' one, or 'auto' (the first that fits)           [f32,rf16]\n"
    "  --engine E,..   engines, or 'all'; pipe:COMMAND, last, is a tracer of your own (README)\n"
    "                                                        [every engine that can run here]\n"
    "  --store S,..    triangle storages, see raydiff list storages              [indexed]\n"
    "  --bits N        store quantised: bits an axis of the grid, 8 to 21        [16]\n"
    "  --builder B,..  builders                                                  [median]\n"
    "  --leaf N        items per leaf, 1 or more                                 [4]\n"
    "  --eps E         builder rtrs: smallest box that is split                  "
    "[0.02]\n" BUILD_OPTIONS_HELP TREE_OPTION_HELP
    "  --move AMOUNT   moves vertices after packing by up to so many extents of the scene, from "
    "the\n"
    "                  seed, and refits the packed trees to where they are       [0]\n"
    "  --box B,..      box tests                                                 [robust]\n"
    "  --tri T,..      triangle tests                                            [mt]\n"
    "  --query Q,..    closest, any, all (every triangle along the ray)          [closest]\n"
    "  --rays SET      ray set                                                   [mixed]\n"
    "  --count N       rays, 1 or more; 1e6 is accepted                          [100000]\n"
    "  --seed S        of rays and generators                                    [1]\n"
    "  --repeat N      timed runs per engine, 1 to 32: median, least, most       [3]\n"
    "  --brute N       ray-triangle pairs that brute force may decide            [2e8]\n"
    "  --brute-rays N  the most rays it decides, 0 is all it can afford          "
    "[0]\n"
    "  --displacement U  how far vertices may have to move to make an answer of an unknown "
    "formula\n"
    "                  right, in 2^-24 of their distance                         [32]\n"
    "  --require watertight  no hit inside a closed fan may be lost, by any engine; without it "
    "only\n"
    "                  by those that promise so. Of closest and any hits\n" ENGINE_OPTIONS_HELP
    "  --json FILE     all rows, for machines\n\n"
    "Columns: hits, then answers in each allowed class (tie, near tie, boundary, border, in "
    "plane,\n"
    "slab, noise, out of contract: README, \"Allowed differences\"), the largest error over its\n"
    "proven bound, what is WRONG, and bits that differ from engine cpu.\n"
    "A named layout that refuses the scene, or is to be built anew after a motion, exits with 2, "
    "a\n"
    "named engine that cannot run with 77. A run in which nothing, or nothing of a named storage,\n"
    "could be played exits with 2.\n"
    "exit codes: 0 agree, 1 mismatch or vacuous, 2 bad input, 3 engine failed, 77 skipped\n"
    "example: raydiff check scenes/fetched/bunny.obj --layout f32,rf16 --rays vertices\n";

void check_help(void)
{
    fputs(help, stdout);
}

struct check_options check_options_default(void)
{
    struct reason reason;
    struct check_options o = {
        .engine = table_all(TABLE_ENGINES),
        .build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT},
        .count = 100000,
        .seed = 1,
        .repeats = 3,
        .brute = 200000000,
        .engines = engine_options_default(),
    };
    bool ok = table_parse(TABLE_LAYOUTS, "", "f32,rf16", &o.layout, &reason) == STATUS_OK &&
              table_parse(TABLE_STORES, "", "indexed", &o.store, &reason) == STATUS_OK &&
              table_parse(TABLE_BUILDERS, "", "median", &o.builder, &reason) == STATUS_OK &&
              table_parse(TABLE_BOX_TESTS, "", "robust", &o.box, &reason) == STATUS_OK &&
              table_parse(TABLE_TRI_TESTS, "", "mt", &o.tri, &reason) == STATUS_OK &&
              table_parse(TABLE_QUERIES, "", "closest", &o.query, &reason) == STATUS_OK &&
              table_parse_one(TABLE_RAY_SETS, "", "mixed", &o.rays, &reason) == STATUS_OK;
    if (!ok)
        abort(); /* a default that no table names is our bug */
    return o;
}
