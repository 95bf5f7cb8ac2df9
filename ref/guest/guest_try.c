/* Loading a guest in a child first, so that a crash of its constructors is one line of text. */
#include "ref/guest/guest.h"
#include "ref/outside/child.h"
#include "ref/outside/shared_object.h"

#include <string.h>

#define TRY_MB  8192u
#define FATE_MS 1000u

struct tried {
    enum status status;
    struct reason reason;
};

static void load_in_child(struct child *parent, void *user)
{
    struct tried tried = {.status = STATUS_OK};
    struct guest guest;
    object_limit_memory(TRY_MB);
    tried.status = guest_load(user, &guest, &tried.reason);
    if (!child_send(parent, &tried, sizeof tried, CHILD_FOREVER))
        return;
    guest_close(&guest);
}

enum status guest_try(const char *path, uint32_t ms, struct reason *reason)
{
    char copy[GUEST_PATH_MOST];
    struct child child;
    struct tried tried;
    struct child_fate fate;
    const uint64_t start = time_ns();
    if (strlen(path) >= sizeof copy)
        return fail(reason, STATUS_INPUT, "%.60s...: a path of over %d characters", path,
                    GUEST_PATH_MOST - 1);
    strcpy(copy, path);
    enum status status = child_start(load_in_child, copy, &child, reason);
    if (status)
        return status;
    if (child_receive_into(&child, &tried, sizeof tried, ms)) {
        child_end(&child, FATE_MS, NULL);
        return tried.status ? fail(reason, tried.status, "%s", tried.reason.text) : STATUS_OK;
    }
    const bool late = (time_ns() - start) / 1000000u >= ms;
    child_end(&child, late ? 0 : FATE_MS, &fate);
    if (late)
        return fail(reason, STATUS_DEVICE, "%.120s: hung while being opened: no end after %u ms",
                    path, ms);
    return fail(reason, STATUS_DEVICE, "%.120s: crashed while being opened: %s", path, fate.text);
}
