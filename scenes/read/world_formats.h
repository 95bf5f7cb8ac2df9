/* The file formats of worlds: bytes to worlds and worlds to streams. world_open and world_write
 * (scenes/worlds.h) choose by the ending of the name. */
#ifndef WORLD_FORMATS_H
#define WORLD_FORMATS_H

#include "ref/world/world.h"

#include <stdio.h>

/* How a reader gets what its file refers to; what `user` is for is the caller's. */
struct world_files {
    /* Opens the scene of a mesh that is named by a file or generator text. Errors: STATUS_INPUT a
     * line; STATUS_MEMORY. */
    enum status (*scene)(void *user, const char *spec, struct scene *out, struct reason *reason);
    /* Reads a file beside it, by a relative path. bytes[size] is 0; the caller frees *bytes.
     * Errors: as of `scene`. */
    enum status (*bytes)(void *user, const char *path, char **bytes, size_t *size,
                         struct reason *reason);
    void *user;
};

/* What a reader left out, since a world has no place for it. */
struct world_notes {
    uint32_t points_and_lines; /* primitives of such modes */
    uint32_t skins, morphs;    /* nodes with a skin, primitives with morph targets: at rest */
};

/* Meshes whose triangles come from elsewhere may have so many of them in all. */
#define WORLD_REFERRED_MOST (1u << 26)

/* Readers. `bytes` is the whole file, unzipped, borrowed, bytes[size] is 0; `name` stands before
 * every reason. A world that comes out has passed world_finish; it may be empty.
 * Errors: STATUS_INPUT "NAME: PLACE: rule" (or "NAME:LINE:COLUMN: rule", "NAME: byte N: rule");
 * STATUS_MEMORY. On error *out is zero. */

/* World JSON: an object with
 *   "raydiff_world"  1, the version
 *   "meshes"         an array of objects: either "scene", a file or generator text, or "vertices",
 *                    3 numbers each, and "indices", 3 for each triangle; and "geometries", an array
 *                    of {"count": triangles, "opaque": true or false}, which cover the triangles in
 *                    order: without it the mesh is one opaque geometry
 *   "instances"      an array of objects: "mesh", an index or null; "transform", 12 numbers, M and
 *                    T row by row, without it the identity; the members of world_fields.h
 *   "filter"         see world_fields.h; without it every candidate passes
 * The float is the one nearest to the decimal. An unknown member is refused. */
enum status read_world(const char *name, const char *bytes, size_t size,
                       const struct world_files *files, struct world *out,
                       struct reason *reason) MUST_USE;

/* glTF 2.0, as JSON or, if it begins with "glTF", as GLB.
 *
 * Instances are the nodes with a mesh of the default scene (the first, if none is named; all nodes,
 * if there is no scene), in the order of the nodes. Matrices are multiplied in double, from the
 * node up to its root, and rounded to float32 once; a rotation is that of the quaternion divided by
 * its length. A node may have extras.raydiff with the members of an instance (world_fields.h); it
 * is then an instance even without a mesh. The file may have extras.raydiff with a "filter".
 *
 * A mesh has one geometry for each of its primitives of triangles, strips or fans, in order;
 * primitives of points and lines are left out, and a mesh of nothing else has one empty geometry. A
 * geometry is opaque unless its material has alphaMode MASK or BLEND. If all of a mesh's primitives
 * are double-sided, its instances have ABI_INSTANCE_CULL_DISABLE, unless their extras have flags.
 * Skins and morph targets are left out, and so is what else a world does not have.
 *
 * Refused are: a required extension; positions that are not VEC3 of FLOAT, or not finite; sparse
 * accessors and those without a buffer view, if used; nodes that are their own ancestors, have two
 * parents or lie deeper than GLTF_DEEP; singular matrices; a matrix and a translation, rotation or
 * scale in one node; indices that end a strip; meshes that take more than GLTF_TIMES bytes for each
 * one of the file and its buffers. Only buffers that are used are read: those with a data: URI, the
 * chunk of a GLB file, and files beside it or in a folder below. */
#define GLTF_DEEP  256u
#define GLTF_TIMES 16u
enum status read_gltf(const char *name, const char *bytes, size_t size,
                      const struct world_files *files, struct world *out, struct world_notes *notes,
                      struct reason *reason) MUST_USE;

/* True if the text is an object with a member "raydiff_world". What it is else is not checked. */
bool is_world(const char *bytes, size_t size);

/* Writers. They write what fits the format and do not look for errors of the stream: the caller
 * does (file_out_commit). The world has passed world_finish.
 * Errors: STATUS_INPUT what the format cannot hold; STATUS_MEMORY. */

/* World JSON; every mesh stands in the file. Reading gives the same world, bit for bit, apart from
 * what scenes have beside vertices and triangles. */
enum status write_world(const struct world *world, FILE *stream, struct reason *reason) MUST_USE;

/* glTF 2.0, with one buffer: as JSON, in a data: URI; as GLB, in its chunk. Each instance is a node
 * with its matrix, each geometry a primitive of 32-bit indices; what is not opaque has a material
 * of alphaMode MASK. The rest stands in extras.raydiff, so that reading gives the same world, bit
 * for bit, as of write_world. A matrix that shears is no product of translation, rotation and
 * scale, as glTF demands; other programs may refuse it.
 * Errors: STATUS_INPUT a mesh without vertices, or a geometry without triangles; more than 2^32 - 1
 * bytes in GLB. STATUS_MEMORY. */
enum status write_gltf(const struct world *world, FILE *stream, struct reason *reason) MUST_USE;
enum status write_glb(const struct world *world, FILE *stream, struct reason *reason) MUST_USE;

#endif
