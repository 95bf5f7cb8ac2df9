/* Functions of the portable kernels, on vector types of the compiler. Expects INLINE and
 * ref/fast/kernel/vectors.h. */
#ifndef FAST_VECTORS_PORTABLE_H
#define FAST_VECTORS_PORTABLE_H

#define SELECT(type, ints, chosen, a, b)                                                           \
    ((type)(((ints)(a) & (ints)(chosen)) | ((ints)(b) & ~(ints)(chosen))))

INLINE float4 max4(float4 a, float4 b)
{
    return SELECT(float4, int4, a > b, a, b);
}

INLINE float8 max8(float8 a, float8 b)
{
    return SELECT(float8, int8, a > b, a, b);
}

INLINE float8 min8(float8 a, float8 b)
{
    return SELECT(float8, int8, a < b, a, b);
}

INLINE float8 fma8(float8 a, float8 b, float8 c)
{
    return a * b + c;
}

INLINE float8 planes(const uint16_t *code)
{
    short8 v;
    memcpy(&v, code, sizeof v);
    return __builtin_convertvector(__builtin_convertvector(v, int8), float8);
}

INLINE float8 bytes(const uint8_t *from)
{
    byte8 v;
    memcpy(&v, from, sizeof v);
    return __builtin_convertvector(__builtin_convertvector(v, int8), float8);
}

INLINE uint32_t bits4(float4 v)
{
    uint32_t word[4], bits = 0;
    memcpy(word, &v, sizeof word);
    for (int i = 0; i < 4; i++)
        bits |= word[i] >> 31 << i;
    return bits;
}

INLINE uint32_t bits8(int8 v)
{
    const int8 weight = {1, 2, 4, 8, 16, 32, 64, 128};
    int8 w = v & weight;
    return (uint32_t)(w[0] | w[1] | w[2] | w[3] | w[4] | w[5] | w[6] | w[7]);
}

INLINE uint32_t less(float8 a, float8 b)
{
    return bits8(a < b);
}

INLINE uint32_t not_above(float8 a, float8 b)
{
    return bits8(a <= b);
}

INLINE uint32_t unequal(float8 a, float8 b)
{
    return bits8((a < b) | (a > b));
}

INLINE float4 permute4(float4 v, int4 order)
{
    return (float4){v[order[0]], v[order[1]], v[order[2]], v[order[3]]};
}

INLINE float8 lane8(float4 v, int k)
{
    return all8(v[k]);
}

INLINE float16 lane16(float4 v, int k)
{
    return (float16){0} + v[k];
}

INLINE float16 vertices(const uint32_t *row, uint32_t count)
{
    float v[16] = {0};
    float16 out;
    memcpy(v, row, count * sizeof *v);
    memcpy(&out, v, sizeof out);
    return out;
}

#ifdef FAST_TINY /* lanes: a code has 5 bits */

typedef int8 codes8;

INLINE uint32_t code_at(codes8 code, int i)
{
    return (uint32_t)code[i];
}

#else

typedef uint32_t codes8;

INLINE codes8 codes(uint32_t word)
{
    return word;
}

INLINE uint32_t code_at(codes8 code, int i)
{
    return code >> 4 * i;
}

#endif

INLINE float8 corners(float16 row, codes8 code, uint32_t count)
{
    (void)count;
    float v[16], out[8];
    float8 all;
    memcpy(v, &row, sizeof v);
    for (int i = 0; i < 8; i++)
        out[i] = v[code_at(code, i) & 15];
    memcpy(&all, out, sizeof all);
    return all;
}

#endif
