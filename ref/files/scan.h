/* A cursor over the text of a mesh file that counts lines, for the text formats. */
#ifndef SCAN_H
#define SCAN_H

#include "ref/base/base.h"

/* Lines end in "\n", "\r\n" or "\r". */
struct scan {
    const char *name; /* of the file, for reasons */
    const char *start, *at;
    const char *end; /* *end is 0, so that no number runs past it */
    uint64_t line;   /* of `at`, from 1 */
    bool binary;     /* reasons name the byte, not the line */
    bool joins;      /* a backslash right before the end of a line joins it with the next */
    char comment;    /* starts a comment where a word could begin; 0: none */
};

/* A cursor at the start of `bytes`, where bytes[size] is 0; borrowed. */
struct scan scan_make(const char *name, const char *bytes, size_t size);

/* Writes "NAME:LINE: " or "NAME: byte N: " and the formatted rule; returns STATUS_INPUT. */
enum status scan_fail(const struct scan *scan, struct reason *reason, const char *format, ...)
    PRINTF_LIKE(3, 4);

/* Skips spaces and tabs, and joined line ends. */
void scan_blanks(struct scan *scan);

/* True at the end of the line's words: line end, comment or end of file. After scan_blanks. */
bool scan_line_done(const struct scan *scan);

/* Goes to the start of the next line. A comment is never joined with the line after it. */
void scan_next_line(struct scan *scan);

/* True at a byte that ends a word: blank, line end, end of file. */
bool scan_word_done(const struct scan *scan);

/* Skips blanks and then one word, which is *word with the length returned; 0 at the line's end. */
size_t scan_word(struct scan *scan, const char **word);

#define SCAN_SHOWN 32

/* The word at the cursor (or "end of line"), cut and with unprintable bytes as '?', for reasons. */
const char *scan_show(const struct scan *scan, char shown[SCAN_SHOWN]);

/* Skips blanks and reads a word that is a decimal within the range of a float; `what` names it in
 * the reason. Errors: STATUS_INPUT. */
enum status scan_float(struct scan *scan, const char *what, float *out,
                       struct reason *reason) MUST_USE;

/* Skips blanks and reads a word that is a whole number of up to 18 digits. Errors: STATUS_INPUT. */
enum status scan_whole(struct scan *scan, const char *what, int64_t *out,
                       struct reason *reason) MUST_USE;

/* Reads [+-]digits at the cursor, without blanks and without looking at what follows.
 * False, the cursor unmoved, if there are none or more than 18. */
bool scan_digits(struct scan *scan, int64_t *out);

#endif
