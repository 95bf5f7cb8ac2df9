#define _POSIX_C_SOURCE 200809L
#include "gpu/vk/vk_driver.h"

#include <dirent.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *const driver_names[] = {"stock", "mesa25", "swiftshader", "hardware", NULL};

/* How many folders above the program are searched: build/raydiff, build/tests/test_x,
 * build/sanitize/tests/test_x and build/mutants/NAME/raydiff all lead to build/drivers. */
#define FOLDERS_ABOVE 4

/* Joins folder and name in `out`; returns false if they do not fit. */
static bool join(char out[DRIVER_PATH_BYTES], const char *folder, const char *name)
{
    int length = snprintf(out, DRIVER_PATH_BYTES, "%s/%s", folder, name);
    return length > 0 && (size_t)length < DRIVER_PATH_BYTES;
}

void driver_folder(const char *variable, const char *name, const char *sign,
                   char out[DRIVER_PATH_BYTES])
{
    const char *asked = getenv(variable);
    if (asked && asked[0]) {
        snprintf(out, DRIVER_PATH_BYTES, "%s", asked);
        return;
    }
    char program[DRIVER_PATH_BYTES];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    for (int i = 0; i < FOLDERS_ABOVE; i++) {
        char *slash = strrchr(program, '/');
        if (!slash)
            break;
        *slash = '\0';
        char file[DRIVER_PATH_BYTES];
        if (join(out, program, name) && join(file, out, sign) && access(file, R_OK) == 0)
            return;
    }
    snprintf(out, DRIVER_PATH_BYTES, "build/%s", name);
}

static bool ends_in(const char *text, const char *end)
{
    size_t length = strlen(text), end_length = strlen(end);
    return length >= end_length && strcmp(text + length - end_length, end) == 0;
}

/* Finds the first lvp_icd*.json in the system's folders. */
static bool find_stock(char out[DRIVER_PATH_BYTES])
{
    static const char *const folders[] = {"/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d",
                                          "/usr/share/vulkan/icd.d"};
    for (size_t i = 0; i < ARRAY_COUNT(folders); i++) {
        DIR *folder = opendir(folders[i]);
        bool found = false;
        for (struct dirent *entry; folder && !found && (entry = readdir(folder));)
            found = strncmp(entry->d_name, "lvp_icd", 7) == 0 && ends_in(entry->d_name, ".json") &&
                    join(out, folders[i], entry->d_name);
        if (folder)
            (void)closedir(folder);
        if (found)
            return true;
    }
    return false;
}

static enum status find_fetched(const char *name, struct driver *out, struct reason *reason)
{
    char folder[DRIVER_PATH_BYTES], place[DRIVER_PATH_BYTES];
    driver_folder("RAYDIFF_DRIVERS", "drivers", "versions", folder);
    out->fetched = true;
    if (!join(place, folder, name) || !join(out->icd, place, "icd.json") ||
        access(out->icd, R_OK) != 0)
        return fail(reason, STATUS_UNSUPPORTED,
                    "vulkan: driver %s is not in %.160s: run make drivers", name, folder);
    return STATUS_OK;
}

enum status driver_find(const char *text, struct driver *out, struct reason *reason)
{
    *out = (struct driver){.kind = DRIVER_FILE, .text = text};
    if (!text) {
        out->kind = DRIVER_ANY;
        return STATUS_OK;
    }
    if (strcmp(text, "hardware") == 0) {
        out->kind = DRIVER_HARDWARE;
        return STATUS_OK;
    }
    if (strcmp(text, "stock") == 0) {
        if (find_stock(out->icd))
            return STATUS_OK;
        return fail(reason, STATUS_UNSUPPORTED,
                    "vulkan: driver stock: the system has no lvp_icd*.json: install Mesa's Vulkan "
                    "drivers");
    }
    if (strcmp(text, "mesa25") == 0 || strcmp(text, "swiftshader") == 0)
        return find_fetched(text, out, reason);
    if (!strchr(text, '/') && !ends_in(text, ".json")) {
        out->kind = DRIVER_PART;
        return STATUS_OK;
    }
    int length = snprintf(out->icd, sizeof out->icd, "%s", text);
    if (length < 0 || (size_t)length >= sizeof out->icd || access(out->icd, R_OK) != 0)
        return fail(reason, STATUS_UNSUPPORTED, "vulkan: driver file %.200s cannot be read", text);
    return STATUS_OK;
}

/* Writes the folder of the driver's JSON file. */
static bool folder_of(const struct driver *driver, char out[DRIVER_PATH_BYTES])
{
    snprintf(out, DRIVER_PATH_BYTES, "%s", driver->icd);
    char *slash = strrchr(out, '/');
    if (slash)
        *slash = '\0';
    return slash != NULL;
}

void driver_version(const struct driver *driver, char *text, size_t text_bytes)
{
    char folder[DRIVER_PATH_BYTES], path[DRIVER_PATH_BYTES], line[512];
    size_t used = 0;
    text[0] = '\0';
    if (!driver->fetched || !folder_of(driver, folder) || !join(path, folder, "versions"))
        return;
    FILE *in = fopen(path, "r");
    if (!in)
        return;
    while (fgets(line, sizeof line, in)) {
        char package[128], version[128];
        if (sscanf(line, "%*s %127s %127s", package, version) != 2 || strcmp(version, "-") == 0)
            continue;
        int more =
            snprintf(text + used, text_bytes - used, "%s%s %s", used ? ", " : "", package, version);
        if (more < 0 || (size_t)more >= text_bytes - used)
            break;
        used += (size_t)more;
    }
    (void)fclose(in);
}

static bool is_driver(const char *name)
{
    return strncmp(name, "libvulkan_", 10) == 0 || strncmp(name, "libvk_", 6) == 0;
}

/* Loads the libraries beside the driver. One may need another, so they are tried until no new one
 * can be loaded. The loader reports those that are missing. */
static void load_companions(const struct driver *driver)
{
    char folder[DRIVER_PATH_BYTES], path[DRIVER_PATH_BYTES];
    if (!driver->fetched || !folder_of(driver, folder))
        return;
    size_t last, loaded = 0;
    do {
        last = loaded;
        loaded = 0;
        DIR *dir = opendir(folder);
        for (struct dirent *entry; dir && (entry = readdir(dir));)
            if (strncmp(entry->d_name, "lib", 3) == 0 && !is_driver(entry->d_name) &&
                strstr(entry->d_name, ".so") && join(path, folder, entry->d_name))
                loaded += dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE) != NULL;
        if (dir)
            (void)closedir(dir);
    } while (loaded > last);
}

/* Sets *earlier to a copy of the variable's value, or NULL if unset. Returns false without
 * memory. */
static bool keep(const char *name, char **earlier)
{
    const char *now = getenv(name);
    *earlier = now ? strdup(now) : NULL;
    return !now || *earlier;
}

static void put_back(const char *name, char *earlier)
{
    if (earlier)
        (void)setenv(name, earlier, 1);
    else
        (void)unsetenv(name);
    free(earlier);
}

enum status driver_begin(const struct driver *driver, struct driver_scope *scope,
                         struct reason *reason)
{
    *scope = (struct driver_scope){0};
    if (driver->kind != DRIVER_FILE)
        return STATUS_OK;
    load_companions(driver);
    if (!keep("VK_DRIVER_FILES", &scope->files) || !keep("VK_ICD_FILENAMES", &scope->filenames)) {
        free(scope->files);
        *scope = (struct driver_scope){0};
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the environment");
    }
    scope->active = true;
    if (setenv("VK_DRIVER_FILES", driver->icd, 1) == 0 &&
        setenv("VK_ICD_FILENAMES", driver->icd, 1) == 0)
        return STATUS_OK;
    driver_end(scope);
    return fail(reason, STATUS_MEMORY, "vulkan: no memory for the environment");
}

void driver_end(struct driver_scope *scope)
{
    if (!scope->active)
        return;
    put_back("VK_DRIVER_FILES", scope->files);
    put_back("VK_ICD_FILENAMES", scope->filenames);
    *scope = (struct driver_scope){0};
}
