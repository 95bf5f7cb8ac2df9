/* Other ways in which a module reads its inputs: modules that differ from the built ones in nothing
 * else, so that answers must have the same bits. */
#ifndef SPIRV_MEMORY_H
#define SPIRV_MEMORY_H

#include "ref/base/base.h"

/* Makes a module that reads its storage buffers of these bindings (bit 1 << binding) as uniform
 * texel buffers: of unsigned words where it reads words (bits of *words), else of quads of them.
 * The caller frees *out. Errors: STATUS_INPUT it is no module; STATUS_UNSUPPORTED it does more with
 * such a buffer than read it, or reads one both as words and as quads; STATUS_MEMORY. */
enum status spirv_texels(const uint32_t *word, size_t count, uint32_t bindings, uint32_t **out,
                         size_t *out_count, uint32_t *words, struct reason *reason) MUST_USE;

/* The same by addresses: each such binding becomes a buffer of 8 bytes, the address of what the
 * module reads (SPV_KHR_physical_storage_buffer). The caller frees *out. Errors: as spirv_texels,
 * but for words and quads. */
enum status spirv_references(const uint32_t *word, size_t count, uint32_t bindings, uint32_t **out,
                             size_t *out_count, struct reason *reason) MUST_USE;

#endif
