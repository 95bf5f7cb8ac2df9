#include "gpu/trace/vulkan_options.h"

#include "gpu/card/probe.h"
#include "ref/base/text.h"

#include <stdlib.h>
#include <string.h>

struct vk_options vulkan_options(const struct engine_options *options)
{
    const char *validate = getenv("RAYDIFF_VALIDATE");
    return (struct vk_options){
        .library = getenv("RAYDIFF_VULKAN_LIBRARY"),
        .driver = options->driver,
        .device = options->device,
        .compiler = options->compiler,
        .validate = validate && strcmp(validate, "1") == 0,
        .watch = validate && strcmp(validate, "gpu") == 0,
    };
}

void vulkan_describe(const struct engine *engine, const struct engine_options *options, char *text,
                     size_t text_bytes)
{
    (void)engine;
    struct vk_options vk_options = vulkan_options(options);
    struct vk *vk;
    struct reason reason;
    vk_describe(&vk_options, text, text_bytes);
    if (vk_open(&vk_options, &vk, &reason))
        return; /* the list contains the reason */
    struct arithmetic arithmetic = probe_measure(vk);
    text_append(text, text_bytes, "arithmetic of %s: %s\n", vk_limits(vk)->device,
                probe_arithmetic_text(&arithmetic));
    (void)vk_close(vk, NULL);
}
