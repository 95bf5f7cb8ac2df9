#include "fuzz/findings/finding_file_world.h"

#include <string.h>

/* Numbers of an instance's line: mesh, custom index, mask, flags; the transform. */
#define INSTANCE_NUMBERS 16

static void check_rule(struct finding_scan *in, bool holds, const char *rule, const char *word)
{
    if (!in->status && !holds)
        in->status = scan_fail(&in->scan, in->reason, rule, word);
}

void finding_read_filter(struct finding_scan *in, struct finding_file *file)
{
    struct filter_rule *filter = &file->trial.world.filter;
    char word[FINDING_WORD_MOST];
    finding_word(in, "a filter", word);
    filter->kind = FILTER_ALL;
    while (trial_filter_name(filter->kind) && strcmp(trial_filter_name(filter->kind), word) != 0)
        filter->kind++;
    check_rule(in, trial_filter_name(filter->kind), "unknown filter '%.60s'", word);
    finding_keyword(in, "seed");
    filter->seed = (uint32_t)finding_whole(in, "seed", UINT32_MAX);
    finding_keyword(in, "share");
    filter->share = (uint32_t)finding_whole(in, "share", 256);
}

static void read_geometries(struct finding_scan *in, struct trial_world *world)
{
    world->geometry = finding_count(in, "geometries", FUZZ_GEOMETRIES_MOST, 5,
                                    sizeof *world->geometry, &world->geometry_count);
    for (uint32_t i = 0; i < world->geometry_count && !in->status; i++) {
        struct trial_geometry *one = &world->geometry[i];
        char word[FINDING_WORD_MOST];
        finding_skip(in);
        finding_keyword(in, "mesh");
        one->mesh = (uint32_t)finding_whole(in, "mesh", FUZZ_GEOMETRIES_MOST - 1);
        finding_keyword(in, "triangles");
        one->count = (uint32_t)finding_whole(in, "triangles", FUZZ_TRIANGLES_MOST);
        finding_word(in, "opaque or filtered", word);
        one->opaque = strcmp(word, "opaque") == 0;
        check_rule(in, one->opaque || strcmp(word, "filtered") == 0,
                   "a geometry is opaque or filtered, not '%.60s'", word);
        finding_line_end(in);
    }
}

/* The number of a mesh; "-": none. */
static uint32_t read_mesh(struct finding_scan *in)
{
    struct finding_scan ahead = *in;
    char word[FINDING_WORD_MOST];
    struct reason none;
    ahead.reason = &none;
    finding_word(&ahead, "a mesh", word);
    if (ahead.status || strcmp(word, "-") != 0)
        return (uint32_t)finding_whole(in, "mesh, or '-'", FUZZ_GEOMETRIES_MOST - 1);
    in->scan = ahead.scan;
    return WORLD_NO_MESH;
}

static void read_instances(struct finding_scan *in, struct trial_world *world)
{
    world->instance = finding_count(in, "instances", FUZZ_INSTANCES_MOST, INSTANCE_NUMBERS,
                                    sizeof *world->instance, &world->instance_count);
    for (uint32_t i = 0; i < world->instance_count && !in->status; i++) {
        struct instance *one = &world->instance[i];
        finding_skip(in);
        one->mesh = read_mesh(in);
        one->custom = (uint32_t)finding_whole(in, "custom index", ABI_CUSTOM_MOST);
        one->mask = (uint32_t)finding_whole(in, "mask", 0xFF);
        one->flags = (uint32_t)finding_whole(in, "flags", ABI_INSTANCE_FLAGS);
        for (int k = 0; k < 12; k++)
            one->m[k / 4][k % 4] = finding_float(in, "a number of a transform", false);
        finding_line_end(in);
    }
}

void finding_read_world(struct finding_scan *in, struct finding_file *file)
{
    if (!file->trial.world.is)
        return;
    read_geometries(in, &file->trial.world);
    read_instances(in, &file->trial.world);
}

struct ray_mode finding_read_mode(struct finding_scan *in)
{
    struct ray_mode mode = {0};
    mode.mask = (uint32_t)finding_whole(in, "mask", 0xFF);
    mode.flags = (uint32_t)finding_whole(in, "flags", ABI_RAY_FLAGS);
    return mode;
}

void finding_put_filter(const struct trial_world *world, FILE *to)
{
    const struct filter_rule *filter = &world->filter;
    fprintf(to, "filter %s seed %u share %u\n", trial_filter_name(filter->kind), filter->seed,
            filter->share);
}

void finding_put_world(const struct trial_world *world, FILE *to)
{
    fprintf(to, "geometries %u\n", world->geometry_count);
    for (uint32_t i = 0; i < world->geometry_count; i++)
        fprintf(to, "mesh %u triangles %u %s\n", world->geometry[i].mesh, world->geometry[i].count,
                world->geometry[i].opaque ? "opaque" : "filtered");
    fprintf(to, "instances %u\n", world->instance_count);
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct instance *one = &world->instance[i];
        if (one->mesh == WORLD_NO_MESH)
            fputc('-', to);
        else
            fprintf(to, "%u", one->mesh);
        fprintf(to, " %u %u %u ", one->custom, one->mask, one->flags);
        for (int k = 0; k < 12; k++)
            finding_put_float(one->m[k / 4][k % 4], to);
        fputc('#', to);
        for (int k = 0; k < 12; k++) {
            fputc(' ', to);
            finding_put_decimal(one->m[k / 4][k % 4], to);
        }
        fputc('\n', to);
    }
}
