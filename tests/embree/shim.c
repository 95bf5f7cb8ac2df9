/* Between a program and the dynamic loader, to see what it does with another Embree:
 *   VARIABLES LD_PRELOAD=shim.so PROGRAM...
 *   EMBREE_ABSENT=1    no library of Embree can be opened
 *   EMBREE_LACKS=NAME  it has no function of that name
 *   EMBREE_LESS=1      it has no device of AVX-512, and those of AVX run SSE4.2 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

typedef void *(*find)(void *handle, const char *name);
typedef void *(*new_device)(const char *config);

static new_device real_device;

/* The loader's own dlsym, of whichever version it has on this processor. */
static find real_dlsym(void)
{
    static const char *const versions[] = {"GLIBC_2.34", "GLIBC_2.17", "GLIBC_2.2.5"};
    void *found = NULL;
    for (size_t i = 0; i < 3 && !found; i++)
        found = dlvsym(RTLD_NEXT, "dlsym", versions[i]);
    return (find)found;
}

static void *less_device(const char *config)
{
    if (strstr(config, "isa=avx512"))
        return NULL;
    return real_device(strstr(config, "isa=avx") ? "threads=1,verbose=1,isa=sse4.2" : config);
}

void *dlsym(void *handle, const char *name)
{
    const char *lacks = getenv("EMBREE_LACKS");
    if (lacks && strcmp(lacks, name) == 0)
        return NULL;
    void *found = real_dlsym()(handle, name);
    if (!found || !getenv("EMBREE_LESS") || strcmp(name, "rtcNewDevice") != 0)
        return found;
    real_device = (new_device)found;
    return (void *)less_device;
}

void *dlopen(const char *path, int flags)
{
    void *(*real)(const char *, int) =
        (void *(*)(const char *, int))real_dlsym()(RTLD_NEXT, "dlopen");
    const char *slash = path ? strrchr(path, '/') : NULL;
    char nowhere[256] = "/nowhere/";
    const char *name = slash ? slash + 1 : path;
    if (!name || strncmp(name, "libembree", 9) != 0 || !getenv("EMBREE_ABSENT"))
        return real(path, flags);
    strncat(nowhere, name, sizeof nowhere - sizeof "/nowhere/");
    return real(nowhere, flags);
}
