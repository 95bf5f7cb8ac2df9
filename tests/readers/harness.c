#define _GNU_SOURCE /* memfd_create */
#include "tests/readers/reader_entry.h"
#include "ref/packed/tree_file.h"
#include "scenes/read/formats.h"
#include "scenes/read/world_formats.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static struct reader_tally tally;

const struct reader_tally *reader_tally(void)
{
    return &tally;
}

void reader_say(void)
{
    printf("reader %s inputs %" PRIu64 " taken %" PRIu64 " slowest %.1f ms of %zu bytes held %zu "
           "bytes of %zu times %.1f share %.3f%s\n",
           reader_entry.name, tally.inputs, tally.taken, 1e-6 * (double)tally.slowest_ns,
           tally.slowest_size, tally.most, tally.most_size, tally.times, tally.share,
           reader_counts() ? "" : " (not counted)");
    fflush(stdout);
}

_Noreturn void reader_broken(const char *rule, const char *file, int line)
{
    fprintf(stderr, "reader %s: does not hold: %s (%s:%d)\n", reader_entry.name, rule, file, line);
    abort();
}

void reader_must_be_reason(const struct reason *reason)
{
    READER_MUST(reason->text[0] != '\0');
    for (const char *at = reason->text; *at; at++)
        READER_MUST((unsigned char)*at >= 0x20 && *at != 0x7F);
}

void reader_must_be_scene(const struct scene *scene)
{
    char *bytes = NULL;
    size_t size = 0;
    struct reason reason = {""};
    struct scene again;
    READER_MUST(scene_check(scene, NULL) == STATUS_OK && scene->tri_count > 0);
    reader_count_limit(false);
    FILE *stream = open_memstream(&bytes, &size);
    READER_MUST(stream && write_ply(scene, stream, &reason) == STATUS_OK && fclose(stream) == 0);
    READER_MUST(read_ply("again", bytes, size, &again, &reason) == STATUS_OK);
    READER_MUST(again.vertex_count == scene->vertex_count && again.tri_count == scene->tri_count);
    READER_MUST(!memcmp(again.vertex, scene->vertex, 12 * (size_t)scene->vertex_count));
    READER_MUST(!memcmp(again.index, scene->index, 12 * (size_t)scene->tri_count));
    scene_free(&again);
    free(bytes);
    reader_count_limit(true);
}

bool reader_play_mesh(enum status (*read)(const char *name, const char *bytes, size_t size,
                                          struct scene *out, struct reason *reason),
                      const char *bytes, size_t size)
{
    struct scene scene;
    struct reason reason = {""};
    enum status status = read("fuzz", bytes, size, &scene, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status)
        reader_must_be_reason(&reason);
    else
        reader_must_be_scene(&scene);
    scene_free(&scene);
    return status == STATUS_OK;
}

/* Writes a world as JSON; the caller frees it. */
static char *world_text(const struct world *world, size_t *size)
{
    char *bytes = NULL;
    struct reason reason = {""};
    FILE *stream = open_memstream(&bytes, size);
    READER_MUST(stream && write_world(world, stream, &reason) == STATUS_OK && fclose(stream) == 0);
    return bytes;
}

/* The world whose file is `bytes` must be written as `text`. */
static void must_be_written(enum status status, struct world *world, const char *text, size_t size)
{
    size_t again_size;
    READER_MUST(status == STATUS_OK);
    char *again = world_text(world, &again_size);
    READER_MUST(again_size == size && memcmp(again, text, size) == 0);
    free(again);
    world_free(world);
}

void reader_must_be_world(enum status status, const struct world *world,
                          const struct reason *reason)
{
    struct reason why = {""};
    struct world_notes notes;
    struct world copy = *world, again;
    char *gltf = NULL;
    size_t size, gltf_size;
    if (status) {
        READER_MUST(!world->mesh && !world->instance && !world->first);
        reader_must_be_reason(reason);
        return;
    }
    reader_count_limit(false);
    copy.first = NULL;
    READER_MUST(world_finish(&copy, &why) == STATUS_OK);
    free(copy.first);
    char *text = world_text(world, &size);
    must_be_written(read_world("again", text, size, NULL, &again, &why), &again, text, size);
    FILE *stream = open_memstream(&gltf, &gltf_size);
    READER_MUST(stream);
    status = write_gltf(world, stream, &why);
    READER_MUST(fclose(stream) == 0);
    if (!status)
        must_be_written(read_gltf("again", gltf, gltf_size, NULL, &again, &notes, &why), &again,
                        text, size);
    free(gltf);
    free(text);
    reader_count_limit(true);
}

int reader_file(const char *bytes, size_t size, char path[READER_PATH_MOST])
{
    int file = memfd_create("reader", MFD_CLOEXEC);
    READER_MUST(file >= 0);
    for (size_t done = 0; done < size;) {
        ssize_t wrote = write(file, bytes + done, size - done);
        READER_MUST(wrote > 0);
        done += (size_t)wrote;
    }
    READER_MUST(lseek(file, 0, SEEK_SET) == 0);
    snprintf(path, READER_PATH_MOST, "/proc/self/fd/%d", file);
    return file;
}

/* Plays once; what is left in *left is not freed. */
static bool play_counted(const char *bytes, size_t size, ptrdiff_t *left)
{
    size_t held, most = READER_ANY;
    if (reader_entry.fixed != READER_ANY)
        most = READER_TIMES * size + reader_entry.fixed;
    reader_count_begin(most);
    uint64_t start = time_ns();
    bool taken = reader_entry.play(bytes, size);
    uint64_t spent = time_ns() - start;
    reader_count_end(&held, left);
    if (spent > tally.slowest_ns) {
        tally.slowest_ns = spent;
        tally.slowest_size = size;
    }
    if (held > tally.most) {
        tally.most = held;
        tally.most_size = size;
    }
    if (most != READER_ANY && (double)held > tally.share * (double)most)
        tally.share = (double)held / (double)most;
    if (size >= READER_TIMES_LEAST && (double)held > tally.times * (double)size)
        tally.times = (double)held / (double)size;
    return taken;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (tally.inputs == 0)
        READER_MUST(atexit(reader_say) == 0);
    char *bytes = malloc(size + 1);
    READER_MUST(bytes);
    memcpy(bytes, data, size);
    bytes[size] = '\0';
    ptrdiff_t left, again = 0;
    bool taken = play_counted(bytes, size, &left);
    if (left > 0) { /* what is kept from the first time on is no leak, what is added each time is */
        (void)play_counted(bytes, size, &again);
        if (again > 0)
            (void)play_counted(bytes, size, &again);
        if (again > 0)
            reader_broken("all memory is given back", __FILE__, __LINE__);
    }
    tally.inputs++;
    tally.taken += taken;
    free(bytes);
    return 0;
}

void reader_must_be_tree_file(const char *bytes, size_t size, const struct scene *scene,
                              bool readable)
{
    struct tree_file file;
    struct bvh bvh;
    struct reason reason = {""};
    enum status status = tree_file_read("fuzz", bytes, size, scene, &file, &reason);
    READER_MUST(status == STATUS_INPUT || (readable && status == STATUS_OK));
    READER_MUST(!readable || status == STATUS_OK || strstr(reason.text, "of another scene"));
    if (status) {
        reader_must_be_reason(&reason);
        return;
    }
    if (file.doubt.text[0])
        reader_must_be_reason(&file.doubt);
    status = tree_file_bvh(&file, scene, &bvh, &reason);
    READER_MUST(status == STATUS_INPUT || bvh_check_form(&bvh, scene, &reason) == STATUS_OK);
    if (status)
        reader_must_be_reason(&reason);
    bvh_free(&bvh);
    tree_file_free(&file);
}
