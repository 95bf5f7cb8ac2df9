#include "tests/hard/driver.h"

#include "gpu/card/card.h"
#include "gpu/trace/vulkan_options.h"

/* Opens the driver and measures it. False if it cannot: *out has outcome and reason. */
static bool measure(const struct engine_options *options, struct card *card,
                    struct hard_result *out)
{
    struct vk_options vk_options = vulkan_options(options);
    struct vk *vk;
    enum status status = vk_open(&vk_options, &vk, &out->reason);
    if (status) {
        out->outcome = status == STATUS_UNSUPPORTED ? HARD_SKIPPED : HARD_FAILED;
        out->absent = status == STATUS_UNSUPPORTED;
        out->unfinished = out->outcome == HARD_FAILED;
        return false;
    }
    status = card_make(vk, card, &out->reason);
    (void)vk_close(vk, NULL);
    if (!status)
        return true;
    out->outcome = HARD_FAILED;
    out->unfinished = true;
    return false;
}

void driver_packs_halves(const struct engine_options *options, struct hard_result *out)
{
    struct card card;
    if (!measure(options, &card, out))
        return;
    const struct card_pack *pack = &card.pack;
    out->played = 1;
    if (pack->differs == 0)
        return;
    out->outcome = HARD_FAILED;
    (void)fail(
        &out->reason, STATUS_OK,
        "%u of %u are not the nearest half: %u overflow, %u below 2^-14, %u others; %a gives "
        "%04x, not %04x",
        pack->differs, pack->count, pack->overflow, pack->tiny, pack->normal, (double)pack->example,
        pack->example_got, pack->example_nearest);
}

void driver_runs_loops(const struct engine_options *options, struct hard_result *out)
{
    static const char *const names[CARD_LOOPS] = {"one loop", "two in turn", "two nested"};
    struct card card;
    if (!measure(options, &card, out))
        return;
    out->played = 1;
    for (size_t i = 0; i < CARD_LOOPS; i++)
        if (card.loop.ran[i] != card.loop.asked[i]) {
            out->outcome = HARD_FAILED;
            (void)fail(&out->reason, STATUS_OK, "%s: %u of %u rounds are run", names[i],
                       card.loop.ran[i], card.loop.asked[i]);
            return;
        }
}
