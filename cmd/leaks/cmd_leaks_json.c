/* The JSON of raydiff leaks. */
#include "cmd/leaks/cmd_leaks.h"

#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"
#include "ref/store.h"

#include <jansson.h>

static json_t *tally_json(const struct leak_tally *t, bool lists)
{
    json_t *out = json_record("rays=%zu misses=%zu", t->rays, t->misses);
    if (!lists)
        return out;
    json_add(out, "empty=%zu double_hits=%zu even=%zu lost=%zu phantoms=%zu repeated=%zu", t->empty,
             t->doubles, t->even, t->lost, t->phantoms, t->repeated);
    return out;
}

static json_t *finding_json(const struct leak_finding *f)
{
    json_t *prims = json_array();
    for (int k = 0; k < 2 && f->is_double; k++)
        json_array_append_new(prims, json_integer((json_int_t)f->prim[k]));
    return json_record("kind=%s aim=%s ray=%zu ray_bits=%p triangles=%p",
                       f->is_double ? "double_hit" : "miss", leak_aim_name(f->aim), f->ray_index,
                       json_ray_bits(&f->ray), prims);
}

static json_t *row_json(const struct leak_scene *scene, const struct leak_row *row)
{
    json_t *out =
        json_record("scene=%s layout=%p store=%p engine=%p builder=%s box=%p tri=%s promises=%i "
                    "broken=%s status=%s reason=%s",
                    scene->spec, json_text(row->layout ? row->layout->name : NULL),
                    json_text(row->layout ? row->store->name : NULL),
                    json_text(row->engine ? row->engine->name : NULL), row->builder->name,
                    json_text(row->engine && !row->engine->needs_packed ? NULL : row->box->name),
                    leak_row_tri(row), (int)row->promises, row->broken, status_text(row->status),
                    row->reason.text);
    if (!out || row->status)
        return out;
    struct leak_tally sum = leaks_total(&row->leaks);
    json_add(out, "total=%p", tally_json(&sum, row->leaks.lists));
    json_t *aims = json_object(), *findings = json_array();
    for (enum leak_aim aim = 0; aim < LEAK_AIMS; aim++)
        json_add(aims, "%s=%p", leak_aim_name(aim),
                 tally_json(&row->leaks.tally[aim], row->leaks.lists));
    json_add(out, "aims=%p bit_differences=%p ns=%zu", aims,
             row->compared ? json_integer((json_int_t)row->bit_differences) : json_null(),
             row->leaks.ns);
    for (size_t i = 0; i < row->leaks.finding_count; i++)
        json_array_append_new(findings, finding_json(&row->leaks.finding[i]));
    json_add(out, "findings=%p", findings);
    return out;
}

enum status leaks_write_json(const char *path, const struct leak_scene *scene, size_t scene_count,
                             const struct turnout *turnout, int exit_code, struct reason *reason)
{
    json_t *scenes = json_array(), *rows = json_array();
    for (size_t s = 0; s < scene_count; s++) {
        const struct inside *inside = &scene[s].inside;
        json_array_append_new(
            scenes, json_record("scene=%s triangles=%u points=%u edges=%u rays=%zu "
                                "origins=%zu aimed_exactly=%zu instances=%u seams=%i vacuous=%s",
                                scene[s].spec, scene[s].tri_count, scene[s].point_count,
                                scene[s].edge_count, scene[s].ray_count, inside->origins,
                                inside->exact, scene[s].is_world ? scene[s].instances : 1,
                                (int)scene[s].seams, scene[s].vacuous));
        for (size_t i = 0; i < scene[s].row_count; i++)
            json_array_append_new(rows, row_json(&scene[s], &scene[s].row[i]));
    }
    json_t *root = json_record("raydiff=%s profile=%s exit=%d scenes=%p named=%p rows=%p",
                               RAYDIFF_VERSION, scene_count ? scene[0].profile->name : "",
                               exit_code, scenes, json_turnout(turnout), rows);
    return json_write(path, root, 17, reason);
}
