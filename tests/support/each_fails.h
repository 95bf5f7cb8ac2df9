/* Work of which each allocation in turn fails. Include after cmocka.h; the program is linked as
 * tests/support/allocations.h has it, which comes before all else. */
#ifndef SUPPORT_EACH_FAILS_H
#define SUPPORT_EACH_FAILS_H

#include "ref/base/base.h"

#include <string.h>

#define EACH_FAILS_MOST 4000

/* Work that frees what it makes, and whose outputs are zero on an error. */
typedef enum status each_fails_fn(const void *of, struct reason *reason);

/* Fails allocations 0, step, 2 step ... until there is none to fail: the status is STATUS_MEMORY,
 * the reason tells that there is
 * no memory, and nothing is kept. Returns how many allocations there are. */
static inline long each_fails(const char *name, each_fails_fn *work, const void *of, long step)
{
    for (long n = 0; n < EACH_FAILS_MOST; n += step) {
        struct reason reason = {""};
        atomic_store(&held, 0);
        fail_after(n);
        enum status status = work(of, &reason);
        atomic_store(&until_failure, -1);
        if (held != 0)
            fail_msg("%s: without allocation %ld: %ld are kept", name, n, (long)held);
        if (!has_failed) {
            if (status)
                fail_msg("%s: %s", name, reason.text);
            return n;
        }
        if (status != STATUS_MEMORY || !strstr(reason.text, "no memory"))
            fail_msg("%s: without allocation %ld: status %d, \"%s\"", name, n, status, reason.text);
    }
    fail_msg("%s: never ends", name);
    return 0;
}

#endif
