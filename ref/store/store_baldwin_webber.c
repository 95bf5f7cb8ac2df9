/* Storage `baldwin_webber`: ten words per item: the nine coefficients of the transform (see
 * ref/primitives/tri_baldwin_webber.h), then the triangle's number in bits 0 - 29 and its axis in
 * the upper two. */
#include "ref/primitives/primitives.h"
#include "ref/store/rows.h"
#include "ref/primitives/test_run.h"
#include "ref/store.h"

#include <string.h>

static uint32_t row_of(float v[3][3])
{
    float m[9];
    uint32_t axis = (uint32_t)baldwin_webber_transform(v, m);
    memcpy(v, m, sizeof m);
    return axis;
}

static bool test(const struct packed *packed, uint32_t first, uint32_t slot, uint32_t tri_id,
                 const struct tri_ray *ray, struct hit *out)
{
    float m[9];
    const uint32_t *row = store_row(packed, first, slot);
    if (!row || row[STORE_ROW - 1] >> 30 > 2)
        return false;
    memcpy(m, row, sizeof m);
    return baldwin_webber_hit(ray, m, (int)(row[STORE_ROW - 1] >> 30), out) &&
           tri_in_range(tri_id, ray, out->t);
}

extern const struct tri_store tri_store_baldwin_webber;
const struct tri_store tri_store_baldwin_webber = {
    .name = "baldwin_webber",
    .summary = "nine coefficients and the number of each triangle, for that test",
    .id = ABI_STORE_BALDWIN_WEBBER,
    .tests = 1u << ABI_TRI_BALDWIN_WEBBER,
    .measure = store_rows_measure,
    .row = row_of,
    .write = store_rows_write,
    .item = store_rows_item,
    .test = test,
};
