/* Oracles of the public library for tests. Include after cmocka.h. */
#ifndef LIBRARY_FIXTURE_H
#define LIBRARY_FIXTURE_H

#include "ref/library/raydiff.h"
#include "scenes/scenes.h"

/* A scene, and the same triangles in the library. */
struct library_stand {
    struct scene scene;
    struct raydiff_oracle *oracle;
};

static inline struct library_stand library_stand(const char *spec)
{
    struct library_stand out;
    struct reason reason;
    struct raydiff_why why;
    if (scene_open(spec, 3, &out.scene, &reason))
        fail_msg("%s", reason.text);
    if (raydiff_oracle_make(out.scene.vertex, out.scene.vertex_count, out.scene.index,
                            out.scene.tri_count, &out.oracle, &why))
        fail_msg("%s", why.line);
    assert_string_equal(why.line, "");
    return out;
}

static inline void library_stand_free(struct library_stand *stand)
{
    raydiff_oracle_free(stand->oracle);
    scene_free(&stand->scene);
}

/* One triangle in the plane z = 0: (0,0,0), (4,0,0), (0,4,0). */
static const float library_vertex[] = {0, 0, 0, 4, 0, 0, 0, 4, 0};
static const uint32_t library_index[] = {0, 1, 2};

static inline struct raydiff_oracle *library_one(void)
{
    struct raydiff_oracle *oracle;
    assert_int_equal(raydiff_oracle_make(library_vertex, 3, library_index, 1, &oracle, NULL),
                     RAYDIFF_ERROR_NONE);
    return oracle;
}

#endif
