/* Output of raydiff leaks: the table, the findings, and which rows keep their promise. */
#include "cmd/leaks/cmd_leaks.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/store.h"

#include <stdio.h>
#include <string.h>

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

const char *leak_row_tri(const struct leak_row *row)
{
    if (row->engine && row->engine->tri_name)
        return row->engine->tri_name;
    return row->own_test ? "own" : row->tri->name;
}

const char *leak_row_ended(const struct leak_row *row)
{
    return row->status == STATUS_LIMIT || row->status == STATUS_REFUSED ? "refused"
           : row->status == STATUS_UNSUPPORTED                          ? "skipped"
                                                                        : "failed";
}

/* True if trees were wanted and every layout refused: nothing ran on any. */
static bool all_refused(const struct leak_scene *scene)
{
    size_t refused = 0, on_layouts = 0;
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct leak_row *row = &scene->row[i];
        on_layouts += row->layout != NULL;
        refused += row->status == STATUS_LIMIT && !row->engine;
    }
    return refused > 0 && refused == on_layouts;
}

/* Prints each reason of a layout or an engine once. */
static void print_reasons(const struct leak_scene *scene, const struct screen *screen)
{
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct leak_row *row = &scene->row[i], *other = scene->row;
        const char *name = row->engine ? row->engine->name : row->layout->name;
        while (other < row && strcmp(other->reason.text, row->reason.text) != 0)
            other++;
        if (row->status != STATUS_OK && other == row)
            screen_text(screen, "  %s %s: %s\n", name, leak_row_ended(row), row->reason.text);
    }
    if (all_refused(scene))
        screen_text(screen, "  nothing ran on a layout: every one refuses\n");
}

static void print_world(const struct leak_scene *scene, const struct screen *screen)
{
    screen_text(screen,
                "%s: %u placed triangles, %u instances, %s; %zu rays from %zu points inside, "
                "seed %llu\n",
                scene->spec, scene->tri_count, scene->instances,
                scene->seams ? "closed only together" : "each closed, that rays start in",
                scene->ray_count, scene->inside.origins, (unsigned long long)scene->seed);
    if (scene->seams)
        screen_text(screen, "seams between instances: counted, not judged\n");
}

static void print_scene(const struct leak_scene *scene, const struct screen *screen)
{
    const struct inside *inside = &scene->inside;
    screen_text(
        screen,
        "%s: %s, %s, %s, closed; %s from %s inside, seed %llu; %.1f %% of them aimed without "
        "rounding\n",
        scene->spec, COUNTED(scene->tri_count, "triangle"), COUNTED(scene->point_count, "point"),
        COUNTED(scene->edge_count, "edge"), COUNTED(scene->ray_count, "ray"),
        COUNTED(inside->origins, "point"), (unsigned long long)scene->seed,
        100.0 * (double)inside->exact / (double)scene->ray_count);
}

void leaks_print(const struct leak_scene *scene, const struct screen *screen)
{
    const struct leak_profile *profile = scene->profile;
    (scene->is_world ? print_world : print_scene)(scene, screen);
    screen_text(screen, "profile %s: %s\n", profile->name, profile->summary);
    if (screen->wide)
        leaks_print_wide(scene);
    else
        leaks_print_table(scene, screen);
    size_t promising = 0;
    for (size_t i = 0; i < scene->row_count; i++)
        promising += scene->row[i].promises;
    for (size_t i = 0; i < scene->row_count; i++)
        for (size_t k = 0; k < scene->row[i].leaks.finding_count && scene->row[i].broken[0]; k++)
            print_finding(&scene->row[i], &scene->row[i].leaks.finding[k]);
    puts("what it means");
    screen_text(screen,
                "  %zu of %zu rows promise a closed mesh to be closed (tri woop; on a tree "
                "also box watertight; none as published), the others are counted\n",
                promising, scene->row_count);
    print_reasons(scene, screen);
    if (scene->vacuous[0])
        screen_text(screen, "  vacuous: %s\n", scene->vacuous);
    putchar('\n');
}

void leaks_print_conclusion(const struct leak_scene *scene, size_t count, int code,
                            const struct screen *screen)
{
    size_t rows = 0, kept = 0, broken = 0, counted = 0, vacuous = 0;
    for (size_t s = 0; s < count; s++) {
        rows += scene[s].row_count;
        vacuous += scene[s].vacuous[0] != '\0';
        for (size_t i = 0; i < scene[s].row_count; i++) {
            const struct leak_row *row = &scene[s].row[i];
            broken += row->status == STATUS_OK && row->broken[0];
            kept += row->status == STATUS_OK && !row->broken[0] && row->promises;
            counted += row->status == STATUS_OK && !row->broken[0] && !row->promises;
        }
    }
    if (rows == 0) /* no scene could be read */
        return;
    char text[300] = "";
    text_append(text, sizeof text, "%s: %zu kept, %zu broken, %zu counted", COUNTED(rows, "row"),
                kept, broken, counted);
    if (rows > kept + broken + counted)
        text_append(text, sizeof text, ", %zu did not run", rows - kept - broken - counted);
    if (vacuous)
        text_append(text, sizeof text, "; vacuous, see above");
    screen_paint(screen, code == EXIT_AGREE ? PAINT_GOOD : PAINT_BAD);
    screen_text(screen, "conclusion: %s\n", text);
    screen_paint(screen, PAINT_PLAIN);
}

int leaks_exit(const struct leak_scene *scene, bool layout_named, bool engine_named)
{
    int code = scene->vacuous[0] ? EXIT_MISMATCH : EXIT_AGREE;
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct leak_row *row = &scene->row[i];
        bool is_layouts = row->status == STATUS_LIMIT && !row->engine;
        if (row->status == STATUS_OK)
            code = exit_worse(code, row->broken[0] ? EXIT_MISMATCH : EXIT_AGREE);
        else if (is_layouts ? layout_named : engine_named || row->status != STATUS_UNSUPPORTED)
            code = exit_worse(code, exit_of_status(row->status));
    }
    if (all_refused(scene))
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
