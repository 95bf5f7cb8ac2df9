/* A compiler that breaks one thing: reads SPIR-V from its standard input, writes it to its standard
 * output. It uses nothing of raydiff.
 *   spirv_pass copy          changes nothing
 *   spirv_pass drop          NoContraction of the first multiplication is lost
 *   spirv_pass reassociate   (a + b) + c becomes a + (b + c), in each sum of three
 *   spirv_pass contract      a * b + c becomes fma(a, b, c), in the first such sum
 *   spirv_pass fuse          the same in the first such sum that nothing forbids: neither it nor
 *                            the product has NoContraction
 *   spirv_pass swap          a - b becomes b - a, in each difference
 *   spirv_pass mark          gives the first multiplication a name, "act"
 *   spirv_pass act           NoContraction of what has that name is lost
 *   spirv_pass odd           reassociates, names a multiplication "odd", and has a bound of ids
 *                            that tells: with that bound and without the name the driver of
 *                            tests/compilers/odd_layer.c crashes or hangs
 *   spirv_pass text          writes words of a language
 *   spirv_pass invalid       a module without its last instruction
 *   spirv_pass fails         writes nothing and ends with 3 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    NAME = 5,
    EXT_IMPORT = 11,
    EXT = 12,
    DECORATE = 71,
    FUNCTION = 54,
    FADD = 129,
    FSUB = 131,
    FMUL = 133
};
enum { NO_CONTRACTION = 42, FMA = 50, MOST = 1 << 20 };

static uint32_t in[MOST], out[2 * MOST];
static size_t in_count, out_count;

static uint32_t op_at(size_t at)
{
    return in[at] & 0xFFFFu;
}

static size_t length_at(size_t at)
{
    return in[at] >> 16;
}

static void put(const uint32_t *word, size_t count)
{
    memcpy(out + out_count, word, count * sizeof *word);
    out_count += count;
}

/* The first instruction `op` whose word `at` is `value`; `at` 0: whatever it is. 0: there is none.
 */
static size_t find(uint32_t op, size_t at, uint32_t value)
{
    for (size_t i = 5; i < in_count; i += length_at(i))
        if (op_at(i) == op && (at == 0 || (length_at(i) > at && in[i + at] == value)))
            return i;
    return 0;
}

static size_t maker_of(uint32_t op, uint32_t id)
{
    return find(op, 2, id);
}

/* "act" and "odd" with the zero behind them, as words. */
enum { ACT = 0x00746361, ODD = 0x0064646F, ODD_BOUND = 4000037 };

/* Names the instruction of an id, before all other names. */
static void name(uint32_t id, uint32_t text)
{
    const size_t first = find(NAME, 0, 0);
    for (size_t i = 5; i < in_count; i += length_at(i)) {
        if (i == first)
            put((const uint32_t[]){3u << 16 | NAME, id, text}, 3);
        put(in + i, length_at(i));
    }
}

/* What was put is read again. */
static void again(void)
{
    in_count = out_count;
    memcpy(in, out, in_count * sizeof *in);
    out_count = 0;
    put(in, 5);
}

static void drop(uint32_t id)
{
    for (size_t i = 5; i < in_count; i += length_at(i))
        if (!(op_at(i) == DECORATE && in[i + 1] == id && in[i + 2] == NO_CONTRACTION))
            put(in + i, length_at(i));
}

/* The new sums need decorations of their own, which are known once all sums are. */
static void reassociate(void)
{
    static uint32_t fresh[4096];
    size_t count = 0;
    uint32_t bound = in[3];
    for (size_t i = 5; i < in_count; i += length_at(i)) /* as many as there will be */
        if (op_at(i) == FADD && maker_of(FADD, in[i + 3]))
            fresh[count++] = bound++;
    const size_t first = find(DECORATE, 0, 0);
    for (size_t i = 5, next = 0; i < in_count; i += length_at(i)) {
        if (i == first)
            for (size_t k = 0; k < count; k++)
                put((const uint32_t[]){3u << 16 | DECORATE, fresh[k], NO_CONTRACTION}, 3);
        const size_t inner = op_at(i) == FADD ? maker_of(FADD, in[i + 3]) : 0;
        if (!inner) {
            put(in + i, length_at(i));
            continue;
        }
        const uint32_t id = fresh[next++];
        put((const uint32_t[]){5u << 16 | FADD, in[i + 1], id, in[inner + 4], in[i + 4]}, 5);
        put((const uint32_t[]){5u << 16 | FADD, in[i + 1], in[i + 2], in[inner + 3], id}, 5);
    }
    out[3] = bound;
}

static void act(void)
{
    const size_t named = find(NAME, 2, ACT);
    drop(named ? in[named + 1] : 0);
}

static void odd(void)
{
    name(in[find(FMUL, 0, 0) + 2], ODD);
    again();
    reassociate();
    out[3] = ODD_BOUND;
}

static void swap(void)
{
    for (size_t i = 5; i < in_count; i += length_at(i)) {
        put(in + i, length_at(i));
        if (op_at(i) == FSUB) {
            out[out_count - 2] = in[i + 4];
            out[out_count - 1] = in[i + 3];
        }
    }
}

static int is_pinned(size_t at)
{
    for (size_t i = 5; i < in_count; i += length_at(i))
        if (op_at(i) == DECORATE && in[i + 1] == in[at + 2] && in[i + 2] == NO_CONTRACTION)
            return 1;
    return 0;
}

static void contract(int allowed)
{
    size_t sum = 0, product = 0;
    for (size_t i = 5; i < in_count && !sum; i += length_at(i))
        if (op_at(i) == FADD && (product = maker_of(FMUL, in[i + 3])) != 0 &&
            !(allowed && (is_pinned(i) || is_pinned(product))))
            sum = i;
    if (!sum) {
        put(in + 5, in_count - 5);
        return;
    }
    const uint32_t set = in[find(EXT_IMPORT, 0, 0) + 1];
    for (size_t i = 5; i < in_count; i += length_at(i))
        if (i == sum)
            put((const uint32_t[]){8u << 16 | EXT, in[i + 1], in[i + 2], set, FMA, in[product + 3],
                                   in[product + 4], in[i + 4]},
                8);
        else if (!(op_at(i) == DECORATE && in[i + 1] == in[sum + 2]))
            put(in + i, length_at(i));
}

int main(int argc, char **argv)
{
    const char *what = argc > 1 ? argv[1] : "";
    in_count = fread(in, sizeof in[0], MOST, stdin);
    if (strcmp(what, "fails") == 0) {
        fprintf(stderr, "spirv_pass: on purpose\n");
        return 3;
    }
    if (strcmp(what, "text") == 0)
        return puts("void main() {}") < 0;
    put(in, 5);
    if (strcmp(what, "drop") == 0)
        drop(in[find(FMUL, 0, 0) + 2]);
    else if (strcmp(what, "swap") == 0)
        swap();
    else if (strcmp(what, "mark") == 0)
        name(in[find(FMUL, 0, 0) + 2], ACT);
    else if (strcmp(what, "act") == 0)
        act();
    else if (strcmp(what, "odd") == 0)
        odd();
    else if (strcmp(what, "reassociate") == 0)
        reassociate();
    else if (strcmp(what, "contract") == 0 || strcmp(what, "fuse") == 0)
        contract(strcmp(what, "fuse") == 0);
    else
        put(in + 5, in_count - 5 - (strcmp(what, "invalid") == 0));
    return fwrite(out, sizeof out[0], out_count, stdout) != out_count;
}
