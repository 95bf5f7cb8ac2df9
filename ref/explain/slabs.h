/* The box tests of ref/primitives/slab.h with a switch for each of their properties: to replay a
 * ray with one of them repaired or broken. With the properties of slab_rule_of the results have the
 * same bits, `plain` or not (tests/explain/test_explain_replay.c). */
#ifndef EXPLAIN_SLABS_H
#define EXPLAIN_SLABS_H

#include "ref/primitives/primitives.h"
#include "ref/primitives/test_run.h"

enum slab_form {
    SLAB_FORM_PLAIN, /* (b - o) * (1 / d); rtrs: (b -+ eps - o) / d */
    SLAB_FORM_FUSED, /* fma(b, 1 / d, -(o * (1 / d))) */
    SLAB_FORM_SPLIT, /* b * (1 / d) - o * (1 / d) */
};

struct slab_rule {
    uint32_t id;         /* ABI_BOX_* */
    bool plain;          /* nothing is changed: box_test_run itself is called */
    bool closed;         /* <=, else < */
    bool by_order;       /* an axis of direction 0 is decided by comparison; all but rtrs do */
    float far;           /* factor of the far plane */
    float near;          /* factor of the entry; not rtrs */
    float behind;        /* share of the scene's reach behind the origin; not rtrs */
    enum slab_form form; /* not rtrs */
};

/* The properties of box test `id` in this program, found by running it. A caller that changes one
 * clears `plain`. */
struct slab_rule slab_rule_of(uint32_t id);

/* As slab_ray_place, with the rule. */
void slab_rule_place(const struct slab_rule *rule, struct slab_ray *r, const struct box *bounds);

/* As box_test_run, with the rule. */
bool slab_by_rule(const struct slab_rule *rule, const struct slab_ray *r, const struct box *box,
                  float tbest, float *entry);

/* True whenever the exact ray meets the box at a t in [tmin, tbest], whatever the direction; in
 * double, padded. *entry is at most the exact entry distance, but at least tmin. */
bool slab_conservative(const struct slab_ray *r, const struct box *box, float tbest, float *entry);

/* One axis, as the test computes it and to double precision. A parallel axis has -infinity to
 * infinity if the origin lies between the planes, else infinity to -infinity. */
struct slab_axis {
    float enter, leave; /* `leave` with the far factor */
    double exact_enter, exact_leave;
};

void slab_axis_of(const struct slab_rule *rule, const struct slab_ray *r, const struct box *box,
                  int axis, struct slab_axis *out);

#endif
