/* The folder of pages: it appears with all its files, or not at all. */
#define _GNU_SOURCE /* renameat2 */
#include "cmd/web/cmd_web.h"

#include "ref/files/folder.h"
#include "ref/files/temporary.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static enum status must_be_page(void *user, const char *name, struct reason *reason)
{
    static const char ending[] = ".html";
    const size_t length = strlen(name), least = sizeof ending - 1;
    if (length > least && strcmp(name + length - least, ending) == 0)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%s: holds %.80s, which is no page: --force replaces pages",
                file_label(user), name);
}

/* What has the name already is a folder of pages, and may be replaced. */
static enum status check_goal(const char *goal, bool force, struct reason *reason)
{
    struct stat about;
    struct folder folder;
    char name[FOLDER_PATH_MOST];
    if (lstat(goal, &about) != 0)
        return STATUS_OK;
    if (!S_ISDIR(about.st_mode))
        return fail(reason, STATUS_INPUT, "%s: exists and is no folder", file_label(goal));
    if (!force)
        return fail(reason, STATUS_INPUT, "%s: exists; --force replaces it", file_label(goal));
    snprintf(name, sizeof name, "%s", goal);
    enum status status = folder_open(goal, false, &folder, reason);
    if (status)
        return status;
    status = folder_list(&folder, must_be_page, name, reason);
    folder_close(&folder);
    return status;
}

/* Splits the goal into its folder and its name. */
static void split(const char *goal, char parent[FOLDER_PATH_MOST], const char **name)
{
    const char *slash = strrchr(goal, '/');
    *name = slash ? slash + 1 : goal;
    snprintf(parent, FOLDER_PATH_MOST, "%.*s", slash ? (int)(slash - goal) : 1, slash ? goal : ".");
    if (slash == goal)
        strcpy(parent, "/");
}

enum status web_folder_open(const char *goal, bool force, struct web_folder *out,
                            struct reason *reason)
{
    char parent[FOLDER_PATH_MOST], hidden[FOLDER_PATH_MOST];
    const char *name;
    size_t length = strlen(goal);
    *out = (struct web_folder){.held = -1, .force = force};
    while (length > 1 && goal[length - 1] == '/')
        length--;
    if (length == 0 || length + 32 > sizeof out->goal || strcmp(goal, "/") == 0)
        return fail(reason, STATUS_INPUT, "'%s' cannot be a folder's name", file_label(goal));
    memcpy(out->goal, goal, length);
    enum status status = check_goal(out->goal, force, reason);
    if (status)
        return status;
    split(out->goal, parent, &name);
    snprintf(hidden, sizeof hidden, ".%.4000s.raydiff", name); /* no name that a user gives */
    out->held = temporary_folder(parent, hidden, &out->path);
    if (out->held >= 0)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%s: cannot be made: %s", file_label(out->goal),
                strerror(errno));
}

enum status web_folder_commit(struct web_folder *folder, struct reason *reason)
{
    const mode_t mask = umask(0);
    umask(mask);
    int code = chmod(folder->path, 0777 & ~mask);
    if (!code && folder->force)
        code = renameat2(AT_FDCWD, folder->path, AT_FDCWD, folder->goal, RENAME_EXCHANGE);
    const bool exchanged = !code && folder->force;
    if (!folder->force || (code && errno == ENOENT))
        code = rename(folder->path, folder->goal);
    if (code)
        return fail(reason, STATUS_INPUT, "%s: cannot be written: %s", file_label(folder->goal),
                    strerror(errno));
    if (!exchanged) {
        free(folder->path);
        folder->path = NULL;
    }
    web_folder_discard(folder); /* what was exchanged is the old one */
    return STATUS_OK;
}

void web_folder_discard(struct web_folder *folder)
{
    if (folder->path)
        (void)!temporary_folder_remove(folder->path);
    if (folder->held >= 0)
        close(folder->held);
    free(folder->path);
    *folder = (struct web_folder){.held = -1};
}
