/* The window without a screen: keys and time, and what is said where no window can be. */
#define _GNU_SOURCE /* setenv */
#include "ref/files/file.h"
#include "scenes/render/turning.h"
#include "scenes/render/window.h"

#include "have_sdl2.h"

#if HAVE_SDL2
#include <SDL2/SDL.h>
#include <dlfcn.h>
#endif
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static double turned(struct turning *turning, uint32_t now)
{
    return turning_take(turning, now);
}

static void a_held_key_turns_by_time(void **state)
{
    (void)state;
    struct turning keys = {0};
    assert_true(turned(&keys, 500) == 0);
    turning_key(&keys, true, true, 1000);
    assert_true(turned(&keys, 1000) == 0);
    assert_true(turned(&keys, 1040) == 40);
    turning_key(&keys, true, true, 1050); /* repeats */
    assert_true(turned(&keys, 1060) == 20);
    turning_key(&keys, true, false, 1065);
    assert_true(turned(&keys, 2000) == 5);
    assert_true(turned(&keys, 3000) == 0);
    turning_key(&keys, false, true, 3000);
    assert_true(turned(&keys, 3100) == -100);
    turning_key(&keys, false, false, 3100);
    assert_true(turned(&keys, 9000) == 0);
}

static void left_wins_over_right(void **state)
{
    (void)state;
    struct turning keys = {0};
    turning_key(&keys, false, true, 100);
    turning_key(&keys, true, true, 130);
    assert_true(turned(&keys, 150) == 20 - 30);
    turning_key(&keys, true, false, 160);
    assert_true(turned(&keys, 200) == 10 - 40);
}

static void a_tap_is_seen(void **state)
{
    (void)state;
    struct turning keys = {0};
    turning_key(&keys, true, true, 100); /* both between two frames */
    turning_key(&keys, true, false, 100);
    assert_true(turned(&keys, 100) == TURNING_TAP_MS);
    turning_key(&keys, false, true, 200);
    turning_key(&keys, false, false, 204);
    assert_true(turned(&keys, 300) == -(double)TURNING_TAP_MS);
}

static void the_clock_wraps(void **state)
{
    (void)state;
    struct turning keys = {0};
    turning_key(&keys, true, true, UINT32_MAX - 4);
    assert_true(turned(&keys, 15) == 20);
}

static void a_turn_takes_two_seconds(void **state)
{
    (void)state;
    double seconds = 2 * 3.14159265358979 / TURNING_SPEED / 1000;
    assert_true(seconds > 2.0005 && seconds < 2.0015); /* RTRS's 2.001 s */
}

static void no_display_is_said(void **state)
{
    (void)state;
    struct reason reason = {""};
    struct window *window = (struct window *)&reason;
    assert_int_equal(setenv("SDL_VIDEODRIVER", "x11", 1), 0);
    assert_int_equal(setenv("DISPLAY", ":no-such-display", 1), 0);
    assert_int_equal(window_open("test", 64, 48, &window, &reason), STATUS_UNSUPPORTED);
    assert_null(window);
    assert_non_null(strstr(reason.text, "no window: "));
    assert_null(strchr(reason.text, '\n'));
    assert_int_equal(unsetenv("SDL_VIDEODRIVER"), 0);
    assert_int_equal(window_open("test", 64, 48, &window, &reason), STATUS_UNSUPPORTED);
    assert_int_equal(unsetenv("DISPLAY"), 0);
    assert_int_equal(unsetenv("WAYLAND_DISPLAY"), 0);
    assert_int_equal(window_open("test", 64, 48, &window, &reason), STATUS_UNSUPPORTED);
    assert_null(window);
    window_close(window);
}

/* SDL's own driver without a screen: opening, drawing and closing do not need one. */
static void a_window_without_a_screen(void **state)
{
    (void)state;
    struct reason reason = {""};
    struct window *window;
    struct window_news news;
    struct image image = {0};
    assert_int_equal(setenv("SDL_VIDEODRIVER", "dummy", 1), 0);
    enum status status = window_open("test", 64, 48, &window, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        skip();
    }
    assert_int_equal(status, STATUS_OK);
    assert_int_equal(image_make(32, 24, &image, &reason), STATUS_OK);
    window_title(window, "another");
    assert_int_equal(window_show(window, &image, &reason), STATUS_OK);
    window_wait(window, 0, &news);
    window_wait(window, 5, &news);
    assert_int_equal(news.width, 64);
    assert_int_equal(news.height, 48);
    assert_false(news.quit || news.turning);
    assert_true(news.turn_ms == 0);
    assert_int_equal(window_show(window, &image, &reason), STATUS_OK);
    window_close(window);
    image_free(&image);
    assert_int_equal(window_open("again", 64, 48, &window, &reason), STATUS_OK);
    window_close(window);
}

#if HAVE_SDL2
/* What is told of an event alone, and of it behind others. */
static void must_tell(struct window *window, int (*push)(SDL_Event *), const SDL_Event *event,
                      bool quit, bool redraw)
{
    for (int others = 0; others < 3; others++) {
        struct window_news news;
        SDL_Event moved = {.type = SDL_MOUSEMOTION}, one = *event;
        window_wait(window, 0, &news); /* what came of itself */
        for (int i = 0; i < others; i++)
            assert_int_equal(push(&moved), 1);
        assert_int_equal(push(&one), 1);
        for (int i = 0; i < others; i++)
            assert_int_equal(push(&moved), 1);
        window_wait(window, others == 1 ? 5 : 0, &news);
        if (news.quit != quit || news.redraw != redraw)
            fail_msg("event %x, %u: quit %d, redraw %d", event->type, event->window.event,
                     news.quit, news.redraw);
    }
}

/* Of what a window has lost, and of nothing else, it is told that it is to be drawn again. */
static void every_event_is_told(void **state)
{
    (void)state;
    struct reason reason = {""};
    struct window *window;
    int (*push)(SDL_Event *) = NULL;
    assert_int_equal(setenv("SDL_VIDEODRIVER", "dummy", 1), 0);
    if (window_open("test", 64, 48, &window, &reason) == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        skip();
    }
    void *library = dlopen("libSDL2-2.0.so.0", RTLD_NOW);
    assert_non_null(library);
    *(void **)&push = dlsym(library, "SDL_PushEvent");
    assert_non_null(push);
    SDL_Event event = {.type = SDL_QUIT};
    must_tell(window, push, &event, true, false);
    for (Uint8 what = SDL_WINDOWEVENT_SHOWN; what <= SDL_WINDOWEVENT_CLOSE; what++) {
        event = (SDL_Event){.type = SDL_WINDOWEVENT};
        event.window.event = what;
        must_tell(window, push, &event, false,
                  what == SDL_WINDOWEVENT_EXPOSED || what == SDL_WINDOWEVENT_SIZE_CHANGED);
    }
    for (int up = 0; up < 2; up++)
        for (SDL_Keycode key = SDLK_ESCAPE; key < SDLK_ESCAPE + 100; key++) {
            event = (SDL_Event){.type = up ? SDL_KEYUP : SDL_KEYDOWN};
            event.key.keysym.sym = key;
            must_tell(window, push, &event, key == SDLK_ESCAPE && !up, false);
        }
    window_close(window);
}
#endif

static uint32_t word_at(const char *bytes, size_t i)
{
    const unsigned char *at = (const unsigned char *)bytes + 4 * i;
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

/* RAYDIFF_SCREEN="FILE X Y PICTURE.png", see tests/scripts/window.sh: a screen as the X window dump
 * that Xvfb keeps, 32 bits a pixel, and a picture that must be at X, Y on it. */
static void the_screen_shows_the_picture(void **state)
{
    (void)state;
    char file[400], picture[400], *bytes;
    unsigned x, y;
    size_t size;
    struct image image;
    struct reason reason = {""};
    assert_int_equal(sscanf(getenv("RAYDIFF_SCREEN"), "%399s %u %u %399s", file, &x, &y, picture),
                     4);
    assert_int_equal(file_read(file, &bytes, &size, &reason), STATUS_OK);
    assert_int_equal(image_read(picture, &image, &reason), STATUS_OK);
    uint32_t header = word_at(bytes, 0), line = word_at(bytes, 12), colours = word_at(bytes, 19);
    assert_int_equal(word_at(bytes, 11), 32); /* bits a pixel, blue lowest */
    assert_int_equal(word_at(bytes, 16), 0xFF);
    assert_int_equal(word_at(bytes, 7), 0); /* least significant byte first */
    assert_true(size >= header + 12 * (size_t)colours + (size_t)line * word_at(bytes, 5));
    const unsigned char *pixels = (const unsigned char *)bytes + header + 12 * (size_t)colours;
    for (uint32_t row = 0; row < image.height; row++)
        for (uint32_t column = 0; column < image.width; column++) {
            const unsigned char *at = pixels + (y + row) * (size_t)line + 4 * (size_t)(x + column);
            assert_int_equal(image.pixel[row * image.width + column],
                             image_rgb(at[2], at[1], at[0]));
        }
    free(bytes);
    image_free(&image);
}

int main(void)
{
    const struct CMUnitTest screen[] = {cmocka_unit_test(the_screen_shows_the_picture)};
    if (getenv("RAYDIFF_SCREEN"))
        return cmocka_run_group_tests(screen, NULL, NULL);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_held_key_turns_by_time),
        cmocka_unit_test(left_wins_over_right),
        cmocka_unit_test(a_tap_is_seen),
        cmocka_unit_test(the_clock_wraps),
        cmocka_unit_test(a_turn_takes_two_seconds),
#if HAVE_SDL2
        cmocka_unit_test(every_event_is_told),
#endif
        cmocka_unit_test(no_display_is_said),
        cmocka_unit_test(a_window_without_a_screen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
