#include "tests/truth/tally.h"

#include "ref/files/file.h"
#include "scenes/scenes.h"

#include <string.h>

static bool same_signature(const struct wrong_answer *a, const struct wrong_answer *b)
{
    return a->who.engine == b->who.engine && a->who.layout == b->who.layout &&
           a->who.box == b->who.box && a->who.tri == b->who.tri &&
           a->judgement.wrong == b->judgement.wrong && a->cause == b->cause;
}

struct signature *tally_add(struct tally *tally, const struct wrong_answer *wrong)
{
    size_t i = 0;
    while (i < tally->count && !same_signature(&tally->signature[i].first, wrong))
        i++;
    if (i == SIGNATURES_MOST) {
        tally->beyond++;
        return NULL;
    }
    struct signature *signature = &tally->signature[i];
    if (i == tally->count) {
        tally->count++;
        *signature = (struct signature){.first = *wrong};
    }
    signature->count++;
    signature->opinion[wrong->opinion]++;
    if (wrong->opinion != GMP_CONFIRMED && tally->doubtful_count < DOUBTFUL_MOST)
        tally->doubtful[tally->doubtful_count++] = *wrong;
    return signature;
}

void signature_name(const struct signature *signature, char *text, size_t text_bytes)
{
    const struct tally_contestant *who = &signature->first.who;
    snprintf(text, text_bytes, "%s.%s.%s.%s.%s.%s", who->engine->name,
             who->layout ? who->layout->name : "-", who->layout ? who->box->name : "-",
             who->tri->name, wrong_name(signature->first.judgement.wrong),
             cause_name(signature->first.cause));
}

void wrong_answer_print(const struct wrong_answer *wrong, FILE *stream)
{
    char line[640];
    judge_line(&wrong->ray, &wrong->judgement, &wrong->hit, line, sizeof line);
    fprintf(stream, "%s: %s, rays %s, seed %llu, index %zu, %s %s %s: %s\n",
            gmp_opinion_name(wrong->opinion), wrong->scene, wrong->rays,
            (unsigned long long)wrong->seed, wrong->index, wrong->who.engine->name,
            wrong->who.layout ? wrong->who.layout->name : "-", wrong->who.tri->name, line);
}

static void write_answer(const struct wrong_answer *answer, FILE *stream)
{
    char line[640];
    judge_line(&answer->ray, &answer->judgement, &answer->hit, line, sizeof line);
    fprintf(stream, "%s\n", line);
    if (answer->mode.mask)
        fprintf(stream, "  mask 0x%02x, flags 0x%03x, tag 0x%08x\n", answer->mode.mask,
                answer->mode.flags, answer->tag);
    fprintf(stream, "  by rationals: %s\n", gmp_opinion_name(answer->opinion));
}

static void write_command(const struct wrong_answer *answer, const char *scene, FILE *stream)
{
    const struct tally_contestant *who = &answer->who;
    const struct ray *ray = &answer->ray;
    fprintf(stream, "  raydiff explain %s --engine %s", scene, who->engine->name);
    if (!who->engine->own_tri)
        fprintf(stream, " --tri %s", who->tri->name);
    if (who->layout)
        fprintf(stream, " --layout %s --box %s", who->layout->name, who->box->name);
    fprintf(stream, " --ray '%a,%a,%a %a,%a,%a %a,%a'\n", (double)ray->org[0], (double)ray->org[1],
            (double)ray->org[2], (double)ray->dir[0], (double)ray->dir[1], (double)ray->dir[2],
            (double)ray->tmin, (double)ray->tmax);
}

static enum status write_signature(const struct signature *signature, const char *dir,
                                   struct reason *reason)
{
    char name[160], path[512], mesh[512];
    struct file_out out;
    signature_name(signature, name, sizeof name);
    snprintf(path, sizeof path, "%s/%s.txt", dir, name);
    snprintf(mesh, sizeof mesh, "%s/%s.ply", dir, name);
    enum status status = STATUS_OK;
    if (signature->smallest.scene.tri_count > 0)
        status = scene_write(mesh, &signature->smallest.scene, reason);
    if (status == STATUS_OK)
        status = file_out_open(path, &out, reason);
    if (status)
        return status;
    fprintf(out.stream, "%s: %zu wrong answers; by rationals", name, signature->count);
    for (enum gmp_opinion k = 0; k < GMP_OPINION_COUNT; k++)
        fprintf(out.stream, " %s %zu", gmp_opinion_name(k), signature->opinion[k]);
    fprintf(out.stream, "\ncause: %s\n\nfirst: %s, rays %s, seed %llu, index %zu\n",
            cause_text(signature->first.cause), signature->first.scene, signature->first.rays,
            (unsigned long long)signature->first.seed, signature->first.index);
    write_answer(&signature->first, out.stream);
    if (signature->smallest.scene.tri_count > 0) {
        fprintf(out.stream, "\nsmallest: %u triangles, %s.ply, from %s\n",
                signature->smallest.scene.tri_count, name, signature->smallest.answer.scene);
        write_answer(&signature->smallest.answer, out.stream);
        snprintf(mesh, sizeof mesh, "%s.ply", name);
        write_command(&signature->smallest.answer, mesh, out.stream);
    }
    return file_out_commit(&out, reason);
}

enum status tally_write(const struct tally *tally, const char *dir, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < tally->count && status == STATUS_OK; i++)
        status = write_signature(&tally->signature[i], dir, reason);
    return status;
}

void tally_free(struct tally *tally)
{
    for (size_t i = 0; i < tally->count; i++)
        scene_free(&tally->signature[i].smallest.scene);
    tally->count = 0;
}
