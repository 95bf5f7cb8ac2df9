/* Keys that are pressed while a campaign plays. */
#define _DEFAULT_SOURCE
#include "cmd/fuzz/cmd_fuzz_screen.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

static struct termios cooked;
static bool is_raw;

/* A process in the background that reads or changes its terminal would be stopped. */
static bool in_foreground(void)
{
    return isatty(STDIN_FILENO) && tcgetpgrp(STDIN_FILENO) == getpgrp();
}

static void give_back(void)
{
    if (is_raw && in_foreground())
        tcsetattr(STDIN_FILENO, TCSANOW, &cooked);
    is_raw = false;
}

/* Takes keys without a line's end and without showing them; Ctrl-C stays what it is. */
static bool make_raw(void)
{
    static bool registered;
    struct termios raw;
    if (is_raw)
        return true;
    if (tcgetattr(STDIN_FILENO, &cooked))
        return false;
    if (!registered && atexit(give_back))
        return false;
    registered = true;
    raw = cooked;
    raw.c_lflag &= (tcflag_t) ~(ICANON | ECHO);
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    is_raw = tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
    return is_raw;
}

int fuzz_key_pressed(struct fuzz_screen *screen)
{
    unsigned char key;
    screen->keys = in_foreground() && make_raw();
    return screen->keys && read(STDIN_FILENO, &key, 1) == 1 ? key : 0;
}

void fuzz_key_wait(void)
{
    struct pollfd in = {.fd = STDIN_FILENO, .events = POLLIN};
    poll(&in, 1, 200);
}

void fuzz_screen_end(struct fuzz_screen *screen)
{
    if (screen->lines > 0)
        fprintf(stderr, "\033[%dA\033[J", screen->lines);
    screen->lines = 0;
    fflush(stderr);
    give_back();
}
