/* Every system call of campaigns, merges, checks, reports and others fails once, in every way that
 * it can: nothing that was found may be lost, and the same command, run again, must end as if
 * nothing had been. CONTRIBUTING.md, "Faults", has what is checked. */
#define _GNU_SOURCE
#include "tests/faults/scenarios.h"
#include "tests/faults/faults_traced.h"
#include "tests/faults/faults_trees.h"

#include <errno.h>
#include <fcntl.h>
#include <fnmatch.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#define SECONDS     60u /* that a run may take: a campaign of 20 trials takes less than one */
#define WORDS_MOST  40
#define FAULTS_MOST 65536
#define CODES_MOST  256
#define SHOWN_MOST  20

struct faults_task {
    struct traced_place place;
    int kind;
};

/* What a worker found, shared. */
struct faults_tally {
    atomic_uint next, played, missed, lost, code[CODES_MOST];
};

struct faults_job {
    const struct scenario *scenario;
    const char *program, *root;
    struct faults_task *task;
    unsigned count;
    struct faults_tally *tally;
    int wanted;    /* the exit code without a fault */
    bool nameless; /* where this plays, files need no name before they are whole */
};

static void path_in(char *path, const char *root, const char *name)
{
    snprintf(path, TREES_PATH_MOST, "%s/%s", root, name);
}

/* Runs a command line in a folder. */
static struct traced_result run(const char *program, const char *line, const char *in,
                                const char *logs, const struct faults_task *task, traced_fn *each,
                                void *user)
{
    char words[1024], out[TREES_PATH_MOST], err[TREES_PATH_MOST], *argv[WORDS_MOST], *rest;
    int count = 0;
    snprintf(words, sizeof words, "%s", line);
    argv[count++] = (char *)(uintptr_t)program;
    for (char *word = strtok_r(words, " ", &rest); word && count < WORDS_MOST - 1;
         word = strtok_r(NULL, " ", &rest))
        argv[count++] = word;
    argv[count] = NULL;
    path_in(out, logs, "out");
    path_in(err, logs, "err");
    return traced_run(argv, in, out, err, task ? &task->place : NULL, task ? task->kind : 0,
                      SECONDS, each, user);
}

/* Codes that the commands document. */
static bool is_documented(int code, int kind)
{
    return (code >= 0 && code <= 4) || code == 77 || (kind == FAULT_KILL && code == 128 + 9);
}

/* Whether a temporary file may be left: by a process that is killed, until the command is run
 * again. One that is killed while what it makes has a temporary name: where a file is about to take
 * the place of another, and a merge all the time. */
static bool may_leave(const struct faults_job *job, const struct faults_task *task)
{
    return task->kind == FAULT_KILL &&
           (!job->nameless || (job->scenario->goal && !job->scenario->page) ||
            traced_calls[task->place.call].number == SYS_renameat);
}

/* Plays one fault in `work`, a copy of what the command starts from. NULL: nothing is wrong. */
static const char *play(const struct faults_job *job, const struct faults_task *task,
                        const char *work, const char *logs, char why[TREES_WHY_MOST])
{
    const struct scenario *s = job->scenario;
    char wanted[TREES_PATH_MOST], after[TREES_PATH_MOST], found[TREES_PATH_MOST];
    char kept[TREES_PATH_MOST];
    path_in(wanted, job->root, "wanted");
    path_in(after, logs, "after");
    path_in(found, work, "found");
    path_in(kept, after, "found");
    struct traced_result result = run(job->program, s->command, work, logs, task, NULL, NULL);
    why[0] = '\0';
    if (!result.reached) {
        atomic_fetch_add(&job->tally->missed, 1);
        return NULL;
    }
    atomic_fetch_add(&job->tally->code[result.code < 0 ? 255 : result.code & 255], 1);
    if (result.code < 0)
        return "it took too long";
    if (!is_documented(result.code, task->kind)) {
        snprintf(why, TREES_WHY_MOST, "exit code %d", result.code);
        return "no documented exit code";
    }
    if (result.code >= 2 && result.code < 128 && tree_file_size(logs, "err") <= 0 &&
        !tree_file_holds(logs, "out", "failed: ") && !(s->page && tree_has(work, s->goal)))
        return "it fails and does not say why";
    if ((task->kind == FAULT_SHORT || task->kind == EINTR) && result.code != job->wanted) {
        snprintf(why, TREES_WHY_MOST, "exit code %d", result.code);
        return "an interrupted or partial call is not resumed";
    }
    if (!tree_is_whole(work, false, why))
        return "a file is torn";
    if (!may_leave(job, task) && !tree_is_whole(work, true, why))
        return "a temporary file is left";
    if (task->kind != FAULT_KILL && !tree_is_empty(getenv("TMPDIR")) &&
        !tree_file_holds(logs, "err", "cannot be removed"))
        return "something is left in the folder for temporary files";
    if (result.code == job->wanted &&
        !(s->page && tree_file_holds(logs, "err", " is not known: ")) &&
        !tree_same(wanted, work, why))
        return "it says that all went well";
    if (!tree_remove(after) || !tree_copy(work, after))
        return "no room to check";
    if (!s->goal || !tree_has(work, s->goal) || s->page) {
        result = run(job->program, s->command, work, logs, NULL, NULL, NULL);
        if (result.code != job->wanted) {
            snprintf(why, TREES_WHY_MOST, "exit code %d", result.code);
            return "it cannot be run again";
        }
    }
    if (!s->goal && !tree_keeps(kept, found, why))
        return "lost";
    if (!tree_is_whole(work, true, why))
        return "run again, it leaves a temporary file";
    if (!tree_is_empty(getenv("TMPDIR")))
        return "run again, it leaves something in the folder for temporary files";
    return tree_same(wanted, work, why) ? NULL : "run again, it ends otherwise";
}

static void tell(const struct faults_job *job, const struct faults_task *task, const char *what,
                 const char *why, const char *logs)
{
    char path[TREES_PATH_MOST], said[400] = "";
    path_in(path, logs, "err");
    FILE *file = fopen(path, "r");
    if (file) {
        said[fread(said, 1, sizeof said - 1, file)] = '\0';
        fclose(file);
    }
    said[strcspn(said, "\n")] = '\0';
    printf("LOST    %s %d:%s:%u:%s: %s%s%s%s%s\n", job->scenario->name, task->place.process,
           traced_calls[task->place.call].name, task->place.occurrence, fault_name(task->kind),
           what, why[0] ? ": " : "", why, said[0] ? "; it says: " : "", said);
    fflush(stdout);
}

/* One of those who play the faults. */
static void work(const struct faults_job *job, unsigned number)
{
    char own[TREES_PATH_MOST], folder[TREES_PATH_MOST], start[TREES_PATH_MOST];
    char temporary[TREES_PATH_MOST], name[32], why[TREES_WHY_MOST];
    snprintf(name, sizeof name, "worker%u", number);
    path_in(own, job->root, name);
    path_in(folder, own, "work");
    path_in(temporary, own, "tmp");
    path_in(start, job->root, "start");
    mkdir(own, 0777);
    setenv("TMPDIR", temporary, 1);
    for (;;) {
        unsigned at = atomic_fetch_add(&job->tally->next, 1);
        if (at >= job->count)
            return;
        const struct faults_task *task = &job->task[at];
        const char *what = "no room to play";
        why[0] = '\0';
        if (tree_remove(folder) && tree_remove(temporary) && mkdir(temporary, 0777) == 0 &&
            tree_copy(start, folder))
            what = play(job, task, folder, own, why);
        atomic_fetch_add(&job->tally->played, 1);
        if (what && atomic_fetch_add(&job->tally->lost, 1) < SHOWN_MOST)
            tell(job, task, what, why, own);
    }
}

/* --- which faults there are ------------------------------------------------------------------- */

struct faults_listing {
    struct faults_task *task;
    unsigned count, calls;
    int processes;
};

static void list(void *user, const struct traced_place *place)
{
    struct faults_listing *l = user;
    if (l->processes && place->process >= l->processes)
        return;
    const struct traced_call *call = &traced_calls[place->call];
    l->calls++;
    for (int i = 0; i < FAULT_KINDS_MOST && call->kinds[i]; i++)
        if (l->count < FAULTS_MOST && (call->kinds[i] != FAULT_SHORT || place->counts) &&
            (call->kinds[i] != EINTR || call->number != SYS_write || !place->standard))
            l->task[l->count++] = (struct faults_task){*place, call->kinds[i]};
    if (place->process == 0 && l->count < FAULTS_MOST)
        l->task[l->count++] = (struct faults_task){*place, FAULT_KILL};
}

/* Of each kind of call in each process the first and every `step`-th, in each of its ways; of these
 * those whose names, "PROCESS:CALL:OCCURRENCE:KIND", match the pattern, if there is one. */
static void choose(struct faults_listing *l, const char *pattern, unsigned step)
{
    unsigned kept = 0;
    for (unsigned i = 0; i < l->count; i++) {
        const struct faults_task *task = &l->task[i];
        char name[100];
        snprintf(name, sizeof name, "%d:%s:%u:%s", task->place.process,
                 traced_calls[task->place.call].name, task->place.occurrence,
                 fault_name(task->kind));
        if (task->place.occurrence % step == 0 && (!pattern || fnmatch(pattern, name, 0) == 0))
            l->task[kept++] = *task;
    }
    l->count = kept;
}

static bool prepare(struct faults_job *job, struct faults_listing *l)
{
    char start[TREES_PATH_MOST], wanted[TREES_PATH_MOST], counted[TREES_PATH_MOST];
    path_in(start, job->root, "start");
    path_in(wanted, job->root, "wanted");
    path_in(counted, job->root, "counted");
    mkdir(start, 0777);
    for (size_t i = 0; i < sizeof job->scenario->before / sizeof *job->scenario->before; i++) {
        const char *line = job->scenario->before[i];
        if (line && run(job->program, line, start, job->root, NULL, NULL, NULL).code > 1)
            return false;
    }
    if (!tree_copy(start, wanted) || !tree_copy(start, counted))
        return false;
    job->wanted =
        run(job->program, job->scenario->command, wanted, job->root, NULL, NULL, NULL).code;
    char why[TREES_WHY_MOST] = "";
    struct traced_result result =
        run(job->program, job->scenario->command, counted, job->root, NULL, list, l);
    if (result.refused) {
        puts("SKIP faults: here no process may trace another (ptrace)");
        exit(77);
    }
    if (job->wanted < 0 || job->wanted > 1 || result.code != job->wanted ||
        !tree_same(wanted, counted, why) || !tree_is_whole(wanted, true, why)) {
        printf("faults: %s does not do the same twice: exit codes %d and %d; %s\n",
               job->scenario->name, job->wanted, result.code, why);
        return false;
    }
    return true;
}

static void print_row(const struct faults_job *job, const struct faults_listing *l, unsigned every,
                      unsigned *faults, unsigned *lost)
{
    unsigned missed = atomic_load(&job->tally->missed);
    *faults += l->count - missed;
    *lost += atomic_load(&job->tally->lost);
    printf("%-8s %6u %6u %7u %8u %5u  ", job->scenario->name, l->calls, every, l->count - missed,
           missed, atomic_load(&job->tally->lost));
    for (int code = 0; code < CODES_MOST; code++)
        if (atomic_load(&job->tally->code[code]))
            printf(" %d: %u", code, atomic_load(&job->tally->code[code]));
    putchar('\n');
    fflush(stdout);
}

struct options {
    const char *scenario, *only;
    unsigned step, jobs;
    bool quick;
    char program[TREES_PATH_MOST];
};

static bool take_options(struct options *o, int argc, char **argv)
{
    *o = (struct options){.step = 1, .jobs = 8};
    for (int option; (option = getopt(argc, argv, "s:n:o:j:q")) != -1;) {
        if (option == 's')
            o->step = (unsigned)strtoul(optarg, NULL, 10);
        else if (option == 'n')
            o->scenario = optarg;
        else if (option == 'q') /* little of what takes long */
            o->quick = true;
        else if (option == 'o')
            o->only = optarg;
        else if (option == 'j')
            o->jobs = (unsigned)strtoul(optarg, NULL, 10);
        else
            return false;
    }
    return optind + 1 == argc && o->step > 0 && o->jobs > 0 && realpath(argv[optind], o->program);
}

/* False: it could not be played. */
static bool play_scenario(const struct options *o, const struct scenario *scenario,
                          const char *root, unsigned *faults, unsigned *lost)
{
    char own[TREES_PATH_MOST];
    const bool sampled = o->quick && scenario->sample;
    const bool all = o->step == 1 && !o->only;
    const unsigned every = sampled ? 6 : all && scenario->every ? scenario->every : o->step;
    struct faults_listing l = {.task = calloc(FAULTS_MOST, sizeof *l.task),
                               .processes = scenario->processes};
    struct faults_job job = {.scenario = scenario,
                             .program = o->program,
                             .root = own,
                             .nameless = tree_takes_nameless(root)};
    path_in(own, root, scenario->name);
    mkdir(own, 0777);
    job.tally =
        mmap(NULL, sizeof *job.tally, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (!l.task || job.tally == MAP_FAILED || !prepare(&job, &l))
        return false;
    choose(&l, sampled ? scenario->sample : o->only, every);
    job.task = l.task;
    job.count = l.count;
    fflush(stdout);
    for (unsigned k = 0; k < o->jobs; k++)
        if (fork() == 0) {
            work(&job, k);
            _exit(0);
        }
    while (wait(NULL) > 0)
        continue;
    if (atomic_load(&job.tally->played) != l.count) {
        printf("faults: %s: only %u of %u were played\n", scenario->name,
               atomic_load(&job.tally->played), l.count);
        ++*lost;
    }
    print_row(&job, &l, every, faults, lost);
    tree_remove(own);
    free(l.task);
    return true;
}

int main(int argc, char **argv)
{
    unsigned faults = 0, lost = 0;
    char root[64];
    struct options options;
    if (!take_options(&options, argc, argv)) {
        fputs("usage: faults [-q] [-s STEP] [-n COMMAND] [-o PATTERN] [-j JOBS] PROGRAM\n", stderr);
        return 2;
    }
    snprintf(root, sizeof root, "%s/raydiff-faults-XXXXXX",
             access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm");
    if (!mkdtemp(root))
        return 4;
    setenv("OMP_NUM_THREADS", "1", 1);
    setenv("VK_DRIVER_FILES", "/dev/null", 1); /* engine cpu alone plays */
    setenv("VK_ICD_FILENAMES", "/dev/null", 1);
    puts("command   calls  every  faults  not met  lost   exit codes: how often");
    for (size_t i = 0; i < scenario_count; i++)
        if (!options.scenario || strcmp(options.scenario, scenarios[i].name) == 0)
            if (!play_scenario(&options, &scenarios[i], root, &faults, &lost)) {
                tree_remove(root);
                return 4;
            }
    tree_remove(root);
    printf("faults: %u injected, %u lost\n", faults, lost);
    return lost > 0 || faults == 0;
}
