/* raydiff precompute: a scene's tree in RTRS's file format or packed in a layout; and trees of
 * others, checked. */
#include "ref/tree/bvh_json.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/packed/packed_file.h"
#include "ref/files/file.h"
#include "scenes/scenes.h"

#include <stdlib.h>

static const char help[] =
    "usage: raydiff precompute --scene SCENE --out FILE [OPTIONS]\n"
    "       raydiff precompute --scene SCENE --verify FILE\n"
    "Builds a scene's tree and writes it as JSON, byte for byte as RTRS's precompute does\n"
    "with builder rtrs; or checks a file that somebody else made.\n\n"
    "  --scene SCENE     a mesh file (.json .obj .ply, also .gz) or a generator such as soup:n=50\n"
    "  --out FILE        written to a temporary name and renamed\n"
    "  --layout L        not as JSON, but packed in a layout: see ref/packed/packed_file.h\n"
    "  --verify FILE     JSON or packed: is it a tree of the scene, and are its boxes large "
    "enough?\n"
    "  --builder B       see raydiff list builders                                [rtrs]\n"
    "  --item-count N    items per leaf: the goal of rtrs, the limit of others    [4]\n"
    "  --eps E           builder rtrs: a box below half of it is not split        "
    "[0.02]\n" BUILD_OPTIONS_HELP
    "  --seed S          of a generator                                           [1]\n\n"
    "exit codes: 0 written, or verified; 1 a tree, but with too small boxes, or triangles in no\n"
    "leaf or in several; 2 bad input, no tree, or RTRS never ends here; 4 no memory\n"
    "example: raydiff precompute --scene default.json --out default.bvh.json --item-count 2\n";

struct precompute {
    char *scene;
    const char *out, *verify;
    const struct layout *layout; /* NULL: JSON */
    size_t builder;
    struct build_options build;
    uint64_t seed;
};

enum {
    OPT_SCENE = 256,
    OPT_OUT,
    OPT_LAYOUT,
    OPT_VERIFY,
    OPT_BUILDER,
    OPT_ITEM_COUNT,
    OPT_EPS,
    OPT_SEED
};

static const struct option long_options[] = {{"scene", 1, NULL, OPT_SCENE},
                                             {"out", 1, NULL, OPT_OUT},
                                             {"layout", 1, NULL, OPT_LAYOUT},
                                             {"verify", 1, NULL, OPT_VERIFY},
                                             {"builder", 1, NULL, OPT_BUILDER},
                                             {"item-count", 1, NULL, OPT_ITEM_COUNT},
                                             {"eps", 1, NULL, OPT_EPS},
                                             {"seed", 1, NULL, OPT_SEED},
                                             BUILD_OPTIONS,
                                             {"help", 0, NULL, OPT_HELP},
                                             {NULL, 0, NULL, 0}};

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    struct precompute *p = user;
    uint64_t n = 0;
    enum status status = STATUS_OK;
    switch (option) {
    case OPT_SCENE:
        p->scene = text;
        break;
    case OPT_OUT:
        p->out = text;
        break;
    case OPT_VERIFY:
        p->verify = text;
        break;
    case OPT_LAYOUT: {
        size_t which = 0;
        status = table_parse_one(TABLE_LAYOUTS, "--layout", text, &which, reason);
        p->layout = status ? NULL : layouts_all[which];
        if (p->layout && p->layout->outside)
            return fail(reason, STATUS_INPUT,
                        "--layout: %s is from outside, and files of packed trees hold none such",
                        p->layout->name);
        break;
    }
    case OPT_BUILDER:
        return table_parse_one(TABLE_BUILDERS, "--builder", text, &p->builder, reason);
    case OPT_ITEM_COUNT:
        status = parse_count("--item-count", text, 1, UINT32_MAX, &n, reason);
        p->build.leaf = (uint32_t)n;
        break;
    case OPT_EPS:
        return parse_float("--eps", text, &p->build.eps, reason);
    case OPT_BINS:
    case OPT_RADIUS:
    case OPT_SPLIT_BUDGET:
    case OPT_SPLIT_ALPHA:
    case OPT_OPTIMIZE:
        return build_option_take(option, text, &p->build, NULL, reason);
    default:
        return parse_count("--seed", text, 0, UINT64_MAX, &p->seed, reason);
    }
    return status;
}

/* Nothing is left under the output's name unless all of it was written. Packed, unless NULL. */
static enum status write_tree(const char *path, const struct bvh *bvh, const struct packed *packed,
                              struct reason *reason)
{
    struct file_out out = {0};
    enum status status = file_out_open(path, &out, reason);
    if (status)
        return status;
    if (packed)
        packed_file_write(packed, out.stream);
    else
        bvh_json_write(bvh, out.stream);
    status = file_out_commit(&out, reason);
    file_out_discard(&out);
    return status;
}

/* As JSON, or packed as was asked for. */
static enum status write_out(const struct precompute *p, const struct scene *scene,
                             const struct bvh *bvh, struct reason *reason)
{
    struct packed packed = {0};
    enum status status = STATUS_OK;
    if (p->layout)
        status = packed_make(p->layout, bvh, scene, &packed, reason);
    if (!status)
        status = write_tree(p->out, bvh, p->layout ? &packed : NULL, reason);
    packed_free(&packed);
    return status;
}

static enum status precompute(const struct precompute *p, const struct scene *scene,
                              struct reason *reason)
{
    struct bvh bvh;
    struct reason why = {""};
    enum status status = bvh_build(builders_all[p->builder], scene, &p->build, &bvh, &why);
    if (status)
        return fail(reason, status, "%s: %s", file_label(p->scene), why.text);
    status = write_out(p, scene, &bvh, reason);
    if (!status) {
        struct bvh_stats stats = bvh_stats(&bvh, scene);
        fprintf(stderr,
                "%s: %u triangles, %u nodes, %u leaves of at most %u items, depth %u, %u inner "
                "boxes too small\n",
                p->out, bvh.tri_count, stats.node_count, stats.leaf_count, stats.largest_leaf,
                stats.depth, stats.loose_count);
    }
    bvh_free(&bvh);
    return status;
}

/* *sound: nothing is wrong with it; else `reason` says what. */
static enum status verify_packed(const char *bytes, size_t size, const struct precompute *p,
                                 const struct scene *scene, bool *sound, struct reason *reason)
{
    struct packed packed;
    struct packed_faults faults;
    enum status status =
        packed_file_read(file_label(p->verify), bytes, size, scene, &packed, &faults, reason);
    *sound = !status && reason->text[0] == '\0';
    if (!status)
        printf("%s: layout %s, %u records, %u boxes too small, %u triangles in no leaf, %u in "
               "several\n",
               p->verify, packed.layout->name, packed.node_count, faults.loose_boxes,
               faults.lost_prims, faults.double_prims);
    packed_free(&packed);
    return status;
}

static enum status verify_json(const char *bytes, size_t size, const struct precompute *p,
                               const struct scene *scene, bool *sound, struct reason *reason)
{
    struct bvh bvh;
    enum status status = bvh_json_read(file_label(p->verify), bytes, size, scene, &bvh, reason);
    *sound = !status && bvh_check(&bvh, scene, reason) == STATUS_OK;
    if (!status) {
        struct bvh_stats stats = bvh_stats(&bvh, scene);
        printf("%s: %u nodes, %u leaves of at most %u items, depth %u, %u inner boxes too small\n",
               p->verify, stats.node_count, stats.leaf_count, stats.largest_leaf, stats.depth,
               stats.loose_count);
    }
    bvh_free(&bvh);
    return status;
}

/* Returns the exit code. */
static int verify(const struct precompute *p, const struct scene *scene)
{
    char *bytes;
    size_t size;
    bool sound = false;
    struct reason reason = {""};
    enum status status = file_read(p->verify, &bytes, &size, &reason);
    if (!status)
        status = packed_file_is(bytes, size) ? verify_packed(bytes, size, p, scene, &sound, &reason)
                                             : verify_json(bytes, size, p, scene, &sound, &reason);
    free(bytes);
    if (!sound)
        fprintf(stderr, "raydiff precompute: %s\n", reason.text);
    return status ? exit_of_status(status) : sound ? EXIT_AGREE : EXIT_MISMATCH;
}

static void print_help(void)
{
    fputs(help, stdout);
}

int cmd_precompute(int argc, char **argv)
{
    struct precompute p = {.build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT},
                           .seed = 1};
    struct reason reason = {""};
    if (table_parse_one(TABLE_BUILDERS, "--builder", "rtrs", &p.builder, &reason))
        return EXIT_INTERNAL;
    int first, code = options_take("precompute", print_help, long_options, take_option, &p, argc,
                                   argv, &first);
    if (code >= 0)
        return code;
    if (first < argc)
        return usage_error("precompute", "unexpected argument '%s'", argv[first]);
    if (!p.scene || (!p.out && !p.verify))
        return usage_error("precompute", "%s is missing", p.scene ? "--out" : "--scene");
    const struct list builder = {.index = {p.builder}, .count = 1};
    const struct option_use use = {.by = "--verify",
                                   .only = p.verify ? "scene verify seed" : NULL,
                                   .builder = &builder,
                                   .scene = (char *const[]){p.scene},
                                   .scene_count = 1};
    code = options_refused("precompute", &use);
    if (code >= 0)
        return code;
    struct scene scene;
    enum status status = scene_open(p.scene, p.seed, &scene, &reason);
    code = EXIT_AGREE;
    if (!status && p.verify)
        code = verify(&p, &scene);
    else if (!status)
        status = precompute(&p, &scene, &reason);
    scene_free(&scene);
    if (status)
        fprintf(stderr, "raydiff precompute: %s\n", reason.text);
    return status ? exit_of_status(status) : code;
}
