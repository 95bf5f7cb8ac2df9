#define _POSIX_C_SOURCE 200809L /* sigaction, timer_create */
#include "cmd/common/cmd_process.h"

#include "ref/files/file.h"

#include <fcntl.h>
#include <time.h>
#include <unistd.h>

static const int ends[] = {SIGINT, SIGTERM, SIGHUP};

bool process_standard_files(void)
{
    static const int flags[] = {O_WRONLY, O_RDONLY, O_RDONLY};
    for (int file = 0; file < (int)ARRAY_COUNT(flags); file++)
        if (fcntl(file, F_GETFD) < 0 && open("/dev/null", flags[file]) != file)
            return false;
    return true;
}

/* Signal handlers call the functions from here to process_signals. */
static void end_by(int number)
{
    const struct sigaction by_default = {.sa_handler = SIG_DFL};
    sigset_t one;
    file_out_abandon();
    sigaction(number, &by_default, NULL);
    sigemptyset(&one);
    sigaddset(&one, number);
    raise(number);
    pthread_sigmask(SIG_UNBLOCK, &one, NULL);
}

static volatile sig_atomic_t *caught_flag;
static volatile sig_atomic_t caught_first;
static timer_t grace;

static void end_late(int number)
{
    (void)number;
    if (caught_first)
        end_by((int)caught_first);
}

static void set_grace(time_t seconds, long ns)
{
    const struct itimerspec when = {.it_value = {seconds, ns}};
    timer_settime(grace, 0, &when, NULL);
}

static void on_caught(int number)
{
    if (caught_first)
        end_by(number);
    caught_first = number;
    *caught_flag = number;
    set_grace(0, PROCESS_GRACE_MS * 1000000L);
}

/* Signals ignored at the start stay ignored, as under nohup or in the background of a script.
 * Commands that end by themselves (`listens`) still catch SIGINT and SIGTERM, since scripts send
 * these. */
static void install(void (*handler)(int number), bool listens)
{
    for (size_t i = 0; i < ARRAY_COUNT(ends); i++) {
        struct sigaction before, action = {.sa_handler = handler, .sa_flags = SA_RESTART};
        if (sigaction(ends[i], NULL, &before) == 0 &&
            (before.sa_handler != SIG_IGN || (listens && ends[i] != SIGHUP)))
            sigaction(ends[i], &action, NULL);
    }
}

void process_signals(void)
{
    install(end_by, false);
}

void process_signals_caught(volatile sig_atomic_t *caught)
{
    const struct sigaction late = {.sa_handler = end_late};
    struct sigevent event = {.sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGALRM};
    if (caught_flag == caught)
        return;
    /* Without a timer, a signal ends the process at once. */
    if (timer_create(CLOCK_MONOTONIC, &event, &grace) != 0)
        return;
    sigaction(SIGALRM, &late, NULL);
    caught_flag = caught;
    install(on_caught, true);
}

void process_signal_taken(void)
{
    if (caught_first)
        set_grace(0, 0);
}
