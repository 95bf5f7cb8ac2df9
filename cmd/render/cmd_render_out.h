/* Other output of raydiff render than pictures. For this command only. */
#ifndef CMD_RENDER_OUT_H
#define CMD_RENDER_OUT_H

#include "cmd/render/cmd_render.h"

/* Builds the path of picture `frame` (1 ..) of `count`. A single picture uses `out` unless it
 * has a place for the number, %d or %04d. With several pictures the number stands there, or else
 * before the ending. Errors: STATUS_INPUT no ending .png, another %, or too long. */
enum status frame_path(const char *out, uint32_t frame, uint32_t count, char *path,
                       size_t path_bytes, struct reason *reason) MUST_USE;

/* Ray counts of a picture, from its segments. */
struct frame_rays {
    uint64_t closest, shadow; /* rays traced */
    uint64_t hit_pixels;      /* pixels whose first segment hit */
};

struct frame_rays frame_count(const struct segment *segment, size_t pixels, uint32_t bounces);

/* Writes segments as text: CSV with a header, or JSON, depending on the path's ending. */
struct paths_out {
    struct file_out file;
    bool json, begun;
};

/* Errors: STATUS_INPUT another ending, or cannot write there. */
enum status paths_open(const char *path, const struct render_stage *stage,
                       const struct render_settings *settings, struct paths_out *out,
                       struct reason *reason) MUST_USE;
void paths_add(struct paths_out *out, uint32_t frame, const struct render_stage *stage,
               const struct segment *segment);
/* Errors: STATUS_INPUT writing failed; the file is removed. */
enum status paths_close(struct paths_out *out, struct reason *reason) MUST_USE;

/* One picture in the summary. */
struct frame_record {
    char path[512];
    double angle; /* radians */
    struct view view;
    struct trace_report report;
    uint64_t wall_ns; /* including shading and reading back, excluding writing */
    bool counted;
    struct frame_rays rays;
};

/* Writes the file of --json. Errors: those of json_write. */
enum status render_json(const char *path, const struct render_settings *settings,
                        const struct render_stage *stage, const struct frame_record *record,
                        uint32_t count, struct reason *reason) MUST_USE;

#endif
