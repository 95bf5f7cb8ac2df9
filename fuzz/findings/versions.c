#include "fuzz/findings/versions.h"

#include <stdio.h>
#include <string.h>

/* The line that names what the engine runs on. */
static void first_line(const struct engine *engine, const struct engine_options *options,
                       char line[160])
{
    char what[2048] = "";
    engine_describe(engine, options, what, sizeof what);
    const char *from = what + strspn(what, " \t\n");
    snprintf(line, 160, "%.*s", (int)strcspn(from, "\n"), from);
    char *threads = strrchr(line, ','); /* how many there are is no version */
    if (threads && strstr(threads, " threads"))
        *threads = '\0';
}

void fuzz_versions(const struct engine *const *engine, size_t count,
                   const struct engine_options *options, char *text, size_t text_bytes)
{
    size_t used = (size_t)snprintf(text, text_bytes, "raydiff %s", RAYDIFF_VERSION);
    for (size_t i = 0; i < count; i++) {
        char what[160], line[240];
        if (engine[i]->reference)
            continue;
        first_line(engine[i], options, what);
        if (what[0] && strstr(text, what))
            continue;
        size_t length = (size_t)snprintf(line, sizeof line, "\n%.60s: %s", engine[i]->name, what);
        if (used + length + 1 > text_bytes)
            return; /* no half lines */
        memcpy(text + used, line, length + 1);
        used += length;
    }
}
