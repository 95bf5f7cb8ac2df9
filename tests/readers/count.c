/* Counts what is allocated: by the sanitizers' hooks where there are any, else by standing before
 * the GNU C library's functions; -DREADER_NO_COUNT turns that off. */
#define _GNU_SOURCE
#include "tests/readers/reader_entry.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if defined __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define HOOKS
#endif
#endif
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
#define HOOKS
#endif
#if !defined HOOKS && defined __GLIBC__ && !defined READER_NO_COUNT
#define READER_OWN_MALLOC
#endif

/* Of the thread that plays: other threads' memory is not the reader's. */
static _Thread_local struct {
    bool on, unlimited;
    ptrdiff_t held; /* below 0: what was there before is freed */
    size_t peak, most;
} count;

void reader_count_begin(size_t most)
{
    count.held = 0;
    count.peak = 0;
    count.most = most;
    count.unlimited = false;
    count.on = true;
}

void reader_count_limit(bool on)
{
    count.unlimited = !on;
}

void reader_count_end(size_t *most_held, ptrdiff_t *left)
{
    count.on = false;
    *most_held = count.peak;
    *left = count.held;
}

#if defined HOOKS || defined READER_OWN_MALLOC

bool reader_counts(void)
{
    return true;
}

/* No allocation in here. */
static _Noreturn void too_much(size_t block)
{
    char line[200];
    count.on = false;
    int length = snprintf(line, sizeof line,
                          "reader %s: does not hold: a block of %zu bytes makes %td held, at most "
                          "%zu may be\n",
                          reader_entry.name, block, count.held, count.most);
    if (length > 0 && write(STDERR_FILENO, line, (size_t)length) != length)
        _exit(134);
    abort();
}

static void took(size_t size)
{
    if (!count.on)
        return;
    count.held += (ptrdiff_t)size;
    if (count.unlimited)
        return;
    if (size > count.most || (count.held > 0 && (size_t)count.held > count.most))
        too_much(size);
    if (count.held > 0 && (size_t)count.held > count.peak)
        count.peak = (size_t)count.held;
}

static void gave(size_t size)
{
    if (count.on)
        count.held -= (ptrdiff_t)size;
}

#else

bool reader_counts(void)
{
    return false;
}

#endif

#ifdef HOOKS
/* As in <sanitizer/allocator_interface.h>, which GCC does not bring. */
int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void *, size_t),
                                              void (*free_hook)(const volatile void *));
size_t __sanitizer_get_allocated_size(const volatile void *block);
int __sanitizer_get_ownership(const volatile void *block);

static void hook_malloc(const volatile void *block, size_t size)
{
    (void)size;
    if (block)
        took(__sanitizer_get_allocated_size(block));
}

static void hook_free(const volatile void *block)
{
    if (block && __sanitizer_get_ownership(block))
        gave(__sanitizer_get_allocated_size(block));
}

__attribute__((constructor)) static void install(void)
{
    if (!__sanitizer_install_malloc_and_free_hooks(hook_malloc, hook_free))
        reader_broken("the sanitizer takes hooks", __FILE__, __LINE__);
}

#elif defined READER_OWN_MALLOC
/* glibc's own, under the names that it keeps for this. Sizes are as malloc_usable_size has them, a
 * little more than was asked for. */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *block);

/* A block asked for beyond all memory is one that must not be asked for: it counts although it is
 * not to be had. */
static void *taken(void *block, size_t asked)
{
    if (block)
        took(malloc_usable_size(block));
    else
        took(asked);
    return block;
}

void *malloc(size_t size)
{
    return taken(__libc_malloc(size), size);
}

void *calloc(size_t number, size_t size)
{
    size_t product = size && number > SIZE_MAX / size ? SIZE_MAX / 2 : number * size;
    return taken(__libc_calloc(number, size), product);
}

void *realloc(void *block, size_t size)
{
    size_t before = block ? malloc_usable_size(block) : 0;
    void *moved = __libc_realloc(block, size);
    if (moved || size == 0)
        gave(before);
    return moved || size ? taken(moved, size) : moved;
}

void free(void *block)
{
    if (block)
        gave(malloc_usable_size(block));
    __libc_free(block);
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    void *block = taken(__libc_memalign(alignment, size), size);
    *out = block;
    return block ? 0 : 12; /* ENOMEM */
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return taken(__libc_memalign(alignment, size), size);
}
#endif
