/* raydiff gen: writes a request in the text form for a tracer to answer. */
#include "ref/outside/pipe_text.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/files/file.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdlib.h>
#include <string.h>

struct gen_command {
    const char *out;
    uint64_t seed, count;
    size_t rays;
    enum query query;
    bool decimal;
};

#define ROWS_OF struct gen_command

static const struct option_row rows[] = {
    {"rays", "SET", "ray set", OF_ONE(rays, TABLE_RAY_SETS), .value = "mixed"},
    {"count", "N", "rays", OF_COUNT(count, 1, 1u << 30), .value = "1000"},
    {"seed", "S", "of rays and generators", OF_COUNT(seed, 0, INT64_MAX), .value = "1"},
    {"query", "Q", "closest or any", OF_ONE(query, TABLE_QUERIES), .value = "closest"},
    {"decimal", NULL,
     "the shortest decimals that read back as the same bits, for awk and the like; otherwise "
     "hexadecimal floats, 0x1.8p+1",
     OF_FLAG(decimal)},
    {"out", "FILE", "where it is written", OF_OUTPUT(out), .shown = "standard output"},
    {0},
};

static const struct option_set set = {
    .command = "gen",
    .usage = "gen SCENE [OPTIONS]",
    .about = "Writes SCENE (a mesh file or a generator) and rays as text, a line each, for a "
             "tracer that answers in the same form; raydiff verify judges the answers. In lines:\n"
             "  from ...           where it comes from: copy it to the answer\n"
             "  query closest      or any: whichever triangle is hit\n"
             "  v X Y Z            a vertex\n"
             "  t A B C            a triangle of three vertices, numbered from 0\n"
             "  r OX OY OZ TMIN DX DY DZ TMAX   a ray; t counts in multiples of D, ends belong\n"
             "                     to it\n"
             "  end                nothing follows\n"
             "The answer: the from line, then per ray 'h T U V TRIANGLE' or 'm' (a miss); see "
             "raydiff judge --help.",
    .group = {GROUP(rows)},
    .codes = "0, 2 bad input, 4 no memory",
    .example = "gen sphere:n=8 --decimal | awk -f fuzz/samples/tracer.awk |\n"
               "             raydiff verify",
};

static enum status write_all(const struct gen_command *o, const struct pipe_from *from,
                             const struct scene *scene, const struct ray *ray,
                             struct reason *reason)
{
    struct file_out out = {.stream = stdout};
    enum status status = o->out ? file_out_open(o->out, &out, reason) : STATUS_OK;
    if (status)
        return status;
    pipe_text_write(out.stream, from, scene, ray, (size_t)o->count, o->query, o->decimal);
    return o->out ? file_out_commit(&out, reason) : STATUS_OK;
}

static enum status gen(const struct gen_command *o, const char *spec, struct reason *reason)
{
    struct pipe_from from = {.seed = o->seed, .count = o->count};
    struct scene scene;
    if (strlen(spec) >= sizeof from.spec || strpbrk(spec, "\n\r"))
        return fail(reason, STATUS_INPUT, "'%.40s...': a scene's name has at most %zu characters",
                    spec, sizeof from.spec - 1);
    enum status status = scene_open(spec, o->seed, &scene, reason);
    if (status)
        return status;
    struct ray *ray;
    status = ray_set_new(ray_sets[o->rays], &scene, o->seed, (size_t)o->count, &ray, reason);
    if (!status) {
        strcpy(from.spec, spec);
        snprintf(from.rays, sizeof from.rays, "%s", ray_sets[o->rays]->name);
        from.hash = pipe_hash(&scene, ray, (size_t)o->count, o->query);
        status = write_all(o, &from, &scene, ray, reason);
    }
    free(ray);
    scene_free(&scene);
    return status;
}

int cmd_gen(int argc, char **argv)
{
    struct gen_command o = {.out = NULL};
    struct reason reason = {""};
    int first, code = options_read(&set, &o, argc, argv, &first);
    if (code >= 0)
        return code;
    if (o.query == QUERY_ALL)
        return usage_error("gen", "--query: closest or any, not all");
    if (argc - first != 1)
        return usage_error("gen", argc == first ? "no scene given" : "one scene at a time");
    const struct list rays = {.index = {o.rays}, .count = 1};
    const struct option_use use = {.rays = &rays, .scene = argv + first, .scene_count = 1};
    code = options_refused("gen", &use);
    if (code >= 0)
        return code;
    return exit_with_reason("gen", gen(&o, argv[first], &reason), &reason);
}
