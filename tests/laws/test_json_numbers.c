/* Numbers of JSON files that are read without a tree: those of the grammar of RFC 8259, as a
 * regular expression has it, and no other; the place told of another text is where it begins. */
#include "scenes/read/json_walk.h"

#include <regex.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define LONGEST 5

static regex_t number;

/* Text, then what follows a number in a list, or nothing. */
static void check(const char *text, const char *behind)
{
    char all[LONGEST + 8];
    const char *begin;
    struct reason reason = {""};
    int size = snprintf(all, sizeof all, "\n  %s%s", text, behind);
    struct json_walk walk = {
        .name = "n", .start = all, .at = all, .end = all + size, .reason = &reason};
    regmatch_t longest;
    enum status status = json_walk_number(&walk, &begin);
    assert_ptr_equal(begin, all + 3);
    bool is = regexec(&number, text, 1, &longest, 0) == 0 && longest.rm_eo == (int)strlen(text);
    if (is && *behind) {
        assert_int_equal(status, STATUS_OK);
        assert_ptr_equal(walk.at, all + 3 + strlen(text));
    } else if (is) { /* what reads a decimal would not stop */
        assert_int_equal(status, STATUS_INPUT);
        assert_string_equal(reason.text + strcspn(reason.text, " "), " the text is cut short");
    } else if (status == STATUS_OK) { /* then it is for what follows to be refused */
        size_t read = (size_t)(walk.at - begin);
        assert_true(read > 0 && read < strlen(text) && longest.rm_eo == (int)read);
        assert_null(strchr("0123456789", *walk.at));
    } else if (strcmp(reason.text, "n:2:3: a number must stand here") != 0) {
        fail_msg("'%s': %s", text, reason.text);
    }
}

static void numbers_are_those_of_the_grammar(void **state)
{
    (void)state;
    static const char letters[] = "019-+.eE";
    const size_t count = sizeof letters - 1;
    assert_int_equal(
        regcomp(&number, "^-?(0|[1-9][0-9]*)([.][0-9]+)?([eE][-+]?[0-9]+)?", REG_EXTENDED), 0);
    for (size_t length = 1, all = count; length <= LONGEST; length++, all *= count)
        for (size_t i = 0; i < all; i++) {
            char text[LONGEST + 1] = "";
            for (size_t k = 0, rest = i; k < length; k++, rest /= count)
                text[k] = letters[rest % count];
            check(text, ",");
            check(text, "");
        }
    check("", ",");
    check("x", ",");
    regfree(&number);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(numbers_are_those_of_the_grammar)};
    return cmocka_run_group_tests_name("json_numbers", tests, NULL, NULL);
}
