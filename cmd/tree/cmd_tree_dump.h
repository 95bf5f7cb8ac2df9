/* raydiff tree: a tree of another program, read and checked without rays. */
#ifndef CMD_TREE_DUMP_H
#define CMD_TREE_DUMP_H

#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_screen.h"
#include "ref/dump/dump_check.h"
#include "ref/dump/dump_instances.h"
#include "ref/dump/dump_world.h"

struct tree_command {
    uint32_t format;  /* of dump_formats; DUMP_GUESSED */
    uint32_t faults;  /* to be named, of each rule */
    const char *from; /* rayquery or a variant: the trees are built; NULL: a file is read */
    uint32_t aim;     /* rays through what boxes lack */
    const char *save; /* where to put them; or NULL */
    const char *json;
    struct engine_options engines;
    struct screen_options screen;
};

/* Rays through what boxes lack. All stay in a plane, the coordinate of a side, which is outside of
 * the box. */
struct tree_aimed {
    bool done;
    uint32_t tries;
    uint32_t aimed; /* of these, rays that exactly hit the instance, and nothing before it */
    uint32_t lost;  /* of these, rays for which the driver does not find it */
    uint32_t found; /* of these, rays for which it does if the meshes' boxes are larger */
    struct ray ray; /* the first of `found` */
    uint32_t instance;
    unsigned side;
};

/* A file that was read, and what was found. */
struct tree_told {
    const char *file;
    size_t tree;        /* below the top level of the file, from 1; 0: the first of it */
    const char *scene;  /* as it was named; NULL: none, or the file's own triangles */
    const char *driver; /* that built it; NULL: it was read */
    const struct tree_dump *dump;
    struct dump_report report;
    bool has_scene;
    bool measured; /* of a top level: `lacks` */
    struct dump_lacks lacks;
    struct tree_aimed aimed; /* with --aim, of the first tree */
    bool compared;           /* with `scene`, beside the file's own triangles: `differences` */
    struct dump_differences differences;
    struct tree_told *below; /* of a top level: dump->below_count of them */
};

/* Builds what the options ask for, saves it if they do, and hands out its bytes; *driver is what
 * built it. The caller frees both, also on error. Errors: as accel_parse and rayquery_save;
 * STATUS_INPUT a variant that adds triangles; as world_open and file_out_open. */
enum status tree_build(const struct tree_command *command, const char *spec, char **bytes,
                       size_t *size, char **driver, struct reason *reason) MUST_USE;

/* Traces command->aim rays through what the boxes of `told`, a top level of that world, lack.
 * Errors: as of the engine, and of world_open; STATUS_MEMORY. */
enum status tree_aim(const struct tree_command *command, const char *spec, struct tree_told *told,
                     struct reason *reason) MUST_USE;

void tree_print(const struct tree_told *told, const struct screen *screen);

/* What a top level lacks, in one line without its end. Returns `text`. */
#define TREE_LACKS_TEXT 320
const char *tree_lacks_text(const struct tree_told *told, char text[TREE_LACKS_TEXT]);

/* Errors: as json_write. */
enum status tree_write_json(const char *path, const struct tree_told *told, int code,
                            struct reason *reason) MUST_USE;

#endif
