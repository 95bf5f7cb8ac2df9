/* raydiff judge and verify: judge answers given in the text form. */
#include "cmd/fuzz/cmd_judge.h"

#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/files/file.h"
#include "ref/outside/pipe.h"
#include "scenes/rays/world_rays.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define STANDARD_INPUT "/dev/stdin"

#define ROWS_OF struct judge_options

static const struct option_row seed_rows[] = {
    SCENE_SEED_ROW(seed),
    {0},
};

static const struct option_row rows[] = {
    {"brute", "N", "ray-triangle pairs that brute force may decide", OF_COUNT(brute, 0, UINT64_MAX),
     .value = "2e8"},
    {"json", "FILE", "the row, for machines, as check writes it", OF_DATA(json)},
    {0},
};

#define NOTES                                                                                      \
    "A formula that is unknown is judged by how far vertices must move to make an answer right."
#define CODES "0 agree, 1 mismatch or vacuous, 2 bad input, 3 the tracer refused, 4 internal"

static const struct option_set judge_set = {
    .command = "judge",
    .usage = "judge SCENE RAYS HITS [OPTIONS]",
    .about =
        "Judges answers of a tracer that cannot be run here: SCENE is a mesh file, a world or a "
        "generator; "
        "RAYS and HITS are text files, or '-' for the standard input, with lines\n"
        "  RAYS  r OX OY OZ TMIN DX DY DZ TMAX   a ray; what raydiff gen writes will do\n"
        "        query closest    or any; closest if there is no such line\n"
        "  HITS  h T U V TRIANGLE  what ray 0, 1, ... hits; triangles count from 0\n"
        "        m                or that it hits nothing\n"
        "        formula mt ieee  if that is known, before or after the hits: formula unknown, "
        "mt, woop, embree, embree_robust, pluecker, baldwin_webber, tri_accel; rounding one of "
        "ieee, "
        "flushed, vulkan, vulkan_rte, embree\n"
        "        flags open watertight unnamed  those that hold: ends of the range are no hits; "
        "closed meshes stay closed; any-hits name no triangle\n"
        "In a world the first line of both is raydiff 2, and then\n"
        "  RAYS  r OX OY OZ TMIN DX DY DZ TMAX MASK FLAGS\n"
        "  HITS  h T U V INSTANCE GEOMETRY TRIANGLE front [CUSTOM]   or back; geometries count "
        "in the mesh, triangles in the geometry\n"
        "Numbers are decimals or hexadecimal floats, 0x1.8p+1; '#' begins a comment. U weighs a "
        "triangle's second vertex, V its third.",
    .group = {GROUP(seed_rows), GROUP(rows), GROUP_AT(displacement_rows, demands),
              GROUP_AT(watertight_rows, demands), GROUP_AT(screen_rows, screen)},
    .notes = NOTES,
    .codes = CODES,
    .example = "gen sphere:n=4 --decimal --count 100 >rays.txt\n"
               "         awk -f fuzz/samples/tracer.awk rays.txt >hits.txt\n"
               "judge sphere:n=4 rays.txt hits.txt",
};

static const struct option_set verify_set = {
    .command = "verify",
    .usage = "gen SCENE ... | TRACER | raydiff verify [OPTIONS]",
    .about = "Judges the answers on its standard input to the rays that raydiff gen wrote. They "
             "hold the 'from' line of the request, by which scene and rays are made again, and "
             "per ray 'h T U V TRIANGLE' or 'm'; of a world also its first line; see raydiff judge "
             "--help.",
    .group = {GROUP(rows), GROUP_AT(displacement_rows, demands), GROUP_AT(watertight_rows, demands),
              GROUP_AT(screen_rows, screen)},
    .notes = NOTES,
    .codes = CODES,
    .example = "gen sphere:n=8 --decimal | awk -f fuzz/samples/tracer.awk |\n"
               "             raydiff verify",
};

static const char *path_of(const char *argument)
{
    return strcmp(argument, "-") == 0 ? STANDARD_INPUT : argument;
}

static const char *name_of(const char *path)
{
    return strcmp(path, STANDARD_INPUT) == 0 ? "standard input" : file_label(path);
}

/* Reads a whole file. Error messages call /dev/stdin "standard input". */
static enum status read_all(const char *path, char **bytes, size_t *size, struct reason *reason)
{
    enum status status = file_read(path, bytes, size, reason);
    if (status == STATUS_INPUT && strcmp(path, STANDARD_INPUT) == 0)
        status = fail(reason, status, "standard input: is empty or cannot be read");
    return status;
}

/* Parses the hits of a file, one per ray. */
static enum status parse_answer(struct judge_run *j, const char *name, const char *bytes,
                                size_t size, struct reason *reason)
{
    const struct pipe_limits limits = {.rays = j->request.ray_count,
                                       .triangles = j->of.scene.tri_count,
                                       .world = j->of.is_world ? &j->of.world : NULL};
    enum status status = pipe_text_parse(name, bytes, size, &limits, &j->answer, reason);
    if (status)
        return status;
    const struct pipe_text *a = &j->answer;
    if (a->ray_count || a->scene.vertex_count || a->world.mesh_count || a->world.instance_count)
        return fail(reason, STATUS_INPUT, "%s: has v, t or r lines: is it a request?", name);
    if (a->refused[0])
        return fail(reason, STATUS_DEVICE, "%s: the tracer refused: %s", name, a->refused);
    if (a->hit_count < j->request.ray_count)
        return fail(reason, STATUS_INPUT, "%s:%" PRIu64 ": ends after %zu of %zu answers", name,
                    a->last_line, a->hit_count, j->request.ray_count);
    return STATUS_OK;
}

static enum status read_answer(struct judge_run *j, const char *path, struct reason *reason)
{
    char *bytes;
    size_t size;
    enum status status = read_all(path, &bytes, &size, reason);
    if (status)
        return status;
    status = parse_answer(j, name_of(path), bytes, size, reason);
    free(bytes);
    return status;
}

/* Checks that the rays are in a scene or in a world, and what else their file has of it. */
static enum status check_rays(const struct judge_run *j, const char *name, struct reason *reason)
{
    const struct pipe_text *with = &j->request;
    const bool is_world = with->version == PIPE_VERSION_WORLD;
    bool same = true;
    if (is_world != j->of.is_world)
        return fail(reason, STATUS_INPUT,
                    "%s: its rays are of version %u, but %.80s is a %s: 'raydiff %u' is the first "
                    "line",
                    name, with->version, j->spec, j->of.is_world ? "world" : "scene",
                    j->of.is_world ? PIPE_VERSION_WORLD : PIPE_VERSION);
    if (is_world && (with->world.mesh_count || with->world.instance_count))
        same = pipe_hash_world(&with->world, NULL, NULL, 0, 0) ==
               pipe_hash_world(&j->of.world, NULL, NULL, 0, 0);
    else if (with->scene.vertex_count)
        same = pipe_hash(&with->scene, NULL, 0, 0) == pipe_hash(&j->of.scene, NULL, 0, 0);
    if (!same)
        return fail(reason, STATUS_INPUT, "%s: has v and t lines for another %s than %.80s", name,
                    is_world ? "world" : "scene", j->spec);
    return STATUS_OK;
}

/* Reads the rays of a file. If the file also holds a scene, it must be the named one. */
static enum status read_rays(struct judge_run *j, const char *path, struct reason *reason)
{
    const struct pipe_limits limits = pipe_limits_none();
    const char *name = name_of(path);
    char *bytes;
    size_t size;
    enum status status = read_all(path, &bytes, &size, reason);
    if (status)
        return status;
    status = pipe_text_parse(name, bytes, size, &limits, &j->request, reason);
    free(bytes);
    if (status)
        return status;
    if (j->request.hit_count)
        return fail(reason, STATUS_INPUT, "%s: has h or m lines: is it an answer?", name);
    if (j->request.ray_count == 0)
        return fail(reason, STATUS_INPUT, "%s: has no ray", name);
    return check_rays(j, name, reason);
}

int cmd_judge(int argc, char **argv)
{
    struct judge_options o = {.json = NULL};
    struct reason reason = {""};
    int first, code = options_read(&judge_set, &o, argc, argv, &first);
    if (code >= 0)
        return code;
    if (argc - first != 3)
        return usage_error("judge", "SCENE, RAYS and HITS are needed, not %d names", argc - first);
    const char *rays = path_of(argv[first + 1]), *hits = path_of(argv[first + 2]);
    if (strcmp(rays, STANDARD_INPUT) == 0 && strcmp(hits, rays) == 0)
        return usage_error("judge", "RAYS and HITS cannot both be '-'");
    const struct option_use use = {.scene = argv + first, .scene_count = 1};
    code = options_refused("judge", &use);
    if (code >= 0)
        return code;
    struct judge_run j = {.command = "judge",
                          .options = &o,
                          .spec = argv[first],
                          .ray_name = argv[first + 1],
                          .seed = o.seed};
    enum status status = check_open_either(j.spec, o.seed, &j.of, &reason);
    if (!status)
        status = read_rays(&j, rays, &reason);
    j.modes = j.of.is_world ? "given" : NULL;
    if (!status)
        status = read_answer(&j, hits, &reason);
    return judge_finish(&j, status, &reason);
}

/* Draws the rays again. */
static enum status draw_rays(struct judge_run *j, const struct ray_set *set,
                             const struct pipe_from *from, struct reason *reason)
{
    struct pipe_text *request = &j->request;
    enum ray_modes modes = 0;
    request->ray_count = (size_t)from->count;
    if (!j->of.is_world)
        return ray_set_new(set, &j->of.scene, from->seed, request->ray_count, &request->ray,
                           reason);
    while (modes < RAY_MODES_COUNT && strcmp(ray_modes_name(modes), from->modes) != 0)
        modes++;
    if (modes == RAY_MODES_COUNT)
        return fail(reason, STATUS_INPUT, "standard input: 'from' has no modes that there are");
    j->modes = ray_modes_name(modes);
    return world_rays_new(&j->of.world, set, modes, from->seed, request->ray_count, &request->ray,
                          &request->mode, reason);
}

static uint64_t hash_of(const struct judge_run *j, enum query query)
{
    const struct pipe_text *request = &j->request;
    return j->of.is_world ? pipe_hash_world(&j->of.world, request->ray, request->mode,
                                            request->ray_count, query)
                          : pipe_hash(&j->of.scene, request->ray, request->ray_count, query);
}

/* Checks the 'from' line before as many rays as it states are drawn. */
static enum status check_from(const struct pipe_text *look, const struct ray_set *set,
                              struct reason *reason)
{
    const struct pipe_from *from = &look->from;
    if (look->refused[0])
        return fail(reason, STATUS_DEVICE, "standard input: the tracer refused: %s", look->refused);
    if (from->spec[0] == '\0')
        return fail(reason, STATUS_INPUT,
                    "standard input: has no 'from' line: a tracer copies it from its request, "
                    "which raydiff gen writes");
    if (!set || from->count < 1 || from->count > 1u << 30)
        return fail(reason, STATUS_INPUT, "standard input: 'from' names no ray set of any count");
    if (look->hit_count < from->count)
        return fail(reason, STATUS_INPUT,
                    "standard input:%" PRIu64 ": ends after %zu of %" PRIu64 " answers",
                    look->last_line, look->hit_count, from->count);
    return STATUS_OK;
}

/* Rebuilds scene or world and rays from the answer's 'from' line. */
static enum status make_again(struct judge_run *j, const struct pipe_text *look,
                              struct reason *reason)
{
    const struct pipe_from *from = &look->from;
    const struct ray_set *set = ray_set_find(from->rays);
    enum status status = check_from(look, set, reason);
    if (status)
        return status;
    j->ray_name = set->name;
    j->spec = from->spec;
    j->seed = from->seed;
    status = check_open_either(from->spec, from->seed, &j->of, reason);
    if (!status && j->of.is_world != (from->modes[0] != '\0'))
        status = fail(
            reason, STATUS_INPUT, "standard input: 'from' is for a %s, but '%.80s' is a %s now",
            from->modes[0] ? "world" : "scene", from->spec, j->of.is_world ? "world" : "scene");
    if (!status)
        status = draw_rays(j, set, from, reason);
    for (j->request.query = QUERY_CLOSEST; !status && j->request.query <= QUERY_ANY;
         j->request.query++)
        if (hash_of(j, j->request.query) == from->hash)
            return STATUS_OK;
    return status ? status
                  : fail(reason, STATUS_INPUT,
                         "standard input: 'from' is for another scene or other rays than '%.80s' "
                         "gives now",
                         from->spec);
}

static enum status read_piped(struct judge_run *j, struct pipe_text *look, struct reason *reason)
{
    const struct pipe_limits limits = pipe_limits_none();
    char *bytes;
    size_t size;
    enum status status = read_all(STANDARD_INPUT, &bytes, &size, reason);
    if (status)
        return status;
    status = pipe_text_parse("standard input", bytes, size, &limits, look, reason);
    if (!status)
        status = make_again(j, look, reason);
    if (!status) /* parse again, now with the limits of the scene and rays */
        status = parse_answer(j, "standard input", bytes, size, reason);
    free(bytes);
    return status;
}

int cmd_verify(int argc, char **argv)
{
    struct judge_options o = {.json = NULL};
    struct reason reason = {""};
    int first, code = options_read(&verify_set, &o, argc, argv, &first);
    if (code >= 0)
        return code;
    if (argc != first)
        return usage_error("verify", "the standard input is read; unexpected argument '%s'",
                           argv[first]);
    struct judge_run j = {.command = "verify", .options = &o};
    struct pipe_text look = {0};
    enum status status = read_piped(&j, &look, &reason);
    code = judge_finish(&j, status, &reason);
    pipe_text_free(&look);
    return code;
}
