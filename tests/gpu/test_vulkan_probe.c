/* The operator probe, on the running driver and on made-up results. */
#include "gpu/card/card.h"

#include "tests/support/drivers.h"

static void run(struct probe_op op[PROBE_OPS], bool *ieee)
{
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    struct reason reason = {""};
    *ieee = gpu_is_lavapipe(vk);
    gpu_must(probe_run(vk, op, &reason), &reason);
    gpu_close(vk);
}

/* Vulkan's promises, in units of the last place: one neighbour for + - *, 2.5 for division. */
static void probe_finds_what_vulkan_promises(void **state)
{
    (void)state;
    struct probe_op op[PROBE_OPS];
    bool ieee;
    run(op, &ieee);
    for (uint32_t k = 0; k < PROBE_OPS; k++) {
        assert_true(op[k].ordinary > 10000 && op[k].special > 1000);
        if (strcmp(op[k].name, "a*b+c") == 0)
            continue; /* two roundings that cancellation can magnify */
        uint32_t most = strchr(op[k].name, '/') ? 3 : strchr(op[k].name, '?') ? 0 : 1;
        if (op[k].worst_ulp > most)
            fail_msg("%s is %u ulp off, %u are allowed", op[k].name, op[k].worst_ulp, most);
    }
}

static void probe_finds_lavapipe_exact(void **state)
{
    (void)state;
    struct probe_op op[PROBE_OPS];
    bool ieee;
    run(op, &ieee);
    if (!ieee) {
        print_message("SKIP this device is not lavapipe\n");
        skip();
    }
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        if (op[k].ordinary_differs || op[k].special_differs)
            fail_msg("%s: %u ordinary, %u special results differ", op[k].name,
                     op[k].ordinary_differs, op[k].special_differs);
}

static void probe_text_names_exact_and_other_operations(void **state)
{
    (void)state;
    struct probe_op op[PROBE_OPS];
    char text[1024];
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        op[k] = (struct probe_op){.name = k ? "good" : "bad", .ordinary = 100, .special = 50};
    op[0].ordinary_differs = 7;
    op[0].worst_ulp = 3;
    probe_text(op, text, sizeof text);
    assert_non_null(strstr(text, "as in C to the bit: good good"));
    assert_non_null(strstr(text, "bad: 7 of 100 differ, at most 3 ulp; 0 of 50 "));
    op[0] = (struct probe_op){.name = "zeros", .special = 50, .special_differs = 4, .flushed = 4};
    probe_text(op, text, sizeof text);
    assert_non_null(strstr(text, "but for subnormals, which are zeros: zeros (4 of 50)"));
    char cut[30];
    probe_text(op, cut, sizeof cut);
    assert_memory_equal(cut, text, sizeof cut - 1);
}

/* Results of a device that is right everywhere. */
static void make_right(struct probe_op op[PROBE_OPS])
{
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        op[k] = (struct probe_op){.name = "op", .ordinary = 100, .special = 50};
}

/* Every line whole: kinds without an operation have none. */
static void probe_text_has_a_line_for_each_kind(void **state)
{
    (void)state;
    static const char exact[] = "as in C to the bit:";
    static const char zeros[] = "as in C but for subnormals, which are zeros:";
    struct probe_op op[PROBE_OPS];
    char text[2048], want[2048];
    for (uint32_t kinds = 0; kinds < 8; kinds++) {
        uint32_t of[3] = {0, 0, 0};
        char *end = want;
        make_right(op);
        /* Operation k is exact, flushed or wrong: the kinds of the set in turn. */
        for (uint32_t k = 0, kind = 0; k < PROBE_OPS; k++, kind = (kind + 1) % 3) {
            while (kinds && !(kinds >> kind & 1))
                kind = (kind + 1) % 3;
            if (kind > 0)
                op[k].special_differs = op[k].flushed = 1 + k;
            if (kind > 1)
                op[k].special_differs++;
            of[kind]++;
        }
        for (uint32_t kind = 0; kind < 2; kind++) {
            if (of[kind])
                end += sprintf(end, "%s", kind ? zeros : exact);
            for (uint32_t k = 0; k < PROBE_OPS; k++)
                if (kind == 0 && op[k].special_differs == 0)
                    end += sprintf(end, " op");
                else if (kind == 1 && op[k].flushed && op[k].flushed == op[k].special_differs)
                    end += sprintf(end, " op (%u of 50)", 1 + k);
            if (of[kind])
                end += sprintf(end, "\n");
        }
        for (uint32_t k = 0; k < PROBE_OPS; k++)
            if (op[k].special_differs > op[k].flushed)
                end += sprintf(end,
                               "op: 0 of 100 differ, at most 0 ulp; %u of 50 with zeros, "
                               "subnormals, infinities or NaN, %u of them by flushing\n",
                               2 + k, 1 + k);
        probe_text(op, text, sizeof text);
        assert_string_equal(text, want);
    }
}

static void probe_model_follows_what_was_measured(void **state)
{
    (void)state;
    struct probe_op op[PROBE_OPS];
    make_right(op);
    struct arithmetic a = probe_arithmetic(op);
    const struct rounding ieee = ROUNDING_IEEE, spec = ROUNDING_VULKAN;
    assert_true(a.bits && !a.flushes);
    assert_memory_equal(&a.rounding, &ieee, sizeof ieee);

    op[PROBE_MUL].special_differs = op[PROBE_MUL].flushed = 5; /* flushed subnormals */
    const struct rounding flushed = ROUNDING_FLUSHED;
    a = probe_arithmetic(op);
    assert_true(a.bits && a.flushes);
    assert_memory_equal(&a.rounding, &flushed, sizeof flushed);

    op[PROBE_MUL].special_differs = 6; /* one more that flushing does not explain */
    assert_false(probe_arithmetic(op).bits);

    make_right(op);
    op[PROBE_DIV].ordinary_differs = op[PROBE_DIV].worst_ulp = 1;
    a = probe_arithmetic(op);
    assert_false(a.bits);
    assert_true(a.rounding.div == spec.div && a.rounding.add == 1 && a.rounding.mul == 1);
    op[PROBE_DIV].worst_ulp = 9; /* worse than Vulkan allows */
    assert_true(probe_arithmetic(op).rounding.div == 19);

    make_right(op);
    op[PROBE_SUB].ordinary_differs = op[PROBE_SUB].worst_ulp = 1;
    assert_true(probe_arithmetic(op).rounding.add == 3);

    make_right(op);
    op[PROBE_MUL_ADD].ordinary_differs = 7; /* contracted: other bits, no larger errors */
    a = probe_arithmetic(op);
    assert_false(a.bits);
    assert_true(a.rounding.add == 1 && a.rounding.mul == 1 && a.rounding.div == 1);
}

enum { OP_FADD = 129, OP_FSUB = 131, OP_FMUL = 133, OP_FDIV = 136 };

/* The probe with its first operation `from` replaced by `to`, run on the device. */
static struct arithmetic run_planted(uint32_t from, uint32_t to)
{
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    const struct shader *shader = shader_find("probe_ops");
    struct probe_op op[PROBE_OPS];
    struct reason reason = {""};
    uint32_t *word = malloc(4 * (size_t)shader->word_count), planted = 0;
    assert_non_null(word);
    memcpy(word, shader->word, 4 * (size_t)shader->word_count);
    for (uint32_t at = 5; at < shader->word_count && !planted; at += word[at] >> 16)
        if ((word[at] & 0xFFFFu) == from) {
            word[at] = (word[at] & 0xFFFF0000u) | to;
            planted++;
        }
    assert_int_equal(planted, 1);
    const struct shader copy = {"probe_planted", word, shader->word_count, false};
    gpu_must(probe_run_shader(vk, &copy, op, &reason), &reason);
    gpu_close(vk);
    free(word);
    return probe_arithmetic(op);
}

static void probe_notices_a_wrong_operator(void **state)
{
    (void)state;
    const struct rounding ieee = ROUNDING_IEEE;
    static const uint32_t swap[][2] = {
        {OP_FADD, OP_FSUB}, {OP_FSUB, OP_FADD}, {OP_FMUL, OP_FDIV}, {OP_FDIV, OP_FMUL}};
    for (size_t i = 0; i < ARRAY_COUNT(swap); i++) {
        struct arithmetic a = run_planted(swap[i][0], swap[i][1]);
        assert_false(a.bits);
        assert_memory_not_equal(&a.rounding, &ieee, sizeof ieee);
    }
}

/* The engine's model is the device's: bits are demanded of every driver that needs no GPU. */
static void engine_model_is_measured(void **state)
{
    (void)state;
    size_t opened = 0;
    for (size_t d = 0; d < ARRAY_COUNT(cpu_drivers); d++) {
        void *self = driver_open("vulkan", cpu_drivers[d]);
        if (!self)
            continue;
        struct model model = engine_model(engine_find("vulkan"), self, tri_test_find("woop"));
        struct rounding want =
            model.rounding.tiny == ROUNDING_IEEE.tiny ? ROUNDING_IEEE : ROUNDING_FLUSHED;
        assert_true(model.bits);
        assert_memory_equal(&model.rounding, &want, sizeof want);
        engine_find("vulkan")->close(self);
        opened++;
    }
    if (!opened)
        skip();
}

static void choice_adds_up(const struct card_choice *choice)
{
    assert_true(choice->telling > 1000);
    assert_int_equal(choice->telling, choice->plain + choice->other + choice->neither);
}

/* Of the operands 1 and NaN it is one of them, of -0 and +0 a zero. */
static void pair_is_of_its_operands(const struct card_pair *pair)
{
    assert_true(isnan(pair->first_nan) || !(pair->first_nan < 1 || pair->first_nan > 1));
    assert_true(isnan(pair->second_nan) || !(pair->second_nan < 1 || pair->second_nan > 1));
    assert_int_equal(float_bits(pair->minus_plus) << 1, 0);
    assert_int_equal(float_bits(pair->plus_minus) << 1, 0);
}

/* What Vulkan promises, and that the counts add up, whatever the driver. */
static void check_card(const struct card *card)
{
    choice_adds_up(&card->fma);
    choice_adds_up(&card->contraction);
    choice_adds_up(&card->distribution);
    assert_int_equal(card->fma.neither + card->contraction.neither, 0);
    pair_is_of_its_operands(&card->min);
    pair_is_of_its_operands(&card->max);
    assert_true(card->sqrt.count > 1000 && card->sqrt.worst_ulp <= 4);
    assert_true(card->inversesqrt.worst_ulp <= 2);
    assert_int_equal(card->unpack.wrong, 0);
    assert_int_equal(card->unpack.kept + card->unpack.flushed + card->unpack.subnormal_wrong,
                     2 * 2046);
    assert_int_equal(card->pack.differs, card->pack.overflow + card->pack.tiny + card->pack.normal);
    for (uint32_t i = 0; i < CARD_LOOPS; i++)
        assert_true(card->loop.ran[i] > 1000 && card->loop.ran[i] <= card->loop.asked[i]);
}

static void card_is_made(struct vk *vk, const char *driver, void *of)
{
    struct reason reason = {""};
    struct card card;
    (void)driver;
    (void)of;
    gpu_must(card_make(vk, &card, &reason), &reason);
    check_card(&card);
    if (gpu_is_lavapipe(vk)) { /* measured on Mesa 22.3.6 and 25.0.7 */
        assert_int_equal(card.pack.differs, 0);
        assert_int_equal(card.fma.plain, card.fma.telling);
        assert_int_equal(card.unpack.kept, 2 * 2046);
    }
}

static void card_is_made_for_every_driver(void **state)
{
    (void)state;
    if (!gpu_on_cpu_drivers(card_is_made, NULL))
        skip();
}

static void card_says_what_it_holds(void **state)
{
    (void)state;
    static struct card card = {.limits = {.device = "a device"},
                               .fma = {10, 0, 10, 0},
                               .contraction = {10, 10, 0, 0},
                               .distribution = {10, 3, 5, 2},
                               .min = {.first_nan = 1, .second_nan = NAN, .plus_minus = -0.0f},
                               .pack = {.count = 9, .differs = 2, .normal = 2},
                               .loop = {{100, 200, 100}, {100, 150, 100}}};
    char text[4096], cut[40];
    make_right(card.op);
    card.arithmetic = probe_arithmetic(card.op);
    card_text(&card, text, sizeof text);
    assert_non_null(strstr(text, "fused (10 of 10 telling)"));
    assert_non_null(strstr(text, "as written, each operation rounded (10 of 10 telling)"));
    assert_non_null(strstr(text, "of 10 telling 3 as written, 5 as a*c-b*c, 2 neither"));
    assert_non_null(strstr(text, "min gives the second operand"));
    assert_non_null(strstr(text, "2 of 9 are not the nearest half"));
    assert_non_null(strstr(text, "ENDED EARLY"));
    assert_non_null(strstr(text, "two in turn 150 of 200"));
    assert_non_null(strstr(text, "IEEE; C's bits are demanded"));
    card_text(&card, cut, sizeof cut);
    assert_memory_equal(cut, text, sizeof cut - 1);
    json_t *json = card_json(&card);
    assert_non_null(json);
    assert_string_equal(json_string_value(json_object_get(json, "device")), "a device");
    assert_int_equal(json_array_size(json_object_get(json, "ops")), PROBE_OPS);
    assert_true(json_is_true(json_object_get(json_object_get(json, "loops"), "ended_early")));
    assert_true(json_is_true(json_object_get(json_object_get(json, "judge"), "bits")));
    json_decref(json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(probe_finds_what_vulkan_promises),
        cmocka_unit_test(probe_finds_lavapipe_exact),
        cmocka_unit_test(probe_text_names_exact_and_other_operations),
        cmocka_unit_test(probe_text_has_a_line_for_each_kind),
        cmocka_unit_test(probe_model_follows_what_was_measured),
        cmocka_unit_test(probe_notices_a_wrong_operator),
        cmocka_unit_test(engine_model_is_measured),
        cmocka_unit_test(card_is_made_for_every_driver),
        cmocka_unit_test(card_says_what_it_holds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
