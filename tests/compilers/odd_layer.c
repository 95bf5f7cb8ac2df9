/* A Vulkan layer in front of a driver that cannot bear odd modules: on one with the bound of ids of
 * tests/compilers/spirv_pass.c's odd, but without its name, it ends the process, with ODD=hang in
 * the environment it hangs. All other calls go on to the driver. It uses nothing of raydiff. */
#include "tests/support/module_layer.h"

#include <unistd.h>

static int has(const VkShaderModuleCreateInfo *info, uint32_t word)
{
    for (size_t i = 0; i < info->codeSize / 4; i++)
        if (info->pCode[i] == word)
            return 1;
    return 0;
}

static VKAPI_ATTR VkResult VKAPI_CALL make_module(VkDevice device,
                                                  const VkShaderModuleCreateInfo *info,
                                                  const VkAllocationCallbacks *allocator,
                                                  VkShaderModule *out)
{
    const char *what = getenv("ODD");
    const int odd = info->codeSize > 16 && info->pCode[3] == 4000037 && !has(info, 0x0064646F);
    while (odd && what && strcmp(what, "hang") == 0)
        pause();
    if (odd)
        abort();
    return next_module(device, info, allocator, out);
}
