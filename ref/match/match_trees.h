/* Trees, for ref/match/match.c; match_rebuild and match_pack are in ref/match/match.h. */
#ifndef MATCH_TREES_H
#define MATCH_TREES_H

#include "ref/match/match.h"

/* Frees the packed tree and the answers of engine cpu on it; match->bvh stays. */
void match_unpack(struct match *match);

/* Frees the answers of engine cpu alone. */
void match_forget_against(struct match *match);

#endif
