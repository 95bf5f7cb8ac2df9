/* Numbers that commands tell, each beside its own name: what is told is made up, no two numbers of
 * it are the same, and each is looked for in the text, the JSON and the page. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/explain/cmd_explain_oriented.h"
#include "cmd/tree/cmd_tree_dump.h"

#include "tests/commands/told.h"

#include <unistd.h>

/* --- oriented boxes --------------------------------------------------------------------------- */

static struct explain_bound bound_of(uint32_t i, bool upper)
{
    const float exact = (float)(100 + 10 * i) / 3, off = (float)(1 + i) / 7;
    return (struct explain_bound){.exact = exact,
                                  .decoded = upper ? exact + off : exact - off,
                                  .fault = (enum bound_fault)(i % 3 ? BOUND_OK : BOUND_STORED),
                                  .float_steps = 1000 + i};
}

static struct explain_oriented oriented_made(void)
{
    struct explain_oriented o = {.there = true, .missed = true};
    for (uint32_t j = 0; j < 3; j++) {
        o.lo[j] = bound_of(2 * j, false);
        o.hi[j] = bound_of(2 * j + 1, true);
        o.box.step[j] = 1 / (float)(3 + 4 * j);
        o.box.enter[j] = (float)(7 + (j + 1) % 3) / 11;
        o.box.leave[j] = (float)(23 + (j + 1) % 3) / 11;
        o.exact_enter[j] = (double)(13 + j) / 17;
        o.exact_leave[j] = (double)(29 + j) / 17;
        for (uint32_t k = 0; k < 3; k++)
            o.box.axis[j][k] = (float)(3 * j + k) - 4;
    }
    return o;
}

static const struct explain_bound *side_of(const struct explain_oriented *o, uint32_t i)
{
    return i % 2 ? &o->hi[i / 2] : &o->lo[i / 2];
}

static void the_text_of_an_oriented_box(void **state)
{
    (void)state;
    const struct explain_oriented o = oriented_made();
    uint32_t bounds = 0, slabs = 0;
    for (int wide = 0; wide < 2; wide++) {
        char *text = NULL, hex[2][64], side[8];
        size_t size;
        bool of_slabs = false;
        FILE *stream = open_memstream(&text, &size);
        assert_non_null(stream);
        explain_oriented_print(stream, &o, wide);
        fclose(stream);
        for (char *line = text, *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
            double off, two[2];
            long long steps;
            uint32_t axis;
            of_slabs = of_slabs || strncmp(line, "  slab ", 7) == 0;
            if (sscanf(line, " %u %3[a-z] %63s %63s %lf %lld", &axis, side, hex[0], hex[1], &off,
                       &steps) == 6) {
                const uint32_t i = 2 * axis + (strcmp(side, "hi") == 0);
                const struct explain_bound *b = side_of(&o, i);
                const double planes =
                    ((double)b->decoded - (double)b->exact) / (double)o.box.step[axis];
                assert_true(strtof(hex[0], NULL) == b->exact);
                assert_true(strtof(hex[1], NULL) == b->decoded);
                assert_true(fabs(off - (i % 2 ? planes : -planes)) <= 1e-3 * fabs(planes));
                assert_true(steps == b->float_steps);
                assert_int_equal(sscanf(end + 1, " %lf %lf", &two[0], &two[1]), 2);
                assert_true((float)two[0] == b->exact && (float)two[1] == b->decoded);
                bounds++;
            } else if (of_slabs && sscanf(line, " %u %lf %lf", &axis, &two[0], &two[1]) == 3) {
                assert_true((float)two[0] == o.box.enter[axis]);
                assert_true((float)two[1] == o.box.leave[axis]);
                assert_int_equal(sscanf(end + 1, " %lf %lf", &two[0], &two[1]), 2);
                assert_true(two[0] == o.exact_enter[axis] && two[1] == o.exact_leave[axis]);
                end = strchr(end + 1, '\n');
                slabs++;
            }
        }
        /* The last axis that is entered, and the first that is left. */
        const char *sum = strstr(text, "oriented box test: ");
        uint32_t entered, left;
        double enter, leave;
        assert_non_null(sum);
        assert_int_equal(sscanf(sum,
                                "oriented box test: enters axis %u at %lf, leaves axis %u at %lf",
                                &entered, &enter, &left, &leave),
                         4);
        assert_true(entered == 1 && (float)enter == o.box.enter[1]);
        assert_true(left == 2 && (float)leave == o.box.leave[2]);
        assert_non_null(strstr(sum, ", no hit"));
        free(text);
    }
    assert_true(bounds == 12 && slabs == 6);
}

static void the_json_of_an_oriented_box(void **state)
{
    (void)state;
    static const char *const ends[] = {"lo", "hi"};
    const struct explain_oriented o = oriented_made();
    json_t *json = explain_oriented_json(&o);
    for (uint32_t i = 0; i < 6; i++) {
        const struct explain_bound *b = side_of(&o, i);
        char path[64];
        snprintf(path, sizeof path, "axes.%u.%s.exact.value", i / 2, ends[i % 2]);
        assert_true((float)number_at(json, path) == b->exact);
        snprintf(path, sizeof path, "axes.%u.%s.decoded.value", i / 2, ends[i % 2]);
        assert_true((float)number_at(json, path) == b->decoded);
        snprintf(path, sizeof path, "axes.%u.%s.float32_steps", i / 2, ends[i % 2]);
        assert_true((int64_t)number_at(json, path) == b->float_steps);
    }
    for (uint32_t j = 0; j < 3; j++) {
        const struct {
            const char *name;
            double is;
        } of[] = {{"step.value", (double)o.box.step[j]},
                  {"enter.value", (double)o.box.enter[j]},
                  {"leave.value", (double)o.box.leave[j]},
                  {"exact_enter", o.exact_enter[j]},
                  {"exact_leave", o.exact_leave[j]}};
        for (size_t k = 0; k < ARRAY_COUNT(of); k++) {
            char path[64];
            snprintf(path, sizeof path, "axes.%u.%s", j, of[k].name);
            assert_true(fabs(number_at(json, path) - of[k].is) <= 1e-8 * fabs(of[k].is));
        }
    }
    assert_true(json_is_false(json_object_get(json, "hit")));
    json_decref(json);
}

/* A line of the table: bound, of its triangles, in the bytes, steps, enter, leave, fault. */
static void the_page_of_an_oriented_box(void **state)
{
    (void)state;
    const struct explain_oriented o = oriented_made();
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    struct html html = {.out = stream};
    explain_oriented_html(&html, &o);
    fclose(stream);
    const char *row = text;
    for (uint32_t i = 0; i < 6; i++) {
        const struct explain_bound *b = side_of(&o, i);
        const double is[] = {(double)b->exact, (double)b->decoded, (double)b->float_steps,
                             (double)o.box.enter[i / 2], (double)o.box.leave[i / 2]};
        char name[16];
        snprintf(name, sizeof name, ">%u %s<", i / 2, i % 2 ? "hi" : "lo");
        row = strstr(row, name);
        assert_non_null(row);
        for (size_t k = 0; k < ARRAY_COUNT(is); k++) {
            row = strstr(row, "class=\"n\">");
            assert_non_null(row);
            row += strlen("class=\"n\">");
            assert_true((float)strtod(row, NULL) == (float)is[k]);
        }
    }
    free(text);
}

/* --- trees of drivers ------------------------------------------------------------------------- */

static struct tree_told told_made(struct tree_dump *dump)
{
    return (struct tree_told){.file = "t",
                              .scene = "s",
                              .dump = dump,
                              .has_scene = true,
                              .measured = true,
                              .compared = true,
                              .report = {.nodes = 11,
                                         .inner = 12,
                                         .leaves = 13,
                                         .empty_leaves = 14,
                                         .width = 15,
                                         .largest_leaf = 16,
                                         .depth = 17,
                                         .stack = 18,
                                         .items = 19,
                                         .judged = 20,
                                         .small_boxes = 21,
                                         .loose = 22,
                                         .sah = 23.5,
                                         .sah_tight = 24.5,
                                         .overlap = 25.5},
                              .lacks = {.judged = 31, .small = 32},
                              .aimed = {.done = true, .tries = 41, .aimed = 42, .lost = 43},
                              .differences = {.instances = 51, .triangles = 52}};
}

/* Each number in the JSON. */
static const struct {
    const char *path;
    double is;
} tree_numbers[] = {
    {"reached", 11},
    {"inner", 12},
    {"leaves", 13},
    {"empty_leaves", 14},
    {"width", 15},
    {"largest_leaf", 16},
    {"depth", 17},
    {"stack", 18},
    {"triangles", 19},
    {"boxes_judged", 20},
    {"boxes_small", 21},
    {"boxes_loose", 22},
    {"sah", 23.5},
    {"sah_tight", 24.5},
    {"overlap", 25.5},
    {"instances", 61},
    {"placed.judged", 31},
    {"placed.small", 32},
    {"placed.sides", 0},
    {"aimed", 41},
    {"hit", 42},
    {"lost", 43},
    {"found", 0},
    {"differences.instances", 51},
    {"differences.triangles", 52},
};

/* And in the text. */
static const char *const tree_lines[] = {
    "the root leads to 11: 12 inner with up to 15 children, 13 leaves (14 empty)",
    "19 instances, at most 16 in one",
    "17, so a stack of at most 18",
    "23.5, with exact boxes 24.5; overlap 25.5",
    "of 20 judged: 21 too small, 22 larger than need be",
    "of 31 judged: 32 too small",
    "41 rays; 42 hit an instance outside of its box first; of these 43 are lost, and 0 of those",
    "51 instances, 52 triangles",
    "61 instances, without the trees below",
};

static void the_json_and_the_text_of_a_tree(void **state)
{
    (void)state;
    struct dump_instance instance = {.number = 0};
    struct tree_dump dump = {.format = "radv", .tri_count = 61, .instance = &instance};
    const struct tree_told told = told_made(&dump);
    const struct screen screen = {.width = 400, .wide = true};
    char path[] = "/tmp/raydiff-told-XXXXXX", *text = NULL;
    const int file = mkstemp(path);
    struct reason reason = {""};
    assert_true(file >= 0);
    close(file);
    assert_int_equal(tree_write_json(path, &told, 1, &reason), STATUS_OK);
    json_t *json = json_load_file(path, 0, NULL);
    unlink(path);
    assert_non_null(json);
    for (size_t i = 0; i < ARRAY_COUNT(tree_numbers); i++)
        if (number_at(json, tree_numbers[i].path) != tree_numbers[i].is)
            fail_msg("JSON: %s is %g", tree_numbers[i].path, number_at(json, tree_numbers[i].path));
    json_decref(json);
    size_t size;
    FILE *before = stdout, *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    stdout = stream;
    tree_print(&told, &screen);
    fclose(stream);
    stdout = before;
    for (size_t i = 0; i < ARRAY_COUNT(tree_lines); i++)
        if (!strstr(text, tree_lines[i]))
            fail_msg("no '%s' in\n%s", tree_lines[i], text);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_text_of_an_oriented_box),
        cmocka_unit_test(the_json_of_an_oriented_box),
        cmocka_unit_test(the_page_of_an_oriented_box),
        cmocka_unit_test(the_json_and_the_text_of_a_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
