#define _DEFAULT_SOURCE
#include "ref/outside/shared_object.h"

#include "ref/outside/pipe.h"

#include <ctype.h>
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH_MOST 512

bool object_is_named(const char *name, size_t length)
{
    const size_t suffix = strlen(OBJECT_SUFFIX);
    return length > suffix && memcmp(name + length - suffix, OBJECT_SUFFIX, suffix) == 0;
}

const char *object_of_engine(const char *name)
{
    const size_t prefix = strlen(GUEST_PREFIX);
    const char *path = strncmp(name, GUEST_PREFIX, prefix) == 0 ? name + prefix : name;
    return strncmp(name, PIPE_PREFIX, strlen(PIPE_PREFIX)) != 0 &&
                   strncmp(name, SHADER_PREFIX, strlen(SHADER_PREFIX)) != 0 &&
                   object_is_named(path, strlen(path))
               ? path
               : NULL;
}

const char *file_of_engine(const char *name)
{
    const size_t prefix = strlen(SHADER_PREFIX);
    return strncmp(name, SHADER_PREFIX, prefix) == 0 && name[prefix] ? name + prefix
                                                                     : object_of_engine(name);
}

enum status object_check_file(const char *path, struct reason *reason)
{
    struct stat what;
    if (stat(path, &what) == 0 && !S_ISREG(what.st_mode))
        return fail(reason, STATUS_INPUT, "%.120s: is no regular file, so no shared object", path);
    return STATUS_OK;
}

void *object_open(const char *path, struct reason *reason)
{
    char here[PATH_MOST + 2];
    snprintf(here, sizeof here, "%s%s", strchr(path, '/') ? "" : "./", path);
    void *handle = dlopen(here, RTLD_NOW | RTLD_LOCAL);
    if (handle)
        return handle;
    const char *why = dlerror();
    size_t named = strlen(here); /* dlerror() begins with the path, too */
    if (strncmp(why, here, named) == 0 && strncmp(why + named, ": ", 2) == 0)
        why += named + 2;
    (void)fail(reason, STATUS_INPUT, "%.120s: cannot be loaded as a shared object: %.150s", path,
               why);
    return NULL;
}

bool object_name_is_fine(const char *name, size_t most)
{
    size_t length = name ? strnlen(name, most + 1) : 0;
    bool fine = length > 0 && length <= most && isalpha((unsigned char)name[0]);
    for (size_t i = 0; i < length && fine; i++)
        fine = isalnum((unsigned char)name[i]) || name[i] == '_';
    return fine;
}

void object_limit_memory(uint32_t megabytes)
{
    unsigned long long pages = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    if (megabytes == UINT32_MAX || !file) {
        if (file)
            fclose(file);
        return;
    }
    bool known = fscanf(file, "%llu", &pages) == 1;
    fclose(file);
    rlim_t most = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + ((rlim_t)megabytes << 20);
    struct rlimit memory = {most, most};
    if (known)
        setrlimit(RLIMIT_AS, &memory);
}
