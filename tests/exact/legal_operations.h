/* What legal.c and legal_formulas.c share; private to them. */
#ifndef LEGAL_OPERATIONS_H
#define LEGAL_OPERATIONS_H

#include "tests/exact/legal.h"

float legal_sub(struct legal *l, float a, float b);

float legal_seen(struct legal *l, float x);

void legal_subtract(struct legal *l, const float a[3], const float b[3], float out[3]);

void legal_cross(struct legal *l, const float a[3], const float b[3], float out[3]);

/* Ours add from the front, Embree from the back. */
float legal_dot(struct legal *l, const float a[3], const float b[3]);

float legal_dot_back(struct legal *l, const float a[3], const float b[3]);

#endif
