/* Classes of bad input, and engines asked in a child process, which may crash or hang. Include
 * after cmocka.h. */
#ifndef TESTS_BAD_INPUT_H
#define TESTS_BAD_INPUT_H

#include "ref/engine.h"
#include "scenes/scenes.h"

#include <float.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define BAD_N    8  /* cells of the grid z = 1, 2 triangles each */
#define BAD_RAYS 64 /* bad ones at odd places, good ones between them */
#define HANG_MS  20000

/* What is spoilt: a ray's number (org 0-2, tmin 3, dir 4-6, tmax 7), all three of dir (8), or a
 * vertex coordinate (9-11). */
struct bad_class {
    const char *name;
    int slot;
    float value;
    bool must_miss; /* a ray that has it meets nothing */
};

static const struct bad_class bad_classes[] = {
    {"NaN origin", 0, NAN, true},
    {"NaN direction", 5, NAN, true},
    {"NaN tmin", 3, NAN, true},
    {"NaN tmax", 7, NAN, true},
    {"infinite origin", 1, INFINITY, false},
    {"-infinite direction", 6, -INFINITY, false},
    {"infinite tmin", 3, INFINITY, false},
    {"infinite tmax", 7, INFINITY, false},
    {"zero direction", 8, 0.0f, true},
    {"-zero direction", 8, -0.0f, true},
    {"denormal direction", 8, 1e-40f, false},
    {"denormal component", 4, 1e-44f, false},
    {"tmin above tmax", 3, 2e30f, true},
    {"negative tmax", 7, -1.0f, true},
    {"negative tmin", 3, -1.0f, false},
    {"origin 2^40", 0, 0x1p40f, true},
    {"origin 1e18", 0, 1e18f, true},
    {"origin 1.85e18", 0, 1.85e18f, true},
    {"largest origin", 2, -FLT_MAX, false},
    {"largest direction", 6, FLT_MAX, false},
    {"NaN vertex", 9, NAN, false},
    {"infinite vertex", 11, INFINITY, false},
    {"vertex 1.9e18", 10, 1.9e18f, false},
    {"largest vertex", 9, -FLT_MAX, false},
};

#define BAD_CLASSES (sizeof bad_classes / sizeof bad_classes[0])

/* What became of a class. */
enum fate {
    FATE_FINE,
    FATE_REFUSED,   /* with a reason */
    FATE_SKIPPED,   /* the engine cannot run here */
    FATE_PHANTOM,   /* a ray that meets nothing has a hit, or one of no triangle */
    FATE_NEIGHBOUR, /* a good ray beside a bad one is answered wrongly */
    FATE_STRAY,     /* something was written behind the last answer */
    FATE_FAILED,    /* says that it did not finish */
    FATE_CRASHED,
    FATE_HUNG,
    FATE_COUNT
};

static const char *const fate_names[FATE_COUNT] = {
    "fine", "refused", "skipped", "phantom", "neighbour", "stray", "failed", "CRASHED", "HUNG"};

/* A child that plays classes one after the other and writes a byte for each. */
typedef void bad_player(void *user, size_t first, int to);

/* Plays all classes in children: one that dies is followed by another, from the next class on. */
static inline void bad_play(bad_player *player, void *user, int hang_ms, enum fate out[])
{
    for (size_t next = 0; next < BAD_CLASSES;) {
        int ends[2], status;
        assert_int_equal(pipe(ends), 0);
        fflush(NULL);
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            close(ends[0]);
            alarm(300);
            player(user, next, ends[1]);
            _exit(0);
        }
        close(ends[1]);
        bool alive = true, hung = false;
        while (alive && next < BAD_CLASSES) {
            unsigned char fate;
            struct pollfd wait = {.fd = ends[0], .events = POLLIN};
            hung = poll(&wait, 1, hang_ms) == 0;
            alive = !hung && read(ends[0], &fate, 1) == 1;
            if (alive)
                out[next++] = fate < FATE_CRASHED ? (enum fate)fate : FATE_CRASHED;
        }
        if (hung)
            kill(child, SIGKILL);
        if (!alive)
            out[next++] = hung ? FATE_HUNG : FATE_CRASHED;
        close(ends[0]);
        assert_int_equal(waitpid(child, &status, 0), child);
    }
}

#endif
