/* raydiff tree: a tree of another program, read and checked without rays. */
#ifndef CMD_TREE_DUMP_H
#define CMD_TREE_DUMP_H

#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_screen.h"
#include "ref/dump/dump_check.h"

struct tree_command {
    uint32_t format; /* of dump_formats; DUMP_GUESSED */
    uint32_t faults; /* to be named, of each rule */
    const char *json;
    struct screen_options screen;
};

/* A file that was read, and what was found. */
struct tree_told {
    const char *file;
    const char *scene; /* as it was named; NULL: none, or the file's own triangles */
    const struct tree_dump *dump;
    const struct dump_report *report;
    bool has_scene;
};

void tree_print(const struct tree_told *told, const struct screen *screen);

/* Errors: as json_write. */
enum status tree_write_json(const char *path, const struct tree_told *told, int code,
                            struct reason *reason) MUST_USE;

#endif
