#include "fuzz/feedback/feedback_inner.h"

#include <assert.h>
#include <stdlib.h>

/* Weights are 2^40 over a product, so that the sum of all is below 2^48. */
#define WEIGHT_MOST ((uint64_t)1 << 40)

enum status feedback_open(size_t bytes_most, struct feedback **out, struct reason *reason)
{
    *out = alloc_zeroed(1, sizeof **out);
    if (!*out)
        return fail(reason, STATUS_MEMORY, "no memory for the coverage of a campaign");
    (*out)->bytes_most = bytes_most;
    return STATUS_OK;
}

void feedback_close(struct feedback *feedback)
{
    if (!feedback)
        return;
    for (size_t i = 0; i < feedback->count; i++)
        fuzz_trial_free(&feedback->entry[i].trial);
    free(feedback);
}

size_t feedback_bytes(const struct fuzz_trial *trial)
{
    return sizeof *trial->world.instance * (size_t)trial->world.instance_count +
           12 * ((size_t)trial->scene.vertex_count + trial->scene.tri_count) +
           sizeof *trial->ray * trial->ray_count + sizeof *trial;
}

bool feedback_wants(const struct feedback *feedback, const uint64_t coverage[COVERAGE_WORDS])
{
    for (size_t w = 0; w < COVERAGE_WORDS; w++)
        if (coverage[w] & ~feedback->held[w])
            return true;
    return false;
}

static bool fits(const struct feedback *feedback, const struct fuzz_trial *trial)
{
    size_t bytes = feedback_bytes(trial);
    return bytes <= feedback->bytes_most / 8 && bytes <= feedback->bytes_most - feedback->bytes;
}

static void count_bits(struct feedback *feedback, const uint64_t coverage[COVERAGE_WORDS])
{
    for (uint32_t w = 0; w < COVERAGE_WORDS; w++)
        for (uint64_t bits = coverage[w]; bits; bits &= bits - 1)
            feedback->reached[64 * w + (uint32_t)__builtin_ctzll(bits)]++;
}

enum status feedback_add(struct feedback *feedback, const struct fuzz_trial *trial,
                         const uint64_t coverage[COVERAGE_WORDS], struct feedback_news *news,
                         struct reason *reason)
{
    *news = (struct feedback_news){0};
    if (trial && feedback_wants(feedback, coverage) && fits(feedback, trial)) {
        assert(feedback->count < COVERAGE_BITS);
        struct feedback_entry *entry = &feedback->entry[feedback->count];
        *entry = (struct feedback_entry){0};
        enum status status = fuzz_trial_copy(trial, &entry->trial, reason);
        if (status)
            return status;
        coverage_merge(entry->coverage, coverage);
        coverage_merge(feedback->held, coverage);
        feedback->bytes += feedback_bytes(trial);
        feedback->count++;
        news->kept = true;
    }
    news->bits = coverage_merge(feedback->map, coverage);
    count_bits(feedback, coverage);
    return STATUS_OK;
}

/* How many trials have reached the entry's rarest bit; at least 1. */
static uint64_t rarest(const struct feedback *feedback, const struct feedback_entry *entry)
{
    uint64_t least = WEIGHT_MOST;
    for (uint32_t w = 0; w < COVERAGE_WORDS; w++)
        for (uint64_t bits = entry->coverage[w]; bits; bits &= bits - 1) {
            uint64_t times = feedback->reached[64 * w + (uint32_t)__builtin_ctzll(bits)];
            least = times < least ? times : least;
        }
    return least;
}

const struct fuzz_trial *feedback_choose(struct feedback *feedback, struct rng *rng)
{
    uint64_t weight[COVERAGE_BITS], total = 0;
    for (size_t i = 0; i < feedback->count; i++) {
        const struct feedback_entry *entry = &feedback->entry[i];
        /* Once more per 8: an entry is tried in earnest before it gives way, and a bit that its
         * children never reach again does not hold the campaign for ever. */
        weight[i] = WEIGHT_MOST / rarest(feedback, entry) / (1 + entry->chosen / 8);
        weight[i] += weight[i] == 0;
        total += weight[i];
    }
    if (total == 0)
        return NULL;
    uint64_t at = (uint64_t)((unsigned __int128)rng_u64(rng) * total >> 64);
    size_t i = 0;
    for (; at >= weight[i]; i++)
        at -= weight[i];
    feedback->entry[i].chosen++;
    return &feedback->entry[i].trial;
}

size_t feedback_count(const struct feedback *feedback)
{
    return feedback->count;
}
