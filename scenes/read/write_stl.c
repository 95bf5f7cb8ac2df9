#include "scenes/read/formats.h"

#include <math.h>

static void put_u32(FILE *stream, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        fputc((int)(value >> (8 * i) & 0xFF), stream);
}

static void put_float3(FILE *stream, const float x[3])
{
    for (int k = 0; k < 3; k++)
        put_u32(stream, float_bits(x[k]));
}

/* The unit normal of a triangle, computed in double, where nothing overflows. */
static void make_normal(float v[3][3], float normal[3])
{
    double a[3], b[3], n[3];
    for (int k = 0; k < 3; k++) {
        a[k] = (double)v[1][k] - (double)v[0][k];
        b[k] = (double)v[2][k] - (double)v[0][k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++)
        normal[k] = length > 0 ? (float)(n[k] / length) : 0.0f;
}

enum status write_stl(const struct scene *scene, FILE *stream, struct reason *reason)
{
    (void)reason;
    fprintf(stream, "%-80s", "raydiff: binary STL"); /* not "solid" */
    put_u32(stream, scene->tri_count);
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        float v[3][3], normal[3];
        scene_tri(scene, i, v);
        make_normal(v, normal);
        put_float3(stream, normal);
        for (int c = 0; c < 3; c++)
            put_float3(stream, v[c]);
        fputc(0, stream);
        fputc(0, stream);
    }
    return STATUS_OK;
}
