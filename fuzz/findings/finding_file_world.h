/* The lines of a finding's text file that only worlds have. */
#ifndef FUZZ_FINDING_FILE_WORLD_H
#define FUZZ_FINDING_FILE_WORLD_H

#include "fuzz/findings/finding_file.h"
#include "fuzz/findings/finding_file_scan.h"

#include <stdio.h>

/* Reads what follows the word `filter`. */
void finding_read_filter(struct finding_scan *in, struct finding_file *file);

/* Reads the parts `geometries` and `instances`. */
void finding_read_world(struct finding_scan *in, struct finding_file *file);

/* Reads the mask and the flags at the end of a ray's line. */
struct ray_mode finding_read_mode(struct finding_scan *in);

/* Writes the line `filter`. */
void finding_put_filter(const struct trial_world *world, FILE *to);

/* Writes these parts. */
void finding_put_world(const struct trial_world *world, FILE *to);

/* Writes a float in hexadecimal, in its column; and one in decimal. */
void finding_put_float(float x, FILE *to);
void finding_put_decimal(float x, FILE *to);

#endif
