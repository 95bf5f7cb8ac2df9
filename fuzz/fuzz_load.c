/* Coverage-guided fuzzing of the readers (libFuzzer): the first byte chooses the format, the rest
 * is the file. Whatever the bytes, a reader gives a scene that scene_check accepts (a finding's
 * text file: a trial that fuzz_trial_check accepts) or one line of reason; it must survive writing
 * and reading back bit for bit. make fuzz-load [SECONDS=60]
 */
#define _POSIX_C_SOURCE 200809L
#include "fuzz/finding_file.h"
#include "scenes/formats.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef enum status reader_fn(const char *name, const char *bytes, size_t size, struct scene *out,
                              struct reason *reason);

static void same_again(const struct scene *scene)
{
    char *bytes = NULL;
    size_t size = 0;
    struct reason reason = {""};
    struct scene again;
    FILE *stream = open_memstream(&bytes, &size);
    if (!stream)
        return;
    if (write_ply(scene, stream, &reason) || fclose(stream) != 0 ||
        read_ply("again", bytes, size, &again, &reason))
        abort();
    if (again.vertex_count != scene->vertex_count || again.tri_count != scene->tri_count ||
        memcmp(again.vertex, scene->vertex, 12 * (size_t)scene->vertex_count) != 0 ||
        memcmp(again.index, scene->index, 12 * (size_t)scene->tri_count) != 0)
        abort();
    scene_free(&again);
    free(bytes);
}

static void check_reason(const struct reason *reason)
{
    if (reason->text[0] == '\0' || strchr(reason->text, '\n'))
        abort();
}

static void read_scene(reader_fn *reader, const char *bytes, size_t size)
{
    struct scene scene;
    struct reason reason = {""};
    if (reader("fuzz", bytes, size, &scene, &reason) == STATUS_OK) {
        if (scene_check(&scene, NULL))
            abort();
        same_again(&scene);
    } else {
        check_reason(&reason);
    }
    scene_free(&scene);
}

static void read_trial(const char *name, const char *bytes, size_t size)
{
    struct finding_file file, again;
    struct reason reason = {""};
    char *text = NULL;
    size_t length = 0;
    if (finding_file_parse(name, bytes, size, &file, &reason)) {
        check_reason(&reason);
        return;
    }
    if (fuzz_trial_check(&file.trial, NULL) || finding_file_print(&file, &text, &length, &reason) ||
        finding_file_parse("again", text, length, &again, &reason) ||
        fuzz_trial_hash(&file.trial) != fuzz_trial_hash(&again.trial) ||
        file.has_signature != again.has_signature ||
        !fuzz_signature_same(&file.signature, &again.signature))
        abort();
    finding_file_free(&again);
    finding_file_free(&file);
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static reader_fn *const readers[] = {read_obj, read_ply, read_rtrs};
    if (size < 1)
        return 0;
    char *bytes = malloc(size);
    if (!bytes)
        return 0;
    memcpy(bytes, data + 1, size - 1);
    bytes[size - 1] = '\0';
    size_t mode = data[0] % (ARRAY_COUNT(readers) + 1);
    if (mode < ARRAY_COUNT(readers))
        read_scene(readers[mode], bytes, size - 1);
    else
        read_trial("fuzz", bytes, size - 1);
    free(bytes);
    return 0;
}
