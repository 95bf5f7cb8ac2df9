/* The rows of raydiff check as JSON. */
#include "cmd/check/cmd_check.h"

#include "cmd/common/cmd_finding.h"
#include "ref/files/file.h"
#include "cmd/common/cmd_json.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

/* Floats that matter stand as bit patterns beside the readable text. */
static json_t *hit_json(const struct hit *hit)
{
    if (hit->prim == ABI_NO_PRIM)
        return json_null();
    char bits[3][16];
    const float value[3] = {hit->t, hit->u, hit->v};
    for (int k = 0; k < 3; k++)
        snprintf(bits[k], sizeof bits[k], "0x%08x", float_bits(value[k]));
    return json_pack("{s:I, s:f, s:s, s:s, s:s}", "prim", (json_int_t)hit->prim, "t",
                     float_is_finite(hit->t) ? (double)hit->t : 0.0, "t_bits", bits[0], "u_bits",
                     bits[1], "v_bits", bits[2]);
}

/* JSON knows no infinity: a number too large to be mistaken. */
static double finite(double x)
{
    return x <= 1e300 ? x : 1e300;
}

static json_t *judgement_json(const struct judgement *j)
{
    if (j->expected == ABI_NO_PRIM)
        return json_pack("{s:s, s:n, s:f, s:f}", "wrong", wrong_name(j->wrong), "expected", "over",
                         finite(j->over), "displacement", finite(j->displacement));
    json_t *out = json_pack("{s:s, s:I, s:f, s:f, s:f, s:f}", "wrong", wrong_name(j->wrong),
                            "expected", (json_int_t)j->expected, "t_lo", j->t_lo, "t_hi", j->t_hi,
                            "over", finite(j->over), "displacement", finite(j->displacement));
    if (j->behind)
        json_object_set_new(out, "lost", json_integer((json_int_t)j->lost));
    return out;
}

static json_t *finding_json(const struct check_scene *scene, const struct row *row,
                            const struct finding *f)
{
    char command[EXPLAIN_COMMAND_MOST];
    json_t *ray = json_array();
    const float value[8] = {f->ray.org[0], f->ray.org[1], f->ray.org[2], f->ray.tmin,
                            f->ray.dir[0], f->ray.dir[1], f->ray.dir[2], f->ray.tmax};
    for (int k = 0; k < 8; k++) {
        char bits[16];
        snprintf(bits, sizeof bits, "0x%08x", float_bits(value[k]));
        json_array_append_new(ray, json_string(bits));
    }
    json_t *out = json_pack("{s:I, s:s, s:o, s:o}", "ray", (json_int_t)f->ray_index, "against",
                            f->bits ? "cpu" : "truth", "ray_bits", ray, "got", hit_json(&f->got));
    if (f->bits)
        json_object_set_new(out, "expected", hit_json(&f->expected));
    else
        json_object_set_new(out, "judgement", judgement_json(&f->judgement));
    if (finding_command(row, f, scene->spec, scene->seed, scene->driver, command))
        json_object_set_new(out, "explain", json_string(command));
    return out;
}

static json_t *counts_json(const struct row *row)
{
    json_t *counts = json_object();
    for (enum verdict v = 0; v < VERDICT_COUNT; v++)
        json_object_set_new(counts, verdict_name(v), json_integer((json_int_t)row->count[v]));
    return counts;
}

static json_t *wrong_json(const struct row *row)
{
    json_t *counts = json_object();
    for (enum wrong w = WRONG_MISSED; w < WRONG_COUNT; w++)
        json_object_set_new(counts, wrong_name(w), json_integer((json_int_t)row->wrong[w]));
    return counts;
}

static json_t *displacement_json(const struct row *row)
{
    if (row->displacement.count == 0)
        return json_null();
    json_t *edges = json_array();
    for (size_t c = 0; c < MATCH_EDGES; c++)
        json_array_append_new(edges,
                              json_pack("{s:I, s:I, s:f}", "hits", (json_int_t)row->edges[c].hits,
                                        "lost", (json_int_t)row->edges[c].lost, "at_most",
                                        match_edges_limit(c, row->edges[c].hits)));
    return json_pack("{s:I, s:f, s:f, s:f, s:I, s:o, s:I}", "answers",
                     (json_int_t)row->displacement.count, "p50", row->displacement.p50, "p99",
                     row->displacement.p99, "max", finite(row->displacement.most),
                     "lost_in_closed_fans", (json_int_t)row->displacement.fan_lost,
                     "lost_beside_edges", edges, "beyond", (json_int_t)row->edges_beyond);
}

static json_t *lists_json(const struct row *row)
{
    if (row->options.query != QUERY_ALL)
        return json_null();
    return json_pack("{s:I, s:I, s:b, s:I, s:I}", "triangles", (json_int_t)row->lists.triangles,
                     "double_hits", (json_int_t)row->lists.doubles, "closed", row->lists.closed,
                     "parity_known", (json_int_t)row->lists.parity, "parity_off",
                     (json_int_t)row->lists.parity_off);
}

static json_t *original_json(const struct row *row)
{
    if (row->original.judged == 0)
        return json_null();
    return json_pack(
        "{s:I, s:I, s:I, s:I, s:I, s:f, s:f, s:f}", "judged", (json_int_t)row->original.judged,
        "beyond", (json_int_t)row->original.beyond, "lost", (json_int_t)row->original.lost,
        "phantom", (json_int_t)row->original.phantom, "other", (json_int_t)row->original.other,
        "certified", finite(row->original.allowed), "displacement", finite(row->original.most),
        "displacement_decoded", finite(row->original.most_decoded));
}

static json_t *row_json(const struct check_scene *scene, const struct row *row)
{
    const struct match_options *o = &row->options;
    json_t *out = json_pack(
        "{s:s, s:s?, s:s, s:i, s:s?, s:s?, s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:I}", "scene",
        scene->spec, "layout", row->layout ? row->layout->name : NULL, "builder", o->builder->name,
        "leaf", (int)o->build.leaf, "engine", row->engine ? row->engine->name : NULL, "box",
        row->layout ? row_box_name(row) : NULL, "tri", row_tri_name(row), "query",
        query_name(o->query), "node_bytes", (json_int_t)row->node_bytes, "item_bytes",
        (json_int_t)row->item_bytes, "memory_bytes", (json_int_t)row->memory_bytes, "rays",
        (json_int_t)row->rays, "hits", (json_int_t)row->hits, "compared_with_brute",
        (json_int_t)row->brute);
    if (!out)
        return NULL;
    json_object_set_new(
        out, "tree",
        json_pack("{s:I, s:I, s:I, s:I}", "nodes", (json_int_t)row->stats.node_count, "leaves",
                  (json_int_t)row->stats.leaf_count, "depth", (json_int_t)row->stats.depth,
                  "largest_leaf", (json_int_t)row->stats.largest_leaf));
    if (o->tree)
        json_object_set_new(out, "bvh", json_string(o->tree->name));
    json_object_set_new(out, "store",
                        row->layout && o->store ? json_string(o->store->name) : json_null());
    if (scene->move > 0)
        json_object_set_new(
            out, "moved",
            json_pack("{s:f, s:f, s:f, s:I, s:I, s:I}", "extents", scene->move, "sah_before",
                      row->refit.sah_before, "sah_after", row->refit.sah_after, "build_ns",
                      (json_int_t)row->refit.build_ns, "pack_ns", (json_int_t)row->refit.pack_ns,
                      "refit_ns", (json_int_t)row->refit.refit_ns));
    json_object_set_new(out, "scene_bytes", json_integer((json_int_t)row->scene_bytes));
    json_object_set_new(out, "counts", counts_json(row));
    json_object_set_new(out, "wrong", wrong_json(row));
    json_object_set_new(out, "err_over_bound", json_real(finite(row->worst_over)));
    json_object_set_new(out, "displacement", displacement_json(row));
    json_object_set_new(out, "lists", lists_json(row));
    json_object_set_new(out, "original", original_json(row));
    json_object_set_new(out, "bit_differences", json_integer((json_int_t)row->bit_differences));
    json_object_set_new(out, "judged", json_boolean(row->judged));
    json_object_set_new(out, "differences", json_integer((json_int_t)row->differences));
    json_object_set_new(out, "mrays_per_s",
                        json_pack("{s:f, s:f, s:f, s:s}", "median", row->mrays[0], "min",
                                  row->mrays[1], "max", row->mrays[2], "clock",
                                  row->device_clock ? "device" : "host"));
    json_object_set_new(out, "box_tests", json_integer((json_int_t)row->boxes));
    json_object_set_new(out, "triangle_tests", json_integer((json_int_t)row->tris));
    json_object_set_new(out, "status", json_string(row_status_name(row->status)));
    json_object_set_new(out, "reason", json_string(row->reason.text));
    json_t *findings = json_array();
    for (size_t i = 0; i < row->finding_count; i++)
        json_array_append_new(findings, finding_json(scene, row, &row->finding[i]));
    json_object_set_new(out, "findings", findings);
    return out;
}

/* Why layouts refuse the scene, a line each: those that --layout auto passed over, and others. */
static void refusals(const struct check_scene *scene, char *text, size_t text_bytes)
{
    size_t used = (size_t)snprintf(text, text_bytes, "%s", scene->refused);
    for (size_t i = 0; i < scene->row_count && used < text_bytes; i++) {
        const struct row *row = &scene->row[i];
        if (row->status == ROW_REFUSED && !strstr(text, row->reason.text))
            used += (size_t)snprintf(text + used, text_bytes - used, "%s%s",
                                     used && text[used - 1] != '\n' ? "\n" : "", row->reason.text);
    }
}

enum status check_write_json(const char *path, const struct check_scene *scene, size_t scene_count,
                             const struct turnout *turnout, int exit_code, struct reason *reason)
{
    json_t *scenes = json_array(), *rows = json_array();
    for (size_t s = 0; s < scene_count; s++) {
        char refused[4096];
        refusals(&scene[s], refused, sizeof refused);
        json_array_append_new(
            scenes, json_pack("{s:s, s:I, s:I, s:s?, s:I, s:s}", "scene", scene[s].spec,
                              "triangles", (json_int_t)scene[s].tri_count, "vertices",
                              (json_int_t)scene[s].vertex_count, "rays", scene[s].rays, "count",
                              (json_int_t)scene[s].ray_count, "refused", refused));
        for (size_t i = 0; i < scene[s].row_count; i++)
            json_array_append_new(rows, row_json(&scene[s], &scene[s].row[i]));
    }
    json_t *root =
        json_pack("{s:s, s:i, s:o, s:o, s:o}", "raydiff", RAYDIFF_VERSION, "exit", exit_code,
                  "scenes", scenes, "named", json_turnout(turnout), "rows", rows);
    return json_write(path, root, 9, reason);
}
