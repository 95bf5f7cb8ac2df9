/* The worker processes of a campaign: each makes trials, plays them, explains its findings, and
 * reports. struct work_watch shows the parent what a worker did when it died. */
#ifndef FUZZ_WORKER_H
#define FUZZ_WORKER_H

#include "ref/outside/child.h"
#include "fuzz/findings/finding_file.h"
#include "fuzz/gen/gen.h"
#include "fuzz/play/player.h"
#include "fuzz/shrink/shrink.h"

#define WORK_MESSAGE_MOST (FINDING_FILE_MOST + ((size_t)16 << 20))
#define WORK_OPINION_MOST 400

/* Where trials come from. */
enum work_stream {
    WORK_CORPUS, /* index: in rules->corpus */
    WORK_KEPT,   /* in rules->kept: played for their coverage, without findings */
    WORK_GEN,    /* gen_trial */
    WORK_MUT,    /* gen_mutate of the order's base */
    WORK_GIVEN   /* the order's base itself */
};

/* Members that were drawn for the trials of an order (fuzz/feedback/pair_coverage.h); `on` if there
 * are any. */
struct work_draw {
    bool on;
    uint32_t contestant;
    const struct layout *layout; /* NULL: the contestant needs none */
    const struct builder *builder;
    const struct tri_store *store;
    const struct tri_test *tri;
    const struct box_test *box;
    uint32_t optimized; /* member of MEET_OPTIMIZE */
    bool moved;
    enum query query;
};

/* What is the same for all orders. Borrowed; a worker has its copy of it from the start. */
struct work_rules {
    struct fuzz_field field;
    uint64_t seed;
    struct gen_options gen;
    const struct builder *builder[16]; /* generated trials are built by these, in turn; */
    size_t builder_count;              /* 0: by whatever was generated */
    const struct fuzz_trial *corpus;
    size_t corpus_count;
    const struct fuzz_trial *kept; /* that reached rare states in earlier runs */
    size_t kept_count;
};

/* The member of MEET_OPTIMIZE that a trial has. */
static inline uint32_t work_optimized(const struct build_options *build)
{
    return build->passes == 0 ? 0 : build->rotates ? 2 : 1;
}

/* Makes trial `index` of a stream: a pure function of rules, stream, index and base (NULL where the
 * stream has none). Errors: STATUS_MEMORY; STATUS_LIMIT, see gen_trial. */
enum status work_trial_make(const struct work_rules *rules, enum work_stream stream, uint64_t index,
                            const struct fuzz_trial *base, struct fuzz_trial *out,
                            struct reason *reason) MUST_USE;

/* The contestant that a signature names, of a drawn field whatever the layout; field->count if none
 * is. */
size_t work_contestant(const struct fuzz_field *field, const struct fuzz_signature *signature);

/* One piece of work: trials first to first + count - 1 of a stream; or a finding to shrink. */
struct work_order {
    bool shrink;
    enum work_stream stream;
    uint64_t first;
    uint32_t count;        /* at most FUZZ_BATCH */
    uint32_t left_out;     /* contestants that do not play, 1u << contestant */
    struct work_draw draw; /* of a drawn field */
    bool unexplained;      /* findings are not explained */
    uint64_t asks, ns;     /* bounds of shrinking, as in struct shrink_options */
    uint32_t ms;           /* of a candidate that may hang or crash: struct shrink_apart */
    uint64_t memory;
    /* A finding file may follow (fuzz/campaign/worker_base.h): the base of stream or what is to
     * shrink. */
};

/* Makes trial i of an order, drawn members included. Errors: as work_trial_make. */
enum status work_trial_ordered(const struct work_rules *rules, const struct work_order *order,
                               uint32_t i, const struct fuzz_trial *base, struct fuzz_trial *out,
                               struct reason *reason) MUST_USE;

struct work_trial {
    uint64_t coverage[COVERAGE_WORDS];
    uint32_t count[VERDICT_COUNT];
    uint32_t wrong, judged, rays, triangles;
    uint32_t refusers;                                       /* contestants, 1u << contestant */
    uint32_t decliners, players, provers, refitted, rebuilt; /* likewise */
    struct {
        uint32_t hits, lost;
    } edges[FUZZ_CONTESTANTS_MOST][MATCH_EDGES];
    /* Members, to be counted. */
    const struct builder *builder;
    const struct tri_store *store;
    const struct tri_test *tri;
    const struct box_test *box;
    uint32_t optimized; /* member of MEET_OPTIMIZE */
};

struct work_finding {
    uint32_t trial; /* in the order, from 0 */
    struct fuzz_finding finding;
    char opinion[WORK_OPINION_MOST];
};

/* The result of an order. The first report has no order: it follows the opening of the engines, and
 * its text is their versions. */
struct work_report {
    enum status status; /* STATUS_OK, or nothing but time and reason is there */
    struct reason reason;
    struct fuzz_time time;
    uint64_t explain_ns, ns; /* in explaining or shrinking; in all */
    uint32_t trials, findings;
    uint64_t text_bytes;
    struct shrink_stats shrunk;
    /* Then work_trial trial[], work_finding finding[], and text. */
};

/* The parts of a received message; false if it is none. Pointers into it. */
struct work_parts {
    const struct work_report *report;
    const struct work_trial *trial;
    const struct work_finding *finding;
    const char *text; /* of a shrunk finding, with a 0 behind it; "" if there is none */
};
bool work_parts(const void *bytes, size_t size, struct work_parts *out);

enum work_phase {
    WORK_OPENING, /* engines */
    WORK_IDLE,
    WORK_MAKING,     /* trials */
    WORK_PLAYING,    /* mark.contestant: which engine runs */
    WORK_EXPLAINING, /* findings */
    WORK_SHRINKING
};

/* In shared memory. */
struct work_watch {
    struct fuzz_mark mark;
    _Atomic uint32_t phase; /* enum work_phase */
    _Atomic uint64_t beat;  /* counts up while there is progress */
};

/* A worker's start. */
struct work_start {
    const struct work_rules *rules;
    struct work_watch *watch; /* shared */
    bool versions;            /* report them */
};

/* Starts one. Its first message is a report without trials: engines are open, or why not. Errors:
 * as child_start. */
enum status worker_start(const struct work_start *start, struct child *out,
                         struct reason *reason) MUST_USE;

/* Sends an order; `base` may be NULL. False if the worker does not take it. */
bool worker_order(struct child *worker, const struct work_order *order,
                  const struct finding_file *base);

#endif
