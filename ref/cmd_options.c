#include "ref/cmd_options.h"

#include "ref/command.h"

#include <string.h>

struct engine_options engine_options_default(void)
{
    return (struct engine_options){.device = -1};
}

enum status engine_option_take(int option, const char *text, struct engine_options *out,
                               struct reason *reason)
{
    uint64_t n = 0;
    enum status status = STATUS_OK;
    switch (option) {
    case OPT_THREADS:
        status = parse_count("--threads", text, 0, 4096, &n, reason);
        out->threads = (uint32_t)n;
        return status;
    case OPT_DEVICE:
        status = parse_count("--device", text, 0, 255, &n, reason);
        out->device = (int)n;
        return status;
    case OPT_WORKGROUP:
        status = parse_count("--workgroup", text, 1, 1024, &n, reason);
        out->workgroup = (uint32_t)n;
        return status;
    case OPT_PEER_TIME:
        status = parse_count("--peer-time", text, 1, 86400, &n, reason);
        out->peer_ms = (uint32_t)(1000 * n);
        return status;
    case OPT_PEER_MEMORY:
        status = parse_count("--peer-memory", text, 0, 1u << 24, &n, reason);
        out->peer_mb = n ? (uint32_t)n : UINT32_MAX;
        return status;
    case OPT_DRIVER:
        out->driver = text;
        return STATUS_OK;
    default:
        return fail(reason, STATUS_INPUT, "unknown option");
    }
}

int options_take(const char *command, void (*print_help)(void), const struct option *table,
                 option_fn *take, void *user, int argc, char **argv, int *first)
{
    struct reason reason;
    int option, index = 0;
    opterr = 0; /* the message is ours */
    optind = 1;
    while ((option = getopt_long(argc, argv, "h", table, &index)) != -1) {
        if (option == OPT_HELP || option == 'h') {
            print_help();
            return EXIT_AGREE;
        }
        if (option == '?')
            return usage_error(command, "unknown option or missing value: '%s'", argv[optind - 1]);
        if (optarg && strcmp(optarg, "-") == 0)
            return usage_error(command,
                               "--%s: '-' is no value; a file of that name is ./-, standard output "
                               "/dev/stdout",
                               table[index].name);
        if (take(user, option, optarg, &reason))
            return usage_error(command, "%s", reason.text);
    }
    *first = optind;
    return -1;
}
