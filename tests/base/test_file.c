#define _GNU_SOURCE /* mkdtemp, symlink */
#include "ref/files/file.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/root.h"

static struct reason reason;

static const char *in_folder(const char *name)
{
    static char path[300];
    snprintf(path, sizeof path, "%s/%s", root, name);
    return path;
}

static void put(const char *name, const void *bytes, size_t size)
{
    FILE *stream = fopen(in_folder(name), "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes, 1, size, stream), size);
    assert_int_equal(fclose(stream), 0);
}

/* Reads a file of the folder and expects its text, or a reason with `text` in it. */
static void expect(const char *name, enum status status, const char *text)
{
    char *bytes;
    size_t size;
    reason.text[0] = '\0';
    assert_int_equal(file_read(in_folder(name), &bytes, &size, &reason), status);
    if (status == STATUS_OK) {
        assert_int_equal(size, strlen(text));
        assert_memory_equal(bytes, text, size + 1);
        free(bytes);
        return;
    }
    assert_null(bytes);
    assert_int_equal(size, 0);
    assert_non_null(strstr(reason.text, text));
    assert_non_null(strstr(reason.text, name));
    assert_null(strchr(reason.text, '\n'));
}

static size_t gzip(const char *text, char *out, size_t size)
{
    z_stream zip = {.next_in = (Bytef *)(uintptr_t)text, .avail_in = (uInt)strlen(text)};
    assert_int_equal(deflateInit2(&zip, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    zip.next_out = (Bytef *)out;
    zip.avail_out = (uInt)size;
    assert_int_equal(deflate(&zip, Z_FINISH), Z_STREAM_END);
    assert_int_equal(deflateEnd(&zip), Z_OK);
    return size - zip.avail_out;
}

static void file_read_gives_all_bytes(void **state)
{
    (void)state;
    put("plain", "v 1 2 3\n", 8);
    expect("plain", STATUS_OK, "v 1 2 3\n");
    put("one", "x", 1);
    expect("one", STATUS_OK, "x");
    size_t large = 3000001;
    char *text = malloc(large + 1);
    assert_non_null(text);
    for (size_t i = 0; i < large; i++)
        text[i] = (char)('a' + i % 23);
    text[large] = '\0';
    put("large", text, large);
    expect("large", STATUS_OK, text);
    free(text);
}

static void file_read_refuses_what_is_no_file(void **state)
{
    (void)state;
    expect("missing", STATUS_INPUT, "No such file");
    assert_int_equal(mkdir(in_folder("folder.obj"), 0700), 0);
    expect("folder.obj", STATUS_INPUT, "is a directory");
    put("empty", "", 0);
    expect("empty", STATUS_INPUT, "is empty");
    put("locked", "x", 1);
    assert_int_equal(chmod(in_folder("locked"), 0), 0);
    if (geteuid() != 0) /* root reads everything */
        expect("locked", STATUS_INPUT, "Permission denied");
}

static void file_read_unzips_by_content(void **state)
{
    (void)state;
    char packed[400];
    size_t size = gzip("hello mesh", packed, sizeof packed);
    put("zipped", packed, size);
    expect("zipped", STATUS_OK, "hello mesh");
    size_t second = gzip(", again", packed + size, sizeof packed - size);
    put("twice", packed, size + second);
    expect("twice", STATUS_OK, "hello mesh, again");
    size = gzip("", packed, sizeof packed);
    put("nothing", packed, size);
    expect("nothing", STATUS_INPUT, "is empty");
}

static void file_read_notices_every_cut_and_damage_of_gzip(void **state)
{
    (void)state;
    char packed[200];
    const char *text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    size_t size = gzip(text, packed, sizeof packed);
    for (size_t cut = 2; cut < size; cut++) {
        put("cut.gz", packed, cut);
        expect("cut.gz", STATUS_INPUT, "cut short");
    }
    for (size_t i = 2; i < size; i++) {
        if (i >= 4 && i < 10) /* time, system: nothing protects them */
            continue;
        packed[i] ^= 0x10;
        put("damaged.gz", packed, size);
        char *bytes;
        size_t got;
        reason.text[0] = '\0';
        assert_int_equal(file_read(in_folder("damaged.gz"), &bytes, &got, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "gzip data"));
        packed[i] ^= 0x10;
    }
    put("tail.gz", packed, size);
    memcpy(packed + size, "tail", 4);
    put("tail.gz", packed, size + 4);
    expect("tail.gz", STATUS_INPUT, "something follows the gzip data");
}

static void file_read_refuses_more_than_the_most(void **state)
{
    (void)state;
    char text[2001], packed[2000], *bytes;
    size_t size;
    memset(text, 'a', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    put("bomb.gz", packed, gzip(text, packed, sizeof packed));
    put("plain", text, sizeof text - 1);
    const char *const names[] = {"bomb.gz", "plain"};
    for (int i = 0; i < 2; i++) {
        const char *path = in_folder(names[i]);
        assert_int_equal(file_read_most(path, 1999, &bytes, &size, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "larger than 1999 bytes"));
        assert_null(bytes);
        assert_int_equal(file_read_most(path, 2000, &bytes, &size, &reason), STATUS_OK);
        assert_int_equal(size, 2000);
        free(bytes);
    }
    assert_int_equal(file_read_most("/dev/zero", 1999, &bytes, &size, &reason), STATUS_INPUT);
}

/* Zeros: what a gzip file of some kilobytes can become without a limit. */
static void file_read_stops_what_unzips_without_end(void **state)
{
    (void)state;
    const size_t large = (size_t)8 << 20;
    char *text = malloc(large + 1), *packed = malloc(large), *bytes;
    size_t size;
    assert_true(text && packed);
    memset(text, '0', large);
    for (size_t length = large; length >= FILE_UNZIPPED_FIXED; length /= 2) {
        text[length] = '\0';
        size_t zipped = gzip(text, packed, large);
        bool most = length <= FILE_UNZIPPED_TIMES * zipped + FILE_UNZIPPED_FIXED;
        put("zeros.gz", packed, zipped);
        assert_int_equal(file_read(in_folder("zeros.gz"), &bytes, &size, &reason),
                         most ? STATUS_OK : STATUS_INPUT);
        assert_int_equal(size, most ? length : 0);
        assert_int_equal(most, length == FILE_UNZIPPED_FIXED);
        if (!most)
            assert_non_null(strstr(reason.text, "unzips to more than 40 times its size"));
        free(bytes);
    }
    free(text);
    free(packed);
}

static void file_label_keeps_the_end_of_a_long_path(void **state)
{
    (void)state;
    assert_string_equal(file_label("a/b.obj"), "a/b.obj");
    char path[1000];
    memset(path, 'd', sizeof path);
    memcpy(path + sizeof path - 7, "/x.obj", 7);
    const char *label = file_label(path);
    assert_true(strlen(label) < 200);
    assert_string_equal(label + strlen(label) - 6, "/x.obj");
}

static size_t count_entries(void)
{
    DIR *listing = opendir(root);
    assert_non_null(listing);
    size_t count = 0;
    while (readdir(listing))
        count++;
    closedir(listing);
    return count;
}

static void file_out_appears_only_when_committed(void **state)
{
    (void)state;
    put("goal", "old", 3);
    size_t before = count_entries();
    struct file_out out;
    assert_int_equal(file_out_open(in_folder("goal"), &out, &reason), STATUS_OK);
    fputs("new text", out.stream);
    expect("goal", STATUS_OK, "old");
    assert_int_equal(count_entries(), out.nameless ? before : before + 1);
    file_out_discard(&out);
    assert_int_equal(count_entries(), before);
    expect("goal", STATUS_OK, "old");
    assert_int_equal(file_out_open(in_folder("goal"), &out, &reason), STATUS_OK);
    fputs("new text", out.stream);
    assert_int_equal(file_out_commit(&out, &reason), STATUS_OK);
    assert_int_equal(count_entries(), before);
    expect("goal", STATUS_OK, "new text");
    file_out_discard(&out); /* a zero struct */
    struct stat about;
    mode_t mask = umask(0);
    umask(mask);
    assert_int_equal(stat(in_folder("goal"), &about), 0);
    assert_int_equal(about.st_mode & 0777, 0666 & ~mask);
}

static void file_out_writes_through_a_link(void **state)
{
    (void)state;
    put("target", "old", 3);
    assert_int_equal(symlink("target", in_folder("link")), 0);
    struct file_out out;
    assert_int_equal(file_out_open(in_folder("link"), &out, &reason), STATUS_OK);
    fputs("new", out.stream);
    assert_int_equal(file_out_commit(&out, &reason), STATUS_OK);
    struct stat about;
    assert_int_equal(lstat(in_folder("link"), &about), 0);
    assert_true(S_ISLNK(about.st_mode));
    expect("target", STATUS_OK, "new");
}

static void file_out_failure_leaves_nothing(void **state)
{
    (void)state;
    size_t before = count_entries();
    struct file_out out;
    assert_int_equal(file_out_open(in_folder("no/such/goal"), &out, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "cannot write"));
    assert_null(out.stream);
    assert_int_equal(file_out_open(root, &out, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "is a directory"));
    /* The goal becomes a folder before the rename. */
    assert_int_equal(file_out_open(in_folder("late"), &out, &reason), STATUS_OK);
    assert_int_equal(mkdir(in_folder("late"), 0700), 0);
    fputs("text", out.stream);
    assert_int_equal(file_out_commit(&out, &reason), STATUS_INPUT);
    assert_null(out.temporary);
    assert_int_equal(rmdir(in_folder("late")), 0);
    assert_int_equal(count_entries(), before);
}

static void file_out_reports_a_full_device(void **state)
{
    (void)state;
    if (access("/dev/full", W_OK) != 0) {
        print_message("SKIP no /dev/full here\n");
        skip();
    }
    struct file_out out;
    assert_int_equal(file_out_open("/dev/full", &out, &reason), STATUS_OK);
    assert_null(out.temporary);
    fputs("text", out.stream);
    assert_int_equal(file_out_commit(&out, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "No space left"));
    assert_int_equal(access("/dev/full", W_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(file_read_gives_all_bytes),
        cmocka_unit_test(file_read_refuses_what_is_no_file),
        cmocka_unit_test(file_read_unzips_by_content),
        cmocka_unit_test(file_read_notices_every_cut_and_damage_of_gzip),
        cmocka_unit_test(file_read_refuses_more_than_the_most),
        cmocka_unit_test(file_read_stops_what_unzips_without_end),
        cmocka_unit_test(file_label_keeps_the_end_of_a_long_path),
        cmocka_unit_test(file_out_appears_only_when_committed),
        cmocka_unit_test(file_out_writes_through_a_link),
        cmocka_unit_test(file_out_failure_leaves_nothing),
        cmocka_unit_test(file_out_reports_a_full_device),
    };
    return cmocka_run_group_tests_name("file", tests, make_root, remove_root);
}
