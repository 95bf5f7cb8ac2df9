/* What the parts of raydiff explain share. For commands only. */
#ifndef CMD_EXPLAIN_INNER_H
#define CMD_EXPLAIN_INNER_H

#include "fuzz/findings/finding_file.h"
#include "gpu/trace/decode.h"
#include "cmd/explain/cmd_explain.h"
#include "cmd/common/cmd_rows.h"
#include "scenes/rays/rays.h"

#include <jansson.h>

struct explain_options {
    struct explain_of of;
    const struct ray_set *rays;
    const char *ray_text, *json;
    uint64_t count, index;
    bool has_index, has_cause, has_engine;
    bool has_file;    /* scene, rays and test come from a finding's file */
    bool about_tree;  /* of a finding that is on no ray */
    bool has_trial;   /* all of them come from a trial's name */
    enum cause cause; /* looked for, if has_cause */
    struct engine_options engines;
};

/* Takes what is to be explained: a scene, the name of a trial of raydiff conform, or a finding's
 * file, which is then read into *file. Errors: STATUS_INPUT; as finding_file_read. */
enum status explain_take_subject(struct explain_options *options, const char *text,
                                 struct finding_file *file, struct reason *reason) MUST_USE;

/* What explain_decode found. */
struct explain_decode {
    bool asked;    /* the layout is from outside and has a shader */
    bool compared; /* else `why` not */
    struct decoded decoded;
    struct reason why;
};

/* Compares what C and GLSL of a layout from outside decode. Errors: as decode_compare, but that it
 * cannot be done here. */
enum status explain_decode(const struct explain_options *o, const struct packed *packed,
                           struct explain_decode *out, struct reason *reason) MUST_USE;

/* EXIT_AGREE, EXIT_MISMATCH or, if it is asked and cannot run here, EXIT_SKIPPED. */
int explain_decode_code(const struct explain_decode *decode);

/* Prints it, if `asked`. */
void explain_decode_print(const struct explain_decode *decode);

/* The same as JSON; null unless `asked`. The caller owns it. */
json_t *explain_decode_json(const struct explain_decode *decode);

/* Writes o->json, if there is one, where no answer of `count` rays is wrong. Errors: as
 * explain_write_json. */
enum status explain_write_none(const struct explain_options *o, size_t count,
                               const struct explain_decode *decode, int exit_code,
                               struct reason *reason) MUST_USE;

/* Explains a finding about a tree: prints which record, slot and bound are at fault, and writes
 * o->json. *code: the exit code. Errors: as fuzz_play and fuzz_trial_tree; STATUS_INPUT cannot
 * write. */
enum status explain_tree_finding(const struct explain_options *o, const struct finding_file *file,
                                 int *code, struct reason *reason) MUST_USE;

/* Writes the command that explains ray `index` of the finding's file again; NULL if there is no
 * file. */
const char *explain_again(const struct explain_options *options, size_t index,
                          char text[EXPLAIN_COMMAND_MOST]);

/* Refuses options that this ray does not use, in one line. A trial's name and a finding's file decide
 * all but how they are played. Returns -1 if there are none, else the exit code. */
int explain_check_use(const struct explain_options *options, char *const *spec);

#endif
