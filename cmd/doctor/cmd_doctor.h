/* Results of `raydiff doctor`, for text and JSON. For commands only. */
#ifndef CMD_DOCTOR_H
#define CMD_DOCTOR_H

#include "gpu/card/card.h"
#include "ref/engine.h"

#define DOCTOR_MOST 16u

struct doctor_engine {
    const struct engine *engine;
    enum status status;
    struct reason reason; /* why it does not run */
    char text[4096];      /* versions, devices */
};

struct doctor_driver {
    const char *name;
    enum status status;
    struct reason reason;
    char version[256]; /* packages it was fetched from, or "" */
    struct card card;  /* valid if the status is OK */
};

struct doctor {
    struct doctor_engine engine[DOCTOR_MOST];
    size_t engine_count;
    struct doctor_driver driver[DOCTOR_MOST];
    size_t driver_count;
};

/* Writes the results as JSON to a temporary file and renames it. Errors: STATUS_INPUT cannot write;
 * STATUS_MEMORY. */
enum status doctor_write_json(const char *path, const struct doctor *doctor,
                              struct reason *reason) MUST_USE;

#endif
