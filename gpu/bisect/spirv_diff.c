#include "gpu/bisect/spirv_diff.h"

#include "gpu/shaders/spirv_words.h"

#include <stdlib.h>
#include <string.h>

#define BOUND      3u /* word of the header */
#define PAIRS_MOST ((size_t)1 << 27)

enum status spirv_code_make(const uint32_t *word, size_t words, struct spirv_code *out,
                            struct reason *reason)
{
    *out = (struct spirv_code){0};
    if (words < SPIRV_HEADER_WORDS || word[0] != SPIRV_MAGIC)
        return fail(reason, STATUS_INPUT, "no SPIR-V module");
    size_t *at = alloc_zeroed(words, sizeof *at);
    if (!at)
        return fail(reason, STATUS_MEMORY, "no memory for a shader");
    size_t count = 0, here = SPIRV_HEADER_WORDS;
    while (here < words && word[here] >> 16 > 0 && word[here] >> 16 <= words - here) {
        at[count++] = here;
        here += word[here] >> 16;
    }
    at[count] = here;
    *out = (struct spirv_code){word, at, count};
    if (here == words)
        return STATUS_OK;
    spirv_code_free(out);
    return fail(reason, STATUS_INPUT, "word %zu: no SPIR-V instruction", here);
}

void spirv_code_free(struct spirv_code *code)
{
    free(code->at);
    *code = (struct spirv_code){0};
}

/* --- the longest common subsequence ----------------------------------------------------------- */

static bool same(const struct spirv_code *a, size_t i, const struct spirv_code *b, size_t j)
{
    const uint32_t *left = spirv_words(a, i), *right = spirv_words(b, j);
    return left[0] == right[0] && memcmp(left, right, spirv_length(a, i) * sizeof *left) == 0;
}

/* The part of two modules between their common beginning and end, and the way through it. */
struct middle {
    const struct spirv_code *a, *b;
    size_t from, a_count, b_count;
    uint8_t *way; /* of a_count * b_count; NULL: all differs */
};

enum { WAY_BOTH, WAY_REMOVE, WAY_ADD };

/* Fills in the way from each pair to the end; `longest` has room for two rows. */
static void find_ways(struct middle *m, uint32_t *longest)
{
    const size_t width = m->b_count + 1;
    uint32_t *below = longest, *row = longest + width;
    for (size_t i = m->a_count; i-- > 0;) {
        row[m->b_count] = 0;
        for (size_t j = m->b_count; j-- > 0;) {
            uint8_t *way = &m->way[i * m->b_count + j];
            if (same(m->a, m->from + i, m->b, m->from + j)) {
                *way = WAY_BOTH;
                row[j] = below[j + 1] + 1;
            } else {
                *way = below[j] >= row[j + 1] ? WAY_REMOVE : WAY_ADD;
                row[j] = below[j] >= row[j + 1] ? below[j] : row[j + 1];
            }
        }
        uint32_t *swap = below;
        below = row;
        row = swap;
    }
}

static enum status middle_make(struct middle *m, struct reason *reason)
{
    const struct spirv_code *a = m->a, *b = m->b;
    const size_t least = a->count < b->count ? a->count : b->count;
    size_t end = 0;
    while (m->from < least && same(a, m->from, b, m->from))
        m->from++;
    while (end < least - m->from && same(a, a->count - 1 - end, b, b->count - 1 - end))
        end++;
    m->a_count = a->count - m->from - end;
    m->b_count = b->count - m->from - end;
    if (m->a_count == 0 || m->b_count == 0 || m->a_count > PAIRS_MOST / m->b_count)
        return STATUS_OK;
    uint32_t *longest = alloc_zeroed(m->b_count + 1, 2 * sizeof *longest);
    m->way = alloc_zeroed(m->a_count, m->b_count);
    if (longest && m->way)
        find_ways(m, longest);
    free(longest);
    return longest && m->way ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for a diff");
}

/* --- the diff --------------------------------------------------------------------------------- */

static void put_common(struct spirv_diff *diff, size_t i)
{
    diff->common[diff->common_count++] = i;
}

static void put_edit(struct spirv_diff *diff, bool added, size_t at)
{
    const bool begins =
        diff->count == 0 || diff->edit[diff->count - 1].common != diff->common_count;
    diff->hunks += begins;
    diff->edit[diff->count++] = (struct spirv_edit){added, at, diff->common_count, diff->hunks - 1};
}

static void walk(const struct middle *m, struct spirv_diff *diff)
{
    size_t i = 0, j = 0;
    for (size_t k = 0; k < m->from; k++)
        put_common(diff, k);
    while (i < m->a_count && j < m->b_count) {
        const int way = m->way ? m->way[i * m->b_count + j] : WAY_REMOVE;
        if (way == WAY_BOTH) {
            put_common(diff, m->from + i++);
            j++;
        } else if (way == WAY_REMOVE) {
            put_edit(diff, false, m->from + i++);
        } else {
            put_edit(diff, true, m->from + j++);
        }
    }
    while (i < m->a_count)
        put_edit(diff, false, m->from + i++);
    while (j < m->b_count)
        put_edit(diff, true, m->from + j++);
    for (size_t k = m->from + m->a_count; k < m->a->count; k++)
        put_common(diff, k);
}

enum status spirv_diff_make(const struct spirv_code *before, const struct spirv_code *after,
                            struct spirv_diff *out, struct reason *reason)
{
    struct middle m = {.a = before, .b = after};
    *out = (struct spirv_diff){.before = before, .after = after};
    enum status status = middle_make(&m, reason);
    out->edit = alloc_zeroed(before->count + after->count, sizeof *out->edit);
    out->common = alloc_zeroed(before->count, sizeof *out->common);
    if (!status && !(out->edit && out->common))
        status = fail(reason, STATUS_MEMORY, "no memory for a diff");
    if (!status)
        walk(&m, out);
    free(m.way);
    if (status)
        spirv_diff_free(out);
    return status;
}

void spirv_diff_free(struct spirv_diff *diff)
{
    free(diff->edit);
    free(diff->common);
    *diff = (struct spirv_diff){0};
}

/* --- modules between -------------------------------------------------------------------------- */

static size_t put(uint32_t *out, size_t count, const struct spirv_code *code, size_t i)
{
    const size_t length = spirv_length(code, i);
    memcpy(out + count, spirv_words(code, i), length * sizeof *out);
    return count + length;
}

enum status spirv_diff_apply(const struct spirv_diff *diff, const bool *done, uint32_t **out,
                             size_t *out_count, struct reason *reason)
{
    const struct spirv_code *a = diff->before, *b = diff->after;
    size_t count = SPIRV_HEADER_WORDS, next = 0;
    *out_count = 0;
    *out = alloc_zeroed(a->at[a->count] + b->at[b->count], sizeof **out);
    if (!*out)
        return fail(reason, STATUS_MEMORY, "no memory for a shader");
    memcpy(*out, a->word, SPIRV_HEADER_WORDS * sizeof **out);
    if (b->word[BOUND] > a->word[BOUND])
        (*out)[BOUND] = b->word[BOUND];
    for (size_t e = 0; e <= diff->count; e++) {
        const size_t until = e < diff->count ? diff->edit[e].common : diff->common_count;
        while (next < until)
            count = put(*out, count, a, diff->common[next++]);
        if (e < diff->count && diff->edit[e].added == done[e])
            count = put(*out, count, diff->edit[e].added ? b : a, diff->edit[e].at);
    }
    *out_count = count;
    return STATUS_OK;
}
