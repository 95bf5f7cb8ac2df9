#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

#include "types.c"

#include "finding.h"

#include "check.c"

#include "device.c"

#if EXPORT_RAY_QUERY
#include "structure.c"

#endif
/* --- the shader --- */

static VkDescriptorSetLayout set_layout;
static VkPipelineLayout layout;
static VkPipeline pipeline;
static VkDescriptorPool sets;
static VkDescriptorSet set;

static void make_layouts(void)
{
#if EXPORT_RAY_QUERY
    VkDescriptorSetLayoutBinding binding[BINDINGS + 1] = {{0}};
#else
    VkDescriptorSetLayoutBinding binding[BINDINGS] = {{0}};
#endif
    for (uint32_t i = 0; i < BINDINGS; i++) {
        binding[i].binding = i;
        binding[i].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        binding[i].descriptorCount = 1;
        binding[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    }
#if EXPORT_RAY_QUERY
    binding[BINDINGS] = binding[0];
    binding[BINDINGS].binding = BINDINGS;
    binding[BINDINGS].descriptorType = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
#endif
    VkDescriptorSetLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = sizeof binding / sizeof binding[0],
        .pBindings = binding,
    };
    try(vkCreateDescriptorSetLayout(device, &info, NULL, &set_layout),
        "vkCreateDescriptorSetLayout");
    VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push};
    VkPipelineLayoutCreateInfo whole = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1,
        .pSetLayouts = &set_layout,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &range,
    };
    try(vkCreatePipelineLayout(device, &whole, NULL, &layout), "vkCreatePipelineLayout");
}

static void make_pipeline(void)
{
    VkShaderModule module;
    VkShaderModuleCreateInfo code = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = sizeof shader,
        .pCode = shader,
    };
    try(vkCreateShaderModule(device, &code, NULL, &module), "vkCreateShaderModule");
    VkSpecializationMapEntry entry[CONSTANTS];
    for (uint32_t i = 0; i < CONSTANTS; i++)
        entry[i] = (VkSpecializationMapEntry){i, 4 * i, 4};
    VkSpecializationInfo values = {CONSTANTS, entry, sizeof constants, constants};
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main",
                  .pSpecializationInfo = &values},
        .layout = layout,
    };
    try(vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &info, NULL, &pipeline),
        "vkCreateComputePipelines");
    vkDestroyShaderModule(device, module, NULL);
}

static void make_set(const struct buffer *buffer)
{
    const VkDescriptorPoolSize sizes[] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, BINDINGS},
#if EXPORT_RAY_QUERY
        {VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1},
#endif
    };
    VkDescriptorPoolCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = 1,
        .poolSizeCount = sizeof sizes / sizeof sizes[0],
        .pPoolSizes = sizes,
    };
    try(vkCreateDescriptorPool(device, &info, NULL, &sets), "vkCreateDescriptorPool");
    VkDescriptorSetAllocateInfo allocate = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = sets,
        .descriptorSetCount = 1,
        .pSetLayouts = &set_layout,
    };
    try(vkAllocateDescriptorSets(device, &allocate, &set), "vkAllocateDescriptorSets");
    for (uint32_t i = 0; i < BINDINGS; i++) {
        VkDescriptorBufferInfo whole = {buffer[i].buffer, 0, VK_WHOLE_SIZE};
        VkWriteDescriptorSet write = {
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = set,
            .dstBinding = i,
            .descriptorCount = 1,
            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            .pBufferInfo = &whole,
        };
        vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    }
#if EXPORT_RAY_QUERY
    bind_structure(set);
#endif
}

static void run(void)
{
    begin();
    vkCmdBindPipeline(command, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(command, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &set, 0, NULL);
    vkCmdPushConstants(command, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, push);
    vkCmdDispatch(command, GROUPS, 1, 1);
    VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_HOST_READ_BIT,
    };
    vkCmdPipelineBarrier(command, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                         0, 1, &barrier, 0, NULL, 0, NULL);
    submit("the dispatch");
}

static void close_all(struct buffer *buffer)
{
    for (uint32_t i = 0; i < BINDINGS; i++)
        free_buffer(&buffer[i]);
    vkDestroyPipeline(device, pipeline, NULL);
    vkDestroyPipelineLayout(device, layout, NULL);
    vkDestroyDescriptorPool(device, sets, NULL);
    vkDestroyDescriptorSetLayout(device, set_layout, NULL);
#if EXPORT_RAY_QUERY
    free_structure();
#endif
    vkDestroyFence(device, fence, NULL);
    vkDestroyCommandPool(device, pool, NULL);
    vkDestroyDevice(device, NULL);
    vkDestroyInstance(instance, NULL);
}

int main(int argc, char **argv)
{
    static struct hit hits[RAYS];
    static uint32_t flags[RAYS];
    static unsigned char finished[RAYS];
    char *end = NULL;
    unsigned long index = argc > 1 ? strtoul(argv[1], &end, 10) : 0;
    if (argc > 2 || (argc > 1 && (end == argv[1] || *end))) {
        printf("usage: %s [DEVICE]\n", argv[0]);
        return 2;
    }
    setvbuf(stdout, NULL, _IOLBF, 0); /* what is said before a crash is seen */
    make_instance();
    choose_device(index);
    choose_queue();
    make_device();
    struct buffer buffer[BINDINGS];
    for (uint32_t i = 0; i < BINDINGS; i++)
        buffer[i] = make_buffer(VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, contents[i].data,
                                contents[i].data_bytes, contents[i].bytes);
#if EXPORT_RAY_QUERY
    build_structure();
#endif
    make_layouts();
    make_pipeline();
    make_set(buffer);
    run();
    memcpy(hits, buffer[HITS].map, sizeof hits);
    memcpy(flags, buffer[FLAGS].map, sizeof flags);
    close_all(buffer);
    for (uint32_t i = 0; i < RAYS; i++)
        finished[i] = flags[i] == FINISHED;
    return check(hits, finished);
}
