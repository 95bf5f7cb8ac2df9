/* A cursor over the text of a mesh file, which counts lines. For all text formats. */
#ifndef SCAN_H
#define SCAN_H

#include "ref/base/base.h"

/* Lines end in "\n", "\r\n" or "\r". */
struct scan {
    const char *name; /* of the file, for reasons */
    const char *start, *at;
    const char *end; /* *end is 0, so that no number is read beyond it */
    uint64_t line;   /* line number of `at`, from 1 */
    bool binary;     /* reasons print the byte instead of the line */
    bool joins;      /* a backslash before a line end joins two lines */
    char comment;    /* starts a comment at the beginning of a word; 0: none */
};

/* Returns a cursor at the start of `bytes`, which is borrowed; bytes[size] must be 0. */
struct scan scan_make(const char *name, const char *bytes, size_t size);

/* Writes "NAME:LINE: " or "NAME: byte N: " and the formatted rule; returns STATUS_INPUT. */
enum status scan_fail(const struct scan *scan, struct reason *reason, const char *format, ...)
    PRINTF_LIKE(3, 4);

/* Skips spaces and tabs, and joined line ends. */
void scan_blanks(struct scan *scan);

/* Returns true at a line end, a comment or the end of the file. Call after scan_blanks. */
bool scan_line_done(const struct scan *scan);

/* Moves to the start of the next line. A comment is never joined with the line after it. */
void scan_next_line(struct scan *scan);

/* Returns true at a blank, a line end or the end of the file. */
bool scan_word_done(const struct scan *scan);

/* Skips blanks and one word. Sets *word to it and returns its length, 0 at the end of the line. */
size_t scan_word(struct scan *scan, const char **word);

#define SCAN_SHOWN 32

/* Returns the word at the cursor, or "end of line" or "end of file", for reasons. Long words are
 * cut, and unprintable bytes are '?'. */
const char *scan_show(const struct scan *scan, char shown[SCAN_SHOWN]);

/* Skips blanks and reads a word that is a decimal within the range of a float. `what` is printed in
 * the reason. Errors: STATUS_INPUT. */
enum status scan_float(struct scan *scan, const char *what, float *out,
                       struct reason *reason) MUST_USE;

/* Skips blanks and reads a word that is a whole number of up to 18 digits. Errors: STATUS_INPUT. */
enum status scan_whole(struct scan *scan, const char *what, int64_t *out,
                       struct reason *reason) MUST_USE;

/* Skips blanks and reads a word of digits alone, up to 2^64 - 1. Returns false and sets *out to 0
 * for any other word. */
bool scan_u64(struct scan *scan, uint64_t *out);

/* Reads [+-]digits at the cursor, without skipping blanks or checking what follows. Returns false
 * and does not move if there are no digits or more than 18. */
bool scan_digits(struct scan *scan, int64_t *out);

#endif
