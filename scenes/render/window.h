/* A window on the screen, by SDL2: its library is opened when a window is asked for, so that a
 * program without windows needs none, and its headers only where they were when this was compiled.
 * Pictures are drawn by the processor; no OpenGL. One window at a time, all calls from one thread.
 */
#ifndef WINDOW_H
#define WINDOW_H

#include "scenes/picture/image.h"

struct window;

/* What happened since the last call. */
struct window_news {
    bool quit;              /* Esc, the close button, or a signal that ends programs */
    bool redraw;            /* what is on the screen was lost: show the picture again */
    uint32_t width, height; /* of the window, now */
    double turn_ms;         /* arrow keys: see scenes/render/turning.h */
    bool turning;           /* one of them is held: do not wait long */
};

/* Opens a window whose inside has that size (cut to the screen by the window manager, if there is
 * one). *out is NULL on error. Errors: STATUS_UNSUPPORTED compiled without SDL2's headers, no
 * library, no display (the reason says which). */
enum status window_open(const char *title, uint32_t width, uint32_t height, struct window **out,
                        struct reason *reason) MUST_USE;

/* Waits for an event, `most_ms` at most (0: only looks), and reports all events. */
void window_wait(struct window *window, unsigned most_ms, struct window_news *out);

/* Shows a picture, stretched where the window has another size.
 * Errors: STATUS_DEVICE the window cannot be drawn to. */
enum status window_show(struct window *window, const struct image *image,
                        struct reason *reason) MUST_USE;

void window_title(struct window *window, const char *title);

void window_close(struct window *window); /* NULL is fine */

#endif
