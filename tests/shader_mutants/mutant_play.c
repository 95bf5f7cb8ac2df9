#define _GNU_SOURCE
#include "tests/shader_mutants/mutant_play.h"

#include "gpu/shaders/compiler_tools.h"
#include "gpu/shaders/spirv_look.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define SILENT_MS 25000 /* of a case, with the compiling of its pipeline */

/* --- the process ------------------------------------------------------------------------------ */

enum { SAYS_BEGINS, SAYS_RESULT, SAYS_END, SAYS_NO_DEVICE };

struct mutant_message {
    int32_t what, result;
    uint32_t at; /* in the order of play */
};

/* Of the module: the device's compiler puts the mutant in place of the shader. */
struct mutant_swap {
    const uint32_t *from, *to;
    size_t count;
};

static enum status swap_module(void *user, struct vk_shader *shader, struct reason *reason)
{
    const struct mutant_swap *swap = user;
    (void)reason;
    if (shader->word == swap->from) {
        shader->word = swap->to;
        shader->word_count = (uint32_t)swap->count;
    }
    return STATUS_OK;
}

static void tell(int to, int what, uint32_t at, int result)
{
    const struct mutant_message message = {what, result, at};
    if (write(to, &message, sizeof message) != (ssize_t)sizeof message)
        _exit(1);
}

/* With `all` every case is played; else until one comes to another end. */
static void play_cases(struct mutant_cases *cases, const struct mutant_swap *swap,
                       const uint32_t *order, uint32_t count, bool all, int to)
{
    const struct vk_compiler hook = {.compile = swap_module, .user = (void *)(uintptr_t)swap};
    struct pool pool = {.options = {.device = -1, .threads = 1, .compiler = &hook}};
    enum status status;
    struct reason reason;
    (void)pool_get(&pool, cases->engine, &status, &reason);
    if (status)
        tell(to, SAYS_NO_DEVICE, 0, 0);
    for (uint32_t i = 0; i < count && !status; i++) {
        tell(to, SAYS_BEGINS, i, 0);
        const int result = mutant_case_play(cases, order[i], &pool);
        if (all || result != cases->one[order[i]].passes)
            tell(to, SAYS_RESULT, i, result);
        if (!all && result != cases->one[order[i]].passes)
            _exit(0);
    }
    tell(to, SAYS_END, count, 0);
    _exit(0);
}

struct mutant_child {
    pid_t pid;
    int from;
};

static bool begin(struct mutant_cases *cases, const struct mutant_swap *swap, const uint32_t *order,
                  uint32_t count, bool all, struct mutant_child *out)
{
    int ends[2];
    if (pipe(ends))
        return false;
    fflush(NULL);
    out->pid = fork();
    if (out->pid == 0) {
        const int nothing = open("/dev/null", O_RDWR);
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        dup2(nothing, STDOUT_FILENO);
        dup2(nothing, STDERR_FILENO);
        close(ends[0]);
        play_cases(cases, swap, order, count, all, ends[1]);
    }
    close(ends[1]);
    out->from = ends[0];
    if (out->pid < 0)
        close(ends[0]);
    return out->pid > 0;
}

/* Waits for the next message. Returns false if the process ended or was silent for too long. */
static bool next(const struct mutant_child *child, struct mutant_message *out, bool *hangs)
{
    struct pollfd wait = {.fd = child->from, .events = POLLIN};
    *hangs = poll(&wait, 1, SILENT_MS) == 0;
    return !*hangs && read(child->from, out, sizeof *out) == (ssize_t)sizeof *out;
}

static void end(const struct mutant_child *child)
{
    kill(child->pid, SIGKILL);
    close(child->from);
    while (waitpid(child->pid, NULL, 0) < 0)
        ;
}

/* --- the shader as built ---------------------------------------------------------------------- */

static void leave_out(struct mutant_cases *cases, size_t i)
{
    cases->one[i] = cases->one[--cases->count];
}

/* Plays all cases in a process. A case that ends it is left out, and it is begun again. */
enum status mutant_play_built(struct mutant_cases *cases, struct reason *reason)
{
    const struct mutant_swap none = {NULL, NULL, 0};
    bool again = true;
    while (again) {
        struct mutant_child child;
        struct mutant_message message = {0};
        bool hangs, device = true;
        uint32_t *order = alloc_zeroed(cases->count + 1, sizeof *order);
        for (uint32_t i = 0; order && i < cases->count; i++)
            order[i] = i;
        if (!order || !begin(cases, &none, order, (uint32_t)cases->count, true, &child)) {
            free(order);
            return fail(reason, STATUS_MEMORY, "no process for a shader");
        }
        while (next(&child, &message, &hangs) && message.what != SAYS_END && device) {
            device = message.what != SAYS_NO_DEVICE;
            if (message.what == SAYS_RESULT)
                cases->one[message.at].passes = message.result;
        }
        end(&child);
        free(order);
        if (!device)
            return fail(reason, STATUS_UNSUPPORTED, "no Vulkan device can be opened");
        again = message.what != SAYS_END;
        if (again)
            leave_out(cases, message.at);
    }
    return STATUS_OK;
}

/* --- the order of play ------------------------------------------------------------------------ */

static enum status history_of(struct mutant_history *history, const struct mutant_cases *cases,
                              const char *function, struct mutant_kills **out)
{
    if (!history->of_case) {
        history->of_case = alloc_zeroed(cases->count, sizeof(uint32_t));
        history->of_pipeline = alloc_zeroed(cases->pipeline_count, sizeof(uint32_t));
    }
    for (size_t i = 0; i < history->count; i++)
        if (strcmp(history->function[i].function, function) == 0) {
            *out = &history->function[i];
            return STATUS_OK;
        }
    if (array_reserve(&history->function, &history->capacity, history->count + 1,
                      sizeof *history->function))
        return STATUS_MEMORY;
    *out = &history->function[history->count++];
    strcpy((*out)->function, function);
    (*out)->of_case = alloc_zeroed(cases->count, sizeof(uint32_t));
    (*out)->of_pipeline = alloc_zeroed(cases->pipeline_count, sizeof(uint32_t));
    return (*out)->of_case && (*out)->of_pipeline && history->of_case && history->of_pipeline
               ? STATUS_OK
               : STATUS_MEMORY;
}

static const struct mutant_cases *sorted;
static const struct mutant_kills *sorted_by;
static const struct mutant_history *sorted_all;

static int down(uint32_t a, uint32_t b)
{
    return order_numbers(b, a);
}

/* What has killed in this function, then its pipelines, then what has killed anywhere. */
static int by_kills(const void *left, const void *right)
{
    const uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
    const size_t p = sorted->one[a].pipeline, q = sorted->one[b].pipeline;
    int order = down(sorted_by->of_case[a], sorted_by->of_case[b]);
    if (!order)
        order = down(sorted_by->of_pipeline[p], sorted_by->of_pipeline[q]);
    if (!order)
        order = down(sorted_all->of_pipeline[p], sorted_all->of_pipeline[q]);
    if (!order)
        order = order_numbers(p, q);
    if (!order)
        order = down(sorted_all->of_case[a], sorted_all->of_case[b]);
    return order ? order : order_numbers(a, b);
}

/* The cases whose pipelines reach the mutant, of at most so many pipelines. */
static uint32_t order_cases(const struct mutant_cases *cases, const struct spirv_mutant *mutant,
                            size_t most, uint32_t *order)
{
    uint32_t count = 0, kept = 0;
    size_t taken = 0;
    bool *of = alloc_zeroed(cases->pipeline_count, sizeof *of);
    for (uint32_t i = 0; i < cases->count; i++)
        if (cases->pipeline[cases->one[i].pipeline].live[mutant->at])
            order[count++] = i;
    qsort(order, count, sizeof *order, by_kills);
    for (uint32_t i = 0; i < count && of; i++) {
        const size_t pipeline = cases->one[order[i]].pipeline;
        if (!of[pipeline] && (most == 0 || taken < most)) {
            of[pipeline] = true;
            taken++;
        }
        if (of[pipeline])
            order[kept++] = order[i];
    }
    free(of);
    return kept;
}

/* --- a mutant --------------------------------------------------------------------------------- */

static void watch(struct mutant_cases *cases, const struct mutant_child *child,
                  const uint32_t *order, struct mutant_kills *kills, struct mutant_history *history,
                  struct mutant_played *out)
{
    struct mutant_message message = {0};
    bool hangs = false;
    uint32_t at = 0;
    const char *how = "";
    while (true) {
        const bool told = next(child, &message, &hangs);
        if (told && message.what == SAYS_BEGINS) {
            at = message.at;
            out->played = at + 1;
            continue;
        }
        out->end = !told                            ? MUTANT_KILLED
                   : message.what == SAYS_END       ? MUTANT_SURVIVED
                   : message.what == SAYS_NO_DEVICE ? MUTANT_ABSENT
                                                    : MUTANT_KILLED;
        how = told ? "" : hangs ? " hangs" : " crashes";
        break;
    }
    end(child);
    if (out->end != MUTANT_KILLED)
        return;
    const struct mutant_case *one = &cases->one[order[at]];
    snprintf(out->by, sizeof out->by, "%s%s", one->name, how);
    kills->of_case[order[at]]++;
    kills->of_pipeline[one->pipeline]++;
    history->of_case[order[at]]++;
    history->of_pipeline[one->pipeline]++;
}

static enum status play_valid(struct mutant_cases *cases, const struct spirv_mutant *mutant,
                              const struct mutant_swap *swap, size_t most,
                              struct mutant_history *history, struct mutant_played *out,
                              struct reason *reason)
{
    struct mutant_kills *kills;
    struct mutant_child child;
    uint32_t *order = alloc_zeroed(cases->count + 1, sizeof *order);
    if (!order || history_of(history, cases, mutant->function, &kills)) {
        free(order);
        return fail(reason, STATUS_MEMORY, "no memory for an order");
    }
    sorted = cases;
    sorted_by = kills;
    sorted_all = history;
    const uint32_t count = order_cases(cases, mutant, most, order);
    const bool begun = begin(cases, swap, order, count, false, &child);
    if (begun)
        watch(cases, &child, order, kills, history, out);
    free(order);
    return begun ? STATUS_OK : fail(reason, STATUS_MEMORY, "no process for a mutant");
}

enum status mutant_play(struct mutant_cases *cases, const struct spirv_mutant *mutant, size_t most,
                        struct mutant_history *history, struct mutant_played *out,
                        struct reason *reason)
{
    struct mutant_swap swap = {.from = cases->shader->word};
    struct spirv_found found = {0};
    struct reason why;
    uint32_t *word;
    const uint64_t start = time_ns();
    *out = (struct mutant_played){.end = MUTANT_INVALID};
    enum status status = spirv_mutate(cases->code, mutant, &word, &swap.count, reason);
    if (status)
        return status;
    swap.to = word;
    if (compiler_validate(word, swap.count, &why) == STATUS_OK) {
        /* A contraction is what a driver does: nothing of it is seen in the module. */
        if (mutant->kind == MUTANT_DECORATION)
            status = spirv_look(word, (uint32_t)swap.count, &found, reason);
        if (!status && found.bare) {
            out->end = MUTANT_KILLED;
            strcpy(out->by, "test_spirv");
        } else if (!status) {
            status = play_valid(cases, mutant, &swap, most, history, out, reason);
        }
    }
    out->seconds = (double)(time_ns() - start) * 1e-9;
    free(word);
    return status;
}
