/* The parts of engine `vulkan` that tests reach beside struct engine. */
#ifndef ENGINE_VULKAN_H
#define ENGINE_VULKAN_H

#include "gpu/vk.h"
#include "ref/engine.h"

/* As engine_vulkan.open, with the device's options given. `workgroup` 0 is ABI_WORKGROUP. */
enum status engine_vulkan_open(const struct vk_options *options, uint32_t workgroup, void **self,
                               struct reason *reason) MUST_USE;

/* As engine_vulkan.close; returns vk_close's count of validation messages. */
uint32_t engine_vulkan_close(void *self, struct reason *reason);

/* How many pipelines have been made since open. */
uint32_t engine_vulkan_pipelines(const void *self);

#endif
