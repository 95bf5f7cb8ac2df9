/* What raydiff render writes beside pictures. For this command only. */
#ifndef CMD_RENDER_OUT_H
#define CMD_RENDER_OUT_H

#include "cmd/render/cmd_render.h"

/* The file of picture `frame` (1 ..) of `count`: `out` itself of one picture, unless it holds a
 * place for the number, %d or %04d; of several the number is put there, or before the ending.
 * Errors: STATUS_INPUT no ending .png, a % that is no such place, or too long. */
enum status frame_path(const char *out, uint32_t frame, uint32_t count, char *path,
                       size_t path_bytes, struct reason *reason) MUST_USE;

/* The rays of a picture, counted from its segments. */
struct frame_rays {
    uint64_t closest, shadow; /* rays traced */
    uint64_t hit_pixels;      /* whose first segment hit */
};

struct frame_rays frame_count(const struct segment *segment, size_t pixels, uint32_t bounces);

/* Segments as text: CSV with a header, or JSON, by the path's ending. */
struct paths_out {
    struct file_out file;
    bool json, begun;
};

/* Errors: STATUS_INPUT neither ending, or cannot write there. */
enum status paths_open(const char *path, const struct render_stage *stage,
                       const struct render_settings *settings, struct paths_out *out,
                       struct reason *reason) MUST_USE;
void paths_add(struct paths_out *out, uint32_t frame, const struct render_stage *stage,
               const struct segment *segment);
/* Errors: STATUS_INPUT not all could be written; then nothing is left behind. */
enum status paths_close(struct paths_out *out, struct reason *reason) MUST_USE;

/* One picture of the summary. */
struct frame_record {
    char path[512];
    double angle; /* radians */
    struct view view;
    struct trace_report report;
    uint64_t wall_ns; /* with shading and reading back, without writing */
    bool counted;
    struct frame_rays rays;
};

/* Writes the file of --json. Errors: as json_write. */
enum status render_json(const char *path, const struct render_settings *settings,
                        const struct render_stage *stage, const struct frame_record *record,
                        uint32_t count, struct reason *reason) MUST_USE;

#endif
