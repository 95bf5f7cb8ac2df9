/* raydiff diff A.png B.png: the differences of two pictures, as numbers and as a heat map. */
#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_rows.h"
#include "ref/base/command.h"
#include "cmd/diff/cmd_diff.h"
#include "scenes/picture/image_diff.h"
#include "ref/base/json_record.h"

#include <inttypes.h>

static const char *const channel_names[IMAGE_CHANNELS] = {"red", "green", "blue", "alpha"};

struct images_job {
    const char *path[2];
    const char *out, *json;
    uint64_t max;
    struct image image[2];
    struct image_diff diff;
};

#define ROWS_OF struct images_job

static const struct option_row rows[] = {
    {"out", "FILE", "a heat map with scale bar, as PNG; equal pixels are gray", OF_OUTPUT(out)},
    {"json", "FILE", "the numbers as JSON, - for the standard output", OF_DATA(json)},
    {"max", "N", "exit code 0 also where no channel differs by more", OF_COUNT(max, 0, 255),
     .value = "0"},
    {0},
};

static const struct option_set set = {
    .command = "diff",
    .usage = "diff A.png B.png [--out HEAT.png] [--json FILE] [--max N]",
    .about = "Compares two pictures of equal size, pixel by pixel, in 8 bits a channel and without "
             "any gamma: how many differ, by how much, where.",
    .group = {GROUP(rows)},
    .codes = "0 equal (see --max), 1 different, 2 bad input, 4 no memory",
    .example = "render rtrs --engine cpu --out cpu.png\n"
               "render rtrs --engine embree --out embree.png\n"
               "diff cpu.png embree.png --out heat.png",
};

static enum status compare(struct images_job *job, struct reason *reason)
{
    for (int i = 0; i < 2; i++) {
        enum status status = image_read(job->path[i], &job->image[i], reason);
        if (status)
            return status;
    }
    struct reason why;
    enum status status = image_diff(&job->image[0], &job->image[1], &job->diff, &why);
    if (status)
        return fail(reason, status, "%.90s and %.90s: %.120s", job->path[0], job->path[1],
                    why.text);
    return STATUS_OK;
}

static double mean_of(const struct image_diff *diff, unsigned channel)
{
    return (double)diff->total[channel] / (double)diff->pixels;
}

static void print_pixel(const char *what, const struct image_diff_pixel *pixel)
{
    printf("  %-19s (%u, %u): rgba", what, pixel->x, pixel->y);
    for (unsigned k = 0; k < IMAGE_CHANNELS; k++)
        printf(" %u", pixel->a >> 8 * k & 255);
    printf(" against");
    for (unsigned k = 0; k < IMAGE_CHANNELS; k++)
        printf(" %u", pixel->b >> 8 * k & 255);
    putchar('\n');
}

static void print_table(const struct images_job *job)
{
    const struct image_diff *diff = &job->diff;
    printf("%s against %s: %u x %u pixels\n", job->path[0], job->path[1], job->image[0].width,
           job->image[0].height);
    printf("  different           %" PRIu64 " of %" PRIu64 " (%.4f %%)\n", diff->differing,
           diff->pixels, 100.0 * (double)diff->differing / (double)diff->pixels);
    if (diff->differing == 0)
        return;
    printf("  by size            ");
    for (int i = 0; i < IMAGE_DIFF_SIZES; i++)
        printf(" %s: %" PRIu64 "%s", image_diff_size_names[i], diff->by_size[i],
               i + 1 < IMAGE_DIFF_SIZES ? "," : "\n");
    printf("  largest            ");
    for (unsigned k = 0; k < IMAGE_CHANNELS; k++)
        printf(" %s %u%s", channel_names[k], diff->largest[k], k + 1 < IMAGE_CHANNELS ? "," : "\n");
    printf("  mean of all        ");
    for (unsigned k = 0; k < IMAGE_CHANNELS; k++)
        printf(" %s %.6f%s", channel_names[k], mean_of(diff, k),
               k + 1 < IMAGE_CHANNELS ? "," : "\n");
    printf("  within              x %u to %u, y %u to %u\n", diff->least_x, diff->most_x,
           diff->least_y, diff->most_y);
    print_pixel("first", &diff->first);
    print_pixel("worst", &diff->worst);
}

static json_t *json_of_channels(uint32_t rgba)
{
    json_t *out = json_array();
    for (unsigned k = 0; k < IMAGE_CHANNELS; k++)
        json_array_append_new(out, json_integer(rgba >> 8 * k & 255));
    return out;
}

static json_t *json_of_pixel(const struct image_diff_pixel *pixel)
{
    return json_record("x=%u y=%u a=%p b=%p", pixel->x, pixel->y, json_of_channels(pixel->a),
                       json_of_channels(pixel->b));
}

static json_t *json_of(const struct images_job *job)
{
    const struct image_diff *diff = &job->diff;
    json_t *largest = json_object(), *mean = json_object(), *by_size = json_object();
    for (unsigned k = 0; k < IMAGE_CHANNELS; k++) {
        json_add(largest, "%s=%u", channel_names[k], diff->largest[k]);
        json_add(mean, "%s=%g", channel_names[k], mean_of(diff, k));
    }
    for (int i = 0; i < IMAGE_DIFF_SIZES; i++)
        json_add(by_size, "%s=%zu", image_diff_size_names[i], diff->by_size[i]);
    json_t *root = json_record(
        "a=%s b=%s width=%u height=%u pixels=%zu different=%zu by_size=%p largest=%p mean=%p",
        job->path[0], job->path[1], job->image[0].width, job->image[0].height, diff->pixels,
        diff->differing, by_size, largest, mean);
    if (root && diff->differing) {
        json_add(root, "box=%p first=%p worst=%p",
                 json_pack("[IIII]", (json_int_t)diff->least_x, (json_int_t)diff->least_y,
                           (json_int_t)diff->most_x, (json_int_t)diff->most_y),
                 json_of_pixel(&diff->first), json_of_pixel(&diff->worst));
    }
    return root;
}

static enum status write_heat(const struct images_job *job, struct reason *reason)
{
    char title[240];
    struct image heat;
    struct colour_place place;
    snprintf(title, sizeof title, "%.100s against %.100s", file_label(job->path[0]),
             file_label(job->path[1]));
    enum status status =
        image_diff_heat(&job->image[0], &job->image[1], &job->diff, title, &heat, &place, reason);
    if (!status)
        status = image_write(job->out, &heat, reason);
    if (!status)
        printf("  heat map            %s: pixel (x, y) is at (%u + %u x, %u + %u y)\n", job->out,
               place.x, place.zoom, place.y, place.zoom);
    image_free(&heat);
    return status;
}

int cmd_diff_images(int argc, char **argv)
{
    struct images_job job = {.out = NULL};
    struct reason reason = {""};
    int first, code = options_read(&set, &job, argc, argv, &first);
    if (code >= 0)
        return code;
    if (argc - first != 2)
        return usage_error("diff", "two PNG files are compared, not %d", argc - first);
    job.path[0] = argv[first];
    job.path[1] = argv[first + 1];
    enum status status = compare(&job, &reason);
    if (!status)
        print_table(&job);
    if (!status && job.out)
        status = write_heat(&job, &reason);
    if (!status && job.json)
        status = json_write(job.json, json_of(&job), 17, &reason);
    code = image_diff_largest(&job.diff) > job.max ? EXIT_MISMATCH : EXIT_AGREE;
    image_free(&job.image[0]);
    image_free(&job.image[1]);
    return status ? exit_with_reason("diff", status, &reason) : code;
}
