#include "cmd/render/cmd_render_out.h"

#include "cmd/common/cmd_json.h"
#include "ref/base/float_word.h"
#include "ref/base/json_record.h"

#include <stdio.h>
#include <string.h>

static bool ends_with(const char *text, const char *ending)
{
    size_t length = strlen(text), own = strlen(ending);
    return length > own && strcmp(text + length - own, ending) == 0;
}

enum status frame_path(const char *out, uint32_t frame, uint32_t count, char *path,
                       size_t path_bytes, struct reason *reason)
{
    const char *place = strchr(out, '%');
    size_t before = strlen(out) - 4, after = before;
    unsigned digits = 4;
    bool numbered = count > 1;
    path[0] = 0;
    if (!ends_with(out, ".png"))
        return fail(reason, STATUS_INPUT, "--out: '%s' does not end with .png", file_label(out));
    if (place) {
        const char *end = place + 1;
        digits = 0;
        if (end[0] == '0' && end[1] >= '1' && end[1] <= '9') {
            digits = (unsigned)(end[1] - '0');
            end += 2;
        }
        if (*end != 'd' || strchr(end, '%'))
            return fail(reason, STATUS_INPUT,
                        "--out: '%s': after %% stands d or 04d, the picture's number, once",
                        file_label(out));
        before = (size_t)(place - out);
        after = (size_t)(end + 1 - out);
        numbered = true;
    }
    char number[16] = "";
    if (numbered)
        snprintf(number, sizeof number, "%s%0*u", place ? "" : "-", (int)digits, frame);
    int length = snprintf(path, path_bytes, "%.*s%s%s", (int)before, out, number, out + after);
    if (length < 0 || (size_t)length >= path_bytes)
        return fail(reason, STATUS_INPUT, "--out: '%s' is too long", file_label(out));
    return STATUS_OK;
}

static unsigned bits_of(uint32_t word)
{
    unsigned count = 0;
    for (; word; word &= word - 1)
        count++;
    return count;
}

struct frame_rays frame_count(const struct segment *segment, size_t pixels, uint32_t bounces)
{
    struct frame_rays rays = {0};
    for (size_t i = 0; i < pixels * bounces; i++) {
        rays.closest += segment[i].prim != ABI_NO_SEGMENT;
        if (segment[i].prim >= ABI_NO_SEGMENT)
            continue;
        rays.shadow += bits_of(segment[i].asked);
        rays.hit_pixels += i % bounces == 0;
    }
    return rays;
}

enum status paths_open(const char *path, const struct render_stage *stage,
                       const struct render_settings *settings, struct paths_out *out,
                       struct reason *reason)
{
    *out = (struct paths_out){.json = ends_with(path, ".json")};
    if (!out->json && !ends_with(path, ".csv"))
        return fail(reason, STATUS_INPUT, "--paths: '%s' ends neither with .csv nor with .json",
                    file_label(path));
    enum status status = file_out_open(path, &out->file, reason);
    if (status)
        return status;
    if (out->json)
        fprintf(out->file.stream,
                "{\"profile\": \"%s\", \"engine\": \"%s\", \"width\": %u, \"height\": %u,\n"
                "\"columns\": [\"frame\", \"x\", \"y\", \"segment\", \"t\", \"prim\", \"asked\", "
                "\"shadowed\"],\n\"segments\": [\n",
                settings->look.profile == PROFILE_RTRS ? "rtrs" : "repaired",
                settings->engine->name, stage->job.width, stage->job.height);
    else
        fputs("frame,x,y,segment,t,prim,asked,shadowed\n", out->file.stream);
    return STATUS_OK;
}

/* Adds a segment. t and prim are empty if its ray hit nothing. */
static void add_segment(struct paths_out *out, uint32_t frame, size_t x, size_t y, uint32_t index,
                        const struct segment *segment)
{
    char t[FLOAT_WORD_MOST] = "", prim[16] = "";
    bool hit = segment->prim != ABI_NO_PRIM;
    if (hit) {
        (void)float_word_write(segment->t, t);
        snprintf(prim, sizeof prim, "%u", segment->prim);
    }
    if (out->json)
        fprintf(out->file.stream, "%s[%u,%zu,%zu,%u,%s%s%s,%s,%u,%u]", out->begun ? ",\n" : "",
                frame, x, y, index, hit ? "\"" : "", hit ? t : "null", hit ? "\"" : "",
                hit ? prim : "null", segment->asked, segment->shadowed);
    else
        fprintf(out->file.stream, "%u,%zu,%zu,%u,%s,%s,%u,%u\n", frame, x, y, index, t, prim,
                segment->asked, segment->shadowed);
    out->begun = true;
}

void paths_add(struct paths_out *out, uint32_t frame, const struct render_stage *stage,
               const struct segment *segment)
{
    const struct frame_job *job = &stage->job;
    for (size_t pixel = 0; pixel < (size_t)job->width * job->height; pixel++)
        for (uint32_t i = 0; i < job->look.bounces; i++) {
            const struct segment *one = &segment[pixel * job->look.bounces + i];
            if (one->prim == ABI_NO_SEGMENT)
                break;
            add_segment(out, frame, pixel % job->width, pixel / job->width, i, one);
        }
}

enum status paths_close(struct paths_out *out, struct reason *reason)
{
    if (out->json)
        fputs("\n]}\n", out->file.stream);
    return file_out_commit(&out->file, reason);
}

static json_t *json_vector(const float v[3])
{
    return json_pack("[f,f,f]", (double)v[0], (double)v[1], (double)v[2]);
}

static json_t *json_frame(const struct frame_record *r)
{
    json_t *rays = r->counted ? json_record("closest=%zu shadow=%zu hit_pixels=%zu",
                                            r->rays.closest, r->rays.shadow, r->rays.hit_pixels)
                              : json_null();
    return json_record("file=%s angle=%g pos=%p forward=%p trace_ns=%zu clock=%s wall_ns=%zu "
                       "box_tests=%zu triangle_tests=%zu memory_bytes=%p rays=%p",
                       r->path, r->angle, json_vector(r->view.pos), json_vector(r->view.forward),
                       r->report.ns, r->report.device_clock ? "device" : "host", r->wall_ns,
                       r->report.boxes, r->report.tris, json_known(r->report.memory_bytes), rays);
}

enum status render_json(const char *path, const struct render_settings *settings,
                        const struct render_stage *stage, const struct frame_record *record,
                        uint32_t count, struct reason *reason)
{
    const struct frame_job *job = &stage->job;
    const struct packed *packed = job->job.packed;
    json_t *frames = json_array();
    for (uint32_t i = 0; frames && i < count; i++)
        json_array_append_new(frames, json_frame(&record[i]));
    json_t *tree =
        packed
            ? json_record("layout=%s builder=%s leaf=%u records=%u node_bytes=%zu item_bytes=%zu",
                          packed->layout->name,
                          settings->bvh ? settings->bvh : settings->builder->name,
                          settings->build.leaf, packed->node_count, packed_node_bytes(packed),
                          packed_item_bytes(packed))
            : json_null();
    json_t *root = json_record(
        "scene=%s triangles=%u profile=%s handler=%s engine=%s box=%s tri=%s width=%u height=%u "
        "workgroup_size=%u bounces=%u ambience=%g camera_light_strength=%g lights=%u materials=%u "
        "tree=%p frames=%p",
        stage->name, stage->tri_count, job->look.profile == PROFILE_RTRS ? "rtrs" : "repaired",
        settings->handler->name, settings->engine->name, job->job.box->name, job->job.tri->name,
        job->width, job->height, job->tile, job->look.bounces, (double)job->look.ambience,
        (double)job->look.camera_light, job->light_count, job->material_count, tree, frames);
    return json_write(path, root, 9, reason);
}
