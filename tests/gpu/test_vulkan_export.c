/* Exported programs, compiled as a stranger would, and run: they show a bug that is there, are
 * content where there is none, and say when they cannot run. Each check sees a change of the
 * program that it must notice. */
#include "tests/gpu/exported.h"

#include "gpu/vk/vk_driver.h"

#include <sys/wait.h>

#define WARNINGS "-std=c11 -Wall -Wextra -Werror"

static char folder[64];
static char output[65536]; /* of the last run, both streams */

static int shell(const char *format, ...) PRINTF_LIKE(1, 2);
static int shell(const char *format, ...)
{
    char command[4096];
    va_list args;
    va_start(args, format);
    int length = vsnprintf(command, sizeof command, format, args);
    va_end(args);
    assert_in_range(length, 1, sizeof command - 1);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

static void read_output(void)
{
    char path[96];
    snprintf(path, sizeof path, "%s/out", folder);
    FILE *in = fopen(path, "r");
    assert_non_null(in);
    size_t size = fread(output, 1, sizeof output - 1, in);
    output[size] = '\0';
    fclose(in);
}

static void compile(const char *program, const char *compiler, const char *libraries)
{
    char path[96];
    snprintf(path, sizeof path, "%s/finding.c", folder);
    FILE *to = fopen(path, "w");
    assert_non_null(to);
    assert_int_equal(fwrite(program, 1, strlen(program), to), strlen(program));
    assert_int_equal(fclose(to), 0);
    int code = shell("%s " WARNINGS " %s %s -o %s/finding >%s/out 2>&1", compiler, path, libraries,
                     folder, folder);
    read_output();
    if (code)
        fail_msg("%s: %s", compiler, output);
}

static const char *libraries_of(const char *engine)
{
    if (strncmp(engine, "embree", 6) != 0)
        return "-lvulkan";
    return HAVE_EMBREE == 4 ? "-lembree4 -lm" : "-lembree3 -lm";
}

/* Compiles and runs with these words of environment in front and these arguments. */
static int run(const char *program, const char *engine, const char *environment,
               const char *arguments)
{
    compile(program, "cc", libraries_of(engine));
    int code = shell("%s %s/finding %s >%s/out 2>&1", environment, folder, arguments, folder);
    read_output();
    return code;
}

/* A copy of the program with `from`, which must be there once, replaced. */
static char *changed(const char *program, const char *from, const char *to)
{
    const char *at = strstr(program, from);
    if (!at || strstr(at + 1, from))
        fail_msg("'%s' is not in the program once", from);
    char *out = NULL;
    if (asprintf(&out, "%.*s%s%s", (int)(at - program), program, to, at + strlen(from)) < 0)
        fail_msg("no memory");
    return out;
}

static void assert_runs(const struct finding_file *file, const char *engine, const char *layout,
                        int code)
{
    struct export_options options = options_of(EXPORT_C, engine, layout);
    char *program = exported(file, &options, NULL);
    int got = run(program, engine, "", "");
    if (got != code)
        fail_msg("%s on %s: exit %d, not %d: %s", engine, layout ? layout : "-", got, code, output);
    assert_non_null(strstr(output, code ? "the bug shows" : "every answer is right"));
    free(program);
}

static bool can_run(const char *name, const char *driver)
{
    const struct engine *engine = engine_find(name);
    const struct engine_options options = {.device = -1, .driver = driver};
    struct reason reason;
    void *self;
    if (engine_open(engine, &options, &self, &reason)) {
        printf("SKIP %s: %s\n", name, reason.text);
        return false;
    }
    engine->close(self);
    return true;
}

static void a_known_bug_shows_and_is_gone_where_it_is_repaired(void **state)
{
    (void)state;
    static const char *const found[] = {"index-shifted", "sentinel", "wrong-item",
                                        "rounded-inward"};
    if (!can_run("vulkan", NULL))
        skip();
    for (size_t i = 0; i < ARRAY_COUNT(found); i++) {
        struct finding_file file = corpus_file(found[i]);
        assert_runs(&file, "vulkan", NULL, 1);
        assert_runs(&file, "vulkan", "rf16", 0);
        finding_file_free(&file);
    }
    struct finding_file file =
        corpus_file("strict-comparison"); /* of the box test, by any layout */
    assert_runs(&file, "vulkan", "f32", 1);
    assert_runs(&file, "vulkan_brute", NULL, 0);
    finding_file_free(&file);
}

static void every_engine_of_others_has_a_program(void **state)
{
    (void)state;
    static const char *const names[] = {"vulkan", "vulkan_brute", "embree", "embree_robust"};
    for (size_t i = 0; i < ARRAY_COUNT(names); i++)
        for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            /* Of trials whose rays hit, so that other triangles show. */
            struct finding_file file = generated_file(5 + query, 100, query);
            struct export_options options = options_of(EXPORT_C, names[i], NULL);
            if (can_run(names[i], NULL)) {
                assert_runs(&file, names[i], NULL, 0);
                /* Other triangles, and what was right is not. */
                char *program = exported(&file, &options, NULL);
                char *other =
                    strncmp(names[i], "embree", 6) == 0
                        ? changed(program, "memcpy(vertex, vertices, sizeof vertices);",
                                  "memset(vertex, 0, sizeof vertices);")
                        : changed(program, "{triangles, sizeof triangles,", "{triangles, 0,");
                assert_int_equal(run(other, names[i], "", ""), 1);
                free(other);
                free(program);
            }
            finding_file_free(&file);
        }
}

/* Where the driver was fetched that has ray queries. */
static void ray_queries_have_a_program(void **state)
{
    (void)state;
    struct driver driver;
    struct reason reason;
    char environment[3 * DRIVER_PATH_BYTES];
    if (driver_find("mesa25", &driver, &reason) || !can_run("rayquery", "mesa25"))
        skip();
    snprintf(environment, sizeof environment, "LD_LIBRARY_PATH=%.*s VK_ICD_FILENAMES=%s",
             (int)(strrchr(driver.icd, '/') - driver.icd), driver.icd, driver.icd);
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
        struct finding_file file = generated_file(3 + query, 100, query);
        struct export_options options = options_of(EXPORT_C, "rayquery", NULL);
        options.engines.driver = "mesa25";
        char *program = exported(&file, &options, NULL);
        if (run(program, "rayquery", environment, ""))
            fail_msg("%s", output);
        char *other = changed(program, "make_input(vertices, sizeof vertices)",
                              "make_input(NULL, sizeof vertices)");
        assert_int_equal(run(other, "rayquery", environment, ""), 1);
        free(other);
        assert_int_equal(run(program, "rayquery", environment, "1"), 2);
        free(program);
        finding_file_free(&file);
    }
}

static void what_cannot_run_says_so(void **state)
{
    (void)state;
    if (!can_run("vulkan", NULL))
        skip();
    struct finding_file file = corpus_file("sentinel");
    struct export_options options = options_of(EXPORT_C, "vulkan", NULL);
    char *program = exported(&file, &options, NULL);
    assert_int_equal(run(program, "vulkan", "", "99"), 2);
    assert_non_null(strstr(output, "there is no device 99"));
    assert_non_null(strstr(output, "device 0: ")); /* and which there are */
    assert_int_equal(run(program, "vulkan", "", "first"), 2);
    assert_non_null(strstr(output, "usage: "));
    assert_int_equal(run(program, "vulkan", "", "0 1"), 2);
    assert_int_equal(run(program, "vulkan", "VK_ICD_FILENAMES=/nowhere.json", ""), 2);
    assert_non_null(strstr(output, "cannot run: vkCreateInstance"));
    free(program);
    finding_file_free(&file);
}

static void a_ray_that_is_not_finished_is_wrong(void **state)
{
    (void)state;
    if (!can_run("vulkan", NULL))
        skip();
    struct finding_file file = corpus_file("triangle-zero");
    struct export_options options = options_of(EXPORT_C, "vulkan", "f32");
    char *program = exported(&file, &options, NULL);
    assert_int_equal(run(program, "vulkan", "", ""), 0);
    char *other = changed(program, "#define FINISHED 1u", "#define FINISHED 3u");
    assert_int_equal(run(other, "vulkan", "", ""), 1);
    assert_non_null(strstr(output, "not finished"));
    free(other);
    free(program);
    finding_file_free(&file);
}

/* A finding of other bits than C's: one bit of what C answers is changed. */
static void bits_matter_where_they_are_the_finding(void **state)
{
    (void)state;
    if (!can_run("vulkan", NULL))
        skip();
    struct finding_file file = generated_file(3, 20, QUERY_CLOSEST);
    struct export_options options = options_of(EXPORT_C, "vulkan", "f32");
    for (int bits = 0; bits < 2; bits++) {
        file.has_signature = bits;
        file.signature = (struct fuzz_signature){
            .layout = layout_find("f32"), .kind = FUZZ_KIND_BITS, .cause = CAUSE_SHADER};
        fuzz_signature_set_engine(&file.signature, "vulkan");
        char *program = exported(&file, &options, NULL);
        assert_int_equal(run(program, "vulkan", "", ""), 0);
        char *other = changed(program, "memcpy(&reference, references[i], sizeof reference);",
                              "memcpy(&reference, references[i], sizeof reference);\n"
                              "    differs = differs || i == 7;");
        assert_int_equal(run(other, "vulkan", "", ""), bits);
        free(other);
        free(program);
    }
    finding_file_free(&file);
}

static void numbers_that_are_none_keep_their_bits(void **state)
{
    (void)state;
    if (!can_run("vulkan", NULL))
        skip();
    struct finding_file file = corpus_file("bad-rays");
    struct export_options options = options_of(EXPORT_C, "vulkan", "f32");
    char word[16], *program;
    file.trial.ray[2].dir[1] = float_from_bits(0x7FC12345u);
    snprintf(word, sizeof word, "0x%08x", 0x7FC12345u);
    program = exported(&file, &options, NULL);
    assert_non_null(strstr(program, word));
    assert_int_equal(run(program, "vulkan", "", ""), 0);
    free(program);
    finding_file_free(&file);
}

/* What a file says of itself ends no comment, begins none, and continues no line. */
static void words_of_a_file_stay_words(void **state)
{
    (void)state;
    struct finding_file file = generated_file(3, 4, QUERY_CLOSEST);
    struct export_options options = options_of(EXPORT_C, "vulkan", "f32");
    options.engines.driver = NO_DRIVER;
    snprintf(file.trial.origin.recipe, sizeof file.trial.origin.recipe,
             "*/ #error out /* in */*/ \\ ?\?/ \x01\xff %%s end");
    snprintf(file.versions, sizeof file.versions, "one */ #error\ntwo \\");
    options.name = "a */ b.c";
    char *program = exported(&file, &options, NULL);
    compile(program, "cc -Wcomment", "-lvulkan");
    free(program);
    finding_file_free(&file);
}

static void other_compilers_take_it_too(void **state)
{
    (void)state;
    static const char *const names[] = {"vulkan", "rayquery", "embree_robust"};
    if (shell("command -v clang >/dev/null") != 0)
        skip();
    struct finding_file file = generated_file(3, 10, QUERY_CLOSEST);
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        if (!HAVE_EMBREE && strncmp(names[i], "embree", 6) == 0)
            continue;
        struct export_options options = options_of(EXPORT_C, names[i], NULL);
        options.engines.driver = NO_DRIVER;
        char *program = exported(&file, &options, NULL);
        compile(program, "clang", libraries_of(names[i]));
        free(program);
    }
    finding_file_free(&file);
}

/* The layer prints what it finds. */
static void validation_has_nothing_to_say(void **state)
{
    (void)state;
    static const char layer[] = "VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation";
    if (!can_run("vulkan", NULL))
        skip();
    struct finding_file file = corpus_file("triangle-zero");
    struct export_options options = options_of(EXPORT_C, "vulkan", "f32");
    char *program = exported(&file, &options, NULL);
    char *other = changed(program, "    vkDestroyFence(device, fence, NULL);\n", "");
    (void)run(other, "vulkan", layer, "");
    if (strstr(output, "VUID-")) {
        assert_int_equal(run(program, "vulkan", layer, ""), 0);
        assert_null(strstr(output, "VUID-"));
    } else {
        puts("SKIP validation: no layer is installed");
    }
    free(other);
    free(program);
    finding_file_free(&file);
}

static int make_folder(void **state)
{
    const char *parent = getenv("TMPDIR");
    (void)state;
    snprintf(folder, sizeof folder, "%.40s/exportXXXXXX", parent ? parent : "/tmp");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return shell("rm -rf '%s'", folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_known_bug_shows_and_is_gone_where_it_is_repaired),
        cmocka_unit_test(every_engine_of_others_has_a_program),
        cmocka_unit_test(ray_queries_have_a_program),
        cmocka_unit_test(what_cannot_run_says_so),
        cmocka_unit_test(a_ray_that_is_not_finished_is_wrong),
        cmocka_unit_test(bits_matter_where_they_are_the_finding),
        cmocka_unit_test(numbers_that_are_none_keep_their_bits),
        cmocka_unit_test(words_of_a_file_stay_words),
        cmocka_unit_test(other_compilers_take_it_too),
        cmocka_unit_test(validation_has_nothing_to_say),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
