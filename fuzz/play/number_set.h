/* A set of 64-bit numbers. */
#ifndef NUMBER_SET_H
#define NUMBER_SET_H

#include "ref/base/base.h"

/* Zero-initialize; the owner frees `slot`. */
struct number_set {
    uint64_t *slot;         /* open addressing; 0 is a free slot */
    size_t capacity, count; /* capacity is a power of two */
};

/* `number` is not 0, in both functions. */
bool number_set_has(const struct number_set *set, uint64_t number);

/* Adds a number, if it is new. Returns false without memory. */
bool number_set_add(struct number_set *set, uint64_t number) MUST_USE;

#endif
