/* Shared by the parts of bench paper. For commands only. */
#ifndef CMD_BENCH_PAPER_H
#define CMD_BENCH_PAPER_H

#include "cmd/bench/cmd_bench.h"
#include "cmd/bench/cmd_bench_frames.h"
#include "bench/frames/paper.h"
#include "scenes/render/diff_frames.h"

/* A scene of the tables. */
struct paper_scene {
    const char *spec;
    const struct paper_figure *figure; /* published for the paper's scene */
    bool same;                         /* the paper's own scene; else another mesh of its kind */
    bool furnished;                    /* this benchmark added lights and material */
    struct scene scene;
};

/* The tables' lines, in order. */
enum paper_line_id {
    LINE_DIRECT,   /* published: 48-byte nodes, leaf 2 */
    LINE_RF,       /* published: 16-byte records, leaf 4 */
    LINE_DIRECT_4, /* the direct layout on RF's tree */
    LINE_NAIVE,    /* published triangle test, no tree */
    LINE_BLANK,
    LINE_EMBREE,
    LINE_DIRECT_WHOLE, /* published, whole paths per invocation, as RTRS: if no ray is cut */
    LINE_RF_WHOLE,
    LINE_DIRECT_CULLS, /* published, but with a box test that culls */
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

/* Measurements of a line. */
struct paper_line {
    size_t contestant;      /* index in the session; SIZE_MAX: left out */
    char why[320];          /* why it was left out */
    bool checked;           /* compared with peer_of's frame, same members */
    struct frame_diff diff; /* to that frame */
    size_t wrong;           /* pixels that differ from brute force in the same look */
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
enum paper_line_id paper_line_other(enum paper_line_id id); /* line that its ratio is relative to */

/* Opens a scene of the tables: PAPER_DEFAULT or PAPER_TEAPOT. Errors: STATUS_UNSUPPORTED the teapot
 * was not fetched; as scene_open; STATUS_MEMORY. */
enum status paper_scene_open(unsigned which, struct paper_scene *out, struct reason *reason);

/* Prints Figure 8 of the scenes, and the same trees in three layouts. A number of the paper's own
 * scene that differs from the published one is counted as a mismatch. */
void paper_print_bytes(struct bench *bench, const struct paper_scene *scene, size_t count);

/* Opens the painters, checks a frame of each line, and measures. A line that cannot be drawn is
 * left out with the reason; bench_worse counts it if that is a failure. Errors: as
 * frames_session_measure; those of drawing by brute force. */
enum status paper_measure(struct paper_table *table, struct reason *reason) MUST_USE;

/* Prints the lines and adds their rows. A line whose frame differs from that of engine cpu (or of
 * brute force, for an engine without a tree) is counted as a mismatch. */
void paper_print_table(struct paper_table *table);

/* Prints what the measurements show about the paper's 19 %. */
void paper_print_words(struct paper_table *const *table, size_t count);

/* Writes the chart of direct against RF over the frames: BASE-SCENE.svg and .png. Errors: as
 * chart_write. */
enum status paper_write_chart(const struct paper_table *table, const char *base,
                              struct reason *reason) MUST_USE;

/* Writes the plot of bytes against ms as SVG. */
enum status paper_write_plot(struct paper_table *const *table, size_t count, const char *path,
                             struct reason *reason) MUST_USE;

#endif
