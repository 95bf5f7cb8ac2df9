/* What the parts of fuzz/findings share. */
#ifndef FUZZ_FINDINGS_INNER_H
#define FUZZ_FINDINGS_INNER_H

#include "fuzz/findings/findings.h"
#include "fuzz/play/number_set.h"

#define FINDINGS_PATH_MOST 4096

/* A line of the log. */
struct findings_line {
    struct fuzz_signature signature;
    struct findings_order order;
    uint32_t ray;
    const char *text; /* the line without its end; borrowed */
    size_t length;
};

struct findings_member {
    struct findings_entry entry;
    uint64_t pending; /* counted, but in no line or checkpoint yet */
    bool stale;       /* its file `count` is to be written */
    uint64_t line;    /* of the log, where it is first named; 0: none */
    uint64_t counted; /* read from its file `count`; 0: no file, or not a number */
};

struct findings {
    struct folder folder;
    int log; /* descriptor of findings.jsonl, locked */
    bool writable;
    bool made; /* the log was not there before */
    uint64_t log_size, checkpoints;
    struct findings_member *member;
    size_t count, capacity;
    struct number_set keys; /* hashes of the lines that the log has */
    char state[FINDINGS_STATE_MOST];
    struct reason said;
};

/* The member of that signature; a missing one is added. NULL without memory. */
struct findings_member *findings_member_of(struct findings *findings,
                                           const struct fuzz_signature *signature);

/* True if the log has a line of that finding. */
bool findings_is_known(const struct findings *findings, const struct fuzz_signature *signature,
                       const struct findings_order *order, uint32_t ray);

/* Adds it to those that findings_is_known finds; false without memory. */
bool findings_know(struct findings *findings, const struct fuzz_signature *signature,
                   const struct findings_order *order, uint32_t ray) MUST_USE;

/* Called for each line of a finding; `text` is valid during the call. */
typedef enum status findings_line_fn(void *user, const struct findings_line *line,
                                     struct reason *reason);

/* Reads the log into entries, keys and state, and hands each finding's line to `each` (may be
 * NULL). An incomplete last line is cut off if the folder is writable and ignored otherwise; see
 * findings_said. Errors:
 * STATUS_INPUT "PATH:LINE: rule"; STATUS_MEMORY; what `each` returns. */
enum status findings_log_read(struct findings *findings, findings_line_fn *each, void *user,
                              struct reason *reason) MUST_USE;

/* Appends the line of a finding. Errors: STATUS_INPUT cannot write; the log is then unchanged;
 * STATUS_MEMORY. */
enum status findings_log_add(struct findings *findings, const struct finding_file *file,
                             uint32_t ray, const char *opinion, struct reason *reason) MUST_USE;

/* Appends a line as it is, without its end. */
enum status findings_log_put(struct findings *findings, const char *text, size_t length,
                             struct reason *reason) MUST_USE;

/* Appends a checkpoint with all that is pending. */
enum status findings_log_checkpoint(struct findings *findings, const char *state,
                                    struct reason *reason) MUST_USE;

/* The name of a signature's folder: the existing one, else the one to create. */
void findings_member_name(const struct findings *findings, const struct fuzz_signature *signature,
                          char name[FUZZ_SIGNATURE_MOST]);

/* Opens the folder and its log without reading them. */
enum status findings_folder_open(const char *folder, bool writable, struct findings **out,
                                 struct reason *reason) MUST_USE;

/* Reads first, smallest and count of every signature's folder into the members; where writable,
 * removes temporary files. */
enum status findings_folder_read(struct findings *findings, struct reason *reason) MUST_USE;

/* Reads first.trial or smallest.trial; *there: the file exists. */
enum status findings_folder_get(const struct findings *findings,
                                const struct fuzz_signature *signature, const char *name,
                                struct finding_file *file, bool *there,
                                struct reason *reason) MUST_USE;

/* Writes first.trial or smallest.trial; creates the signature's folder if it is missing. */
enum status findings_folder_put(struct findings *findings, const struct finding_file *file,
                                const char *name, struct reason *reason) MUST_USE;

/* Reads log and folders, in that order, `each` as in findings_log_read, and checks that they fit
 * agree. A killed writer or a full disk can leave files that the log does not have, and lower
 * counts. Neither can cause a finding of the log without its files, a count above the log's, or
 * statistics of a campaign beside a log without a checkpoint: these are errors. Errors: as those
 * two; STATUS_INPUT "PATH[:LINE]: rule". */
enum status findings_read(struct findings *findings, findings_line_fn *each, void *user,
                          struct reason *reason) MUST_USE;

/* Removes a folder that a merge made under a temporary name. Errors are ignored. */
void findings_remove(const char *path);
/* Removes the folders TO.PID.tmp of killed merges to `to`. */
void findings_remove_killed(const char *to);

/* Writes the file `count` of every entry whose number changed. */
enum status findings_folder_counts(struct findings *findings, struct reason *reason) MUST_USE;

#endif
