/* The passes of the shrinker: each is a list of changes to try on the smallest trial so far. */
#ifndef FUZZ_SHRINK_INNER_H
#define FUZZ_SHRINK_INNER_H

#include "fuzz/shrink/shrink.h"

enum shrink_way {
    SHRINK_CHUNKS, /* all things, halves of them, quarters, ... single ones */
    SHRINK_ENDS, /* the same of the first and the last chunk alone: a binary search for a number */
    SHRINK_SINGLY,
};

struct shrink_pass {
    const char *name;
    enum shrink_way way;
    /* Of what the chunks consist; 0: nothing to do. */
    uint32_t (*things)(const struct fuzz_trial *trial);
    uint32_t variants; /* changes of each chunk */
    /* Changes things first .. first + count - 1 of a copy in place; false: there is nothing to
     * change. A result that is not smaller, or no valid trial, is not played. */
    bool (*change)(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant);
};

/* In the order of a round, NULL-terminated. */
extern const struct shrink_pass *const shrink_passes[];

/* 1: a pass over the trial as a whole. */
uint32_t shrink_one(const struct fuzz_trial *trial);

/* Number of instances. */
uint32_t shrink_instances_of(const struct fuzz_trial *trial);

/* Removes triangles [first, first + count), and vertices that no triangle has then. */
void shrink_cut_triangles(struct fuzz_trial *trial, uint32_t first, uint32_t count);

/* The geometries after triangles [first, first + count) went, or with `keep` after they alone
 * stayed. */
void shrink_cut_geometries(struct trial_world *world, uint32_t first, uint32_t count, bool keep);

/* Where an instance places a point, in float32. */
void shrink_place(const struct instance *one, const float p[3], float out[3]);

/* All numbers of a trial in one row: coordinates of vertices, then 8 of each ray in the order of
 * the file, then 12 of each instance's transform. */
uint32_t shrink_number_count(const struct fuzz_trial *trial);
/* The same of a small trial, else 0: trials of more vertices, rays or instances have too many to
 * try each. */
uint32_t shrink_few_numbers(const struct fuzz_trial *trial);
float *shrink_number(struct fuzz_trial *trial, uint32_t i);

enum shrink_role {
    SHRINK_VERTEX,
    SHRINK_ORG,
    SHRINK_DIR,
    SHRINK_TMIN,
    SHRINK_TMAX,
    SHRINK_TRANSFORM
};
/* What number i is, and on which axis (0 for tmin, tmax and transforms). */
enum shrink_role shrink_role(const struct fuzz_trial *trial, uint32_t i, uint32_t *axis);

/* 2^exponent is the largest power of two that is at most |x|; 0 if x is 0 or not finite. */
int shrink_exponent(float x);
/* x 2^by; may round or overflow. */
float shrink_scaled(float x, int by);

/* The user of shrink_ask_player. */
struct shrink_asking {
    struct fuzz_player *player; /* of one contestant, the signature's */
    const struct fuzz_signature *wanted;
    struct fuzz_finding finding; /* of the last trial that showed it */
};

/* Whether `who` is the contestant of the file's signature. Errors: STATUS_INPUT it is not, or there
 * is no signature. */
enum status shrink_check_who(const struct fuzz_contestant *who, const struct finding_file *file,
                             struct reason *reason) MUST_USE;

shrink_ask_fn shrink_ask_player;

#endif
