/* A folder of findings:
 *
 *   findings.jsonl                  append-only, a line per finding and per checkpoint
 *   SIGNATURE/first.trial           the finding of the lowest origin (findings_order)
 *   SIGNATURE/smallest.trial        the smallest trial that shows it (fuzz_trial_size)
 *   SIGNATURE/count                 how many there were; for people, made from the log
 *
 * Files appear by renames, whole or not at all; a line is one write. So a process that is killed at
 * any moment leaves a folder that can be opened again: at worst the last line is torn, and is cut
 * off. What no kill can leave, such as a finding of the log without its files, is refused. Only one
 * process at a time writes to a folder (a lock on the log, which ends with it). */
#ifndef FUZZ_FINDINGS_H
#define FUZZ_FINDINGS_H

#include "fuzz/findings/finding_file.h"
#include "ref/files/folder.h"

/* Lines of one signature; of further findings only the number is kept, in checkpoints. */
#define FINDINGS_LINES_MOST 1000u
#define FINDINGS_NO_RAY     UINT32_MAX
#define FINDINGS_STATE_MOST 8192

struct findings;

/* Where a finding stands among all: stream gen before mut, then by seed, index, version, trial. */
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
    bool repeated; /* it was known: the same trial, signature and ray. Nothing changed */
    bool signature, first, smallest; /* new ones */
};

/* Opens a folder for writing, made if it is not there (its parent must be). Reads what is there and
 * removes what a killed writer left half-done.
 * Errors: STATUS_INPUT it cannot be written, is being written by another process, or "PATH: rule"
 * of what in it is no such folder's; STATUS_MEMORY. */
enum status findings_open(const char *folder, struct findings **out,
                          struct reason *reason) MUST_USE;

/* The same for reading: changes nothing; no process may be writing to it. */
enum status findings_look(const char *folder, struct findings **out,
                          struct reason *reason) MUST_USE;

/* One line on what was cut off when it was opened, or "". */
const char *findings_said(const struct findings *findings);

/* Adds a finding: file->signature, seen on ray `ray` of file->trial (FINDINGS_NO_RAY: on none, as a
 * crash), with one line of `opinion`. The files are written first, then the line, so that nothing
 * that was counted can be lost; beyond FINDINGS_LINES_MOST the counting waits for
 * findings_checkpoint. Errors: STATUS_INPUT no signature, no such ray, cannot write; STATUS_MEMORY.
 */
enum status findings_add(struct findings *findings, const struct finding_file *file, uint32_t ray,
                         const char *opinion, struct findings_news *news,
                         struct reason *reason) MUST_USE;

/* Offers a shrunk trial of a known signature: only `smallest` can be news, nothing is counted.
 * Errors: STATUS_INPUT the signature is not known, cannot write; STATUS_MEMORY. */
enum status findings_offer(struct findings *findings, const struct finding_file *file,
                           struct findings_news *news, struct reason *reason) MUST_USE;

/* Says in the log that all that was added so far belongs to `state`, the caller's own text (shorter
 * than FINDINGS_STATE_MOST), from which it will go on after a kill; what it then adds again is
 * known to be repeated. Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status findings_checkpoint(struct findings *findings, const char *state,
                                struct reason *reason) MUST_USE;

/* The last checkpoint's state, "" if there is none. */
const char *findings_state(const struct findings *findings);

size_t findings_count(const struct findings *findings);
/* In the order in which they were first seen. Valid until the next call that changes something. */
const struct findings_entry *findings_entry(const struct findings *findings, size_t i);
/* NULL: there is none. */
const struct findings_entry *findings_find(const struct findings *findings,
                                           const struct fuzz_signature *signature);
/* Reads "first.trial" or "smallest.trial" of a signature. Errors: as finding_file_read. */
enum status findings_get(const struct findings *findings, const struct fuzz_signature *signature,
                         const char *name, struct finding_file *out,
                         struct reason *reason) MUST_USE;
/* The folder itself, for what else a campaign keeps in it. */
const struct folder *findings_folder(const struct findings *findings);
/* Path of "first.trial", "smallest.trial" or "count" of a signature, for people: what lies there is
 * read by findings_get. */
void findings_path(const struct findings *findings, const struct fuzz_signature *signature,
                   const char *name, char *path, size_t path_bytes);

/* Closes; what findings_checkpoint was not called for is not counted. NULL is fine. */
void findings_close(struct findings *findings);

/* Joins folders into a new one: counts are added, but a finding whose line is in several is one,
 * the lowest origin is the first, the smallest the smallest, of each signature the
 * FINDINGS_LINES_MOST lowest lines are kept, in order. The result is the same in whatever order the
 * folders are named, and of shards the same as of one run whose folder was merged alone. `to` must
 * not exist or be empty; it appears whole or not at all. Errors: as findings_look; STATUS_INPUT one
 * folder named twice, `to` holds something. */
enum status findings_merge(const char *const *folder, size_t count, const char *to,
                           struct reason *reason) MUST_USE;

#endif
