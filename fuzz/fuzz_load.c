/* Coverage-guided fuzzing of the readers (libFuzzer): the first byte chooses the format, the rest
 * is the file. Whatever the bytes, a reader gives a scene that scene_check accepts or one line of
 * reason; a scene must survive writing and reading back bit for bit.
 *   make fuzz-load [SECONDS=60]
 */
#define _POSIX_C_SOURCE 200809L
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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static reader_fn *const readers[] = {read_obj, read_ply, read_rtrs};
    struct scene scene;
    struct reason reason = {""};
    if (size < 1)
        return 0;
    char *bytes = malloc(size);
    if (!bytes)
        return 0;
    memcpy(bytes, data + 1, size - 1);
    bytes[size - 1] = '\0';
    enum status status = readers[data[0] % 3]("fuzz", bytes, size - 1, &scene, &reason);
    if (status == STATUS_OK) {
        if (scene_check(&scene, NULL))
            abort();
        same_again(&scene);
    } else if (reason.text[0] == '\0' || strchr(reason.text, '\n')) {
        abort();
    }
    scene_free(&scene);
    free(bytes);
    return 0;
}
