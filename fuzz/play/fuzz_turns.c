#include "fuzz/play/fuzz_turns.h"

size_t fuzz_turns_share(struct fuzz_field *field,
                        bool (*alike)(const struct engine *a, const struct engine *b))
{
    size_t sharing = 0;
    for (size_t i = 0; i < field->count; i++)
        field->turn[i] = (struct fuzz_turn){.first = (uint8_t)i, .of = 1};
    for (size_t i = 0; i < field->count; i++) {
        struct fuzz_turn *first = &field->turn[i];
        for (size_t k = i + 1; k < field->count && first->first == i; k++)
            if (first->of < FUZZ_TURNS && field->turn[k].first == k &&
                field->who[k].layout == field->who[i].layout &&
                alike(field->who[i].engine, field->who[k].engine))
                field->turn[k] = (struct fuzz_turn){first->first, first->of++};
        sharing += first->first == i && first->of > 1 ? first->of : 0;
    }
    return sharing;
}

uint32_t fuzz_turns_waiting(const struct fuzz_field *field, uint64_t block)
{
    const uint32_t slot = (uint32_t)(block % FUZZ_TURNS);
    uint32_t waiting = 0;
    for (size_t i = 0; i < field->count; i++) {
        const struct fuzz_turn *turn = &field->turn[i];
        const struct fuzz_turn *first = &field->turn[turn->first];
        /* The last slots of FUZZ_TURNS are those of the second, the third and so on. */
        const uint32_t alone = FUZZ_TURNS + 1u - first->of;
        const bool plays =
            turn->first == i ? first->of < 2 || slot < alone : slot == alone + turn->of - 1u;
        waiting |= turn->of == 0 || plays ? 0 : 1u << i;
    }
    return waiting;
}
