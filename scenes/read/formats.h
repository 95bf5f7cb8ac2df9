/* The file formats: bytes to scenes and scenes to streams. One file each; scene_read and
 * scene_write (scenes.h) choose by the ending of the name. */
#ifndef FORMATS_H
#define FORMATS_H

#include "ref/scene/scene.h"

#include <stdio.h>

/* Readers. `bytes` is the whole file, unzipped, borrowed, bytes[size] is 0; `name` stands before
 * every reason. A scene that comes out has passed scene_check and has a triangle.
 * Errors: STATUS_INPUT "NAME:LINE: rule" (or "NAME: byte N: rule", "NAME: vertices[3].pos: rule");
 * STATUS_MEMORY. On error *out is zero. */

/* RTRS scene JSON (rtrs). All six keys are required, unknown keys ignored, duplicate keys refused.
 * A number is rounded to double and then to float, as RTRS's reader does: where its double lies
 * exactly between two floats that is not always the float nearest to the decimal; for what
 * write_rtrs writes it always is. A vertex index must exist; a material index too, or be 0 where
 * there is no material. */
enum status read_rtrs(const char *name, const char *bytes, size_t size, struct scene *out,
                      struct reason *reason) MUST_USE;

/* Wavefront OBJ: v, vt, vn, f; the positions alone are kept (scene.normal is NULL), one vertex per
 * v in file order. Corners are v, v/vt, v//vn or v/vt/vn; indices count from 1, or back from the
 * newest with -1, and what they name must stand above. Polygons become the fan from their first
 * corner (wrong for some non-convex ones), up to MESH_CORNERS_MOST corners. A v may have a weight
 * (ignored), a colour, or both. Other keywords are ignored with their line; a line that begins with
 * no keyword is refused. */
enum status read_obj(const char *name, const char *bytes, size_t size, struct scene *out,
                     struct reason *reason) MUST_USE;

/* PLY 1.0, ascii, binary_little_endian or binary_big_endian: x, y, z of element vertex and the list
 * vertex_indices or vertex_index of element face, of any integer types; every other element and
 * property is skipped. Polygons become fans as in read_obj. The counts of the header are checked
 * against the size of the file before anything is allocated; data after the last element are
 * refused, blanks apart; in ascii an element is a line. */
enum status read_ply(const char *name, const char *bytes, size_t size, struct scene *out,
                     struct reason *reason) MUST_USE;

/* STL, binary or ASCII; the positions alone are kept. A file whose size is that of a binary one of
 * its count is binary, whatever its header begins with; else one that begins with "solid" is ASCII,
 * of one or more solids. Corners whose positions are equal bit for bit become one vertex, numbered
 * as they come first, so that triangles are connected as those of other formats are. Normals and
 * attributes are ignored. */
enum status read_stl(const char *name, const char *bytes, size_t size, struct scene *out,
                     struct reason *reason) MUST_USE;

/* Writers. They write what fits the format and do not look for errors of the stream: the caller
 * does (file_out_commit). The scene has passed scene_check.
 * Errors: STATUS_INPUT what the format cannot hold; STATUS_MEMORY. */

/* RTRS's default material, a semi-matt red. */
extern const struct material rtrs_red;

/* RTRS scene JSON, byte for byte as RTRS writes it. What the scene lacks is made: normals by
 * scene_normals, the camera by scene_camera, RTRS's red material. Numbers other than the
 * positions must be finite too: STATUS_INPUT. */
enum status write_rtrs(const struct scene *scene, FILE *stream, struct reason *reason) MUST_USE;

/* Wavefront OBJ: positions and triangles, in order. */
enum status write_obj(const struct scene *scene, FILE *stream, struct reason *reason) MUST_USE;

/* PLY, binary_little_endian: float x, y, z; uchar uint vertex_indices. */
enum status write_ply(const struct scene *scene, FILE *stream, struct reason *reason) MUST_USE;

/* STL, binary: a unit normal for each triangle, 0 0 0 where it has no area. */
enum status write_stl(const struct scene *scene, FILE *stream, struct reason *reason) MUST_USE;

#endif
