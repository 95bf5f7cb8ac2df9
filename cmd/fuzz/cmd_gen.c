/* raydiff gen: writes a request in the text form for a tracer to answer. */
#include "ref/outside/pipe_text.h"
#include "cmd/check/cmd_check.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/files/file.h"
#include "scenes/rays/world_rays.h"

#include <string.h>

struct gen_command {
    const char *out;
    uint64_t seed, count;
    size_t rays, modes;
    bool modes_named;
    enum query query;
    bool decimal;
};

#define ROWS_OF struct gen_command

/* As ray_modes_name. */
static const char *const modes[] = {"all", "mixed", "drawn", NULL};

static const struct option_row rows[] = {
    {"rays", "SET", "ray set", OF_ONE(rays, TABLE_RAY_SETS), .value = "mixed"},
    {"modes", "M",
     "of a world, what rays may meet: all of it, what masks and flags drawn at random admit, or "
     "mixed: every second ray",
     OF_CHOICE(modes, modes), .value = "mixed"},
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
    .about =
        "Writes SCENE (a mesh file, a world or a generator) and rays as text, a line each, for a "
        "tracer that answers in the same form; raydiff verify judges the answers. In lines:\n"
        "  from ...           where it comes from: copy it to the answer\n"
        "  query closest      or any: whichever triangle is hit\n"
        "  v X Y Z            a vertex\n"
        "  t A B C            a triangle of three vertices, numbered from 0\n"
        "  r OX OY OZ TMIN DX DY DZ TMAX   a ray; t counts in multiples of D, ends belong\n"
        "                     to it\n"
        "  end                nothing follows\n"
        "In a world, whose first line is raydiff 2, also:\n"
        "  filter KIND SEED SHARE   which hits count that are not opaque\n"
        "  mesh               v, t and g lines up to the next i line are its own\n"
        "  g TRIANGLES opaque   a geometry of its next triangles; or filtered\n"
        "  i MESH CUSTOM MASK FLAGS M00 M01 M02 T0 ...   an instance\n"
        "  r ... MASK FLAGS   what the ray may meet\n"
        "The answer: the from line, then per ray 'h T U V TRIANGLE' or 'm' (a miss); see "
        "raydiff judge --help.",
    .group = {GROUP(rows)},
    .codes = "0, 2 bad input, 4 no memory",
    .example = "gen sphere:n=8 --decimal | awk -f fuzz/samples/tracer.awk |\n"
               "             raydiff verify",
};

/* A request: a scene or a world, and its rays. */
struct gen_request {
    struct check_subject of;
    struct pipe_from from;
};

static enum status write_all(const struct gen_command *o, const struct gen_request *request,
                             struct reason *reason)
{
    const struct check_subject *of = &request->of;
    struct file_out out = {.stream = stdout};
    enum status status = o->out ? file_out_open(o->out, &out, reason) : STATUS_OK;
    if (status)
        return status;
    if (of->is_world)
        pipe_text_write_world(out.stream, &request->from, &of->world, of->ray, of->mode,
                              (size_t)o->count, o->query, o->decimal);
    else
        pipe_text_write(out.stream, &request->from, &of->scene, of->ray, (size_t)o->count, o->query,
                        o->decimal);
    return o->out ? file_out_commit(&out, reason) : STATUS_OK;
}

static enum status make_of_scene(const struct gen_command *o, struct gen_request *request,
                                 struct reason *reason)
{
    struct check_subject *of = &request->of;
    if (o->modes_named)
        return fail(reason, STATUS_INPUT,
                    "--modes: %s is a scene; only worlds have masks and flags (docs/worlds.md)",
                    request->from.spec);
    enum status status =
        ray_set_new(ray_sets[o->rays], &of->scene, o->seed, (size_t)o->count, &of->ray, reason);
    if (!status)
        request->from.hash = pipe_hash(&of->scene, of->ray, (size_t)o->count, o->query);
    return status;
}

static enum status make_of_world(const struct gen_command *o, struct gen_request *request,
                                 struct reason *reason)
{
    struct check_subject *of = &request->of;
    struct check_scene about;
    check_describe(&of->world, &about);
    if (about.vacuous)
        return fail(reason, STATUS_INPUT, "%s: " CHECK_VACUOUS, request->from.spec);
    enum status status = world_rays_new(&of->world, ray_sets[o->rays], (enum ray_modes)o->modes,
                                        o->seed, (size_t)o->count, &of->ray, &of->mode, reason);
    if (status)
        return status;
    snprintf(request->from.modes, sizeof request->from.modes, "%s", modes[o->modes]);
    request->from.hash = pipe_hash_world(&of->world, of->ray, of->mode, (size_t)o->count, o->query);
    return request->from.hash ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for a world");
}

static enum status gen(const struct gen_command *o, const char *spec, struct reason *reason)
{
    struct gen_request request = {.from = {.seed = o->seed, .count = o->count}};
    struct pipe_from *from = &request.from;
    if (strlen(spec) >= sizeof from->spec || strpbrk(spec, "\n\r"))
        return fail(reason, STATUS_INPUT, "'%.40s...': a scene's name has at most %zu characters",
                    spec, sizeof from->spec - 1);
    strcpy(from->spec, spec);
    snprintf(from->rays, sizeof from->rays, "%s", ray_sets[o->rays]->name);
    enum status status = check_open_either(spec, o->seed, &request.of, reason);
    if (!status)
        status = request.of.is_world ? make_of_world(o, &request, reason)
                                     : make_of_scene(o, &request, reason);
    if (!status)
        status = write_all(o, &request, reason);
    check_close(&request.of);
    return status;
}

int cmd_gen(int argc, char **argv)
{
    struct gen_command o = {.out = NULL};
    struct reason reason = {""};
    int first, code = options_read(&set, &o, argc, argv, &first);
    if (code >= 0)
        return code;
    o.modes_named = option_was_given("modes");
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
