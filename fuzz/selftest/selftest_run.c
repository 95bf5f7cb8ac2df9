/* Running the programs of the self-test, and what they found. */
#define _XOPEN_SOURCE 700
#include "fuzz/selftest/selftest.h"

#include "fuzz/findings/findings.h"
#include "ref/base/command.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <glob.h>
#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Beyond its time limit a program opens its engines, explains, and ends. */
#define GRACE_MS 60000u
#define STOP_NS  2000000000u  /* for a campaign to end by itself after its first finding */
#define MANY     "1000000000" /* trials: named, so that they are the stream `gen` alone */
static const char drawn_prefix[] = "pairs:";  /* of engines whose other members are drawn */
static const char world_prefix[] = "worlds:"; /* of engines that trace worlds */
#define TRIAL_S "2" /* an engine's time: a bug that hangs costs it several times over */

static bool is_check(const struct selftest_job *job)
{
    return strcmp(job->engines, "spirv") == 0;
}

static int remove_one(const char *path, const struct stat *stat, int type, struct FTW *ftw)
{
    (void)stat;
    (void)type;
    (void)ftw;
    return remove(path);
}

static enum status clear_folder(struct selftest_job *job, struct reason *reason)
{
    if ((unsigned)snprintf(job->found, sizeof job->found, "%s/found", job->folder) >=
            sizeof job->found ||
        (unsigned)snprintf(job->report, sizeof job->report, "%s/report.json", job->folder) >=
            sizeof job->report ||
        (unsigned)snprintf(job->log, sizeof job->log, "%s/log", job->folder) >= sizeof job->log)
        return fail(reason, STATUS_INPUT, "%.100s...: the name is too long", job->folder);
    if (mkdir(job->folder, 0777) != 0 && errno != EEXIST)
        return fail(reason, STATUS_INPUT, "%s: %s", job->folder, strerror(errno));
    if (nftw(job->found, remove_one, 8, FTW_DEPTH | FTW_PHYS) != 0 && errno != ENOENT)
        return fail(reason, STATUS_INPUT, "%s: %s", job->found, strerror(errno));
    if (unlink(job->report) != 0 && errno != ENOENT)
        return fail(reason, STATUS_INPUT, "%s: %s", job->report, strerror(errno));
    return STATUS_OK;
}

/* What follows the prefix; NULL: the text has another beginning. */
static const char *behind(const char *text, const char *prefix)
{
    return strncmp(text, prefix, strlen(prefix)) == 0 ? text + strlen(prefix) : NULL;
}

/* In the child: becomes the program, its output in the log. The pipe stays open, so that the parent
 * sees when the program ends. */
static void become(struct child *parent, void *user)
{
    const struct selftest_job *job = user;
    char seed[24], trials[24], seconds[24];
    int log = open(job->log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    (void)snprintf(seed, sizeof seed, "%llu", (unsigned long long)job->seed);
    (void)snprintf(trials, sizeof trials, "%llu", (unsigned long long)job->trials);
    (void)snprintf(seconds, sizeof seconds, "%u", job->seconds);
    const char *argv[32] = {job->program, "fuzz"};
    size_t count = 2;
    if (is_check(job)) {
        argv[count++] = "--self-test";
        argv[count++] = "--shaders";
    } else {
        const char *drawn = behind(job->engines, drawn_prefix);
        const char *worlds = behind(job->engines, world_prefix);
        const char *const always[][2] = {{"--seed", seed},
                                         {"--engine", drawn    ? drawn
                                                      : worlds ? worlds
                                                               : job->engines},
                                         {"--layout", job->layouts},
                                         {"--dir", job->found},
                                         {"--json", job->report},
                                         {"--jobs", "1"},
                                         {"--corpus", "none"},
                                         {"--trial-time", TRIAL_S},
                                         {"--trials", job->trials ? trials : MANY}};
        const char *const hunt[][2] = {{"--time", seconds}, {"--until", "1"}};
        argv[count++] = "--no-shrink";
        memcpy(argv + count, always, sizeof always);
        count += sizeof always / sizeof argv[0];
        if (!job->trials)
            memcpy(argv + count, hunt, sizeof hunt);
        count += job->trials ? 0 : sizeof hunt / sizeof argv[0];
        if (drawn) {
            argv[count++] = "--pairs";
            argv[count++] = "1";
        }
        if (worlds)
            argv[count++] = "--worlds";
    }
    setenv("LP_NUM_THREADS", "0", 0);
    if (log >= 0 && dup2(log, 1) == 1 && dup2(log, 2) == 2 && fcntl(parent->file, F_SETFD, 0) == 0)
        execv(job->program, (char *const *)(uintptr_t)argv);
    _exit(127);
}

enum status selftest_start(struct selftest_job *job, struct reason *reason)
{
    enum status status = clear_folder(job, reason);
    job->result = (struct selftest_result){.end = SELFTEST_FAILED};
    job->start_ns = time_ns();
    return status ? status : child_start(become, job, &job->child, reason);
}

void selftest_wait(struct selftest_job *const *job, size_t count, uint32_t ms)
{
    struct child *child[CHILDREN_MOST];
    size_t used = 0;
    for (size_t i = 0; i < count && used < CHILDREN_MOST; i++)
        if (job[i])
            child[used++] = &job[i]->child;
    child_wait(child, used, ms);
}

/* A line of the program's output: the first, or the last that is not empty. */
static void read_said(struct selftest_job *job, bool first)
{
    char line[SELFTEST_SAID_MOST];
    FILE *log = fopen(job->log, "re");
    while (log && fgets(line, sizeof line, log)) {
        line[strcspn(line, "\n")] = '\0';
        if (!line[0])
            continue;
        memcpy(job->result.said, line, sizeof line);
        if (first)
            break;
    }
    if (log)
        fclose(log);
}

/* True if the program reports a finding that counts: a new one, which shows again. */
static bool one_counts(const struct selftest_job *job)
{
    json_t *root = json_load_file(job->report, 0, NULL), *one;
    size_t i;
    bool counts = false;
    json_array_foreach(json_object_get(root, "findings"), i, one)
    {
        const char *state = json_string_value(json_object_get(one, "state"));
        counts = counts || (state && strcmp(state, "new") == 0);
    }
    json_decref(root);
    return counts;
}

/* The finding of the lowest trial, if there is one and one counts. */
static enum status look(struct selftest_job *job, struct reason *reason)
{
    bool counts = job->trials || one_counts(job); /* without a bug any is too many */
    struct findings *findings = NULL;
    const struct findings_entry *best = NULL;
    enum status status = findings_look(job->found, &findings, reason);
    if (status == STATUS_INPUT) {
        (void)snprintf(job->result.said, sizeof job->result.said, "%.250s", reason->text);
        return STATUS_OK;
    }
    if (status)
        return status;
    for (size_t i = 0; i < findings_count(findings) && counts; i++) {
        const struct findings_entry *entry = findings_entry(findings, i);
        if (!best || findings_order_compare(&entry->first, &best->first) < 0)
            best = entry;
    }
    job->result.end = best ? SELFTEST_FOUND : SELFTEST_CLEAN;
    job->result.trials = job->trials;
    if (best) {
        char text[FUZZ_SIGNATURE_MOST];
        fuzz_signature_print(&best->signature, text);
        (void)snprintf(job->result.said, sizeof job->result.said, "%s", text);
        job->result.trials = best->first.index + 1;
    }
    findings_close(findings);
    return STATUS_OK;
}

static enum status conclude(struct selftest_job *job, const struct child_fate *fate,
                            struct reason *reason)
{
    struct selftest_result *result = &job->result;
    bool fine = !fate->forced && !fate->signal;
    if (fine && fate->code == EXIT_SKIPPED) {
        result->end = SELFTEST_SKIPPED;
        read_said(job, false);
    } else if (fine && is_check(job) && fate->code <= EXIT_MISMATCH) {
        result->end = fate->code ? SELFTEST_FOUND : SELFTEST_CLEAN;
        read_said(job, true);
    } else if (fine && !is_check(job) &&
               (fate->code <= EXIT_MISMATCH || (job->stopping && fate->code == 128 + SIGTERM))) {
        return look(job, reason);
    } else {
        char said[SELFTEST_SAID_MOST];
        read_said(job, false);
        (void)snprintf(said, sizeof said, "%s: %.150s", fate->text, result->said);
        memcpy(result->said, said, sizeof said);
    }
    return STATUS_OK;
}

/* Ends a campaign soon after its first finding, even if it shows only among other trials: the
 * campaign still plays it again and reports whether it shows. */
static void stop_soon(struct selftest_job *job)
{
    char pattern[SELFTEST_PATH_MOST + 16];
    glob_t files;
    if (job->trials || job->stopping || is_check(job))
        return;
    (void)snprintf(pattern, sizeof pattern, "%s/*/first.trial", job->found);
    if (glob(pattern, GLOB_NOSORT, NULL, &files) == 0) {
        job->stopping = job->seen_ns && time_ns() - job->seen_ns > STOP_NS;
        job->seen_ns = job->seen_ns ? job->seen_ns : time_ns();
        if (job->stopping)
            kill(job->child.pid, SIGTERM);
        globfree(&files);
    }
}

bool selftest_ended(struct selftest_job *job, enum status *status, struct reason *reason)
{
    struct child_fate fate;
    const void *bytes;
    size_t size;
    uint64_t ns = time_ns() - job->start_ns;
    *status = STATUS_OK;
    stop_soon(job);
    bool late = !job->trials && ns / 1000000u > (uint64_t)job->seconds * 1000u + GRACE_MS;
    if (!late && child_receive(&job->child, 0, 0, &bytes, &size) == CHILD_LATE)
        return false;
    child_end(&job->child, late ? 0 : GRACE_MS, &fate);
    job->result.seconds = (double)(time_ns() - job->start_ns) * 1e-9;
    *status = conclude(job, &fate, reason);
    return true;
}

void selftest_stop(struct selftest_job *job)
{
    child_end(&job->child, 0, NULL);
}
