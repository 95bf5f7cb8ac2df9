/* What changed between two SPIR-V modules, instruction by instruction, and modules between them. */
#ifndef SPIRV_DIFF_H
#define SPIRV_DIFF_H

#include "ref/base/base.h"

/* A module by its instructions: number i begins at word[at[i]]; at[count] is the end. The words are
 * borrowed. */
struct spirv_code {
    const uint32_t *word;
    size_t *at;
    size_t count;
};

/* Errors: STATUS_INPUT no module; STATUS_MEMORY. *out is zero on error. */
enum status spirv_code_make(const uint32_t *word, size_t words, struct spirv_code *out,
                            struct reason *reason) MUST_USE;
void spirv_code_free(struct spirv_code *code);

static inline const uint32_t *spirv_words(const struct spirv_code *code, size_t i)
{
    return code->word + code->at[i];
}
static inline uint32_t spirv_op(const struct spirv_code *code, size_t i)
{
    return spirv_words(code, i)[0] & 0xFFFFu;
}
static inline size_t spirv_length(const struct spirv_code *code, size_t i)
{
    return code->at[i + 1] - code->at[i];
}

/* An edit: instruction `at` of the module before is removed, or of that after is added. Edits
 * without a common instruction between them are a hunk. */
struct spirv_edit {
    bool added;
    size_t at;
    size_t common; /* common instructions in front of it */
    size_t hunk;
};

/* Both modules are borrowed. */
struct spirv_diff {
    const struct spirv_code *before, *after;
    struct spirv_edit *edit;
    size_t count, hunks;
    size_t *common; /* of the module before, in order */
    size_t common_count;
};

/* Compares by a longest common subsequence; of modules too large for that (over 2^27 pairs between
 * the first and the last difference) all between is one hunk. Errors: STATUS_MEMORY. */
enum status spirv_diff_make(const struct spirv_code *before, const struct spirv_code *after,
                            struct spirv_diff *out, struct reason *reason) MUST_USE;
void spirv_diff_free(struct spirv_diff *diff);

/* Makes the module with the edits that have done[i]: none give the words of the module before, all
 * those of that after, but for the header, which is the former's with the larger bound of ids. The
 * caller frees *out. Errors: STATUS_MEMORY. */
enum status spirv_diff_apply(const struct spirv_diff *diff, const bool *done, uint32_t **out,
                             size_t *out_count, struct reason *reason) MUST_USE;

#endif
