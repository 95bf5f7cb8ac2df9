/* The comment of an exported finding: whatever a text of others holds, every character of it is
 * there, none ends the comment, and no line is too long. */
#include "tests/gpu/exported.h"

#define LONGEST 96

static struct reason why;

/* The comment with this in place of why the engine was not asked; the caller frees it. */
static char *comment_with(struct export_case *the, const char *begin, const char *text)
{
    static char *out; /* gcc 12 takes the text for the pointer's own place if that is a local one */
    size_t size = 0;
    FILE *stream = open_memstream(&out, &size);
    assert_non_null(stream);
    snprintf(the->not_asked, sizeof the->not_asked, "%s", text);
    export_comment(the, begin, stream);
    assert_int_equal(fclose(stream), 0);
    return out;
}

/* The paragraph of that title as one line, a blank for each of its ends. */
static void paragraph(const char *comment, const char *begin, const char *title, char *out)
{
    char head[80];
    size_t used = 0;
    snprintf(head, sizeof head, "\n%s%-12s", begin, title);
    const char *at = strstr(comment, head);
    assert_non_null(at);
    at += strlen(head);
    snprintf(head, sizeof head, "\n%s%-12s", begin, "");
    for (; *at; at++) {
        if (*at == '\n') {
            if (strncmp(at, head, strlen(head)) != 0)
                break;
            at += strlen(head) - 1;
            out[used++] = ' ';
        } else {
            out[used++] = *at;
        }
    }
    out[used] = '\0';
}

static void check(struct export_case *the, const char *begin, const char *text, const char *wanted)
{
    static const char before[] = "it was not run where this file was written: ";
    char is[600];
    char *comment = comment_with(the, begin, text);
    paragraph(comment, begin, "Answered", is);
    assert_int_equal(strncmp(is, before, strlen(before)), 0);
    assert_string_equal(is + strlen(before), wanted);
    assert_null(strstr(comment, "*/"));
    assert_null(strstr(comment, "/*"));
    for (const char *line = comment; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        assert_true(strcspn(line, "\n") <= LONGEST);
    }
    free(comment);
}

static void every_character_is_there_or_replaced(void **state)
{
    (void)state;
    static const char *const begins[] = {"// ", "# "};
    struct finding_file file = corpus_file("wrong-item");
    struct export_case the = make_case(&file, "vulkan_brute", NULL);
    assert_null(the.here);
    for (size_t b = 0; b < ARRAY_COUNT(begins); b++)
        for (int c = 1; c < 256; c++) {
            char text[20], wanted[20], is = (char)(c < 0x20 || c > 0x7E ? '?' : c);
            if (c == ' ')
                continue;
            snprintf(text, sizeof text, "a%cb %cx y%c", c, c, c);
            snprintf(wanted, sizeof wanted, "a%cb %cx y%c", is, is, is);
            check(&the, begins[b], text, wanted);
        }
    export_case_free(&the);
    finding_file_free(&file);
}

static void no_text_ends_a_comment(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {{"a */ b", "a |/ b"},
                                           {"a /* b", "a |* b"},
                                           {"/*/", "||/"},
                                           {"*/", "|/"},
                                           {"a/ *b", "a/ *b"},
                                           {"**/", "*|/"},
                                           {"//* x */*", "/|* x ||*"},
                                           {"/ / * * /", "/ / * * /"}};
    struct finding_file file = corpus_file("wrong-item");
    struct export_case the = make_case(&file, "vulkan_brute", NULL);
    for (size_t i = 0; i < ARRAY_COUNT(pairs); i++)
        check(&the, "// ", pairs[i][0], pairs[i][1]);
    export_case_free(&the);
    finding_file_free(&file);
}

/* Words of all lengths at every place of a line. */
static void lines_break_between_words(void **state)
{
    (void)state;
    struct finding_file file = corpus_file("wrong-item");
    struct export_case the = make_case(&file, "vulkan_brute", NULL);
    for (size_t first = 1; first < 60; first++)
        for (size_t second = 1; second < 60; second += 7) {
            char text[160] = "";
            memset(text, 'a', first);
            text[first] = ' ';
            memset(text + first + 1, 'b', second);
            strcat(text, " c d");
            check(&the, "# ", text, text);
        }
    export_case_free(&the);
    finding_file_free(&file);
}

/* The comment of an export with this name, or none, and form. */
static char *comment_of(const struct export_case *the)
{
    static char *out;
    size_t size = 0;
    FILE *stream = open_memstream(&out, &size);
    assert_non_null(stream);
    export_comment(the, "// ", stream);
    assert_int_equal(fclose(stream), 0);
    return out;
}

/* A program is told to be compiled to the part of its name before the first '.'; a name that has
 * none, or no name, has a plain one. */
static void a_file_is_run_by_its_name(void **state)
{
    (void)state;
    static const struct {
        const char *name, *file[2], *program; /* in C, and as a script */
    } named[] = {{NULL, {"finding.c", "finding.amber"}, "finding"},
                 {"", {"finding.c", "finding.amber"}, "finding"},
                 {".c", {".c", ".c"}, "finding"},
                 {"a.b.c", {"a.b.c", "a.b.c"}, "a"},
                 {"plain", {"plain", "plain"}, "plain"}};
    struct finding_file file = generated_file(3, 1, QUERY_CLOSEST);
    for (size_t i = 0; i < ARRAY_COUNT(named); i++)
        for (int amber = 0; amber < 2; amber++) {
            struct export_case the = make_case(&file, "vulkan_brute", NULL);
            struct export_options options = *the.options;
            char wanted[200], is[600];
            options.form = amber ? EXPORT_AMBER : EXPORT_C;
            options.name = named[i].name;
            the.options = &options;
            snprintf(wanted, sizeof wanted,
                     amber
                         ? "amber -v 1.1 -t vulkan1.1 %s It passes where the driver is right, and "
                           "fails while the bug shows."
                         : "cc %s -lvulkan -o %s && ./%s [DEVICE]",
                     named[i].file[amber], named[i].program, named[i].program);
            char *comment = comment_of(&the);
            paragraph(comment, "// ", "Run", is);
            assert_string_equal(is, wanted);
            free(comment);
            export_case_free(&the);
        }
    finding_file_free(&file);
}

/* What each exit code means: of a crash that it shows by one, of nothing else. */
static void exit_codes_are_told_by_the_kind_of_finding(void **state)
{
    (void)state;
    static const char *const engine[] = {"vulkan", "rayquery", "embree", "embree_robust"};
    for (size_t e = 0; e < ARRAY_COUNT(engine); e++) {
        struct finding_file file = generated_file(4, 2, QUERY_CLOSEST);
        struct export_case the = make_case(&file, engine[e], e ? NULL : "f32");
        for (int k = 0; k < 2 * FUZZ_KIND_COUNT; k++) {
            const bool crash = k == 2 * FUZZ_KIND_CRASH + 1;
            char wanted[300], is[600];
            file.has_signature = k % 2;
            file.signature.kind = (enum fuzz_kind)(k / 2);
            snprintf(wanted, sizeof wanted,
                     "0 every answer is right (fixed), 1 the bug shows%s, 2 it cannot run here.",
                     crash ? " (or the program crashes)" : "");
            char *comment = comment_of(&the);
            paragraph(comment, "// ", "Exit code", is);
            assert_string_equal(is, wanted);
            free(comment);
        }
        export_case_free(&the);
        finding_file_free(&file);
    }
}

static char *program_of(const struct export_case *the)
{
    static char *out;
    size_t size = 0;
    FILE *stream = open_memstream(&out, &size);
    assert_non_null(stream);
    export_write_c(the, stream);
    assert_int_equal(fclose(stream), 0);
    return out;
}

/* A program has the code that its engine, its query and what is known of its formula ask for, and
 * no other. */
static void a_program_has_the_code_that_it_needs(void **state)
{
    (void)state;
    static const char *const engine[] = {"vulkan", "vulkan_brute", "rayquery", "embree",
                                         "embree_robust"};
    size_t referred = 0, followed = 0;
    for (size_t e = 0; e < ARRAY_COUNT(engine); e++)
        for (int any = 0; any < 2; any++) {
            const bool embree = e > 2;
            struct finding_file file = generated_file(5, 2, any ? QUERY_ANY : QUERY_CLOSEST);
            struct export_case the = make_case(&file, engine[e], e ? NULL : "f32");
            char *program = program_of(&the);
            const struct {
                const char *code;
                bool is;
            } part[] = {{"static int is_there(", the.model.formula == TWIN_UNKNOWN},
                        {"memcpy(&reference, references[i]", the.reference != NULL},
                        {"vkCreateAccelerationStructureKHR", e == 2},
                        {"vkCmdDispatch(", !embree},
                        {"rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);", e == 4},
                        {"rtcOccluded1(", embree && any},
                        {"rtcIntersect1(", embree && !any}};
            for (size_t i = 0; i < ARRAY_COUNT(part); i++)
                if ((strstr(program, part[i].code) != NULL) != part[i].is)
                    fail_msg("%s, %s: %s", engine[e], any ? "any" : "closest", part[i].code);
            followed += the.model.formula == TWIN_UNKNOWN;
            referred += the.reference != NULL;
            free(program);
            export_case_free(&the);
            finding_file_free(&file);
        }
    assert_true(followed > 0 && referred > 0);
}

/* The text names query and engine, of one ray and of several, for the nearest hit and any. */
static void the_question_is_told(void **state)
{
    (void)state;
    static const char *const engine[] = {"vulkan", "vulkan_brute", "rayquery"};
    static const char *const asked[] = {
        "a compute shader %s among %u triangles, by a tree of ",
        "a compute shader %s among %u triangles; it tests each of them ",
        "the driver's ray queries (VK_KHR_ray_query) %s among %u triangles."};
    for (size_t e = 0; e < ARRAY_COUNT(engine); e++)
        for (uint32_t rays = 1; rays < 4; rays++)
            for (int any = 0; any < 2; any++) {
                struct finding_file file =
                    generated_file(5 + rays, rays, any ? QUERY_ANY : QUERY_CLOSEST);
                struct export_case the = make_case(&file, engine[e], e ? NULL : "f32");
                char wanted[300];
                int used = snprintf(wanted, sizeof wanted,
                                    rays == 1 ? "One ray asks " : "%u rays ask ", rays);
                snprintf(wanted + used, sizeof wanted - (size_t)used, asked[e],
                         any ? "whether anything is hit" : "for the nearest hit",
                         file.trial.scene.tri_count);
                char *comment = comment_of(&the), *at = comment;
                for (; (at = strstr(at, "\n// ")); at++) { /* one line, to find it */
                    memmove(at, at + 3, strlen(at + 3) + 1);
                    *at = ' ';
                }
                assert_non_null(strstr(comment, wanted));
                free(comment);
                export_case_free(&the);
                finding_file_free(&file);
            }
}

/* Of a finding of bits it is told that other bits than C's are WRONG; of no other finding. */
static void bits_that_matter_are_told(void **state)
{
    (void)state;
    struct finding_file file = generated_file(3, 2, QUERY_CLOSEST);
    struct export_case the = make_case(&file, "vulkan_brute", NULL);
    for (int matter = 0; matter < 2; matter++) {
        the.bits_matter = matter;
        char *comment = comment_of(&the), is[600];
        assert_int_equal(strstr(comment, "other bits than C's") != NULL ||
                             strstr(comment, "\n// Bits ") != NULL,
                         matter);
        if (matter) {
            paragraph(comment, "// ", "Bits", is);
            assert_non_null(strstr(is, "so other bits than C's count as WRONG here."));
        }
        free(comment);
    }
    export_case_free(&the);
    finding_file_free(&file);
}

/* --- what is refused --- */

static enum status refused(const struct finding_file *file, const char *engine)
{
    struct export_options options = options_of(EXPORT_C, engine, NULL);
    struct export_case the;
    options.engines.driver = NO_DRIVER;
    why.text[0] = '\0';
    enum status status = export_case_make(file, &options, &the, &why);
    if (!status)
        export_case_free(&the);
    return status;
}

/* Of Embree some rays are left out; where none is left, there is nothing to export. */
static void embree_needs_a_ray_that_it_survives(void **state)
{
    (void)state;
    enum { RAYS = 3 };
    for (uint32_t bad = 0; bad < 1u << RAYS; bad++) {
        struct finding_file file = generated_file(4, RAYS, QUERY_CLOSEST);
        for (uint32_t i = 0; i < RAYS; i++)
            file.trial.ray[i] = (struct ray){.dir = {0, 0, 1}, .tmax = bad >> i & 1 ? NAN : 1};
        assert_int_equal(refused(&file, "vulkan_brute"), STATUS_OK);
        bool none = bad == (1u << RAYS) - 1;
        assert_int_equal(refused(&file, "embree"), none ? STATUS_INPUT : STATUS_OK);
        assert_string_equal(why.text,
                            none ? "there is no ray that Embree promises to survive" : "");
        finding_file_free(&file);
    }
}

/* Engines that build their own structure need a triangle; others none. */
static void only_trees_of_others_need_triangles(void **state)
{
    (void)state;
    static const char *const engine[] = {"vulkan", "vulkan_brute", "rayquery", "embree"};
    for (uint32_t triangles = 0; triangles < 2; triangles++)
        for (size_t e = 0; e < ARRAY_COUNT(engine); e++) {
            struct finding_file file = generated_file(4, 1, QUERY_CLOSEST);
            file.trial.scene.tri_count = triangles;
            file.trial.ray[0] = (struct ray){.dir = {0, 0, 1}, .tmax = 1};
            bool no = triangles == 0 && e >= 2;
            assert_int_equal(refused(&file, engine[e]), no ? STATUS_INPUT : STATUS_OK);
            assert_string_equal(why.text,
                                no ? "a scene without triangles has nothing to build from" : "");
            finding_file_free(&file);
        }
}

/* A shader that tests every triangle takes one dispatch of them. */
static void one_dispatch_of_triangles_is_exported(void **state)
{
    (void)state;
    for (uint32_t more = 0; more < 2; more++) {
        struct finding_file file = {0};
        assert_int_equal(fuzz_trial_make(3, DISPATCH_PART + more, 1, &file.trial, &why), STATUS_OK);
        file.trial.scene.vertex[0] = file.trial.scene.vertex[4] = 1;
        for (uint32_t i = 0; i < 3 * (DISPATCH_PART + more); i++)
            file.trial.scene.index[i] = i % 3;
        file.trial.ray[0].dir[2] = 1;
        file.trial.ray[0].org[0] = 5; /* beside */
        assert_int_equal(refused(&file, "vulkan_brute"), more ? STATUS_LIMIT : STATUS_OK);
        assert_int_equal(strstr(why.text, "takes more than 16384 triangles") != NULL, more);
        finding_file_free(&file);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_character_is_there_or_replaced),
        cmocka_unit_test(no_text_ends_a_comment),
        cmocka_unit_test(lines_break_between_words),
        cmocka_unit_test(a_file_is_run_by_its_name),
        cmocka_unit_test(exit_codes_are_told_by_the_kind_of_finding),
        cmocka_unit_test(a_program_has_the_code_that_it_needs),
        cmocka_unit_test(the_question_is_told),
        cmocka_unit_test(bits_that_matter_are_told),
        cmocka_unit_test(embree_needs_a_ray_that_it_survives),
        cmocka_unit_test(only_trees_of_others_need_triangles),
        cmocka_unit_test(one_dispatch_of_triangles_is_exported),
    };
    return cmocka_run_group_tests_name("export_words", tests, NULL, NULL) ? 1 : 0;
}
