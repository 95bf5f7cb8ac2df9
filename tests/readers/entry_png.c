/* Pictures, each as it is and with its checksums made right: no mutation would get past those. */
#include "tests/readers/reader_entry.h"
#include "scenes/picture/image.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#define TWICE_MOST (1u << 16) /* pixels; larger ones are read once */

static uint32_t big_endian(const char *at)
{
    const unsigned char *byte = (const unsigned char *)at;
    return (uint32_t)byte[0] << 24 | (uint32_t)byte[1] << 16 | (uint32_t)byte[2] << 8 | byte[3];
}

/* Every chunk that is whole gets the checksum that its bytes have. */
static void checksums_right(char *bytes, size_t size)
{
    size_t at = 8;
    while (size >= 12 && at <= size - 12) {
        uint32_t length = big_endian(bytes + at);
        if (length > size - 12 - at)
            return;
        uint32_t sum = (uint32_t)crc32(0, (const Bytef *)bytes + at + 4, length + 4);
        for (unsigned k = 0; k < 4; k++)
            bytes[at + 8 + length + k] = (char)(unsigned char)(sum >> (24 - 8 * k));
        at += 12 + (size_t)length;
    }
}

static void must_be_image(const struct image *image, const char *path)
{
    const uint64_t count = (uint64_t)image->width * image->height;
    struct image again;
    struct reason reason = {""};
    READER_MUST(image->width >= 1 && image->width <= IMAGE_SIDE_MOST);
    READER_MUST(image->height >= 1 && image->height <= IMAGE_SIDE_MOST);
    READER_MUST(count <= IMAGE_PIXELS_MOST);
    if (count > TWICE_MOST)
        return;
    READER_MUST(image_read(path, &again, &reason) == STATUS_OK);
    READER_MUST(again.width == image->width && again.height == image->height);
    READER_MUST(memcmp(again.pixel, image->pixel, 4 * count) == 0);
    image_free(&again);
}

static bool play_bytes(const char *bytes, size_t size)
{
    char path[READER_PATH_MOST];
    struct image image;
    struct reason reason = {""};
    int file = reader_file(bytes, size, path);
    enum status status = image_read(path, &image, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status) {
        reader_must_be_reason(&reason);
        READER_MUST(!image.pixel && image.width == 0 && image.height == 0);
    } else {
        must_be_image(&image, path);
    }
    close(file);
    image_free(&image);
    return status == STATUS_OK;
}

static bool play(const char *bytes, size_t size)
{
    bool taken = play_bytes(bytes, size);
    char *right = malloc(size + 1);
    READER_MUST(right);
    memcpy(right, bytes, size + 1);
    checksums_right(right, size);
    if (memcmp(right, bytes, size) != 0)
        taken = play_bytes(right, size) || taken;
    free(right);
    return taken;
}

/* A kilobyte can be a picture of one colour with millions of pixels, see scenes/picture/image.h. */
const struct reader_entry reader_entry = {"png", (size_t)4 * IMAGE_PIXELS_MOST + (1 << 21), play};
