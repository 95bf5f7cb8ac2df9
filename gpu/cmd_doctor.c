/* raydiff doctor: what can run here, and why the rest cannot. */
#define _POSIX_C_SOURCE 200809L
#include "ref/cmd_options.h"
#include "ref/command.h"

#include <float.h>
#include <fenv.h>
#include <string.h>
#include <unistd.h>

static const char help[] = "usage: raydiff doctor [OPTIONS]\n"
                           "Says for every engine whether it can run here, with versions, devices\n"
                           "and limits, or why it is skipped; and checks the float environment\n"
                           "that the C reference relies on.\n\n" ENGINE_OPTIONS_HELP
                           "\nexit codes: 0 every engine runs, 77 some do not, 4 the float\n"
                           "            environment is not IEEE\n"
                           "example: raydiff doctor --driver llvmpipe\n";

static int print_engine(const struct engine *engine, const struct engine_options *options)
{
    char text[4096] = "";
    void *self = NULL;
    struct reason reason = {""};
    enum status status = engine->open(options, &self, &reason);
    engine->describe(options, text, sizeof text);
    printf("%-14s %s\n", engine->name, status ? "SKIPPED" : "runs");
    if (status) {
        printf("    why: %s\n", reason.text);
    } else {
        engine->close(self);
    }
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n"))
        printf("    %s\n", line);
    return status ? EXIT_SKIPPED : EXIT_AGREE;
}

/* The reference must round to nearest, keep subnormals and evaluate floats as floats. */
static int print_float_environment(void)
{
    volatile float least = FLT_MIN, half = 0.5f, one = 1.0f, tiny = 0x1p-24f;
    bool subnormals = least * half > 0.0f;
    bool nearest = fegetround() == FE_TONEAREST && one + tiny == one;
    printf("float          %s: FLT_EVAL_METHOD %d, subnormals %s, rounding %s\n",
           subnormals && nearest && FLT_EVAL_METHOD == 0 ? "IEEE" : "NOT IEEE", FLT_EVAL_METHOD,
           subnormals ? "kept" : "flushed", nearest ? "to nearest" : "directed");
    return subnormals && nearest && FLT_EVAL_METHOD == 0 ? EXIT_AGREE : EXIT_INTERNAL;
}

static void print_help(void)
{
    fputs(help, stdout);
}

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    return engine_option_take(option, text, user, reason);
}

int cmd_doctor(int argc, char **argv)
{
    static const struct option long_options[] = {ENGINE_OPTIONS};
    struct engine_options options = engine_options_default();
    int first, code = options_take("doctor", print_help, long_options, take_option, &options, argc,
                                   argv, &first);
    if (code >= 0)
        return code;
    if (first < argc)
        return usage_error("doctor", "'%s' is not an option", argv[first]);
    printf("raydiff        %s, compiled by %s\n", RAYDIFF_VERSION, __VERSION__);
    printf("processors     %ld\n", sysconf(_SC_NPROCESSORS_ONLN));
    code = print_float_environment();
    for (size_t i = 0; engines[i]; i++)
        code = exit_worse(code, print_engine(engines[i], &options));
    return code;
}
