#define _POSIX_C_SOURCE 200809L /* fdopen, strdup */
#include "cmd/common/cmd_options.h"

#include "ref/base/command.h"
#include "ref/base/text.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The former standard output, once an option has "-" as its file. */
static FILE *aside;

enum status output_aside(struct reason *reason)
{
    if (aside)
        return fail(reason, STATUS_INPUT, "--csv and --json cannot both be '-'");
    fflush(stdout);
    int kept = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    aside = kept < 0 ? NULL : fdopen(kept, "w");
    if (aside && dup2(STDERR_FILENO, STDOUT_FILENO) >= 0)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "-: cannot write to the standard output");
}

enum status options_out(const char *path, struct file_out *out, struct reason *reason)
{
    if (strcmp(path, "-") != 0)
        return file_out_open(path, out, reason);
    *out = (struct file_out){.stream = aside, .path = strdup("the standard output")};
    aside = NULL;
    if (out->stream && out->path)
        return STATUS_OK;
    file_out_discard(out);
    return fail(reason, STATUS_INPUT, "-: cannot write to the standard output");
}

enum status output_try(const char *path, struct reason *reason)
{
    struct file_out out;
    struct stat what;
    if (!path || strcmp(path, "-") == 0 ||
        (stat(path, &what) == 0 && !S_ISREG(what.st_mode) && !S_ISDIR(what.st_mode)))
        return STATUS_OK; /* opening a pipe would end its reader's input */
    enum status status = file_out_open(path, &out, reason);
    file_out_discard(&out);
    return status;
}

#define GIVEN_MOST   128 /* more than any command has */
#define OUTPUTS_MOST 16

/* Names from a table, which outlives the command. */
static const char *given[GIVEN_MOST];
static size_t given_count;

/* The named outputs. They are tried after all options are known to be right. */
static struct output {
    const char *name; /* of the option */
    const char *path;
    bool tried;
} outputs[OUTPUTS_MOST];
static size_t output_count;

void options_begin(void)
{
    given_count = output_count = 0;
}

const char *option_given(size_t i)
{
    return i < given_count ? given[i] : NULL;
}

bool option_was_given(const char *name)
{
    for (size_t i = 0; i < given_count; i++)
        if (strcmp(given[i], name) == 0)
            return true;
    return false;
}

enum status option_note(const char *name, bool repeats, struct reason *reason)
{
    if (option_was_given(name))
        return repeats ? STATUS_OK : fail(reason, STATUS_INPUT, "--%s: is given twice", name);
    if (given_count < GIVEN_MOST)
        given[given_count++] = name;
    return STATUS_OK;
}

void output_note(const char *name, const char *path, bool tried)
{
    if (path && output_count < OUTPUTS_MOST)
        outputs[output_count++] = (struct output){name, path, tried};
}

static const char *without_here(const char *path)
{
    while (strncmp(path, "./", 2) == 0)
        path += 2 + strspn(path + 2, "/");
    return path;
}

/* True if the later output would take the place of the earlier one. */
static bool is_same_file(const char *a, const char *b)
{
    struct stat of_a, of_b;
    const bool there = stat(a, &of_a) == 0 && stat(b, &of_b) == 0;
    if (there)
        return S_ISREG(of_a.st_mode) && of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
    return strcmp(without_here(a), without_here(b)) == 0;
}

enum status outputs_apart(struct reason *reason)
{
    for (size_t i = 0; i < output_count; i++)
        for (size_t k = 0; k < i; k++)
            if (strcmp(outputs[i].path, "-") != 0 && is_same_file(outputs[k].path, outputs[i].path))
                return fail(reason, STATUS_INPUT, "--%s and --%s: both would be written to %s",
                            outputs[k].name, outputs[i].name, outputs[i].path);
    return STATUS_OK;
}

static bool is_output(const char *word)
{
    const char *value = strncmp(word, "--", 2) == 0 ? strchr(word, '=') : NULL;
    for (size_t i = 0; i < output_count; i++)
        if (strcmp(outputs[i].path, value ? value + 1 : word) == 0)
            return true;
    return false;
}

enum status outputs_can_tell(int argc, char *const *argv, struct reason *reason)
{
    static const char *const telling[] = {"json", "jsonl", "junit"};
    const char *option = NULL;
    for (size_t i = 0; i < ARRAY_COUNT(telling) && !option; i++)
        if (option_was_given(telling[i]))
            option = telling[i];
    for (int i = 1; i < argc && option; i++)
        if (!utf8_is_text(argv[i]) && !is_output(argv[i]))
            return fail(reason, STATUS_INPUT,
                        "%s: a name that is not UTF-8 cannot be written by --%s", argv[i], option);
    return STATUS_OK;
}

enum status outputs_try(struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < output_count && !status; i++)
        if (outputs[i].tried)
            status = output_try(outputs[i].path, reason);
    return status;
}

int option_error(const char *command, enum status status, const struct reason *reason)
{
    if (status == STATUS_UNSUPPORTED)
        return exit_with_reason(command, status, reason);
    int code = usage_error(command, "%s", reason->text);
    return status == STATUS_DEVICE ? EXIT_ENGINE : code;
}
