#include "scenes/read/world_fields.h"

static const char *const flag_word[] = {"cull_disable", "flip_facing", "force_opaque",
                                        "force_no_opaque", NULL};
static const uint32_t flag_bit[] = {ABI_INSTANCE_CULL_DISABLE, ABI_INSTANCE_FLIP_FACING,
                                    ABI_INSTANCE_FORCE_OPAQUE, ABI_INSTANCE_FORCE_NO_OPAQUE};

_Static_assert(ARRAY_COUNT(flag_word) - 1 == ARRAY_COUNT(flag_bit), "each flag has a word");
_Static_assert(ABI_INSTANCE_FLAGS == 15, "every flag has a word");

static const char *const filter_word[] = {[FILTER_ALL] = "all",
                                          [FILTER_NONE] = "none",
                                          [FILTER_TRIANGLES] = "triangles",
                                          [FILTER_CELLS] = "cells",
                                          NULL};

struct instance instance_default(void)
{
    return (struct instance){
        .m = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, .mesh = WORLD_NO_MESH, .mask = 0xFF};
}

static enum status take_u32(struct json_pull *pull, uint32_t most, uint32_t *out)
{
    uint64_t value;
    enum status status = json_pull_whole(pull, most, &value);
    *out = (uint32_t)value;
    return status;
}

enum status take_custom(struct json_pull *pull, void *self)
{
    return take_u32(pull, ABI_CUSTOM_MOST, &((struct instance *)self)->custom);
}

enum status take_mask(struct json_pull *pull, void *self)
{
    return take_u32(pull, 0xFF, &((struct instance *)self)->mask);
}

static enum status take_flag(struct json_pull *pull, void *self)
{
    struct instance *instance = self;
    unsigned which;
    enum status status = json_pull_word(pull, flag_word, &which);
    if (!status && (instance->flags & flag_bit[which]))
        status = json_pull_fail(pull, "'%s' is there twice", flag_word[which]);
    if (!status)
        instance->flags |= flag_bit[which];
    return status;
}

enum status take_flags(struct json_pull *pull, void *self)
{
    ((struct instance *)self)->flags = 0;
    return json_pull_array(pull, take_flag, self);
}

static enum status take_kind(struct json_pull *pull, void *self)
{
    unsigned kind;
    enum status status = json_pull_word(pull, filter_word, &kind);
    ((struct filter_rule *)self)->kind = (enum filter_kind)kind;
    return status;
}

static enum status take_seed(struct json_pull *pull, void *self)
{
    return take_u32(pull, UINT32_MAX, &((struct filter_rule *)self)->seed);
}

static enum status take_share(struct json_pull *pull, void *self)
{
    return take_u32(pull, 256, &((struct filter_rule *)self)->share);
}

enum status take_filter(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {
        {"kind", take_kind, true}, {"seed", take_seed, false}, {"share", take_share, false}, {0}};
    return json_pull_object(pull, members, self);
}

static const char *comma(bool *first)
{
    const char *text = *first ? "" : ", ";
    *first = false;
    return text;
}

bool put_instance_members(const struct instance *instance, bool first, FILE *stream)
{
    bool any = instance->custom != 0 || instance->mask != 0xFF || instance->flags != 0;
    if (instance->custom != 0)
        fprintf(stream, "%s\"custom\": %u", comma(&first), instance->custom);
    if (instance->mask != 0xFF)
        fprintf(stream, "%s\"mask\": %u", comma(&first), instance->mask);
    if (instance->flags == 0)
        return any;
    fprintf(stream, "%s\"flags\": [", comma(&first));
    bool first_flag = true;
    for (unsigned i = 0; i < ARRAY_COUNT(flag_bit); i++)
        if (instance->flags & flag_bit[i])
            fprintf(stream, "%s\"%s\"", comma(&first_flag), flag_word[i]);
    fputc(']', stream);
    return any;
}

bool filter_is_told(const struct filter_rule *filter)
{
    return filter->kind != FILTER_ALL || filter->seed != 0 || filter->share != 0;
}

void put_filter(const struct filter_rule *filter, FILE *stream)
{
    fprintf(stream, "{\"kind\": \"%s\", \"seed\": %u, \"share\": %u}", filter_word[filter->kind],
            filter->seed, filter->share);
}
