/* The finding as an Amber script (google/amber, docs/amber_script.md). A script can only expect
 * numbers to be equal, unequal, less or greater; so of a ray with several right answers it expects
 * what all of them have in common. */
#include "fuzz/export/export_inner.h"

#include <string.h>

/* --- the shader and the buffers --- */

/* Amber reads single bytes, and reads for ever if anything but END follows the last one, a newline
 * included (google/amber issue 931). */
static void put_shader(const struct shader *shader, FILE *to)
{
    fputs("SHADER compute trace SPIRV-HEX TARGET_ENV vulkan1.1\n", to);
    for (uint32_t i = 0; i < shader->word_count; i++) {
        uint32_t word = shader->word[i];
        if (i)
            fputs(i % 4 ? " " : "\n", to);
        fprintf(to, "0x%02x 0x%02x 0x%02x 0x%02x", (word & 0xFFu), (word >> 8 & 0xFFu),
                (word >> 16 & 0xFFu), (word >> 24));
    }
    fputs("END\n\n", to);
}

/* A buffer of words that begins with these, the rest 0. */
static void put_buffer(const char *name, const uint32_t *word, uint64_t count, uint64_t bytes,
                       FILE *to)
{
    if (!count) {
        fprintf(to, "BUFFER %s DATA_TYPE uint32 SIZE %llu FILL 0\n\n", name,
                (unsigned long long)(bytes / 4));
        return;
    }
    fprintf(to, "BUFFER %s DATA_TYPE uint32 DATA\n", name);
    for (uint64_t i = 0; i < bytes / 4; i++)
        fprintf(to, "0x%08x%c", (i < count ? word[i] : 0),
                i % 8 == 7 || i + 1 == bytes / 4 ? '\n' : ' ');
    fputs("END\n\n", to);
}

static void put_triangles(const struct export_case *the, const struct export_buffer *buffer,
                          FILE *to)
{
    const struct scene *scene = &the->trial->scene;
    uint64_t words = buffer->bytes / 4, used = 0;
    if (!scene->tri_count) {
        put_buffer(buffer->name, NULL, 0, buffer->bytes, to);
        return;
    }
    fprintf(to, "# Nine floats a triangle, as bits.\nBUFFER %s DATA_TYPE uint32 DATA\n",
            buffer->name);
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        float v[3][3];
        scene_tri(scene, i, v);
        for (int k = 0; k < 9; k++, used++)
            fprintf(to, "0x%08x ", float_bits(v[k / 3][k % 3]));
        fprintf(to, "# triangle %u:", i);
        for (int k = 0; k < 9; k++)
            fprintf(to, " %.9g", (double)v[k / 3][k % 3]);
        fputc('\n', to);
    }
    for (; used < words; used++)
        fputs("0 # padding\n", to);
    fputs("END\n\n", to);
}

static void put_buffers(const struct export_case *the, FILE *to)
{
    struct export_buffer buffer[DISPATCH_BINDINGS];
    export_buffers(the, buffer);
    for (uint32_t i = 0; i < DISPATCH_BINDINGS; i++) {
        const uint64_t count = buffer[i].data_bytes / 4;
        if (i == ABI_BIND_RAYS)
            fputs("# Origin, tmin, direction and tmax of each ray, as bits.\n", to);
        if (i == ABI_BIND_TRIS)
            put_triangles(the, &buffer[i], to);
        else if (i == ABI_BIND_RAYS)
            put_buffer(buffer[i].name, (const void *)the->ray, count, buffer[i].bytes, to);
        else if (i == ABI_BIND_NODES)
            put_buffer(buffer[i].name, the->packed.word, count, buffer[i].bytes, to);
        else
            put_buffer(buffer[i].name, the->packed.item, count, buffer[i].bytes, to);
    }
    fputs("# Rays, root, records, words of items, triangles, hits of a ray.\n", to);
    put_buffer("push", (const void *)&the->dispatch.push, sizeof(struct push) / 4,
               sizeof(struct push), to);
}

static void put_pipeline(const struct export_case *the, FILE *to)
{
    struct export_buffer buffer[DISPATCH_BINDINGS];
    export_buffers(the, buffer);
    fputs("PIPELINE compute pipeline\n  ATTACH trace", to);
    for (uint32_t i = 0; i < DISPATCH_CONSTANTS; i++)
        fprintf(to, " SPECIALIZE %u AS uint32 %u", i, the->dispatch.constant[i]);
    fputc('\n', to);
    for (uint32_t i = 0; i < DISPATCH_BINDINGS; i++)
        fprintf(to, "  BIND BUFFER %s AS storage DESCRIPTOR_SET 0 BINDING %u\n", buffer[i].name, i);
    fprintf(to, "  BIND BUFFER push AS push_constant\nEND\n\nRUN pipeline %u 1 1\n\n",
            dispatch_groups(&the->dispatch, the->ray_count));
}

/* --- what is expected --- */

/* What all right answers to a ray have in common. */
struct common {
    size_t count;
    bool miss, hit; /* some are */
    bool one_prim;  /* all hits name this triangle */
    uint32_t prim;
    float t[2], u[2], v[2];
};

static void join(float out[2], const float interval[2], bool first)
{
    if (first || interval[0] < out[0])
        out[0] = interval[0];
    if (first || interval[1] > out[1])
        out[1] = interval[1];
}

static struct common in_common(const struct export_case *the, uint32_t ray)
{
    struct common c = {.one_prim = true};
    for (size_t i = 0; i < the->right_count; i++) {
        const struct export_right *right = &the->right[i];
        if (right->ray != ray)
            continue;
        c.count++;
        if (right->prim == ABI_NO_PRIM) {
            c.miss = true;
            continue;
        }
        join(c.t, right->t, !c.hit);
        join(c.u, right->u, !c.hit);
        join(c.v, right->v, !c.hit);
        c.one_prim = c.one_prim && (!c.hit || c.prim == right->prim);
        c.prim = right->prim;
        c.hit = true;
    }
    return c;
}

/* Positive floats are ordered as their bits are; -0 is 0, too, and has another place. */
static void put_interval(const char *name, const float x[2], unsigned offset, FILE *to)
{
    if (!(x[0] > 0.0f)) {
        fprintf(to, "# %s in [%.9g, %.9g] cannot be tested on bits\n", name, (double)x[0],
                (double)x[1]);
        return;
    }
    fprintf(to, "EXPECT hits IDX %u GE %u # %s >= %.9g\n", offset, float_bits(x[0]), name,
            (double)x[0]);
    fprintf(to, "EXPECT hits IDX %u LE %u # %s <= %.9g\n", offset, float_bits(x[1]), name,
            (double)x[1]);
}

static void put_bits(const struct hit *hit, unsigned offset, FILE *to)
{
    fprintf(to, "EXPECT hits IDX %u EQ %u %u %u %u # the bits of C\n", offset, float_bits(hit->t),
            float_bits(hit->u), float_bits(hit->v), hit->prim);
}

static void expect_ray(const struct export_case *the, uint32_t i, FILE *to)
{
    const unsigned offset = (unsigned)(i * sizeof(struct hit)), prim = offset + 12;
    struct common c = in_common(the, i);
    for (size_t k = 0; k < the->right_count; k++)
        if (the->right[k].ray == i)
            export_print_right(the, &the->right[k], to);
    fprintf(to, "EXPECT flags IDX %u EQ %u # ray %u was finished\n", (4 * i), ABI_FLAG_DONE, i);
    if (the->bits_matter)
        put_bits(&the->reference[i], offset, to);
    else if (c.count == 0)
        fprintf(to, "# ray %u is out of contract: any answer is right\n", i);
    else if (c.miss && c.hit)
        fprintf(to, "# ray %u: a hit or a miss, which a script cannot express\n", i);
    else if (c.miss)
        fprintf(to, "EXPECT hits IDX %u EQ 0 0 0 %u # a miss\n", offset, ABI_NO_PRIM);
    else {
        if (c.one_prim)
            fprintf(to, "EXPECT hits IDX %u EQ %u # the triangle\n", prim, c.prim);
        else
            fprintf(to, "EXPECT hits IDX %u NE %u # no miss\n", prim, ABI_NO_PRIM);
        put_interval("t", c.t, offset, to);
        put_interval("u", c.u, offset + 4, to);
        put_interval("v", c.v, offset + 8, to);
    }
}

void export_write_amber(const struct export_case *the, FILE *to)
{
    fputs("#!amber\n#\n", to);
    export_comment(the, "# ", to);
    fputs("\n# A tree that was packed wrongly may make the shader read beyond its buffers.\n"
          "DEVICE_FEATURE robustBufferAccess\n\n",
          to);
    put_shader(the->dispatch.shader, to);
    put_buffers(the, to);
    put_pipeline(the, to);
    for (uint32_t i = 0; i < the->ray_count; i++)
        expect_ray(the, i, to);
}
