/* Choosing drivers, several in one process, and the same bits from each of them. */
#define _POSIX_C_SOURCE 200809L /* mkdtemp */
#include "gpu/vk/vk_driver.h"

#include "tests/support/drivers.h"

#include <sys/stat.h>
#include <unistd.h>

#define NOWHERE "/nowhere/drivers"

static void driver_names_and_parts_are_told_apart(void **state)
{
    (void)state;
    struct driver driver;
    struct reason reason = {""};
    gpu_must(driver_find(NULL, &driver, &reason), &reason);
    assert_int_equal(driver.kind, DRIVER_ANY);
    gpu_must(driver_find("hardware", &driver, &reason), &reason);
    assert_int_equal(driver.kind, DRIVER_HARDWARE);
    gpu_must(driver_find("llvm", &driver, &reason), &reason);
    assert_int_equal(driver.kind, DRIVER_PART);
    assert_string_equal(driver.text, "llvm");
    assert_int_equal(driver_find("no/such.json", &driver, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "no/such.json"));
    assert_int_equal(driver_find("such.json", &driver, &reason), STATUS_UNSUPPORTED);
}

static void driver_not_fetched_says_what_to_do(void **state)
{
    (void)state;
    struct driver driver;
    struct reason reason = {""};
    assert_int_equal(setenv("RAYDIFF_DRIVERS", NOWHERE, 1), 0);
    for (size_t i = 1; i < ARRAY_COUNT(cpu_drivers); i++) {
        assert_int_equal(driver_find(cpu_drivers[i], &driver, &reason), STATUS_UNSUPPORTED);
        assert_non_null(strstr(reason.text, "make drivers"));
        assert_non_null(strstr(reason.text, NOWHERE));
        assert_non_null(strstr(reason.text, cpu_drivers[i]));
    }
    assert_int_equal(unsetenv("RAYDIFF_DRIVERS"), 0);
}

/* A folder's name may have one letter; an empty one is none. */
static void driver_folder_is_the_environments_if_it_names_one(void **state)
{
    (void)state;
    struct driver driver;
    struct reason reason = {""}, other = {""};
    assert_int_equal(setenv("RAYDIFF_DRIVERS", "~", 1), 0);
    assert_int_equal(driver_find("mesa25", &driver, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, " is not in ~: "));
    assert_int_equal(setenv("RAYDIFF_DRIVERS", "", 1), 0);
    reason.text[0] = '\0';
    enum status empty = driver_find("mesa25", &driver, &reason);
    assert_int_equal(unsetenv("RAYDIFF_DRIVERS"), 0);
    assert_int_equal(driver_find("mesa25", &driver, &other), empty);
    assert_string_equal(reason.text, other.text);
}

/* Of both names; or by a path as long as fits, which is no fetched one. */
static void driver_that_was_fetched_is_found_in_its_folder(void **state)
{
    (void)state;
    char folder[] = "/tmp/raydiff-driver-XXXXXX", place[64], icd[80], path[DRIVER_PATH_BYTES + 1];
    struct driver driver;
    struct reason reason = {""};
    assert_non_null(mkdtemp(folder));
    assert_int_equal(setenv("RAYDIFF_DRIVERS", folder, 1), 0);
    for (size_t i = 1; i < ARRAY_COUNT(cpu_drivers); i++) {
        assert_int_equal(driver_find(cpu_drivers[i], &driver, &reason), STATUS_UNSUPPORTED);
        snprintf(place, sizeof place, "%s/%s", folder, cpu_drivers[i]);
        snprintf(icd, sizeof icd, "%s/icd.json", place);
        assert_int_equal(mkdir(place, 0700), 0);
        assert_int_equal(driver_find(cpu_drivers[i], &driver, &reason), STATUS_UNSUPPORTED);
        assert_int_equal(fclose(fopen(icd, "w")), 0);
        gpu_must(driver_find(cpu_drivers[i], &driver, &reason), &reason);
        assert_true(driver.kind == DRIVER_FILE && driver.fetched);
        assert_string_equal(driver.icd, icd);
        memset(path, '/', sizeof path);
        strcpy(path + DRIVER_PATH_BYTES - 1 - strlen(icd), icd);
        gpu_must(driver_find(path, &driver, &reason), &reason);
        assert_true(driver.kind == DRIVER_FILE && !driver.fetched);
        assert_string_equal(driver.icd, path);
        strcpy(path + DRIVER_PATH_BYTES - strlen(icd), icd);
        assert_int_equal(driver_find(path, &driver, &reason), STATUS_UNSUPPORTED);
        assert_int_equal(unlink(icd) || rmdir(place), 0);
    }
    assert_int_equal(unsetenv("RAYDIFF_DRIVERS") || rmdir(folder), 0);
}

/* Package and version of each line of the file beside the driver that has both, as many as fit. */
static void driver_version_is_read_beside_a_fetched_one(void **state)
{
    (void)state;
    static const char wanted[] = "mesa 25.0.1, llvm 19-2";
    char folder[] = "/tmp/raydiff-driver-XXXXXX", path[64], text[64];
    struct driver driver = {.kind = DRIVER_FILE, .fetched = true};
    assert_non_null(mkdtemp(folder));
    snprintf(driver.icd, sizeof driver.icd, "%s/some.json", folder);
    snprintf(path, sizeof path, "%s/versions", folder);
    driver_version(&driver, text, sizeof text);
    assert_string_equal(text, "");
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    fputs("0123 mesa 25.0.1 rest\n4567 kept -\nshort line\n89ab llvm 19-2\n", out);
    assert_int_equal(fclose(out), 0);
    driver_version(&driver, text, sizeof text);
    assert_string_equal(text, wanted);
    driver.fetched = false;
    driver_version(&driver, text, sizeof text);
    assert_string_equal(text, "");
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

static void driver_scope_puts_the_environment_back(void **state)
{
    (void)state;
    struct driver driver = {.kind = DRIVER_FILE, .icd = "some.json"};
    struct driver_scope scope;
    struct reason reason = {""};
    char *before = getenv("VK_ICD_FILENAMES") ? strdup(getenv("VK_ICD_FILENAMES")) : NULL;
    assert_int_equal(setenv("VK_DRIVER_FILES", "mine.json", 1), 0);
    assert_int_equal(unsetenv("VK_ICD_FILENAMES"), 0);
    gpu_must(driver_begin(&driver, &scope, &reason), &reason);
    assert_string_equal(getenv("VK_DRIVER_FILES"), "some.json");
    assert_string_equal(getenv("VK_ICD_FILENAMES"), "some.json");
    driver_end(&scope);
    assert_string_equal(getenv("VK_DRIVER_FILES"), "mine.json");
    assert_null(getenv("VK_ICD_FILENAMES"));
    driver.kind = DRIVER_PART;
    gpu_must(driver_begin(&driver, &scope, &reason), &reason);
    assert_string_equal(getenv("VK_DRIVER_FILES"), "mine.json");
    driver_end(&scope);
    assert_int_equal(unsetenv("VK_DRIVER_FILES"), 0);
    if (before)
        assert_int_equal(setenv("VK_ICD_FILENAMES", before, 1), 0);
    free(before);
}

/* Opens `name`; false, with the reason printed, where it is not. */
static bool open_as(const char *name, char device[VK_NAME_BYTES])
{
    struct vk_options options = gpu_options();
    struct reason reason = {""};
    struct vk *vk;
    options.driver = name;
    enum status status = vk_open(&options, &vk, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        return false;
    }
    gpu_must(status, &reason);
    (void)snprintf(device, VK_NAME_BYTES, "%.100s %.100s", vk_limits(vk)->device,
                   vk_limits(vk)->driver);
    assert_true(vk_limits(vk)->software);
    gpu_close(vk);
    return true;
}

static void drivers_open_one_after_the_other(void **state)
{
    (void)state;
    static const char *const order[] = {"mesa25", "stock", "swiftshader", "stock", "mesa25"};
    char first[ARRAY_COUNT(order)][VK_NAME_BYTES] = {""};
    size_t opened = 0;
    for (size_t i = 0; i < ARRAY_COUNT(order); i++) {
        if (!open_as(order[i], first[i]))
            continue;
        opened++;
        assert_int_equal(strstr(first[i], "SwiftShader") != NULL, i == 2);
        for (size_t k = 0; k < i; k++)
            if (first[k][0] &&
                (strcmp(first[i], first[k]) == 0) != (strcmp(order[i], order[k]) == 0))
                fail_msg("%s is '%s', %s was '%s'", order[i], first[i], order[k], first[k]);
    }
    if (!opened)
        skip();
}

static void driver_file_opens_by_its_path(void **state)
{
    (void)state;
    struct driver driver;
    struct reason reason = {""};
    char by_name[VK_NAME_BYTES], by_file[VK_NAME_BYTES];
    if (driver_find("stock", &driver, &reason) || !open_as("stock", by_name))
        skip();
    assert_true(open_as(driver.icd, by_file));
    assert_string_equal(by_name, by_file);
}

static void driver_hardware_is_never_a_cpu(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct reason reason = {""};
    struct vk *vk;
    options.driver = "hardware";
    enum status status = vk_open(&options, &vk, &reason);
    if (status == STATUS_UNSUPPORTED) {
        assert_non_null(strstr(reason.text, "hardware"));
        return;
    }
    gpu_must(status, &reason);
    assert_false(vk_limits(vk)->software);
    gpu_close(vk);
}

static const struct {
    const char *layout, *box, *tri;
    enum query query;
} mixes[] = {
    {"f32", "robust", "mt", QUERY_CLOSEST}, {"rf16", "robust", "woop", QUERY_CLOSEST},
    {"rf16", "robust", "mt", QUERY_ANY},    {"rtrs_direct", "rtrs", "mt_rtrs", QUERY_CLOSEST},
    {"rtrs_rf", "rtrs", "woop", QUERY_ANY},
};

/* Pipelines cost drivers 0.2 s each; `raydiff conform --driver` has all combinations. */
static void compare_all(const char *driver, void *self, struct drivers_view *view)
{
    for (size_t m = 0; m < ARRAY_COUNT(mixes); m++) {
        view_pack(view, mixes[m].layout);
        const struct job job = {.scene = &view->scene,
                                .packed = &view->packed,
                                .box = box_test_find(mixes[m].box),
                                .tri = tri_test_find(mixes[m].tri),
                                .query = mixes[m].query};
        size_t hits = driver_trace("vulkan", self, view, &job, view->got);
        for (size_t i = 0; i < view->ray_count; i++)
            assert_int_equal(trace_ray(&(struct job){.scene = &view->scene,
                                                     .packed = &view->packed,
                                                     .box = job.box,
                                                     .tri = job.tri,
                                                     .query = job.query},
                                       &view->ray[i], &view->expected[i], NULL),
                             STATUS_OK);
        size_t differs = view_differs(view);
        if (differs)
            fail_msg("%s: %s %s %s %s: %zu of %zu answers differ", driver, mixes[m].layout,
                     job.box->name, job.tri->name, query_name(job.query), differs, view->ray_count);
        assert_true(hits > 0);
    }
}

static void drivers_trace_the_bits_of_c(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=200", "sphere"};
    size_t jobs = 0;
    for (size_t d = 0; d < ARRAY_COUNT(cpu_drivers); d++) {
        void *self = driver_open("vulkan", cpu_drivers[d]);
        if (!self)
            continue;
        for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
            struct drivers_view view = view_make(specs[s], "vertices", 2000);
            compare_all(cpu_drivers[d], self, &view);
            jobs++;
            view_free(&view);
        }
        engine_find("vulkan")->close(self);
    }
    if (!jobs)
        skip();
}

/* Closest, any and all hits of engines `brute` and `vulkan_brute`. */
static void compare_brute(const char *driver, void *self, void *c, struct drivers_view *view)
{
    enum { CAPACITY = 3 };
    const struct engine *brute = engine_find("brute"), *vulkan = engine_find("vulkan_brute");
    struct reason reason = {""};
    for (size_t t = 0; tri_tests[t]; t++) {
        if (view->scene.tri_count > 1000 && tri_tests[t]->id != ABI_TRI_WOOP)
            continue; /* one test for the slow scenes */
        for (int q = 0; q < 2; q++) {
            const struct job job = {.scene = &view->scene,
                                    .packed = NULL,
                                    .box = box_tests[0],
                                    .tri = tri_tests[t],
                                    .query = q ? QUERY_ANY : QUERY_CLOSEST};
            (void)driver_trace("brute", c, view, &job, view->expected);
            (void)driver_trace("vulkan_brute", self, view, &job, view->got);
            if (view_differs(view))
                fail_msg("%s: %s %s: %zu of %zu answers differ", driver, job.tri->name,
                         query_name(job.query), view_differs(view), view->ray_count);
        }
        const struct job job = {.scene = &view->scene,
                                .packed = NULL,
                                .box = box_tests[0],
                                .tri = tri_tests[t],
                                .query = QUERY_ALL};
        const size_t n = view->ray_count;
        struct hit *hit[2] = {calloc(n, CAPACITY * sizeof(struct hit)),
                              calloc(n, CAPACITY * sizeof(struct hit))};
        uint32_t *count[2] = {calloc(n, 4), calloc(n, 4)};
        assert_true(hit[0] && hit[1] && count[0] && count[1]);
        gpu_must(brute->prepare(c, &job, &reason), &reason);
        gpu_must(brute->trace_all(c, view->ray, n, CAPACITY, hit[0], count[0], &reason), &reason);
        gpu_must(vulkan->prepare(self, &job, &reason), &reason);
        gpu_must(vulkan->trace_all(self, view->ray, n, CAPACITY, hit[1], count[1], &reason),
                 &reason);
        assert_memory_equal(count[0], count[1], 4 * n);
        for (size_t i = 0; i < n; i++) {
            size_t listed = count[0][i] < CAPACITY ? count[0][i] : CAPACITY;
            assert_memory_equal(hit[0] + i * CAPACITY, hit[1] + i * CAPACITY,
                                listed * sizeof(struct hit));
        }
        for (int i = 0; i < 2; i++) {
            free(hit[i]);
            free(count[i]);
        }
    }
}

/* One part of the triangles, a part and a bit, several parts. */
static void drivers_brute_force_has_the_bits_of_c(void **state)
{
    (void)state;
    static const struct {
        const char *spec;
        size_t rays;
    } scenes[] = {{"soup:n=1", 65},
                  {"soup:n=500", 700},
                  {"soup:n=16384", 70},
                  {"soup:n=16385", 70},
                  {"soup:n=40000", 70}};
    struct engine_options options = {.device = -1};
    struct reason reason = {""};
    void *c = NULL;
    size_t opened = 0;
    gpu_must(engine_open(engine_find("brute"), &options, &c, &reason), &reason);
    for (size_t d = 0; d < ARRAY_COUNT(cpu_drivers); d++) {
        void *self = driver_open("vulkan_brute", cpu_drivers[d]);
        if (!self)
            continue;
        for (size_t s = 0; s < ARRAY_COUNT(scenes); s++) {
            struct drivers_view view = view_make(scenes[s].spec, "mixed", scenes[s].rays);
            compare_brute(cpu_drivers[d], self, c, &view);
            view_free(&view);
        }
        assert_false(
            engine_model(engine_find("vulkan_brute"), self, tri_tests[0]).bits); /* no tree */
        engine_find("vulkan_brute")->close(self);
        opened++;
    }
    engine_find("brute")->close(c);
    if (!opened)
        skip();
}

static void brute_force_of_an_empty_scene_misses(void **state)
{
    (void)state;
    struct scene scene;
    struct hit hit = {1, 1, 1, 1};
    const struct ray ray = {{0, 0, 0}, 0, {1, 0, 0}, 1};
    struct reason reason = {""};
    struct trace_report report;
    const struct engine *engine = engine_find("vulkan_brute");
    void *self = driver_open("vulkan_brute", NULL);
    if (!self)
        skip();
    assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    const struct job job = {.scene = &scene,
                            .packed = NULL,
                            .box = box_tests[0],
                            .tri = tri_tests[0],
                            .query = QUERY_CLOSEST};
    assert_int_equal(engine->trace(self, &ray, 1, &hit, &report, &reason), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "prepared"));
    gpu_must(engine->prepare(self, &job, &reason), &reason);
    gpu_must(engine->trace(self, &ray, 1, &hit, &report, &reason), &reason);
    const struct hit miss = {0, 0, 0, ABI_NO_PRIM};
    assert_memory_equal(&hit, &miss, sizeof hit);
    gpu_must(engine->trace(self, &ray, 0, &hit, &report, &reason), &reason);
    engine->close(self);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(driver_names_and_parts_are_told_apart),
        cmocka_unit_test(driver_not_fetched_says_what_to_do),
        cmocka_unit_test(driver_folder_is_the_environments_if_it_names_one),
        cmocka_unit_test(driver_that_was_fetched_is_found_in_its_folder),
        cmocka_unit_test(driver_version_is_read_beside_a_fetched_one),
        cmocka_unit_test(driver_scope_puts_the_environment_back),
        cmocka_unit_test(drivers_open_one_after_the_other),
        cmocka_unit_test(driver_file_opens_by_its_path),
        cmocka_unit_test(driver_hardware_is_never_a_cpu),
        cmocka_unit_test(drivers_trace_the_bits_of_c),
        cmocka_unit_test(drivers_brute_force_has_the_bits_of_c),
        cmocka_unit_test(brute_force_of_an_empty_scene_misses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
