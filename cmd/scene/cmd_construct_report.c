/* The report of raydiff construct on the scene it made. */
#include "cmd/scene/cmd_construct.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static json_t *model_json(const struct construct_model *model, uint32_t red)
{
    bool is_red = model->material == CONSTRUCT_DEFAULT;
    return json_record("model=%s material=%u triangles=%u vertices=%u transformed=%i mirrored=%i",
                       model->spec, is_red ? red : model->material, model->tri_count,
                       model->vertex_count, (int)model->transform.any,
                       (int)model->transform.mirrors);
}

enum status construct_json(const struct construct_options *o, const struct scene *scene,
                           const struct construct_notes *notes, json_t **out, struct reason *reason)
{
    *out = NULL;
    json_t *models = json_array();
    for (uint32_t i = 0; i < o->construct.model_count; i++)
        if (json_array_append_new(models, model_json(&o->construct.model[i], notes->red)) != 0) {
            json_decref(models);
            return fail(reason, STATUS_MEMORY, "--json: no memory");
        }
    json_t *red = notes->red == CONSTRUCT_DEFAULT ? json_null() : json_integer(notes->red);
    *out =
        json_record("raydiff=%s out=%s models=%p triangles=%u vertices=%u materials=%u "
                    "default_material=%p lights=%u camera=%s unused_vertices=%u filled_normals=%u",
                    RAYDIFF_VERSION, o->out, models, scene->tri_count, scene->vertex_count,
                    scene->material_count, red, scene->light_count,
                    scene->camera.orbit ? "orbit" : "fixed", notes->unused, notes->filled);
    return *out ? STATUS_OK : fail(reason, STATUS_MEMORY, "--json: no memory");
}

void construct_print(const struct construct_options *o, const struct scene *scene,
                     const struct construct_notes *notes)
{
    const struct construct *c = &o->construct;
    fprintf(stderr, "%s: %s, %s, %s, %s, %s, camera %s\n", o->out, COUNTED(c->model_count, "model"),
            COUNTED(scene->tri_count, "triangle"), COUNTED(scene->vertex_count, "vertex"),
            COUNTED(scene->material_count, "material"), COUNTED(scene->light_count, "light"),
            scene->camera.orbit ? "orbit" : "fixed");
    if (notes->red != CONSTRUCT_DEFAULT)
        fprintf(stderr, "material %u is the default red\n", notes->red);
    if (notes->unused)
        fprintf(stderr, "vertices of no triangle, kept, with normal 0 1 0: %u\n", notes->unused);
    if (notes->filled)
        fprintf(stderr, "vertices without a normal of their triangles', filled with 0 1 0: %u\n",
                notes->filled);
    size_t length = strlen(o->out);
    if (length < 5 || strcasecmp(o->out + length - 5, ".json") != 0)
        fprintf(stderr, "not kept, since the format has no place for them: normals, lights, "
                        "materials, camera\n");
}
