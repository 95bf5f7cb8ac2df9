/* Texts that are read line by line, of every format, and what is read of them, printed. Include
 * after cmocka.h. */
#ifndef TESTS_LAWS_TEXT_SAMPLES_H
#define TESTS_LAWS_TEXT_SAMPLES_H

#include "fuzz/findings/finding_file.h"
#include "ref/dump/tree_dump.h"
#include "ref/outside/pipe_text.h"
#include "scenes/read/formats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEXT_MOST 4096

/* All that was read, printed into `stream`. */
typedef enum status reads_fn(const char *bytes, size_t size, FILE *stream, struct reason *reason);

static inline void print_words(FILE *stream, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        fprintf(stream, "%02x", ((const unsigned char *)bytes)[i]);
    putc('\n', stream);
}

static inline void print_scene(FILE *stream, const struct scene *scene)
{
    print_words(stream, scene->vertex, 12 * (size_t)scene->vertex_count);
    print_words(stream, scene->index, 12 * (size_t)scene->tri_count);
}

static inline enum status print_mesh(enum status status, struct scene *scene, FILE *stream)
{
    if (!status) {
        print_scene(stream, scene);
        scene_free(scene);
    }
    return status;
}

static inline enum status reads_obj(const char *bytes, size_t size, FILE *stream,
                                    struct reason *reason)
{
    struct scene scene;
    return print_mesh(read_obj("f", bytes, size, &scene, reason), &scene, stream);
}

static inline enum status reads_ply(const char *bytes, size_t size, FILE *stream,
                                    struct reason *reason)
{
    struct scene scene;
    return print_mesh(read_ply("f", bytes, size, &scene, reason), &scene, stream);
}

static inline enum status reads_stl(const char *bytes, size_t size, FILE *stream,
                                    struct reason *reason)
{
    struct scene scene;
    return print_mesh(read_stl("f", bytes, size, &scene, reason), &scene, stream);
}

static inline enum status reads_dump(const char *bytes, size_t size, FILE *stream,
                                     struct reason *reason)
{
    struct tree_dump dump;
    const enum status status = tree_dump_read("f", bytes, size, DUMP_RAYDIFF, &dump, reason);
    if (!status)
        tree_dump_write(&dump, stream);
    tree_dump_free(&dump);
    return status;
}

static inline enum status reads_finding(const char *bytes, size_t size, FILE *stream,
                                        struct reason *reason)
{
    struct finding_file file;
    char *text;
    size_t text_size;
    enum status status = finding_file_parse("f", bytes, size, &file, reason);
    if (status)
        return status;
    assert_int_equal(finding_file_print(&file, &text, &text_size, reason), STATUS_OK);
    fwrite(text, 1, text_size, stream);
    free(text);
    finding_file_free(&file);
    return STATUS_OK;
}

static inline enum status reads_pipe(const char *bytes, size_t size, FILE *stream,
                                     struct reason *reason)
{
    struct pipe_text text;
    const struct pipe_limits limits = pipe_limits_none();
    const enum status status = pipe_text_parse("f", bytes, size, &limits, &text, reason);
    if (status)
        return status;
    const struct pipe_from *from = &text.from;
    fprintf(stream, "%u %d %u %u %u '%s' %llx %llu %llu '%s' '%s' '%s' filter %d %u %u\n",
            text.version, (int)text.query, text.formula, text.rounding, text.flags, text.refused,
            (unsigned long long)from->hash, (unsigned long long)from->seed,
            (unsigned long long)from->count, from->rays, from->modes, from->spec,
            (int)text.world.filter.kind, text.world.filter.seed, text.world.filter.share);
    print_scene(stream, &text.scene);
    print_words(stream, text.ray, text.ray_count * sizeof *text.ray);
    print_words(stream, text.mode, text.mode ? text.ray_count * sizeof *text.mode : 0);
    print_words(stream, text.hit, text.hit_count * sizeof *text.hit);
    for (uint32_t m = 0; m < text.world.mesh_count; m++) {
        print_scene(stream, text.world.mesh[m].scene);
        for (uint32_t g = 0; g < text.world.mesh[m].geometry_count; g++)
            fprintf(stream, "%u %d\n", text.world.mesh[m].geometry[g].count,
                    text.world.mesh[m].geometry[g].opaque);
    }
    for (uint32_t i = 0; i < text.world.instance_count; i++) {
        const struct instance *one = &text.world.instance[i];
        fprintf(stream, "%u %u %u %u\n", one->mesh, one->custom, one->mask, one->flags);
        print_words(stream, one->m, sizeof one->m);
    }
    pipe_text_free(&text);
    return STATUS_OK;
}

/* --- what is read ----------------------------------------------------------------------------- */

/* Lines with '|' in front have a text that is the rest of the line: blanks in it are its own. */
static const struct sample {
    const char *what;
    reads_fn *reads;
    const char *text;
    bool comments, empty_lines;
} samples[] = {
    {"OBJ", reads_obj,
     "v 0 0 0\nv 1 0 .5\nv 0 1 -2e-1\nvt 0 1\nvn 0 0 1\nf 1 2 3\nf 1/1 2/1 3/1\nf -1//1 -2//1 "
     "-3//1\n",
     true, true},
    {"PLY", reads_ply,
     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
     "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
     "0 0 0\n1 0 .5\n0 1 -2e-1\n3 0 1 2\n3 2 1 0\n",
     false, false},
    {"STL", reads_stl,
     "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 .5\nvertex 0 1 -2e-1\n"
     "endloop\nendfacet\nendsolid one\n",
     false, true},
    {"tree with vertices", reads_dump,
     "raydiff tree 1\nvertex 0 0 0\nvertex 1 0 .5\nvertex 0 1 -2e-1\ntriangle 0 1 2\n"
     "triangle 2 1 0\nsplits\nbytes 96\nnode 0 0 0 1 1 1 1 2\nleaf 0 0 0 1 1 inf 0 1\n"
     "leaf nan 0 0 1 1 1 1\nend\n",
     true, true},
    {"tree of a scene", reads_dump, "raydiff tree 1\n|scene a mesh.obj\nleaf 0 0 0 1 1 1 0\nend\n",
     true, true},
    {"answers", reads_pipe,
     "raydiff 1\nformula woop vulkan_rte\nflags unnamed open\nh 0x1.8p+1 .25 -2.5e-1 7\nm\n"
     "h nan inf -inf 0\nend\n",
     true, true},
    {"answers of a known formula", reads_pipe, "raydiff 1\nformula mt\nflags open\nm\nend\n", true,
     true},
    {"refused", reads_pipe, "raydiff 1\n|refused too many triangles\n", true, true},
    {"rays", reads_pipe,
     "raydiff 1\n|from 0123456789abcdef 1 2 mixed a mesh.obj\nquery any\nv 0 0 0x1p-3\nv 1 0 0\n"
     "v 0 1e-3 0\nt 0 1 2\nr 0 0 -1 0 0 0 1 inf\nr 0 0 -1 0 0 0 1 9\nend\n",
     true, true},
    {"rays of a world", reads_pipe,
     "raydiff 2\n|from 0123456789abcdef 1 2 mixed modes=mixed a world.json\nquery any\n"
     "filter cells 3 128\nmesh\nv 0 0 0x1p-3\nv 1 0 0\nv 0 1e-3 0\nt 0 1 2\nt 2 1 0\n"
     "g 1 opaque\ng 1 filtered\ni 0 7 255 1 1 0 0 5 0 1 0 6 0 0 1 .5\n"
     "i - 7 255 0 1 0 0 5 0 1 0 6 0 0 1 .5\nr 0 0 -1 0 0 0 1 inf 255 16\nend\n",
     true, true},
    {"answers of a world", reads_pipe,
     "raydiff 2\nformula mt embree\nh 1 .5 .25 0 0 1 front 7\nh 1 .5 .25 0 0 1 back\nm\n", true,
     true},
    {"finding", reads_finding,
     "raydiff trial 1\nexpect cpu.rtrs_rf.missed.rounded_inward\n"
     "origin seed 7 index 12 version 1 stream gen\n|recipe soup of 32\n|with raydiff 0.1.0\n"
     "builder median leaf 4 eps 0x1.47ae14p-6\nbox robust\ntri mt\nquery closest\nstore compact\n"
     "optimize 4\npresplit 0x1p-2\nvertices 3\n0 0 0\n0x1p+0 0 .5\n0 1 -2e-1\ntriangles 1\n0 1 2\n"
     "rays 2\n0x1p-2 0 -1 0 0 1 0 inf\n0x1p-2 0 -1 0 0 1 nan:0x7fc00000 9\nend\n",
     true, true},
    {"finding that moves", reads_finding,
     "raydiff trial 1\nexpect clean\nbuilder median leaf 4 eps 0x1.47ae14p-6\nbox robust\ntri mt\n"
     "query any\nrotate 4\nmove 0x1p-3 seed 7\nvertices 3\n0 0 0\n1 0 0\n0 1 0\ntriangles 1\n"
     "0 1 2\nrays 1\n0 0 -1 0 0 1 0 9\nend\n",
     true, true},
    {"finding of a world", reads_finding,
     "raydiff trial 2\nexpect clean\nfilter triangles seed 7 share 128\n"
     "builder median leaf 4 eps 0x1.47ae14p-6\nbox robust\ntri mt\nquery closest\nvertices 3\n"
     "0 0 0\n1 0 0\n0 1 0\ntriangles 1\n0 1 2\ngeometries 2\nmesh 0 triangles 1 opaque\n"
     "mesh 1 triangles 0 filtered\ninstances 2\n0 0 255 0 1 0 0 5 0 1 0 6 0 0 1 .5\n"
     "- 3 1 2 1 0 0 5 0 1 0 6 0 0 1 .5\nrays 1\n0 0 -1 0 0 1 0 inf 255 0\nend\n",
     true, true},
};

#endif
