/* Bytes that raydiff bench paper tells of a mesh that is not the paper's: its own numbers, and
 * beside them the published ones. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/bench/cmd_bench_paper.h"

#include "tests/commands/told_bench.h"

/* The next number of the text behind `*at`, which ends behind it. */
static double next_number(const char **at)
{
    char *end;
    *at += strcspn(*at, "0123456789");
    const double number = strtod(*at, &end);
    *at = end;
    return number;
}

/* The numbers behind a word of the text are these. */
static void numbers_behind(const char *text, const char *word, const double *is, size_t count)
{
    const char *at = strstr(text, word);
    if (!at)
        fail_msg("no '%s' in\n%s", word, text);
    at += strlen(word);
    for (size_t i = 0; i < count; i++) {
        const double number = next_number(&at);
        if (fabs(number - is[i]) > 0.051)
            fail_msg("%s: number %zu is %.17g, not %.17g", word, i, number, is[i]);
    }
}

static void another_mesh_stands_beside_the_published_numbers(void **state)
{
    (void)state;
    static const struct paper_figure figure = {"f", 9001, 9002, 9003, 9004, 9005, 1, 2};
    struct reason reason;
    struct paper_scene scene = {.spec = "s", .figure = &figure};
    struct bench bench = bench_made(true);
    if (scene_make(3 * 20, 20, &scene.scene))
        fail_msg("no memory");
    for (uint32_t i = 0; i < 60; i++) { /* triangles in a row, no two of them overlap */
        scene.scene.vertex[3 * i] = (float)(i / 3) + (i % 3 == 1 ? 0.5f : 0);
        scene.scene.vertex[3 * i + 1] = i % 3 == 2 ? 0.5f : 0;
        scene.scene.vertex[3 * i + 2] = 0;
        scene.scene.index[i] = i;
    }
    struct paper_tree direct, rf;
    if (paper_tree(&scene.scene, PAPER_LEAF_DIRECT, &direct, &reason) ||
        paper_tree(&scene.scene, PAPER_LEAF_RF, &rf, &reason))
        fail_msg("%s", reason.text);
    const double geometry = 16 * 20 + 40, uploaded = 16 * 21 + 32 * 60;
    told_begin(&stdout);
    paper_print_bytes(&bench, &scene, 1);
    char *text = told_end();
    told_squeeze(text);
    numbers_behind(text, "s: ANOTHER MESH than the paper's teapot, whose numbers stand beside: ",
                   (const double[]){20, 60, 9001, 9002}, 4);
    numbers_behind(text, "geometry, 16 n + 40 ",
                   (const double[]){geometry, 9003, 100, 100 * geometry / uploaded}, 4);
    const double bytes[] = {(double)direct.direct, (double)rf.rf};
    numbers_behind(text, "direct, leaf ",
                   (const double[]){PAPER_LEAF_DIRECT, direct.stats.node_count, PAPER_DIRECT_BYTES,
                                    bytes[0], 9004, 100 * bytes[0] / geometry,
                                    100 * bytes[0] / uploaded},
                   7);
    numbers_behind(text, "RF, leaf ",
                   (const double[]){PAPER_LEAF_RF, 3 * rf.stats.leaf_count - 1, PAPER_RF_BYTES,
                                    bytes[1], 9005, 100 * bytes[1] / geometry,
                                    100 * bytes[1] / uploaded},
                   7);
    free(text);
    assert_true(json_array_size(bench.rows) >= 2);
    json_decref(bench.rows);
    scene_free(&scene.scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_mesh_stands_beside_the_published_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
