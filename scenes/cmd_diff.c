/* raydiff diff: two pictures. */
#include "scenes/cmd_diff.h"

#include "ref/command.h"

#include <string.h>

static bool ends_in_png(const char *text)
{
    size_t length = strlen(text);
    return length > 4 && strcmp(text + length - 4, ".png") == 0;
}

/* An argument is a picture, and no option's value. */
static bool is_of_pictures(int argc, char **argv)
{
    for (int i = 1; i < argc; i++)
        if (ends_in_png(argv[i]) && argv[i][0] != '-' &&
            (argv[i - 1][0] != '-' || strcmp(argv[i - 1], "--") == 0))
            return true;
    return false;
}

int cmd_diff(int argc, char **argv)
{
    if (is_of_pictures(argc, argv) || argc < 2 || strcmp(argv[1], "--help") == 0 ||
        strcmp(argv[1], "-h") == 0)
        return cmd_diff_images(argc, argv);
    return usage_error("diff", "two PNG files are compared, and none was given");
}
