#include "scenes/spec.h"

#include "ref/base/decimal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

size_t spec_params(const struct param *param)
{
    size_t count = 0;
    while (count < GENERATOR_PARAMS && param[count].name)
        count++;
    return count;
}

bool spec_names(const char *spec, const char *name)
{
    size_t length = strcspn(spec, ":");
    return strlen(name) == length && memcmp(spec, name, length) == 0;
}

/* Appends `word` to a comma-separated list, truncated to `size`. */
static void append(char *text, size_t size, const char *word)
{
    size_t used = strlen(text);
    snprintf(text + used, size - used, "%s%s", used ? ", " : "", word);
}

static enum status unknown_param(const struct spec_maker *maker, const char *key, size_t length,
                                 struct reason *reason)
{
    char known[120] = "";
    for (size_t i = 0; i < spec_params(maker->param); i++)
        append(known, sizeof known, maker->param[i].name);
    append(known, sizeof known, "seed");
    return fail(reason, STATUS_INPUT, "%s: '%.*s' is no parameter; known are %s (as %s:NAME=VALUE)",
                maker->name, length > 40 ? 40 : (int)length, key, known, maker->name);
}

/* Reads the number of a param, which ends at the next comma. */
static enum status read_param(const struct spec_maker *maker, const struct param *param,
                              const char *text, double *value, struct reason *reason)
{
    size_t length = strcspn(text, ",");
    const char *end = decimal_read_double(text, value);
    if (end == text + length && *value >= param->least && *value <= param->most)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%s: %s=%.*s must be a number from %.9g to %.9g (%s)",
                maker->name, param->name, length > 40 ? 40 : (int)length, text, param->least,
                param->most, param->summary);
}

static enum status read_seed(const struct spec_maker *maker, const char *text, uint64_t *seed,
                             struct reason *reason)
{
    size_t length = strcspn(text, ",");
    uint64_t value = 0;
    bool good = length > 0;
    for (size_t i = 0; i < length && good; i++) {
        uint64_t digit = (uint64_t)(text[i] - '0');
        good = text[i] >= '0' && text[i] <= '9' && value <= (UINT64_MAX - digit) / 10;
        value = 10 * value + digit;
    }
    *seed = value;
    if (good)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%s: seed=%.*s must be a whole number from 0 to 2^64 - 1",
                maker->name, length > 40 ? 40 : (int)length, text);
}

/* Reads "key=value,key=value" into the values of the generator's params and the seed. */
static enum status read_params(const struct spec_maker *maker, const char *text, double *value,
                               uint64_t *seed, struct reason *reason)
{
    bool given[GENERATOR_PARAMS + 1] = {false}; /* the last is the seed */
    while (text) {
        size_t length = strcspn(text, "=,"), which = 0;
        for (; which < GENERATOR_PARAMS && maker->param[which].name; which++)
            if (strlen(maker->param[which].name) == length &&
                memcmp(text, maker->param[which].name, length) == 0)
                break;
        bool known = which < GENERATOR_PARAMS && maker->param[which].name;
        if (!known && length == 4 && memcmp(text, "seed", 4) == 0)
            which = GENERATOR_PARAMS;
        else if (!known)
            return unknown_param(maker, text, length, reason);
        const char *number = text[length] == '=' ? text + length + 1 : "";
        enum status status = which == GENERATOR_PARAMS ? read_seed(maker, number, seed, reason)
                                                       : read_param(maker, &maker->param[which],
                                                                    number, &value[which], reason);
        if (status)
            return status;
        if (given[which])
            return fail(reason, STATUS_INPUT, "%s: %.*s is given twice", maker->name, (int)length,
                        text);
        given[which] = true;
        text = strchr(text, ',');
        text = text ? text + 1 : NULL;
    }
    return STATUS_OK;
}

enum status spec_values(const struct spec_maker *maker, const char *spec, double *value,
                        uint64_t *seed, struct reason *reason)
{
    const char *params = strchr(spec, ':');
    for (size_t i = 0; i < GENERATOR_PARAMS; i++)
        value[i] = i < spec_params(maker->param) ? maker->param[i].value : 0;
    return params ? read_params(maker, params + 1, value, seed, reason) : STATUS_OK;
}

enum status spec_check(const struct spec_maker *maker, const double *value, struct reason *reason)
{
    for (size_t k = 0; k < spec_params(maker->param); k++) {
        const struct param *param = &maker->param[k];
        if (!(value[k] >= param->least && value[k] <= param->most)) /* also true for NaN */
            return fail(reason, STATUS_LIMIT, "%s: %s=%g, but it must lie in %g to %g", maker->name,
                        param->name, value[k], param->least, param->most);
        if (param->whole && floor(value[k]) != value[k])
            return fail(reason, STATUS_INPUT, "%s: %s=%g, but it must be a whole number",
                        maker->name, param->name, value[k]);
    }
    return STATUS_OK;
}
