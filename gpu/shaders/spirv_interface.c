#include "gpu/shaders/spirv_interface.h"

#include "gpu/shaders/spirv_look.h"
#include "gpu/shaders/spirv_words.h"

#include <string.h>

enum { MODEL_COMPUTE = 5, MODE_LOCAL_SIZE = 17 };

static enum status decoration(const uint32_t *at, uint32_t length, uint32_t bindings,
                              struct spirv_interface *out, struct reason *reason)
{
    if (length < 4)
        return STATUS_OK;
    if (at[2] == DECORATION_SPEC_ID && at[3] == 0)
        out->local_chosen = true;
    if (at[2] == DECORATION_BINDING && at[3] >= bindings)
        return fail(reason, STATUS_INPUT, "binding %u: there are 0 to %u", at[3], bindings - 1);
    if (at[2] == DECORATION_DESCRIPTOR_SET && at[3] != 0)
        return fail(reason, STATUS_INPUT, "descriptor set %u: there is 0", at[3]);
    return STATUS_OK;
}

/* One instruction. */
static enum status take(const uint32_t *at, uint32_t length, uint32_t bindings, bool *main_found,
                        struct spirv_interface *out, struct reason *reason)
{
    const uint32_t code = at[0] & 0xFFFFu;
    uint32_t name[2] = {0, 0};
    memcpy(name, "main", 4);
    if (code == OP_ENTRY_POINT && length >= 5) {
        if (at[1] != MODEL_COMPUTE)
            return fail(reason, STATUS_INPUT, "no compute shader");
        *main_found = *main_found || memcmp(at + 3, name, sizeof name) == 0;
    } else if (code == OP_EXECUTION_MODE && length >= 6 && at[2] == MODE_LOCAL_SIZE) {
        memcpy(out->local, at + 3, sizeof out->local);
    } else if (code == OP_DECORATE) {
        return decoration(at, length, bindings, out, reason);
    }
    return STATUS_OK;
}

enum status spirv_interface(const uint32_t *word, size_t count, uint32_t bindings,
                            struct spirv_interface *out, struct reason *reason)
{
    struct spirv_found found;
    bool main_found = false;
    *out = (struct spirv_interface){.local_chosen = false};
    if (count > UINT32_MAX)
        return fail(reason, STATUS_INPUT, "a module of over 2^32 words");
    enum status status = spirv_look(word, (uint32_t)count, &found, reason); /* lengths, too */
    if (!status && found.other_capabilities)
        status = fail(reason, STATUS_INPUT, "it needs %u capabilities beyond Shader",
                      found.other_capabilities);
    for (size_t at = SPIRV_HEADER_WORDS; at < count && !status; at += word[at] >> 16)
        status = take(word + at, word[at] >> 16, bindings, &main_found, out, reason);
    if (!status && !main_found)
        status = fail(reason, STATUS_INPUT, "no entry point main");
    if (!status && (out->local[1] > 1 || out->local[2] > 1))
        status =
            fail(reason, STATUS_INPUT, "a workgroup of %u x %u x %u: rays are in one dimension",
                 out->local[0], out->local[1], out->local[2]);
    if (status)
        *out = (struct spirv_interface){.local_chosen = false};
    return status;
}
