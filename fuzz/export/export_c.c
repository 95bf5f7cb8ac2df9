/* The finding as a C program: its data, and the templates around them. */
#include "fuzz/export/export_inner.h"
#include "fuzz/export/export_template.h"
#include "ref/base/decimal.h"
#include "ref/base/float_word.h"

#include <string.h>

/* Rays beyond this many are printed only if they are wrong. */
#define PRINTED 8

/* --- numbers --- */

static void put_float(float x, FILE *to)
{
    char text[FLOAT_WORD_MOST];
    float_word_write(x, text);
    if (float_is_finite(x))
        fprintf(to, "%sf", text);
    else
        fputs(x > 0 ? "INFINITY" : "-INFINITY", to);
}

static void put_decimals(const float *x, int count, FILE *to)
{
    char text[DECIMAL_TEXT];
    for (int i = 0; i < count; i++) {
        if (float_is_finite(x[i]))
            decimal_write_float(x[i], text);
        else
            snprintf(text, sizeof text, "%s", x[i] > 0 ? "inf" : x[i] < 0 ? "-inf" : "nan");
        fprintf(to, "%s%s", i ? " " : "", text);
    }
}

/* "0x1p+0f, 0x0p+0f" and `after`, then a comment: `what` and the decimals. */
static void put_floats(const float *x, int count, const char *after, const char *what, FILE *to)
{
    for (int i = 0; i < count; i++) {
        put_float(x[i], to);
        fputs(i + 1 < count ? ", " : after, to);
    }
    fprintf(to, " /* %s", what);
    put_decimals(x, count, to);
    fputs(" */\n", to);
}

static void put_words(const uint32_t *word, size_t count, size_t per_line, FILE *to)
{
    for (size_t i = 0; i < count; i++) {
        if (i % per_line == 0)
            fputs("   ", to);
        fprintf(to, " 0x%08x,", word[i]);
        if (i % per_line == per_line - 1 || i + 1 == count)
            fputc('\n', to);
    }
}

/* --- rays and answers --- */

/* NaNs have payloads that no constant of C has: then all numbers are words. */
static bool have_nan(const struct export_case *the)
{
    for (uint32_t i = 0; i < the->ray_count; i++)
        for (int k = 0; k < 8; k++) {
            float x;
            memcpy(&x, (const char *)&the->ray[i] + 4 * k, sizeof x);
            if (x != x)
                return true;
        }
    return false;
}

static void put_rays(const struct export_case *the, FILE *to)
{
    bool words = have_nan(the);
    fprintf(to, "/* Origin, tmin, direction, tmax%s. */\nstatic const %s rays[RAYS][8] = {\n",
            words ? ", as bits" : "", words ? "uint32_t" : "float");
    for (uint32_t i = 0; i < the->ray_count; i++) {
        float number[8];
        uint32_t word[8];
        memcpy(number, &the->ray[i], sizeof number);
        memcpy(word, &the->ray[i], sizeof word);
        if (the->number[i] != i)
            fprintf(to, "    /* ray %u of the finding */\n", the->number[i]);
        fputs("    {", to);
        if (words) {
            for (int k = 0; k < 8; k++)
                fprintf(to, "%s0x%08x", k ? ", " : "", word[k]);
            fputs("}, /* ", to);
            put_decimals(number, 8, to);
            fputs(" */\n", to);
            continue;
        }
        put_floats(number, 4, ",", "", to);
        fputs("     ", to);
        put_floats(number + 4, 4, "},", "", to);
    }
    fputs("};\n\n", to);
}

/* A right answer, an interval a line. */
static void put_right(const struct export_case *the, const struct export_right *right, FILE *to)
{
    if (right->prim == ABI_NO_PRIM || export_is_unnamed(the)) {
        fprintf(to, "    {%u, %s, {0, 0}, {0, 0}, {0, 0}}, /* ray %u: %s */\n", right->ray,
                right->prim == ABI_NO_PRIM ? "MISS" : "0", right->ray,
                right->prim == ABI_NO_PRIM ? "a miss" : "a hit");
        return;
    }
    fprintf(to, "    {%u, %u, /* ray %u: triangle %u */\n     {", right->ray, right->prim,
            right->ray, right->prim);
    put_floats(right->t, 2, "},", "t: ", to);
    if (export_is_followed(the)) {
        fputs("     {-INFINITY, INFINITY}, {-INFINITY, INFINITY}}, /* u and v: see is_there */\n",
              to);
        return;
    }
    fputs("     {", to);
    put_floats(right->u, 2, "},", "u: ", to);
    fputs("     {", to);
    put_floats(right->v, 2, "}},", "v: ", to);
}

static void put_rights(const struct export_case *the, FILE *to)
{
    fprintf(
        to,
        "/* Every right answer; a ray without an entry is out of contract and any answer is right. "
        "*/\n#define RIGHTS %zuu\nstatic const struct right rights[] = {\n",
        the->right_count ? the->right_count : 1);
    if (!the->right_count)
        fputs("    {.ray = 0xFFFFFFFFu, .prim = MISS}, /* of no ray */\n", to);
    for (size_t i = 0; i < the->right_count; i++)
        put_right(the, &the->right[i], to);
    fputs("};\n\n", to);
}

static void put_references(const struct export_case *the, FILE *to)
{
    if (!the->reference)
        return;
    fputs("/* What C answers on the same bytes: the bits of t, u and v, and the triangle. */\n"
          "static const uint32_t references[RAYS][4] = {\n",
          to);
    for (uint32_t i = 0; i < the->ray_count; i++) {
        const struct hit *hit = &the->reference[i];
        const float number[3] = {hit->t, hit->u, hit->v};
        fprintf(to, "    {0x%08x, 0x%08x, 0x%08x, ", float_bits(hit->t), float_bits(hit->u),
                float_bits(hit->v));
        if (hit->prim == ABI_NO_PRIM)
            fputs("MISS}, /* a miss */\n", to);
        else {
            fprintf(to, "%u}, /* ", hit->prim);
            put_decimals(number, 3, to);
            fputs(" */\n", to);
        }
    }
    fputs("};\n\n", to);
}

static void put_answers(const struct export_case *the, FILE *to)
{
    fprintf(to, "#define RAYS %uu\n#define PRINTED %d /* more rays: only those that are wrong */\n",
            the->ray_count, PRINTED);
    fprintf(to, "#define UNNAMED %d /* answers do not say which triangle is hit */\n\n",
            export_is_unnamed(the));
    put_rays(the, to);
    put_rights(the, to);
    if (the->reference)
        fprintf(to, "#define BITS_MATTER %d /* other bits than C's are WRONG */\n\n",
                the->bits_matter);
    put_references(the, to);
}

/* --- scene --- */

static void put_mesh(const struct export_case *the, FILE *to)
{
    const struct scene *scene = &the->trial->scene;
    fprintf(to,
            "#define VERTICES  %uu\n#define TRIANGLES %uu\n\n"
            "static const float vertices[VERTICES][3] = {\n",
            scene->vertex_count, scene->tri_count);
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        fputs("    {", to);
        put_floats(scene->vertex + 3 * (size_t)i, 3, "},", "", to);
    }
    fputs("};\n\nstatic const uint32_t indices[TRIANGLES][3] = {\n", to);
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        const uint32_t *index = scene->index + 3 * (size_t)i;
        fprintf(to, "    {%u, %u, %u},\n", index[0], index[1], index[2]);
    }
    fputs("};\n\n", to);
}

/* Triangles as the shaders read them. */
static void put_triangles(const struct export_case *the, FILE *to)
{
    const struct scene *scene = &the->trial->scene;
    if (!scene->tri_count)
        return;
    fprintf(to, "static const float triangles[%u][3][3] = {\n", scene->tri_count);
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        float v[3][3];
        char what[40];
        scene_tri(scene, i, v);
        snprintf(what, sizeof what, "triangle %u: ", i);
        for (int c = 0; c < 3; c++) {
            fputs(c ? "     {" : "    {{", to);
            put_floats(v[c], 3, c < 2 ? "}," : "}},", c ? "" : what, to);
        }
    }
    fputs("};\n\n", to);
}

/* --- dispatch --- */

static void put_constants(const struct export_case *the, FILE *to)
{
    static const char *const names[DISPATCH_CONSTANTS] = {
        [ABI_SPEC_WORKGROUP] = "rays of a workgroup",
        [ABI_SPEC_BOX] = "box test",
        [ABI_SPEC_TRI] = "triangle test",
        [ABI_SPEC_QUERY] = "query",
        [ABI_SPEC_STACK] = "entries of the traversal stack",
        [ABI_SPEC_STORE] = "triangle storage",
        [ABI_SPEC_LAYOUT_0] = "member of the layout's family",
        [ABI_SPEC_LAYOUT_1] = "its second number"};
    const char *values[DISPATCH_CONSTANTS] = {
        [ABI_SPEC_BOX] = the->layout ? the->trial->box->name : "not used",
        [ABI_SPEC_TRI] = the->subject == SUBJECT_QUERY ? "not used" : the->trial->tri->name,
        [ABI_SPEC_QUERY] = query_name(the->trial->query)};
    const struct push *push = &the->dispatch.push;
    fprintf(to,
            "/* Specialization constants 0 to %u. */\n#define CONSTANTS %u\n"
            "static const uint32_t constants[CONSTANTS] = {\n",
            DISPATCH_CONSTANTS - 1, DISPATCH_CONSTANTS);
    for (uint32_t i = 0; i < DISPATCH_CONSTANTS; i++)
        fprintf(to, "    %u, /* %s%s%s */\n", the->dispatch.constant[i], names[i],
                values[i] ? ": " : "", values[i] ? values[i] : "");
    fprintf(to,
            "};\n\nstatic const uint32_t push[] = {\n    %u, /* rays */\n    %u, /* root record%s "
            "*/\n    %u, /* %s */\n    %u, /* words of items */\n    %u, /* triangles */\n    %u, "
            "/* hits of a ray */\n};\n\n#define GROUPS %uu\n\n",
            push->ray_count, push->root,
            the->subject == SUBJECT_BRUTE ? ": here the first triangle" : "", push->node_count,
            the->subject == SUBJECT_BRUTE ? "one past the last triangle" : "records",
            push->item_count, push->tri_count, push->capacity,
            dispatch_groups(&the->dispatch, the->ray_count));
}

static void put_contents(const struct export_case *the, FILE *to)
{
    struct export_buffer buffer[DISPATCH_BINDINGS];
    export_buffers(the, buffer);
    fprintf(
        to,
        "/* Storage buffers 0 to %u: what they begin with (the rest is 0), and their size. */\n"
        "#define BINDINGS %uu\n#define HITS     %u\n#define FLAGS    %u\n"
        "#define FINISHED %uu /* in flags: the invocation ran to its end, without complaint */\n"
        "static const struct {\n    const void *data;\n    size_t data_bytes, bytes;\n"
        "} contents[BINDINGS] = {\n",
        DISPATCH_BINDINGS - 1, DISPATCH_BINDINGS, (unsigned)ABI_BIND_HITS, (unsigned)ABI_BIND_FLAGS,
        ABI_FLAG_DONE);
    for (uint32_t i = 0; i < DISPATCH_BINDINGS; i++)
        if (buffer[i].data_bytes)
            fprintf(to, "    {%s, sizeof %s, %llu},\n", buffer[i].name, buffer[i].name,
                    (unsigned long long)buffer[i].bytes);
        else
            fprintf(to, "    {NULL, 0, %llu}, /* %s */\n", (unsigned long long)buffer[i].bytes,
                    buffer[i].name);
    fputs("};\n\n", to);
}

static void put_dispatch(const struct export_case *the, FILE *to)
{
    const struct shader *shader = the->dispatch.shader;
    put_constants(the, to);
    if (the->packed.word_count) {
        fprintf(to,
                "/* The tree: a record of layout %s a line. */\n"
                "static const uint32_t nodes[] = {\n",
                the->layout->name);
        put_words(the->packed.word, the->packed.word_count, the->layout->node_bytes / 4, to);
        fputs("};\n\n", to);
    }
    if (the->packed.item_count) {
        fputs("static const uint32_t items[] = {\n", to);
        put_words(the->packed.item, the->packed.item_count, 8, to);
        fputs("};\n\n", to);
    }
    if (the->subject == SUBJECT_QUERY)
        put_mesh(the, to);
    else
        put_triangles(the, to);
    put_contents(the, to);
    fprintf(to, "/* SPIR-V of raydiff's shader %s. */\nstatic const uint32_t shader[] = {\n",
            shader->name);
    put_words(shader->word, shader->word_count, 8, to);
    fputs("};\n", to);
}

static void put_data(const void *user, FILE *to)
{
    const struct export_case *the = user;
    fputs("/* --- the finding --- */\n\n", to);
    put_answers(the, to);
    if (export_is_vulkan(the))
        put_dispatch(the, to);
    else
        put_mesh(the, to);
}

void export_write_c(const struct export_case *the, FILE *to)
{
    const char *defined[8] = {NULL};
    int count = 0;
    if (the->reference)
        defined[count++] = "REFERENCE";
    if (the->subject == SUBJECT_QUERY)
        defined[count++] = "RAY_QUERY";
    if (the->subject == SUBJECT_EMBREE_ROBUST)
        defined[count++] = "ROBUST";
    if (the->trial->query == QUERY_ANY)
        defined[count++] = "ANY";
    if (export_is_followed(the))
        defined[count++] = "FOLLOWED";
    fputs("/*\n", to);
    export_comment(the, " * ", to);
    fputs(" */\n", to);
    export_template_write(export_is_vulkan(the) ? "vulkan.c" : "embree.c", defined, put_data, the,
                          to);
}
