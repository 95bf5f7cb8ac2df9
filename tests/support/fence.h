/* Words that end where memory ends: what reads or writes behind them is ended by a signal. Include
 * after cmocka.h. */
#ifndef TESTS_FENCE_H
#define TESTS_FENCE_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

struct fence {
    char *pages; /* whole ones, the last of which cannot be used */
    size_t bytes, page;
    uint32_t *word;
};

/* `count` words, copied from `word` unless that is NULL. */
static inline struct fence fence_make(const uint32_t *word, size_t count)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE), used = count * sizeof *word;
    size_t bytes = (used + page - 1) / page * page + page;
    struct fence fence = {aligned_alloc(page, bytes), bytes, page, NULL};
    assert_non_null(fence.pages);
    fence.word = (uint32_t *)(void *)(fence.pages + bytes - page - used);
    memset(fence.word, 0, used);
    if (word)
        memcpy(fence.word, word, used);
    assert_int_equal(mprotect(fence.pages + bytes - page, page, PROT_NONE), 0);
    return fence;
}

static inline void fence_free(struct fence *fence)
{
    assert_int_equal(mprotect(fence->pages, fence->bytes, PROT_READ | PROT_WRITE), 0);
    free(fence->pages);
}

#endif
