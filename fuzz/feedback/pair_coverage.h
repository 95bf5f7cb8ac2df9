/* How many trials met each pair of members: two members of different factors (engine, layout,
 * builder, storage, triangle test, box test, optimization, motion) meet in a trial that both take
 * part in and that an engine has answered. Draws the members that meet next: those of the rarest
 * pair, and others that they have met least. */
#ifndef FEEDBACK_PAIR_COVERAGE_H
#define FEEDBACK_PAIR_COVERAGE_H

#include "fuzz/play/trial.h"
#include "ref/engine.h"
#include "ref/files/folder.h"

enum pair_factor {
    MEET_ENGINE,
    MEET_LAYOUT,
    MEET_BUILDER,
    MEET_STORE,
    MEET_TRI,
    MEET_BOX,
    MEET_OPTIMIZE, /* plain, reinsert, rotate */
    MEET_MOTION,   /* still, moved: refitted, not rebuilt */
    MEET_FACTORS
};

/* "engine", ... */
const char *pair_factor_name(enum pair_factor factor);

#define MEET_MOST          256u /* members of a factor */
#define MEET_OPTIMIZATIONS 3u   /* of MEET_OPTIMIZE */
#define MEET_NONE          UINT16_MAX

/* The members that take part; borrowed. An engine without a tree meets triangle tests only, one
 * with a test of its own neither triangle nor box tests, one with neither only vertices that are
 * still: so that it is drawn, too. */
struct pair_tables {
    const void *member[MEET_FACTORS][MEET_MOST]; /* of OPTIMIZE and MOTION not read */
    uint32_t count[MEET_FACTORS];                /* of those at most MEET_OPTIMIZATIONS and 2, the
                                                    first plain or still */
};

/* A member of each factor. MEET_NONE where its engine does not meet that factor's; also where a
 * trial has a member that takes no part. */
struct combination {
    uint16_t member[MEET_FACTORS];
};

struct pair_coverage;

/* Finds the pairs that can meet: not those that layouts and storages refuse in every scene, or
 * engines in every layout. *out is for pair_coverage_close. Errors: STATUS_INPUT an engine, layout
 * or other factor has no member; STATUS_MEMORY. */
enum status pair_coverage_open(const struct pair_tables *tables, struct pair_coverage **out,
                               struct reason *reason) MUST_USE;
void pair_coverage_close(struct pair_coverage *pair_coverage); /* NULL is fine */

const struct pair_tables *pair_coverage_tables(const struct pair_coverage *pair_coverage);
/* Name of a member. */
const char *pair_coverage_name(const struct pair_coverage *pair_coverage, enum pair_factor factor,
                               uint32_t i);
/* Draws the members that meet in the next `trials` trials: a function of seed, `turn`, tables, and
 * of all that was drawn, met and missed before. Members that the engine does not meet are set to
 * some that can be traced with the others. */
void pair_coverage_draw(struct pair_coverage *pair_coverage, uint64_t seed, uint64_t turn,
                        uint32_t trials, struct combination *out);
/* Records that of the trials drawn so many were refused, and others rebuilt in place of refitted.
 * Then all their pairs, or those of motion, are due again, unless that always happens. */
void pair_coverage_missed(struct pair_coverage *pair_coverage, const struct combination *drawn,
                          uint32_t refused, uint32_t rebuilt);

/* The places of these members; MEET_NONE for those that take no part. */
struct combination pair_coverage_of(const struct pair_coverage *pair_coverage,
                                    const struct engine *engine, const struct layout *layout,
                                    const struct builder *builder, const struct tri_store *store,
                                    const struct tri_test *tri, const struct box_test *box,
                                    uint32_t optimized, bool moved);

/* One more trial that was answered. */
void pair_coverage_add(struct pair_coverage *pair_coverage, const struct combination *met);

struct pair_coverage_summary {
    uint32_t possible, met; /* pairs; those that met at least once */
    uint64_t least, median; /* trials of a possible pair */
    uint32_t below;         /* pairs that met in fewer trials than `wanted` */
    uint32_t impossible;
};
struct pair_coverage_summary pair_coverage_summarize(const struct pair_coverage *pair_coverage,
                                                     uint64_t wanted);

#define PAIR_NAME_MOST 120
/* The pair of place `at`, from 0, in the order of how rarely they met, "builder.sbvh
 * layout.bvh8_u8_node", and how often. False: there are fewer. */
bool pair_coverage_rarest(const struct pair_coverage *pair_coverage, uint32_t at,
                          char name[PAIR_NAME_MOST], uint64_t *count);

/* Writes the tally as lines "FACTOR.MEMBER FACTOR.MEMBER COUNT" to the file, whole or not at all.
 * Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status pair_coverage_write(const struct pair_coverage *pair_coverage,
                                const struct folder *folder, const char *name,
                                struct reason *reason) MUST_USE;
/* Takes over what pair_coverage_write wrote, of pairs that are possible here; a file that is not
 * there holds nothing. Errors: STATUS_INPUT "PATH:LINE: rule"; STATUS_MEMORY. */
enum status pair_coverage_read(struct pair_coverage *pair_coverage, const struct folder *folder,
                               const char *name, struct reason *reason) MUST_USE;

#endif
