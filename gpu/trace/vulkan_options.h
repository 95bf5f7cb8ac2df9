/* Options shared by the Vulkan engines. Environment: RAYDIFF_VALIDATE=1 runs under the validation
 * layer and fails on its messages; RAYDIFF_VALIDATE=gpu also checks every memory access of a
 * shader. RAYDIFF_VULKAN_LIBRARY names another loader than libvulkan.so.1. */
#ifndef VULKAN_OPTIONS_H
#define VULKAN_OPTIONS_H

#include "gpu/vk/vk.h"
#include "ref/engine.h"

/* Returns the options for vk_open; their strings are borrowed. */
struct vk_options vulkan_options(const struct engine_options *options);

/* As engine.describe: lists the devices, and what the judge assumes of the chosen one. */
void vulkan_describe(const struct engine *engine, const struct engine_options *options, char *text,
                     size_t text_bytes);

#endif
