/* The text file of a finding or of a regression: what it gives is a trial that survives writing and
 * reading back. */
#include "fuzz/findings/finding_file.h"
#include "tests/readers/reader_entry.h"

#include <stdlib.h>

static bool play(const char *bytes, size_t size)
{
    struct finding_file file, again;
    struct reason reason = {""};
    char *text = NULL;
    size_t length = 0;
    enum status status = finding_file_parse("fuzz", bytes, size, &file, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT || status == STATUS_LIMIT);
    if (status) {
        reader_must_be_reason(&reason);
        return false;
    }
    READER_MUST(fuzz_trial_check(&file.trial, NULL) == STATUS_OK);
    reader_count_limit(false);
    READER_MUST(finding_file_print(&file, &text, &length, &reason) == STATUS_OK);
    READER_MUST(finding_file_parse("again", text, length, &again, &reason) == STATUS_OK);
    READER_MUST(fuzz_trial_hash(&file.trial) == fuzz_trial_hash(&again.trial));
    READER_MUST(file.has_signature == again.has_signature &&
                (!file.has_signature || fuzz_signature_same(&file.signature, &again.signature)));
    reader_count_limit(true);
    finding_file_free(&again);
    finding_file_free(&file);
    free(text);
    return true;
}

const struct reader_entry reader_entry = {"trial", 1 << 18, play};
