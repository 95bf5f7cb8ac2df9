/* raydiff explain of an external layout: compares what its C and its GLSL decode. */
#include "cmd/explain/cmd_explain_inner.h"

#include "ref/outside/plugin_shader.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <stdio.h>

enum status explain_decode(const struct explain_options *o, const struct packed *packed,
                           struct explain_decode *out, struct reason *reason)
{
    *out = (struct explain_decode){.compared = false};
    if (!o->of.layout || !plugin_shader_path(o->of.layout))
        return STATUS_OK;
    out->asked = true;
    enum status status = decode_compare(packed, &o->engines, &out->decoded, &out->why);
    out->compared = status == STATUS_OK;
    if (status && status != STATUS_UNSUPPORTED)
        return fail(reason, status, "comparing what C and GLSL decode: %s", out->why.text);
    return STATUS_OK;
}

int explain_decode_code(const struct explain_decode *decode)
{
    if (!decode->asked)
        return EXIT_AGREE;
    return !decode->compared ? EXIT_SKIPPED : decode->decoded.differ ? EXIT_MISMATCH : EXIT_AGREE;
}

void explain_decode_print(const struct explain_decode *decode, const struct screen *screen)
{
    const struct decoded *decoded = &decode->decoded;
    if (!decode->asked)
        return;
    if (!decode->compared) {
        screen_text(screen, "decode    C and GLSL are not compared: %s\n", decode->why.text);
        return;
    }
    if (decoded->differ == 0) {
        screen_text(screen, "decode    C and GLSL decode the same of %s, %s\n",
                    COUNTED(decoded->records, "record"), COUNTED(decoded->slots, "slot"));
        return;
    }
    screen_text(screen, "decode    DIFFERS: %s\n", decoded->first);
    screen_text(screen, "          %u of %u records decode otherwise in GLSL than in C\n",
                decoded->differ, decoded->records);
}

json_t *explain_decode_json(const struct explain_decode *decode)
{
    const struct decoded *decoded = &decode->decoded;
    if (!decode || !decode->asked)
        return json_null();
    return json_record("compared=%i reason=%s records=%u slots=%u differ=%u first=%s",
                       decode->compared, decode->why.text, decoded->records, decoded->slots,
                       decoded->differ, decoded->first);
}
