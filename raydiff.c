/* The front door: names, summaries and functions of the sub-commands, and how the program ends. */
#include "ref/outside/plugin_shader.h"
#include "ref/base/command.h"
#include "cmd/common/cmd_nearest.h"
#include "cmd/common/cmd_process.h"

#include <string.h>

static const struct command commands[] = {
    {"check", "the main job: engines and layouts on a scene, compared ray by ray", cmd_check},
    {"explain", "one ray: what is right, what was answered, and why it is wrong", cmd_explain},
    {"fuzz", "random trials on engines and layouts; what is wrong is kept", cmd_fuzz},
    {"merge", "joins the findings of campaigns, such as shards", cmd_merge},
    {"min", "findings made smaller, as long as they show the same", cmd_min},
    {"replay", "findings played again: whether each is still there, and why", cmd_replay},
    {"export", "a finding as a C program for a driver's maker, without raydiff", cmd_export},
    {"conform", "the conformance suite, each name its own reproduction", cmd_conform},
    {"judge", "answers of a tracer that cannot be run here, from files", cmd_judge},
    {"gen", "writes a scene and rays as text, for a tracer to answer", cmd_gen},
    {"verify", "judges the answers to what gen wrote: gen | TRACER | verify", cmd_verify},
    {"bench", "speed, bytes, memory and errors, engines interleaved", cmd_bench},
    {"construct", "meshes, materials, lights and a camera to a scene, as RTRS's tool",
     cmd_construct},
    {"report", "one HTML file of it all: agreement, speed, size, pictures, findings", cmd_report},
    {"precompute", "writes a tree as BVH JSON, byte for byte as RTRS's tool would", cmd_precompute},
    {"diff", "two pictures, or engines on a scene: which pixel differs, and why", cmd_diff},
    {"render", "pictures of a scene by any engine, with shadows and reflections", cmd_render},
    {"scene", "what a scene is, from one format to another, and which there are", cmd_scene},
    {"leaks", "rays from inside a closed mesh: what passes, what is hit twice", cmd_leaks},
    {"list", "every builder, layout, test, engine, scene and ray set", cmd_list},
    {"doctor", "what can run here, and why the rest cannot", cmd_doctor},
    {NULL, NULL, NULL},
};

static void print_help(FILE *to)
{
    fputs("raydiff: when a ray misses a triangle, find out who is wrong.\n\n"
          "usage: raydiff COMMAND [ARGUMENTS]     raydiff COMMAND --help\n\n",
          to);
    for (const struct command *command = commands; command->name; command++)
        fprintf(to, "  %-12s %s\n", command->name, command->summary);
    fputs("\nexit codes: 0 agree, 1 mismatch, 2 usage or bad input, 3 an engine crashed or hung,\n"
          "            4 internal error, 77 skipped\n"
          "example:    raydiff check soup:n=1000 --layout f32,rf16\n",
          to);
}

/* What a command printed has arrived: a full disk is an output that cannot be written, as any. A
 * signal's code stays. */
static int printed(const char *name, int code)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return code;
    if (code == EXIT_USAGE || code > 128) /* said already, or ended */
        return code;
    fprintf(stderr, "raydiff %s: cannot write to the standard output\n", name);
    return exit_worse(code, EXIT_USAGE);
}

int main(int argc, char **argv)
{
    if (!process_standard_files()) {
        fputs("raydiff: /dev/null: cannot be opened in place of a closed standard file\n", stderr);
        return EXIT_USAGE;
    }
    if (argc < 2) {
        print_help(stderr);
        return EXIT_USAGE;
    }
    if (strcmp(argv[1], "--version") == 0) {
        puts("raydiff " RAYDIFF_VERSION);
        return EXIT_AGREE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "help") == 0) {
        print_help(stdout);
        return printed(argv[1], EXIT_AGREE);
    }
    plugin_compile_with(cmd_glsl_compile);
    process_signals();
    for (const struct command *command = commands; command->name; command++)
        if (strcmp(argv[1], command->name) == 0)
            return printed(argv[1], command->run(argc - 1, argv + 1));
    const bool of_seed = strcmp(argv[1], "load") == 0 || strcmp(argv[1], "demo") == 0;
    struct nearest_name nearest = nearest_make(argv[1], strlen(argv[1]));
    for (const struct command *command = commands; command->name; command++)
        nearest_try(&nearest, command->name);
    fprintf(stderr, "raydiff: unknown command '%s' (see raydiff %s--help)%s%s%s\n", argv[1],
            of_seed ? "render " : "", nearest.name ? "; did you mean " : "",
            nearest.name ? nearest.name : "", nearest.name ? "?" : "");
    return EXIT_USAGE;
}
