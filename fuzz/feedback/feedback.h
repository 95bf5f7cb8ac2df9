/* Coverage feedback: counts how often a campaign reached each state, keeps the trials that reached
 * one first, and chooses which of them to mutate next, so that rare states are reached. A pure
 * function of the sequence of calls. */
#ifndef FUZZ_FEEDBACK_H
#define FUZZ_FEEDBACK_H

#include "fuzz/play/coverage.h"
#include "ref/base/rng.h"
#include "ref/files/folder.h"

/* Bytes of the trials that are kept, vertices, triangles and rays; one trial may take an eighth. */
#define FEEDBACK_BYTES ((size_t)64 << 20)

struct feedback;

/* What a trial changed. */
struct feedback_news {
    uint32_t bits; /* reached for the first time */
    bool kept;     /* the trial is now one of the corpus */
};

/* An empty one that keeps trials of at most that many bytes together. Errors: STATUS_MEMORY. */
enum status feedback_open(size_t bytes_most, struct feedback **out, struct reason *reason) MUST_USE;
void feedback_close(struct feedback *feedback); /* NULL is fine */

/* True if a trial with this coverage would be kept if it fits: it reached a bit that no kept one
 * has. */
bool feedback_wants(const struct feedback *feedback, const uint64_t coverage[COVERAGE_WORDS]);

/* Counts the bits that a trial reached and keeps a copy of it if feedback_wants; so there are at
 * most COVERAGE_BITS kept. A `trial` of NULL is only counted. Errors: STATUS_MEMORY; nothing is
 * changed then. */
enum status feedback_add(struct feedback *feedback, const struct fuzz_trial *trial,
                         const uint64_t coverage[COVERAGE_WORDS], struct feedback_news *news,
                         struct reason *reason) MUST_USE;

/* Chooses a kept trial at random: its weight is 1 over how many trials have reached its rarest bit,
 * and falls as it is chosen again (after Boehme, Pham, Roychoudhury, Coverage-based Greybox Fuzzing
 * as Markov Chain, CCS 2016: energy goes to what is rarely reached). NULL if there is none. Valid
 * until feedback_close. */
const struct fuzz_trial *feedback_choose(struct feedback *feedback, struct rng *rng);

size_t feedback_count(const struct feedback *feedback); /* of kept trials */

/* Writes every kept trial that this feedback has not written yet to HASH.trial of the folder (16
 * digits of fuzz_trial_hash): a finding file that expects nothing. Each appears whole or not at
 * all; an existing file is kept. Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status feedback_save(struct feedback *feedback, const struct folder *folder,
                          struct reason *reason) MUST_USE;

/* Trials of a folder. Zero is none. */
struct feedback_list {
    struct fuzz_trial *trial;
    size_t count, capacity;
    size_t left_out;    /* files that could not be read or were too many */
    struct reason said; /* on the first of them, "PATH:LINE: rule" */
};

/* Reads all ?*.trial of the folder in the order of their names, as many as fit into `bytes_most`;
 * other files are ignored. A file that is no trial is left out; see `said`. The files do not have
 * the coverage: the caller plays the trials again and adds them. Errors: STATUS_INPUT the folder
 * cannot be read; STATUS_MEMORY. */
enum status feedback_load(const struct folder *folder, size_t bytes_most, struct feedback_list *out,
                          struct reason *reason) MUST_USE;
void feedback_list_free(struct feedback_list *list);

#endif
