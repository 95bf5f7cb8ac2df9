/* raydiff diff --pixel: the path of one pixel on every engine, up to the first bit that differs. */
#include "cmd/common/cmd_json.h"
#include "ref/base/command.h"
#include "cmd/diff/cmd_diff.h"
#include "scenes/render/diff_values.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <stdio.h>

/* The report on one path by several engines. */
struct page {
    struct diff_run *run;
    struct why_judges judges;         /* of member `judged`, as side 0 */
    const struct diff_member *judged; /* the member shown last */
    int code;
};

static size_t the_pixel(const struct diff_run *run)
{
    return (size_t)run->options->y * run->stage.job.width + run->options->x;
}

static bool is_shown(const struct diff_run *run, size_t i)
{
    return run->member[i].status == STATUS_OK;
}

/* Makes the judges of the member, unless they exist. */
static enum status use_judges(struct page *page, const struct diff_member *member,
                              struct reason *reason)
{
    if (page->judged == member)
        return STATUS_OK;
    const struct model model[2] = {member->side.model, member->side.model};
    why_judges_free(&page->judges);
    page->judged = member;
    return why_judges_make(page->run->oracle, model, member->walk.shadow_query, &page->judges,
                           reason);
}

/* Judges a member's answer. A wrong answer changes the exit code, unless the member is as
 * published. */
static enum status judge_ray(struct page *page, const struct diff_member *member, bool shadow,
                             const struct ray *ray, const struct hit *hit, struct why_answer *out,
                             struct reason *reason)
{
    enum status status = use_judges(page, member, reason);
    if (!status)
        status = why_judge(&page->judges, 0, shadow, ray, hit, out, reason);
    if (!status && out->judgement.verdict == VERDICT_WRONG && !member->side.published)
        page->code = exit_worse(page->code, EXIT_MISMATCH);
    return status;
}

static void print_hit(const struct hit *hit)
{
    if (hit->prim == ABI_NO_PRIM) {
        fputs("a miss", stdout);
        return;
    }
    printf("triangle %u at t ", hit->prim);
    print_float(stdout, hit->t);
    printf(" = 0x%08x, u %.9g, v %.9g", float_bits(hit->t), (double)hit->u, (double)hit->v);
}

/* Prints the answer on one line, the truth and the verdict on the next. */
static void print_answer(const char *title, const struct why_answer *answer)
{
    const struct judgement *judgement = &answer->judgement;
    const struct oracle_answer *truth = &answer->truth;
    printf("    %-9s ", title);
    print_hit(&answer->hit);
    fputs("\n    exact     ", stdout);
    if (truth->prim == ABI_NO_PRIM)
        fputs("a miss", stdout);
    else
        printf("triangle %u%s at t in [%.17g, %.17g]", truth->prim,
               truth->tie_count > 1 ? " and others at the same t" : "", truth->t_lo, truth->t_hi);
    if (judgement->verdict == VERDICT_WRONG)
        printf(": WRONG, %s", wrong_name(judgement->wrong));
    else
        printf(": %s", verdict_name(judgement->verdict));
    if (judgement->over > 0)
        printf(", error of t %.3g of its bound", judgement->over);
    putchar('\n');
}

static void print_explain(const struct page *page, const struct diff_member *member, bool shadow,
                          const struct ray *ray)
{
    char command[EXPLAIN_COMMAND_MOST];
    diff_explain(page->run, member, shadow, ray, command);
    printf("    explain   %s\n", command);
}

static enum status print_light(struct page *page, const struct diff_member *member,
                               const struct walk_light *light, uint32_t index,
                               struct reason *reason)
{
    struct why_answer answer;
    printf("    light %-3u ", index);
    if (!light->asked) {
        printf("not traced: the light is behind the surface (normal . light %.9g)\n",
               (double)light->nl);
        return STATUS_OK;
    }
    printf("at distance ");
    print_float(stdout, light->far);
    printf(light->shadowed ? ": in the shadow\n" : ": reached\n");
    enum status status = judge_ray(page, member, true, &light->ray, &light->hit, &answer, reason);
    if (status)
        return status;
    print_answer("  met", &answer);
    print_explain(page, member, true, &light->ray);
    return STATUS_OK;
}

static enum status print_step(struct page *page, const struct diff_member *member, uint32_t segment,
                              struct reason *reason)
{
    const struct walk_step *step = walk_step_of(&member->walk, 0, segment);
    const float p[3] = {step->p.x, step->p.y, step->p.z};
    const float n[3] = {step->n.x, step->n.y, step->n.z};
    const float g[3] = {step->g.x, step->g.y, step->g.z};
    struct why_answer answer;
    enum status status = judge_ray(page, member, false, &step->ray, &step->hit, &answer, reason);
    if (status)
        return status;
    print_floats(stdout, 4, "origin", step->ray.org, 3);
    print_floats(stdout, 4, "direction", step->ray.dir, 3);
    print_answer("hit", &answer);
    print_explain(page, member, false, &step->ray);
    if (step->hit.prim != ABI_NO_PRIM) {
        print_floats(stdout, 4, "point", p, 3);
        print_floats(stdout, 4, "normal", n, 3);
        if (page->run->stage.job.look.profile == PROFILE_REPAIRED)
            print_floats(stdout, 4, "plane", g, 3);
    }
    for (uint32_t light = 0; light < member->walk.lights && step->hit.prim != ABI_NO_PRIM;
         light++) {
        status = print_light(page, member, walk_light_of(&member->walk, 0, segment, light), light,
                             reason);
        if (status)
            return status;
    }
    printf("    weight    %.9g, colour so far %.9g %.9g %.9g\n", (double)step->weight,
           (double)step->total.x, (double)step->total.y, (double)step->total.z);
    return STATUS_OK;
}

static void print_value(const struct first_bit *first, int side)
{
    if (first->is_float) {
        print_float(stdout, float_from_bits(first->bits[side]));
        putchar(' ');
    }
    printf("0x%08x", first->bits[side]);
}

static void print_first(const struct diff_run *run, const struct first_bit *first)
{
    printf("    FIRST     bit that differs from %s: %s", run->member[run->reference].engine->name,
           first->name);
    if (first->light != UINT32_MAX)
        printf(" of light %u", first->light);
    printf(", bit %u: ", first->bit);
    print_value(first, 0);
    printf(" there, ");
    print_value(first, 1);
    printf(" here");
    if (first->is_float)
        printf(", %llu float%s apart", (unsigned long long)first->ulps, plural(first->ulps));
    putchar('\n');
}

/* Prints one engine's segment in full, or that it equals the reference. */
static enum status print_member(struct page *page, size_t i, uint32_t segment,
                                struct reason *reason)
{
    const struct diff_run *run = page->run;
    const struct diff_member *member = &run->member[i];
    const struct diff_walk *walk = &member->walk;
    struct first_bit first = walk_first_bit(&run->member[run->reference].walk, walk, 0);
    bool at = first.differs && first.segment == segment;
    if (segment >= walk->length[0]) {
        printf("  %s: its path has ended\n", member->engine->name);
        if (at)
            print_first(run, &first);
        return STATUS_OK;
    }
    if (i != run->reference && (!first.differs || first.segment > segment)) {
        printf("  %s: to the bit as %s, ", member->engine->name,
               run->member[run->reference].engine->name);
        print_hit(&walk_step_of(walk, 0, segment)->hit);
        putchar('\n');
        return STATUS_OK;
    }
    printf("  %s\n", member->engine->name);
    if (at)
        print_first(run, &first);
    return print_step(page, member, segment, reason);
}

static json_t *vec_json(struct vec3 v)
{
    const float x[3] = {v.x, v.y, v.z};
    return json_floats(x, 3);
}

static json_t *ray_json(const struct ray *ray)
{
    return json_record("origin=%p direction=%p tmin=%p tmax=%p", json_floats(ray->org, 3),
                       json_floats(ray->dir, 3), json_float(ray->tmin), json_float(ray->tmax));
}

/* Returns a ray with its answer, verdict, truth and command; NULL without memory. */
static json_t *asked_json(struct page *page, const struct diff_member *member, bool shadow,
                          const struct ray *ray, const struct hit *hit)
{
    struct why_answer answer;
    struct reason unsaid;
    char command[EXPLAIN_COMMAND_MOST];
    if (judge_ray(page, member, shadow, ray, hit, &answer, &unsaid))
        return NULL;
    diff_explain(page->run, member, shadow, ray, command);
    return json_record("ray=%p hit=%p verdict=%s wrong=%s exact_triangle=%p t_lo=%g t_hi=%g "
                       "err_over_bound=%g explain=%s",
                       ray_json(ray), json_hit(hit), verdict_name(answer.judgement.verdict),
                       wrong_name(answer.judgement.wrong), json_prim(answer.truth.prim),
                       answer.truth.t_lo, answer.truth.t_hi, answer.judgement.over, command);
}

static json_t *step_json(struct page *page, const struct diff_member *member, uint32_t segment)
{
    const struct walk_step *step = walk_step_of(&member->walk, 0, segment);
    json_t *lights = json_array();
    for (uint32_t i = 0; i < member->walk.lights && step->hit.prim != ABI_NO_PRIM; i++) {
        const struct walk_light *light = walk_light_of(&member->walk, 0, segment, i);
        json_t *asked =
            light->asked ? asked_json(page, member, true, &light->ray, &light->hit) : json_null();
        json_array_append_new(
            lights, json_record("asked=%i shadowed=%i normal_light=%p distance=%p shadow_ray=%p",
                                light->asked, light->shadowed, json_float(light->nl),
                                json_float(light->far), asked));
    }
    return json_record("closest=%p point=%p normal=%p plane=%p weight=%p color=%p lights=%p",
                       asked_json(page, member, false, &step->ray, &step->hit), vec_json(step->p),
                       vec_json(step->n), vec_json(step->g), json_float(step->weight),
                       vec_json(step->total), lights);
}

static json_t *first_json(const struct first_bit *first)
{
    char bits[2][16];
    if (!first->differs)
        return json_null();
    for (int i = 0; i < 2; i++)
        snprintf(bits[i], sizeof bits[i], "0x%08x", first->bits[i]);
    return json_record(
        "segment=%u light=%p value=%s bit=%u bits=%p floats_apart=%zu", first->segment,
        first->light == UINT32_MAX ? json_null() : json_integer((json_int_t)first->light),
        first->name, first->bit, json_pack("[s, s]", bits[0], bits[1]), first->ulps);
}

static json_t *member_json(struct page *page, size_t i)
{
    const struct diff_run *run = page->run;
    const struct diff_member *member = &run->member[i];
    struct first_bit first = walk_first_bit(&run->member[run->reference].walk, &member->walk, 0);
    json_t *steps = json_array();
    for (uint32_t segment = 0; segment < member->walk.length[0]; segment++)
        json_array_append_new(steps, step_json(page, member, segment));
    return json_record("engine=%s value=%u first_bit=%p own_renderer_parts=%s segments=%p",
                       member->engine->name, member->walk.frame.pixel[0], first_json(&first),
                       path_field_name(member->drawn.field), steps);
}

/* Walks the member's path and compares it with what the member's own renderer draws. */
static enum status walk_member(struct page *page, struct diff_member *member, struct reason *reason)
{
    enum status status = side_walk_pixel(&member->side, &page->run->view, the_pixel(page->run),
                                         &member->walk, &member->drawn, reason);
    if (!status && !member->drawn.follows)
        page->code = exit_worse(page->code, EXIT_MISMATCH);
    return status;
}

/* Prints the result of a member's path on one line. */
static void print_end(struct page *page, size_t i)
{
    const struct diff_run *run = page->run;
    const struct diff_member *member = &run->member[i], *reference = &run->member[run->reference];
    uint32_t value = member->walk.frame.pixel[0];
    printf("%s: %s, value %u %u %u", member->engine->name,
           COUNTED(member->walk.length[0], "segment"), value & 255u, value >> 8 & 255u,
           value >> 16 & 255u);
    struct first_bit first = walk_first_bit(&reference->walk, &member->walk, 0);
    if (member != reference && !first.differs)
        printf(", to the bit as %s", reference->engine->name);
    if (member != reference && first.differs) {
        printf(", first other bit in %s of segment %u", first.name, first.segment);
        if (sides_same_bits(&reference->side, &member->side)) {
            printf(": the same bits are demanded");
            page->code = exit_worse(page->code, EXIT_MISMATCH);
        }
    }
    if (!renderer_by_waves(member->side.renderer)) {
        uint32_t drawn = member->side.frame.pixel[the_pixel(run)];
        if (member->drawn.field == PATH_SAME)
            printf("; its own renderer: the same segments");
        else
            printf("; ITS OWN RENDERER parts at segment %u (%s)", member->drawn.segment,
                   path_field_name(member->drawn.field));
        printf(", value %u %u %u", drawn & 255u, drawn >> 8 & 255u, drawn >> 16 & 255u);
    }
    putchar('\n');
}

static enum status write_page(struct page *page, struct reason *reason)
{
    struct diff_run *run = page->run;
    json_t *members = json_array();
    for (size_t i = 0; i < run->count; i++)
        if (is_shown(run, i))
            json_array_append_new(members, member_json(page, i));
    json_t *out = diff_subject_json(run, page->code);
    json_add(out, "pixel=%p reference=%s paths=%p",
             json_pack("[I, I]", (json_int_t)run->options->x, (json_int_t)run->options->y),
             run->member[run->reference].engine->name, members);
    return json_write(run->options->json, out, 17, reason);
}

enum status diff_pixel(struct diff_run *run, int *exit_code, struct reason *reason)
{
    struct page page = {.run = run, .code = *exit_code};
    uint32_t longest = 0;
    enum status status = STATUS_OK;
    for (size_t i = 0; i < run->count && !status; i++) {
        if (!is_shown(run, i))
            continue;
        status = walk_member(&page, &run->member[i], reason);
        if (!status && run->member[i].walk.length[0] > longest)
            longest = run->member[i].walk.length[0];
    }
    if (!status) {
        diff_print_subject(run);
        printf("pixel %u,%u\n", run->options->x, run->options->y);
    }
    for (uint32_t segment = 0; segment < longest && !status; segment++) {
        printf("\nsegment %u\n", segment);
        for (size_t i = 0; i < run->count && !status; i++)
            if (is_shown(run, i))
                status = print_member(&page, i, segment, reason);
    }
    putchar('\n');
    for (size_t i = 0; i < run->count && !status; i++)
        if (is_shown(run, i))
            print_end(&page, i);
    if (!status && run->options->json)
        status = write_page(&page, reason);
    why_judges_free(&page.judges);
    *exit_code = page.code;
    return status;
}
