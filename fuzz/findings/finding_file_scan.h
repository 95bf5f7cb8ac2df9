/* Words and lines of a finding's text file, for its reader alone. */
#ifndef FUZZ_FINDING_FILE_SCAN_H
#define FUZZ_FINDING_FILE_SCAN_H

#include "ref/files/scan.h"

#define FINDING_WORD_MOST 192

/* A text being read. After the first error the functions below read nothing and return 0 or "", so
 * that a reader tests `status` only where it depends on what was read. */
struct finding_scan {
    struct scan scan;
    struct reason *reason;
    enum status status; /* of the first error: STATUS_INPUT "NAME:LINE: rule" */
};

/* Reads the next word of the line, which must be shorter than FINDING_WORD_MOST; `what` names it in
 * the reason. */
void finding_word(struct finding_scan *in, const char *what, char word[FINDING_WORD_MOST]);

/* Reads the word `expected`; any other is an error. */
void finding_keyword(struct finding_scan *in, const char *expected);

/* Reads a whole number, decimal digits only, of at most `most`. */
uint64_t finding_whole(struct finding_scan *in, const char *what, uint64_t most);

/* Reads a float (ref/base/float_word.h), a finite one unless `any`. */
float finding_float(struct finding_scan *in, const char *what, bool any);

/* Reads the rest of the line, without blanks at its ends: printable ASCII and tabs, shorter than
 * `size`. */
void finding_text(struct finding_scan *in, char *out, size_t size);

/* Reads "KEYWORD COUNT" and allocates COUNT elements of `size` bytes, each of which is a line of
 * that many numbers; the caller frees them. More than the rest of the file can hold is rejected
 * before it is allocated. NULL after an error: also STATUS_LIMIT over `most`, STATUS_MEMORY. */
void *finding_count(struct finding_scan *in, const char *keyword, uint32_t most, int numbers,
                    size_t size, uint32_t *count);

/* Goes to the next line; a further word on this one is an error. */
void finding_line_end(struct finding_scan *in);

/* Skips blank lines and comments; then the cursor is at a word or at the end of the file. */
void finding_skip(struct finding_scan *in);

#endif
