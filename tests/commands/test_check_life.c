/* What raydiff check --steps says of trees and engines against the rows that it is about, drawn at
 * random: each name stands once in the list of what was done with it, and an engine that is wrong
 * has both of its numbers. What is expected is found name by name. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/check/cmd_check.h"
#include "ref/base/rng.h"
#include "ref/base/text.h"
#include "ref/store.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROWS 12u
#define TEXT 6000u

static char *printed(const struct check_scene *scene)
{
    const struct screen screen = {.width = SCREEN_WIDTH, .wide = true};
    char *text = NULL;
    size_t size;
    FILE *before = stdout, *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    stdout = stream;
    check_print_life(scene, &screen);
    stdout = before;
    assert_int_equal(fclose(stream), 0);
    return text;
}

/* Names that are parts of others are among them. */
static void draw_row(struct rng *rng, struct row *row)
{
    static const char *const layout[] = {"f32",           "rf16",  "rtrs_rf",
                                         "rtrs_rf_paper", "gfx12", "gfx12_mesa"},
                             *const engine[] = {"cpu",   "cpu_stackless", "vulkan", "vulkan_brute",
                                                "brute", "embree_robust", "embree"};
    *row = (struct row){.status = rng_below(rng, 5)   ? ROW_OK
                                  : rng_below(rng, 2) ? ROW_REFUSED
                                                      : ROW_SKIPPED};
    row->layout = rng_below(rng, 4) ? layout_find(layout[rng_below(rng, 6)]) : NULL;
    row->engine = engine_find(engine[rng_below(rng, 7)]);
    row->options.store = rng_below(rng, 3) ? NULL : tri_stores[rng_below(rng, 3)];
    row->life.fate = LIFE_REFITTED + rng_below(rng, 3);
    row->life.updated = rng_below(rng, 2) && row->life.fate == LIFE_REFITTED;
    row->life.again = row->status == ROW_OK && !rng_below(rng, 4);
    row->count[VERDICT_WRONG] = 1 + rng_below(rng, 100);
    row->life.wrong_again = rng_below(rng, 2) ? rng_below(rng, 100) : 0;
    assert_non_null(row->engine);
}

/* Whether row i is in the list that `which` stands for: 0 to 2 fates of trees, then engines that
 * updated, then engines prepared anew. Writes its name there. */
static bool is_listed(const struct row *row, unsigned which, char name[STORED_NAME_MOST])
{
    if (which < 3) {
        if (!row->layout || row->status == ROW_REFUSED ||
            row->life.fate != LIFE_REFITTED + (enum life_fate)which)
            return false;
        char room[STORED_NAME_MOST];
        snprintf(name, STORED_NAME_MOST, "%s", stored_name(row->layout, row->options.store, room));
        return true;
    }
    snprintf(name, STORED_NAME_MOST, "%s", row->engine->name);
    return row->status == ROW_OK && row->life.updated == (which == 3);
}

static void expected_of(const struct check_scene *scene, char text[TEXT])
{
    static const char *const begins[] = {
        "  trees refitted: ", "  trees built again: ",
        "  trees built again: a refit cannot be stored or is not made (docs/layouts.md): ",
        "  engines that updated what they held: ", "  engines prepared anew: "};
    text[0] = '\0';
    for (unsigned which = 0; which < ARRAY_COUNT(begins); which++) {
        size_t listed = 0;
        for (size_t i = 0; i < scene->row_count; i++) {
            char name[STORED_NAME_MOST], other[STORED_NAME_MOST];
            bool first = is_listed(&scene->row[i], which, name);
            for (size_t k = 0; k < i && first; k++)
                first = !is_listed(&scene->row[k], which, other) || strcmp(name, other) != 0;
            if (first)
                text_append(text, TEXT, "%s%s", listed++ ? ", " : begins[which], name);
        }
        text_append(text, TEXT, "%s", listed ? "\n" : "");
    }
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        if (row->life.again)
            text_append(
                text, TEXT, "  prepared anew: %s%s%s: %zu WRONG in place of %zu%s\n",
                row->engine->name, row->layout ? " " : "", row->layout ? row->layout->name : "",
                row->life.wrong_again, row->count[VERDICT_WRONG],
                row->life.wrong_again ? "" : ": its update kept something of before (stale)");
    }
}

static void every_name_and_number_is_that_of_the_rows(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 3);
    for (int turn = 0; turn < 2000; turn++) {
        struct row row[ROWS];
        char expected[TEXT];
        const struct check_scene scene = {
            .row = row, .row_count = 1 + rng_below(&rng, ROWS), .step = 1};
        for (size_t i = 0; i < scene.row_count; i++)
            draw_row(&rng, &row[i]);
        expected_of(&scene, expected);
        char *text = printed(&scene);
        assert_string_equal(text, expected);
        free(text);
    }
}

static void before_the_steps_there_is_nothing_to_say(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 4);
    struct row row;
    draw_row(&rng, &row);
    const struct check_scene scene = {.row = &row, .row_count = 1};
    char *text = printed(&scene);
    assert_string_equal(text, "");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_name_and_number_is_that_of_the_rows),
        cmocka_unit_test(before_the_steps_there_is_nothing_to_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
