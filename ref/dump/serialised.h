/* What serialised acceleration structures of all Vulkan drivers have in common. For the files of
 * their readers.
 *
 * Little-endian. By the Vulkan standard such a structure begins with two UUIDs, of the driver and
 * of what it is compatible with, the size of all and that after deserialisation as 64-bit words,
 * the number of handles, and the handles, of 64 bits each. */
#ifndef SERIALISED_H
#define SERIALISED_H

#include "ref/dump/tree_dump.h"

#define SERIAL_UUID    16u
#define SERIAL_SIZE    32u /* words behind the UUIDs */
#define SERIAL_INNER   40u
#define SERIAL_COUNT   48u
#define SERIAL_HANDLES 56u

static inline uint32_t serial_word(const char *at)
{
    uint32_t value = 0;
    for (int i = 0; i < 4; i++)
        value |= (uint32_t)(unsigned char)at[i] << (8 * i);
    return value;
}

static inline uint64_t serial_long(const char *at)
{
    return serial_word(at) | (uint64_t)serial_word(at + 4) << 32;
}

static inline float serial_float(const char *at)
{
    return float_from_bits(serial_word(at));
}

/* A UUID as the text that it is, or in hexadecimal digits. Returns `text`. */
#define SERIAL_UUID_TEXT (2 * SERIAL_UUID + 1)
const char *serial_uuid_text(const char *at, char text[SERIAL_UUID_TEXT]);

/* "NAME: structure at byte N: ", and a rule. Returns STATUS_INPUT. */
enum status serial_fail(const char *name, uint64_t begin, struct reason *reason, const char *format,
                        ...) __attribute__((format(printf, 4, 5)));

/* A handle of a top level. */
struct serial_handle {
    uint64_t value; /* 0: of no tree */
    uint32_t first; /* in the file, the place where it comes first */
    uint32_t below; /* which of the trees that follow it is of */
};

/* Leaves each handle but 0 once, numbers them by where they first are, and sorts them by value.
 * Returns how many are left. */
uint32_t serial_handles(struct serial_handle *list, uint32_t count);

/* The handle with that value in what serial_handles left, or NULL. */
const struct serial_handle *serial_handle_find(const struct serial_handle *list, uint32_t count,
                                               uint64_t value);

#endif
