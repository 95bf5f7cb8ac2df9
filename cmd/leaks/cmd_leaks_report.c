/* Output of raydiff leaks: the table, the findings, and which rows keep their promise. */
#include "cmd/leaks/cmd_leaks.h"
#include "ref/base/command.h"
#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"
#include "ref/store.h"

#include <jansson.h>

/* Prints the rate per million of `rays`. For 0 events prints "<3 / N", which the true rate exceeds
 * in 5 of 100 such results. */
static void print_rate(size_t count, size_t rays)
{
    char text[32];
    double million = 1e6 / (double)(rays ? rays : 1);
    if (count == 0)
        snprintf(text, sizeof text, "<%.3g", 3 * million);
    else
        snprintf(text, sizeof text, "%.1f", (double)count * million);
    printf(" %9s", text);
}

static void print_aims(const struct leaks *leaks, size_t offset)
{
    for (enum leak_aim aim = 0; aim < LEAK_AIMS; aim++)
        printf(" %8zu", *(const size_t *)((const char *)&leaks->tally[aim] + offset));
}

static void print_row(const struct leak_row *row)
{
    char text[STORED_NAME_MOST];
    printf("%-13s %-13s %-10s %-7s", stored_name(row->layout, row->store, text),
           row->engine ? row->engine->name : "-",
           row->engine && !row->engine->needs_packed ? "-" : row->box->name,
           row->own_test ? "own" : row->tri->name);
    if (row->status) {
        printf(" %s: %s\n",
               row->status == STATUS_LIMIT || row->status == STATUS_REFUSED ? "refused"
               : row->status == STATUS_UNSUPPORTED                          ? "skipped"
                                                                            : "failed",
               row->reason.text);
        return;
    }
    struct leak_tally sum = leaks_total(&row->leaks);
    print_rate(sum.misses, sum.rays);
    print_aims(&row->leaks, offsetof(struct leak_tally, misses));
    if (row->leaks.lists) {
        print_rate(sum.doubles, sum.rays);
        print_aims(&row->leaks, offsetof(struct leak_tally, doubles));
        printf(" %8zu %6zu %7zu %6zu", sum.even, sum.lost, sum.phantoms, sum.repeated);
    } else {
        for (int i = 0; i < 9; i++)
            printf(" %*s", (const int[]){9, 8, 8, 8, 8, 8, 6, 7, 6}[i], "-");
    }
    if (row->compared)
        printf(" %7zu", row->bit_differences);
    else
        printf(" %7s", "-");
    printf(" %s%s\n",
           row->broken[0]  ? "BROKEN: "
           : row->promises ? "kept"
                           : "counted",
           row->broken);
}

static void print_finding(const struct leak_row *row, const struct leak_finding *f)
{
    const struct ray *ray = &f->ray;
    char text[STORED_NAME_MOST];
    printf("%s %s.%s.%s ray %zu at %s: org %a %a %a dir %a %a %a", f->is_double ? "DOUBLE" : "MISS",
           row->engine->name, stored_name(row->layout, row->store, text), row->tri->name,
           f->ray_index, leak_aim_name(f->aim), (double)ray->org[0], (double)ray->org[1],
           (double)ray->org[2], (double)ray->dir[0], (double)ray->dir[1], (double)ray->dir[2]);
    if (f->is_double)
        printf(", triangles %u and %u", f->prim[0], f->prim[1]);
    putchar('\n');
}

void leaks_print(const struct leak_scene *scene)
{
    const struct inside *inside = &scene->inside;
    const struct leak_profile *profile = scene->profile;
    printf("%s: %u triangles, %u points, %u edges, closed; %zu rays from %zu points inside, seed "
           "%llu; %.1f %% of them aimed without rounding\n",
           scene->spec, scene->tri_count, scene->point_count, scene->edge_count, scene->ray_count,
           inside->origins, (unsigned long long)scene->seed,
           100.0 * (double)inside->exact / (double)scene->ray_count);
    printf("profile %s: %s\n", profile->name, profile->summary);
    printf("%-41s %-45s %s\n", "", "misses: per million, of rays aimed at a",
           "double hits: likewise");
    printf("%-13s %-13s %-10s %-7s", "layout", "engine", "box", "tri");
    for (int i = 0; i < 2; i++)
        printf(" %9s %8s %8s %8s %8s", "per 10^6", "vertex", "midpoint", "edge", "beside");
    printf(" %8s %6s %7s %6s %7s %s\n", "even", "lost", "phantom", "repeat", "bits", "word");
    size_t promising = 0;
    for (size_t i = 0; i < scene->row_count; i++) {
        print_row(&scene->row[i]);
        promising += scene->row[i].promises;
    }
    for (size_t i = 0; i < scene->row_count; i++)
        for (size_t k = 0; k < scene->row[i].leaks.finding_count && scene->row[i].broken[0]; k++)
            print_finding(&scene->row[i], &scene->row[i].leaks.finding[k]);
    printf(
        "what it means\n  %zu of %zu rows promise a closed mesh to be closed (tri woop; on a tree "
        "also box watertight; none as published), the others are counted\n",
        promising, scene->row_count);
    if (scene->vacuous[0])
        printf("  vacuous: %s\n", scene->vacuous);
    putchar('\n');
}

int leaks_exit(const struct leak_scene *scene, bool layout_named, bool engine_named)
{
    int code = scene->vacuous[0] ? EXIT_MISMATCH : EXIT_AGREE;
    size_t refused = 0, on_layouts = 0;
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct leak_row *row = &scene->row[i];
        bool is_layouts = row->status == STATUS_LIMIT && !row->engine;
        on_layouts += row->layout != NULL;
        refused += is_layouts;
        if (row->status == STATUS_OK)
            code = exit_worse(code, row->broken[0] ? EXIT_MISMATCH : EXIT_AGREE);
        else if (is_layouts ? layout_named : engine_named || row->status != STATUS_UNSUPPORTED)
            code = exit_worse(code, exit_of_status(row->status));
    }
    if (refused > 0 && refused == on_layouts) /* nothing ran on any layout */
        code = exit_worse(code, exit_of_status(STATUS_LIMIT));
    return code;
}

static enum turnout_end end_of(const struct leak_row *row)
{
    switch (row->status) {
    case STATUS_OK:
        return TURNOUT_ANSWERED;
    case STATUS_LIMIT:
    case STATUS_REFUSED:
        return TURNOUT_REFUSED;
    case STATUS_UNSUPPORTED:
        return row->absent ? TURNOUT_ABSENT : TURNOUT_SKIPPED;
    default:
        return TURNOUT_FAILED;
    }
}

void leaks_count_turnout(const struct leak_scene *scene, struct turnout *turnout)
{
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct leak_row *row = &scene->row[i];
        enum turnout_end end = end_of(row);
        if (row->engine)
            turnout_add(turnout, "engine", row->engine->name, end, 1, row->reason.text);
        if (row->layout)
            turnout_add(turnout, "layout", row->layout->name,
                        row->engine && end == TURNOUT_REFUSED ? TURNOUT_SKIPPED : end, 1,
                        row->reason.text);
    }
}

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
                    row->own_test ? "own" : row->tri->name, (int)row->promises, row->broken,
                    status_text(row->status), row->reason.text);
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
        json_array_append_new(scenes,
                              json_record("scene=%s triangles=%u points=%u edges=%u rays=%zu "
                                          "origins=%zu aimed_exactly=%zu vacuous=%s",
                                          scene[s].spec, scene[s].tri_count, scene[s].point_count,
                                          scene[s].edge_count, scene[s].ray_count, inside->origins,
                                          inside->exact, scene[s].vacuous));
        for (size_t i = 0; i < scene[s].row_count; i++)
            json_array_append_new(rows, row_json(&scene[s], &scene[s].row[i]));
    }
    json_t *root = json_record("raydiff=%s profile=%s exit=%d scenes=%p named=%p rows=%p",
                               RAYDIFF_VERSION, scene_count ? scene[0].profile->name : "",
                               exit_code, scenes, json_turnout(turnout), rows);
    return json_write(path, root, 17, reason);
}
