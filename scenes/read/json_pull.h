/* Reads JSON by what is expected of it: a table of members for each object, a function for each
 * element of an array. The file never stands in memory as a tree. Numbers are read as decimals, so
 * that a float is the one nearest to what is written. */
#ifndef JSON_PULL_H
#define JSON_PULL_H

#include "scenes/read/json_walk.h"

#define JSON_PULL_DEEP 16 /* objects and arrays around a value that is read, not skipped */

struct json_pull {
    struct json_walk walk;
    bool closed; /* a member that is in no table is refused; else it is skipped */
    struct {
        const char *key; /* of an object, or NULL: of an array */
        size_t index;
    } step[JSON_PULL_DEEP]; /* where the value is */
    size_t depth;
};

/* Reads one value, of the member or element that the cursor is at, into *self. */
typedef enum status json_take_fn(struct json_pull *pull, void *self);

struct json_member {
    const char *key;
    json_take_fn *take;
    bool needed;
};

/* Errors of all functions: STATUS_INPUT "NAME: nodes[3].children[0]: rule", or
 * "NAME:LINE:COLUMN: rule" where the text is no JSON; STATUS_MEMORY. */

struct json_pull json_pull_make(const char *name, const char *bytes, size_t size,
                                struct reason *reason);

/* "NAME: PLACE: " and the formatted rule; returns STATUS_INPUT. */
enum status json_pull_fail(const struct json_pull *pull, const char *format, ...) PRINTF_LIKE(2, 3);

/* The rule at a place further inside: `key` and, unless it is JSON_PULL_NONE, its element. */
#define JSON_PULL_NONE SIZE_MAX
enum status json_pull_fail_at(struct json_pull *pull, const char *key, size_t element,
                              const char *rule);

/* Reads an object. `member` ends at the first entry without a key, and has at most 32. A member
 * that comes twice is refused, and so is an object without one that is needed. */
enum status json_pull_object(struct json_pull *pull, const struct json_member *member,
                             void *self) MUST_USE;

/* Reads an array. `take` finds the place of its element by json_pull_index. */
enum status json_pull_array(struct json_pull *pull, json_take_fn *take, void *self) MUST_USE;

/* Of the innermost array: the place of the element that is read. */
size_t json_pull_index(const struct json_pull *pull);

/* Reads the whole file: an object, and nothing behind it. */
enum status json_pull_file(struct json_pull *pull, const struct json_member *member,
                           void *self) MUST_USE;

/* The float, or double, nearest to the decimal. It is finite. */
enum status json_pull_float(struct json_pull *pull, float *out) MUST_USE;
enum status json_pull_double(struct json_pull *pull, double *out) MUST_USE;

/* A whole number in 0 .. most; most is at most 2^53. "3.0" is one as well. */
enum status json_pull_whole(struct json_pull *pull, uint64_t most, uint64_t *out) MUST_USE;

enum status json_pull_bool(struct json_pull *pull, bool *out) MUST_USE;

/* A text; the caller owns *out, and json_string_value gives it. */
enum status json_pull_text(struct json_pull *pull, json_t **out) MUST_USE;

/* One of the words of a table, which ends with NULL: its number. */
enum status json_pull_word(struct json_pull *pull, const char *const *word, unsigned *out) MUST_USE;

/* True, and the value is read, if it is null. */
enum status json_pull_null(struct json_pull *pull, bool *out) MUST_USE;

#endif
