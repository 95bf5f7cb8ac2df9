/* raydiff build --same: whether the same build has the same bytes each time, with any number of
 * threads. For commands only. */
#ifndef CMD_BUILD_SAME_H
#define CMD_BUILD_SAME_H

#include "cmd/common/cmd_screen.h"
#include "ref/match/match.h"

#include <jansson.h>

#define SAME_THREADS      4
#define SAME_LAYOUTS_MOST 128
#define SAME_ENGINES_MOST 8

/* 1, 2, 8, 16. */
extern const uint32_t same_threads[SAME_THREADS];

struct same_job {
    const struct builder *const *builder;
    size_t builder_count;
    const struct layout *const *layout; /* SAME_LAYOUTS_MOST at most */
    size_t layout_count;
    uint32_t rounds; /* builds with each number of threads */
    uint64_t seed;   /* of rays */
};

/* A builder's tree, or what a layout makes of it. */
struct same_row {
    const struct builder *builder; /* NULL: it was not come to */
    const struct layout *layout;   /* NULL: the tree */
    uint32_t builds, differing;    /* compared with the first; and not equal to it */
    char text[64];                 /* where the first of these differs */
    struct reason refused;         /* "" if it was not refused */
};

/* An engine that builds a tree of its own, which cannot be read. */
struct same_engine {
    const struct engine *engine;
    uint32_t builds;
    size_t rays;
    size_t other; /* answers of all builds with other bits than in the first */
    size_t wrong; /* of all builds, by the judge */
    bool absent;  /* it cannot run here */
    struct reason refused;
};

/* Builds and compares. `row`: (1 + layout_count) of each builder, zero before. Errors: as bvh_build
 * and packed_make, but that limits are in the rows. */
enum status same_play(const struct same_job *job, const struct scene *scene, struct same_row *row,
                      struct reason *reason) MUST_USE;

/* Has engines that are libraries build and trace. Errors: as ray_set_new and match_make;
 * STATUS_DEVICE one did not finish. */
enum status same_engines(const struct same_job *job, const struct scene *scene,
                         struct same_engine out[SAME_ENGINES_MOST], size_t *count,
                         struct reason *reason) MUST_USE;

/* EXIT_MISMATCH if a row differs, or an engine's answer is WRONG: other bits of others are no
 * fault. Else EXIT_AGREE. */
int same_code(const struct same_row *row, size_t rows, const struct same_engine *engine,
              size_t count);

void same_print(const struct same_row *row, size_t count, const struct screen *screen);
void same_print_engines(const struct same_engine *one, size_t count, const struct screen *screen);

/* The caller owns it. */
json_t *same_json(const char *scene, const struct same_row *row, size_t count,
                  const struct same_engine *engine, size_t engine_count);

struct build_command;

/* The command: all scenes. Returns the exit code. */
int same_run(const struct build_command *b, char *const *spec, size_t count);

#endif
