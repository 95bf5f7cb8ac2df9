#define _DEFAULT_SOURCE
#include "ref/outside/plugin_guard.h"

#include "ref/outside/child.h"
#include "ref/outside/shared_object.h"
#include "ref/files/file.h"
#include "ref/store.h"

#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define PATH_MOST 512
#define FATE_MS   1000u
#define EXIT_HUNG 3 /* EXIT_ENGINE */

static bool hung; /* of the last failed child */
static uint32_t limit_ms = PLUGIN_MS, limit_mb = PLUGIN_MB;

static struct {
    void *handle;
    const struct layout *layout;
    char path[PATH_MOST];
} opened[LAYOUTS_ADDED_MOST];
static size_t opened_count;

void plugin_limits(uint32_t ms, uint32_t megabytes)
{
    limit_ms = ms ? ms : PLUGIN_MS;
    limit_mb = megabytes ? megabytes : PLUGIN_MB;
}

/* --- the child's side ------------------------------------------------------------------------ */

/* The first message: the result. After a successful packing the words and items follow. */
struct told {
    enum status status;
    struct reason reason;
    enum packed_rule rule;
    uint32_t word_count, item_count, node_count, ref_count, root;
};

struct guard_packing {
    const struct layout *layout;
    const struct bvh *bvh;
    const struct scene *scene;
};

static void pack_in_child(struct child *parent, void *user)
{
    const struct guard_packing *what = user;
    struct told told = {.status = STATUS_OK};
    struct packed packed = {.store = tri_stores[0]};
    object_limit_memory(limit_mb);
    told.status =
        plugin_pack(what->layout, what->bvh, what->scene, &packed, &told.rule, &told.reason);
    told.word_count = packed.word_count;
    told.item_count = packed.item_count;
    told.node_count = packed.node_count;
    told.ref_count = packed.ref_count;
    told.root = packed.root;
    bool sent = child_send(parent, &told, sizeof told, CHILD_FOREVER);
    if (sent && !told.status)
        sent = child_send(parent, packed.word, 4 * (size_t)packed.word_count, CHILD_FOREVER);
    if (sent && !told.status && packed.item_count)
        sent = child_send(parent, packed.item, 4 * (size_t)packed.item_count, CHILD_FOREVER);
    packed_free(&packed);
}

/* Returns the plugin of an opened object; NULL with a reason on error. */
static const struct raydiff_plugin *ask(void *handle, const char *path, struct reason *reason)
{
    union {
        void *object;
        const struct raydiff_plugin *(*function)(void);
    } found = {.object = dlsym(handle, "raydiff_plugin")};
    if (!found.object) {
        (void)fail(reason, STATUS_INPUT, "%.120s: it does not export raydiff_plugin()", path);
        return NULL;
    }
    const struct raydiff_plugin *plugin = found.function();
    return plugin_check(path, plugin, reason) ? NULL : plugin;
}

static void open_in_child(struct child *parent, void *user)
{
    struct told told = {.status = STATUS_INPUT};
    object_limit_memory(limit_mb);
    void *handle = object_open(user, &told.reason);
    if (handle && ask(handle, user, &told.reason))
        told.status = STATUS_OK;
    if (!child_send(parent, &told, sizeof told, CHILD_FOREVER))
        return;
}

/* --- the parent's side ----------------------------------------------------------------------- */

/* Ends a child that sent no answer; the reason tells how it failed. */
static enum status blame_after(const char *name, const char *doing, struct child *child,
                               uint64_t start, uint32_t most, struct reason *reason)
{
    struct child_fate fate = {.forced = false};
    bool late = (time_ns() - start) / 1000000u >= most;
    hung = late;
    child_end(child, late ? 0 : FATE_MS, &fate);
    if (late)
        return fail(reason, STATUS_DEVICE, "%.120s: hung while %s: no end after %u ms", name, doing,
                    most);
    return fail(reason, STATUS_DEVICE, "%.120s: crashed while %s: %s", name, doing, fate.text);
}

static enum status blame(const char *name, const char *doing, struct child *child, uint64_t start,
                         struct reason *reason)
{
    return blame_after(name, doing, child, start, limit_ms, reason);
}

static uint32_t left_ms(uint64_t start)
{
    uint64_t spent = (time_ns() - start) / 1000000u;
    return spent < limit_ms ? (uint32_t)(limit_ms - spent) : 0;
}

static bool receive_words(struct child *child, uint32_t count, uint64_t start, uint32_t **out)
{
    *out = NULL;
    if (count == 0)
        return true;
    *out = alloc_zeroed(count, sizeof **out);
    return *out && child_receive_into(child, *out, 4 * (size_t)count, left_ms(start));
}

enum status plugin_pack_guarded(const struct layout *layout, const struct bvh *bvh,
                                const struct scene *scene, struct packed *out,
                                enum packed_rule *rule, struct reason *reason)
{
    struct guard_packing what = {layout, bvh, scene};
    struct child child;
    struct told told;
    uint64_t start = time_ns();
    *out = (struct packed){.store = out->store};
    *rule = PACKED_SOUND;
    enum status status = child_start(pack_in_child, &what, &child, reason);
    if (status)
        return status;
    if (!child_receive_into(&child, &told, sizeof told, limit_ms))
        return blame(layout->name, "packing", &child, start, reason);
    if (told.status) {
        child_end(&child, 0, NULL);
        *rule = told.rule;
        return fail(reason, told.status, "%s", told.reason.text);
    }
    const uint64_t width = layout->width > 2 ? layout->width : 0;
    if (told.word_count != (uint64_t)told.node_count * (layout->node_bytes / 4) ||
        told.ref_count != told.node_count * (1 + width) || told.root >= told.node_count) {
        child_end(&child, 0, NULL);
        return fail(reason, STATUS_DEVICE, "%s: pack() damaged its process", layout->name);
    }
    if (!receive_words(&child, told.word_count, start, &out->word) ||
        !receive_words(&child, told.item_count, start, &out->item)) {
        packed_free(out);
        return blame(layout->name, "sending what it packed", &child, start, reason);
    }
    child_end(&child, FATE_MS, NULL);
    out->layout = layout;
    out->word_count = told.word_count;
    out->item_count = told.item_count;
    out->node_count = told.node_count;
    out->ref_count = told.ref_count;
    out->root = told.root;
    return STATUS_OK;
}

static uint32_t open_ms(void)
{
    return limit_ms < PLUGIN_OPEN_MS ? limit_ms : PLUGIN_OPEN_MS;
}

/* Opens the object in this process, too, where its constructor may hang. Then nothing helps but
 * ending the process. */
struct opening {
    const char *path;
    pthread_mutex_t mutex;
    pthread_cond_t done;
    bool is_done;
};

static void *watch_opening(void *user)
{
    struct opening *opening = user;
    struct timespec end;
    clock_gettime(CLOCK_REALTIME, &end);
    end.tv_sec += open_ms() / 1000 + 1;
    pthread_mutex_lock(&opening->mutex);
    int code = 0;
    while (!opening->is_done && code != ETIMEDOUT)
        code = pthread_cond_timedwait(&opening->done, &opening->mutex, &end);
    bool late = !opening->is_done;
    pthread_mutex_unlock(&opening->mutex);
    if (late) {
        fprintf(stderr, "raydiff: %.120s: hung while being opened again: no end after %u ms\n",
                opening->path, open_ms());
        file_out_abandon();
        _exit(EXIT_HUNG);
    }
    return NULL;
}

static void *open_watched(const char *path, const struct raydiff_plugin **plugin,
                          struct reason *reason)
{
    struct opening opening = {
        .path = path, .mutex = PTHREAD_MUTEX_INITIALIZER, .done = PTHREAD_COND_INITIALIZER};
    pthread_t watcher;
    bool watched = pthread_create(&watcher, NULL, watch_opening, &opening) == 0;
    void *handle = object_open(path, reason);
    *plugin = handle ? ask(handle, path, reason) : NULL;
    pthread_mutex_lock(&opening.mutex);
    opening.is_done = true;
    pthread_cond_signal(&opening.done);
    pthread_mutex_unlock(&opening.mutex);
    if (watched)
        pthread_join(watcher, NULL);
    return handle;
}

static enum status try_open(char *path, struct reason *reason)
{
    struct child child;
    struct told told;
    uint64_t start = time_ns();
    enum status status = child_start(open_in_child, path, &child, reason);
    if (status)
        return status;
    if (!child_receive_into(&child, &told, sizeof told, open_ms()))
        return blame_after(path, "being opened", &child, start, open_ms(), reason);
    child_end(&child, 0, NULL);
    return told.status ? fail(reason, told.status, "%s", told.reason.text) : STATUS_OK;
}

static void close_all(void)
{
    while (opened_count > 0)
        dlclose(opened[--opened_count].handle);
}

enum status plugin_open(const char *path, const struct layout **out, struct reason *reason)
{
    *out = NULL;
    for (size_t i = 0; i < opened_count; i++)
        if (strcmp(opened[i].path, path) == 0) {
            *out = opened[i].layout;
            return STATUS_OK;
        }
    if (strlen(path) >= PATH_MOST)
        return fail(reason, STATUS_INPUT, "%.60s...: a path of over %d characters", path,
                    PATH_MOST - 1);
    if (opened_count == ARRAY_COUNT(opened))
        return fail(reason, STATUS_LIMIT, "%.120s: more than %zu layouts from outside", path,
                    ARRAY_COUNT(opened));
    strcpy(opened[opened_count].path, path);
    enum status status = object_check_file(path, reason);
    if (!status)
        status = try_open(opened[opened_count].path, reason);
    if (status)
        return status;
    const struct raydiff_plugin *plugin;
    void *handle = open_watched(path, &plugin, reason);
    status = plugin ? plugin_layout_add(path, plugin, out, reason) : STATUS_INPUT;
    if (status) {
        if (handle)
            dlclose(handle);
        return status;
    }
    if (opened_count == 0)
        atexit(close_all);
    plugin_pack_with(plugin_pack_guarded);
    opened[opened_count].handle = handle;
    opened[opened_count++].layout = *out;
    return STATUS_OK;
}

bool plugin_hung(void)
{
    return hung;
}

const char *plugin_path(const struct layout *layout)
{
    for (size_t i = 0; layout && i < opened_count; i++)
        if (opened[i].layout == layout)
            return opened[i].path;
    return NULL;
}
