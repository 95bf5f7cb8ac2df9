/* The last line of raydiff check against the rows that it is about, drawn at random: scenes,
 * layouts, storages, engines, builders, tests and queries in any order. What it says of speeds is
 * found here in another way: rows have names, and a row is beside the one of f32 of its name. */
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

#define ROWS   32u
#define SCENES 2u
#define NAME   64u

/* What is printed. */
static char *printed(const struct check_scene *scene, size_t count, int code, bool colour)
{
    const struct screen screen = {.width = SCREEN_WIDTH, .wide = true, .colour = colour};
    char *text = NULL;
    size_t size;
    FILE *before = stdout, *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    stdout = stream;
    check_print_conclusion(scene, count, code, &screen);
    stdout = before;
    assert_int_equal(fclose(stream), 0);
    return text;
}

/* Members that a row of f32 beside another has in common with it, as one word. */
static void draw_beside(struct rng *rng, struct row *row, char name[NAME])
{
    const uint32_t drawn = rng_below(rng, 32);
    const unsigned e = drawn & 1, b = drawn >> 1 & 1, x = drawn >> 2 & 1, t = drawn >> 3 & 1,
                   q = drawn >> 4 & 1;
    row->engine = engines[e];
    row->options.builder = builders_all[b];
    row->options.box = box_tests[x];
    row->options.tri = tri_tests[t];
    row->options.query = q ? QUERY_ANY : QUERY_CLOSEST;
    snprintf(name, NAME, "e%u b%u x%u t%u q%u", e, b, x, t, q);
}

/* A name of the layout with its storage; "": none. */
static void draw_layout(struct rng *rng, struct row *row, char name[NAME])
{
    static const char *const layout[] = {"f32", "f32", "f32", "rf16", "half4"};
    const uint32_t which = rng_below(rng, 6), stored = rng_below(rng, 4);
    name[0] = '\0';
    if (which == 5)
        return;
    row->layout = layout_find(layout[which]);
    assert_non_null(row->layout);
    row->options.store = stored == 0 ? NULL : tri_stores[stored == 1];
    snprintf(name, NAME, "%s%s%s", layout[which], stored == 1 ? ":" : "",
             stored == 1 ? tri_stores[1]->name : "");
}

/* Least and most of a row's runs around a median; now and then of one run. */
static void draw_speed(struct rng *rng, struct row *row)
{
    const double part = rng_float(rng);
    const double middle = (1 + part) * (double)(1u << rng_below(rng, 5));
    const double span = rng_below(rng, 4) ? 1.0 + 0.25 * rng_float(rng) : 1.0;
    row->mrays[0] = middle;
    row->mrays[1] = middle / span;
    row->mrays[2] = middle * span;
}

struct drawn_row {
    char beside[NAME], layout[NAME];
};

struct drawn_rows {
    struct row row[SCENES][ROWS];
    struct drawn_row name[SCENES][ROWS];
    struct check_scene scene[SCENES];
};

static struct drawn_rows *draw_rows(struct rng *rng)
{
    struct drawn_rows *d = calloc(1, sizeof *d);
    assert_non_null(d);
    for (size_t s = 0; s < SCENES; s++) {
        struct check_scene *scene = &d->scene[s];
        scene->row = d->row[s];
        const uint32_t wanted = rng_below(rng, ROWS + 1);
        for (uint32_t i = 0; i < wanted; i++) {
            struct row *row = &d->row[s][scene->row_count];
            struct drawn_row *name = &d->name[s][scene->row_count];
            *row = (struct row){.judged = rng_below(rng, 8) > 0, .rays = 1 + rng_below(rng, 1000)};
            draw_beside(rng, row, name->beside);
            draw_layout(rng, row, name->layout);
            draw_speed(rng, row);
            if (rng_below(rng, 8) == 0)
                row->status = ROW_REFUSED + (enum row_status)rng_below(rng, 4);
            if (rng_below(rng, 8) == 0)
                row->count[VERDICT_WRONG] = row->differences =
                    1 + rng_below(rng, (uint32_t)row->rays);
            if (rng_below(rng, 16) == 0)
                row->differences = 1; /* lost beside edges, or other bits: not WRONG */
            size_t same = 0;
            while (strcmp(d->name[s][same].beside, name->beside) != 0 ||
                   strcmp(d->name[s][same].layout, name->layout) != 0)
                same++;
            scene->row_count += same == scene->row_count; /* no row twice */
        }
    }
    return d;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

/* Whether two ranges lie apart by more than the wider spans. */
static bool apart(const struct row *a, const struct row *b)
{
    const double gap = larger(a->mrays[1] / b->mrays[2], b->mrays[1] / a->mrays[2]);
    const double span = larger(a->mrays[2] / a->mrays[1], b->mrays[2] / b->mrays[1]);
    return span > 1 && gap > span;
}

static bool is_sound(const struct row *row)
{
    return row->status == ROW_OK && row->judged && row->differences == 0;
}

/* The conclusion on speeds, "" for none: each row of f32 is compared with those of its name. */
static void speeds_of(const struct drawn_rows *d, char *text, size_t text_bytes)
{
    double best = 0;
    for (size_t s = 0; s < SCENES; s++)
        for (size_t i = 0; i < ROWS; i++)
            for (size_t b = 0; b < ROWS; b++) {
                const struct row *row = &d->row[s][i], *base = &d->row[s][b];
                if (i == b || i >= d->scene[s].row_count || b >= d->scene[s].row_count ||
                    strcmp(d->name[s][b].layout, "f32") != 0 || d->name[s][i].layout[0] == '\0' ||
                    strcmp(d->name[s][i].beside, d->name[s][b].beside) != 0 || !is_sound(row) ||
                    !is_sound(base))
                    continue;
                const double speed = row->mrays[0] / base->mrays[0];
                if (best == 0)
                    snprintf(text, text_bytes, "; speeds cannot be told apart");
                if (apart(row, base) && speed > best) {
                    best = speed;
                    snprintf(text, text_bytes, "; %s on %s has %.2f times f32's speed",
                             d->name[s][i].layout, row->engine->name, speed);
                }
            }
}

static size_t rows_that(const struct drawn_rows *d, enum row_status status, bool judged_only)
{
    size_t count = 0;
    for (size_t s = 0; s < SCENES; s++)
        for (size_t i = 0; i < d->scene[s].row_count; i++)
            count += d->row[s][i].status == status && (!judged_only || is_sound(&d->row[s][i]));
    return count;
}

static void expected_of(const struct drawn_rows *d, char *text, size_t text_bytes)
{
    static const char *const ended[] = {"refused", "skipped", "failed", "vacuous"};
    size_t rows = 0, published = 0, rays = 0, wrong = 0;
    char speeds[256] = "";
    for (size_t s = 0; s < SCENES; s++)
        for (size_t i = 0; i < d->scene[s].row_count; i++) {
            const struct row *row = &d->row[s][i];
            const bool ran = row->status == ROW_OK;
            rows++;
            published += ran && !row->judged;
            rays += ran && row->judged ? row->rays : 0;
            wrong += ran && row->judged ? row->count[VERDICT_WRONG] : 0;
        }
    text[0] = '\0';
    if (rows == 0)
        return;
    text_append(text, text_bytes, "conclusion: %zu of %zu rows agree", rows_that(d, ROW_OK, true),
                rows - published);
    if (published)
        text_append(text, text_bytes, ", %zu as published counted", published);
    for (size_t k = 0; k < ARRAY_COUNT(ended); k++) {
        const size_t count = rows_that(d, ROW_REFUSED + (enum row_status)k, false);
        if (count)
            text_append(text, text_bytes, ", %zu %s", count, ended[k]);
    }
    if (rays)
        text_append(text, text_bytes, ", %zu of %zu answers WRONG", wrong, rays);
    speeds_of(d, speeds, sizeof speeds);
    text_append(text, text_bytes, "%s\n", speeds);
}

static void every_number_is_that_of_the_rows(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 1);
    size_t said[3] = {0}; /* of speeds: nothing, that they cannot be told apart, one */
    for (int turn = 0; turn < 3000; turn++) {
        struct drawn_rows *d = draw_rows(&rng);
        char expected[512];
        expected_of(d, expected, sizeof expected);
        char *text = printed(d->scene, SCENES, 0, false);
        assert_string_equal(text, expected);
        said[strstr(text, "has") ? 2 : strstr(text, "speeds") ? 1 : 0]++;
        free(text);
        free(d);
    }
    assert_true(said[0] > 100 && said[1] > 100 && said[2] > 100);
}

/* Good only where the command's exit code is. */
static void its_colour_is_that_of_the_exit_code(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 2);
    struct drawn_rows *d = draw_rows(&rng);
    assert_true(d->scene[0].row_count > 0);
    for (int code = 0; code < 4; code++) {
        char *text = printed(d->scene, SCENES, code, true);
        const char *const begins = code ? "\033[1;31mconclusion: " : "\033[32mconclusion: ";
        assert_int_equal(strncmp(text, begins, strlen(begins)), 0);
        assert_non_null(strstr(text, "\033[0m"));
        free(text);
    }
    free(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_number_is_that_of_the_rows),
        cmocka_unit_test(its_colour_is_that_of_the_exit_code),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
