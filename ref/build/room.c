#define _DEFAULT_SOURCE /* madvise */
#include "ref/build/room.h"

#include "ref/base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

/* Arrays of twice this size use pages of 2 MB. With pages of 4 KB a fast builder would spend much
 * of its time on page faults. */
#define PAGE_BYTES ((size_t)2 << 20)

void *room_make(size_t count, size_t size)
{
    if (size && count > (SIZE_MAX - PAGE_BYTES) / size)
        return NULL;
    size_t align = count * size >= 2 * PAGE_BYTES ? PAGE_BYTES : 64;
    size_t bytes = (count * size + align) / align * align;
    void *room = memory_fits(bytes) ? aligned_alloc(align, bytes) : NULL;
#ifdef MADV_HUGEPAGE
    if (room && align == PAGE_BYTES)
        (void)madvise(room, bytes, MADV_HUGEPAGE); /* a hint: nothing depends on it */
#endif
    return room;
}

void room_free(void *room)
{
    free(room);
}
