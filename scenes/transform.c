#include "scenes/transform.h"

#include <math.h>

#define PI 3.14159265358979323846

struct transform transform_identity(void)
{
    return (struct transform){.row = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
}

struct transform transform_then(const struct transform *first, const struct transform *second)
{
    if (!first->any || !second->any)
        return first->any ? *first : *second;
    struct transform both = {.mirrors = first->mirrors != second->mirrors, .any = true};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 4; k++)
            both.row[i][k] = second->row[i][0] * first->row[0][k] +
                             second->row[i][1] * first->row[1][k] +
                             second->row[i][2] * first->row[2][k];
        both.row[i][3] += second->row[i][3];
    }
    return both;
}

struct transform transform_translate(const float by[3])
{
    struct transform out = transform_identity();
    out.any = true;
    for (int k = 0; k < 3; k++)
        out.row[k][3] = (double)by[k];
    return out;
}

/* Sine and cosine of an angle in degrees, exact at multiples of 90. */
static void turn(float degrees, double *sine, double *cosine)
{
    static const double quarter[4][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}};
    double rest = fmod((double)degrees, 360); /* exact */
    rest += rest < 0 ? 360 : 0;
    if (fmod(rest, 90) == 0) {
        *sine = quarter[(int)(rest / 90) % 4][0];
        *cosine = quarter[(int)(rest / 90) % 4][1];
        return;
    }
    *sine = sin(rest * (PI / 180));
    *cosine = cos(rest * (PI / 180));
}

enum status transform_rotate(const float axis[3], float degrees, struct transform *out,
                             struct reason *reason)
{
    double a[3], length = 0, sine, cosine;
    *out = transform_identity();
    for (int k = 0; k < 3; k++) /* squares of floats neither overflow nor underflow in double */
        length += (double)axis[k] * (double)axis[k];
    if (!(length > 0))
        return fail(reason, STATUS_INPUT, "an axis of length 0");
    for (int k = 0; k < 3; k++)
        a[k] = (double)axis[k] / sqrt(length);
    turn(degrees, &sine, &cosine);
    out->any = true;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            /* cos I + (1 - cos) a a^T + sin [a]x. Off-diagonal entry (i, k) of [a]x is the
             * component of the third axis, with the sign of the permutation. */
            double cross = i == k ? 0 : (k + 1) % 3 == i ? a[(i + 1) % 3] : -a[(k + 1) % 3];
            out->row[i][k] = (i == k ? cosine : 0) + (1 - cosine) * a[i] * a[k] + sine * cross;
        }
    return STATUS_OK;
}

enum status transform_scale(const float by[3], struct transform *out, struct reason *reason)
{
    *out = transform_identity();
    for (int k = 0; k < 3; k++)
        if (by[k] == 0)
            return fail(reason, STATUS_INPUT, "a factor of 0 flattens the model");
    out->any = true;
    for (int k = 0; k < 3; k++) {
        out->row[k][k] = (double)by[k];
        out->mirrors ^= by[k] < 0;
    }
    return STATUS_OK;
}

enum status transform_matrix(const float number[16], struct transform *out, struct reason *reason)
{
    *out = transform_identity();
    if (number[12] != 0 || number[13] != 0 || number[14] != 0 || number[15] != 1)
        return fail(reason, STATUS_INPUT, "the last of the four rows must be 0 0 0 1");
    struct transform made = {.any = true};
    double(*m)[4] = made.row, largest = 1;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 4; k++)
            m[i][k] = (double)number[4 * i + k];
        largest *= sqrt(m[i][0] * m[i][0] + m[i][1] * m[i][1] + m[i][2] * m[i][2]);
    }
    double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) +
                         m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
                         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    if (!(fabs(determinant) > 0x1p-40 * largest))
        return fail(reason, STATUS_INPUT, "its determinant is 0: it flattens the model");
    made.mirrors = determinant < 0;
    *out = made;
    return STATUS_OK;
}

void transform_point(const struct transform *transform, const float in[3], float out[3])
{
    double p[3] = {(double)in[0], (double)in[1], (double)in[2]};
    for (int i = 0; i < 3 && transform->any; i++) {
        const double *row = transform->row[i];
        out[i] = (float)(row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
    }
    for (int i = 0; i < 3 && !transform->any; i++)
        out[i] = in[i];
}
