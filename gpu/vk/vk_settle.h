/* Branches of a shader's module that its specialization constants decide. Drivers decide them, too,
 * but some only after they inlined and simplified what is never run. */
#ifndef VK_SETTLE_H
#define VK_SETTLE_H

#include "ref/base/base.h"

/* Makes *out a copy of the module, with as many words: where a condition follows from
 * specialization constants alone, the branch goes to the one block, and OpNop stands for the rest
 * of both instructions. Constant i is value[i]; those from `values` on are as in the module. No
 * block is removed: those that are left are not reached. The caller frees *out, which is NULL
 * where the words are no module, which drivers have to tell. Error: STATUS_MEMORY, *out is NULL. */
enum status vk_settle(const uint32_t *word, uint32_t count, const uint32_t *value, uint32_t values,
                      uint32_t **out) MUST_USE;

#endif
