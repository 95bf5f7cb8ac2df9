#include "scenes/read/formats.h"

/* Low byte first, whatever this machine does. */
static void put_word(uint32_t word, FILE *stream)
{
    for (int shift = 0; shift < 32; shift += 8)
        putc((int)(word >> shift & 0xFF), stream);
}

enum status write_ply(const struct scene *scene, FILE *stream, struct reason *reason)
{
    (void)reason;
    fprintf(stream,
            "ply\nformat binary_little_endian 1.0\n"
            "element vertex %u\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %u\nproperty list uchar uint vertex_indices\nend_header\n",
            scene->vertex_count, scene->tri_count);
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        put_word(float_bits(scene->vertex[i]), stream);
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++) {
        if (i % 3 == 0)
            putc(3, stream);
        put_word(scene->index[i], stream);
    }
    return STATUS_OK;
}
