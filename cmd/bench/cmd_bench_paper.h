/* The paper's tables: what its parts share. For commands only. */
#ifndef CMD_BENCH_PAPER_H
#define CMD_BENCH_PAPER_H

#include "cmd/bench/cmd_bench.h"
#include "cmd/bench/cmd_bench_frames.h"
#include "bench/frames/paper.h"
#include "scenes/render/diff_frames.h"

/* A scene of the tables. */
struct paper_scene {
    const char *spec;
    const struct paper_figure *figure; /* published beside it */
    bool same;                         /* the paper's own scene; else another mesh of its kind */
    bool furnished;                    /* given lights, material and camera here */
    struct scene scene;
};

/* The tables' lines, in their order. */
enum paper_line_id {
    LINE_DIRECT,   /* published: 48-byte nodes, leaf 2 */
    LINE_RF,       /* published: 16-byte records, leaf 4 */
    LINE_DIRECT_4, /* the direct layout on RF's tree */
    LINE_NAIVE,    /* published triangle test, no tree */
    LINE_BLANK,
    LINE_EMBREE,
    LINE_DIRECT_WHOLE, /* published, whole paths per invocation, as it was: where no ray is cut */
    LINE_RF_WHOLE,
    LINE_DIRECT_CULLS, /* published, but for a box test that culls */
    LINE_RF_CULLS,
    LINE_F32_2, /* repaired */
    LINE_RF16_4,
    LINE_F32_4,
    LINE_RF16_2,
    LINE_NAIVE_MT,
    LINE_EMBREE_MT,
    LINE_F32_2_WHOLE, /* repaired, whole paths */
    LINE_RF16_4_WHOLE,
    LINE_F32_4_WHOLE,
    LINE_RF16_2_WHOLE,
    LINE_COUNT
};

/* What is measured of a line. */
struct paper_line {
    size_t contestant;      /* in the session; SIZE_MAX: left out */
    char why[320];          /* left out */
    bool checked;           /* against engine cpu with the same members */
    struct frame_diff diff; /* to it */
    size_t wrong;           /* pixels that differ from brute force's in the same look */
    struct bvh_stats tree;
};

/* The frames of one scene. */
struct paper_table {
    struct bench *bench;
    const struct paper_scene *scene;
    uint32_t width, height;
    struct frames_session session;
    struct paper_line line[LINE_COUNT];
    bool slow; /* a frame of some line takes over 0.1 s */
};

const char *paper_line_name(enum paper_line_id id);
bool paper_line_published(enum paper_line_id id); /* drawn in the published look */
struct painter_plan paper_plan(const struct paper_table *table, enum paper_line_id id);
enum paper_line_id paper_line_other(enum paper_line_id id); /* what its ratio is to */

/* Opens a scene of the tables: PAPER_DEFAULT or PAPER_TEAPOT. STATUS_UNSUPPORTED: the teapot was
 * not fetched. */
enum status paper_scene_open(unsigned which, struct paper_scene *out, struct reason *reason);

/* Figure 8 of the scenes, and the same trees in three layouts. A number of the paper's own scene
 * that is not the published one is counted as a mismatch. */
void paper_print_bytes(struct bench *bench, const struct paper_scene *scene, size_t count);

/* Opens the painters, checks a frame of each, measures. Errors: as frames_session_measure; who
 * cannot draw is left out with the reason, and counted by bench_worse if that is a failure. */
enum status paper_measure(struct paper_table *table, struct reason *reason) MUST_USE;

/* Prints the lines and adds their rows. A line whose frame is not the one that engine cpu draws is
 * counted as a mismatch. */
void paper_print_table(struct paper_table *table);

/* What became of the paper's 19 %, from what was measured. */
void paper_print_words(struct paper_table *const *table, size_t count);

/* Direct against RF over the frames: BASE-SCENE.svg and .png. Errors: as chart_write. */
enum status paper_write_chart(const struct paper_table *table, const char *base,
                              struct reason *reason) MUST_USE;

/* Bytes against ms, as SVG. */
enum status paper_write_plot(struct paper_table *const *table, size_t count, const char *path,
                             struct reason *reason) MUST_USE;

#endif
