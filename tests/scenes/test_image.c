/* Pictures in and out: every kind of PNG becomes the numbers that it holds, and nothing that is
 * cut, damaged or beyond the limits becomes a picture. The PNGs are put together here, chunk by
 * chunk. */
#define _GNU_SOURCE /* mkdtemp */
#include "scenes/picture/image.h"

#include "ref/base/rng.h"
#include "ref/files/file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/root.h"

#define SIGNATURE "\x89PNG\r\n\x1A\n"
enum { GRAY = 0, RGB = 2, PALETTE = 3, GRAY_ALPHA = 4, RGBA = 6 };

static struct reason reason;

struct bytes {
    unsigned char at[4096];
    size_t size;
};

static const char *in_folder(const char *name)
{
    static char path[300];
    snprintf(path, sizeof path, "%s/%s", root, name);
    return path;
}

static void put(const char *name, const void *bytes, size_t size)
{
    FILE *stream = fopen(in_folder(name), "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes, 1, size, stream), size);
    assert_int_equal(fclose(stream), 0);
}

static void add(struct bytes *out, const void *bytes, size_t size)
{
    assert_true(out->size + size <= sizeof out->at);
    memcpy(out->at + out->size, bytes, size);
    out->size += size;
}

static void add_word(struct bytes *out, uint32_t word)
{
    const unsigned char byte[4] = {(unsigned char)(word >> 24), (unsigned char)(word >> 16),
                                   (unsigned char)(word >> 8), (unsigned char)word};
    add(out, byte, 4);
}

static void add_chunk(struct bytes *out, const char *name, const void *bytes, size_t size)
{
    add_word(out, (uint32_t)size);
    size_t from = out->size;
    add(out, name, 4);
    add(out, bytes, size);
    add_word(out, (uint32_t)crc32(0, out->at + from, (uInt)(out->size - from)));
}

struct kind {
    uint32_t width, height;
    unsigned char depth, colour, interlaced;
};

static struct bytes begun(struct kind kind)
{
    struct bytes out = {.size = 0}, header = {.size = 0};
    add(&out, SIGNATURE, 8);
    add_word(&header, kind.width);
    add_word(&header, kind.height);
    const unsigned char rest[5] = {kind.depth, kind.colour, 0, 0, kind.interlaced};
    add(&header, rest, 5);
    add_chunk(&out, "IHDR", header.at, header.size);
    return out;
}

/* The rows, each with the byte of its filter, and the end. */
static void finish(struct bytes *out, const void *rows, size_t size)
{
    struct bytes zipped;
    uLongf zipped_size = sizeof zipped.at;
    assert_int_equal(compress(zipped.at, &zipped_size, rows, size), Z_OK);
    add_chunk(out, "IDAT", zipped.at, zipped_size);
    add_chunk(out, "IEND", "", 0);
}

static void expect_pixels(const struct bytes *png, uint32_t width, uint32_t height,
                          const uint32_t *pixel)
{
    struct image image;
    put("kind.png", png->at, png->size);
    if (image_read(in_folder("kind.png"), &image, &reason) != STATUS_OK)
        fail_msg("%s", reason.text);
    assert_int_equal(image.width, width);
    assert_int_equal(image.height, height);
    for (size_t i = 0; i < (size_t)width * height; i++)
        assert_int_equal(image.pixel[i], pixel[i]);
    image_free(&image);
    assert_null(image.pixel);
}

static void expect_reason(const char *name, const char *text)
{
    struct image image = {1, 1, NULL};
    reason.text[0] = '\0';
    assert_int_equal(image_read(in_folder(name), &image, &reason), STATUS_INPUT);
    assert_null(image.pixel);
    assert_int_equal(image.width + image.height, 0);
    assert_null(strchr(reason.text, '\n'));
    if (!strstr(reason.text, text) || !strstr(reason.text, name))
        fail_msg("'%s' without '%s' or '%s'", reason.text, text, name);
}

static uint32_t rgba(unsigned r, unsigned g, unsigned b, unsigned a)
{
    return r | g << 8 | b << 16 | (uint32_t)a << 24;
}

static void images_have_sides_within_limits(void **state)
{
    (void)state;
    struct image image;
    assert_int_equal(image_make(3, 2, &image, &reason), STATUS_OK);
    for (int i = 0; i < 6; i++)
        assert_int_equal(image.pixel[i], 0xFF000000u);
    image_free(&image);
    const uint32_t wrong[][2] = {{0, 1},
                                 {1, 0},
                                 {IMAGE_SIDE_MOST + 1, 1},
                                 {1, 0x80000001u},
                                 {IMAGE_SIDE_MOST, IMAGE_PIXELS_MOST / IMAGE_SIDE_MOST + 1}};
    for (size_t i = 0; i < ARRAY_COUNT(wrong); i++) {
        assert_int_equal(image_make(wrong[i][0], wrong[i][1], &image, &reason), STATUS_INPUT);
        assert_null(image.pixel);
    }
}

static void every_kind_becomes_its_numbers(void **state)
{
    (void)state;
    struct bytes png = begun((struct kind){2, 1, 8, RGB, 0});
    finish(&png, "\0\x01\x02\x03\xFF\x80\x00", 7);
    expect_pixels(&png, 2, 1, (uint32_t[]){image_rgb(1, 2, 3), image_rgb(255, 128, 0)});
    png = begun((struct kind){1, 2, 8, RGBA, 0});
    finish(&png, "\0\x01\x02\x03\x04\0\xFF\x80\x00\xFF", 10);
    expect_pixels(&png, 1, 2, (uint32_t[]){rgba(1, 2, 3, 4), image_rgb(255, 128, 0)});
    png = begun((struct kind){5, 1, 1, GRAY, 0});
    finish(&png, "\0\xB0", 2);
    expect_pixels(&png, 5, 1,
                  (uint32_t[]){image_rgb(255, 255, 255), image_rgb(0, 0, 0),
                               image_rgb(255, 255, 255), image_rgb(255, 255, 255),
                               image_rgb(0, 0, 0)});
    png = begun((struct kind){2, 1, 8, GRAY_ALPHA, 0});
    finish(&png, "\0\x10\x20\x30\xFF", 5);
    expect_pixels(&png, 2, 1, (uint32_t[]){rgba(16, 16, 16, 32), image_rgb(48, 48, 48)});
    png = begun((struct kind){3, 1, 2, PALETTE, 0});
    add_chunk(&png, "PLTE", "\x01\x02\x03\x0A\x0B\x0C\xFA\xFB\xFC", 9);
    add_chunk(&png, "tRNS", "\xFF\x07", 2);
    finish(&png, "\0\x18", 2); /* 0, 1, 2 */
    expect_pixels(&png, 3, 1,
                  (uint32_t[]){image_rgb(1, 2, 3), rgba(10, 11, 12, 7), image_rgb(250, 251, 252)});
    /* 16 bits are scaled: v * 255 / 65535 to nearest. */
    png = begun((struct kind){3, 1, 16, GRAY, 0});
    finish(&png, "\0\x00\x80\x00\x81\xFE\xFF", 7);
    expect_pixels(&png, 3, 1,
                  (uint32_t[]){image_rgb(0, 0, 0), image_rgb(1, 1, 1), image_rgb(254, 254, 254)});
    png = begun((struct kind){2, 1, 8, RGB, 0}); /* one colour is said to be transparent */
    add_chunk(&png, "tRNS", "\0\x01\0\x02\0\x03", 6);
    finish(&png, "\0\x01\x02\x03\x01\x02\x04", 7);
    expect_pixels(&png, 2, 1, (uint32_t[]){rgba(1, 2, 3, 0), image_rgb(1, 2, 4)});
}

static void interlaced_rows_come_to_their_place(void **state)
{
    (void)state;
    enum { SIDE = 9 };
    static const int pass[7][4] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                   {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
    unsigned char rows[200];
    size_t size = 0;
    for (int p = 0; p < 7; p++)
        for (int y = pass[p][1]; y < SIDE; y += pass[p][3]) {
            rows[size++] = 0;
            for (int x = pass[p][0]; x < SIDE; x += pass[p][2])
                rows[size++] = (unsigned char)(SIDE * y + x);
        }
    uint32_t pixel[SIDE * SIDE];
    for (unsigned i = 0; i < SIDE * SIDE; i++)
        pixel[i] = image_rgb(i, i, i);
    struct bytes png = begun((struct kind){SIDE, SIDE, 8, GRAY, 1});
    finish(&png, rows, size);
    expect_pixels(&png, SIDE, SIDE, pixel);
}

/* A file that says how its numbers are to be shown keeps them all the same. */
static void no_gamma_is_applied(void **state)
{
    (void)state;
    const uint32_t pixel[] = {image_rgb(1, 128, 250), image_rgb(64, 64, 64)};
    struct bytes png = begun((struct kind){2, 1, 8, RGB, 0});
    add_chunk(&png, "gAMA", "\x00\x01\x86\xA0", 4);
    add_chunk(&png, "sBIT", "\x04\x04\x04", 3);
    add_chunk(&png, "tEXt", "Comment\0words", 13);
    finish(&png, "\0\x01\x80\xFA\x40\x40\x40", 7);
    expect_pixels(&png, 2, 1, pixel);
    png = begun((struct kind){2, 1, 8, RGB, 0});
    add_chunk(&png, "sRGB", "\0", 1);
    finish(&png, "\0\x01\x80\xFA\x40\x40\x40", 7);
    expect_pixels(&png, 2, 1, pixel);
}

static struct bytes sample(void)
{
    struct bytes png = begun((struct kind){4, 4, 8, RGB, 0});
    add_chunk(&png, "tEXt", "Comment\0words", 13);
    unsigned char rows[4 * 13];
    for (size_t i = 0; i < sizeof rows; i++)
        rows[i] = (unsigned char)(i % 13 == 0 ? 0 : 7 * i);
    finish(&png, rows, sizeof rows);
    return png;
}

static void every_cut_and_damage_is_noticed(void **state)
{
    (void)state;
    struct bytes png = sample();
    for (size_t cut = 0; cut < png.size; cut++) {
        put("cut.png", png.at, cut);
        expect_reason("cut.png", cut == 0 ? "is empty" : cut < 8 ? "no PNG" : "cut short");
    }
    for (size_t i = 0; i < png.size; i++)
        for (int bit = 0; bit < 8; bit += 3) {
            png.at[i] ^= (unsigned char)(1 << bit);
            put("damaged.png", png.at, png.size);
            expect_reason("damaged.png", "");
            png.at[i] ^= (unsigned char)(1 << bit);
        }
    struct image image;
    add(&png, "what follows is not looked at", 29);
    put("tail.png", png.at, png.size);
    assert_int_equal(image_read(in_folder("tail.png"), &image, &reason), STATUS_OK);
    image_free(&image);
}

static void what_is_no_picture_is_refused(void **state)
{
    (void)state;
    put("text.png", "this is no picture", 18);
    expect_reason("text.png", "is no PNG file");
    put("empty.png", "", 0);
    expect_reason("empty.png", "is empty");
    expect_reason("missing.png", "No such file");
    assert_int_equal(mkdir(in_folder("folder.png"), 0700), 0);
    expect_reason("folder.png", "is a directory");
    struct bytes png = begun((struct kind){0, 1, 8, RGB, 0});
    finish(&png, "\0", 1);
    put("none.png", png.at, png.size);
    expect_reason("none.png", "damaged PNG file");
    png = begun((struct kind){2, 2, 8, RGB, 0}); /* a row is missing */
    finish(&png, "\0\x01\x02\x03\x04\x05\x06", 7);
    put("rows.png", png.at, png.size);
    expect_reason("rows.png", "damaged PNG file");
    png = begun((struct kind){1, 1, 8, PALETTE, 0});
    finish(&png, "\0\0", 2);
    put("palette.png", png.at, png.size);
    expect_reason("palette.png", "damaged PNG file");
}

static void sides_are_not_believed(void **state)
{
    (void)state;
    const struct {
        uint32_t width, height;
        const char *rule;
    } wrong[] = {{IMAGE_SIDE_MOST + 1, 1, "sides are 1 to 16384"},
                 {1, 0x7FFFFFFF, "sides are 1 to 16384"},
                 {0x7FFFFFFF, 0x7FFFFFFF, "sides are 1 to 16384"},
                 {IMAGE_SIDE_MOST, IMAGE_SIDE_MOST, "at most 67108864 are allowed"},
                 {8192, 8192, "bytes cannot hold 8192 x 8192"}};
    for (size_t i = 0; i < ARRAY_COUNT(wrong); i++) {
        struct bytes png = begun((struct kind){wrong[i].width, wrong[i].height, 8, RGB, 0});
        finish(&png, "\0\0\0\0", 4);
        put("huge.png", png.at, png.size);
        expect_reason("huge.png", wrong[i].rule);
    }
}

static void random_pixels(struct image *image, uint64_t seed, unsigned opaque)
{
    struct rng rng = rng_make(seed, 0);
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        image->pixel[i] = (uint32_t)rng_u64(&rng) | opaque;
        if (rng_below(&rng, 4) != 0 && i > 0) /* some runs */
            image->pixel[i] = image->pixel[i - 1];
    }
}

static void what_is_written_is_read_back(void **state)
{
    (void)state;
    const uint32_t sides[][2] = {{1, 1}, {7, 3}, {1, 1000}, {16384, 2}, {333, 100}};
    for (size_t i = 0; i < 2 * ARRAY_COUNT(sides); i++) {
        struct image image, again;
        const uint32_t *side = sides[i / 2];
        assert_int_equal(image_make(side[0], side[1], &image, &reason), STATUS_OK);
        random_pixels(&image, i, i % 2 ? 0 : 0xFF000000u);
        char *bytes[2];
        size_t size[2];
        for (int k = 0; k < 2; k++) { /* the same picture, the same bytes */
            assert_int_equal(image_write(in_folder("back.png"), &image, &reason), STATUS_OK);
            assert_int_equal(file_read(in_folder("back.png"), &bytes[k], &size[k], &reason),
                             STATUS_OK);
        }
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(bytes[0], bytes[1], size[0]);
        assert_int_equal(bytes[0][25], i % 2 ? RGBA : RGB);
        assert_int_equal(image_read(in_folder("back.png"), &again, &reason), STATUS_OK);
        assert_int_equal(again.width, image.width);
        assert_int_equal(again.height, image.height);
        assert_memory_equal(again.pixel, image.pixel, 4 * (size_t)image.width * image.height);
        for (int k = 0; k < 2; k++)
            free(bytes[k]);
        image_free(&image);
        image_free(&again);
    }
}

static void what_cannot_be_written_is_said(void **state)
{
    (void)state;
    struct image image;
    assert_int_equal(image_make(400, 400, &image, &reason), STATUS_OK);
    random_pixels(&image, 1, 0);
    assert_int_equal(image_write(in_folder("none/a.png"), &image, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "none/a.png: cannot write: No such file"));
    assert_int_equal(image_write(root, &image, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "is a directory"));
    assert_int_equal(image_write("/dev/full", &image, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "/dev/full: cannot write: "));
    image_free(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(images_have_sides_within_limits),
        cmocka_unit_test(every_kind_becomes_its_numbers),
        cmocka_unit_test(interlaced_rows_come_to_their_place),
        cmocka_unit_test(no_gamma_is_applied),
        cmocka_unit_test(every_cut_and_damage_is_noticed),
        cmocka_unit_test(what_is_no_picture_is_refused),
        cmocka_unit_test(sides_are_not_believed),
        cmocka_unit_test(what_is_written_is_read_back),
        cmocka_unit_test(what_cannot_be_written_is_said),
    };
    return cmocka_run_group_tests_name("image", tests, make_root, remove_root) ? 1 : 0;
}
