#include "ref/cmd_finding.h"

#include <stdio.h>

bool finding_command(const struct row *row, const struct finding *finding, const char *spec,
                     uint64_t seed, const char *driver, char text[EXPLAIN_COMMAND_MOST])
{
    text[0] = '\0';
    /* What another run may answer otherwise cannot be explained by one. */
    if (!finding->bits && finding->judgement.wrong == WRONG_NOT_REPEATABLE)
        return false;
    struct explain_of of = explain_of_row(row, spec, seed, driver);
    explain_command(&of, &finding->ray, text);
    return true;
}

void finding_print(const struct row *row, const struct finding *finding, const char *spec,
                   uint64_t seed, const char *driver)
{
    char line[512], command[EXPLAIN_COMMAND_MOST];
    if (finding->bits)
        judge_bits_line(&finding->ray, &finding->expected, &finding->got, line, sizeof line);
    else
        judge_line(&finding->ray, &finding->judgement, &finding->got, line, sizeof line);
    printf("%s %s %s.%s.%s.%s ray %zu %s\n", finding->bits ? "BITS" : "WRONG",
           finding->bits ? "differ from engine cpu's:" : wrong_name(finding->judgement.wrong),
           query_name(row->options.query), row->engine->name,
           row->layout ? row->layout->name : "-", row->options.tri->name, finding->ray_index, line);
    if (finding_command(row, finding, spec, seed, driver, command))
        printf("  explain: %s\n", command);
}
