/* A glTF file by hand: two meshes, strips and fans, nodes in nodes, indices of all sizes, and a
 * buffer in the file. */
#ifndef TESTS_GLTF_FIXTURE_H
#define TESTS_GLTF_FIXTURE_H

#include "scenes/gltf/gltf.h"
#include "tests/worlds/files_fixture.h"

/* Vertices 16 bytes apart, indices of 1, 2 and 4 bytes, three more vertices without a gap. */
#define GLTF_BYTES 132
static const float near_by[4][4] = {
    {0, 0, 0, -1e30f}, {1, 0, 0, -1e30f}, {1, 1, 0, -1e30f}, {0, 1, 0.5f, -1e30f}};
static const float far_off[3][3] = {{5, 5, 5}, {6, 5, 5}, {5, 6, 5}};

static inline void fill_bytes(unsigned char bytes[GLTF_BYTES])
{
    static const unsigned char small[] = {0, 1, 2, 0, 2, 3, 99, 99};
    static const uint16_t middle[] = {0, 1, 2, 3};
    static const uint32_t large[] = {3, 2, 1, 0};
    memcpy(bytes, near_by, sizeof near_by);
    memcpy(bytes + 64, small, sizeof small);
    memcpy(bytes + 72, middle, sizeof middle);
    memcpy(bytes + 80, large, sizeof large);
    memcpy(bytes + 96, far_off, sizeof far_off);
}

#define GLTF_URI "data:application/octet-stream;base64,"

static const char gltf_json[] =
    "{\"asset\": {\"version\": \"2.0\"}, \"extensionsUsed\": [\"KHR_materials_unlit\"],\n"
    " \"scene\": 1, \"scenes\": [{\"nodes\": [3]}, {\"nodes\": [0], \"name\": \"main\"}],\n"
    " \"nodes\": [\n"
    "  {\"children\": [1, 2], \"translation\": [10, 20, 30], \"scale\": [2, 1, 1]},\n"
    "  {\"mesh\": 0, \"matrix\": [2, 0, 1, 0,  0, 3, 0, 0,  0, -1, 4, 0,  5, 6, 7, 1]},\n"
    "  {\"mesh\": 1, \"rotation\": [0, 0, 0.705, 0.705], \"scale\": [2, 3, 4],\n"
    "   \"extras\": {\"raydiff\": {\"custom\": 70000, \"mask\": 3}, \"other\": 1}},\n"
    "  {\"mesh\": 0, \"extras\": 7}],\n"
    " \"meshes\": [{\"primitives\": [\n"
    "   {\"attributes\": {\"POSITION\": 0, \"NORMAL\": 99}, \"indices\": 1, \"mode\": 4},\n"
    "   {\"attributes\": {\"POSITION\": 0}, \"indices\": 2, \"mode\": 5, \"material\": 0},\n"
    "   {\"attributes\": {\"POSITION\": 0}, \"indices\": 3, \"mode\": 6, \"material\": 1},\n"
    "   {\"attributes\": {\"POSITION\": 77}, \"mode\": 0},\n"
    "   {\"attributes\": {}, \"mode\": 3}]},\n"
    "  {\"primitives\": [{\"attributes\": {\"POSITION\": 4}, \"material\": 1},\n"
    "   {\"attributes\": {\"POSITION\": 0}, \"indices\": 1, \"material\": 2}]}],\n"
    " \"materials\": [{\"alphaMode\": \"MASK\"}, {\"alphaMode\": \"BLEND\", \"doubleSided\": "
    "true},\n"
    "  {\"alphaMode\": \"OPAQUE\", \"doubleSided\": true}],\n"
    " \"accessors\": [\n"
    "  {\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\"},\n"
    "  {\"bufferView\": 1, \"componentType\": 5121, \"count\": 6, \"type\": \"SCALAR\"},\n"
    "  {\"bufferView\": 2, \"componentType\": 5123, \"count\": 4, \"type\": \"SCALAR\"},\n"
    "  {\"bufferView\": 2, \"byteOffset\": 8, \"componentType\": 5125, \"count\": 4,\n"
    "   \"type\": \"SCALAR\"},\n"
    "  {\"bufferView\": 3, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}],\n"
    " \"bufferViews\": [\n"
    "  {\"buffer\": 0, \"byteLength\": 64, \"byteStride\": 16},\n"
    "  {\"buffer\": 0, \"byteOffset\": 64, \"byteLength\": 6},\n"
    "  {\"buffer\": 0, \"byteOffset\": 72, \"byteLength\": 24},\n"
    "  {\"buffer\": 0, \"byteOffset\": 96, \"byteLength\": 36}],\n"
    " \"buffers\": [{\"byteLength\": 132, \"uri\": \"" GLTF_URI "@\"}]}\n";

/* The file with its buffer; the caller frees it. */
static inline char *gltf_text(void)
{
    unsigned char bytes[GLTF_BYTES];
    char *base64 = NULL;
    size_t size;
    FILE *stream = open_memstream(&base64, &size);
    assert_non_null(stream);
    fill_bytes(bytes);
    base64_encode(bytes, sizeof bytes, stream);
    assert_int_equal(fclose(stream), 0);
    char *text = changed(gltf_json, "@", base64);
    free(base64);
    return text;
}

static struct world_notes fixture_notes;

static inline enum status read_gltf_bytes(const char *bytes, size_t size, struct world *out)
{
    return read_gltf("w.gltf", bytes, size, &fixture_files, out, &fixture_notes, &reason);
}

static inline enum status read_gltf_text(const char *text, struct world *out)
{
    return read_copy(read_gltf_bytes, text, strlen(text), "w.gltf", out);
}

/* The file with the first `old` replaced by `new`, and read. */
static inline enum status read_gltf_changed(const char *old, const char *new, struct world *out)
{
    char *whole = gltf_text(), *text = changed(whole, old, new);
    enum status status = read_gltf_text(text, out);
    free(text);
    free(whole);
    return status;
}

/* A GLB file of some JSON and a chunk; the caller frees it. */
static inline char *glb_bytes(const char *json, const void *chunk, size_t chunk_size, size_t *size)
{
    size_t length = (strlen(json) + 3) / 4 * 4;
    const uint32_t head[] = {0x46546C67, 2, (uint32_t)(28 + length + chunk_size), (uint32_t)length,
                             0x4E4F534A};
    const uint32_t next[] = {(uint32_t)chunk_size, 0x004E4942};
    char *bytes = malloc(28 + length + chunk_size + 1);
    assert_non_null(bytes);
    memcpy(bytes, head, sizeof head);
    memset(bytes + 20, ' ', length);
    memcpy(bytes + 20, json, strlen(json));
    memcpy(bytes + 20 + length, next, sizeof next);
    memcpy(bytes + 28 + length, chunk, chunk_size);
    *size = 28 + length + chunk_size;
    bytes[*size] = '\0';
    return bytes;
}

/* The file of the fixture as GLB; the caller frees it. */
static inline char *gltf_glb(size_t *size)
{
    unsigned char chunk[GLTF_BYTES];
    fill_bytes(chunk);
    char *json = changed(gltf_json, ", \"uri\": \"" GLTF_URI "@\"", "");
    char *bytes = glb_bytes(json, chunk, sizeof chunk, size);
    free(json);
    return bytes;
}

#endif
