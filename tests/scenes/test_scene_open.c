#define _GNU_SOURCE /* mkdtemp */
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

static void expect_refused(const char *spec, const char *rule)
{
    struct scene scene;
    reason.text[0] = '\0';
    enum status status = scene_open(spec, 1, &scene, &reason);
    assert_null(scene.vertex);
    scene_free(&scene);
    assert_int_equal(status, STATUS_INPUT);
    if (!strstr(reason.text, rule))
        print_error("'%s' lacks '%s'\n", reason.text, rule);
    assert_non_null(strstr(reason.text, rule));
    assert_null(strchr(reason.text, '\n'));
}

/* The triangles of a spec, in order, as one number. */
static uint64_t digest(const char *spec, uint64_t seed, uint32_t *tri_count)
{
    struct scene scene;
    enum status status = scene_open(spec, seed, &scene, &reason);
    if (status != STATUS_OK)
        print_error("%s\n", reason.text);
    assert_int_equal(status, STATUS_OK);
    assert_int_equal(scene_check(&scene, NULL), STATUS_OK);
    uint64_t hash = 14695981039346656037u;
    for (uint32_t i = 0; i < scene.tri_count; i++) {
        float v[3][3];
        scene_tri(&scene, i, v);
        for (int k = 0; k < 9; k++)
            hash = (hash ^ float_bits(v[k / 3][k % 3])) * 1099511628211u;
    }
    *tri_count = scene.tri_count;
    scene_free(&scene);
    return hash;
}

static void scene_open_makes_every_generator_with_its_defaults(void **state)
{
    (void)state;
    for (size_t i = 0; generators[i]; i++) {
        uint32_t count, again;
        uint64_t a = digest(generators[i]->name, 1, &count);
        assert_true(count > 0);
        char spec[400];
        snprintf(spec, sizeof spec, "%s:", generators[i]->name);
        for (size_t k = 0; k < GENERATOR_PARAMS && generators[i]->param[k].name; k++)
            snprintf(spec + strlen(spec), sizeof spec - strlen(spec), "%s=%.17g,",
                     generators[i]->param[k].name, generators[i]->param[k].value);
        snprintf(spec + strlen(spec), sizeof spec - strlen(spec), "seed=1");
        assert_true(digest(spec, 99, &again) == a);
        assert_int_equal(again, count);
    }
}

static void scene_open_passes_parameters_and_seed(void **state)
{
    (void)state;
    uint32_t count;
    digest("soup:n=7", 1, &count);
    assert_int_equal(count, 7);
    uint64_t a = digest("soup:n=1e2,size=.25", 3, &count);
    assert_int_equal(count, 100);
    assert_true(digest("soup:seed=3,size=0.25,n=100", 8, &count) == a);
    assert_true(digest("soup:n=100,size=0.25", 4, &count) != a);
    assert_true(digest("soup:n=100,size=0.125", 3, &count) != a);
    digest("soup:seed=18446744073709551615", 1, &count);
}

static void scene_open_names_what_it_does_not_know(void **state)
{
    (void)state;
    expect_refused("suop",
                   "unknown scene 'suop': no file, and no generator; those are soup, sphere");
    expect_refused("suop:n=3", "unknown scene 'suop:n=3': no file, and no generator");
    expect_refused("", "unknown scene '': no file, and no generator");
    expect_refused("suop", "rtrs (of worlds: raydiff scene list); did you mean soup?");
    expect_refused("scenes/fetched/none.obj", "No such file or directory; make scenes fetches");
    expect_refused("elsewhere/none.obj", "elsewhere/none.obj: No such file or directory");
    assert_null(strstr(reason.text, "make scenes"));
    struct scene none;
    assert_int_equal(scene_open("scenes/fetched/none.obj", 1, &none, NULL), STATUS_INPUT);
    expect_refused("soup:m=3", "soup: 'm' is no parameter; known are n, size, offset, seed");
    expect_refused("soup:", "soup: '' is no parameter");
    expect_refused("soup:n=3,", "soup: '' is no parameter");
    expect_refused("soup:n", "soup: n= must be a number from 0 to");
    expect_refused("soup:n=", "soup: n= must be a number");
    expect_refused("soup:n=x", "soup: n=x must be a number");
    expect_refused("soup:n=3x", "soup: n=3x must be a number");
    expect_refused("soup:n=nan", "soup: n=nan must be a number");
    expect_refused("soup:n=-1", "soup: n=-1 must be a number from 0 to 1048576 (triangles)");
    expect_refused("soup:n=1e300", "soup: n=1e300 must be a number from 0 to");
    expect_refused("soup:n=3=4", "soup: n=3=4 must be a number");
    expect_refused("soup:n=3,n=3", "soup: n is given twice");
    expect_refused("soup:seed=-1", "soup: seed=-1 must be a whole number");
    expect_refused("soup:seed=18446744073709551616", "must be a whole number from 0 to 2^64 - 1");
    expect_refused("soup:seed=", "soup: seed= must be a whole number");
    expect_refused("no/such/mesh.obj", "no/such/mesh.obj: No such file");
    expect_refused("/", "/: is a directory");
}

static void put(const char *path, const char *text)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    fputs(text, stream);
    assert_int_equal(fclose(stream), 0);
}

static void scene_open_reads_files_by_their_ending(void **state)
{
    (void)state;
    static const char mesh[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    char folder[] = "/tmp/raydiff-test-open-XXXXXX", before[200];
    assert_non_null(getcwd(before, sizeof before));
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    uint32_t count;
    put("a:b.obj", mesh);
    put("UPPER.OBJ", mesh);
    put("plain.obj.gz", mesh); /* not zipped, and read all the same */
    put("mesh.off", mesh);
    put("soup", mesh);
    put("noscene.json", mesh);
    gzFile zipped = gzopen("zip.obj.gz", "wb");
    assert_non_null(zipped);
    assert_true(gzputs(zipped, mesh) > 0);
    assert_int_equal(gzclose(zipped), Z_OK);
    uint64_t want = digest("a:b.obj", 1, &count);
    assert_int_equal(count, 1);
    assert_true(digest("./UPPER.OBJ", 1, &count) == want);
    assert_true(digest("zip.obj.gz", 1, &count) == want);
    assert_true(digest("plain.obj.gz", 1, &count) == want);
    expect_refused("mesh.off", "mesh.off: unknown ending");
    expect_refused("./soup", "./soup: unknown ending");
    expect_refused("noscene.json", "noscene.json:1:");
    digest("soup", 1, &count);
    assert_int_equal(count, 1000); /* the generator, not the file */
    static const char *const made[] = {"a:b.obj", "UPPER.OBJ",  "plain.obj.gz", "mesh.off",
                                       "soup",    "zip.obj.gz", "noscene.json"};
    for (size_t i = 0; i < ARRAY_COUNT(made); i++)
        assert_int_equal(unlink(made[i]), 0);
    assert_int_equal(chdir(before), 0);
    assert_int_equal(rmdir(folder), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scene_open_makes_every_generator_with_its_defaults),
        cmocka_unit_test(scene_open_passes_parameters_and_seed),
        cmocka_unit_test(scene_open_names_what_it_does_not_know),
        cmocka_unit_test(scene_open_reads_files_by_their_ending),
    };
    return cmocka_run_group_tests_name("scene_open", tests, NULL, NULL);
}
