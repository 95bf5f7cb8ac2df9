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

enum status web_folder_open(const char *goal, bool force, struct web_folder *out,
                            struct reason *reason)
{
    char parent[FOLDER_PATH_MOST], *slash;
    *out = (struct web_folder){.goal = goal, .held = -1, .force = force};
    if (!goal[0] || strlen(goal) >= sizeof parent || goal[strlen(goal) - 1] == '/')
        return fail(reason, STATUS_INPUT, "'%s' cannot be a folder's name", file_label(goal));
    enum status status = check_goal(goal, force, reason);
    if (status)
        return status;
    strcpy(parent, goal);
    slash = strrchr(parent, '/');
    if (slash)
        *slash = '\0';
    const char *const in = !slash ? "." : slash == parent ? "/" : parent;
    out->held = temporary_folder(in, slash ? slash + 1 : parent, &out->path);
    if (out->held >= 0)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%s: cannot be made: %s", file_label(goal), strerror(errno));
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
    if (folder->held > 0)
        close(folder->held);
    free(folder->path);
    *folder = (struct web_folder){.goal = NULL};
}
