/* Keeps each shader module that a program makes:
 *   RAYDIFF_MODULES=FOLDER LD_PRELOAD=modules.so PROGRAM...
 * The folder gets a file per content, so that tests/mutation/coverage.sh can tell which suites
 * make which module. Stands between the program and the entry points that it asks the Vulkan
 * loader for. */
#define _GNU_SOURCE /* dlvsym, asprintf, RTLD_NEXT */
#include <vulkan/vulkan.h>

#include <dlfcn.h>
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static PFN_vkGetInstanceProcAddr instance_entry;
static PFN_vkGetDeviceProcAddr device_entry;
static PFN_vkCreateShaderModule create_module;

/* Writes the words under a name made of them, whole or not at all: many processes write. */
static void keep(const void *words, size_t bytes)
{
    const char *folder = getenv("RAYDIFF_MODULES");
    const unsigned char *byte = words;
    uint64_t hash = 14695981039346656037u; /* FNV-1a */
    for (size_t i = 0; i < bytes; i++)
        hash = (hash ^ byte[i]) * 1099511628211u;
    char *path = NULL, *made = NULL;
    if (folder && asprintf(&path, "%s/%016" PRIx64, folder, hash) > 0 && access(path, F_OK) != 0 &&
        asprintf(&made, "%s.%ld", path, (long)getpid()) > 0) {
        FILE *file = fopen(made, "wb");
        if (file && fwrite(words, 1, bytes, file) == bytes && fclose(file) == 0)
            (void)rename(made, path);
    }
    free(path);
    free(made);
}

static VKAPI_ATTR VkResult VKAPI_CALL kept_module(VkDevice device,
                                                  const VkShaderModuleCreateInfo *info,
                                                  const VkAllocationCallbacks *allocator,
                                                  VkShaderModule *module)
{
    keep(info->pCode, info->codeSize);
    return create_module(device, info, allocator, module);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_asked(VkDevice device, const char *name)
{
    PFN_vkVoidFunction entry = device_entry(device, name);
    if (!entry || strcmp(name, "vkCreateShaderModule") != 0)
        return entry;
    create_module = (PFN_vkCreateShaderModule)entry;
    return (PFN_vkVoidFunction)kept_module;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_asked(VkInstance of, const char *name)
{
    PFN_vkVoidFunction entry = instance_entry(of, name);
    if (!entry || strcmp(name, "vkGetDeviceProcAddr") != 0)
        return entry;
    device_entry = (PFN_vkGetDeviceProcAddr)entry;
    return (PFN_vkVoidFunction)device_asked;
}

/* In place of that of the C library. The first to ask for the entry is the program, which may ask
 * again; drivers, which have one of that name, too, are left alone. */
void *dlsym(void *restrict handle, const char *restrict name)
{
    static void *(*real)(void *, const char *);
    if (!real) {
        void *symbol = dlvsym(RTLD_NEXT, "dlsym", "GLIBC_2.34");
        if (!symbol)
            symbol = dlvsym(RTLD_NEXT, "dlsym", "GLIBC_2.2.5"); /* x86-64 before glibc 2.34 */
        memcpy(&real, &symbol, sizeof real);
    }
    void *found = real(handle, name);
    if (!found || strcmp(name, "vkGetInstanceProcAddr") != 0)
        return found;
    PFN_vkGetInstanceProcAddr entry;
    memcpy(&entry, &found, sizeof entry);
    if (instance_entry && entry != instance_entry)
        return found;
    instance_entry = entry;
    PFN_vkGetInstanceProcAddr asked = instance_asked;
    memcpy(&found, &asked, sizeof found);
    return found;
}
