#include "ref/base/ray_text.h"

#include "ref/base/decimal.h"
#include "ref/base/float_word.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *float_text_read(const char *text, float *out)
{
    const char *from = text + (*text == '-' || *text == '+'), *rule;
    if (strncmp(from, "nan", 3) == 0 && from[3] != ':') { /* any NaN */
        *out = *text == '-' ? -NAN : NAN;
        return from + 3;
    }
    if (from[0] == 'i' || (from[0] == '0' && (from[1] == 'x' || from[1] == 'X')))
        return float_word_read(text, out, &rule);
    return decimal_read_float(text, out); /* infinite if out of range, which a ray may be */
}

static bool is_separator(char c)
{
    return c == ' ' || c == ',' || c == '\t';
}

enum status ray_text_read(const char *text, float tmax, struct ray *out, struct reason *reason)
{
    float value[8];
    int count = 0;
    const char *at = text;
    *out = (struct ray){.tmax = tmax};
    while (is_separator(*at))
        at++;
    while (*at) {
        const char *end = count < 8 ? float_text_read(at, &value[count]) : NULL;
        if (!end || (*end && !is_separator(*end)))
            return fail(reason, STATUS_INPUT,
                        count < 8 ? "ray: '%.40s' does not begin with a float32 number"
                                  : "ray: '%.40s' is beyond its eighth number",
                        at);
        count++;
        for (at = end; is_separator(*at); at++) {
        }
    }
    if (count != 6 && count != 8)
        return fail(reason, STATUS_INPUT,
                    "ray: %d numbers; needed are origin and direction, then perhaps tmin and tmax",
                    count);
    memcpy(out->org, value, sizeof out->org);
    memcpy(out->dir, value + 3, sizeof out->dir);
    if (count == 8) {
        out->tmin = value[6];
        out->tmax = value[7];
    }
    return STATUS_OK;
}

void float_text_write(float x, char text[32])
{
    if (isnan(x))
        snprintf(text, 32, "nan");
    else
        snprintf(text, 32, "%a", (double)x);
}

size_t ray_text_write(const struct ray *ray, char text[RAY_TEXT_MOST])
{
    char n[8][32];
    const float value[8] = {ray->org[0], ray->org[1], ray->org[2], ray->dir[0],
                            ray->dir[1], ray->dir[2], ray->tmin,   ray->tmax};
    for (int i = 0; i < 8; i++)
        float_text_write(value[i], n[i]);
    int length = snprintf(text, RAY_TEXT_MOST, "%s,%s,%s %s,%s,%s %s,%s", n[0], n[1], n[2], n[3],
                          n[4], n[5], n[6], n[7]);
    return length < 0 ? 0 : (size_t)length;
}
