/* raydiff build: trees that a device builds beside C's, stage by stage. */
#ifndef CMD_BUILD_H
#define CMD_BUILD_H

#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_screen.h"
#include "gpu/build/device_tree.h"
#include "gpu/build/device_builders.h"
#include "gpu/build/wide_compare.h"

#include <jansson.h>

#define BUILD_ROUNDS_MOST 99u

struct build_command {
    struct list builder, layout;
    struct engine_options engines;
    uint64_t seed;
    uint32_t rounds;
    uint32_t same; /* builds with each number of threads; 0: no --same */
    float move;    /* of vertices, for refits; 0: none */
    const char *json;
    struct screen_options screen;
};

/* A part of a build, or (STAGED_PARTS) all of it: milliseconds in the median, and the ratio of the
 * device's time to C's in a round. */
struct build_part {
    double device_ms, c_ms;
    double ratio, ratio_least, ratio_most;
};

/* A builder on a scene. */
struct build_row {
    const char *scene;
    const struct builder *builder;
    uint32_t triangles;
    struct staged_difference differs; /* of the first round that differs; stage NULL: of none */
    uint32_t differing;               /* rounds that differ */
    uint64_t device_bytes;
    struct build_part part[STAGED_PARTS + 1];
};

/* A layout that the tree of a builder is collapsed for and encoded in. */
struct build_wide {
    const char *scene;
    const struct builder *builder;
    const struct layout *layout;
    uint32_t triangles, nodes;
    struct staged_difference differs; /* of the first round that differs; stage NULL: of none */
    uint32_t differing;               /* rounds that differ */
    struct reason refused;            /* "" if it was not refused */
    bool unplayed;                    /* the binary trees differ */
    uint64_t device_bytes;
    double device_ns[WIDE_PARTS][BUILD_ROUNDS_MOST], c_ns[WIDE_PARTS][BUILD_ROUNDS_MOST];
    struct build_part part[WIDE_PARTS];
};

/* The same for the tree that the device has just built, in round `r`. Errors: as wide_compare. */
enum status build_wide_play(struct device_tree *tree, const struct staged *mine,
                            const struct scene *scene, uint32_t r, struct build_wide *wide,
                            struct reason *reason) MUST_USE;

/* Sums up the rounds. */
void build_wide_sum(struct build_wide *wide, uint32_t rounds);
void build_print_wide(const struct build_wide *wide, size_t count, const struct screen *screen);
json_t *build_wide_json(const struct build_wide *wide, size_t count);

#define BUILD_REFITS_MOST 64

/* A layout whose tree is refitted. */
struct build_refit {
    const char *scene;
    const struct layout *layout;
    uint32_t triangles;
    uint32_t differing;    /* rounds that differ */
    char text[64];         /* the first word of the first of them */
    struct reason refused; /* "" if it was not refused */
    struct build_part part;
};

/* Refits the tree of builder hploc, in each layout that a device can refit, to the moved scene.
 * Writes *count results, also on error. Errors: as device_refit and packed_refit, but that limits
 * of layouts are in the results. */
enum status build_refits(struct device_tree *tree, const struct build_command *b,
                         const struct scene *scene, const char *spec,
                         struct build_refit refit[BUILD_REFITS_MOST], size_t *count,
                         struct reason *reason) MUST_USE;
void build_print_refits(const struct build_refit *refit, size_t count, const struct screen *screen);
json_t *build_refits_json(const struct build_refit *refit, size_t count);

/* Builds in all rounds, and makes wide trees in these layouts of what was built. Errors: as
 * device_tree_build, staged_build and wide_compare. */
enum status build_measure(struct device_tree *tree, const struct scene *scene, uint32_t rounds,
                          struct build_row *row, struct build_wide *wide, size_t layout_count,
                          struct reason *reason) MUST_USE;

/* The medians and the ratio's ends of nanoseconds in each round. */
struct build_part build_part_of(const double *device_ns, const double *c_ns, uint32_t rounds);

void build_print(const struct build_row *row, size_t count, const struct screen *screen);

/* What was measured. */
struct build_results {
    struct build_row *row; /* of each scene and builder */
    size_t row_count;
    struct build_wide *wide; /* of each of these and each layout */
    size_t wide_count;
    struct build_refit *refit;
    size_t refit_count;
    int code;
};

/* The exit code: the worst of results->code and, where anything differs, EXIT_MISMATCH. */
int build_exit(const struct build_results *results);

/* Errors: as json_write. */
enum status build_write_json(const char *path, const struct build_results *results,
                             const struct vk_limits *limits, uint32_t rounds, int code,
                             struct reason *reason) MUST_USE;

#endif
