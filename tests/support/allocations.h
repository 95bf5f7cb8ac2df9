/* Allocations that fail when they are told to, and are counted and weighed. A program that includes
 * this is linked so that its own and the library's come here first (Makefile, mutants.sh): those of
 * the C library and of Embree do not. Include before all else. */
#ifndef TESTS_ALLOCATIONS_H
#define TESTS_ALLOCATIONS_H

#ifndef _DEFAULT_SOURCE
#define _DEFAULT_SOURCE /* malloc_usable_size, RLIMIT_AS */
#endif
#include <malloc.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

static atomic_long until_failure = -1; /* negative: none fails */
static atomic_long held;
static atomic_long bytes_held, bytes_most;
static atomic_bool has_failed;

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t bytes);
void *__real_aligned_alloc(size_t align, size_t bytes);
void __real_free(void *old);
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t bytes);
void *__wrap_aligned_alloc(size_t align, size_t bytes);
void __wrap_free(void *old);

/* After n more allocations one fails; negative: none does. */
static inline void fail_after(long n)
{
    atomic_store(&has_failed, false);
    atomic_store(&until_failure, n);
}

static bool fails_now(void)
{
    if (atomic_load(&until_failure) < 0 || atomic_fetch_sub(&until_failure, 1) != 0)
        return false;
    atomic_store(&has_failed, true);
    return true;
}

static void weigh(long bytes)
{
    long now = atomic_fetch_add(&bytes_held, bytes) + bytes;
    long most = atomic_load(&bytes_most);
    while (now > most && !atomic_compare_exchange_weak(&bytes_most, &most, now))
        continue;
}

static void *counted(void *made)
{
    if (made) {
        atomic_fetch_add(&held, 1);
        weigh((long)malloc_usable_size(made));
    }
    return made;
}

void *__wrap_malloc(size_t bytes)
{
    return fails_now() ? NULL : counted(__real_malloc(bytes));
}

void *__wrap_calloc(size_t count, size_t size)
{
    return fails_now() ? NULL : counted(__real_calloc(count, size));
}

/* One that makes an array smaller is a wish: nothing is said if it fails. */
void *__wrap_realloc(void *old, size_t bytes)
{
    if (!old)
        return __wrap_malloc(bytes);
    long before = (long)malloc_usable_size(old);
    if ((long)bytes > before && fails_now())
        return NULL;
    weigh((long)bytes); /* both are there while one is copied */
    void *made = __real_realloc(old, bytes);
    weigh((made ? (long)malloc_usable_size(made) - before : 0) - (long)bytes);
    return made;
}

void *__wrap_aligned_alloc(size_t align, size_t bytes)
{
    return fails_now() ? NULL : counted(__real_aligned_alloc(align, bytes));
}

void __wrap_free(void *old)
{
    if (old) {
        atomic_fetch_sub(&held, 1);
        weigh(-(long)malloc_usable_size(old));
    }
    __real_free(old);
}

#endif
