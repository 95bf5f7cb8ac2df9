/* Words and lines of a finding's text file, for its reader alone. */
#ifndef FUZZ_FINDING_FILE_SCAN_H
#define FUZZ_FINDING_FILE_SCAN_H

#include "ref/files/scan.h"

#define FINDING_WORD_MOST 192

/* Takes the next word of the line, which must be shorter than FINDING_WORD_MOST; `what` names it in
 * the reason. Errors: STATUS_INPUT. */
enum status finding_word(struct scan *scan, const char *what, char word[FINDING_WORD_MOST],
                         struct reason *reason) MUST_USE;

/* Takes the word `expected` and nothing else. Errors: STATUS_INPUT. */
enum status finding_keyword(struct scan *scan, const char *expected,
                            struct reason *reason) MUST_USE;

/* Takes a whole number, decimal digits alone, of at most `most`. Errors: STATUS_INPUT. */
enum status finding_whole(struct scan *scan, const char *what, uint64_t most, uint64_t *out,
                          struct reason *reason) MUST_USE;

/* Takes a float (ref/base/float_word.h), a finite one unless `any`. Errors: STATUS_INPUT. */
enum status finding_float(struct scan *scan, const char *what, bool any, float *out,
                          struct reason *reason) MUST_USE;

/* Takes the rest of the line as text, blanks around it left out: printable ASCII and tabs, shorter
 * than `size`. Errors: STATUS_INPUT. */
enum status finding_text(struct scan *scan, char *out, size_t size, struct reason *reason) MUST_USE;

/* Nothing may follow on this line; goes to the next. Errors: STATUS_INPUT. */
enum status finding_line_end(struct scan *scan, struct reason *reason) MUST_USE;

/* Skips blank lines and comments; then the cursor is at a word or at the end of the file. */
void finding_skip(struct scan *scan);

#endif
