/* Numbers that raydiff explain tells of a ray and of the node where its path ended: no two are the
 * same, and each is looked for beside its own name. */
#define _GNU_SOURCE /* open_memstream */
#include "bench/report/report_html.h"
#include "cmd/explain/cmd_explain_inner.h"

#include "tests/commands/told.h"

/* Numbers of a bound from `at` on. */
static struct explain_bound bound_of(float at)
{
    return (struct explain_bound){.exact = at,
                                  .canonical = at + 1,
                                  .decoded = at + 2,
                                  .half_steps = (double)at + 3.5,
                                  .float_steps = (int64_t)at + 4};
}

static struct explain_step step_made(void)
{
    struct explain_step step = {.note = {.node = 11, .tested = true, .entry = 12, .tbest = 13},
                                .record = 14};
    for (int k = 0; k < 3; k++) {
        const float at = (float)(100 * (k + 1));
        step.lo[k] = bound_of(at + 10);
        step.hi[k] = bound_of(at + 20);
        step.slab[k] = (struct slab_axis){at + 31, at + 32, (double)at + 33, (double)at + 34};
    }
    return step;
}

#define BOUND(path, at)                                                                            \
    {path ".exact.value", (at)}, {path ".tree.value", (at) + 1},                                   \
        {path ".decoded.value", (at) + 2}, {path ".float16_steps", (at) + 3.5},                    \
    {                                                                                              \
        path ".float32_steps", (at) + 4                                                            \
    }
#define AXIS(k, at)                                                                                \
    BOUND("way.0.lo." k, (at) + 10), BOUND("way.0.hi." k, (at) + 20),                              \
        {"way.0.slab." k ".enter.value", (at) + 31}, {"way.0.slab." k ".leave.value", (at) + 32},  \
        {"way.0.slab." k ".exact_enter", (at) + 33},                                               \
    {                                                                                              \
        "way.0.slab." k ".exact_leave", (at) + 34                                                  \
    }

static const struct told_number numbers[] = {
    {"exit", 1},
    {"subject.seed", 21},
    {"subject.leaf", 22},
    {"subject.index", 23},
    {"origin.0.value", 24},
    {"origin.1.value", 25},
    {"origin.2.value", 26},
    {"direction.0.value", 27},
    {"direction.1.value", 28},
    {"direction.2.value", 29},
    {"tmin.value", 30},
    {"tmax.value", 31},
    {"truth.prim", 32},
    {"truth.ties", 33},
    {"truth.t_lo", 34},
    {"truth.t_hi", 35},
    {"finished", 1},
    {"answer.prim", 36},
    {"answer.t.value", 37},
    {"answer.u.value", 38},
    {"answer.v.value", 39},
    {"judgement.expected", 40},
    {"judgement.t_lo", 41},
    {"judgement.t_hi", 42},
    {"judgement.over", 43},
    {"judgement.displacement", 44},
    {"judgement.lost", 45},
    {"inside", 0},
    {"c_answers.prim", 46},
    {"c_answers.t.value", 47},
    {"c_answers.u.value", 48},
    {"c_answers.v.value", 49},
    {"last", 50},
    {"way.0.node", 11},
    {"way.0.record", 14},
    {"way.0.leaf", 0},
    {"way.0.tested", 1},
    {"way.0.hit", 0},
    {"way.0.entered", 0},
    {"way.0.skipped", 0},
    {"way.0.entry.value", 12},
    {"way.0.best.value", 13},
    AXIS("0", 100),
    AXIS("1", 200),
    AXIS("2", 300),
    {"tried.0.finished", 1},
    {"tried.0.changed", 0},
    {"tried.0.allowed", 0},
    {"tried.0.answer.prim", 51},
    {"tried.0.answer.t.value", 52},
    {"tried.0.answer.u.value", 53},
    {"tried.0.answer.v.value", 54},
    {"imitated.0.parameter", 55},
    {"imitated.0.same", 0},
    {"imitated.0.refuted", 0},
    {"imitated.0.witnesses", 56},
    {"imitated.0.of", 57},
    {"imitated.0.telling", 58},
    {"imitated.0.told", 59},
    {"decode.compared", 0},
    {"decode.records", 60},
    {"decode.slots", 61},
    {"decode.differ", 62},
};

static void fill_ray(struct judged_ray *ray, struct explain_step *step)
{
    *ray = (struct judged_ray){
        .ray = {.org = {24, 25, 26}, .tmin = 30, .dir = {27, 28, 29}, .tmax = 31},
        .answer = {.finished = true, .hit = {.prim = 36, .t = 37, .u = 38, .v = 39}},
        .truth = {.prim = 32, .tie_count = 33, .t_lo = 34, .t_hi = 35},
        .judgement = {.verdict = VERDICT_WRONG,
                      .expected = 40,
                      .t_lo = 41,
                      .t_hi = 42,
                      .over = 43,
                      .displacement = 44,
                      .behind = true,
                      .lost = 45},
        .why = {.replayed = {.prim = 46, .t = 47, .u = 48, .v = 49},
                .attempt = {{.end = REPLAY_DONE,
                             .opinion = {.text = "o"},
                             .hit = {.prim = 51, .t = 52, .u = 53, .v = 54}}},
                .attempt_count = 1,
                .imitation =
                    {{.parameter = 55, .witnesses = 56, .asked = 57, .telling = 58, .told = 59}},
                .imitation_count = 1,
                .step = step,
                .step_count = 1,
                .last = 50}};
}

/* All of a page. */
struct told_page {
    struct explain_of of;
    struct explain_decode decode;
    struct judged judged;
    struct judged_ray ray;
    struct explain_step step;
    struct explain_page page;
};

static struct told_page *page_made(void)
{
    static struct told_page all;
    all.of = (struct explain_of){.spec = "s",
                                 .seed = 21,
                                 .engine = engine_find("cpu"),
                                 .layout = layout_find("f32"),
                                 .builder = builders_all[0],
                                 .build = {.leaf = 22},
                                 .box = box_tests[0],
                                 .tri = tri_tests[0]};
    all.decode = (struct explain_decode){
        .asked = true, .decoded = {.records = 60, .slots = 61, .differ = 62, .first = "f"}};
    all.judged = (struct judged){.known = true};
    all.step = step_made();
    fill_ray(&all.ray, &all.step);
    all.page = (struct explain_page){.of = &all.of,
                                     .judged = &all.judged,
                                     .ray = &all.ray,
                                     .index = 23,
                                     .count = 1,
                                     .decode = &all.decode};
    return &all;
}

static void the_json_of_a_ray(void **state)
{
    (void)state;
    told_json(explain_json(&page_made()->page, 1), numbers, ARRAY_COUNT(numbers));
}

static void flags_of_a_ray(void **state)
{
    (void)state;
    static const char *const flags[] = {"finished",        "inside",           "way.0.leaf",
                                        "way.0.tested",    "way.0.hit",        "way.0.entered",
                                        "way.0.skipped",   "tried.0.finished", "tried.0.changed",
                                        "tried.0.allowed", "imitated.0.same",  "imitated.0.refuted",
                                        "decode.compared"};
    for (size_t i = 0; i < ARRAY_COUNT(flags); i++) {
        struct told_page *all = page_made();
        struct explanation *why = &all->ray.why;
        all->ray.answer.finished = i == 0;
        why->inside = i == 1;
        all->step.leaf = i == 2;
        all->step.note.tested = i == 3;
        all->step.note.hit = i == 4;
        all->step.note.visited = i == 5;
        all->step.note.skipped = i == 6;
        why->attempt[0].end = i == 7 ? REPLAY_DONE : (enum replay_end)(REPLAY_DONE + 1);
        why->attempt[0].changed = i == 8;
        why->attempt[0].opinion.allowed = i == 9;
        why->imitation[0].same = i == 10;
        why->imitation[0].refuted = i == 11;
        all->decode.compared = i == 12;
        told_flag(explain_json(&all->page, 1), flags[i], flags, ARRAY_COUNT(flags));
    }
}

/* The page of a triangle that its leaf lacks, for which a defect of C was found. */
static struct told_page *page_told(void)
{
    static const struct scene scene = {.tri_count = 5}; /* none of those that are told of */
    struct told_page *all = page_made();
    struct explanation *why = &all->ray.why;
    all->page.scene = &scene;
    all->page.rays = "r";
    all->page.count = 63;
    all->page.again = "a";
    all->page.screen.wide = true;
    all->ray.truth.class = ORACLE_WITHIN;
    all->ray.among = 64;
    all->ray.alone = (struct hit){.prim = 65, .t = 66, .u = 67, .v = 68};
    all->ray.alone_judgement.verdict = VERDICT_RIGHT;
    why->prim = 69;
    why->end = END_SLOT;
    why->slot = 70;
    why->slot_stored = 71;
    why->cause = CAUSE_NONE + 1;
    why->replayed_opinion.text = "o";
    why->imitation[0].defect = DEFECT_NONE + 1;
    why->imitation[0].same = true;
    why->imitation[0].kept = EXPLAIN_TELLING;
    return all;
}

/* A hit of four numbers from `at` on. */
static void hit_told(char text[120], const char *before, unsigned at)
{
    const double t = at + 1;
    snprintf(text, 120, "%striangle %u at t = %a (%g), u = %u, v = %u", before, at, t, t, at + 2,
             at + 3);
}

static void the_text_of_a_ray(void **state)
{
    (void)state;
    struct told_page *all = page_told();
    char answer[120], alone[120], c_answers[120], floats[8][40];
    const char *lines[24] = {"scene s: 5 triangles\n",
                             "ray 23 of 63 of set r, seed 21\n",
                             ", builder median, leaf 22, box ",
                             "truth triangle 32 and others at the same t at t in [34, 35], ",
                             "triangle 40 was to be found, or at the least triangle 45 behind it, "
                             "error of t 43 of its bound, right if vertices move by 44 u of ",
                             "that is its answer among 64 rays;",
                             "path (cpu) to triangle 69\n",
                             "\n11 14 inner",
                             "slot 70 of its leaf should name triangle 69; it names triangle 71\n",
                             " (55): the same as the engine, also for 56 of 57 other rays; on 58 "
                             "of these C answers otherwise, on "
                             "which the engine does as planted 59 times\n",
                             answer,
                             alone,
                             c_answers};
    size_t count = 13;
    for (int i = 0; i < 8; i++) {
        snprintf(floats[i], sizeof floats[0], "%a (%d)", 24.0 + i, 24 + i);
        lines[count++] = floats[i];
    }
    hit_told(answer, "answer ", 36);
    hit_told(alone, "alone ", 65);
    hit_told(c_answers, "C on the same bytes answers ", 46);
    told_begin(&stdout);
    explain_print(&all->page);
    told_text(told_end(), lines, count);
}

static void the_html_of_a_ray(void **state)
{
    (void)state;
    struct told_page *all = page_told();
    char *text = NULL;
    size_t size;
    const char *lines[] = {
        "from (24, 25, 26) along (27, 28, 29), t from 30 to 31<",
        "Truth: triangle 32 at t in [34, 35], ",
        "Answer: triangle 36 at t = 37 (0x1.28p+5), u = 38, v = 39<",
        "path to triangle 69<",
        ">11</td>",
        ">14</td>",
        ">triangle 51 at t = 52<",
    };
    all->ray.why.inside = all->ray.why.attempt[0].changed = true;
    struct html html = {.out = open_memstream(&text, &size)};
    assert_non_null(html.out);
    explain_html_numbers(&html, &all->page);
    fclose(html.out);
    told_text(text, lines, ARRAY_COUNT(lines));
}

/* A bound in three forms, in hexadecimal and below in decimals, with both numbers of steps; then
 * the ends of the slabs, computed and exact. */
static void the_text_of_a_node(void **state)
{
    (void)state;
    const struct explain_step step = step_made();
    for (int wide = 0; wide < 2; wide++) {
        char *text = NULL, line[20][200];
        const char *lines[20];
        size_t size, count = 0;
        lines[count++] = "node 11, record 14, words\n";
        lines[count++] = " of its triangles of the tree in the bytes float16 float32\n";
        lines[count++] = "box test: entry 12, best t so far 13, no hit";
        for (int k = 0; k < 6; k++) {
            const double at = 100 * (k / 2 + 1) + (k % 2 ? 20 : 10);
            snprintf(line[count], sizeof line[0], "%c %s %a %a %a %.4g %.0f", "xyz"[k / 2],
                     k % 2 ? "hi" : "lo", at, at + 1, at + 2, at + 3.5, at + 4);
            lines[count] = line[count];
            count++;
            snprintf(line[count], sizeof line[0], "%.0f %.0f %.0f\n", at, at + 1, at + 2);
            lines[count] = line[count];
            count++;
        }
        for (int k = 0; k < 3; k++) {
            const double at = 100 * (k + 1);
            snprintf(line[count], sizeof line[0], "%c %.0f %.0f%s%.0f %.0f", "xyz"[k], at + 31,
                     at + 32, wide ? " " : "\n", at + 33, at + 34);
            lines[count] = line[count];
            count++;
        }
        FILE *stream = open_memstream(&text, &size);
        assert_non_null(stream);
        explain_node_print(stream, &step, wide);
        fclose(stream);
        told_text(text, lines, count);
    }
}

static void the_text_of_what_shaders_decode(void **state)
{
    (void)state;
    const struct screen screen = {.width = 4000, .wide = true};
    struct explain_decode decode = page_made()->decode;
    const char *const differ[] = {"62 of 60 records decode otherwise in GLSL than in C"};
    const char *const same[] = {"C and GLSL decode the same of 60 records, 61 slots"};
    decode.compared = true;
    told_begin(&stdout);
    explain_decode_print(&decode, &screen);
    told_text(told_end(), differ, 1);
    decode.decoded.differ = 0;
    told_begin(&stdout);
    explain_decode_print(&decode, &screen);
    told_text(told_end(), same, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_json_of_a_ray),  cmocka_unit_test(flags_of_a_ray),
        cmocka_unit_test(the_text_of_a_ray),  cmocka_unit_test(the_html_of_a_ray),
        cmocka_unit_test(the_text_of_a_node), cmocka_unit_test(the_text_of_what_shaders_decode),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
