/* Sorting of 64-bit keys by some of their bits. */
#ifndef KEYS_H
#define KEYS_H

#include "ref/base/base.h"

/* Sorts by bits first_bit and above, ascending; keys that are equal there keep their order, so the
 * result is the same for any number of threads. *key (from room_make) may be replaced by another
 * array. Errors: STATUS_MEMORY; the keys are unchanged. */
enum status keys_sort(uint64_t **key, uint32_t count, uint32_t first_bit,
                      uint32_t threads) MUST_USE;

#endif
