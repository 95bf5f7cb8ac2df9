#define _GNU_SOURCE
#include "tests/faults/faults_trees.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LOG        "findings.jsonl"
#define CHECKPOINT "{\"checkpoint\""

static void join(char *path, const char *folder, const char *name)
{
    snprintf(path, TREES_PATH_MOST, "%s/%s", folder, name);
}

/* All of a file with a 0 behind it, or NULL. */
static char *contents(const char *path, size_t *size)
{
    struct stat about;
    FILE *file = fopen(path, "rb");
    if (!file || fstat(fileno(file), &about) != 0 || !S_ISREG(about.st_mode)) {
        if (file)
            fclose(file);
        return NULL;
    }
    char *bytes = malloc((size_t)about.st_size + 1);
    *size = bytes ? fread(bytes, 1, (size_t)about.st_size, file) : 0;
    fclose(file);
    if (bytes)
        bytes[*size] = '\0';
    return bytes;
}

static bool copy_file(const char *from, const char *to)
{
    size_t size = 0;
    char *bytes = contents(from, &size);
    FILE *file = bytes ? fopen(to, "wb") : NULL;
    bool good = file && fwrite(bytes, 1, size, file) == size;
    good = file && fclose(file) == 0 && good;
    free(bytes);
    return good;
}

static bool is_folder(const char *path)
{
    struct stat about;
    return lstat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

bool tree_copy(const char *from, const char *to)
{
    struct dirent **name;
    bool good = mkdir(to, 0777) == 0;
    int count = good ? scandir(from, &name, NULL, alphasort) : -1;
    for (int i = 0; i < count; i++) {
        char a[TREES_PATH_MOST], b[TREES_PATH_MOST];
        join(a, from, name[i]->d_name);
        join(b, to, name[i]->d_name);
        if (strcmp(name[i]->d_name, ".") != 0 && strcmp(name[i]->d_name, "..") != 0 && good)
            good = is_folder(a) ? tree_copy(a, b) : copy_file(a, b);
        free(name[i]);
    }
    if (count >= 0)
        free(name);
    return good && count >= 0;
}

static int remove_one(const char *path, const struct stat *about, int type, struct FTW *ftw)
{
    (void)about, (void)type, (void)ftw;
    return remove(path);
}

bool tree_remove(const char *path)
{
    return nftw(path, remove_one, 16, FTW_DEPTH | FTW_PHYS) == 0 || errno == ENOENT;
}

static bool ends_with(const char *text, size_t size, const char *end)
{
    size_t length = strlen(end);
    return size >= length && memcmp(text + size - length, end, length) == 0;
}

/* The next line of a finding, or NULL; *last becomes the last checkpoint seen. */
static char *next_finding(char **at, char **last)
{
    while (**at) {
        char *line = *at, *end = strchr(line, '\n');
        if (!end)
            return NULL; /* torn */
        *end = '\0';
        *at = end + 1;
        if (strncmp(line, CHECKPOINT, strlen(CHECKPOINT)) != 0)
            return line;
        *last = line;
    }
    return NULL;
}

static bool same_logs(char *a, char *b)
{
    char none[] = "", *x, *y, *last_a = none, *last_b = none;
    do {
        x = next_finding(&a, &last_a);
        y = next_finding(&b, &last_b);
        if (!x != !y || (x && strcmp(x, y) != 0))
            return false;
    } while (x);
    return strcmp(last_a, last_b) == 0;
}

static bool whole_file(const char *name, const char *bytes, size_t size)
{
    const char *end = strrchr(name, '.');
    if (end && strcmp(end, ".trial") == 0)
        return ends_with(bytes, size, "\nend\n");
    if (end && strcmp(end, ".html") == 0)
        return ends_with(bytes, size, "</html>\n");
    if (end && strcmp(end, ".json") == 0)
        return ends_with(bytes, size, "}\n");
    if (end && strcmp(end, ".xml") == 0)
        return ends_with(bytes, size, "</testsuites>\n");
    if (end && strcmp(end, ".csv") == 0)
        return ends_with(bytes, size, "\n");
    if (strcmp(name, "count") == 0)
        return size > 1 && strspn(bytes, "0123456789") == size - 1 && bytes[size - 1] == '\n';
    return true;
}

/* What tells how long something took, when it ran, or how many bytes that made. */
static bool is_timed(const char *name)
{
    static const char *const ends[] = {".json", ".html", ".xml", ".csv"};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        if (ends_with(name, strlen(name), ends[i]))
            return true;
    return false;
}

/* Drops what numbers are written with. */
static size_t drop_numbers(char *bytes, size_t size)
{
    size_t kept = 0;
    for (size_t i = 0; i < size; i++)
        if (!memchr("0123456789.e+-", bytes[i], 14))
            bytes[kept++] = bytes[i];
    return kept;
}

static bool same_files(const char *name, const char *a, const char *b)
{
    size_t size_a = 0, size_b = 0;
    char *x = contents(a, &size_a), *y = contents(b, &size_b);
    bool same = x && y;
    const bool of_session = strcmp(name, "stats.json") == 0; /* says what the last one did */
    if (same && of_session)
        same = whole_file(name, x, size_a) && whole_file(name, y, size_b);
    else if (same && is_timed(name)) {
        same = whole_file(name, x, size_a) && whole_file(name, y, size_b);
        size_a = drop_numbers(x, size_a);
        size_b = drop_numbers(y, size_b);
    }
    if (same && strcmp(name, LOG) == 0)
        same = same_logs(x, y);
    else if (same && !of_session)
        same = size_a == size_b && memcmp(x, y, size_a) == 0;
    free(x);
    free(y);
    return same;
}

/* Whether all that is in `wanted` is in `got`; once: both ways. */
static bool same_within(const char *wanted, const char *got, bool files, char *why)
{
    struct dirent **name;
    int count = scandir(wanted, &name, NULL, alphasort);
    bool same = count >= 0;
    if (!same)
        snprintf(why, TREES_WHY_MOST, "%.400s is gone", wanted);
    for (int i = 0; i < count; i++) {
        char a[TREES_PATH_MOST], b[TREES_PATH_MOST];
        struct stat about;
        join(a, wanted, name[i]->d_name);
        join(b, got, name[i]->d_name);
        const char *own = name[i]->d_name;
        if (own[0] != '.' && !ends_with(own, strlen(own), ".tmp") && same) {
            bool there = lstat(b, &about) == 0;
            same = there && (is_folder(a) ? is_folder(b) && same_within(a, b, files, why)
                                          : !files || same_files(own, a, b));
            if (!same && !why[0])
                snprintf(why, TREES_WHY_MOST, "%.400s %s", b, there ? "differs" : "is not there");
        }
        free(name[i]);
    }
    if (count >= 0)
        free(name);
    return same;
}

bool tree_same(const char *wanted, const char *got, char why[TREES_WHY_MOST])
{
    why[0] = '\0';
    return same_within(wanted, got, true, why) && same_within(got, wanted, false, why);
}

bool tree_is_whole(const char *path, bool tidy, char why[TREES_WHY_MOST])
{
    struct dirent **name;
    int count = scandir(path, &name, NULL, alphasort);
    bool good = true;
    for (int i = 0; i < count; i++) {
        char one[TREES_PATH_MOST];
        const char *own = name[i]->d_name;
        bool temporary = ends_with(own, strlen(own), ".tmp");
        join(one, path, own);
        if (strcmp(own, ".") != 0 && strcmp(own, "..") != 0 && good) {
            size_t size = 0;
            char *bytes = is_folder(one) ? NULL : contents(one, &size);
            good = !(temporary && tidy);
            if (good && bytes && !temporary)
                good = whole_file(own, bytes, size);
            if (!good)
                snprintf(why, TREES_WHY_MOST, "%.400s %s", one, temporary ? "is left" : "is torn");
            if (good && is_folder(one) && !temporary)
                good = tree_is_whole(one, tidy, why);
            free(bytes);
        }
        free(name[i]);
    }
    if (count >= 0)
        free(name);
    return good;
}

bool tree_keeps(const char *before, const char *after, char why[TREES_WHY_MOST])
{
    size_t size;
    char a[TREES_PATH_MOST], b[TREES_PATH_MOST], none[] = "", *last = none, *line;
    join(a, before, LOG);
    join(b, after, LOG);
    char *x = contents(a, &size), *y = contents(b, &size), *at = x;
    bool kept = true;
    while (x && kept && (line = next_finding(&at, &last)) != NULL) {
        kept = y && strstr(y, line);
        if (!kept)
            snprintf(why, TREES_WHY_MOST, "a finding of the log is lost: %.300s", line);
    }
    free(x);
    free(y);
    return kept;
}

long tree_file_size(const char *folder, const char *name)
{
    char path[TREES_PATH_MOST];
    struct stat about;
    join(path, folder, name);
    return stat(path, &about) == 0 ? (long)about.st_size : -1;
}

bool tree_has(const char *folder, const char *name)
{
    return tree_file_size(folder, name) >= 0;
}

bool tree_file_holds(const char *logs, const char *name, const char *what)
{
    char path[TREES_PATH_MOST], text[8192];
    join(path, logs, name);
    FILE *file = fopen(path, "r");
    text[file ? fread(text, 1, sizeof text - 1, file) : 0] = '\0';
    if (file)
        fclose(file);
    return strstr(text, what) != NULL;
}

bool tree_is_empty(const char *folder)
{
    return rmdir(folder) == 0 && mkdir(folder, 0777) == 0;
}

bool tree_takes_nameless(const char *folder)
{
    int file = open(folder, O_TMPFILE | O_WRONLY, 0600);
    if (file >= 0)
        close(file);
    return file >= 0;
}
