/* The front door: names, summaries and functions of the sub-commands, and how the program ends. */
#include "ref/outside/plugin_shader.h"
#include "ref/base/command.h"
#include "cmd/common/cmd_nearest.h"
#include "cmd/common/cmd_process.h"
#include "cmd/common/cmd_rows.h"

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
          "usage: raydiff COMMAND [ARGUMENTS]     raydiff help COMMAND\n\n",
          to);
    for (const struct command *command = commands; command->name; command++)
        fprintf(to, "  %-12s %s\n", command->name, command->summary);
    fputs("\nexit codes: 0 agree, 1 mismatch, 2 usage or bad input, 3 an engine crashed or hung,\n"
          "            4 internal error, 77 skipped\n"
          "example:    raydiff check soup:n=1000 --layout f32,rf16\n",
          to);
}

/* --- what is made of the options of all commands ------------------------------------------- */

/* Commands that take other options after these words. */
static const struct {
    const char *command;
    char *word;
} forms[] = {{"diff", (char[]){"a.png"}}, {"fuzz", (char[]){"--self-test"}}};

/* The options of a command, all its forms, as option_form has it. */
static void print_options(const struct command *command)
{
    char name[24], help[] = "--help";
    snprintf(name, sizeof name, "%s", command->name);
    (void)command->run(2, (char *[]){name, help, NULL});
    for (size_t i = 0; i < ARRAY_COUNT(forms); i++)
        if (strcmp(forms[i].command, command->name) == 0)
            (void)command->run(3, (char *[]){name, forms[i].word, help, NULL});
}

static void each(void (*print)(const struct command *command))
{
    for (const struct command *command = commands; command->name; command++)
        print(command);
}

static void print_name(const struct command *command)
{
    puts(command->name);
}

static void print_page(const struct command *command)
{
    printf(".TP\n.BR raydiff\\-%s (1)\n%s\n", command->name, command->summary);
}

/* As zsh describes it. */
static void print_choice(const struct command *command)
{
    printf("        '%s:%s'\n", command->name, command->summary);
}

static void man_page(const struct command *only)
{
    printf(
        ".TH RAYDIFF%s%s 1 \"\" \"raydiff %s\" \"User Commands\"\n.SH NAME\nraydiff%s%s \\- %s\n",
        only ? "-" : "", only ? only->name : "", RAYDIFF_VERSION, only ? "-" : "",
        only ? only->name : "",
        only ? only->summary : "differential testing of ray tracers and BVH node layouts");
    if (only) {
        print_options(only);
        puts(".SH SEE ALSO\n.BR raydiff (1)");
        return;
    }
    puts(
        ".SH SYNOPSIS\n.B raydiff\n.I COMMAND\n.RI [ ARGUMENTS ]\n.SH DESCRIPTION\n"
        "Runs a C reference, Vulkan compute shaders and Embree on the same triangles and rays, for "
        "every node\nlayout, and shows which agree, which differ and why.\n"
        "Every command has\n.B \\-\\-help\nwith an example, and a page of its own.\n.SH COMMANDS");
    each(print_page);
}

static void bash_completion(void)
{
    puts("# bash completion of raydiff: source it, or keep it in bash-completion's folder.\n"
         "_raydiff() {\n"
         "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
         "    local options= values= words= files=\n"
         "    if ((COMP_CWORD == 1)); then");
    puts("        COMPREPLY=($(compgen -W 'help");
    each(print_name);
    puts("        ' -- \"$word\"))\n        return\n    fi\n    case ${COMP_WORDS[1]} in");
    each(print_options);
    puts("    esac\n"
         "    if [[ $values ]]; then\n"
         "        COMPREPLY=($(compgen -W \"$values\" -- \"$word\"))\n"
         "    elif [[ ! $words && $word = -* ]]; then\n"
         "        COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
         "    elif [[ ! $words || $files ]]; then\n"
         "        COMPREPLY=($(compgen -f -- \"$word\"))\n"
         "    fi\n"
         "}\n"
         "complete -o filenames -F _raydiff raydiff");
}

static void zsh_completion(void)
{
    puts("#compdef raydiff\n"
         "_raydiff() {\n"
         "    local -a commands specs\n"
         "    commands=(");
    each(print_choice);
    puts("    )\n"
         "    if ((CURRENT == 2)); then\n"
         "        _describe command commands\n"
         "        return\n"
         "    fi\n"
         "    case $words[2] in");
    each(print_options);
    puts("    esac\n"
         "    shift words\n"
         "    ((CURRENT--))\n"
         "    _arguments $specs '*:file:_files'\n"
         "}\n"
         "_raydiff \"$@\"");
}

static const struct command *find_command(const char *name)
{
    for (const struct command *command = commands; command->name; command++)
        if (strcmp(name, command->name) == 0)
            return command;
    return NULL;
}

static int unknown_command(const char *name)
{
    const bool of_paper = strcmp(name, "load") == 0 || strcmp(name, "demo") == 0;
    struct nearest_name nearest = nearest_make(name, strlen(name));
    for (const struct command *command = commands; command->name; command++)
        nearest_try(&nearest, command->name);
    fprintf(stderr, "raydiff: unknown command '%s' (see raydiff %s--help)%s%s%s\n", name,
            of_paper ? "render " : "", nearest.name ? "; did you mean " : "",
            nearest.name ? nearest.name : "", nearest.name ? "?" : "");
    return EXIT_USAGE;
}

/* raydiff help [--man|--bash|--zsh|--commands] [COMMAND]; also --help. */
static int help(int argc, char **argv)
{
    static const char *const form[] = {"--man", "--bash", "--zsh", "--commands"};
    size_t i = 0;
    while (argc > 1 && i < ARRAY_COUNT(form) && strcmp(argv[1], form[i]) != 0)
        i++;
    const bool formed = argc > 1 && i < ARRAY_COUNT(form);
    const char *name = argc > 1 + formed ? argv[1 + formed] : NULL;
    const struct command *only = name ? find_command(name) : NULL;
    if (argc > 2 + formed || (name && formed && i > 0)) {
        fprintf(stderr, "raydiff: help: [--man] [COMMAND], --bash, --zsh or --commands\n");
        return EXIT_USAGE;
    }
    if (name && !only)
        return unknown_command(name);
    option_form = !formed || i == 3 ? FORM_HELP : (enum option_form)(FORM_MAN + i);
    if (!formed && only)
        print_options(only);
    else if (!formed)
        print_help(stdout);
    else if (i == 0)
        man_page(only);
    else if (i == 1)
        bash_completion();
    else if (i == 2)
        zsh_completion();
    else
        each(print_name);
    return EXIT_AGREE;
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
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "help") == 0)
        return printed(argv[1], help(argc - 1, argv + 1));
    plugin_compile_with(cmd_glsl_compile);
    process_signals();
    const struct command *command = find_command(argv[1]);
    return command ? printed(argv[1], command->run(argc - 1, argv + 1)) : unknown_command(argv[1]);
}
