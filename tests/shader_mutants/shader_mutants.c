/* Which mutants of a shader's SPIR-V the suites catch (make shader-mutants):
 *   shader_mutants play FOLDER SHADER [COUNT SEED PIPELINES quick|AGAIN]
 *       plays COUNT mutants of a shader, spread over kinds; FOLDER/SHADER.csv has a line of each,
 *       the last of which counts. Those that the file has are not played again, but survivors that
 *       the file AGAIN names. PIPELINES: so many of a mutant's at most. quick: a handful of cases.
 *   shader_mutants list SHADER          all mutants, a line each
 *   shader_mutants one SHADER NAME          plays one on a handful of cases
 *   shader_mutants write SHADER NAME FILE   the module of one, for swap_layer.c
 * Exit codes: 0; 1 a survivor (of play); 2 usage; 4 memory; 77 no Vulkan device. */
#include "tests/shader_mutants/mutant_play.h"

#include "ref/base/command.h"
#include "ref/base/rng.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- which are played ------------------------------------------------------------------------- */

/* Turns the mutants of each kind into a random order, and takes them by turns of kinds. */
static size_t *drawn(const struct spirv_mutants *all, uint64_t seed)
{
    size_t *order = alloc_zeroed(all->count + 1, sizeof *order), *of = NULL;
    size_t count = 0, taken[MUTANT_KINDS] = {0}, there[MUTANT_KINDS] = {0};
    of = alloc_zeroed(all->count + 1, MUTANT_KINDS * sizeof *of);
    for (size_t i = 0; of && i < all->count; i++) {
        const enum mutant_kind kind = all->one[i].kind;
        of[kind * all->count + there[kind]++] = i;
    }
    for (size_t kind = 0; of && kind < MUTANT_KINDS; kind++) {
        struct rng rng = rng_make(seed, kind);
        for (size_t i = there[kind]; i > 1; i--) {
            size_t *a = &of[kind * all->count + i - 1];
            size_t *b = &of[kind * all->count + rng_below(&rng, (uint32_t)i)];
            const size_t swap = *a;
            *a = *b;
            *b = swap;
        }
    }
    while (of && order && count < all->count)
        for (size_t kind = 0; kind < MUTANT_KINDS; kind++)
            if (taken[kind] < there[kind])
                order[count++] = of[kind * all->count + taken[kind]++];
    free(of);
    return order;
}

/* --- a file of results ------------------------------------------------------------------------ */

static const char *const end_names[] = {"killed", "survived", "invalid", "absent"};

/* How the file says that a mutant ended; false: it has no line of it. */
static bool has_line(FILE *file, const char *name, enum mutant_end *end)
{
    char line[1024];
    bool has = false;
    rewind(file);
    while (fgets(line, sizeof line, file))
        if (strncmp(line, name, strlen(name)) == 0 && line[strlen(name)] == ',') {
            const char *word = line + strlen(name) + 1;
            word = strchr(word, ',') ? strchr(word, ',') + 1 : word;
            for (size_t e = 0; e < ARRAY_COUNT(end_names); e++)
                if (strncmp(word, end_names[e], strlen(end_names[e])) == 0)
                    *end = (enum mutant_end)e;
            has = true;
        }
    fseek(file, 0, SEEK_END);
    return has;
}

static void put_line(FILE *file, const struct spirv_mutant *mutant,
                     const struct mutant_played *played)
{
    char name[MUTANT_TEXT];
    spirv_mutant_name(mutant, name);
    fprintf(file, "%s,%s,%s,%s,%zu,%.2f,\"%s\"\n", name, mutant_kind_names[mutant->kind],
            end_names[played->end], played->by, played->played, played->seconds, mutant->text);
    fflush(file);
}

/* --- commands --------------------------------------------------------------------------------- */

static int give_up(enum status status, const struct reason *reason)
{
    fprintf(stderr, "shader_mutants: %s\n", reason->text);
    return exit_of_status(status);
}

struct mutant_run {
    struct mutant_cases cases;
    struct spirv_code code;
    struct spirv_mutants all;
    struct mutant_history history;
    FILE *file;
    size_t count, pipelines;
    size_t ends[4];
    const char *again; /* a file of names: survivors that are played once more */
};

/* Whether a file has the line. */
static bool is_named(const char *path, const char *name)
{
    char line[1024];
    bool has = false;
    FILE *file = fopen(path, "r");
    while (file && !has && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = '\0';
        has = strcmp(line, name) == 0;
    }
    if (file)
        fclose(file);
    return has;
}

static enum status play_drawn(struct mutant_run *p, const size_t *order, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < p->all.count && !status; i++) {
        const struct spirv_mutant *mutant = &p->all.one[order[i]];
        struct mutant_played played = {.end = MUTANT_SURVIVED};
        char name[MUTANT_TEXT];
        if (p->ends[MUTANT_KILLED] + p->ends[MUTANT_SURVIVED] == p->count)
            break;
        spirv_mutant_name(mutant, name);
        const bool has = has_line(p->file, name, &played.end);
        if (!has || (p->again && played.end == MUTANT_SURVIVED && is_named(p->again, name))) {
            status = mutant_play(&p->cases, mutant, p->pipelines, &p->history, &played, reason);
            if (!status && played.end == MUTANT_ABSENT)
                status = fail(reason, STATUS_UNSUPPORTED, "no Vulkan device can be opened");
            if (!status)
                put_line(p->file, mutant, &played);
        }
        p->ends[played.end] += !status;
    }
    return status;
}

static int play(const char *folder, const char *shader, size_t count, uint64_t seed,
                size_t pipelines, const char *how)
{
    static struct mutant_run p;
    const bool quick = strcmp(how, "quick") == 0;
    struct reason reason;
    char path[512];
    p.count = count;
    p.pipelines = pipelines;
    p.again = !quick && *how ? how : NULL;
    const uint64_t start = time_ns();
    enum status status = mutant_cases_make(shader, quick, &p.code, &p.cases, &reason);
    if (!status)
        status = mutant_play_built(&p.cases, &reason);
    if (!status)
        status = spirv_mutants_make(&p.code, &p.all, &reason);
    if (status)
        return give_up(status, &reason);
    fprintf(stderr, "%s: %zu mutants, %zu cases of %zu pipelines, prepared in %.1f s\n", shader,
            p.all.count, p.cases.count, p.cases.pipeline_count, (double)(time_ns() - start) * 1e-9);
    snprintf(path, sizeof path, "%.300s/%.100s.csv", folder, shader);
    p.file = fopen(path, "a+");
    size_t *order = drawn(&p.all, seed);
    if (!p.file || !order)
        status = fail(&reason, STATUS_INPUT, "%.300s cannot be written", path);
    if (!status)
        status = play_drawn(&p, order, &reason);
    if (status)
        return give_up(status, &reason);
    fclose(p.file);
    printf("%s: %zu killed, %zu survived, %zu not valid\n", shader, p.ends[MUTANT_KILLED],
           p.ends[MUTANT_SURVIVED], p.ends[MUTANT_INVALID]);
    return p.ends[MUTANT_SURVIVED] > 0;
}

static int list(const char *shader, const char *name, const char *path)
{
    struct spirv_mutants all;
    struct spirv_code code;
    struct reason reason;
    const struct shader *of = shader_find(shader);
    if (!of)
        return give_up(fail(&reason, STATUS_INPUT, "'%.60s': no such shader", shader), &reason);
    enum status status = spirv_code_make(of->word, of->word_count, &code, &reason);
    if (!status)
        status = spirv_mutants_make(&code, &all, &reason);
    if (status)
        return give_up(status, &reason);
    for (size_t i = 0; i < all.count && !status; i++) {
        char text[MUTANT_TEXT];
        spirv_mutant_name(&all.one[i], text);
        if (!name) {
            printf("%s %s\n", text, all.one[i].text);
            continue;
        }
        if (strcmp(name, text) != 0)
            continue;
        uint32_t *word;
        size_t count;
        FILE *file = fopen(path, "wb");
        status = spirv_mutate(&code, &all.one[i], &word, &count, &reason);
        const bool wrote = !status && file && fwrite(word, 4, count, file) == count;
        if (!file || fclose(file) || !wrote)
            return give_up(fail(&reason, STATUS_INPUT, "%.300s cannot be written", path), &reason);
        return EXIT_AGREE;
    }
    return name ? EXIT_USAGE : EXIT_AGREE;
}

/* Plays one on a handful of cases. */
static int play_one(const char *shader, const char *name)
{
    static struct mutant_run p;
    struct reason reason;
    enum status status = mutant_cases_make(shader, true, &p.code, &p.cases, &reason);
    if (!status)
        status = mutant_play_built(&p.cases, &reason);
    if (!status)
        status = spirv_mutants_make(&p.code, &p.all, &reason);
    for (size_t i = 0; i < p.all.count && !status; i++) {
        struct mutant_played played;
        char text[MUTANT_TEXT];
        spirv_mutant_name(&p.all.one[i], text);
        if (strcmp(name, text) != 0)
            continue;
        status = mutant_play(&p.cases, &p.all.one[i], 0, &p.history, &played, &reason);
        if (status)
            break;
        printf("%s: %s %s\n", p.all.one[i].text, end_names[played.end], played.by);
        return played.end == MUTANT_SURVIVED;
    }
    return status ? give_up(status, &reason) : EXIT_USAGE;
}

int main(int argc, char **argv)
{
    omp_set_num_threads(1); /* processes that are forked have no other threads */
    if (argc >= 4 && strcmp(argv[1], "play") == 0)
        return play(argv[2], argv[3], argc > 4 ? strtoul(argv[4], NULL, 10) : 200,
                    argc > 5 ? strtoul(argv[5], NULL, 10) : 1,
                    argc > 6 ? strtoul(argv[6], NULL, 10) : 0, argc > 7 ? argv[7] : "");
    if (argc == 3 && strcmp(argv[1], "list") == 0)
        return list(argv[2], NULL, NULL);
    if (argc == 4 && strcmp(argv[1], "one") == 0)
        return play_one(argv[2], argv[3]);
    if (argc == 5 && strcmp(argv[1], "write") == 0)
        return list(argv[2], argv[3], argv[4]);
    fprintf(stderr, "shader_mutants play FOLDER SHADER [COUNT SEED PIPELINES quick|AGAIN]\n"
                    "shader_mutants list SHADER\nshader_mutants one SHADER NAME\nshader_mutants "
                    "write SHADER NAME FILE\n");
    return EXIT_USAGE;
}
