/* Selects a Vulkan driver: by name, by its JSON file, or any. A process can open several drivers
 * one after the other, as the loader reads its environment for every instance. */
#ifndef VK_DRIVER_H
#define VK_DRIVER_H

#include "ref/base/base.h"

#define DRIVER_PATH_BYTES 1024u

enum driver_kind {
    DRIVER_ANY,      /* any that the loader finds */
    DRIVER_FILE,     /* the driver of one JSON file */
    DRIVER_HARDWARE, /* a device that is not a CPU */
    DRIVER_PART,     /* part of a driver's or device's name, in any case */
};

struct driver {
    enum driver_kind kind;
    const char *text;            /* as given; NULL: any */
    bool fetched;                /* in the folder of `make drivers` */
    char icd[DRIVER_PATH_BYTES]; /* DRIVER_FILE: its JSON file */
};

/* stock, mesa25, swiftshader, hardware; NULL-terminated. */
extern const char *const driver_names[];

/* Interprets `text`: a name in driver_names, a file (it contains '/' or ends in ".json"), else part
 * of a name; NULL is any. `stock` is the system's lavapipe. mesa25 and swiftshader are where `make
 * drivers` put them: in $RAYDIFF_DRIVERS, else in drivers/ beside the program or up to three
 * folders above, else in build/drivers. `text` is borrowed.
 * Errors: STATUS_UNSUPPORTED driver or file not found (the reason contains the remedy). */
enum status driver_find(const char *text, struct driver *out, struct reason *reason) MUST_USE;

/* Writes the folder `name` of what was fetched for the program: that of the environment's
 * `variable`, else the first beside the program or up to three folders above that has the file
 * `sign`, else build/NAME. */
void driver_folder(const char *variable, const char *name, const char *sign,
                   char out[DRIVER_PATH_BYTES]);

/* Writes "package version" of a fetched driver, comma-separated, as recorded when it was fetched.
 * Empty if not known. */
void driver_version(const struct driver *driver, char *text, size_t text_bytes);

/* The changes of driver_begin. */
struct driver_scope {
    bool active;
    char *files, *filenames; /* earlier values; NULL: unset */
};

/* For DRIVER_FILE, makes the loader use only this driver until driver_end; else does nothing. Sets
 * VK_DRIVER_FILES and VK_ICD_FILENAMES. First loads the libraries that were fetched with the
 * driver, so that it uses them instead of the system's. They stay loaded, and of two libraries with
 * one name a process keeps the first. Changes the environment: no other thread may read it
 * meanwhile. Errors: STATUS_MEMORY. */
enum status driver_begin(const struct driver *driver, struct driver_scope *scope,
                         struct reason *reason) MUST_USE;
void driver_end(struct driver_scope *scope);

#endif
