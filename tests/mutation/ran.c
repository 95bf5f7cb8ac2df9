/* Which code a program runs, for tests/mutation/coverage.sh:
 *   RAN_BLOCKS=FOLDER PROGRAM...
 * The folder gets a file for each shared object or program that this is linked into, with a byte
 * for each address of its code: 1 where a basic block begins that was run, by whatever process. All
 * map it, so that what a signal ends has told what it ran, too. The other code is compiled with
 * -fsanitize-coverage=trace-pc. Where there is no such folder nothing is kept. */
#define _GNU_SOURCE /* dl_iterate_phdr */
#include <fcntl.h>
#include <link.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

void __sanitizer_cov_trace_pc(void);

static unsigned char *ran;
static uintptr_t base, end, length; // length: none before there is a map

/* The object that this code lies in: its base, and the end of its code, from there. */
static int find_object(struct dl_phdr_info *info, size_t size, void *name)
{
    (void)size;
    uintptr_t here = (uintptr_t)&__sanitizer_cov_trace_pc - info->dlpi_addr;
    for (int i = 0; i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *part = &info->dlpi_phdr[i];
        if (part->p_type != PT_LOAD || here < part->p_vaddr ||
            here >= part->p_vaddr + part->p_memsz)
            continue;
        base = info->dlpi_addr;
        end = part->p_vaddr + part->p_memsz;
        *(const char **)name = info->dlpi_name;
        return 1;
    }
    return 0;
}

__attribute__((constructor(101))) static void map_blocks(void)
{
    const char *folder = getenv("RAN_BLOCKS"), *name = NULL;
    char program[4096], path[8192];
    if (!folder || !dl_iterate_phdr(find_object, &name))
        return;
    if (!*name) {
        ssize_t length_of = readlink("/proc/self/exe", program, sizeof program - 1);
        program[length_of > 0 ? length_of : 0] = 0;
        name = program;
    }
    const char *last = strrchr(name, '/');
    snprintf(path, sizeof path, "%s/%s", folder, last ? last + 1 : name);
    int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0)
        return;
    void *map = ftruncate(file, (off_t)end) == 0
                    ? mmap(NULL, end, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                    : MAP_FAILED;
    close(file);
    if (map == MAP_FAILED)
        return;
    ran = map;
    length = end;
}

void __sanitizer_cov_trace_pc(void)
{
    uintptr_t at = (uintptr_t)__builtin_return_address(0) - base;
    if (at < length)
        ran[at] = 1;
}
