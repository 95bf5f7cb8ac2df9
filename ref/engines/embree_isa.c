/* Which ISA a device of Embree runs, as it says itself. */
#define _POSIX_C_SOURCE 200809L
#include "ref/engines/embree_device.h"

#if HAVE_EMBREE

#include "ref/engines/embree_inner.h"
#include "ref/engines/embree_isa.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define SAID_MOST 16384

const char *const embree_isa_configs[EMBREE_ISAS] = {
    "", ",isa=sse2", ",isa=sse4.2", ",isa=avx", ",isa=avx2", ",isa=avx512,frequency_level=simd512"};

/* As Embree writes them. */
static const char *const said_as[EMBREE_ISAS] = {NULL, "SSE2", "SSE4.2", "AVX", "AVX2", "AVX512"};

/* Whether the word is among those before `end`. */
static bool has_word(const char *line, const char *end, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = line; (at = strstr(at, word)) && at < end; at += length)
        if (at > line && at[-1] == ' ' && (at[length] == ' ' || at[length] == '\n'))
            return true;
    return false;
}

/* The line that ends with this, up to its mark. */
static const char *line_of(const char *said, const char *mark, const char **end)
{
    *end = strstr(said, mark);
    const char *line = *end;
    while (line && line > said && line[-1] != '\n')
        line--;
    return line;
}

enum embree_isa embree_isa_said(const char *said)
{
    const char *told_end, *made_end;
    const char *told = line_of(said, "(supported)", &told_end);
    const char *made = line_of(said, "(compile time enabled)", &made_end);
    for (enum embree_isa isa = EMBREE_ISAS - 1; told && made && isa > EMBREE_ISA_OWN; isa--)
        if (has_word(told, told_end, said_as[isa]) && has_word(made, made_end, said_as[isa]))
            return isa;
    return EMBREE_ISA_OWN;
}

/* Makes the device, which writes to the pipe in place of the standard streams. Never returns. */
static void say(enum embree_isa isa, int to)
{
    char config[sizeof "threads=1,verbose=1,isa=sse4.2,frequency_level=simd512"];
    snprintf(config, sizeof config, "threads=1,verbose=1%s", embree_isa_configs[isa]);
    if (dup2(to, STDOUT_FILENO) < 0 || dup2(to, STDERR_FILENO) < 0)
        _exit(2);
    RTCDevice device = rtc.NewDevice(config);
    if (device)
        rtc.ReleaseDevice(device);
    _exit(device ? 0 : 1);
}

static void read_all(int from, char said[SAID_MOST])
{
    char rest[512];
    size_t used = 0;
    ssize_t count;
    do {
        const bool full = used == SAID_MOST - 1;
        count = read(from, full ? rest : said + used, full ? sizeof rest : SAID_MOST - 1 - used);
        if (count > 0 && !full)
            used += (size_t)count;
    } while (count > 0 || (count < 0 && errno == EINTR));
    said[used] = '\0';
}

/* Writes what a device for that ISA says. */
static enum status ask(enum embree_isa isa, char said[SAID_MOST], struct reason *reason)
{
    int pipe_of[2], code = 0;
    if (pipe(pipe_of))
        return fail(reason, STATUS_DEVICE, "Embree: no pipe to ask for its ISA");
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        close(pipe_of[0]);
        say(isa, pipe_of[1]);
    }
    close(pipe_of[1]);
    if (child > 0)
        read_all(pipe_of[0], said);
    close(pipe_of[0]);
    while (child > 0 && waitpid(child, &code, 0) < 0 && errno == EINTR)
        continue;
    if (child < 0 || !WIFEXITED(code) || WEXITSTATUS(code) > 1)
        return fail(reason, STATUS_DEVICE, "Embree: no process could ask for its ISA");
    return WEXITSTATUS(code)
               ? fail(reason, STATUS_UNSUPPORTED, "Embree: no device of ISA %s for this processor",
                      embree_isa_words[isa])
               : STATUS_OK;
}

enum status embree_isa_check(enum embree_isa isa, struct reason *reason)
{
    static atomic_int known[EMBREE_ISAS]; /* 0: not asked; else 1 + the ISA that runs */
    char said[SAID_MOST];
    if (isa == EMBREE_ISA_OWN)
        return STATUS_OK;
    if (!atomic_load(&known[isa])) {
        enum status status = embree_load(reason);
        if (!status)
            status = ask(isa, said, reason);
        if (status)
            return status;
        atomic_store(&known[isa], 1 + (int)embree_isa_said(said));
    }
    const int runs = atomic_load(&known[isa]) - 1;
    if (runs == (int)isa)
        return STATUS_OK;
    return fail(reason, STATUS_UNSUPPORTED, "Embree: asked for ISA %s, it runs %s",
                embree_isa_words[isa], runs ? embree_isa_words[runs] : "one that it does not name");
}

#endif
