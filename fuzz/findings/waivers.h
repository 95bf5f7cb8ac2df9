/* Waivers: failures that are known, each with a reason and a link, of the conformance suite and,
 * with dates, of campaigns (fuzz/findings/baseline.h). In the suite one that no longer excuses
 * anything is itself a failure, so that the list cannot grow old. */
#ifndef FUZZ_WAIVERS_H
#define FUZZ_WAIVERS_H

#include "ref/base/base.h"

struct waiver {
    char *pattern; /* shell wildcards, of the name of a trial or hard case */
    char *version; /* of an engine, as version_told() takes it: elsewhere it excuses nothing; or
                      NULL */
    char *until;   /* YYYY-MM-DD, the last day on which it excuses; NULL: it has none */
    char *reason;
    char *link;
    size_t line;
    size_t exist;  /* names of the whole suite that it matches, as far as waivers_count() did */
    size_t named;  /* names that it matches, played or not */
    size_t ran;    /* of them, those that were played */
    size_t failed; /* of them, those that failed */
};

/* Owns its arrays; zero is an empty list. */
struct waivers {
    struct waiver *waiver;
    size_t count, capacity;
    char *text; /* what the strings point into */
    char path[256];
};

/* Reads lines "PATTERN [@VERSION] REASON... LINK"; blank lines and lines that start with '#' are
 * comments. VERSION is what version_told() takes, '_' for a blank; LINK is the last word and has
 * "://" or ".md" in it. Control characters, a range that is none, and a second line of the same
 * pattern, version and date are refused. Errors: STATUS_INPUT "PATH:LINE: rule"; STATUS_MEMORY. */
enum status waivers_read(const char *path, struct waivers *out, struct reason *reason) MUST_USE;

/* The same of bytes in memory, which it takes over and frees; `name` stands in messages. With
 * `dated` each line says "until YYYY-MM-DD" or "until -" before the reason. */
enum status waivers_parse(const char *name, char *text, size_t size, bool dated,
                          struct waivers *out, struct reason *reason) MUST_USE;
/* Those that are part of the program, tests/waivers.txt. Errors: as waivers_read. */
enum status waivers_shipped_read(struct waivers *out, struct reason *reason) MUST_USE;
void waivers_free(struct waivers *waivers);

/* True if `versions`, the descriptions of engines (as `raydiff doctor` prints them), contain
 * `version`: a text such as "Mesa 22.3.6", or a range "NAME FIRST..LAST", such as "Embree
 * 3..4.3.3", in which a version of NAME lies. Both ends are included. Only as many numbers are
 * compared as LAST has: 4.3.3 is within "..4.3". */
bool version_told(const char *versions, const char *version);

/* True if it is about `name` (shell wildcards) and about one of these versions, or about none. */
bool waiver_is_about(const struct waiver *waiver, const char *name, const char *versions);

enum waiver_event { WAIVER_SKIPPED, WAIVER_PASSED, WAIVER_FAILED };

/* Counts a name of the whole suite, of which a pattern chose some, which are noted. It is matched
 * with those waivers alone of which the count may still change what waiver_judge() says of a suite
 * that is not complete. Returns true if there are such after that; with `name` NULL nothing is
 * counted. */
bool waivers_count(struct waivers *waivers, const char *name);

/* True if a waiver that matches `name` is about one version. */
bool waivers_name_version(const struct waivers *waivers, const char *name);

/* Records the result of `name`, and returns the first waiver that excuses its failure; NULL if it
 * did not fail or none does. All waivers that match count it. Its failure is counted only by those
 * that name no version, or one that `versions`, the descriptions of the engines, contain.
 * `versions` may be "" if waivers_name_version is false, or nothing failed. */
const struct waiver *waivers_note(struct waivers *waivers, const char *name,
                                  enum waiver_event event, const char *versions);

enum waiver_fault {
    WAIVER_FINE,
    WAIVER_UNUSED,  /* what it names was played and did not fail: remove it */
    WAIVER_NOTHING, /* it matches nothing: correct or remove it */
    WAIVER_GONE,    /* no fault: nothing failed, but in another version than it is about */
};

/* Judges a waiver at the end.
 *   complete   every name of the suite was noted, so that no match means that none exists; else a
 *              waiver whose `exist` is more than what was noted is fine
 *   versions   descriptions of the engines
 * A waiver whose names were all skipped, because an engine cannot run here, is fine. */
enum waiver_fault waiver_judge(const struct waiver *waiver, bool complete, const char *versions);

#endif
