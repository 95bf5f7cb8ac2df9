/* What raydiff check says of all its rows at once, of rows drawn at random: each line stands there
 * if there is a row that it is about, whatever else is there, with numbers found here in another
 * way; and of several scenes each counts. */
#define _GNU_SOURCE /* open_memstream */
#include "tests/commands/told_check.h"

#include "cmd/common/cmd_compiler.h"
#include "ref/base/command.h"
#include "ref/base/rng.h"
#include "ref/base/text.h"

#define ROWS   7u
#define SCENES 4u
#define TEXT   8000u

struct summed_check {
    struct engine library, compiled[2];
    struct row row[ROWS];
    struct check_scene scene;
};

static void draw_row(struct rng *rng, struct summed_check *d, struct row *row)
{
    static const char *const layout[] = {"f32", "f32", "rf16", "half4"};
    const uint32_t player = rng_below(rng, 5);
    *row = (struct row){.status = rng_below(rng, 5) ? ROW_OK : ROW_REFUSED,
                        .options = {.builder = builders_all[rng_below(rng, 2)],
                                    .build = {.leaf = 4},
                                    .store = tri_stores[rng_below(rng, 2)],
                                    .box = box_tests[rng_below(rng, 2)],
                                    .tri = tri_tests[rng_below(rng, 2)],
                                    .query = (enum query)rng_below(rng, 2)},
                        .engine = player == 0   ? &d->library
                                  : player == 1 ? engine_find("cpu")
                                  : player == 2 ? engine_find("vulkan")
                                                : &d->compiled[player - 3],
                        .layout = player == 0 ? NULL : layout_find(layout[rng_below(rng, 4)]),
                        .rays = 1 + rng_below(rng, 9),
                        .bits = rng_below(rng, 2) == 0,
                        .judged = rng_below(rng, 2) == 0,
                        .bit_differences = rng_below(rng, 9),
                        .unknown = rng_below(rng, 8) == 0};
    row->node_bytes = 1 + rng_below(rng, 900);
    row->item_bytes = 1 + rng_below(rng, 900);
    row->scene_bytes = 1 + rng_below(rng, 900);
    row->mrays[0] = 10 + rng_below(rng, 40);
    row->mrays[1] = row->mrays[0] - 1 - rng_below(rng, 8);
    row->mrays[2] = row->mrays[0] + 1 + rng_below(rng, 8);
    row->count[VERDICT_WRONG] = rng_below(rng, 3);
    row->moved = rng_below(rng, 9);
    row->against = engine_find("vulkan");
    row->compiled = (struct engine_compiled){.compiler = row->engine->name,
                                             .raw = engine_find("vulkan"),
                                             .ops = rng_below(rng, 90),
                                             .kept = rng_below(rng, 90),
                                             .foreign = rng_below(rng, 9),
                                             .free = row->engine == &d->compiled[1],
                                             .words = player > 2 ? 1 + rng_below(rng, 9) : 0};
}

static void draw(struct rng *rng, struct summed_check *d)
{
    *d = (struct summed_check){.library = *engine_find("brute"),
                               .compiled = {*engine_find("vulkan"), *engine_find("vulkan")}};
    d->library.name = "lib";
    d->library.library = true;
    d->library.reference = false;
    d->compiled[0].name = "c0";
    d->compiled[1].name = "c1";
    d->scene = (struct check_scene){.spec = "s",
                                    .tri_count = 50,
                                    .vertex_count = 9,
                                    .rays = "r",
                                    .ray_count = 9,
                                    .row = d->row,
                                    .row_count = 1 + rng_below(rng, ROWS)};
    for (size_t i = 0; i < d->scene.row_count; i++)
        draw_row(rng, d, &d->row[i]);
}

static const char *name_of(const struct row *row, char text[STORED_NAME_MOST])
{
    snprintf(text, STORED_NAME_MOST, "%s%s%s", row->layout->name,
             row->options.store == tri_stores[0] ? "" : ":",
             row->options.store == tri_stores[0] ? "" : row->options.store->name);
    return text;
}

static bool are_alike(const struct row *a, const struct row *b)
{
    return a->engine == b->engine && a->options.tri == b->options.tri &&
           a->options.box == b->options.box && a->options.query == b->options.query;
}

/* Neither lies within the other's span, seen from where it ends. */
static bool are_apart(const struct row *a, const struct row *b)
{
    const double *low = a->mrays[0] < b->mrays[0] ? a->mrays : b->mrays,
                 *high = low == a->mrays ? b->mrays : a->mrays;
    const double gap = high[1] / low[2];
    return gap > low[2] / low[1] && gap > high[2] / high[1];
}

static void ratios_of(const struct summed_check *d, const char *player, char *text)
{
    char name[STORED_NAME_MOST];
    const struct row *base = NULL, *end = d->row + d->scene.row_count;
    for (const struct row *row = end; row-- > d->row;)
        if (row->status == ROW_OK && row->layout == layout_find("f32") &&
            row->engine == engine_find(player))
            base = row;
    for (const struct row *row = d->row; row < end && base; row++)
        if (row != base && row->status == ROW_OK && row->layout && are_alike(row, base))
            text_append(
                text, TEXT,
                "  %s on %s: %.2f of f32's node bytes (%.2f with f32's item array), %.2f "
                "times its speed%s\n",
                name_of(row, name), player, (double)row->node_bytes / (double)base->node_bytes,
                (double)(row->node_bytes + row->item_bytes) /
                    (double)(base->node_bytes + base->item_bytes),
                row->mrays[0] / base->mrays[0], are_apart(row, base) ? "" : ", within noise");
}

static void libraries_of(const struct summed_check *d, char *text)
{
    const struct row *cpu = NULL;
    for (size_t i = d->scene.row_count; i-- > 0;)
        if (d->row[i].status == ROW_OK && d->row[i].engine == engine_find("cpu"))
            cpu = &d->row[i];
    for (size_t i = 0; i < d->scene.row_count && cpu; i++)
        if (d->row[i].status == ROW_OK && !d->row[i].layout &&
            d->row[i].options.query == cpu->options.query)
            text_append(text, TEXT, "  cpu on %s: %.2f times the speed of lib\n", cpu->layout->name,
                        cpu->mrays[0] / d->row[i].mrays[0]);
}

/* A line for each tree that is stored, unless the line before is of the same; of none if all are
 * stored as by default. */
static void bytes_of(const struct summed_check *d, char *text)
{
    char name[STORED_NAME_MOST];
    const struct row *before = NULL;
    bool other = false;
    for (size_t i = 0; i < d->scene.row_count; i++)
        other |= d->row[i].layout && d->row[i].options.store != tri_stores[0];
    for (size_t i = 0; i < d->scene.row_count && other; i++) {
        const struct row *row = &d->row[i];
        if (row->status != ROW_OK || !row->layout)
            continue;
        if (!before || row->layout != before->layout ||
            row->options.store != before->options.store ||
            row->options.builder != before->options.builder)
            text_append(
                text, TEXT,
                "  %s: %.2f bytes a triangle: %.2f nodes, %.2f storage, %.2f the scene's arrays\n",
                name_of(row, name),
                (double)(row->node_bytes + row->item_bytes + row->scene_bytes) / 50,
                (double)row->node_bytes / 50, (double)row->item_bytes / 50,
                (double)row->scene_bytes / 50);
        before = row;
    }
}

static void agreement_of_rows(const struct summed_check *d, char *text)
{
    static const char *const against[] = {"cpu", "the shaders as built"};
    size_t published = 0;
    for (int built = 0; built < 2; built++) {
        size_t rows = 0, rays = 0, bad = 0;
        for (size_t i = 0; i < d->scene.row_count; i++) {
            const struct row *row = &d->row[i];
            if (row->status != ROW_OK || !row->bits || row->engine == engine_find("cpu") ||
                (row->compiled.words > 0) != (built == 1))
                continue;
            rows++;
            rays += row->rays;
            bad += row->bit_differences;
        }
        if (rows)
            text_append(text, TEXT, "  bit for bit against %s: %zu of %zu answers differ\n",
                        against[built], bad, rays);
    }
    for (size_t i = 0; i < d->scene.row_count; i++)
        if (d->row[i].status == ROW_OK && !d->row[i].judged)
            published += d->row[i].count[VERDICT_WRONG];
    if (published)
        text_append(text, TEXT,
                    "  members as published are wrong in %zu answer%s: counted, not judged\n",
                    published, published == 1 ? "" : "s");
}

/* Keeps of a text, from "what it means" on, the lines that say such a thing. */
static void keep(const char *text, char *out)
{
    static const char *const said[] = {" times ", "bytes a triangle", "bit for bit",
                                       "as published"};
    const char *line = strstr(text, "what it means\n");
    assert_non_null(line);
    out[0] = '\0';
    while (*(line = strchr(line, '\n') + 1)) {
        const int length = (int)strcspn(line, "\n");
        for (size_t i = 0; i < ARRAY_COUNT(said); i++) {
            const char *at = strstr(line, said[i]);
            if (at && at < line + length) {
                text_append(out, TEXT, "%.*s\n", length, line);
                break;
            }
        }
    }
}

static void each_line_is_there_if_its_rows_are(void **state)
{
    (void)state;
    const struct screen screen = {.width = 4000, .wide = true};
    struct rng rng = rng_make(12, 3);
    for (int turn = 0; turn < 1500; turn++) {
        struct summed_check d;
        char expected[TEXT] = "", got[TEXT];
        draw(&rng, &d);
        ratios_of(&d, "vulkan", expected);
        ratios_of(&d, "cpu", expected);
        libraries_of(&d, expected);
        bytes_of(&d, expected);
        agreement_of_rows(&d, expected);
        told_begin(&stdout);
        check_print(&d.scene, &screen);
        char *text = told_end();
        keep(text, got);
        assert_string_equal(got, expected);
        free(text);
    }
}

/* The sums of one engine with compiled shaders, "" of fewer than two rows; first: its first. */
static void sum_of(const struct summed_check *d, const struct row *first, char *text)
{
    size_t rows = 0, ops = 0, kept = 0, open = 0, equal = 0, other = 0, wrong = 0;
    for (const struct row *row = first; row < d->row + d->scene.row_count; row++) {
        if (row->status != ROW_OK || row->engine != first->engine)
            continue;
        rows++;
        ops += row->compiled.ops;
        kept += row->compiled.kept;
        open += row->compiled.foreign;
        equal += row->bits && row->bit_differences == 0;
        other += row->bits ? row->bit_differences : row->moved;
        wrong += row->count[VERDICT_WRONG];
    }
    if (rows < 2)
        return;
    text_append(text, TEXT, "%s vulkan %zu ", first->engine->name, rows);
    if (first->compiled.free)
        text_append(text, TEXT, "free, %zu", ops);
    else
        text_append(text, TEXT, "%zu of %zu", kept, ops);
    text_append(text, TEXT, " %zu %zu %zu %zu\n", open, equal, other, wrong);
}

/* Speeds aside, which stand behind them. */
static void each_sum_is_that_of_its_rows(void **state)
{
    (void)state;
    const struct screen screen = {.width = 4000, .wide = true};
    struct rng rng = rng_make(12, 5);
    size_t sums = 0;
    for (int turn = 0; turn < 1500; turn++) {
        struct summed_check d;
        char expected[TEXT] = "", got[TEXT] = "";
        draw(&rng, &d);
        for (size_t i = 0; i < d.scene.row_count; i++) {
            bool is_first = d.row[i].status == ROW_OK && d.row[i].compiled.words > 0;
            for (size_t k = 0; k < i && is_first; k++)
                is_first = d.row[k].status != ROW_OK || d.row[k].engine != d.row[i].engine;
            if (is_first)
                sum_of(&d, &d.row[i], expected);
        }
        told_begin(&stdout);
        compilers_print(d.row, d.scene.row_count, "s", NULL, &screen);
        char *text = told_end();
        told_squeeze(text);
        char *line = strstr(text, "all rows of a compiler");
        for (int k = 0; line && *line; k++) {
            char *end = strchr(line, '\n'), *at = end;
            *end = '\0';
            for (int words = 0; k > 1 && words < 2;) /* the two of speeds */
                words += *--at == ' ';
            if (k > 1)
                text_append(got, TEXT, "%.*s\n", (int)(at - line), line);
            line = end + 1;
        }
        assert_string_equal(got, expected);
        sums += expected[0] != '\0';
        free(text);
    }
    assert_in_range(sums, 200, 1400);
}

/* --displacement is used if any scene, whichever, has a row whose formula is unknown; where nothing
 * ran, something else is told. */
static void what_any_scene_uses_is_used(void **state)
{
    (void)state;
    struct rng rng = rng_make(12, 4);
    size_t refused = 0;
    for (int turn = 0; turn < 500; turn++) {
        struct summed_check d[SCENES];
        struct check_scene scene[SCENES];
        const size_t count = 1 + rng_below(&rng, SCENES);
        bool unknown = false, ran = false;
        for (size_t s = 0; s < count; s++) {
            draw(&rng, &d[s]);
            scene[s] = d[s].scene;
            for (size_t i = 0; i < scene[s].row_count; i++) {
                unknown |= d[s].row[i].unknown;
                ran |= d[s].row[i].status == ROW_OK;
            }
        }
        told_begin(&stderr);
        const int code = check_unused(8, scene, count), none = check_unused(0, scene, count);
        char *text = told_end();
        assert_int_equal(none, EXIT_AGREE);
        assert_int_equal(code, ran && !unknown ? EXIT_USAGE : EXIT_AGREE);
        assert_int_equal(strstr(text, "--displacement: no engine here") != NULL, ran && !unknown);
        refused += code != EXIT_AGREE;
        free(text);
    }
    assert_in_range(refused, 50, 450);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_line_is_there_if_its_rows_are),
        cmocka_unit_test(each_sum_is_that_of_its_rows),
        cmocka_unit_test(what_any_scene_uses_is_used),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
