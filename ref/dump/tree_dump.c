#include "ref/dump/dump_inner.h"

#include "ref/base/float_word.h"

#include <stdlib.h>
#include <string.h>

const char *const dump_formats[DUMP_FORMATS + 1] = {"raydiff",  "tinybvh", "bvh2",
                                                    "lavapipe", "radv",    NULL};

#define NUMBERS_MOST ((size_t)UINT32_MAX - 1)

enum status dump_add_node(struct dump_making *making, bool leaf, const struct box *box)
{
    struct tree_dump *dump = &making->dump;
    if (dump->node_count >= NUMBERS_MOST)
        return STATUS_LIMIT;
    enum status status = array_reserve(&dump->node, &making->node_capacity, dump->node_count + 1,
                                       sizeof *dump->node);
    if (!status)
        dump->node[dump->node_count++] = (struct dump_node){
            .box = *box,
            .first = (uint32_t)(leaf ? dump->item_count : dump->child_count),
            .leaf = leaf,
        };
    return status;
}

enum status dump_add_link(struct dump_making *making, uint32_t number)
{
    struct tree_dump *dump = &making->dump;
    struct dump_node *node = &dump->node[dump->node_count - 1];
    size_t *count = node->leaf ? &dump->item_count : &dump->child_count;
    if (*count >= NUMBERS_MOST)
        return STATUS_LIMIT;
    enum status status =
        node->leaf
            ? array_reserve(&dump->item, &making->item_capacity, *count + 1, sizeof *dump->item)
            : array_reserve(&dump->child, &making->child_capacity, *count + 1, sizeof *dump->child);
    if (status)
        return status;
    (node->leaf ? dump->item : dump->child)[(*count)++] = number;
    node->count++;
    return STATUS_OK;
}

static unsigned guess(const char *bytes, size_t size)
{
    if (size >= strlen(DUMP_MAGIC) && memcmp(bytes, DUMP_MAGIC, strlen(DUMP_MAGIC)) == 0)
        return DUMP_RAYDIFF;
    if (dump_is_bvh2(bytes, size))
        return DUMP_BVH2;
    if (dump_is_tinybvh(bytes, size))
        return DUMP_TINYBVH;
    if (dump_is_radv(bytes, size))
        return DUMP_RADV;
    return dump_is_serialised(bytes, size) ? DUMP_LAVAPIPE : DUMP_GUESSED;
}

enum status tree_dump_read(const char *name, const char *bytes, size_t size, unsigned format,
                           struct tree_dump *out, struct reason *reason)
{
    static enum status (*const read[DUMP_FORMATS])(const char *, const char *, size_t,
                                                   struct tree_dump *, struct reason *) = {
        [DUMP_RAYDIFF] = dump_read_text,
        [DUMP_TINYBVH] = dump_read_tinybvh,
        [DUMP_BVH2] = dump_read_bvh2,
        [DUMP_LAVAPIPE] = dump_read_lavapipe,
        [DUMP_RADV] = dump_read_radv};
    *out = (struct tree_dump){0};
    if (format == DUMP_GUESSED && (format = guess(bytes, size)) == DUMP_GUESSED)
        return fail(reason, STATUS_INPUT,
                    "%s: no tree of a known format: it begins neither with '" DUMP_MAGIC
                    "1' nor as a file of tinybvh or a serialised acceleration structure, and has "
                    "not the size that a file of bvh v2 has",
                    name);
    enum status status = read[format](name, bytes, size, out, reason);
    out->format = dump_formats[format];
    if (!status && out->node_count == 0)
        status = fail(reason, STATUS_INPUT, "%s: no node, so no root", name);
    if (status)
        tree_dump_free(out);
    return status;
}

static void put_floats(FILE *stream, const char *word, const float *x, size_t count)
{
    char text[FLOAT_WORD_MOST];
    fputs(word, stream);
    for (size_t i = 0; i < count; i++) {
        (void)float_word_write(x[i], text);
        fprintf(stream, " %s", text);
    }
}

void tree_dump_write(const struct tree_dump *dump, FILE *stream)
{
    fputs(DUMP_MAGIC "1\n", stream);
    if (dump->spec)
        fprintf(stream, "scene %s\n", dump->spec);
    for (size_t i = 0; dump->scene.tri_count && i < dump->scene.vertex_count; i++) {
        put_floats(stream, "vertex", dump->scene.vertex + 3 * i, 3);
        fputc('\n', stream);
    }
    for (size_t i = 0; i < dump->scene.tri_count; i++)
        fprintf(stream, "triangle %u %u %u\n", dump->scene.index[3 * i],
                dump->scene.index[3 * i + 1], dump->scene.index[3 * i + 2]);
    fputs(dump->splits ? "splits\n" : "", stream);
    if (dump->bytes)
        fprintf(stream, "bytes %llu\n", (unsigned long long)dump->bytes);
    for (size_t i = 0; i < dump->node_count; i++) {
        const struct dump_node *node = &dump->node[i];
        put_floats(stream, node->leaf ? "leaf" : "node", node->box.lo, 3);
        put_floats(stream, "", node->box.hi, 3);
        for (size_t k = node->first; k < (size_t)node->first + node->count; k++)
            fprintf(stream, " %u", (node->leaf ? dump->item : dump->child)[k]);
        fputc('\n', stream);
    }
    fputs("end\n", stream);
}

enum status tree_dump_make(const struct bvh *bvh, struct tree_dump *out)
{
    struct dump_making making = {.dump = {.format = dump_formats[DUMP_RAYDIFF],
                                          .splits = bvh_is_split(bvh),
                                          .tri_count = bvh->tri_count,
                                          .tri_known = true}};
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < bvh->node_count && !status; i++) {
        const struct bvh_node *node = &bvh->node[i];
        status = dump_add_node(&making, node->item_count > 0, &node->bounds);
        for (uint32_t k = 0; k < node->item_count && !status; k++)
            status = dump_add_link(&making, bvh->prim[node->item_first + k]);
        for (uint32_t k = 0; k < 2 && !node->item_count && !status; k++)
            status = dump_add_link(&making, k ? node->snd : node->fst);
    }
    if (status)
        tree_dump_free(&making.dump);
    *out = making.dump;
    return status;
}

void tree_dump_free(struct tree_dump *dump)
{
    free(dump->node);
    free(dump->child);
    free(dump->item);
    free(dump->spec);
    free(dump->instance);
    free(dump->source);
    for (size_t i = 0; i < dump->below_count; i++)
        tree_dump_free(&dump->below[i]);
    free(dump->below);
    scene_free(&dump->scene);
    *dump = (struct tree_dump){0};
}
