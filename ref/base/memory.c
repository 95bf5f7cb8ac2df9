#define _DEFAULT_SOURCE /* RLIMIT_AS */
#include "ref/base/memory.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define LINE 4096

/* Reads the number after `key` at the beginning of a line of a file; false if there is none. */
static bool find_number(const char *path, const char *key, uint64_t *out)
{
    char line[LINE];
    bool found = false;
    FILE *file = fopen(path, "r");
    while (file && !found && fgets(line, sizeof line, file))
        found = strncmp(line, key, strlen(key)) == 0 &&
                sscanf(line + strlen(key), "%" SCNu64, out) == 1;
    if (file)
        (void)fclose(file);
    return found;
}

static uint64_t left_of(uint64_t most, uint64_t used)
{
    return most > used ? most - used : 0;
}

static uint64_t system_left(void)
{
    uint64_t kilobytes;
    return find_number("/proc/meminfo", "MemAvailable:", &kilobytes) ? kilobytes << 10 : UINT64_MAX;
}

/* The kernel frees inactive cached files of the group when memory is needed, so they count as
 * free. */
static uint64_t one_group_left(const char *group)
{
    char path[LINE];
    uint64_t most, used, unused = 0;
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.max", group);
    if (!find_number(path, "", &most)) /* the value may be "max" */
        return UINT64_MAX;
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.current", group);
    if (!find_number(path, "", &used))
        return UINT64_MAX;
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.stat", group);
    (void)find_number(path, "inactive_file ", &unused);
    return left_of(most, left_of(used, unused));
}

/* The least of the group's own value and those of its ancestors. */
static uint64_t group_left(void)
{
    char line[LINE / 2];
    uint64_t least = UINT64_MAX;
    bool found = false;
    FILE *file = fopen("/proc/self/cgroup", "r");
    while (file && !found && fgets(line, sizeof line, file))
        found = strncmp(line, "0::", 3) == 0;
    if (file)
        (void)fclose(file);
    if (!found)
        return UINT64_MAX;
    line[strcspn(line, "\n")] = 0;
    for (char *end = line; end; end = strrchr(line + 3, '/')) {
        if (end > line)
            *end = 0; /* the parent group; the last has no name */
        uint64_t left = one_group_left(line + 3);
        least = left < least ? left : least;
    }
    return least;
}

static uint64_t space_left(void)
{
    struct rlimit limit;
    uint64_t pages;
    long page = sysconf(_SC_PAGESIZE);
    if (getrlimit(RLIMIT_AS, &limit) || limit.rlim_cur == RLIM_INFINITY || page <= 0 ||
        !find_number("/proc/self/statm", "", &pages))
        return UINT64_MAX;
    return left_of(limit.rlim_cur, pages * (uint64_t)page);
}

uint64_t memory_left(void)
{
    uint64_t left = system_left(), group = group_left(), space = space_left();
    left = group < left ? group : left;
    return space < left ? space : left;
}
