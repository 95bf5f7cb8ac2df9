/* How often the named engines, layouts, builders and tests answered. A run in which one of them
 * answered nothing has not tested it, whatever the others did. */
#ifndef TURNOUT_H
#define TURNOUT_H

#include "ref/match/match.h"

#define TURNOUT_MOST      256
#define TURNOUT_NAME_MOST 256

/* An engine that answers less than one in this many questions answered next to nothing. */
#define TURNOUT_ONE_IN 10

/* How one question ended. */
enum turnout_end {
    TURNOUT_ANSWERED,
    TURNOUT_REFUSED, /* it reports that it cannot hold the scene */
    TURNOUT_SKIPPED, /* it does not take part in this combination, or another member refused */
    TURNOUT_ABSENT,  /* the engine cannot run here at all */
    TURNOUT_FAILED,
    TURNOUT_ENDS
};

struct turnout_one {
    char kind[16]; /* "engine", "layout", ... */
    char name[TURNOUT_NAME_MOST];
    bool declines; /* an engine: it can refuse for itself */
    size_t end[TURNOUT_ENDS];
    struct reason reason; /* why it did not answer, the first time */
};

/* Zero is empty. */
struct turnout {
    struct turnout_one one[TURNOUT_MOST];
    size_t count;
};

/* Enters one that must answer something; one that is entered already stays. Names beyond
 * TURNOUT_MOST are left out. */
void turnout_name(struct turnout *turnout, const char *kind, const char *name);

/* Counts how `count` questions to one that was entered ended; of others nothing is counted. */
void turnout_add(struct turnout *turnout, const char *kind, const char *name, enum turnout_end end,
                 size_t count, const char *reason);

/* How a row ended for its engine; false: the engine did not run, since another member refused. */
bool turnout_of_engine(const struct row *row, enum turnout_end *end);
/* And for its layout, builder, storage or tests. */
enum turnout_end turnout_of_member(const struct row *row);

/* Counts a row for its engine and layout; and several. */
void turnout_row(struct turnout *turnout, const struct row *row);
void turnout_rows(struct turnout *turnout, const struct row *row, size_t count);

size_t turnout_asked(const struct turnout_one *one);

/* The exit code for one: EXIT_AGREE; EXIT_SKIPPED if it cannot run here; EXIT_MISMATCH if
 * it answered nothing, or an engine next to nothing (TURNOUT_ONE_IN). */
int turnout_code(const struct turnout_one *one);
/* The worst of all. */
int turnout_exit(const struct turnout *turnout);

/* "answered 0 of 116, refused 116: no thanks; vacuous: ...", in one line. */
void turnout_line(const struct turnout_one *one, char *text, size_t text_bytes);

/* True if it did not answer all questions. */
bool turnout_tells(const struct turnout_one *one);

#endif
