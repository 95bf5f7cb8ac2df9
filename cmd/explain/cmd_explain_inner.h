/* Shared by the files of raydiff explain. Commands only. */
#ifndef CMD_EXPLAIN_INNER_H
#define CMD_EXPLAIN_INNER_H

#include "fuzz/findings/finding_file.h"
#include "gpu/trace/decode.h"
#include "cmd/explain/cmd_explain.h"
#include "cmd/common/cmd_rows.h"
#include "scenes/rays/rays.h"

#include <jansson.h>

/* In place of the default layout, of scenes and worlds that it cannot hold. */
#define EXPLAIN_LARGE_LAYOUT "f32"

/* Shows a page elsewhere; `exit_code` is that of the run. */
typedef enum status explain_show_fn(void *to, const struct explain_page *page, int exit_code,
                                    struct reason *reason);

struct explain_options {
    const char *command; /* whose options they are, for messages */
    /* Called with the page in place of printing it. Where no answer is wrong, the page is of the
     * first ray. Worlds are refused then. NULL: it is printed. */
    explain_show_fn *shows;
    void *shows_to;
    struct explain_of of;
    const struct ray_set *rays;
    const char *ray_text, *json, *html, *svg;
    uint64_t count, index;
    bool has_index, has_cause, has_engine;
    bool has_file;    /* scene, rays and test come from a finding's file */
    uint64_t modes;   /* of a world: enum ray_modes */
    uint32_t braid;   /* likewise */
    bool about_tree;  /* the finding has no ray */
    bool has_trial;   /* all of them come from a trial's name */
    enum cause cause; /* the requested cause, if has_cause */
    struct engine_options engines;
    struct screen_options screen;
};

/* The options; they fill a struct explain_options. */
extern const struct option_set explain_set;

/* Reads the subject: a scene, the name of a trial of raydiff conform, or a finding's file, which is
 * read into *file. Errors: STATUS_INPUT; those of finding_file_read. */
enum status explain_take_subject(struct explain_options *options, const char *text,
                                 struct finding_file *file, struct reason *reason) MUST_USE;

/* Explains what explain_take_subject and explain_check_use took. Frees *file. *code is the exit
 * code so far. Errors: those of the scene, the tree and the engine, STATUS_INPUT cannot write. */
enum status explain_run(struct explain_options *options, struct finding_file *file, int *code,
                        struct reason *reason) MUST_USE;

/* The page as JSON. The caller owns it; NULL: no memory. */
json_t *explain_json(const struct explain_page *page, int exit_code);

/* The result of explain_decode. */
struct explain_decode {
    bool asked;    /* the layout is external and has a shader */
    bool compared; /* false: `why` holds the reason */
    struct decoded decoded;
    struct reason why;
};

/* Compares what C and GLSL of an external layout decode. Errors: those of decode_compare, except
 * that it cannot run here. */
enum status explain_decode(const struct explain_options *o, const struct packed *packed,
                           struct explain_decode *out, struct reason *reason) MUST_USE;

/* EXIT_AGREE, EXIT_MISMATCH, or EXIT_SKIPPED if `asked` but it cannot run here. */
int explain_decode_code(const struct explain_decode *decode);

/* Prints the result if `asked`. */
void explain_decode_print(const struct explain_decode *decode, const struct screen *screen);

#define EXPLAIN_CONCLUSION_MOST 400u /* bytes, the end included */

/* Writes in one sentence what was answered to the ray, and the cause if that is wrong. */
void explain_conclude(const struct judged_ray *ray, char text[EXPLAIN_CONCLUSION_MOST]);

/* Prints the last line of a run: the text, and the result of explain_decode if `asked`, first if
 * C and GLSL differ, since that is the cause of the rest. */
void explain_print_conclusion(const char *text, const struct explain_decode *decode,
                              const struct screen *screen);

/* Prints the node where a traversal ended: words, bounds, slabs; in 80 columns, unless `wide`. */
void explain_node_print(FILE *out, const struct explain_step *step, bool wide);

/* The result as JSON; null unless `asked`. The caller owns it. */
json_t *explain_decode_json(const struct explain_decode *decode);

/* Writes o->json, if set, when no answer of `count` rays is wrong. Errors: those of
 * explain_write_json. */
enum status explain_write_none(const struct explain_options *o, size_t count,
                               const struct explain_decode *decode, int exit_code,
                               struct reason *reason) MUST_USE;

/* Explains a finding about a tree: prints which record, slot and bound are at fault, and writes
 * o->json. *code: the exit code. Errors: those of fuzz_play and fuzz_trial_tree; STATUS_INPUT
 * cannot write. */
enum status explain_tree_finding(const struct explain_options *o, const struct finding_file *file,
                                 int *code, struct reason *reason) MUST_USE;

/* Writes the command that explains ray `index` of the finding's file again. Returns NULL if there
 * is no file. */
const char *explain_again(const struct explain_options *options, size_t index,
                          char text[EXPLAIN_COMMAND_MOST]);

/* Rejects options that this ray does not use, in one line. A trial's name and a finding's file
 * decide everything except how they are played. Returns -1 if there are none, else the exit
 * code. */
int explain_check_use(const struct explain_options *options, char *const *spec);

/* Writes how the tree of a builder on a device differs from C's; "": it does not, or is C's.
 * Errors: as builder->compare, but that a difference is none. */
enum status explain_compare_built(const struct builder *builder, const struct scene *scene,
                                  struct reason *built, struct reason *reason) MUST_USE;

#endif
