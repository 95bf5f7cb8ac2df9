/* Shared by commands that show pictures: their options, and opening a scene, its tree and a view.
 * Commands only.
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

#define RENDER_SCENE_DEFAULT "rtrs" /* the scene RTRS shows by default */
#define RENDER_WINDOW_WIDTH  800u   /* if only a workgroup size is given */
#define RENDER_WINDOW_HEIGHT 600u

/* An intersection handler of RTRS, as members of our tables for each profile. */
struct render_handler {
    const char *name; /* as in --handler; RTRS spells it --handler-NAME */
    struct {
        const char *builder, *layout, *box, *tri;
        uint32_t leaf;
    } member[2]; /* [PROFILE_...] */
};

extern const struct render_handler render_handlers[]; /* ends with a NULL name */

/* Settings from options. Fields marked "filled in" are NULL or 0 before render_settings_finish
 * unless the user set them. */
struct render_settings {
    char *scene;   /* NULL: RENDER_SCENE_DEFAULT */
    uint64_t seed; /* for generators */
    struct look look;
    enum { RENDER_AS_SCENE, RENDER_FIXED, RENDER_ORBIT } turn;
    enum framing framing;                 /* of a scene without a camera */
    uint32_t width, height, tile;         /* filled in: all above 0 */
    const struct render_handler *handler; /* filled in */
    const struct engine *engine;          /* filled in */
    struct engine_options engine_options;
    bool waves;                    /* use engine.trace, even if the engine has a renderer */
    const char *bvh;               /* a tree from a file, or NULL */
    const struct builder *builder; /* filled in, as are all members below */
    struct build_options build;
    /* NULL: the first that fits, if layout_auto; else that of a packed --bvh file; else the
     * handler's. */
    const struct layout *layout;
    bool layout_auto;
    const struct layout *versus; /* second of --layout A,B in modes with two_layouts; or NULL */
    const struct box_test *box;
    const struct tri_test *tri;
    enum frame_plan plan;
    bool general;
    bool resizable;   /* filled in: no size was given, so the picture follows its window */
    const char *out;  /* path of the picture */
    const char *json; /* or NULL */
    struct {
        const char *csv;
        struct show_range range;
    } show; /* for --show */
    struct {
        uint64_t frames, turns, warm_up;
        const char *base;
    } benchmark; /* for --benchmark */
    struct {
        float seconds; /* 0: no limit */
        uint64_t pictures;
        const char *log;
        float fps;
    } window; /* for --window */
};

struct render_settings render_settings_default(void);

/* Options of struct render_settings: those of all pictures, and those of each mode. */
extern const struct option_row render_rows[], render_show_rows[], render_benchmark_rows[],
    render_window_rows[];

/* Fills in what was not given: the resolution by RTRS's three forms, and the members of the
 * profile's handler. `command` prefixes notes on stderr. Errors: STATUS_INPUT contradicting
 * options. */
enum status render_settings_finish(const char *command, struct render_settings *settings,
                                   struct reason *reason) MUST_USE;

/* Rejects options of members that no engine in `engine` uses. Call after render_settings_finish.
 * Errors: STATUS_INPUT. */
enum status render_options_check(const struct render_settings *settings, const struct list *engine,
                                 struct reason *reason) MUST_USE;

/* The engine to use instead of `engine` with the settings' handler: naive tests every triangle.
 * Errors: STATUS_INPUT there is none. */
enum status render_engine(const struct render_settings *settings, const struct engine *engine,
                          const struct engine **out, struct reason *reason) MUST_USE;

/* A scene with its tree, ready for pictures. Owns everything. Do not move it: the job points into
 * it. */
struct render_stage {
    const char *name;      /* of the scene; borrowed */
    uint32_t tri_count;    /* of the scene as read; handler blank shows none of them */
    struct scene scene;    /* the scene shown */
    struct camera camera;  /* `orbit`: set by the options, else by the scene */
    struct tree_file file; /* from --bvh */
    struct bvh bvh;        /* empty if the file is packed */
    struct packed packed;  /* in settings->layout; empty if the engine needs none */
    struct shading shading;
    struct frame_job job;
};

/* Opens everything. Warnings and notes go to stderr as "raydiff COMMAND: ...". Errors, after which
 * *out is zero: those of scene_open, tree_open, shading_make and packed_make (with a hint at
 * --layout auto); STATUS_INPUT a camera that is not finite. */
enum status render_stage_open(const char *command, const struct render_settings *settings,
                              struct render_stage *out, struct reason *reason) MUST_USE;

/* Packs the stage's tree in another layout and sets it in the job. Errors: those of packed_make and
 * tree_file_pack; the stage then has no packed tree. */
enum status render_stage_pack(struct render_stage *stage, const struct layout *layout,
                              struct reason *reason) MUST_USE;

/* The view for the job's size after turning the camera by `angle` radians (see camera_orbit). */
struct view render_stage_view(const struct render_stage *stage, double angle);

void render_stage_close(struct render_stage *stage); /* a zeroed one is fine */

/* What `raydiff render --NAME` does with the settings instead of writing pictures. */
struct render_mode {
    const char *name;             /* the option that selects it */
    const struct option_row *row; /* its own options, for struct render_settings */
    const char *never;            /* options of render it does not use, separated by blanks */
    bool two_layouts;             /* --layout may name two; the second is settings->versus */
    /* Runs with finished settings. Returns the exit code. `value` is the option's, or NULL. */
    int (*run)(const struct render_settings *settings, const char *value);
};

#endif
