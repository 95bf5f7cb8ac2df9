/* The text file of a finding or of a regression: one trial, and what is expected of it. Numbers are
 * hexadecimal floats with decimals beside them; read back to the bit. */
#ifndef FUZZ_FINDING_FILE_H
#define FUZZ_FINDING_FILE_H

#include "fuzz/signature.h"
#include "fuzz/trial.h"

struct finding_file {
    struct fuzz_trial trial;
    bool has_signature;              /* false: a trial that must be clean */
    struct fuzz_signature signature; /* what it shows */
    char versions[1024];             /* engines and drivers that it was seen with, a line each */
};

/* Writes `path` whole or not at all. Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status finding_file_write(const struct finding_file *file, const char *path,
                               struct reason *reason) MUST_USE;

/* Reads and checks (fuzz_trial_check). Errors: STATUS_INPUT "PATH:LINE: rule"; STATUS_LIMIT;
 * STATUS_MEMORY. */
enum status finding_file_read(const char *path, struct finding_file *out,
                              struct reason *reason) MUST_USE;

/* The same of bytes in memory, for fuzzing the reader and for pipes; `name` stands in messages. */
enum status finding_file_parse(const char *name, const char *bytes, size_t size,
                               struct finding_file *out, struct reason *reason) MUST_USE;

void finding_file_free(struct finding_file *file);

#endif
