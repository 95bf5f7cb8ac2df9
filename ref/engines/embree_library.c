/* Opens Embree's shared library. */
#define _POSIX_C_SOURCE 200809L
#include "ref/engine.h"

#if HAVE_EMBREE

#include "ref/base/symbols.h"
#include "ref/engines/embree_library.h"

#include <dlfcn.h>
#include <pthread.h>

struct embree_functions rtc;

static pthread_once_t once = PTHREAD_ONCE_INIT;
static enum status loaded;
static struct reason why;

static void *open_library(void)
{
    void *library = NULL;
#ifdef EMBREE_FOLDER /* it lies where the system does not look */
    library = dlopen(EMBREE_FOLDER "/" EMBREE_LIBRARY, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
#endif
    return library ? library : dlopen(EMBREE_LIBRARY, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
}

/* It is never closed: its threads and memory would outlive it. */
static void load(void)
{
    static const struct symbol functions[] = {
#define EMBREE_ENTRY(name) {"rtc" #name, offsetof(struct embree_functions, name)},
        EMBREE_FUNCTIONS(EMBREE_ENTRY)
#undef EMBREE_ENTRY
    };
    struct embree_functions found;
    void *library = open_library();
    if (!library) {
        loaded = fail(&why, STATUS_UNSUPPORTED, "Embree: no library: %s", dlerror());
        return;
    }
    const char *lacks = symbols_find(library, functions, ARRAY_COUNT(functions), &found);
    if (lacks)
        loaded = fail(&why, STATUS_UNSUPPORTED, "Embree: %s has no %s", EMBREE_LIBRARY, lacks);
    else
        rtc = found;
}

enum status embree_load(struct reason *reason)
{
    pthread_once(&once, load);
    return loaded ? fail(reason, loaded, "%s", why.text) : STATUS_OK;
}

#endif
