/* A Vulkan layer that puts another module in place of one: where a program makes a shader of the
 * words of the file SWAP_FROM, the driver gets those of SWAP_TO. So the programs of the tests play
 * a mutant without being linked anew. SWAP_SEEN names a file that is made once that happened. It
 * uses nothing of raydiff. */
#include "tests/support/module_layer.h"

#include <stdio.h>

struct swap_words {
    uint32_t word[1 << 16];
    size_t bytes;
};

static struct swap_words from, to;

static void read_words(const char *variable, struct swap_words *out)
{
    const char *path = getenv(variable);
    FILE *file = path ? fopen(path, "rb") : NULL;
    out->bytes = file ? fread(out->word, 1, sizeof out->word, file) : 0;
    if (file)
        fclose(file);
}

static VKAPI_ATTR VkResult VKAPI_CALL make_module(VkDevice device,
                                                  const VkShaderModuleCreateInfo *info,
                                                  const VkAllocationCallbacks *allocator,
                                                  VkShaderModule *out)
{
    VkShaderModuleCreateInfo other = *info;
    if (from.bytes == 0) {
        read_words("SWAP_FROM", &from);
        read_words("SWAP_TO", &to);
    }
    if (to.bytes > 0 && info->codeSize == from.bytes &&
        memcmp(info->pCode, from.word, from.bytes) == 0) {
        const char *seen = getenv("SWAP_SEEN");
        FILE *file = seen ? fopen(seen, "a") : NULL;
        if (file)
            fclose(file);
        other.pCode = to.word;
        other.codeSize = to.bytes;
    }
    return next_module(device, &other, allocator, out);
}
