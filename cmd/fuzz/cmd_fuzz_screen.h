/* The screen of raydiff fuzz on a terminal: redrawn in place, with keys. Commands only. */
#ifndef CMD_FUZZ_SCREEN_H
#define CMD_FUZZ_SCREEN_H

#include "fuzz/campaign/campaign.h"

#define SCREEN_SAMPLES 32u  /* of the trend, one a second */
#define SCREEN_SEEN    512u /* findings with an age */

struct fuzz_command;

struct fuzz_screen {
    int lines;         /* drawn; the next drawing overwrites them */
    uint64_t drawn_ns; /* 0: never */
    uint64_t sample[SCREEN_SAMPLES], sampled, sampled_ns; /* trials a second, each second */
    uint64_t before;                                      /* trials at the last sample */
    uint64_t seen_ns[SCREEN_SEEN]; /* when a finding came, since the start; 0: it was there */
    size_t seen;
    bool counted;    /* the findings that were there before */
    size_t selected; /* 1 + the finding that is shown; 0: all are listed */
    bool paused, keys;
};

/* Draws it if it is due, and does what keys ask for: p pauses until the next p, f shows one finding
 * after the other, q ends the campaign as Ctrl-C does. Keys are read only in the foreground. */
void fuzz_screen_tick(struct fuzz_command *c, const struct campaign_view *view);

/* A key that was pressed, or 0; sets screen->keys if keys can be read. */
int fuzz_key_pressed(struct fuzz_screen *screen);
/* Waits for a key, a fifth of a second at most. */
void fuzz_key_wait(void);

/* Clears it and gives the terminal back. */
void fuzz_screen_end(struct fuzz_screen *screen);

/* A row per character, from ' ' (none) to '#' (the most): the samples in their order. */
void fuzz_screen_trend(const struct fuzz_screen *screen, char text[SCREEN_SAMPLES + 1]);

/* "12 s", "3 min", "2 h" or "1 d". */
void fuzz_screen_age(uint64_t ns, char text[16]);

#endif
