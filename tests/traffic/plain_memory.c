#include "tests/traffic/plain_memory.h"

#include <stdlib.h>

/* As where the arrays lie: 2^40 bytes each, the first one at 2^40. */
#define ARRAY_BYTES ((uint64_t)1 << 40)

struct plain_memory plain_make(const struct traffic_memory_size *size)
{
    struct plain_memory m = {.size = *size};
    m.level = calloc(size->units + 1, sizeof *m.level);
    if (!m.level)
        abort();
    for (uint32_t i = 0; i <= size->units; i++) {
        const struct traffic_cache_size *of = &size->cache[i < size->units ? 0 : 1];
        m.level[i].bytes = of->bytes;
        m.level[i].ways = of->ways;
        m.level[i].line_bytes = of->line;
        m.level[i].line = calloc(of->bytes / of->line, sizeof *m.level[i].line);
        if (!m.level[i].line)
            abort();
    }
    return m;
}

static void dram(struct plain_memory *m, uint64_t at, uint64_t bytes, bool write)
{
    for (uint64_t burst = at / 64 * 64; burst < at + bytes; burst += 64) {
        uint64_t row = burst / m->size.row_bytes, bank = row % TRAFFIC_BANKS;
        (write ? m->out : m->in)[TRAFFIC_DRAM][burst / ARRAY_BYTES - 1] += 64;
        if (m->row_open[bank] && m->row[bank] == row)
            m->row_hits++;
        else
            m->row_misses++;
        m->row_open[bank] = true;
        m->row[bank] = row;
    }
}

static void use(struct plain_memory *m, uint32_t unit, uint64_t at, uint64_t bytes, bool write);

/* What leaves cache `i` towards DRAM, or comes from there. */
static void beyond(struct plain_memory *m, uint32_t i, uint64_t at, uint64_t bytes, bool write)
{
    if (i == m->size.units) {
        dram(m, at, bytes, write);
        return;
    }
    (write ? m->out : m->in)[TRAFFIC_L2][at / ARRAY_BYTES - 1] += bytes;
    use(m, m->size.units, at, bytes, write);
}

static struct plain_line *line_of(struct plain_memory *m, uint32_t i, uint64_t number)
{
    struct plain_level *level = &m->level[i];
    uint64_t sets = level->bytes / level->line_bytes / level->ways;
    struct plain_line *set = level->line + number % sets * level->ways, *oldest = &set[0];
    for (uint32_t w = 0; w < level->ways; w++)
        if (set[w].valid && set[w].number == number)
            return &set[w];
    for (uint32_t w = 0; w < level->ways; w++) {
        if (!set[w].valid)
            return &set[w];
        if (set[w].used < oldest->used)
            oldest = &set[w];
    }
    return oldest;
}

static void use(struct plain_memory *m, uint32_t i, uint64_t at, uint64_t bytes, bool write)
{
    uint32_t size = m->level[i].line_bytes;
    for (uint64_t number = at / size; number <= (at + bytes - 1) / size; number++) {
        struct plain_line *line = line_of(m, i, number);
        bool covers = at <= number * size && at + bytes >= (number + 1) * size;
        bool there = line->valid && line->number == number;
        struct plain_line old = *line;
        *line = (struct plain_line){.number = number,
                                    .used = ++m->clock,
                                    .valid = true,
                                    .dirty = write || (there && old.dirty),
                                    .whole = !write || covers || (there && old.whole)};
        if (there && (write || old.whole))
            continue;
        m->missed[i == m->size.units]++;
        if (!there && old.valid && old.dirty)
            beyond(m, i, old.number * size, size, true);
        if (!write)
            beyond(m, i, number * size, size, false);
    }
}

void plain_access(struct plain_memory *m, uint32_t unit, enum traffic_array array, uint64_t offset,
                  uint64_t bytes, bool write)
{
    if (bytes == 0)
        return;
    (write ? m->out : m->in)[TRAFFIC_L1][array] += bytes;
    use(m, unit, (array + 1) * ARRAY_BYTES + offset, bytes, write);
}

void plain_flush(struct plain_memory *m)
{
    for (uint32_t i = 0; i <= m->size.units; i++) {
        struct plain_level *level = &m->level[i];
        for (uint64_t k = 0; k < level->bytes / level->line_bytes; k++)
            if (level->line[k].valid && level->line[k].dirty)
                beyond(m, i, level->line[k].number * level->line_bytes, level->line_bytes, true);
        for (uint64_t k = 0; k < level->bytes / level->line_bytes; k++)
            level->line[k].valid = false;
    }
}

void plain_free(struct plain_memory *m)
{
    for (uint32_t i = 0; i <= m->size.units; i++)
        free(m->level[i].line);
    free(m->level);
}
