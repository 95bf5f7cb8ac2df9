/* Shared by cmd_report_pictures.c and cmd_report_looks.c; private to them. */
#ifndef CMD_REPORT_GALLERY_H
#define CMD_REPORT_GALLERY_H

#include "cmd/report/cmd_report_parts.h"

#define TEXT_BYTES   16384
#define NAME_BYTES   96
#define LAYOUT_BYTES 512

/* The pictures of one scene while they are made. */
struct gallery {
    const struct report_options *options;
    struct runner *runner;
    struct report *report;
    size_t scene; /* index */
    bool named;   /* the user chose the engines */
    char group[256];
    char commands[TEXT_BYTES], why[RUN_SAID_MOST]; /* of all runs, one per line */
    int code;
    double seconds;
    bool drawn, stopped;
    json_t *pairs; /* results of raydiff diff; owned */
};

const char *gallery_scene(const struct gallery *gallery);

/* The members that the user named, or `own` if the user named none or all. */
const char *gallery_named(const struct report_options *options, const char *flag, const char *own);

/* Adds the last line of what a command said to the reasons: notes stand before why it ended. */
void gallery_complain(struct gallery *gallery, const char *who, const char *what);

/* Begins a command line with the gallery's scene. */
void gallery_line(const struct gallery *gallery, const char *command, struct line *line);

/* Runs a command of the part. Adds the size, the members that the user named (`layout`: also
 * layouts), and the options to write the picture `name` and, unless NULL, the file `json`. Frees
 * the line. Errors: those of runner_run. */
enum status gallery_run(struct gallery *gallery, command_fn *command, struct line *line,
                        bool layout, const char *name, const char *json, struct run *run,
                        struct reason *reason);

/* A name such as "cpu-0.png". It includes the scene's index, since all scenes share a folder. */
void gallery_file_name(const struct gallery *gallery, const char *what, char name[NAME_BYTES]);

/* Reports that a file written by a command cannot be read, with the command's own message if it
 * printed one. */
void gallery_unread(struct gallery *gallery, const char *who, const char *said, enum status status,
                    const struct reason *why);

/* Adds a picture made by a command. */
void gallery_show(struct gallery *gallery, const char *title, const char *caption, const char *name,
                  const char *said);

/* Adds the false-colour pictures of one layout, and of a second one compared with the first.
 * Errors: those of runner_run. */
enum status gallery_look_at_tree(struct gallery *gallery, struct reason *reason) MUST_USE;

#endif
