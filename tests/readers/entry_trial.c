/* The text file of a finding or of a regression: what it gives is a trial that survives writing and
 * reading back. */
#include "fuzz/findings/finding_file.h"
#include "tests/readers/fire.h"

#include <stdlib.h>

static bool play(const char *bytes, size_t size)
{
    struct finding_file file, again;
    struct reason reason = {""};
    char *text = NULL;
    size_t length = 0;
    enum status status = finding_file_parse("fuzz", bytes, size, &file, &reason);
    FIRE_MUST(status == STATUS_OK || status == STATUS_INPUT || status == STATUS_LIMIT);
    if (status) {
        fire_must_be_reason(&reason);
        return false;
    }
    FIRE_MUST(fuzz_trial_check(&file.trial, NULL) == STATUS_OK);
    fire_count_limit(false);
    FIRE_MUST(finding_file_print(&file, &text, &length, &reason) == STATUS_OK);
    FIRE_MUST(finding_file_parse("again", text, length, &again, &reason) == STATUS_OK);
    FIRE_MUST(fuzz_trial_hash(&file.trial) == fuzz_trial_hash(&again.trial));
    FIRE_MUST(file.has_signature == again.has_signature &&
              (!file.has_signature || fuzz_signature_same(&file.signature, &again.signature)));
    fire_count_limit(true);
    finding_file_free(&again);
    finding_file_free(&file);
    free(text);
    return true;
}

const struct fire_entry fire_entry = {"trial", 1 << 18, play};
