/* The front door: names, groups, summaries and functions of the commands, and how the program
 * ends. */
#include "gpu/build/device_builders.h"
#include "gpu/engines/shader_tracer.h"
#include "cmd/doctor/cmd_glsl.h"
#include "ref/guest/guest_host.h"
#include "ref/outside/plugin_shader.h"
#include "ref/base/command.h"
#include "ref/base/nearest_name.h"
#include "cmd/common/cmd_process.h"
#include "cmd/common/cmd_rows.h"

#include <string.h>

static const struct command commands[] = {
    {"check", "the main job: engines and layouts on a scene, compared ray by ray", cmd_check, NULL},
    {"explain", "one ray: what is right, what was answered, and why it is wrong", cmd_explain,
     NULL},
    {"fuzz", "random trials on engines and layouts; what is wrong is kept", cmd_fuzz, NULL},
    {"merge", "joins the findings of campaigns, such as shards", cmd_merge, "fuzz"},
    {"min", "findings made smaller, as long as they show the same", cmd_min, "fuzz"},
    {"replay", "findings played again: whether each is still there, and why", cmd_replay, "fuzz"},
    {"export", "a finding as a C program for a driver's maker", cmd_export, "fuzz"},
    {"bisect", "the pass of a shader's compiler that changes an answer, and how", cmd_bisect, NULL},
    {"conform", "the conformance suite, each name its own reproduction", cmd_conform, NULL},
    {"judge", "answers of a tracer that cannot be run here, from files", cmd_judge, NULL},
    {"gen", "writes a scene and rays as text, for a tracer to answer", cmd_gen, "judge"},
    {"verify", "judges the answers to what gen wrote: gen | TRACER | verify", cmd_verify, "judge"},
    {"bench", "speed, bytes, memory and errors, engines interleaved", cmd_bench, NULL},
    {"report", "all in one HTML file: agreement, speed, size, pictures, findings", cmd_report,
     NULL},
    {"web", "pages of findings in 3-D, which the visitor's own GPU traces", cmd_web, NULL},
    {"render", "pictures of a scene by any engine, with shadows and reflections", cmd_render, NULL},
    {"diff", "two pictures, or engines on a scene: which pixel differs", cmd_diff, "render"},
    {"scene", "what a scene is, from one format to another, and which there are", cmd_scene, NULL},
    {"construct", "meshes, lights and a camera to one scene, as RTRS's tool", cmd_construct,
     "scene"},
    {"precompute", "a tree as BVH JSON, byte for byte as RTRS's tool", cmd_precompute, "scene"},
    {"build", "trees that a GPU builds beside C's, stage by stage", cmd_build, NULL},
    {"tree", "another program's tree: is it sound, and what it costs", cmd_tree, NULL},
    {"leaks", "rays from inside a closed mesh: what passes, what is hit twice", cmd_leaks, NULL},
    {"list", "every builder, layout, test, engine, scene and ray set", cmd_list, NULL},
    {"doctor", "what can run here, and why the rest cannot", cmd_doctor, NULL},
    {0},
};

static void print_help(FILE *to)
{
    fputs("raydiff: when a ray misses a triangle, find out who is wrong.\n\n"
          "usage: raydiff COMMAND [ARGUMENTS]     raydiff help COMMAND\n\n",
          to);
    for (const struct command *command = commands; command->name; command++)
        fprintf(to, "%s  %-12s %s\n", command->group ? "  " : "", command->name, command->summary);
    fputs("\nAn indented command may follow its group: raydiff fuzz min, or raydiff min.\n"
          "\nexit codes: 0 agree, 1 mismatch, 2 usage or bad input, 3 an engine crashed or\n"
          "            hung, 4 internal error, 77 skipped\n"
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
    printf(".TP\n.BR raydiff\\-%s (1)\n%s%s%s%s%s\n", command->name, command->summary,
           command->group ? "; also raydiff " : "", command->group ? command->group : "",
           command->group ? " " : "", command->group ? command->name : "");
}

/* Lines of both shells: a command of a group, as the second word or about to be. */
static void print_member(const struct command *command)
{
    if (command->group)
        printf("    [[ $first != %s ]] || members+=' %s'\n"
               "    [[ \"$first $second\" != '%s %s' ]] || member=1\n",
               command->group, command->name, command->group, command->name);
}

/* As zsh describes it. */
static void print_choice(const struct command *command)
{
    printf("        \"%s:%s\"\n", command->name, command->summary);
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
         "    local options= values= words= files= member=0 members=\n"
         "    local first=${COMP_WORDS[1]} second=${COMP_WORDS[2]}\n"
         "    if ((COMP_CWORD == 1)); then");
    puts("        COMPREPLY=($(compgen -W 'help");
    each(print_name);
    puts("        ' -- \"$word\"))\n        return\n    fi");
    each(print_member);
    puts("    ((COMP_CWORD > 2)) && members= || member=0\n    case ${COMP_WORDS[1 + member]} in");
    each(print_options);
    puts("    esac\n"
         "    if [[ $values ]]; then\n"
         "        COMPREPLY=($(compgen -W \"$values\" -- \"$word\"))\n"
         "    elif [[ ! $words && $word = -* ]]; then\n"
         "        COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
         "    elif [[ ! $words || $files ]]; then\n"
         "        COMPREPLY=($(compgen -f -- \"$word\"))\n"
         "    fi\n"
         "    COMPREPLY+=($(compgen -W \"$members\" -- \"$word\"))\n"
         "}\n"
         "complete -o filenames -F _raydiff raydiff");
}

static void zsh_completion(void)
{
    puts("#compdef raydiff\n"
         "_raydiff() {\n"
         "    local -a commands specs\n"
         "    local member=0 members= first=$words[2] second=$words[3]\n"
         "    commands=(");
    each(print_choice);
    puts("    )\n"
         "    if ((CURRENT == 2)); then\n"
         "        _describe command commands\n"
         "        return\n"
         "    fi");
    each(print_member);
    puts("    if ((CURRENT == 3)); then\n"
         "        compadd ${=members}\n"
         "    elif ((member)); then\n"
         "        shift words\n"
         "        ((CURRENT--))\n"
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

/* The command of that name, which may follow its group's: *words gets 2 then, else 1. NULL:
 * none. */
static const struct command *find_command(int argc, char **argv, int *words)
{
    const struct command *found = NULL;
    for (const struct command *command = commands; command->name; command++) {
        bool follows = argc > 1 && command->group && strcmp(argv[0], command->group) == 0 &&
                       strcmp(argv[1], command->name) == 0;
        if (!follows && strcmp(argv[0], command->name) != 0)
            continue;
        found = command;
        *words = follows ? 2 : 1;
        if (follows)
            break;
    }
    return found;
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

/* raydiff help [--man|--bash|--zsh|--commands] [[GROUP] COMMAND]; also --help. */
static int help(int argc, char **argv)
{
    static const char *const form[] = {"--man", "--bash", "--zsh", "--commands"};
    size_t i = 0;
    if (argc > 2 && strcmp(argv[argc - 1], form[0]) == 0) { /* also behind the command */
        memmove(argv + 2, argv + 1, (size_t)(argc - 2) * sizeof *argv);
        argv[1] = (char *)form[0];
    }
    if (argc == 2 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0))
        argc = 1;
    while (argc > 1 && i < ARRAY_COUNT(form) && strcmp(argv[1], form[i]) != 0)
        i++;
    const bool formed = argc > 1 && i < ARRAY_COUNT(form);
    const char *name = argc > 1 + formed ? argv[1 + formed] : NULL;
    int words = 1;
    const struct command *only =
        name ? find_command(argc - 1 - formed, argv + 1 + formed, &words) : NULL;
    if (argc > 1 + words + formed || (name && formed && i > 0)) {
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
    if (code == EXIT_USAGE || code > 128) /* reported already, or ended by a signal */
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
    if (guest_host_is_meant(argc, argv))
        return guest_host_main(argv);
    struct reason reason;
    enum status status = device_builders_add(&reason);
    if (status)
        return exit_with_reason("list", status, &reason);
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "version") == 0) {
        puts("raydiff " RAYDIFF_VERSION);
        return EXIT_AGREE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 ||
        strcmp(argv[1], "help") == 0)
        return printed(argv[1], help(argc - 1, argv + 1));
    plugin_compile_with(cmd_glsl_compile);
    shader_tracer_compile_with(cmd_glsl_tracer);
    process_signals();
    int words;
    const struct command *command = find_command(argc - 1, argv + 1, &words);
    if (!command)
        return unknown_command(argv[1]);
    return printed(command->name, command->run(argc - words, argv + words));
}
