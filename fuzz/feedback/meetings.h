/* How many trials met each pair of members: two members of different factors (engine, layout,
 * builder, storage, triangle test, box test, optimization, motion) meet in a trial that both take
 * part in and that an engine has answered. And which members are to meet next: those of the rarest
 * pair, the others so that they meet whom they have met least. */
#ifndef FUZZ_MEETINGS_H
#define FUZZ_MEETINGS_H

#include "fuzz/play/trial.h"
#include "ref/engine.h"
#include "ref/files/folder.h"

enum meeting_factor {
    MEET_ENGINE,
    MEET_LAYOUT,
    MEET_BUILDER,
    MEET_STORE,
    MEET_TRI,
    MEET_BOX,
    MEET_OPTIMIZE, /* plain, reinsert */
    MEET_MOTION,   /* still, moved: refitted, not rebuilt */
    MEET_FACTORS
};

/* "engine", ... */
const char *meeting_factor_name(enum meeting_factor factor);

#define MEET_MOST 256u /* members of a factor */
#define MEET_NONE UINT16_MAX

/* Who takes part. Members are borrowed. An engine without a tree meets triangle tests only, one
 * with a test of its own neither triangle nor box tests. */
struct meeting_tables {
    const void *member[MEET_FACTORS][MEET_MOST]; /* of OPTIMIZE and MOTION not read */
    uint32_t count[MEET_FACTORS];                /* of those at most 2, the first plain or still */
};

/* A member of each factor. MEET_NONE where its engine does not meet that factor's; also where a
 * trial has a member that takes no part. */
struct meeting {
    uint16_t member[MEET_FACTORS];
};

struct meetings;

/* Finds out which pairs can meet: not what layouts and storages refuse of every scene, or engines
 * of every layout. *out is for meetings_close. Errors: STATUS_INPUT an engine, layout or other
 * factor has no member; STATUS_MEMORY. */
enum status meetings_open(const struct meeting_tables *tables, struct meetings **out,
                          struct reason *reason) MUST_USE;
void meetings_close(struct meetings *meetings); /* NULL is fine */

const struct meeting_tables *meetings_tables(const struct meetings *meetings);
/* Name of a member. */
const char *meetings_name(const struct meetings *meetings, enum meeting_factor factor, uint32_t i);
/* True if the two members can meet; the factors differ. */
bool meetings_possible(const struct meetings *meetings, enum meeting_factor a, uint32_t i,
                       enum meeting_factor b, uint32_t j);

/* The next members to meet, in so many trials: a function of seed, `turn`, tables, and of all that
 * was drawn, met and missed before. Members that the engine does not meet are set, too, to what can
 * be traced with the others. */
void meetings_draw(struct meetings *meetings, uint64_t seed, uint64_t turn, uint32_t trials,
                   struct meeting *out);
/* Of the trials of what was drawn so many were refused, and others rebuilt in place of refitted:
 * then pairs of them all, and those of motion, are due again, unless that happens always. */
void meetings_missed(struct meetings *meetings, const struct meeting *drawn, uint32_t refused,
                     uint32_t rebuilt);

/* The places of these members; MEET_NONE for those that take no part. */
struct meeting meetings_of(const struct meetings *meetings, const struct engine *engine,
                           const struct layout *layout, const struct builder *builder,
                           const struct tri_store *store, const struct tri_test *tri,
                           const struct box_test *box, bool optimized, bool moved);

/* One more trial that was answered. */
void meetings_add(struct meetings *meetings, const struct meeting *met);

struct meetings_summary {
    uint32_t possible, met; /* pairs; those that met at least once */
    uint64_t least, median; /* trials of a possible pair */
    uint32_t below;         /* pairs that met in fewer trials than asked for */
    uint32_t impossible;
};
struct meetings_summary meetings_summarize(const struct meetings *meetings, uint64_t wanted);

#define MEETING_NAME_MOST 120
/* The pair of place `at`, from 0, in the order of how rarely they met, "builder.sbvh
 * layout.bvh8_u8_node", and how often. False: there are fewer. */
bool meetings_rarest(const struct meetings *meetings, uint32_t at, char name[MEETING_NAME_MOST],
                     uint64_t *count);

/* Writes the tally as lines "FACTOR.MEMBER FACTOR.MEMBER COUNT" to the file, whole or not at all.
 * Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status meetings_write(const struct meetings *meetings, const struct folder *folder,
                           const char *name, struct reason *reason) MUST_USE;
/* Takes over what meetings_write wrote, of pairs that are possible here; a file that is not there
 * holds nothing. Errors: STATUS_INPUT "PATH:LINE: rule"; STATUS_MEMORY. */
enum status meetings_read(struct meetings *meetings, const struct folder *folder, const char *name,
                          struct reason *reason) MUST_USE;

#endif
