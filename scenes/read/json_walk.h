/* A cursor over JSON text that parses one value at a time, so that a list of a million elements
 * never stands in memory as a tree. jansson parses the values; the brackets around them are read
 * here. */
#ifndef JSON_WALK_H
#define JSON_WALK_H

#include "ref/base/base.h"

#include <jansson.h>

struct json_walk {
    const char *name; /* of the file, for reasons */
    const char *start, *at, *end;
    bool first; /* no member or element of the innermost bracket has been read */
    struct reason *reason;
};

/* Every function skips the white space before what it reads.
 * Errors of all: STATUS_INPUT "NAME:LINE:COLUMN: rule"; STATUS_MEMORY. */

/* Steps into an object or array: `bracket` is '{' or '['. */
enum status json_walk_open(struct json_walk *walk, char bracket) MUST_USE;

/* Called before every member or element. At the end *more is false and the cursor is behind
 * `bracket`, '}' or ']'. Leaving an inner bracket makes the outer one's next member not its
 * first. */
enum status json_walk_more(struct json_walk *walk, char bracket, bool *more) MUST_USE;

/* Parses a value of any kind; no object in it has a key twice. The caller owns *out. */
enum status json_walk_value(struct json_walk *walk, json_t **out) MUST_USE;

/* Reads a member's key and colon; *out is a string the caller owns. */
enum status json_walk_key(struct json_walk *walk, json_t **out) MUST_USE;

/* The next byte that is no white space, which stays; 0 at the end of the text. */
char json_walk_peek(struct json_walk *walk);

/* Reads a number as JSON writes them and leaves the cursor behind it; *out is its first byte. The
 * text goes on behind it, so that what reads a decimal there stops. */
enum status json_walk_number(struct json_walk *walk, const char **out) MUST_USE;

/* Reads a value of any kind and forgets it: in memory is one text or number of it at a time. At
 * most JSON_WALK_DEEP arrays and objects may be inside each other. Keys may come twice. */
#define JSON_WALK_DEEP 512
enum status json_walk_skip(struct json_walk *walk) MUST_USE;

/* Nothing but white space may be left. */
enum status json_walk_end(struct json_walk *walk) MUST_USE;

#endif
