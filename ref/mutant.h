/* Numbers of the planted bugs. The shipped program is compiled with MUTANT 0 and holds none;
 * tests/mutants.mk compiles one C unit or shader with -DMUTANT=n into build/mutants/ and demands
 * that the suite turns red. Plain #define, so that GLSL can include it. */
#ifndef MUTANT_H
#define MUTANT_H

#ifndef MUTANT
#define MUTANT 0
#endif

#define MUTANT_HALF_NEAREST   1   /* bounds rounded to nearest instead of outward */
#define MUTANT_LOST_SLOT      2   /* the eighth item slot of a leaf is not read */
#define MUTANT_ZERO_IS_EMPTY  3   /* triangle 0 taken for an empty slot */
#define MUTANT_SLAB_STRICT    4   /* < for <= in the box test */
#define MUTANT_SWAPPED_CHILD  5   /* the far child's reference replaced by the near one's */
#define MUTANT_NO_PRECISE     6   /* SPIR-V without its NoContraction decorations */
#define MUTANT_SHORT_STACK    7   /* the traversal stack is one entry short */
#define MUTANT_FAR_NOT_PADDED 8   /* far plane factor 1 */
#define MUTANT_BAD_TWIN       9   /* a running-error bound that ignores one rounding step's size */
#define MUTANT_FILTER_BOUND   20  /* the oracle's filter claims less error than it has */
#define MUTANT_LOST_CARRY     21  /* the highest carry of a wide sum is dropped */
#define MUTANT_TREE_UNPADDED  22  /* the oracle's tree trusts its box test to the last bit */
#define MUTANT_EARLY_BOUND    24  /* the vectorised filter claims less error than it has */
#define MUTANT_ENDS_SWAPPED   23  /* open ranges are taken as closed and closed ones as open */
#define MUTANT_NEAR_KEPT      30  /* watertight: near plane factor 1 */
#define MUTANT_NEAR_ROUNDED   33  /* a twin whose near-exact t is in float32 */
#define MUTANT_OPERAND_KEPT   32  /* a twin that flushes results, but not operands */
#define MUTANT_BEHIND_FORGOT  31  /* watertight: nothing reaches behind the origin */
#define MUTANT_CULLED_ALL     50  /* all hits: the nearest hit shortens the ray */
#define MUTANT_OPEN_EDGES     51  /* woop takes an edge function of zero for outside */
#define MUTANT_PAST_LAST_RAY  60  /* shaders: invocations past the last ray work, too */
#define MUTANT_FAN_OFF        40  /* watertight tests get a boundary band on closed fans */
#define MUTANT_NOT_CERTAIN    41  /* no exact hit is certain: losing it is always excused */
#define MUTANT_HUGE_BOUND     42  /* the bound of t times a million */
#define MUTANT_DEFECT_CURED   60  /* a member made to be wrong is right */
#define MUTANT_OTHER_DEFECT   61  /* it is wrong for another cause */
#define MUTANT_UNGUARDED      62  /* Embree is asked rays that it does not survive */
#define MUTANT_NEIGHBOUR      70  /* of many jobs each reads the first one's nodes */
#define MUTANT_FLAGS_UNREAD   71  /* of many jobs no ray's flags are looked at */
#define MUTANT_SIGN_OF_ZERO   80  /* the text of -0 has no sign */
#define MUTANT_COUNTED_TWICE  81  /* a finding that the log has is counted again */
#define MUTANT_LAST_IS_FIRST  82  /* the newest finding is taken for the first */
#define MUTANT_TRACER_DIES    83  /* engine cpu does not survive a ray whose tmax is NaN */
#define MUTANT_TRACER_HANGS   84  /* nor ends on it */
#define MUTANT_ALL_AS_RARE    110 /* feedback chooses every trial as often */
#define MUTANT_HELD_FORGOTTEN 111 /* feedback keeps trials that reach nothing new */
#define MUTANT_HALF_MESSAGE   90  /* what a dead child sent of a message is taken for all of it */
#define MUTANT_SIBLINGS_HELD  91  /* a child keeps the files that its parent had open */
#define MUTANT_EARLY_BESIDE   105 /* the same of the filter that looks for triangles on one side */
#define MUTANT_FACE_FORGOT    106 /* two hits of triangles with a vertex in common have the same t */
#define MUTANT_MEDIUM_SIGN    107 /* a product of middling integers is right of positive ones only */
#define MUTANT_NEVER_EXPIRES  112 /* an entry of the baseline excuses for ever */
#define MUTANT_EXPORT_NO_RAYS 115 /* export: the push constants say that there is no ray */
#define MUTANT_EXPORT_EXACT   116 /* export: only the exact numbers are right, to the bit */
#define MUTANT_EXPORT_ENDIAN  117 /* export: the bytes of a word in the other order */

#endif
