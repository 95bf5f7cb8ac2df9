/* Selects a Vulkan driver: by name, by its JSON file, or any. Several drivers can be opened
 * one after the other in one process: the loader reads its environment anew for every instance. */
#ifndef VK_DRIVER_H
#define VK_DRIVER_H

#include "ref/base/base.h"

#define DRIVER_PATH_BYTES 1024u

enum driver_kind {
    DRIVER_ANY,      /* any that the loader finds */
    DRIVER_FILE,     /* that of one JSON file */
    DRIVER_HARDWARE, /* a device that is not a CPU */
    DRIVER_PART,     /* part of a driver's or device's name, in any case */
};

struct driver {
    enum driver_kind kind;
    const char *text;            /* as given; NULL: any */
    bool fetched;                /* lies in the folder of `make drivers` */
    char icd[DRIVER_PATH_BYTES]; /* DRIVER_FILE: its JSON file */
};

/* stock, mesa25, swiftshader, hardware; NULL-terminated. */
extern const char *const driver_names[];

/* What `text` means: a name of driver_names, a file (it has a '/' or ends in ".json"), else part of
 * a name; NULL is any. `stock` is the system's lavapipe; mesa25 and swiftshader lie where `make
 * drivers` put them: in $RAYDIFF_DRIVERS, else in drivers/ beside the program or up to three
 * folders above, else in build/drivers. `text` is borrowed.
 * Errors: STATUS_UNSUPPORTED driver or file not found (the reason contains the remedy). */
enum status driver_find(const char *text, struct driver *out, struct reason *reason) MUST_USE;

/* Writes "package version" of a fetched driver, comma-separated, as recorded when it was fetched;
 * empty if nothing is known. */
void driver_version(const struct driver *driver, char *text, size_t text_bytes);

/* What driver_begin changed. */
struct driver_scope {
    bool active;
    char *files, *filenames; /* earlier values; NULL: unset */
};

/* Makes the loader see only this driver until driver_end (DRIVER_FILE; else does nothing): sets
 * VK_DRIVER_FILES and VK_ICD_FILENAMES, and loads the libraries that were fetched with the driver
 * first, so that it finds them and not the system's. They stay loaded; of two libraries of one name
 * a process keeps the first. Changes the environment: no other thread may read it meanwhile.
 * Errors: STATUS_MEMORY. */
enum status driver_begin(const struct driver *driver, struct driver_scope *scope,
                         struct reason *reason) MUST_USE;
void driver_end(struct driver_scope *scope);

#endif
