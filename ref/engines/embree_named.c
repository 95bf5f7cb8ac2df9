#include "ref/engines/embree_named.h"

#include "ref/engines/embree_isa.h"
#include "ref/twin/model.h"

#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

extern const struct engine engine_embree, engine_embree_robust;

const char *const embree_isa_words[EMBREE_ISAS] = {"", "sse2", "sse42", "avx", "avx2", "avx512"};
static const char *const quality_words[EMBREE_QUALITIES] = {"medium", "low", "high"};
static const char *const packet_words[] = {"1", "4", "8", "16"};
static const unsigned packets[] = {0, 4, 8, 16};

/* An engine of this file. */
struct named_mode {
    char name[EMBREE_NAME_MOST];
    struct embree_mode mode;
};

static enum status mode_open(const struct engine *engine, const struct engine_options *options,
                             void **self, struct reason *reason)
{
    return embree_open_mode(options, embree_mode_of(engine), self, reason);
}

/* How rays are given to Embree. */
#define CALLED(n)                                                                                  \
    static const char *called_##n(const void *self)                                                \
    {                                                                                              \
        (void)self;                                                                                \
        return "rtcIntersect" #n " or rtcOccluded" #n;                                             \
    }
CALLED(1)
CALLED(4)
CALLED(8)
CALLED(16)

static const char *(*const called[])(const void *self) = {called_1, called_4, called_8, called_16};

static size_t form_of(const struct embree_mode *mode)
{
    size_t form = 0;
    while (packets[form] != mode->packet)
        form++;
    return form;
}

/* --- names ------------------------------------------------------------------------------------ */

bool embree_is_named(const char *name)
{
    return strncmp(name, EMBREE_PREFIX, strlen(EMBREE_PREFIX)) == 0;
}

/* Where the word of that length is in a list; `count`: nowhere. */
static size_t find(const char *const *list, size_t count, const char *word, size_t length)
{
    size_t i = 0;
    while (i < count && !(strlen(list[i]) == length && memcmp(list[i], word, length) == 0))
        i++;
    return i;
}

/* What a name has said so far. */
struct words_said {
    bool isa, form, quality, robust, compact, updates;
};

/* Takes a word. Returns false if it is none, or the second of its kind. */
static bool take(const char *word, size_t length, struct words_said *said, struct embree_mode *out)
{
    static const char *const flags[] = {"robust", "compact", "dynamic", "refit"};
    enum { ROBUST, COMPACT, DYNAMIC, REFIT };
    const bool dotted = length == 6 && memcmp(word, "sse4.2", 6) == 0;
    const size_t isa =
        dotted ? EMBREE_ISA_SSE42 : find(embree_isa_words, EMBREE_ISAS, word, length);
    const size_t form = find(packet_words, ARRAY_COUNT(packet_words), word, length);
    const size_t quality = find(quality_words, EMBREE_QUALITIES, word, length);
    const size_t flag = find(flags, ARRAY_COUNT(flags), word, length);
    bool *kind = &said->compact;
    if (isa > EMBREE_ISA_OWN && isa < EMBREE_ISAS) {
        out->isa = (enum embree_isa)isa;
        kind = &said->isa;
    } else if (form < ARRAY_COUNT(packet_words)) {
        out->packet = packets[form];
        kind = &said->form;
    } else if (quality < EMBREE_QUALITIES) {
        out->quality = (enum embree_quality)quality;
        kind = &said->quality;
    } else if (flag == ROBUST) {
        kind = &said->robust;
    } else if (flag == DYNAMIC || flag == REFIT) {
        kind = &said->updates;
    } else if (flag != COMPACT) {
        return false;
    }
    out->robust = out->robust || flag == ROBUST;
    out->compact = out->compact || flag == COMPACT;
    out->dynamic = out->dynamic || flag == DYNAMIC || flag == REFIT;
    out->refit = out->refit || flag == REFIT;
    const bool second = *kind;
    *kind = true;
    return !second;
}

enum status embree_named_parse(const char *name, struct embree_mode *out, struct reason *reason)
{
    struct words_said said = {false};
    *out = (struct embree_mode){0};
    for (const char *at = name + strlen(EMBREE_PREFIX);; at++) {
        const size_t length = strcspn(at, ":");
        if (!take(at, length, &said, out))
            return fail(reason, STATUS_INPUT,
                        "'%.60s': '%.*s' is no word for a mode of Embree, or the second of its "
                        "kind: sse2, sse42, avx, avx2 or avx512; 1, 4, 8 or 16; low, medium or "
                        "high; robust; compact; dynamic or refit; or embree:all",
                        name, (int)(length < 30 ? length : 30), at);
        at += length;
        if (!*at)
            return STATUS_OK;
    }
}

const char *embree_named_plain(const char *name)
{
    struct embree_mode mode;
    struct reason reason;
    if (!embree_is_named(name) || embree_named_parse(name, &mode, &reason))
        return NULL;
    return mode.robust ? engine_embree_robust.name : engine_embree.name;
}

void embree_named_write(const struct embree_mode *mode, char name[EMBREE_NAME_MOST])
{
    static const struct embree_mode plain = {0};
    const size_t form = form_of(mode);
    snprintf(name, EMBREE_NAME_MOST, "embree%s%s%s%s%s%s%s%s%s", mode->isa ? ":" : "",
             embree_isa_words[mode->isa], form ? ":" : "", form ? packet_words[form] : "",
             mode->quality ? ":" : "", mode->quality ? quality_words[mode->quality] : "",
             mode->robust ? ":robust" : "", mode->compact ? ":compact" : "",
             mode->refit     ? ":refit"
             : mode->dynamic ? ":dynamic"
                             : "");
    struct embree_mode rest = *mode;
    rest.robust = false;
    if (mode->robust && memcmp(&rest, &plain, sizeof rest) == 0)
        snprintf(name, EMBREE_NAME_MOST, "%s", engine_embree_robust.name);
}

/* --- engines ---------------------------------------------------------------------------------- */

static enum status add(const struct embree_mode *mode, const char *name, const struct engine **out,
                       struct reason *reason)
{
    static struct named_mode places[ENGINES_EMBREE_MOST];
    static size_t place_count;
    if (place_count == ENGINES_EMBREE_MOST)
        return fail(reason, STATUS_LIMIT, "%s: more than %d modes of Embree", name,
                    ENGINES_EMBREE_MOST);
    struct named_mode *place = &places[place_count];
    snprintf(place->name, sizeof place->name, "%s", name);
    place->mode = *mode;
    struct engine engine = mode->robust ? engine_embree_robust : engine_embree;
    engine.plain = mode->robust ? &engine_embree_robust : &engine_embree;
    engine.name = place->name;
    engine.summary = "a mode of Embree";
    engine.named = &place->mode;
    engine.open = mode_open;
    engine.called = called[form_of(mode)];
    if (mode->packet)
        engine.worlds = NULL;
    const enum status status = engine_add(&engine, out, reason);
    place_count += !status;
    return status;
}

enum status embree_named(const char *name, const struct engine **out, struct reason *reason)
{
    struct embree_mode mode;
    char own[EMBREE_NAME_MOST];
    *out = NULL;
    enum status status = embree_named_parse(name, &mode, reason);
    if (status)
        return status;
    embree_named_write(&mode, own);
    *out = engine_find(own);
    if (*out)
        return STATUS_OK;
    status = embree_isa_check(mode.isa, reason);
    return status ? status : add(&mode, own, out, reason);
}

/* The modes that name their ISA, by number. */
static struct embree_mode mode_at(unsigned i)
{
    return (struct embree_mode){.isa = (enum embree_isa)(1 + i / 48),
                                .packet = packets[i / 12 % 4],
                                .quality = (enum embree_quality)(i / 4 % EMBREE_QUALITIES),
                                .robust = i / 2 % 2,
                                .compact = i % 2};
}

enum status embree_named_all(const char *pattern, struct reason *reason)
{
    enum status status = STATUS_OK;
    struct reason why = {""};
    bool any = false, runs = false;
    for (unsigned i = 0; i < 48 * (EMBREE_ISAS - 1) && status != STATUS_LIMIT; i++) {
        const struct embree_mode mode = mode_at(i);
        const struct engine *engine;
        char name[EMBREE_NAME_MOST];
        embree_named_write(&mode, name);
        if (fnmatch(pattern, name, 0) != 0)
            continue;
        any = true;
        status = embree_named(name, &engine, &why);
        runs = runs || !status;
    }
    if (!any)
        return fail(reason, STATUS_INPUT, "no mode of Embree is called '%.60s'", pattern);
    if (runs && status != STATUS_LIMIT)
        return STATUS_OK;
    return fail(reason, status, "%s", why.text);
}

const struct embree_mode *embree_mode_of(const struct engine *engine)
{
    return engine->open == mode_open ? engine->named : NULL;
}
