/* A folder of findings:
 *
 *   findings.jsonl                  append-only, a line per finding and per checkpoint
 *   SIGNATURE/first.trial           the finding of the lowest origin (findings_order)
 *   SIGNATURE/smallest.trial        the smallest trial that shows it (fuzz_trial_size)
 *   SIGNATURE/count                 how many there were; for people, made from the log
 *
 * Files appear by renames, whole or not at all; a line is one write. So a process that is killed at
 * any moment leaves a folder that can be opened again: at worst the last line is incomplete, and is
 * cut off. What no kill can leave, such as a finding of the log without its files, is an error. One
 * process at a time writes to a folder: it holds a lock on the log until it ends. */
#ifndef FUZZ_FINDINGS_H
#define FUZZ_FINDINGS_H

#include "fuzz/findings/finding_file.h"
#include "ref/files/folder.h"

/* Lines of one signature; of further findings only the number is kept, in checkpoints. */
#define FINDINGS_LINES_MOST 1000u
#define FINDINGS_NO_RAY     UINT32_MAX
#define FINDINGS_STATE_MOST 8192

struct findings;

/* The order of findings: stream gen before mut, then by seed, index, version, trial. */
struct findings_order {
    bool mutated;
    uint64_t seed, index;
    uint32_t version;
    uint64_t hash; /* fuzz_trial_hash */
};

struct findings_order findings_order(const struct fuzz_trial *trial);
/* Below 0, 0 or above 0, as strcmp. */
int findings_order_compare(const struct findings_order *a, const struct findings_order *b);

/* One signature. */
struct findings_entry {
    struct fuzz_signature signature;
    uint64_t count;               /* of findings */
    uint64_t lines;               /* of them in the log, at most FINDINGS_LINES_MOST */
    bool has_first, has_smallest; /* the files are there */
    struct findings_order first;
    struct fuzz_trial_size smallest;
    char versions[FINDING_VERSIONS_MOST]; /* of the first */
};

/* What a finding changed. */
struct findings_news {
    bool repeated; /* the folder had it: the same trial, signature and ray. Nothing changed */
    bool signature, first, smallest; /* new ones */
};

/* True if the path is a folder of findings, valid or not. findings_open makes a missing one. */
bool findings_is_folder(const char *path);

/* Opens a folder for writing; a missing one is created (its parent must exist). Reads the content
 * and removes the temporary files of killed writers.
 * Errors: STATUS_INPUT it cannot be written, another process is writing to it, or "PATH: rule"
 * where the content is not that of a folder of findings; STATUS_MEMORY. */
enum status findings_open(const char *folder, struct findings **out,
                          struct reason *reason) MUST_USE;

/* Opens a folder for reading and changes nothing. Errors: likewise. */
enum status findings_look(const char *folder, struct findings **out,
                          struct reason *reason) MUST_USE;

/* One line on the incomplete line that was cut off when it was opened, or "". */
const char *findings_said(const struct findings *findings);

/* Adds a finding: file->signature, seen on ray `ray` of file->trial (FINDINGS_NO_RAY: on none, as a
 * crash), with one line of `opinion`. The files are written first, then the line, so that a finding
 * that is counted has its files. Beyond FINDINGS_LINES_MOST findings are counted by the next
 * findings_checkpoint. Errors: STATUS_INPUT no signature, no such ray, cannot write; STATUS_MEMORY.
 */
enum status findings_add(struct findings *findings, const struct finding_file *file, uint32_t ray,
                         const char *opinion, struct findings_news *news,
                         struct reason *reason) MUST_USE;

/* Offers a shrunk trial of a known signature: only `smallest` can be news, nothing is counted.
 * Errors: STATUS_INPUT the signature is not known, cannot write; STATUS_MEMORY. */
enum status findings_offer(struct findings *findings, const struct finding_file *file,
                           struct findings_news *news, struct reason *reason) MUST_USE;

/* Records in the log that `state`, a text of the caller shorter than FINDINGS_STATE_MOST, includes
 * all findings added so far. A killed caller resumes from there; findings that it adds again are
 * recognized as repeated. Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status findings_checkpoint(struct findings *findings, const char *state,
                                struct reason *reason) MUST_USE;

/* The last checkpoint's state, "" if there is none. */
const char *findings_state(const struct findings *findings);

size_t findings_count(const struct findings *findings);
/* In the order in which they were first seen. Valid until the next call that changes something. */
const struct findings_entry *findings_entry(const struct findings *findings, size_t i);
/* NULL if the folder has none of that signature. */
const struct findings_entry *findings_find(const struct findings *findings,
                                           const struct fuzz_signature *signature);
/* Reads "first.trial" or "smallest.trial" of a signature. Errors: as finding_file_read. */
enum status findings_get(const struct findings *findings, const struct fuzz_signature *signature,
                         const char *name, struct finding_file *out,
                         struct reason *reason) MUST_USE;
/* The folder itself, for the other files of a campaign. */
const struct folder *findings_folder(const struct findings *findings);
/* Writes the path of "first.trial", "smallest.trial" or "count" of a signature, to be shown. Use
 * findings_get to read the file. */
void findings_path(const struct findings *findings, const struct fuzz_signature *signature,
                   const char *name, char *path, size_t path_bytes);

/* Closes without a checkpoint. NULL is fine. */
void findings_close(struct findings *findings);

/* Merges folders into a new one. Counts are added; a finding whose line is in several folders
 * counts once. Each signature keeps the first by origin, the smallest, and its FINDINGS_LINES_MOST
 * lowest lines in order. The result does not depend on the order of the folders, and that of all
 * shards is that of a single run, merged alone. `to` must not exist, or be empty; it appears whole
 * or not at all. Errors: as findings_look; STATUS_INPUT one folder named twice, `to` holds
 * something. */
enum status findings_merge(const char *const *folder, size_t count, const char *to,
                           struct reason *reason) MUST_USE;

#endif
