/* The exit code and the last line of raydiff leaks against the rows that they are of, drawn at
 * random: layouts that refuse, engines with and without a layout that end in every way. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/leaks/cmd_leaks.h"
#include "ref/base/command.h"
#include "ref/base/rng.h"
#include "ref/base/text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROWS   12u
#define SCENES 2u

/* What a row of an engine comes to: the code where the engine was named, and where it was not. */
static const struct {
    enum status status;
    int named, unnamed;
} ends[] = {{STATUS_OK, 0, 0},           {STATUS_INPUT, 2, 2},   {STATUS_LIMIT, 2, 2},
            {STATUS_REFUSED, 1, 1},      {STATUS_DEVICE, 3, 3},  {STATUS_MEMORY, 4, 4},
            {STATUS_UNSUPPORTED, 77, 0}, {STATUS_INTERNAL, 4, 4}};

/* Rows of some scenes, and what they come to by kind. */
struct drawn {
    struct leak_row row[SCENES][ROWS];   /* behind the last of a scene one that is none of it */
    struct leak_scene scene[SCENES + 1]; /* and one that is not printed */
    size_t kept, broken, counted, vacuous, rows;
};

static struct leak_row layout_that_refuses(void)
{
    return (struct leak_row){.layout = layouts_all[0], .status = STATUS_LIMIT};
}

static struct leak_row none_of_it(void)
{
    return (struct leak_row){
        .engine = engines[0], .layout = layouts_all[0], .status = STATUS_INTERNAL};
}

/* Few rows, and often those of one kind, so that each decides the code at times. */
static void draw_rows(struct rng *rng, struct drawn *d)
{
    *d = (struct drawn){.kept = 0};
    for (size_t s = 0; s < SCENES; s++) {
        struct leak_scene *scene = &d->scene[s];
        const uint32_t only = rng_below(rng, 3), count = rng_below(rng, ROWS);
        scene->row = d->row[s];
        scene->row_count = rng_below(rng, 2) ? count : count % 3;
        if (rng_below(rng, 6) == 0)
            strcpy(scene->vacuous, "!");
        d->vacuous += scene->vacuous[0] != '\0';
        d->rows += scene->row_count;
        scene->row[scene->row_count] = none_of_it();
        for (size_t i = 0; i < scene->row_count; i++) {
            struct leak_row *row = &scene->row[i];
            if (only == 0 || (only == 1 && rng_below(rng, 4) == 0)) {
                *row = layout_that_refuses();
                continue;
            }
            const uint32_t end = rng_below(rng, 2) ? 0 : rng_below(rng, ARRAY_COUNT(ends));
            *row = (struct leak_row){.engine = engines[0], .status = ends[end].status};
            row->layout = rng_below(rng, 2) ? layouts_all[0] : NULL;
            row->promises = rng_below(rng, 2);
            if (rng_below(rng, 5) == 0)
                strcpy(row->broken, "!");
            if (end == 0) {
                d->broken += row->broken[0] != '\0';
                d->kept += !row->broken[0] && row->promises;
                d->counted += !row->broken[0] && !row->promises;
            }
        }
    }
}

/* The code of a row. */
static int code_of(const struct leak_row *row, bool layout_named, bool engine_named)
{
    if (!row->engine)
        return layout_named ? 2 : 0;
    if (row->status == STATUS_OK)
        return row->broken[0] ? 1 : 0;
    size_t i = 1;
    while (ends[i].status != row->status)
        i++;
    return engine_named ? ends[i].named : ends[i].unnamed;
}

static int expected_of(const struct leak_scene *scene, bool layout_named, bool engine_named)
{
    static const int worst_first[] = {4, 3, 2, 1, 77, 0};
    bool seen[78] = {[0] = true};
    size_t on_layouts = 0, by_layouts = 0;
    for (size_t i = 0; i < scene->row_count; i++) {
        seen[code_of(&scene->row[i], layout_named, engine_named)] = true;
        on_layouts += scene->row[i].layout != NULL;
        by_layouts += scene->row[i].engine == NULL;
    }
    seen[1] = seen[1] || scene->vacuous[0];
    seen[2] = seen[2] || (by_layouts > 0 && by_layouts == on_layouts);
    size_t i = 0;
    while (!seen[worst_first[i]])
        i++;
    return worst_first[i];
}

static void each_row_has_its_exit_code(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 1);
    static struct drawn d;
    size_t times[78] = {0};
    for (int turn = 0; turn < 4000; turn++) {
        draw_rows(&rng, &d);
        for (uint32_t named = 0; named < 4; named++) {
            const int code = leaks_exit(&d.scene[0], named & 1, named & 2);
            assert_int_equal(code, expected_of(&d.scene[0], named & 1, named & 2));
            times[code]++;
        }
    }
    for (int code = 0; code < 5; code++)
        assert_true(times[code] > 500);
    assert_true(times[77] > 40);
}

static char *printed(const struct drawn *d)
{
    const struct screen screen = {.width = SCREEN_WIDTH, .wide = true};
    char *text = NULL;
    size_t size;
    FILE *before = stdout, *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    stdout = stream;
    leaks_print_conclusion(d->scene, SCENES, 0, &screen);
    stdout = before;
    assert_int_equal(fclose(stream), 0);
    return text;
}

static void every_row_is_in_the_last_line_once(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 2);
    static struct drawn d;
    struct leak_row other[2] = {{.engine = engines[0], .promises = true}};
    other[1] = other[0];
    for (int turn = 0; turn < 2000; turn++) {
        char expected[200] = "";
        draw_rows(&rng, &d);
        for (size_t s = 0; s < SCENES; s++)
            d.scene[s].row[d.scene[s].row_count] = other[0];
        d.scene[SCENES] = (struct leak_scene){.row = other, .row_count = 2};
        const size_t others = d.rows - d.kept - d.broken - d.counted;
        if (d.rows) {
            text_append(expected, sizeof expected,
                        "conclusion: %zu row%s: %zu kept, %zu broken, %zu counted", d.rows,
                        d.rows == 1 ? "" : "s", d.kept, d.broken, d.counted);
            if (others)
                text_append(expected, sizeof expected, ", %zu did not run", others);
            text_append(expected, sizeof expected, "%s\n", d.vacuous ? "; vacuous, see above" : "");
        }
        char *text = printed(&d);
        assert_string_equal(text, expected);
        free(text);
    }
}

/* The word for it in the table. */
static const char *word_of(enum turnout_end end)
{
    return end == TURNOUT_REFUSED                            ? "refused"
           : end == TURNOUT_SKIPPED || end == TURNOUT_ABSENT ? "skipped"
                                                             : "failed";
}

/* What an engine refuses is no refusal of its layout, which has no say in it. */
static void who_refuses_is_told_apart(void **state)
{
    (void)state;
    static const struct {
        enum status status;
        bool absent;
        enum turnout_end engine, layout;
    } rows[] = {{STATUS_OK, false, TURNOUT_ANSWERED, TURNOUT_ANSWERED},
                {STATUS_LIMIT, false, TURNOUT_REFUSED, TURNOUT_SKIPPED},
                {STATUS_REFUSED, false, TURNOUT_REFUSED, TURNOUT_SKIPPED},
                {STATUS_UNSUPPORTED, false, TURNOUT_SKIPPED, TURNOUT_SKIPPED},
                {STATUS_UNSUPPORTED, true, TURNOUT_ABSENT, TURNOUT_ABSENT},
                {STATUS_DEVICE, false, TURNOUT_FAILED, TURNOUT_FAILED},
                {STATUS_MEMORY, false, TURNOUT_FAILED, TURNOUT_FAILED}};
    static struct turnout turnout;
    struct leak_row row[3]; /* two of the scene */
    const struct leak_scene scene = {.row = row, .row_count = 2};
    const struct turnout_one *const engine = &turnout.one[0], *const layout = &turnout.one[1];
    for (size_t i = 0; i <= ARRAY_COUNT(rows); i++) {
        memset(&turnout, 0, sizeof turnout);
        turnout_name(&turnout, "engine", engines[0]->name);
        turnout_name(&turnout, "layout", layouts_all[0]->name);
        row[0] = layout_that_refuses();
        if (i < ARRAY_COUNT(rows)) {
            row[0].engine = engines[0];
            row[0].status = rows[i].status;
            row[0].absent = rows[i].absent;
        }
        row[1] = row[0];
        row[2] = none_of_it();
        leaks_count_turnout(&scene, &turnout);
        assert_int_equal(turnout_asked(engine), i < ARRAY_COUNT(rows) ? 2 : 0);
        assert_int_equal(turnout_asked(layout), 2);
        if (i < ARRAY_COUNT(rows)) {
            assert_int_equal(engine->end[rows[i].engine], 2);
            assert_int_equal(layout->end[rows[i].layout], 2);
            if (rows[i].status != STATUS_OK)
                assert_string_equal(leak_row_ended(&row[0]), word_of(rows[i].engine));
        } else {
            assert_string_equal(leak_row_ended(&row[0]), "refused");
            assert_int_equal(layout->end[TURNOUT_REFUSED], 2);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_row_has_its_exit_code),
        cmocka_unit_test(every_row_is_in_the_last_line_once),
        cmocka_unit_test(who_refuses_is_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
