/* The last line of raydiff check. */
#include "cmd/check/cmd_check.h"

#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/store.h"

#include <stdio.h>
#include <string.h>

struct conclusion {
    size_t rows, agree, counted;   /* all; of them judged without fault; as published */
    size_t ended[ROW_VACUOUS + 1]; /* rows by their status */
    size_t judged, wrong;          /* answers */
    bool beside;                   /* a row that agrees is beside one of f32 that agrees */
    const struct row *fastest;     /* of those whose speed can be told from f32's; NULL: none */
    double speed;                  /* of it, in multiples of f32's */
};

static bool agrees(const struct row *row)
{
    return row->status == ROW_OK && row->judged && row->differences == 0;
}

/* The row of f32 that differs from `row` in the layout and the storage alone; or NULL. */
static const struct row *f32_beside(const struct check_scene *scene, const struct row *row)
{
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *base = &scene->row[i];
        if (base->status == ROW_OK && base->layout && strcmp(base->layout->name, "f32") == 0 &&
            (!base->options.store || base->options.store == tri_stores[0]) &&
            base->engine == row->engine && base->options.builder == row->options.builder &&
            base->options.tri == row->options.tri && base->options.box == row->options.box &&
            base->options.query == row->options.query)
            return base;
    }
    return NULL;
}

static double over(double a, double b)
{
    return b > 0 ? a / b : 0;
}

bool check_speeds_differ(const struct row *a, const struct row *b)
{
    const double span_a = over(a->mrays[2], a->mrays[1]), span_b = over(b->mrays[2], b->mrays[1]);
    const double wider = span_a > span_b ? span_a : span_b;
    const double apart =
        a->mrays[1] > b->mrays[2] ? over(a->mrays[1], b->mrays[2]) : over(b->mrays[1], a->mrays[2]);
    return wider > 1 && apart > wider;
}

static void look_whether_faster(const struct check_scene *scene, const struct row *row,
                                struct conclusion *all)
{
    const struct row *base = row->layout && agrees(row) ? f32_beside(scene, row) : NULL;
    if (!base || base == row || !agrees(base) || !(base->mrays[0] > 0))
        return;
    all->beside = true;
    double speed = row->mrays[0] / base->mrays[0];
    if (!check_speeds_differ(row, base) || (all->fastest && speed <= all->speed))
        return;
    all->fastest = row;
    all->speed = speed;
}

static struct conclusion conclude(const struct check_scene *scene, size_t count)
{
    struct conclusion all = {0};
    for (size_t s = 0; s < count; s++)
        for (size_t i = 0; i < scene[s].row_count; i++) {
            const struct row *row = &scene[s].row[i];
            all.rows++;
            all.ended[row->status]++;
            if (row->status != ROW_OK)
                continue;
            all.agree += agrees(row);
            all.counted += !row->judged;
            all.judged += row->judged ? row->rays : 0;
            all.wrong += row->judged ? row->count[VERDICT_WRONG] : 0;
            look_whether_faster(&scene[s], row, &all);
        }
    return all;
}

void check_print_conclusion(const struct check_scene *scene, size_t count, int code,
                            const struct screen *screen)
{
    const struct conclusion all = conclude(scene, count);
    if (all.rows == 0) /* no scene could be read */
        return;
    char text[512] = "", name[STORED_NAME_MOST];
    text_append(text, sizeof text, "%zu of %zu rows agree", all.agree, all.rows - all.counted);
    if (all.counted)
        text_append(text, sizeof text, ", %zu as published counted", all.counted);
    for (enum row_status status = ROW_REFUSED; status <= ROW_VACUOUS; status++)
        if (all.ended[status])
            text_append(text, sizeof text, ", %zu %s", all.ended[status], row_status_name(status));
    if (all.judged)
        text_append(text, sizeof text, ", %zu of %zu answers WRONG", all.wrong, all.judged);
    if (all.fastest)
        text_append(text, sizeof text, "; %s on %s has %.2f times f32's speed",
                    stored_name(all.fastest->layout, all.fastest->options.store, name),
                    all.fastest->engine->name, all.speed);
    else if (all.beside)
        text_append(text, sizeof text, "; speeds cannot be told apart");
    screen_paint(screen, code == EXIT_AGREE ? PAINT_GOOD : PAINT_BAD);
    screen_text(screen, "conclusion: %s\n", text);
    screen_paint(screen, PAINT_PLAIN);
}
