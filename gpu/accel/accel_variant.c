#include "gpu/accel/accel_variant.h"

#include "gpu/accel/accel_format.h"
#include "ref/base/text.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HOW(field) offsetof(struct accel_variant, how.field)
#define OWN(field) offsetof(struct accel_variant, field)

/* A word, the number that it sets, and to what. `kind`: words of one kind exclude each other. */
static const struct word {
    const char *text;
    size_t at;
    uint32_t value;
    bool flag; /* the number is a bool */
    char kind;
} words[] = {
    {"fast_trace", HOW(fast_trace), 1, true, 'p'},
    {"fast_build", HOW(fast_build), 1, true, 'p'},
    {"low_memory", HOW(low_memory), 1, true, 'l'},
    {"allow_update", HOW(allow_update), 1, true, 'a'},
    {"allow_compaction", HOW(allow_compaction), 1, true, 'b'},
    {"update", HOW(update), VK_ACCEL_UPDATE_IN_PLACE, false, 'u'},
    {"update_into", HOW(update), VK_ACCEL_UPDATE_INTO, false, 'u'},
    {"compact", HOW(copy), VK_ACCEL_COPY_COMPACT, false, 'c'},
    {"clone", HOW(copy), VK_ACCEL_COPY_CLONE, false, 'c'},
    {"serialise", HOW(copy), VK_ACCEL_COPY_SERIALISE, false, 'c'},
    {"serialise_new", HOW(copy), VK_ACCEL_COPY_SERIALISE_NEW, false, 'c'},
    {"indirect", HOW(where), VK_ACCEL_INDIRECT, false, 'w'},
    {"host", HOW(where), VK_ACCEL_BY_HOST, false, 'w'},
    {"split", OWN(split), 0, false, 's'},
    {"scaled", OWN(transform), ACCEL_SCALED, false, 't'},
    {"turned", OWN(transform), ACCEL_TURNED, false, 't'},
    {"moved", OWN(transform), ACCEL_MOVED, false, 't'},
    {"u16", OWN(index), ACCEL_U16, false, 'i'},
    {"u8", OWN(index), ACCEL_U8, false, 'i'},
    {"unindexed", OWN(index), ACCEL_UNINDEXED, false, 'i'},
    {"f32x2", OWN(format), ACCEL_F32X2, false, 'f'},
    {"f32x4", OWN(format), ACCEL_F32X4, false, 'f'},
    {"f16x2", OWN(format), ACCEL_F16X2, false, 'f'},
    {"f16x3", OWN(format), ACCEL_F16X3, false, 'f'},
    {"f16x4", OWN(format), ACCEL_F16X4, false, 'f'},
    {"s16x2", OWN(format), ACCEL_S16X2, false, 'f'},
    {"s16x4", OWN(format), ACCEL_S16X4, false, 'f'},
    {"u16x2", OWN(format), ACCEL_U16X2, false, 'f'},
    {"u16x4", OWN(format), ACCEL_U16X4, false, 'f'},
    {"s8x2", OWN(format), ACCEL_S8X2, false, 'f'},
    {"s8x4", OWN(format), ACCEL_S8X4, false, 'f'},
    {"u8x2", OWN(format), ACCEL_U8X2, false, 'f'},
    {"u8x4", OWN(format), ACCEL_U8X4, false, 'f'},
    {"u10x3", OWN(format), ACCEL_U10X3, false, 'f'},
    {"f64x3", OWN(format), ACCEL_F64X3, false, 'f'},
    {"stride", OWN(stride), 0, false, 'd'},
    {"offset", OWN(offset), 1, true, 'o'},
    {"first_vertex", OWN(first_vertex), 1, true, 'v'},
    {"nan", OWN(nan), 1, true, 'n'},
    {"degenerate", OWN(degenerate), 1, true, 'g'},
};

_Static_assert(sizeof(enum vk_accel_copy) == sizeof(uint32_t), "numbers are set by their size");

const char *const accel_names[] = {
    "rayquery:fast_trace",
    "rayquery:fast_build",
    "rayquery:low_memory",
    "rayquery:allow_update",
    "rayquery:allow_compaction",
    "rayquery:fast_build:low_memory:allow_update:allow_compaction",
    "rayquery:update",
    "rayquery:update_into",
    "rayquery:compact",
    "rayquery:clone",
    "rayquery:serialise",
    "rayquery:serialise_new",
    "rayquery:indirect",
    "rayquery:host",
    "rayquery:split2",
    "rayquery:split7",
    "rayquery:scaled",
    "rayquery:turned",
    "rayquery:moved",
    "rayquery:u16",
    "rayquery:u8",
    "rayquery:unindexed",
    "rayquery:f32x2",
    "rayquery:f32x4",
    "rayquery:f16x2",
    "rayquery:f16x3",
    "rayquery:f16x4",
    "rayquery:s16x2",
    "rayquery:s16x4",
    "rayquery:u16x2",
    "rayquery:u16x4",
    "rayquery:s8x2",
    "rayquery:s8x4",
    "rayquery:u8x2",
    "rayquery:u8x4",
    "rayquery:u10x3",
    "rayquery:f64x3",
    "rayquery:stride20",
    "rayquery:offset",
    "rayquery:first_vertex",
    "rayquery:nan",
    "rayquery:degenerate",
    "rayquery:fast_build:update:compact:u16:stride20",
    "rayquery:fast_build:update_into:clone",
    "rayquery:fast_trace:update:serialise",
    "rayquery:update_into:serialise_new:split3",
    "rayquery:low_memory:compact:split5:nan",
    "rayquery:update:split5:nan:degenerate",
    "rayquery:update:split3:scaled:u16:offset",
    "rayquery:compact:split7:turned:unindexed:offset",
    "rayquery:clone:split4:scaled:stride32:nan",
    "rayquery:serialise:split4:turned:u16:stride24:offset:nan:degenerate",
    "rayquery:serialise_new:unindexed:stride16:offset",
    "rayquery:split3:u16:f32x4:stride48:offset:nan",
    "rayquery:split2:u16:f16x4:stride12:offset:first_vertex",
    NULL,
};

/* --- reading ---------------------------------------------------------------------------------- */

static const char *const compilers[] = {"raw",     "opt",   "size",      "passes", "cross", "hlsl",
                                        "shaderc", "texel", "reference", "source", "final", "none"};

bool accel_is_named(const char *name)
{
    const size_t prefix = strlen(ACCEL_PREFIX);
    if (strncmp(name, ACCEL_PREFIX, prefix) != 0)
        return false;
    const size_t length = strcspn(name + prefix, ":");
    for (size_t i = 0; i < ARRAY_COUNT(compilers); i++)
        if (strlen(compilers[i]) == length && memcmp(compilers[i], name + prefix, length) == 0)
            return false;
    return true;
}

/* Reads the number behind a word such as "stride20". Returns 0 if it is none. */
static uint32_t number_behind(const char *text, size_t length)
{
    uint32_t number = 0;
    if (length == 0 || length > 4 || text[0] == '0')
        return 0;
    for (size_t i = 0; i < length; i++) {
        if (text[i] < '0' || text[i] > '9')
            return 0;
        number = 10 * number + (uint32_t)(text[i] - '0');
    }
    return number;
}

static void set(struct accel_variant *variant, const struct word *word, uint32_t value)
{
    const bool yes = value != 0;
    if (word->flag)
        memcpy((char *)variant + word->at, &yes, sizeof yes);
    else
        memcpy((char *)variant + word->at, &value, sizeof value);
}

static uint32_t get(const struct accel_variant *variant, const struct word *word)
{
    bool yes = false;
    uint32_t value = 0;
    if (word->flag)
        memcpy(&yes, (const char *)variant + word->at, sizeof yes);
    else
        memcpy(&value, (const char *)variant + word->at, sizeof value);
    return word->flag ? yes : value;
}

/* Takes a word. Returns its kind, or 0 if it is none. */
static char take(const char *text, size_t length, struct accel_variant *out)
{
    for (size_t i = 0; i < ARRAY_COUNT(words); i++) {
        const struct word *word = &words[i];
        const size_t own = strlen(word->text);
        if (length < own || memcmp(text, word->text, own) != 0)
            continue;
        const uint32_t number = number_behind(text + own, length - own);
        const uint32_t value = word->value ? word->value : number;
        if (word->value ? length != own : !number)
            continue;
        set(out, word, value);
        return word->kind;
    }
    return 0;
}

static enum status check(const char *name, const struct accel_variant *variant,
                         struct reason *reason)
{
    const struct accel_format_facts *format = &accel_format[variant->format];
    if (variant->split == 1 || variant->split > ACCEL_SPLIT_MOST)
        return fail(reason, STATUS_INPUT, "'%.80s': split2 to split%u", name, ACCEL_SPLIT_MOST);
    if (variant->stride && (variant->stride < format->bytes || variant->stride % format->align ||
                            variant->stride > ACCEL_STRIDE_MOST))
        return fail(reason, STATUS_INPUT,
                    "'%.80s': a stride of %s is a multiple of %u from %u to %u", name, format->name,
                    format->align, format->bytes, ACCEL_STRIDE_MOST);
    if (variant->nan && !format->nan)
        return fail(reason, STATUS_INPUT, "'%.80s': format %s has no NaN", name, format->name);
    return STATUS_OK;
}

enum status accel_parse(const char *name, struct accel_variant *out, struct reason *reason)
{
    char said[ARRAY_COUNT(words) + 1] = "";
    *out = (struct accel_variant){.split = 0};
    for (const char *at = name + strlen(ACCEL_PREFIX);; at++) {
        const size_t length = strcspn(at, ":"), count = strlen(said);
        const char kind = take(at, length, out);
        if (!kind || strchr(said, kind))
            return fail(
                reason, STATUS_INPUT,
                "'%.80s': '%.*s' is no word for a variant of rayquery, or the second of its "
                "kind (docs/variants.md; rayquery:all), nor a compiler",
                name, (int)(length < 30 ? length : 30), at);
        said[count] = kind;
        said[count + 1] = '\0';
        at += length;
        if (!*at)
            break;
    }
    enum status status = check(name, out, reason);
    if (out->stride == accel_format[out->format].bytes)
        out->stride = 0;
    out->how.allow_update = out->how.allow_update && out->how.update == VK_ACCEL_UPDATE_NONE;
    out->how.allow_compaction = out->how.allow_compaction && out->how.copy != VK_ACCEL_COPY_COMPACT;
    return status;
}

void accel_write(const struct accel_variant *variant, char name[ACCEL_NAME_MOST])
{
    snprintf(name, ACCEL_NAME_MOST, "rayquery");
    for (size_t i = 0; i < ARRAY_COUNT(words); i++) {
        const struct word *word = &words[i];
        const uint32_t value = get(variant, word);
        if (!value || (word->value && value != word->value))
            continue;
        text_append(name, ACCEL_NAME_MOST, ":%s", word->text);
        if (!word->value)
            text_append(name, ACCEL_NAME_MOST, "%u", value);
    }
}

bool accel_original(const struct accel_variant *variant, struct accel_variant *out)
{
    *out = *variant;
    out->how.copy = VK_ACCEL_COPY_NONE;
    if (variant->how.copy == VK_ACCEL_COPY_COMPACT)
        out->how.allow_compaction = true; /* the flag of what is compacted */
    return variant->how.copy != VK_ACCEL_COPY_NONE;
}

bool accel_has_form(const struct accel_variant *variant)
{
    return variant->transform || variant->index || variant->format || variant->stride ||
           variant->split || variant->offset || variant->first_vertex || variant->nan ||
           variant->degenerate;
}
