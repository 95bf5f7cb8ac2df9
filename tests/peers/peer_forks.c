/* A peer of many processes, for tests/scripts/peers.sh, which compiles it into a folder of its own.
 *   forks            starts PROCESSES and ends
 *   forks stay       starts them and hangs
 *   forks there N S  waits until N processes have its folder in their command lines; at most S
 * seconds forks gone S     waits until none has; prints after how many milliseconds, or who is left
 * Signals that can be ignored are. */
#define _GNU_SOURCE
#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define PROCESSES 200

static void wait_for_ever(void)
{
    for (;;)
        pause();
}

/* A child; one left by its parent; the same in a session of its own; a child with a child. */
static void start(int kind)
{
    if (fork() != 0)
        return;
    if (kind == 1 && fork() != 0)
        _exit(0);
    if (kind == 2) {
        if (fork() != 0)
            _exit(0);
        setsid();
        if (fork() != 0)
            _exit(0);
    }
    if (kind == 3)
        (void)!fork();
    wait_for_ever();
}

static double ms_since(const struct timespec *start)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)(now.tv_sec - start->tv_sec) +
           1e-6 * (double)(now.tv_nsec - start->tv_nsec);
}

/* Processes other than this one with `text` in their command lines; zombies have none. */
static int count(const char *text, int print)
{
    int found = 0;
    DIR *all = opendir("/proc");
    struct dirent *one;
    while (all && (one = readdir(all)) != NULL) {
        char path[300], line[4096];
        if (one->d_name[0] < '1' || one->d_name[0] > '9' || atol(one->d_name) == getpid())
            continue;
        snprintf(path, sizeof path, "/proc/%s/cmdline", one->d_name);
        FILE *file = fopen(path, "r");
        size_t size = file ? fread(line, 1, sizeof line - 1, file) : 0;
        if (file)
            fclose(file);
        if (!memmem(line, size, text, strlen(text)))
            continue;
        found++;
        for (size_t i = 0; i < size; i++)
            line[i] = line[i] ? line[i] : ' ';
        line[size] = '\0';
        if (print && found <= 5)
            printf("%s: %.150s\n", one->d_name, line);
    }
    if (all)
        closedir(all);
    return found;
}

int main(int argc, char **argv)
{
    struct timespec begun;
    char folder[512];
    int there = argc == 4 && strcmp(argv[1], "there") == 0;
    clock_gettime(CLOCK_MONOTONIC, &begun);
    if (there || (argc == 3 && strcmp(argv[1], "gone") == 0)) {
        double limit = 1e3 * atof(argv[argc - 1]);
        snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(argv[0], '/') + 1 - argv[0]),
                 argv[0]);
        for (;;) {
            int now = count(folder, 0);
            if (there ? now >= atoi(argv[2]) : now == 0)
                break;
            if (ms_since(&begun) > limit) {
                printf("%d processes:\n", now);
                count(folder, 1);
                return 1;
            }
            usleep(5000);
        }
        printf("%.0f\n", ms_since(&begun));
        return 0;
    }
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_IGN);
    signal(SIGHUP, SIG_IGN);
    for (int i = 0; i < PROCESSES; i++)
        start(i % 4);
    if (argc == 2 && strcmp(argv[1], "stay") == 0)
        wait_for_ever();
    return 0;
}
