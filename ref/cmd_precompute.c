/* raydiff precompute: a scene's tree in the seed's file format. */
#include "ref/bvh_json.h"
#include "ref/cmd_options.h"
#include "ref/cmd_tables.h"
#include "ref/command.h"
#include "scenes/file.h"
#include "scenes/scenes.h"

static const char help[] =
    "usage: raydiff precompute --scene SCENE --out FILE [OPTIONS]\n"
    "Builds a scene's tree and writes it as JSON, byte for byte as the seed's precompute does\n"
    "with builder rtrs.\n\n"
    "  --scene SCENE     a mesh file (.json .obj .ply, also .gz) or a generator such as soup:n=50\n"
    "  --out FILE        written to a temporary name and renamed\n"
    "  --builder B       see raydiff list builders                                [rtrs]\n"
    "  --item-count N    items per leaf: the goal of rtrs, the limit of others    [4]\n"
    "  --eps E           builder rtrs: a box below half of it is not split        [0.02]\n"
    "  --seed S          of a generator                                           [1]\n\n"
    "exit codes: 0 written, 2 bad input, or the seed never ends here, 4 no memory\n"
    "example: raydiff precompute --scene default.json --out default.bvh.json --item-count 2\n";

struct precompute {
    const char *scene, *out;
    size_t builder;
    struct build_options build;
    uint64_t seed;
};

enum { OPT_SCENE = 256, OPT_OUT, OPT_BUILDER, OPT_ITEM_COUNT, OPT_EPS, OPT_SEED };

static const struct option long_options[] = {
    {"scene", 1, NULL, OPT_SCENE},     {"out", 1, NULL, OPT_OUT},
    {"builder", 1, NULL, OPT_BUILDER}, {"item-count", 1, NULL, OPT_ITEM_COUNT},
    {"eps", 1, NULL, OPT_EPS},         {"seed", 1, NULL, OPT_SEED},
    {"help", 0, NULL, OPT_HELP},       {NULL, 0, NULL, 0}};

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
    case OPT_BUILDER:
        return table_parse_one(TABLE_BUILDERS, "--builder", text, &p->builder, reason);
    case OPT_ITEM_COUNT:
        status = parse_count("--item-count", text, 1, UINT32_MAX, &n, reason);
        p->build.leaf = (uint32_t)n;
        break;
    case OPT_EPS:
        return parse_float("--eps", text, &p->build.eps, reason);
    default:
        return parse_count("--seed", text, 0, UINT64_MAX, &p->seed, reason);
    }
    return status;
}

/* Nothing is left under the output's name unless all of it was written. */
static enum status write_tree(const char *path, const struct bvh *bvh, struct reason *reason)
{
    struct file_out out = {0};
    enum status status = file_out_open(path, &out, reason);
    if (status)
        return status;
    bvh_json_write(bvh, out.stream);
    status = file_out_commit(&out, reason);
    file_out_discard(&out);
    return status;
}

static enum status precompute(const struct precompute *p, struct reason *reason)
{
    struct scene scene;
    struct bvh bvh;
    enum status status = scene_open(p->scene, p->seed, &scene, reason);
    if (status)
        return status;
    struct reason why = {""};
    status = builders[p->builder]->build(&scene, &p->build, &bvh, &why);
    if (status) {
        (void)fail(reason, status, "%s: %s", file_label(p->scene), why.text);
    } else if ((status = write_tree(p->out, &bvh, reason)) == STATUS_OK) {
        struct bvh_stats stats = bvh_stats(&bvh, &scene);
        fprintf(stderr,
                "%s: %u triangles, %u nodes, %u leaves of at most %u items, depth %u, %u inner "
                "boxes too small\n",
                p->out, bvh.prim_count, stats.node_count, stats.leaf_count, stats.largest_leaf,
                stats.depth, stats.loose_count);
    }
    bvh_free(&bvh);
    scene_free(&scene);
    return status;
}

static void print_help(void)
{
    fputs(help, stdout);
}

int cmd_precompute(int argc, char **argv)
{
    struct precompute p = {.build = {BUILD_LEAF_DEFAULT, BUILD_EPS_DEFAULT}, .seed = 1};
    struct reason reason = {""};
    if (table_parse_one(TABLE_BUILDERS, "--builder", "rtrs", &p.builder, &reason))
        return EXIT_INTERNAL;
    int first, code = options_take("precompute", print_help, long_options, take_option, &p, argc,
                                   argv, &first);
    if (code >= 0)
        return code;
    if (first < argc)
        return usage_error("precompute", "unexpected argument '%s'", argv[first]);
    if (!p.scene || !p.out)
        return usage_error("precompute", "%s is missing", p.scene ? "--out" : "--scene");
    enum status status = precompute(&p, &reason);
    if (status)
        fprintf(stderr, "raydiff precompute: %s\n", reason.text);
    return exit_of_status(status);
}
