/* Judgements as text. */
#include "ref/base/decimal.h"
#include "ref/base/text.h"
#include "ref/judge/judge.h"

#include <stdio.h>

void judge_set_lost(struct judgement *out, uint32_t prim, double t_lo, double t_hi)
{
    out->behind = prim != out->expected;
    out->lost = prim;
    out->lost_lo = t_lo;
    out->lost_hi = t_hi;
}

#define HIT_LONGEST "prim=4294967295 t=-0x1.fffffep+127 u=-0x1.fffffep+127 v=-0x1.fffffep+127"

static void print_hit(const struct hit *hit, char *text, size_t text_bytes)
{
    if (hit->prim == ABI_NO_PRIM)
        snprintf(text, text_bytes, "miss");
    else
        snprintf(text, text_bytes, "prim=%u t=%a u=%a v=%a", (unsigned)hit->prim, (double)hit->t,
                 (double)hit->u, (double)hit->v);
}

static void print_line(const struct ray *ray, const struct hit *answer, const char *expected,
                       char *text, size_t text_bytes)
{
    char got[sizeof HIT_LONGEST];
    print_hit(answer, got, sizeof got);
    snprintf(text, text_bytes, "o=(%a,%a,%a) d=(%a,%a,%a) t=[%a,%a] => %s  expected: %s",
             (double)ray->org[0], (double)ray->org[1], (double)ray->org[2], (double)ray->dir[0],
             (double)ray->dir[1], (double)ray->dir[2], (double)ray->tmin, (double)ray->tmax, got,
             expected);
}

void judge_line(const struct ray *ray, const struct judgement *judgement, const struct hit *answer,
                char *text, size_t text_bytes)
{
    char expected[sizeof "prim=4294967295 t=, lost: prim=4294967295 t= displacement=-1.79e+308 uM" +
                  2 * DECIMAL_WITHIN_MOST] = "miss";
    char t[DECIMAL_WITHIN_MOST];
    decimal_within(judgement->t_lo, judgement->t_hi, t);
    if (judgement->expected != ABI_NO_PRIM)
        snprintf(expected, sizeof expected, "prim=%u t=%s", (unsigned)judgement->expected, t);
    decimal_within(judgement->lost_lo, judgement->lost_hi, t);
    if (judgement->behind)
        text_append(expected, sizeof expected, ", lost: prim=%u t=%s", (unsigned)judgement->lost,
                    t);
    if (judgement->over > 0.0)
        text_append(expected, sizeof expected, " err/E=%.3g", judgement->over);
    else if (judgement->displacement > 0.0)
        text_append(expected, sizeof expected, " displacement=%.3g uM", judgement->displacement);
    print_line(ray, answer, expected, text, text_bytes);
}

void judge_bits_line(const struct ray *ray, const struct hit *expected, const struct hit *answer,
                     char *text, size_t text_bytes)
{
    char want[sizeof HIT_LONGEST];
    print_hit(expected, want, sizeof want);
    print_line(ray, answer, want, text, text_bytes);
}
