/* Members that are wrong on purpose: layouts and engines outside the tables, each with one known
 * defect and otherwise equal to one in the tables. */
#ifndef HARD_MADE_H
#define HARD_MADE_H

#include "ref/engine.h"

/* rf16 with bounds rounded to the nearest half instead of outward. */
extern const struct layout layout_rf16_nearest;
/* rtrs_rf with item k naming triangle k: what is left of its faults without F2. */
extern const struct layout layout_rtrs_rf_unshifted;
/* cpu, but of a leaf's accepted triangles the last wins (the paper's Figure 7); one leaf only. */
extern const struct engine engine_last_wins;
/* cpu with the far plane of every box times 1.00000024. */
extern const struct engine engine_padded_4u;

#endif
