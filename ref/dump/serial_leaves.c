#include "ref/dump/serial_leaves.h"

#include <stdlib.h>

#define GEOMETRY 0x0FFFFFFFu /* the rest are flags */

enum status serial_leaves_make(uint32_t room, struct serial_leaves *leaves, struct tree_dump *dump)
{
    leaves->leaf = alloc_zeroed(room, sizeof *leaves->leaf);
    dump->item = alloc_zeroed(room, sizeof *dump->item);
    if (!leaves->leaf || !dump->item)
        return STATUS_MEMORY;
    if (leaves->top) {
        dump->instance = alloc_zeroed(room, sizeof *dump->instance);
        return dump->instance ? STATUS_OK : STATUS_MEMORY;
    }
    dump->source = alloc_zeroed(room, sizeof *dump->source);
    return dump->source ? scene_make(3 * room, room, &dump->scene) : STATUS_MEMORY;
}

static bool are_finite(const char *at, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!float_is_finite(serial_float(at + 4 * i)))
            return false;
    return true;
}

bool serial_leaf_add(struct serial_leaves *leaves, const char *at, uint32_t place, uint32_t node)
{
    const struct serial_places *places = leaves->places;
    struct serial_leaf leaf = {.at = at, .place = place, .node = node};
    if (leaves->top) {
        if (!are_finite(at + places->transform, 12))
            return false;
        leaf.number = serial_word(at + places->instance);
    } else {
        if (!are_finite(at, 9))
            return true;
        leaf.geometry = serial_word(at + places->geometry) & GEOMETRY;
        leaf.number = serial_word(at + places->number);
    }
    leaves->leaf[leaves->count++] = leaf;
    return true;
}

static int by_number(const void *a, const void *b)
{
    const struct serial_leaf *x = a, *y = b;
    if (x->geometry != y->geometry)
        return x->geometry < y->geometry ? -1 : 1;
    if (x->number != y->number)
        return x->number < y->number ? -1 : 1;
    return x->place < y->place ? -1 : x->place > y->place;
}

static void put_triangle(const struct serial_leaf *leaf, struct tree_dump *dump, uint32_t item)
{
    for (size_t i = 0; i < 9; i++)
        dump->scene.vertex[9 * (size_t)item + i] = serial_float(leaf->at + 4 * i);
    for (uint32_t i = 0; i < 3; i++)
        dump->scene.index[3 * (size_t)item + i] = 3 * item + i;
    dump->source[item] = (struct dump_source){leaf->geometry, leaf->number};
}

static void put_instance(const struct serial_places *places, const struct serial_leaf *leaf,
                         struct dump_instance *to)
{
    const uint32_t custom = serial_word(leaf->at + places->custom);
    for (size_t i = 0; i < 12; i++) {
        to->m[i / 4][i % 4] = serial_float(leaf->at + places->transform + 4 * i);
        to->inverse[i / 4][i % 4] = serial_float(leaf->at + places->back + 4 * i);
    }
    to->number = leaf->number;
    to->custom = custom & 0xFFFFFF;
    to->mask = custom >> 24;
    to->below = leaf->place;
}

void serial_leaves_put(struct serial_leaves *leaves, struct tree_dump *dump)
{
    uint32_t items = 0;
    qsort(leaves->leaf, leaves->count, sizeof *leaves->leaf, by_number);
    for (uint32_t i = 0; i < leaves->count; i++) {
        const struct serial_leaf *leaf = &leaves->leaf[i];
        const bool again =
            i > 0 && leaf[-1].geometry == leaf->geometry && leaf[-1].number == leaf->number;
        if (!again && leaves->top)
            put_instance(leaves->places, leaf, &dump->instance[items]);
        else if (!again)
            put_triangle(leaf, dump, items);
        items += !again;
        dump->item[i] = items - 1;
        dump->node[leaf->node].first = i;
        dump->node[leaf->node].count = 1;
    }
    dump->item_count = leaves->count;
    dump->tri_count = items;
    dump->tri_known = true;
    dump->scene.tri_count = leaves->top ? 0 : items;
    dump->scene.vertex_count = leaves->top ? 0 : 3 * items;
}

struct box serial_box(const char *at)
{
    struct box box;
    for (size_t k = 0; k < 3; k++) {
        box.lo[k] = serial_float(at + 4 * k);
        box.hi[k] = serial_float(at + 12 + 4 * k);
    }
    return box;
}
