/* raydiff fuzz --self-test: runs the fuzzer on planted bugs. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/fuzz/cmd_selftest.h"

#include "gpu/shaders/spirv_look.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The rarest planted bug shows only in scenes of more than 32,768 triangles. For seeds 1 to 8 the
 * first such trial is the 659th to the 10,358th. This seed's, the 2,458th, is in the middle. */
#define DEFAULT_SEED "2"

static enum status take_choices(void *options, const struct option_value *given,
                                struct reason *reason)
{
    struct selftest_command *c = options;
    for (char *one = strtok(given->text, ","); one; one = strtok(NULL, ",")) {
        if (c->choices == SELFTEST_CHOICE_MOST)
            return fail(reason, STATUS_INPUT, "--only: at most %u", SELFTEST_CHOICE_MOST);
        c->choice[c->choices++] = one;
    }
    return c->choices ? STATUS_OK : fail(reason, STATUS_INPUT, "--only: needs at least one name");
}

#define ROWS_OF struct selftest_command

static const struct option_row rows[] = {
    {"only", "B,..",
     "only these: by bug, by bug and unit as in LOST_SLOT.trace_rf16, by kind, or by engines",
     OF_OWN(take_choices)},
    {"time", "S", "seconds for each", OF_COUNT(seconds, 1, 86400), .value = "60"},
    {"control", "N", "least number of trials of the program without a bug",
     OF_COUNT(control, 1, 1000000), .value = "1024"},
    {"seed", "S", "of the trials", OF_COUNT(seed, 0, UINT64_MAX), .value = DEFAULT_SEED},
    {"jobs", "N", "programs at a time, of one worker each", OF_COUNT(jobs, 1, SELFTEST_JOBS_MOST),
     .shown = "cores"},
    {"programs", "DIR", "where they are", OF_FOLDER(programs),
     .shown = "mutants, beside this program"},
    {"shaders", NULL, "only check that this program's own shaders are pinned",
     OF_FLAG(shaders_only)},
    {"json", "FILE", "results, for machines", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "fuzz",
    .usage = "fuzz --self-test [OPTIONS]",
    .about = "Fuzzes programs into each of which one bug was planted, in one C unit or one shader "
             "of an engine, layout or builder, never in the oracle or the judge, and prints how "
             "many trials and seconds it took until the bug was found. Then the program without a "
             "bug plays the same trials and must find nothing. `make selftest` builds the "
             "programs and runs this.",
    .group = {GROUP(rows)},
    .codes = "0 every bug was found and nothing else, 1 not so, 2 bad input, nothing is built, 4 "
             "internal error",
    .example = "fuzz --self-test --only rounding,LOST_SLOT",
    .makes_folder = true,
};

static bool is_chosen(const struct selftest_command *c, const struct selftest_bug *bug)
{
    for (size_t i = 0; i < c->choices; i++)
        if (selftest_chosen(bug, c->choice[i]))
            return true;
    return c->choices == 0;
}

/* Joins folder and name; false if that is too long. */
static bool join(char path[SELFTEST_PATH_MOST], const char *folder, const char *name)
{
    return (unsigned)snprintf(path, SELFTEST_PATH_MOST, "%s/%s", folder, name) < SELFTEST_PATH_MOST;
}

/* Finds this program and the folder of the programs with bugs. */
static enum status find_folder(struct selftest_command *c, struct reason *reason)
{
    ssize_t length = readlink("/proc/self/exe", c->self, sizeof c->self - 1);
    if (length <= 0)
        return fail(reason, STATUS_INPUT, "the path of this program is unknown; give --programs");
    c->self[length] = '\0';
    char beside[SELFTEST_PATH_MOST];
    memcpy(beside, c->self, sizeof beside);
    char *slash = strrchr(beside, '/');
    if (slash)
        *slash = '\0';
    if (c->programs
            ? (unsigned)snprintf(c->folder, sizeof c->folder, "%s", c->programs) >= sizeof c->folder
            : !join(c->folder, beside, "mutants"))
        return fail(reason, STATUS_INPUT, "the folder's name is too long");
    return STATUS_OK;
}

static enum status add_row(struct selftest_command *c, const struct selftest_bug *bug, bool control,
                           struct reason *reason)
{
    char name[SELFTEST_NAME_MOST + 16];
    struct selftest_row *row = &c->row[c->rows];
    *row = (struct selftest_row){.bug = bug, .control = control};
    selftest_name(bug, name);
    if (control)
        (void)snprintf(name, sizeof name, "control.%s.%s", bug->engines, bug->layouts);
    if (!join(row->folder, c->folder, name) || !join(row->program, row->folder, "raydiff"))
        return fail(reason, STATUS_INPUT, "the folder's name is too long");
    if (control)
        memcpy(row->program, c->self, sizeof row->program);
    else if (access(row->program, X_OK) != 0)
        return fail(reason, STATUS_INPUT,
                    "%s is not built: type `make selftest` (or `make planted`)", name);
    row->job = (struct selftest_job){.program = row->program,
                                     .folder = row->folder,
                                     .engines = bug->engines,
                                     .layouts = bug->layouts,
                                     .seed = c->seed,
                                     .seconds = c->seconds};
    c->rows++;
    return STATUS_OK;
}

static bool same_field(const struct selftest_bug *a, const struct selftest_bug *b)
{
    return strcmp(a->engines, b->engines) == 0 && strcmp(a->layouts, b->layouts) == 0;
}

/* Adds a row for each chosen bug and a control for each field that they are played in. */
static enum status make_rows(struct selftest_command *c, struct reason *reason)
{
    c->row = alloc_zeroed(2 * c->bugs, sizeof *c->row);
    if (!c->row)
        return fail(reason, STATUS_MEMORY, "no memory for %zu programs", c->bugs);
    enum status status = STATUS_OK;
    for (size_t i = 0; i < c->bugs && !status; i++)
        if (is_chosen(c, &c->bug[i]))
            status = add_row(c, &c->bug[i], false, reason);
    c->planted = c->rows;
    for (size_t i = 0; i < c->planted && !status; i++) {
        bool there = false;
        for (size_t k = c->planted; k < c->rows; k++)
            there = there || same_field(c->row[k].bug, c->row[i].bug);
        if (!there)
            status = add_row(c, c->row[i].bug, true, reason);
    }
    if (!status && c->planted == 0)
        status = fail(reason, STATUS_INPUT, "--only: no bug is '%.100s'", c->choice[0]);
    return status;
}

/* A control plays at least as many trials as the bugs of its field needed. */
static void set_control(const struct selftest_command *c, struct selftest_row *row)
{
    row->job.trials = c->control;
    for (size_t i = 0; i < c->planted; i++)
        if (same_field(c->row[i].bug, row->bug) && c->row[i].job.result.trials > row->job.trials)
            row->job.trials = c->row[i].job.result.trials;
}

/* Starts the next row; false: none can be started now. */
static bool start_next(struct selftest_command *c, size_t running, enum status *status,
                       struct reason *reason)
{
    size_t ended = 0;
    if (running >= c->jobs)
        return false;
    for (size_t i = 0; i < c->rows; i++) {
        struct selftest_row *row = &c->row[i];
        if (!row->started) {
            if (row->control && ended < c->planted)
                return false; /* controls start after all bugs */
            if (row->control)
                set_control(c, row);
            row->started = true;
            *status = selftest_start(&row->job, reason);
            return *status == STATUS_OK;
        }
        ended += row->ended;
    }
    return false;
}

static void show_progress(const struct selftest_command *c)
{
    size_t ended = 0;
    const char *sign = "";
    if (!c->terminal)
        return;
    for (size_t i = 0; i < c->rows; i++)
        ended += c->row[i].ended;
    fprintf(stderr, "\r\033[K%zu of %zu done:", ended, c->rows);
    for (size_t i = 0; i < c->rows; i++)
        if (c->row[i].started && !c->row[i].ended) {
            const char *name = strrchr(c->row[i].folder, '/');
            fprintf(stderr, "%s %s", sign, name ? name + 1 : "");
            sign = ",";
        }
    fflush(stderr);
}

static void wipe_progress(const struct selftest_command *c)
{
    if (c->terminal)
        fputs("\r\033[K", stderr);
}

/* Runs all rows, c->jobs at a time. */
static enum status run_rows(struct selftest_command *c, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (;;) {
        struct selftest_job *running[SELFTEST_JOBS_MOST];
        size_t count = 0;
        for (size_t i = 0; i < c->rows; i++)
            if (c->row[i].started && !c->row[i].ended)
                running[count++] = &c->row[i].job;
        if (!status && start_next(c, count, &status, reason))
            continue;
        if (status || count == 0)
            break;
        show_progress(c);
        selftest_wait(running, count, 500);
        for (size_t i = 0; i < c->rows && !status; i++)
            if (c->row[i].started && !c->row[i].ended)
                c->row[i].ended = selftest_ended(&c->row[i].job, &status, reason);
        wipe_progress(c);
        selftest_print_rows(c);
    }
    for (size_t i = 0; i < c->rows; i++)
        if (c->row[i].started && !c->row[i].ended)
            selftest_stop(&c->row[i].job);
    return status;
}

static enum status run(struct selftest_command *c, struct selftest_sum *sum, struct reason *reason)
{
    char table[SELFTEST_PATH_MOST];
    enum status status = find_folder(c, reason);
    if (!status && (!join(table, c->folder, "selftest.txt") || access(table, R_OK) != 0))
        status =
            fail(reason, STATUS_INPUT,
                 "no planted bugs in %.150s: type `make selftest` in raydiff's sources", c->folder);
    if (!status)
        status = selftest_read(table, &c->bug, &c->bugs, reason);
    if (!status)
        status = make_rows(c, reason);
    if (status)
        return status;
    selftest_print_head();
    status = run_rows(c, reason);
    *sum = selftest_sum(c);
    if (!status)
        selftest_print_sum(sum);
    if (!status && c->json)
        status = selftest_json(c, sum, reason);
    return status;
}

/* Checks programs with a mutated shader. No run can show a lost decoration, since the drivers here
 * never contract. */
static int check_shaders(void)
{
    struct reason reason;
    enum status status = spirv_check_tracing(&reason);
    if (!status)
        puts("shaders: all float operations of the tracing shaders are pinned");
    else
        printf("%s\n", reason.text);
    return status == STATUS_OK         ? EXIT_AGREE
           : status == STATUS_INTERNAL ? EXIT_MISMATCH
                                       : exit_of_status(status);
}

int cmd_selftest(int argc, char **argv)
{
    static struct selftest_command c;
    struct selftest_sum sum = {0};
    struct reason reason = {""};
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    c = (struct selftest_command){.terminal = isatty(STDERR_FILENO) == 1, .start_ns = time_ns()};
    c.jobs = cores < 1 ? 1 : cores > SELFTEST_JOBS_MOST ? SELFTEST_JOBS_MOST : (unsigned)cores;
    int first, code = options_read(&set, &c, argc, argv, &first);
    if (code < 0 && first < argc)
        code = usage_error("fuzz", "'%s': only options are expected", argv[first]);
    const struct option_use use = {
        .by = "--shaders", .never = c.shaders_only ? "only time seed jobs programs json" : ""};
    if (code < 0)
        code = options_refused("fuzz", &use);
    if (code >= 0)
        return code;
    if (c.shaders_only)
        return check_shaders();
    enum status status = run(&c, &sum, &reason);
    code = exit_with_reason("fuzz", status, &reason);
    free(c.bug);
    free(c.row);
    return status || selftest_passed(&sum) ? code : EXIT_MISMATCH;
}
