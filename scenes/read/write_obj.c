#include "ref/base/decimal.h"
#include "scenes/read/formats.h"

enum status write_obj(const struct scene *scene, FILE *stream, struct reason *reason)
{
    (void)reason;
    fprintf(stream, "# %u vertices, %u triangles\n", scene->vertex_count, scene->tri_count);
    for (size_t i = 0; i < scene->vertex_count; i++) {
        char text[3][DECIMAL_TEXT];
        for (size_t k = 0; k < 3; k++)
            decimal_write_float(scene->vertex[3 * i + k], text[k]);
        fprintf(stream, "v %s %s %s\n", text[0], text[1], text[2]);
    }
    for (size_t i = 0; i < scene->tri_count; i++) {
        const uint32_t *index = scene->index + 3 * i;
        fprintf(stream, "f %llu %llu %llu\n", index[0] + 1ull, index[1] + 1ull, index[2] + 1ull);
    }
    return STATUS_OK;
}
