/* A window on the screen, with SDL2. The library is loaded when a window is opened, so that
 * programs without windows do not need it. Its headers are needed at compile time; without them
 * window_open fails. Pictures are drawn by the CPU, without OpenGL. One window at a time, all calls
 * from one thread. */
#ifndef WINDOW_H
#define WINDOW_H

#include "scenes/picture/image.h"

struct window;

/* Events since the last call. */
struct window_news {
    bool quit;              /* Esc, the close button, or a terminating signal */
    bool redraw;            /* the window content was lost: show the picture again */
    uint32_t width, height; /* current size of the window */
    double turn_ms;         /* turning time of the arrow keys: see scenes/render/turning.h */
    bool turning;           /* an arrow key is held: wait only briefly */
};

/* Opens a window with an inside of width x height (cut to the screen by the window manager, if
 * there is one). *out is NULL on error. Errors: STATUS_UNSUPPORTED compiled without SDL2's headers,
 * no library, no display (the reason names it); STATUS_MEMORY. */
enum status window_open(const char *title, uint32_t width, uint32_t height, struct window **out,
                        struct reason *reason) MUST_USE;

/* Waits up to `most_ms` for an event (0: no wait), and reports all pending events. */
void window_wait(struct window *window, unsigned most_ms, struct window_news *out);

/* Shows a picture, stretched to the size of the window.
 * Errors: STATUS_DEVICE the window cannot be drawn to. */
enum status window_show(struct window *window, const struct image *image,
                        struct reason *reason) MUST_USE;

void window_title(struct window *window, const char *title);

void window_close(struct window *window); /* NULL is allowed */

#endif
