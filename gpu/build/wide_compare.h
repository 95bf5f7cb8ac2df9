/* Wide trees and their words as a device makes them, beside C's. */
#ifndef WIDE_COMPARE_H
#define WIDE_COMPARE_H

#include "gpu/build/device_wide.h"

/* What is timed on both sides. */
enum wide_part {
    WIDE_COLLAPSE, /* ref/staged/staged_wide.h */
    WIDE_WORDS,    /* the layout's records */
    WIDE_PARTS
};

extern const char *const wide_part_names[WIDE_PARTS];

struct wide_result {
    struct staged_difference differs; /* "nodes", "children", "items" or "words", whose element is a
                                         record; stage NULL: none */
    struct reason refused;            /* by both, or "" */
    uint32_t nodes;                   /* of the wide tree in C */
    uint64_t device_ns[WIDE_PARTS], c_ns[WIDE_PARTS];
    uint64_t device_bytes;
};

/* Makes the wide tree and the words of the tree that device_tree_build made last, on the device and
 * in C from `mine`, which is the same binary tree. The depth of the tree does not matter: nothing
 * is traced. Errors: as device_wide_make and the layout's pack_tree, but that a STATUS_LIMIT of
 * both sides is out->refused, and one of C alone STATUS_DEVICE. */
enum status wide_compare(struct device_tree *tree, const struct layout *layout,
                         const struct staged *mine, const struct scene *scene,
                         struct wide_result *out, struct reason *reason) MUST_USE;

/* The first record of a packed tree, and how many words, in which `word` differs. */
struct staged_difference wide_words_compare(const uint32_t *word, uint32_t word_count,
                                            const struct packed *packed);

#endif
