/* What commands that show pictures share: their options, and how a scene, its tree and a view of it
 * are opened by them. For commands only.
 *   settings = render_settings_default(); options_read(...); render_settings_finish(...);
 *   render_stage_open(...); renderer_open(settings.engine, &settings.engine_options, ...);
 *   renderer_prepare(renderer, &stage.job, ...); view = render_stage_view(&stage, angle); ... */
#ifndef CMD_RENDER_H
#define CMD_RENDER_H

#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_tree.h"
#include "scenes/render/camera.h"
#include "scenes/render/render.h"
#include "scenes/render/show_picture.h"

#define RENDER_SCENE_DEFAULT "rtrs" /* RTRS's own */
#define RENDER_WINDOW_WIDTH  800u   /* if only a workgroup size is given */
#define RENDER_WINDOW_HEIGHT 600u

/* What RTRS calls an intersection handler: members of our tables, for either profile. */
struct render_handler {
    const char *name; /* as in --handler; --handler-NAME is RTRS's spelling */
    struct {
        const char *builder, *layout, *box, *tri;
        uint32_t leaf;
    } member[2]; /* [PROFILE_...] */
};

extern const struct render_handler render_handlers[]; /* ends with a NULL name */

/* What the options set. What render_settings_finish fills in is NULL or 0
 * before unless the user named it. */
struct render_settings {
    char *scene;   /* NULL: RENDER_SCENE_DEFAULT */
    uint64_t seed; /* of generators */
    struct look look;
    enum { RENDER_AS_SCENE, RENDER_FIXED, RENDER_ORBIT } turn;
    uint32_t width, height, tile;         /* filled in: all above 0 */
    const struct render_handler *handler; /* filled in */
    const struct engine *engine;          /* filled in */
    struct engine_options engine_options;
    bool waves;                    /* through engine.trace, even if the engine has a renderer */
    const char *bvh;               /* a tree from a file, or NULL */
    const struct builder *builder; /* filled in, as all members below */
    struct build_options build;
    const struct layout *layout; /* NULL: the first that fits, if layout_auto, else the
                                    file's of --bvh or, of JSON, the handler's */
    bool layout_auto;
    const struct layout *versus; /* the second of --layout A,B, for modes of two_layouts; or NULL */
    const struct box_test *box;
    const struct tri_test *tri;
    enum frame_plan plan;
    bool general;
    bool resizable;   /* filled in: no size was named, so a picture can follow its window */
    const char *out;  /* where the picture goes */
    const char *json; /* or NULL */
    struct {
        const char *csv;
        struct show_range range;
    } show; /* of --show */
    struct {
        uint64_t frames, turns, warm_up;
        const char *base;
    } benchmark; /* of --benchmark */
    struct {
        float seconds; /* 0: for ever */
        uint64_t pictures;
        const char *log;
        float fps;
    } window; /* of --window */
};

struct render_settings render_settings_default(void);

/* Options of pictures, and those that follow an engine of them, of struct render_settings. */
extern const struct option_row render_rows[], render_show_rows[], render_benchmark_rows[],
    render_window_rows[];

/* Fills in what was not named: the resolution by RTRS's three forms, and the members of the
 * profile's handler. `command` prefixes notes on stderr.
 * Errors: STATUS_INPUT options that contradict each other. */
enum status render_settings_finish(const char *command, struct render_settings *settings,
                                   struct reason *reason) MUST_USE;

/* Refuses options of members that nothing of `engine` uses. After
 * render_settings_finish. Errors: STATUS_INPUT. */
enum status render_options_check(const struct render_settings *settings, const struct list *engine,
                                 struct reason *reason) MUST_USE;

/* The engine that stands for `engine` with the settings' handler: naive means every triangle.
 * Errors: STATUS_INPUT it has none. */
enum status render_engine(const struct render_settings *settings, const struct engine *engine,
                          const struct engine **out, struct reason *reason) MUST_USE;

/* A scene with its tree, ready for pictures; owns everything. Do not move it: the job points into
 * it. */
struct render_stage {
    const char *name;      /* of the scene; borrowed */
    uint32_t tri_count;    /* of the scene as it was read; handler blank shows none of them */
    struct scene scene;    /* what is shown */
    struct camera camera;  /* `orbit`: of the options, else of the scene */
    struct tree_file file; /* of --bvh */
    struct bvh bvh;        /* empty if the file is packed */
    struct packed packed;  /* of settings->layout; empty if the engine needs none */
    struct shading shading;
    struct frame_job job;
};

/* Opens all of it; warnings and notes go to stderr as "raydiff COMMAND: ...".
 * Errors, of which *out is zero: as scene_open, tree_open, shading_make and packed_make (with a
 * hint at --layout auto); STATUS_INPUT a camera that is not finite. */
enum status render_stage_open(const char *command, const struct render_settings *settings,
                              struct render_stage *out, struct reason *reason) MUST_USE;

/* Packs the stage's tree in another layout and makes it the job's. Errors: as packed_make and
 * tree_file_pack; then the stage has no packed tree. */
enum status render_stage_pack(struct render_stage *stage, const struct layout *layout,
                              struct reason *reason) MUST_USE;

/* The view after the camera was turned by so many radians (see camera_orbit), for the job's size.
 */
struct view render_stage_view(const struct render_stage *stage, double angle);

void render_stage_close(struct render_stage *stage); /* a zero one is fine */

/* Something else to do with the settings than to write pictures: `raydiff render --NAME`. */
struct render_mode {
    const char *name;             /* of the option that chooses it */
    const struct option_row *row; /* its own options, of struct render_settings */
    const char *never;            /* options of render that it does not use, blanks between */
    bool two_layouts;             /* --layout may name two: settings->versus */
    /* Settings are finished. Returns the exit code. `value` is the option's, or NULL. */
    int (*run)(const struct render_settings *settings, const char *value);
};

#endif
