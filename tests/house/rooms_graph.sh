#!/bin/sh
# The rooms of docs/rooms.txt as a Graphviz text: an arrow from each room to those that it includes, without
# arrows that longer paths make obvious, and without tests. `make rooms-graph` draws docs/rooms.svg of it.
#   sh tests/house/rooms_graph.sh [edges]    edges: an arrow a line, as ROOM ROOM
set -eu
awk -v only="${1-}" '
    /^#/ { next }
    !/^ / { room = $0; sub(":.*", "", room); sub("[^:]*:", ""); name[++rooms] = room }
    { for (i = 1; i <= NF; i++) { includes[room, $i] = 1; below[room] = below[room] " " $i } }
    function shown(room) { return room !~ /^tests/ || room ~ /^tests\/hard/ }
    # Lower rooms come first, so that what they reach is known.
    END {
        for (r = 1; r <= rooms; r++) {
            count = split(below[name[r]], to, " ")
            for (i = 1; i <= count; i++) {
                reaches[name[r], to[i]] = 1
                for (k = 1; k < r; k++)
                    if (reaches[to[i], name[k]]) { reaches[name[r], name[k]] = 1; longer[name[r], name[k]] = 1 }
            }
        }
        if (only != "edges") {
            print "digraph rooms {"
            print "    rankdir=TB; node [shape=box, fontname=\"Helvetica\", fontsize=11, style=filled]; edge [color=\"#607080\"];"
        }
        split("ref #dcecff gpu #e4f7dd shaders #e4f7dd scenes #fff3d0 fuzz #ffe2dc bench #efe4fb cmd #f0f0f0 tests #f8f8f8", part, " ")
        for (i = 1; i in part; i += 2) colour[part[i]] = part[i + 1]
        for (r = 1; r <= rooms; r++) {
            if (!shown(name[r]) || name[r] ~ /^fuzz\/(samples|templates)/) continue
            top = name[r]
            sub("[/.].*", "", top)
            if (only != "edges")
                printf "    \"%s\" [fillcolor=\"%s\"];\n", name[r], top in colour ? colour[top] : "#f0f0f0"
            for (k = 1; k < r; k++)
                if (includes[name[r], name[k]] && !longer[name[r], name[k]] && shown(name[k])) {
                    if (only == "edges") print name[r], name[k]
                    else printf "    \"%s\" -> \"%s\";\n", name[r], name[k]
                }
        }
        if (only != "edges") print "}"
    }' docs/rooms.txt
