#include "scenes/picture/image.h"

#include "ref/files/file.h"

#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#define SIGNATURE_BYTES 8u

/* Deflate encodes at most 258 bytes in two bits, so a file holds at most 1032 bytes of rows for
 * each of its own bytes (RFC 1951, 3.2.5). */
#define DEFLATED_MOST 1032u

/* Checks the sides of an image; `label` starts the error message. */
static enum status sides_check(const char *label, uint32_t width, uint32_t height,
                               struct reason *reason)
{
    if (width == 0 || height == 0 || width > IMAGE_SIDE_MOST || height > IMAGE_SIDE_MOST)
        return fail(reason, STATUS_INPUT, "%s: %u x %u pixels: sides are 1 to %u", label, width,
                    height, IMAGE_SIDE_MOST);
    if ((uint64_t)width * height > IMAGE_PIXELS_MOST)
        return fail(reason, STATUS_INPUT, "%s: %u x %u pixels: at most %u are allowed", label,
                    width, height, IMAGE_PIXELS_MOST);
    return STATUS_OK;
}

enum status image_make(uint32_t width, uint32_t height, struct image *out, struct reason *reason)
{
    *out = (struct image){0};
    enum status status = sides_check("picture", width, height, reason);
    if (status != STATUS_OK)
        return status;
    const size_t count = (size_t)width * height;
    out->pixel = malloc(4 * count);
    if (!out->pixel)
        return fail(reason, STATUS_MEMORY, "no memory for a picture of %u x %u", width, height);
    for (size_t i = 0; i < count; i++)
        out->pixel[i] = image_rgb(0, 0, 0);
    out->width = width;
    out->height = height;
    return STATUS_OK;
}

void image_free(struct image *image)
{
    free(image->pixel);
    *image = (struct image){0};
}

/* A PNG file being read or written. On an error libpng writes its message to `why` and jumps to
 * `left`. State used after the longjmp is kept here and not in local variables. */
struct passage {
    png_structp png;
    png_infop info;
    jmp_buf left;
    char why[120];
    const char *bytes; /* unread bytes */
    size_t size;
    png_bytep *row;
    enum status status; /* STATUS_OK: libpng failed, see `why` */
};

static void leave(png_structp png, png_const_charp why)
{
    struct passage *passage = png_get_error_ptr(png);
    snprintf(passage->why, sizeof passage->why, "%s", why);
    longjmp(passage->left, 1);
}

static void unheard(png_structp png, png_const_charp what)
{
    (void)png;
    (void)what;
}

static void take_bytes(png_structp png, png_bytep to, size_t size)
{
    struct passage *passage = png_get_io_ptr(png);
    if (size > passage->size)
        png_error(png, "cut short");
    memcpy(to, passage->bytes, size);
    passage->bytes += size;
    passage->size -= size;
}

/* Skips all chunks that do not change pixel values, gamma and profiles included. A damaged chunk is
 * still an error. */
static void set_up_reading(struct passage *passage)
{
    static const png_byte skipped[] = "bKGD\0cHRM\0eXIf\0gAMA\0hIST\0iCCP\0iTXt\0oFFs\0pCAL\0pHYs\0"
                                      "sBIT\0sCAL\0sPLT\0sRGB\0sTER\0tEXt\0tIME\0zTXt";
    png_structp png = passage->png;
    png_set_read_fn(png, passage, take_bytes);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, skipped, sizeof skipped / 5);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); /* sides_check checks the sides */
}

/* Converts every kind of PNG to four bytes per pixel. */
static void set_up_rows(png_structp png)
{
    png_set_expand(png); /* palettes, grays below 8 bits, transparent colours */
    png_set_scale_16(png);
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
}

/* After the header: checks the sides and that the file can hold the rows; allocates the image. */
static enum status make_room(const struct passage *passage, size_t file_size, const char *label,
                             struct image *out, struct reason *reason)
{
    uint32_t width = png_get_image_width(passage->png, passage->info);
    uint32_t height = png_get_image_height(passage->png, passage->info);
    enum status status = sides_check(label, width, height, reason);
    if (status != STATUS_OK)
        return status;
    uint64_t bits = (uint64_t)png_get_channels(passage->png, passage->info) *
                    png_get_bit_depth(passage->png, passage->info);
    if (bits * width * height / 8 > (uint64_t)DEFLATED_MOST * file_size)
        return fail(reason, STATUS_INPUT, "%s: is cut short: %zu bytes cannot hold %u x %u pixels",
                    label, file_size, width, height);
    return image_make(width, height, out, reason);
}

/* Converts the bytes of the rows to pixel values in place. */
static void rows_to_pixels(struct image *image)
{
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        unsigned char byte[4];
        memcpy(byte, &image->pixel[i], 4);
        image->pixel[i] = (image_rgb(byte[0], byte[1], byte[2]) & 0xFFFFFFu) | (uint32_t)byte[3]
                                                                                   << 24;
    }
}

/* True if everything was read. Else passage->status has the error, or passage->why if that is
 * STATUS_OK. */
static bool read_rows(struct passage *passage, const char *label, struct image *out,
                      struct reason *reason)
{
    const size_t file_size = passage->size;
    if (setjmp(passage->left))
        return false;
    set_up_reading(passage);
    png_read_info(passage->png, passage->info);
    passage->status = make_room(passage, file_size, label, out, reason);
    if (passage->status != STATUS_OK)
        return false;
    set_up_rows(passage->png);
    (void)png_set_interlace_handling(passage->png);
    png_read_update_info(passage->png, passage->info);
    passage->row = alloc_zeroed(out->height, sizeof *passage->row);
    if (!passage->row || png_get_rowbytes(passage->png, passage->info) != (size_t)4 * out->width) {
        passage->status = fail(reason, passage->row ? STATUS_INTERNAL : STATUS_MEMORY,
                               "%s: no memory for its rows", label);
        return false;
    }
    for (uint32_t y = 0; y < out->height; y++)
        passage->row[y] = (png_bytep)(out->pixel + (size_t)y * out->width);
    png_read_image(passage->png, passage->row);
    png_read_end(passage->png, NULL);
    rows_to_pixels(out);
    return true;
}

static enum status read_png(const char *label, const char *bytes, size_t size, struct image *out,
                            struct reason *reason)
{
    if (size < SIGNATURE_BYTES || png_sig_cmp((png_const_bytep)bytes, 0, SIGNATURE_BYTES) != 0)
        return fail(reason, STATUS_INPUT, "%s: is no PNG file", label);
    struct passage passage = {.bytes = bytes, .size = size};
    passage.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &passage, leave, unheard);
    if (passage.png)
        passage.info = png_create_info_struct(passage.png);
    enum status status;
    if (!passage.info)
        status = fail(reason, STATUS_MEMORY, "%s: no memory to read it", label);
    else if (read_rows(&passage, label, out, reason))
        status = STATUS_OK;
    else if (passage.status != STATUS_OK)
        status = passage.status;
    else
        status = fail(reason, STATUS_INPUT, "%s: damaged PNG file: %s", label, passage.why);
    png_destroy_read_struct(&passage.png, &passage.info, NULL);
    free(passage.row);
    if (status != STATUS_OK)
        image_free(out);
    return status;
}

enum status image_read(const char *path, struct image *out, struct reason *reason)
{
    char *bytes;
    size_t size;
    *out = (struct image){0};
    enum status status = file_read(path, &bytes, &size, reason);
    if (status != STATUS_OK)
        return status;
    status = read_png(file_label(path), bytes, size, out, reason);
    free(bytes);
    return status;
}

static bool is_opaque(const struct image *image)
{
    for (size_t i = 0; i < (size_t)image->width * image->height; i++)
        if (image->pixel[i] >> 24 != 255)
            return false;
    return true;
}

/* Writes a row of pixels as bytes, `channels` per pixel. */
static void put_row(const uint32_t *pixel, uint32_t width, unsigned channels, png_bytep row)
{
    for (uint32_t x = 0; x < width; x++)
        for (unsigned k = 0; k < channels; k++)
            row[(size_t)x * channels + k] = (png_byte)(pixel[x] >> 8 * k);
}

/* False if libpng failed. Writes only necessary chunks: no time and no gamma. */
static bool write_rows(struct passage *passage, const struct image *image, unsigned channels,
                       png_bytep row, FILE *stream)
{
    if (setjmp(passage->left))
        return false;
    png_init_io(passage->png, stream);
    png_set_compression_level(passage->png, 6);
    png_set_IHDR(passage->png, passage->info, image->width, image->height, 8,
                 channels == 4 ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(passage->png, passage->info);
    for (uint32_t y = 0; y < image->height; y++) {
        put_row(image->pixel + (size_t)y * image->width, image->width, channels, row);
        png_write_row(passage->png, row);
    }
    png_write_end(passage->png, NULL);
    return true;
}

enum status image_write(const char *path, const struct image *image, struct reason *reason)
{
    const unsigned channels = is_opaque(image) ? 3 : 4;
    struct file_out out;
    enum status status = file_out_open(path, &out, reason);
    if (status != STATUS_OK)
        return status;
    struct passage passage = {0};
    png_bytep row = alloc_zeroed(image->width, channels);
    passage.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &passage, leave, unheard);
    if (passage.png)
        passage.info = png_create_info_struct(passage.png);
    if (!row || !passage.info)
        status = fail(reason, STATUS_MEMORY, "%s: no memory to write it", file_label(path));
    else if (!write_rows(&passage, image, channels, row, out.stream))
        status = fail(reason, STATUS_INPUT, "%s: cannot write: %s", file_label(path), passage.why);
    png_destroy_write_struct(&passage.png, &passage.info);
    free(row);
    if (status == STATUS_OK)
        return file_out_commit(&out, reason);
    file_out_discard(&out);
    return status;
}
