/* The command that explains an answer, read back by the shell and by the rows of options: it names
 * the tree, the tests and the ray to the bit, whatever they are, and nothing that is not used. */
#define _POSIX_C_SOURCE 200809L /* popen */
#include "cmd/common/cmd_explain_line.h"

#include "cmd/common/cmd_rows.h"
#include "ref/base/command.h"
#include "ref/base/ray_text.h"
#include "ref/base/rng.h"
#include "ref/store.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define WORDS 64

/* What such a command names, by options of the same rows. */
struct read_back {
    const char *ray;
    struct explain_of of;
    struct build_options build;
};

#define ROWS_OF struct read_back
static const struct option_row rows[] = {
    {"ray", "R", "", OF_TEXT(ray)},
    {"engine", "E", "", OF_MEMBER(of.engine, TABLE_ENGINES), .value = "cpu"},
    {"layout", "L", "", OF_MEMBER(of.layout, TABLE_LAYOUTS), .value = "f32"},
    {"builder", "B", "", OF_MEMBER(of.builder, TABLE_BUILDERS), .value = "median"},
    {"bvh", "FILE", "", OF_TEXT(of.tree)},
    {"store", "S", "", OF_MEMBER(of.store, TABLE_STORES), .value = "indexed"},
    {"box", "B", "", OF_MEMBER(of.box, TABLE_BOX_TESTS), .value = "robust"},
    {"tri", "T", "", OF_MEMBER(of.tri, TABLE_TRI_TESTS), .value = "mt"},
    {"query", "Q", "", OF_ONE(of.query, TABLE_QUERIES), .value = "closest"},
    {"driver", "D", "", OF_TEXT(of.driver)},
    SEED_ROW(of.seed),
    {0},
};

static const struct option_set set = {
    .command = "explain",
    .group = {GROUP(rows), GROUP_AT(leaf_rows, build), GROUP_AT(build_rows, build)},
};

/* The words that a shell makes of a command; returns how many there are. */
static int words_of(const char *command, char *word[WORDS])
{
    char line[EXPLAIN_COMMAND_MOST + 64];
    int count = 0;
    size_t room = 0;
    snprintf(line, sizeof line, "printf '%%s\\n' %s", command);
    FILE *shell = popen(line, "r");
    assert_non_null(shell);
    for (word[0] = NULL; getline(&word[count], &room, shell) > 0; word[count] = NULL, room = 0) {
        word[count][strcspn(word[count], "\n")] = '\0';
        assert_true(++count < WORDS);
    }
    free(word[count]);
    assert_int_equal(pclose(shell), 0);
    return count;
}

/* Any finite number, at times a plain one. */
static float any_number(struct rng *rng)
{
    float x = float_from_bits((uint32_t)rng_u64(rng));
    return float_is_finite(x) && rng_below(rng, 4) ? x : (float)rng_below(rng, 4) - 1;
}

/* Of 0 to `most`, where 0 stands for the default and -1 for 0. */
static float any_share(struct rng *rng, float most)
{
    const uint32_t kind = rng_below(rng, 4);
    return kind == 0 ? 0 : kind == 1 ? -1 : most * rng_float(rng) + 0x1p-30f;
}

static struct explain_of draw(struct rng *rng, const char *const *spec)
{
    static const char *const engine[] = {"cpu", "vulkan", "cpu_stackless"};
    uint32_t b = 0, l = 0;
    while (builders_all[b])
        b++;
    while (layouts_all[l])
        l++;
    struct explain_of of = {.spec = spec[rng_below(rng, 4)],
                            .seed = rng_below(rng, 3) ? rng_u64(rng) : 1,
                            .engine = engine_find(engine[rng_below(rng, 3)]),
                            .layout = layouts_all[rng_below(rng, l)],
                            .builder = builders_all[rng_below(rng, b)],
                            .store = tri_stores[rng_below(rng, 3)],
                            .box = box_tests[rng_below(rng, 3)],
                            .tri = tri_tests[rng_below(rng, 3)],
                            .query = rng_below(rng, 2) ? QUERY_ANY : QUERY_CLOSEST,
                            .driver = rng_below(rng, 2) ? "a driver's" : NULL,
                            .tree = rng_below(rng, 8) ? NULL : "of /it's.json"};
    of.build = build_options_default();
    of.build.leaf = rng_below(rng, 2) ? 4 : 1 + rng_below(rng, 1u << 20);
    of.build.passes = rng_below(rng, 2) ? 0 : 1 + rng_below(rng, 1000);
    of.build.rotates = of.build.passes > 0 && rng_below(rng, 2);
    of.build.eps = rng_below(rng, 4) ? any_number(rng) : BUILD_EPS_DEFAULT;
    of.build.bins = rng_below(rng, 2) ? 0 : 2 + rng_below(rng, BUILD_BINS_MOST - 1);
    of.build.radius = rng_below(rng, 2) ? 0 : 1 + rng_below(rng, BUILD_RADIUS_MOST);
    of.build.split_budget = any_share(rng, BUILD_SPLIT_BUDGET_MOST);
    of.build.split_alpha = any_share(rng, 1);
    of.build.presplit = fmaxf(any_share(rng, BUILD_PRESPLIT_MOST), 0);
    return of;
}

/* What is left of the options of a tree: what its builder does not read is as it would be. */
static struct build_options read_by(const struct explain_of *of)
{
    struct build_options build = build_options_default();
    const char *name = of->builder->name;
    if (of->tree)
        return build;
    build.leaf = of->build.leaf;
    build.passes = of->build.passes;
    build.rotates = of->build.rotates;
    if (strcmp(name, "rtrs") == 0)
        build.eps = of->build.eps;
    if (strcmp(name, "sah_binned") == 0)
        build.bins = of->build.bins;
    if (strcmp(name, "ploc") == 0 || strcmp(name, "ploctree") == 0)
        build.radius = of->build.radius;
    if (strcmp(name, "sbvh") == 0) {
        build.split_budget = of->build.split_budget;
        build.split_alpha = of->build.split_alpha;
    }
    static const char *const whole[] = {"rtrs", "sbvh", "lbvh30", "lbvh63", "hploc"};
    bool parts = true;
    for (size_t i = 0; i < ARRAY_COUNT(whole); i++)
        parts = parts && strcmp(name, whole[i]) != 0;
    if (parts)
        build.presplit = of->build.presplit;
    return build;
}

static void must_be_text(const char *text, const char *want)
{
    assert_true((text != NULL) == (want != NULL));
    if (want)
        assert_string_equal(text, want);
}

static void must_be_told(const struct read_back *told, const struct explain_of *of,
                         const struct ray *ray)
{
    const struct build_options build = read_by(of);
    const bool shaders = strcmp(of->engine->name, "vulkan") == 0;
    struct ray read;
    assert_int_equal(ray_text_read(told->ray, 0, &read, NULL), STATUS_OK);
    assert_memory_equal(&read, ray, sizeof read);
    assert_ptr_equal(told->of.engine, of->engine);
    assert_ptr_equal(told->of.layout, of->layout);
    assert_true(of->tree || told->of.builder == of->builder);
    assert_ptr_equal(told->of.store, of->store);
    assert_ptr_equal(told->of.box, of->box);
    assert_ptr_equal(told->of.tri, of->tri);
    assert_int_equal(told->of.query, of->query);
    assert_true(told->of.seed == (strncmp(of->spec, "soup", 4) == 0 ? of->seed : 1));
    must_be_text(told->of.tree, of->tree);
    must_be_text(told->of.driver, shaders ? of->driver : NULL);
    assert_memory_equal(&told->build, &build, sizeof build);
}

static void a_command_is_read_back_to_the_bit(void **state)
{
    (void)state;
    static const char *const spec[] = {"soup:n=9", "sphere:n=2", "it's \"$A\" *.obj", "./-x.obj"};
    struct rng rng = rng_make(8, 3);
    for (int n = 0; n < 600; n++) {
        const struct explain_of of = draw(&rng, spec);
        struct read_back told = {.build = build_options_default()};
        char text[EXPLAIN_COMMAND_MOST], *word[WORDS];
        struct ray ray;
        float *number = ray.org; /* eight in a row */
        int first;
        for (int k = 0; k < 8; k++)
            number[k] = any_number(&rng);
        explain_command(&of, &ray, text);
        const int count = words_of(text, word);
        assert_string_equal(word[0], "raydiff");
        assert_string_equal(word[1], "explain");
        if (options_read(&set, &told, count - 1, word + 1, &first) != -1)
            fail_msg("%s is refused", text);
        assert_int_equal(first, count - 2);
        assert_string_equal(word[1 + first], of.spec);
        must_be_told(&told, &of, &ray);
        for (int i = 0; i < count; i++)
            free(word[i]);
    }
}

/* Blanks, tabs and commas, perhaps none. */
static void put_separators(struct rng *rng, uint32_t least, char *text)
{
    char put[4] = "";
    const uint32_t count = least + rng_below(rng, 3);
    for (uint32_t i = 0; i < count; i++)
        put[i] = " ,\t"[rng_below(rng, 3)];
    strcat(text, put);
}

/* A ray is read alike whatever separates its numbers and stands around them; of six numbers, the
 * ends are 0 and the one that the caller has. */
static void separators_are_no_part_of_a_ray(void **state)
{
    (void)state;
    struct rng rng = rng_make(9, 3);
    for (int n = 0; n < 400; n++) {
        const int count = n % 2 ? 8 : 6;
        char text[512] = "", number[32];
        struct ray wanted = {.tmax = 7.5f}, read;
        struct reason reason = {""};
        float value[8];
        put_separators(&rng, 0, text);
        for (int k = 0; k < count; k++) {
            value[k] = any_number(&rng);
            float_text_write(value[k], number);
            strcat(text, number);
            put_separators(&rng, k + 1 < count, text);
        }
        memcpy(wanted.org, value, sizeof wanted.org);
        memcpy(wanted.dir, value + 3, sizeof wanted.dir);
        if (count == 8)
            wanted.tmin = value[6], wanted.tmax = value[7];
        if (ray_text_read(text, 7.5f, &read, &reason))
            fail_msg("'%s': %s", text, reason.text);
        assert_memory_equal(&read, &wanted, sizeof wanted);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(separators_are_no_part_of_a_ray),
        cmocka_unit_test(a_command_is_read_back_to_the_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
