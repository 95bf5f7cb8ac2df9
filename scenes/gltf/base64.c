#include "scenes/gltf/gltf.h"

static const char letter[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/* The number of a letter; 64 if it is none. */
static unsigned number_of(char c)
{
    if (c >= 'A' && c <= 'Z')
        return (unsigned)(c - 'A');
    if (c >= 'a' && c <= 'z')
        return (unsigned)(c - 'a') + 26;
    if (c >= '0' && c <= '9')
        return (unsigned)(c - '0') + 52;
    return c == '+' ? 62 : c == '/' ? 63 : 64;
}

/* Decodes four letters, the last `padding` of which are '='. The bits that are left over are 0. */
static bool decode_four(const char *text, unsigned padding, char out[3])
{
    uint32_t bits = 0;
    for (unsigned i = 0; i < 4; i++) {
        unsigned number = i < 4 - padding ? number_of(text[i]) : 0;
        if (number == 64)
            return false;
        bits = bits << 6 | number;
    }
    for (unsigned i = 0; i < 3 - padding; i++)
        out[i] = (char)(bits >> (16 - 8 * i) & 0xFF);
    return (bits & ((UINT32_C(1) << (8 * padding)) - 1)) == 0;
}

bool base64_decode(const char *text, size_t size, char *out, size_t *out_size)
{
    *out_size = 0;
    if (size % 4 != 0)
        return false;
    for (size_t at = 0; at < size; at += 4) {
        unsigned padding = 0;
        if (at + 4 == size)
            padding = text[at + 3] != '=' ? 0 : text[at + 2] != '=' ? 1 : 2;
        if (!decode_four(text + at, padding, out + *out_size))
            return false;
        *out_size += 3 - padding;
    }
    return true;
}

void base64_encode(const unsigned char *bytes, size_t size, FILE *stream)
{
    for (size_t at = 0; at < size; at += 3) {
        size_t count = size - at < 3 ? size - at : 3;
        uint32_t bits = 0;
        for (size_t i = 0; i < 3; i++)
            bits = bits << 8 | (i < count ? bytes[at + i] : 0u);
        for (unsigned i = 0; i < 4; i++)
            fputc(i <= count ? letter[bits >> (18 - 6 * i) & 63] : '=', stream);
    }
}
