/* Drives an entry without a fuzzer: NAME FILE|FOLDER... plays each file once; an input that takes
 * longer than a minute ends the program. Exit code 0, or killed by abort or alarm. */
#define _GNU_SOURCE
#include "tests/readers/reader_entry.h"
#include "ref/files/file.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LATE_S 60

/* The bytes as they are: file_read would unzip them. An empty file is an input, too. */
static bool read_plain(const char *path, char **bytes, size_t *size)
{
    struct stat about;
    FILE *stream = fopen(path, "rb");
    *bytes = NULL;
    if (!stream || fstat(fileno(stream), &about) != 0 || !S_ISREG(about.st_mode))
        goto done;
    *size = (size_t)about.st_size;
    *bytes = malloc(*size + 1);
    if (*bytes && fread(*bytes, 1, *size, stream) != *size) {
        free(*bytes);
        *bytes = NULL;
    }
done:
    if (stream)
        fclose(stream);
    return *bytes != NULL;
}

static void play_file(const char *path)
{
    char *bytes;
    size_t size;
    if (!read_plain(path, &bytes, &size)) {
        fprintf(stderr, "reader %s: %s: cannot be read\n", reader_entry.name, path);
        exit(2);
    }
    fprintf(stderr, "reader %s: %s\n", reader_entry.name,
            path); /* whose fault it was, if it dies */
    alarm(LATE_S);
    LLVMFuzzerTestOneInput((const uint8_t *)bytes, size);
    alarm(0);
    free(bytes);
}

static void play_folder(const char *path)
{
    struct dirent **name;
    int count = scandir(path, &name, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        char inner[4096];
        snprintf(inner, sizeof inner, "%s/%s", path, name[i]->d_name);
        if (name[i]->d_name[0] != '.')
            play_file(inner);
        free(name[i]);
    }
    if (count >= 0)
        free(name);
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        struct stat about;
        if (stat(argv[i], &about) == 0 && S_ISDIR(about.st_mode))
            play_folder(argv[i]);
        else
            play_file(argv[i]);
    }
    if (reader_tally()->inputs == 0)
        fprintf(stderr, "usage: %s FILE|FOLDER...\n", argv[0]);
    return reader_tally()->inputs == 0 ? 2 : 0;
}
