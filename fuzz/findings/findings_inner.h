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
    uint64_t pending; /* counted, and in no line or checkpoint yet */
    bool stale;       /* its file `count` is to be written */
    uint64_t line;    /* of the log, where it is first named; 0: none */
    uint64_t counted; /* what its file `count` says; 0: there is none, or it says nothing */
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

/* The member of that signature, made if need be; NULL without memory. */
struct findings_member *findings_member_of(struct findings *findings,
                                           const struct fuzz_signature *signature);

/* True if the log has a line of that finding. */
bool findings_is_known(const struct findings *findings, const struct fuzz_signature *signature,
                       const struct findings_order *order, uint32_t ray);

/* From now on it is; false without memory. */
bool findings_know(struct findings *findings, const struct fuzz_signature *signature,
                   const struct findings_order *order, uint32_t ray) MUST_USE;

/* Called for each line of a finding; `text` is valid during the call. */
typedef enum status findings_line_fn(void *user, const struct findings_line *line,
                                     struct reason *reason);

/* Reads the log into entries, keys and state, and hands each finding's line to `each` (may be
 * NULL). A torn last line is cut off where the folder is writable, ignored otherwise; said. Errors:
 * STATUS_INPUT "PATH:LINE: rule"; STATUS_MEMORY; what `each` returns. */
enum status findings_log_read(struct findings *findings, findings_line_fn *each, void *user,
                              struct reason *reason) MUST_USE;

/* Appends the line of a finding. Errors: STATUS_INPUT cannot write, and then the log is as it was;
 * STATUS_MEMORY. */
enum status findings_log_add(struct findings *findings, const struct finding_file *file,
                             uint32_t ray, const char *opinion, struct reason *reason) MUST_USE;

/* Appends a line as it is, without its end. */
enum status findings_log_put(struct findings *findings, const char *text, size_t length,
                             struct reason *reason) MUST_USE;

/* Appends a checkpoint with all that is pending. */
enum status findings_log_checkpoint(struct findings *findings, const char *state,
                                    struct reason *reason) MUST_USE;

/* Opens the folder and its log, and reads nothing. */
/* The name of a signature's folder: as it is there, else as it is to be made. */
void findings_member_name(const struct findings *findings, const struct fuzz_signature *signature,
                          char name[FUZZ_SIGNATURE_MOST]);

enum status findings_folder_open(const char *folder, bool writable, struct findings **out,
                                 struct reason *reason) MUST_USE;

/* Reads first, smallest and count of every signature's folder into the members; where writable,
 * removes temporary files. */
enum status findings_folder_read(struct findings *findings, struct reason *reason) MUST_USE;

/* Reads first.trial or smallest.trial; *there: it is there. */
enum status findings_folder_get(const struct findings *findings,
                                const struct fuzz_signature *signature, const char *name,
                                struct finding_file *file, bool *there,
                                struct reason *reason) MUST_USE;

/* Writes first.trial or smallest.trial, and the signature's folder if need be. */
enum status findings_folder_put(struct findings *findings, const struct finding_file *file,
                                const char *name, struct reason *reason) MUST_USE;

/* Reads log and folders, in that order, `each` as in findings_log_read, and checks that they fit
 * together. A killed writer, or a full disk, can leave more files than the log has findings, and
 * lower counts, never less: a finding of the log whose files are gone, a count above the log's, a
 * campaign's statistics beside a log without a checkpoint are the work of others. Errors: as those
 * two; STATUS_INPUT "PATH[:LINE]: rule". */
enum status findings_read(struct findings *findings, findings_line_fn *each, void *user,
                          struct reason *reason) MUST_USE;

/* Removes a folder that a merge made under a temporary name, as far as it can be. */
void findings_remove(const char *path);
/* The same of what merges to `to` left that were killed: TO.PID.tmp. */
void findings_remove_killed(const char *to);

/* Writes the file `count` of every entry whose number changed. */
enum status findings_folder_counts(struct findings *findings, struct reason *reason) MUST_USE;

#endif
