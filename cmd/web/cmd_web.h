/* Shared by the files of raydiff web: pages of findings and scenes for a browser. Commands only. */
#ifndef CMD_WEB_H
#define CMD_WEB_H

#include "cmd/common/cmd_tables.h"
#include "cmd/explain/cmd_explain_inner.h"
#include "fuzz/export/export_rights.h"
#include "ref/files/folder.h"

#include <stdio.h>

#define WEB_JOBS      2u
#define WEB_RAYS_MOST 256u /* of a page */

/* A tree that the browser traces, on a layout. */
struct web_job {
    char name[STORED_NAME_MOST]; /* of layout and storage */
    struct reason why;           /* why there is no WGSL for it, if words is NULL */
    uint32_t *words;             /* what gpu/webgpu/core.js takes */
    size_t word_count;
    struct hit *answer; /* of C on the same bytes, for each ray; NULL: it did not finish */
};

/* What a page needs beside what is explained. Owns all but the rays. */
struct web_data {
    const struct ray *ray; /* `count` of them, of which the first has the number `first` */
    size_t first, count;
    struct web_job job[WEB_JOBS]; /* the subject's own layout, where it has one, then f32 */
    size_t job_count;
    struct export_right *right;
    size_t right_count;
};

/* Errors: those of the oracle; STATUS_MEMORY. *out is zero on error. */
enum status web_data_make(const struct explain_page *page, struct web_data *out,
                          struct reason *reason) MUST_USE;
void web_data_free(struct web_data *data);

/* Writes a page that needs no other file and fetches nothing. Write errors stay in the stream.
 * Errors: STATUS_MEMORY. */
enum status web_page_write(FILE *out, const struct explain_page *page, const struct web_data *data,
                           int exit_code, struct reason *reason) MUST_USE;

/* The head of a page up to its body, and the end. */
struct html;
void web_html_begin(struct html *html, const char *title);
void web_html_end(struct html *html);

/* A page of the folder. */
#define WEB_NAME_MOST 128u
struct web_entry {
    char name[WEB_NAME_MOST]; /* "NAME.html" without the ending */
    char *subject;            /* as the user named it, or the file of a folder of findings */
    char verdict[200], cause[80];
    struct reason why; /* why there is no page; "" if there is one */
};

/* Writes the list of pages. */
void web_index_write(FILE *out, const struct web_entry *entry, size_t count);

/* Names a page after a signature or a scene: other characters than letters, digits, '.', '_' and
 * '-' become '-'. */
void web_name(const char *text, char name[WEB_NAME_MOST]);

/* A folder that takes its name when all its files are written. */
struct web_folder {
    char goal[FOLDER_PATH_MOST];
    char *path; /* its temporary name */
    int held;   /* keeps the lock on it; -1: none */
    bool force;
};

/* Makes it beside its goal. With `force` the goal may exist, if it holds nothing but pages. Errors:
 * STATUS_INPUT it exists, or cannot be made. */
enum status web_folder_open(const char *goal, bool force, struct web_folder *out,
                            struct reason *reason) MUST_USE;

/* Gives it its name. Errors: STATUS_INPUT. */
enum status web_folder_commit(struct web_folder *folder, struct reason *reason) MUST_USE;

/* Removes it, if it was not committed. One without a path is fine. */
void web_folder_discard(struct web_folder *folder);

#endif
