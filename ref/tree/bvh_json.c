#include "ref/tree/bvh_json.h"

#include "ref/base/decimal.h"
#include "ref/base/json_text.h"

#include <jansson.h>
#include <math.h>

static void put_float3(FILE *stream, const char *key, const float x[3])
{
    fprintf(stream, "\"%s\":[", key);
    for (int k = 0; k < 3; k++) {
        char text[DECIMAL_TEXT] = "null";
        if (float_is_finite(x[k]))
            (void)decimal_write_float(x[k], text);
        fprintf(stream, "%s%s", k > 0 ? "," : "", text);
    }
    fputc(']', stream);
}

void bvh_json_write(const struct bvh *bvh, FILE *stream)
{
    fputs("{\"uniforms\":[", stream);
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        fprintf(stream, "%s{\"fst\":%u,\"snd\":%u,\"item_idx\":%u,\"item_count\":%u,\"bounds\":{",
                i > 0 ? "," : "", node->fst, node->snd, node->item_first, node->item_count);
        put_float3(stream, "min", node->bounds.lo);
        fputc(',', stream);
        put_float3(stream, "max", node->bounds.hi);
        fputs("}}", stream);
    }
    fputs("],\"indices\":[", stream);
    for (uint32_t i = 0; i < bvh->prim_count; i++)
        fprintf(stream, "%s%u", i > 0 ? "," : "", bvh->prim[i]);
    fputs("]}", stream);
}

/* A file being read, and its current element for error messages. */
struct reading {
    const char *name;
    const char *list; /* "uniforms" or "indices" */
    size_t index;
    struct reason *reason;
};

static enum status refuse(const struct reading *reading, const char *key, const char *rule)
{
    return fail(reading->reason, STATUS_INPUT, "%s: %s[%zu]%s%s: %s", reading->name, reading->list,
                reading->index, key ? "." : "", key ? key : "", rule);
}

static enum status get_u32(const struct reading *reading, const char *key, const json_t *value,
                           uint32_t *out)
{
    if (!json_is_integer(value) || json_integer_value(value) < 0 ||
        json_integer_value(value) > UINT32_MAX)
        return refuse(reading, key, "must be a whole number from 0 to 4294967295");
    *out = (uint32_t)json_integer_value(value);
    return STATUS_OK;
}

/* Returns the float for a number. jansson returns the double nearest to the text. That double may
 * be halfway between two floats although the text is not, so the float is chosen whose own text
 * reads as that double. */
static float float_of(double number)
{
    float nearest = (float)number;
    float other = nextafterf(nearest, (double)nearest < number ? INFINITY : -INFINITY);
    if (fabs(number - (double)nearest) != fabs((double)other - number))
        return nearest;
    char text[DECIMAL_TEXT];
    double reads;
    (void)decimal_write_float(other, text);
    return decimal_read_double(text, &reads) && reads == number ? other : nearest;
}

static enum status get_float3(const struct reading *reading, const char *key, const json_t *bounds,
                              float out[3])
{
    const json_t *three = json_object_get(bounds, key);
    if (!json_is_array(three) || json_array_size(three) != 3)
        return refuse(reading, key, "must be an array of exactly 3 numbers");
    for (size_t k = 0; k < 3; k++) {
        const json_t *value = json_array_get(three, k);
        if (!json_is_number(value))
            return refuse(reading, key, "must hold numbers only");
        double number = json_number_value(value);
        /* From this value on a double rounds to an infinite float. */
        if (!(fabs(number) < 0x1.ffffffp127))
            return refuse(reading, key, "is beyond the range of a 32-bit float");
        out[k] = number == (double)(float)number ? (float)number : float_of(number);
    }
    return STATUS_OK;
}

static enum status read_node(const struct reading *reading, const json_t *value,
                             struct bvh_node *node)
{
    struct {
        const char *key;
        uint32_t *out;
    } number[] = {{"fst", &node->fst},
                  {"snd", &node->snd},
                  {"item_idx", &node->item_first},
                  {"item_count", &node->item_count}};
    if (!json_is_object(value))
        return refuse(reading, NULL, "must be an object");
    enum status status = STATUS_OK;
    for (size_t i = 0; i < ARRAY_COUNT(number) && !status; i++)
        status =
            get_u32(reading, number[i].key, json_object_get(value, number[i].key), number[i].out);
    const json_t *bounds = json_object_get(value, "bounds");
    if (!status)
        status = get_float3(reading, "min", bounds, node->bounds.lo);
    if (!status)
        status = get_float3(reading, "max", bounds, node->bounds.hi);
    return status;
}

/* Finds the list `key` and allocates `size` bytes per element. */
static enum status get_list(const struct reading *reading, const json_t *file, const char *key,
                            size_t size, uint32_t *count, const json_t **list, void **memory)
{
    *list = json_object_get(file, key);
    if (!json_is_array(*list))
        return fail(reading->reason, STATUS_INPUT, "%s: %s: must be an array", reading->name, key);
    if (json_array_size(*list) > UINT32_MAX)
        return fail(reading->reason, STATUS_INPUT, "%s: %s: more than 4294967295 elements",
                    reading->name, key);
    *count = (uint32_t)json_array_size(*list);
    *memory = alloc_zeroed(*count, size);
    if (!*memory)
        return fail(reading->reason, STATUS_MEMORY, "%s: no memory for %u %s", reading->name,
                    *count, key);
    return STATUS_OK;
}

/* Returns the number of triangles of the tree. With more items than the scene has triangles some
 * are repeated, and the largest index determines the number. */
static uint32_t count_triangles(const struct bvh *bvh, const struct scene *scene)
{
    uint32_t count = 0;
    if (bvh->prim_count <= scene->tri_count)
        return bvh->prim_count;
    for (uint32_t i = 0; i < bvh->prim_count; i++)
        if (bvh->prim[i] >= count)
            count = bvh->prim[i] < bvh->prim_count ? bvh->prim[i] + 1 : bvh->prim_count;
    return count;
}

static enum status read_tree(struct reading *reading, const json_t *file, struct bvh *out)
{
    const json_t *list;
    void *memory = NULL;
    uint32_t count;
    reading->list = "uniforms";
    enum status status =
        get_list(reading, file, "uniforms", sizeof *out->node, &count, &list, &memory);
    if (status)
        return status;
    out->node = memory;
    out->node_count = count;
    for (uint32_t i = 0; i < count && !status; i++) {
        reading->index = i;
        status = read_node(reading, json_array_get(list, i), &out->node[i]);
    }
    if (status)
        return status;
    status = get_list(reading, file, "indices", sizeof *out->prim, &count, &list, &memory);
    if (status)
        return status;
    out->prim = memory;
    out->prim_count = count;
    reading->list = "indices";
    for (uint32_t i = 0; i < count && !status; i++) {
        reading->index = i;
        status = get_u32(reading, NULL, json_array_get(list, i), &out->prim[i]);
    }
    return status;
}

static enum status refuse_syntax(const char *name, json_error_t *error, struct reason *reason)
{
    if (json_error_code(error) == json_error_out_of_memory)
        return fail(reason, STATUS_MEMORY, "%s: no memory to parse the JSON text", name);
    return fail(reason, STATUS_INPUT, "%s: line %d, column %d: %s", name, error->line,
                error->column, error->text);
}

enum status bvh_json_read(const char *name, const char *bytes, size_t size,
                          const struct scene *scene, struct bvh *out, struct reason *reason)
{
    *out = (struct bvh){0};
    json_error_t error;
    if (!json_text_fits(bytes, size))
        return fail(reason, STATUS_INPUT, "%s: " JSON_TEXT_RULE, name);
    json_t *file = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, &error);
    if (!file)
        return refuse_syntax(name, &error, reason);
    struct reading reading = {.name = name, .reason = reason};
    enum status status = read_tree(&reading, file, out);
    json_decref(file);
    if (!status)
        out->tri_count = count_triangles(out, scene);
    struct reason rule;
    if (!status && (status = bvh_check_form(out, scene, &rule)) != STATUS_OK)
        (void)fail(reason, status, "%s: %s", name, rule.text);
    if (status)
        bvh_free(out);
    return status;
}
