/* A finding file as bytes for a process that was forked from this one: both know the same tables,
 * so that pointers into them mean the same. Text would be some hundred times slower, and a campaign
 * sends one with every block of mutants. */
#ifndef FUZZ_WORKER_BASE_H
#define FUZZ_WORKER_BASE_H

#include "fuzz/findings/finding_file.h"

/* Bytes that worker_base_put writes. */
size_t worker_base_bytes(const struct finding_file *file);
void worker_base_put(const struct finding_file *file, void *bytes);

/* The inverse; the caller frees *out (finding_file_free), which is zero on error. Errors:
 * STATUS_INPUT another number of bytes than it should be; STATUS_LIMIT; STATUS_MEMORY. */
enum status worker_base_get(const void *bytes, size_t size, struct finding_file *out,
                            struct reason *reason) MUST_USE;

#endif
