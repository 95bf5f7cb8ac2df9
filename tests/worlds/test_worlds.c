/* Worlds by name: files in a folder that name each other, what is a scene, and what is written by
 * which ending. */
#define _GNU_SOURCE /* mkdtemp */
#include "ref/files/file.h"
#include "scenes/worlds.h"
#include "tests/worlds/files_fixture.h"

#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "/tmp/raydiff-test-worlds-XXXXXX";
static char before[400];

static int enter(void **state)
{
    (void)state;
    return !getcwd(before, sizeof before) || !mkdtemp(folder) || chdir(folder) != 0 ||
           mkdir("below", 0700) != 0;
}

static int leave(void **state)
{
    (void)state;
    return system("rm -r below/* ./*.* && rmdir below") != 0 || chdir(before) != 0 ||
           rmdir(folder) != 0;
}

static void put(const char *path, const char *text)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    fputs(text, stream);
    assert_int_equal(fclose(stream), 0);
}

static void open_world(const char *spec, struct world *out)
{
    enum status status = world_open(spec, 1, out, &reason);
    if (status)
        print_error("%s\n", reason.text);
    assert_int_equal(status, STATUS_OK);
}

static void expect_refused(const char *spec, const char *rule)
{
    struct world world;
    reason.text[0] = '\0';
    enum status status = world_open(spec, 1, &world, &reason);
    assert_null(world.mesh);
    assert_null(strchr(reason.text, '\n'));
    expect_rule(status, rule);
}

#define HEAD "{\"raydiff_world\":1,\"instances\":[{\"mesh\":0}],\"meshes\":["

static void put_files(void)
{
    put("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    put("below/two.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n");
    put("below/inner.json", HEAD "{\"scene\":\"two.obj\"}]}");
    put("below/soup", "");
    put("outer.world.json", HEAD "{\"scene\":\"below/inner.json\"},{\"scene\":\"one.obj\"},"
                                 "{\"scene\":\"soup:n=5\"},{\"scene\":\"soup:n=5,seed=1\"}]}");
}

static void meshes_are_files_beside_a_world(void **state)
{
    (void)state;
    struct world world, other;
    put_files();
    open_world("outer.world.json", &world);
    assert_int_equal(world.mesh_count, 4);
    assert_int_equal(world.mesh[0].scene->tri_count, 2);
    assert_int_equal(world.mesh[1].scene->tri_count, 1);
    assert_int_equal(world.mesh[2].scene->tri_count, 5);
    /* From elsewhere, with another seed and an absolute path: the same world. */
    char path[300];
    (void)snprintf(path, sizeof path, "%s/outer.world.json", folder);
    assert_int_equal(world_open(path, 7, &other, &reason), STATUS_OK);
    assert_same_world(&world, &other);
    assert_memory_equal(world.mesh[2].scene->vertex, world.mesh[3].scene->vertex, 5 * 36);
    world_free(&other);
    world_free(&world);
}

static void files_outside_the_folder_are_refused(void **state)
{
    (void)state;
    static const char *const names[] = {
        "../one.obj", "/etc/passwd", "below/../../one.obj", "below/..",
        "",           "..",          "./../x/one.obj",      "below//..//one.obj"};
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        char text[200];
        (void)snprintf(text, sizeof text, HEAD "{\"scene\":\"%s\"}]}", names[i]);
        put("out.json", text);
        expect_refused("out.json", "is no file in the folder of this one, or below it");
        (void)snprintf(
            text, sizeof text,
            "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":1,\"uri\":\"%s\"}],"
            "\"bufferViews\":[{\"buffer\":0,\"byteLength\":1}],",
            names[i]);
        FILE *stream = fopen("out.gltf", "wb");
        assert_non_null(stream);
        fputs(text, stream);
        fputs("\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":"
              "\"VEC3\"}],"
              "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
              stream);
        assert_int_equal(fclose(stream), 0);
        expect_refused("out.gltf", "out.gltf: buffers[0].uri: '");
    }
    put("out.json", HEAD "{\"scene\":\"below/..two.obj\"}]}");
    expect_refused("out.json", "below/..two.obj: No such file"); /* which is a name */
}

static void a_circle_of_files_is_refused(void **state)
{
    (void)state;
    put("self.json", HEAD "{\"scene\":\"self.json\"}]}");
    expect_refused("self.json",
                   "self.json: meshes[0].scene: ./self.json: is being read: these files");
    put("a.json", HEAD "{\"scene\":\"below/b.json\"}]}");
    put("below/b.json", HEAD "{\"scene\":\"c.json\"}]}");
    put("below/c.json", HEAD "{\"scene\":\"b.json\"}]}");
    expect_refused("a.json", "below/b.json: is being read: these files name each other");
    assert_int_equal(symlink("a.json", "link.json"), 0);
    put("below/c.json", HEAD "{\"scene\":\"../a.json\"}]}");
    expect_refused("a.json", "'../a.json' is no file in the folder");
    put("a.json", HEAD "{\"scene\":\"link.json\"}]}");
    expect_refused("a.json", "link.json: is being read");
}

static void what_a_file_names_is_a_regular_file(void **state)
{
    (void)state;
    static const char *const names[] = {"pipe", "gone.bin", "below", "file.bin"};
    static const char *const rules[] = {"is no regular file", "No such file", "is a directory",
                                        "buffers[0].byteLength: is 36, but there are 20 bytes"};
    assert_int_equal(mkfifo("pipe", 0600), 0);
    FILE *stream = fopen("file.bin", "wb"); /* begins as a zipped one does */
    assert_non_null(stream);
    assert_int_equal(fwrite("\x1F\x8B\x08\x00 to be read as it", 1, 20, stream), 20);
    assert_int_equal(fclose(stream), 0);
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        char text[400];
        (void)snprintf(
            text, sizeof text,
            "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"%s\"}],"
            "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
            "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{"
            "\"attributes\":{\"POSITION\":0}}]}]}",
            names[i]);
        put("file.gltf", text);
        expect_refused("file.gltf", rules[i]);
    }
    assert_int_equal(unlink("pipe"), 0);
}

static void a_scene_is_a_world_of_one_instance(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere:n=3", "rtrs", "one.obj", "./one.obj"};
    put_files();
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        struct world world;
        struct scene scene;
        open_world(specs[i], &world);
        assert_int_equal(scene_open(specs[i], 1, &scene, &reason), STATUS_OK);
        assert_true(world_is_plain(&world));
        assert_false(world.borrows);
        assert_ptr_equal(world_only_scene(&world), world.mesh[0].scene);
        assert_int_equal(world.mesh[0].scene->tri_count, scene.tri_count);
        assert_int_equal(world.mesh[0].scene->light_count, scene.light_count);
        assert_memory_equal(world.mesh[0].scene->vertex, scene.vertex, 12 * scene.vertex_count);
        scene_free(&scene);
        world_free(&world);
    }
    expect_refused("suop",
                   "unknown scene 'suop': no file, and no generator; those are soup, sphere");
    expect_refused("crwod", "did you mean crowd");
    expect_refused("crowd:m=3", "crowd: 'm' is no parameter; known are n, size, seed");
    expect_refused("crowd:n=0", "crowd: n=0 must be a number from 1 to 1048576");
    expect_refused("no/such.glb", "no/such.glb: No such file");
    expect_refused("below", "below: is a directory");
}

/* The instance of a world with one mesh, as text. */
static bool is_scene(const char *instance, const char *geometries, const char *filter, bool *plain)
{
    char text[600];
    struct world world;
    (void)snprintf(text, sizeof text,
                   "{\"raydiff_world\":1,\"meshes\":[{\"scene\":\"sphere:n=1\"%s}],\"instances\":[{"
                   "\"mesh\":0%s}]%s}",
                   geometries, instance, filter);
    put("one.json", text);
    open_world("one.json", &world);
    bool only = world_only_scene(&world) != NULL;
    *plain = world_is_plain(&world);
    world_free(&world);
    struct scene scene;
    enum status status = scene_open("one.json", 1, &scene, &reason);
    assert_int_equal(status == STATUS_OK, only);
    if (status)
        expect_rule(status, "one.json: is a world of 1 mesh, 1 instance, 8 placed triangles; this");
    scene_free(&scene);
    return only;
}

static void a_world_that_rays_meet_as_a_scene_is_one(void **state)
{
    (void)state;
    static const char turned[] = ",\"transform\":[0,-1,0,0,1,0,0,0,0,0,1,0]";
    static const char part[] = ",\"geometries\":[{\"count\":3,\"opaque\":false},{\"count\":5}]";
    static const char cells[] = ",\"filter\":{\"kind\":\"cells\",\"share\":256}";
    bool plain;
    assert_true(is_scene("", "", "", &plain) && plain);
    assert_true(is_scene(",\"transform\":[1,0,-0.0,0,0,1,0,0,0,0,1,0]", "", "", &plain) && plain);
    assert_true(is_scene(",\"mask\":1", "", "", &plain) && !plain);
    assert_true(is_scene(",\"custom\":1", "", "", &plain) && !plain);
    assert_true(is_scene(",\"flags\":[\"flip_facing\"]", "", "", &plain) && !plain);
    assert_true(is_scene("", part, "", &plain) && !plain);
    assert_true(is_scene("", "", cells, &plain) && !plain);
    assert_true(is_scene(",\"flags\":[\"force_opaque\"]", part, cells, &plain) && !plain);
    assert_false(is_scene("", part, cells, &plain) || plain);
    assert_false(is_scene(",\"flags\":[\"force_no_opaque\"]", "", cells, &plain) || plain);
    assert_false(is_scene(turned, "", "", &plain) || plain);
    assert_false(is_scene(",\"mask\":0", "", "", &plain) || plain);
    struct scene scene;
    enum status status = scene_open("placed-far", 1, &scene, &reason);
    expect_rule(status,
                "placed-far: is a world of 1 mesh, 4 instances, 2048 placed triangles; this");
    put("empty.json", "{\"raydiff_world\":1,\"meshes\":[],\"instances\":[]}");
    status = scene_open("empty.json", 1, &scene, &reason);
    expect_rule(status,
                "empty.json: is a world of 0 meshes, 0 instances, 0 placed triangles; this");
    put("empty.json", "{\"raydiff_world\":1,\"meshes\":[{\"vertices\":[],\"indices\":[]}],"
                      "\"instances\":[{\"mesh\":0}]}");
    status = scene_open("empty.json", 1, &scene, &reason);
    expect_rule(status, "empty.json: has no triangle");
}

static void every_ending_is_written_and_read(void **state)
{
    (void)state;
    static const char *const endings[] = {"x.json", "x.gltf", "x.glb", "X.GLTF"};
    struct world world, back;
    open_world("nest:n=1", &world);
    for (size_t i = 0; i < ARRAY_COUNT(endings); i++) {
        assert_int_equal(world_write(endings[i], &world, &reason), STATUS_OK);
        open_world(endings[i], &back);
        assert_same_world(&world, &back);
        world_free(&back);
    }
    static const char *const scenes[] = {"x.obj", "x.ply", "x.stl"};
    for (size_t i = 0; i < ARRAY_COUNT(scenes); i++) {
        enum status status = world_write(scenes[i], &world, &reason);
        expect_rule(status, ": this format holds one mesh in one instance at the identity, not a "
                            "world of 1 mesh, 16 instances, 128 placed triangles; .json, .gltf");
        assert_int_equal(access(scenes[i], F_OK), -1);
    }
    world_free(&world);
    open_world("sphere:n=2", &world);
    for (size_t i = 0; i < ARRAY_COUNT(scenes); i++) {
        assert_int_equal(world_write(scenes[i], &world, &reason), STATUS_OK);
        open_world(scenes[i], &back);
        assert_true(world_is_plain(&back));
        assert_int_equal(world_tri_count(&back), 32);
        world_free(&back);
    }
    expect_rule(world_write("x.xyz", &world, &reason), "x.xyz: unknown ending; worlds are written");
    expect_rule(world_write("no/x.glb", &world, &reason), "no/x.glb: cannot write: No such file");
    world_free(&world);
}

/* A refusal of the format leaves the file that was there. */
static void what_cannot_be_written_leaves_the_file(void **state)
{
    (void)state;
    struct world world;
    char *bytes;
    size_t size;
    put("kept.gltf", "kept");
    open_world("mixed", &world);
    expect_rule(world_write("kept.gltf", &world, &reason), "kept.gltf: mesh 0: geometry ");
    world_free(&world);
    assert_int_equal(file_read("kept.gltf", &bytes, &size, &reason), STATUS_OK);
    assert_int_equal(size, 4);
    free(bytes);
}

static void zipped_files_are_read_too(void **state)
{
    (void)state;
    struct world world, back;
    open_world("twins:k=2", &world);
    assert_int_equal(world_write("z.glb", &world, &reason), STATUS_OK);
    assert_int_equal(world_write("z.json", &world, &reason), STATUS_OK);
    assert_int_equal(system("gzip -f z.glb z.json"), 0);
    open_world("z.glb.gz", &back);
    assert_same_world(&world, &back);
    world_free(&back);
    open_world("z.json.gz", &back);
    assert_same_world(&world, &back);
    world_free(&back);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_are_files_beside_a_world),
        cmocka_unit_test(files_outside_the_folder_are_refused),
        cmocka_unit_test(a_circle_of_files_is_refused),
        cmocka_unit_test(what_a_file_names_is_a_regular_file),
        cmocka_unit_test(a_scene_is_a_world_of_one_instance),
        cmocka_unit_test(a_world_that_rays_meet_as_a_scene_is_one),
        cmocka_unit_test(every_ending_is_written_and_read),
        cmocka_unit_test(what_cannot_be_written_leaves_the_file),
        cmocka_unit_test(zipped_files_are_read_too),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
