/* raydiff precompute: writes a scene's tree in RTRS's file format or packed in a layout; or
 * verifies a tree file. */
#include "ref/tree/bvh_json.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/packed/packed_file.h"
#include "ref/files/file.h"
#include "scenes/scenes.h"
#include "ref/base/text.h"

#include <math.h>
#include <stdlib.h>

struct precompute {
    char *scene;
    const char *out, *verify;
    const struct layout *layout; /* NULL: JSON */
    size_t builder;
    struct build_options build;
    uint64_t seed;
};

static enum status take_layout(void *options, const struct option_value *given,
                               struct reason *reason)
{
    struct precompute *p = options;
    size_t which = 0;
    enum status status = table_parse_one(TABLE_LAYOUTS, "--layout", given->text, &which, reason);
    p->layout = status ? NULL : layouts_all[which];
    if (p->layout && p->layout->outside)
        return fail(reason, STATUS_INPUT,
                    "--layout: %s is from outside, and files of packed trees hold none such",
                    p->layout->name);
    return status;
}

#define ROWS_OF struct precompute

static const struct option_row rows[] = {
    {"scene", "SCENE",
     "a mesh file (.json .obj .ply .stl, also .gz) or a generator such as soup:n=50",
     OF_FILE(scene)},
    {"out", "FILE", "written to a temporary name and renamed", OF_OUTPUT(out)},
    {"layout", "L", "not as JSON, but packed in a layout: see ref/packed/packed_file.h",
     OF_OWN(take_layout), .table = 1 + TABLE_LAYOUTS},
    {"verify", "FILE", "JSON or packed: is it a tree of the scene, and are its boxes large enough?",
     OF_FILE(verify)},
    {"builder", "B", "see raydiff list builders", OF_ONE(builder, TABLE_BUILDERS), .value = "rtrs"},
    {"item-count", "N", "items per leaf: the goal of rtrs, the limit of others",
     OF_COUNT(build.leaf, 1, UINT32_MAX), .standard = BUILD_LEAF_DEFAULT},
    {"eps", "E", "builder rtrs: a box below half of it is not split",
     OF_REAL(build.eps, -INFINITY, INFINITY), .standard = BUILD_EPS_DEFAULT},
    SCENE_SEED_ROW(seed),
    {0},
};

static const struct option_set set = {
    .command = "precompute",
    .usage = "precompute --scene SCENE --out FILE [OPTIONS]\n"
             "precompute --scene SCENE --verify FILE",
    .about = "Builds a scene's tree and writes it as JSON, byte for byte as the precompute of RTRS "
             "does with builder rtrs; or checks a file from another program.",
    .group = {GROUP(rows), GROUP_AT(build_rows, build)},
    .codes = "0 written, or verified; 1 a tree, but with too small boxes, or triangles in no leaf "
             "or in several; 2 bad input, no tree, or RTRS never ends here; 4 no memory",
    .example = "precompute --scene sphere:n=8 --out sphere.bvh.json --item-count 2",
};

/* Writes the tree as JSON, or packed if `packed` is not NULL. The output file appears only once it
 * is complete. */
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

/* Writes the tree as JSON, or packed in the layout of --layout. */
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
    struct bvh_stats stats;
    status = bvh_count(&bvh, scene, &stats, reason);
    if (!status)
        status = write_out(p, scene, &bvh, reason);
    if (!status)
        fprintf(stderr, "%s: %s, %s, %s of at most %s, depth %u, %s too small\n", p->out,
                COUNTED(bvh.tri_count, "triangle"), COUNTED(stats.node_count, "node"),
                COUNTED(stats.leaf_count, "leaf"), COUNTED(stats.largest_leaf, "item"), stats.depth,
                COUNTED(stats.loose_count, "inner box"));
    bvh_free(&bvh);
    return status;
}

/* *sound becomes true if nothing is wrong with the tree; else `reason` is set. */
static enum status verify_packed(const char *bytes, size_t size, const struct precompute *p,
                                 const struct scene *scene, bool *sound, struct reason *reason)
{
    struct packed packed;
    struct packed_faults faults;
    enum status status =
        packed_file_read(file_label(p->verify), bytes, size, scene, &packed, &faults, reason);
    *sound = !status && reason->text[0] == '\0';
    if (!status)
        printf("%s: layout %s, %s, %s too small, %s in no leaf, %u in several\n", p->verify,
               packed.layout->name, COUNTED(packed.node_count, "record"),
               COUNTED(faults.loose_boxes, "box"), COUNTED(faults.lost_prims, "triangle"),
               faults.double_prims);
    packed_free(&packed);
    return status;
}

static enum status verify_json(const char *bytes, size_t size, const struct precompute *p,
                               const struct scene *scene, bool *sound, struct reason *reason)
{
    struct bvh bvh;
    enum status status = bvh_json_read(file_label(p->verify), bytes, size, scene, &bvh, reason);
    struct bvh_stats stats;
    if (!status)
        status = bvh_count(&bvh, scene, &stats, reason);
    struct reason why;
    *sound = !status && bvh_check(&bvh, scene, &why) == STATUS_OK;
    if (!status && !*sound)
        (void)fail(reason, STATUS_INPUT, "%s: %s", file_label(p->verify), why.text);
    if (!status)
        printf("%s: %s, %s of at most %s, depth %u, %s too small\n", p->verify,
               COUNTED(stats.node_count, "node"), COUNTED(stats.leaf_count, "leaf"),
               COUNTED(stats.largest_leaf, "item"), stats.depth,
               COUNTED(stats.loose_count, "inner box"));
    bvh_free(&bvh);
    return status;
}

/* Verifies the file. Returns the exit code. */
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

int cmd_precompute(int argc, char **argv)
{
    struct precompute p = {.build = build_options_default()};
    struct reason reason = {""};
    int first, code = options_read(&set, &p, argc, argv, &first);
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
    return status ? exit_with_reason("precompute", status, &reason) : code;
}
