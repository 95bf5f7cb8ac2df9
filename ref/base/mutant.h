/* Numbers of the planted bugs. The shipped program is compiled with MUTANT 0 and holds none;
 * tests/house/mutants.sh and mutants.mk compile one C unit or shader with -DMUTANT=n into build/mutants/,
 * and the suite (tests/house/mutants_list.txt) or the fuzzer (fuzz/selftest.txt) must find it. Plain
 * #define, so that GLSL can include it. */
#ifndef MUTANT_H
#define MUTANT_H

#ifndef MUTANT
#define MUTANT 0
#endif

#define MUTANT_HALF_NEAREST    1   /* bounds rounded to nearest instead of outward */
#define MUTANT_LOST_SLOT       2   /* the eighth item slot of a leaf is not read */
#define MUTANT_ZERO_IS_EMPTY   3   /* triangle 0 taken for an empty slot */
#define MUTANT_SLAB_STRICT     4   /* < for <= in the box test */
#define MUTANT_SWAPPED_CHILD   5   /* the far child's reference replaced by the near one's */
#define MUTANT_NO_PRECISE      6   /* SPIR-V without its NoContraction decorations */
#define MUTANT_SHORT_STACK     7   /* the traversal stack is one entry short */
#define MUTANT_FAR_NOT_PADDED  8   /* far plane factor 1 */
#define MUTANT_BAD_TWIN        9   /* a running-error bound that ignores one rounding step's size */
#define MUTANT_FILTER_BOUND    20  /* the oracle's filter claims less error than it has */
#define MUTANT_LOST_CARRY      21  /* the highest carry of a wide sum is dropped */
#define MUTANT_TREE_UNPADDED   22  /* the oracle's tree trusts its box test to the last bit */
#define MUTANT_EARLY_BOUND     24  /* the vectorised filter claims less error than it has */
#define MUTANT_ENDS_SWAPPED    23  /* open ranges are taken as closed and closed ones as open */
#define MUTANT_NEAR_KEPT       30  /* watertight: near plane factor 1 */
#define MUTANT_NEAR_ROUNDED    33  /* a twin whose near-exact t is in float32 */
#define MUTANT_OPERAND_KEPT    32  /* a twin that flushes results, but not operands */
#define MUTANT_BEHIND_FORGOT   31  /* watertight: nothing reaches behind the origin */
#define MUTANT_CULLED_ALL      50  /* all hits: the nearest hit shortens the ray */
#define MUTANT_OPEN_EDGES      51  /* woop takes an edge function of zero for outside */
#define MUTANT_PAST_LAST_RAY   60  /* shaders: invocations past the last ray work, too */
#define MUTANT_LOST_IS_NEAREST 660 /* the judge names a lost hit as the nearest one */
#define MUTANT_T_OF_A_DOUBLE   661 /* an exact t is told as the middle of its enclosure */
#define MUTANT_NEAR_IS_ENOUGH  662 /* explain: far rays need not agree with an imitation */
#define MUTANT_CAUSE_UNTOLD    663 /* explain: a cause needs no ray that tells of it */
#define MUTANT_SCALE_BY_VERDICT 664 /* explain: an answer that is the same, scaled, is a cure */
#define MUTANT_CURE_IS_NEAREST 820 /* explain: at another scale the nearest hit must be answered */
#define MUTANT_SCALE_ONCE      665 /* explain: right at one other scale is enough for a cause */
#define MUTANT_STOPPED_FOR_EVER 795 /* a stopped worker is waited for without end */
#define MUTANT_STOPPED_IS_HUNG  796 /* what a worker was at when somebody stopped it is a finding */
#define MUTANT_QUEUE_COUNTS    850 /* waiting for a processor counts as hanging */
#define MUTANT_FAN_OFF         40  /* watertight tests get a boundary band on closed fans */
#define MUTANT_NOT_CERTAIN     41  /* no exact hit is certain: losing it is always excused */
#define MUTANT_HUGE_BOUND      42  /* the bound of t times a million */
#define MUTANT_DEFECT_CURED    63  /* a member made to be wrong is right */
#define MUTANT_OTHER_DEFECT    61  /* it is wrong for another cause */
#define MUTANT_UNGUARDED       62  /* Embree is asked rays that it does not survive */
#define MUTANT_NEIGHBOUR       70  /* of many jobs each reads the first one's nodes */
#define MUTANT_FLAGS_UNREAD    71  /* of many jobs no ray's flags are looked at */
#define MUTANT_SIGN_OF_ZERO    80  /* the text of -0 has no sign */
#define MUTANT_LINK_FOLLOWED     720 /* folders of others: links are followed */
#define MUTANT_ANY_KIND          721 /* folders of others: a pipe, a device, a folder will do as a file */
#define MUTANT_HARD_LINK_WRITTEN 722 /* folders of others: what has a second name is appended to */
#define MUTANT_LINE_TWICE        726 /* a line that the findings' log has twice counts twice */
#define MUTANT_TOTAL_UNREAD      727 /* how many findings a checkpoint says is not compared */
#define MUTANT_FILES_UNMISSED    728 /* a finding of the log needs no files */
#define MUTANT_LOSS_UNSEEN       729 /* a log that lost lines, or is lost, is taken */
#define MUTANT_MERGED_TWICE      730 /* a finding of two folders is two */
#define MUTANT_COUNTS_LEFT       731 /* counts that a killed writer left behind stay so */
#define MUTANT_SHORT_IS_WHOLE    724 /* files: what the system took a part of is taken for written */
#define MUTANT_INTERRUPTED       725 /* files: a write that a signal interrupts has failed */
#define MUTANT_WRITE_UNCHECKED   732 /* files: a write that failed is taken for written */
#define MUTANT_RENAME_UNCHECKED  733 /* files: a rename that failed is taken for one */
#define MUTANT_LEFT_STAYS        790 /* files: what killed writers left is not removed */
#define MUTANT_HELD_REMOVED      791 /* files: what another writer is writing is removed */
#define MUTANT_NAMED_AT_ONCE     792 /* files: they have temporary names from the beginning */
#define MUTANT_UNREAD_IS_WELL    793 /* report: a picture that cannot be read is none that fails */
#define MUTANT_PRINTED_LOST      794 /* report: what a part could not print is not missed */
#define MUTANT_UNREAD_IS_SMALL   734 /* fuzz: a finding that cannot be read needs no shrinking */
#define MUTANT_MERGE_LEFT        735 /* merge: what a killed one left stays */
#define MUTANT_COUNTED_TWICE   81  /* a finding that the log has is counted again */
#define MUTANT_LAST_IS_FIRST   82  /* the newest finding is taken for the first */
#define MUTANT_TRACER_DIES     83  /* engine cpu does not survive a ray whose tmax is NaN */
#define MUTANT_TRACER_HANGS    84  /* nor ends on it */
#define MUTANT_BOX_UNCOUNTED   340 /* numbers of a ray: the root's box is not counted */
#define MUTANT_AROUND_OPEN     341 /* a point on a box's lower bound is not in it */
#define MUTANT_DEPTH_LAST      342 /* the stack's depth at the last push, not the greatest */
#define MUTANT_SHOW_BACKWARDS  343 /* differences of pictures: first less second */
#define MUTANT_PIXEL_LOST      345 /* pictures of the tree: the first pixel of a part has no value */
#define MUTANT_DECODED_TURNED  346 /* a packed tree is decoded with its children changed over */
#define MUTANT_WRONG_IS_BLUE   344 /* pictures of verdicts: what is wrong looks as what is right */
#define MUTANT_ALL_AS_RARE     110 /* feedback chooses every trial as often */
#define MUTANT_NOT_ESCAPED     113 /* text goes into JUnit and TAP as it is */
#define MUTANT_UNPLAYED_PASS   114 /* a contestant that played nothing passes */
#define MUTANT_REFUSERS_PASS   680 /* what was named need not answer anything */
#define MUTANT_ONE_ANSWER_DOES 681 /* an engine may refuse all but one */
#define MUTANT_CPU_STANDS_IN   682 /* conform: engine cpu passes trials that others refused */
#define MUTANT_FUZZ_REFUSERS   683 /* fuzz: a contestant need not answer anything */
#define MUTANT_TURNOUT_FORGOT  684 /* fuzz: a resumed campaign forgets who answered before */
#define MUTANT_WAIVERS_LEFT    685 /* conform --hard: the waivers of the program are not read */
#define MUTANT_KNOWN_FAILS     686 /* report: a finding that the baseline knows fails it */
#define MUTANT_OUTPUT_LATE     687 /* outputs are not tried before the work is done */
#define MUTANT_NAME_WITH_COLON 688 /* a finding's folder is named after its engine as it is */
#define MUTANT_INTERPRETER     689 /* a peer is called after the first word of its command */
#define MUTANT_FAST_IS_MT      690 /* rows of engine fast say what was asked for, not what ran */
#define MUTANT_OWN_IS_MT       797 /* rows of engines with tests of their own name those asked for */
#define MUTANT_HARD_LISTS      691 /* conform --hard: --layout, --builder, --box, --tri do nothing */
#define MUTANT_OPTION_SWALLOWED 750 /* options of builders are taken without a builder that reads them */
#define MUTANT_OPTION_UNNAMED  751 /* a command's last option is not among those that were given */
#define MUTANT_HARD_TURNS      752 /* hard cases: layouts that come by turns meet one builder */
#define MUTANT_MATRIX_NARROW   1200 /* the matrix of the hard cases has room for 64 columns */
#define MUTANT_HELD_FORGOTTEN  111 /* feedback keeps trials that reach nothing new */
#define MUTANT_HALF_MESSAGE    90  /* what a dead child sent of a message is taken for all of it */
#define MUTANT_SIBLINGS_HELD   91  /* a child keeps the files that its parent had open */
#define MUTANT_EARLY_BESIDE    105 /* the same of the filter that looks for triangles on one side */
#define MUTANT_FACE_FORGOT     106 /* two hits of triangles with a vertex in common have the same t */
#define MUTANT_MEDIUM_SIGN     107 /* a product of middling integers is right of positive ones only */
#define MUTANT_OTHER_TWIN      108 /* a judge of many takes the twin of another triangle */
#define MUTANT_LANE_SLIPPED    109 /* twins by vectors are all concluded with the first ray */
#define MUTANT_ORDER_KEPT      120 /* answers are handed out in the order of the dispatch */
#define MUTANT_SIDES_BELIEVED  310 /* a PNG file's sides are allocated for, however short it is */
#define MUTANT_LINE_THIN       311 /* smooth lines are a pixel thinner than asked for */
#define MUTANT_ZERO_COLOURED   312 /* a difference of 0 has a colour */
#define MUTANT_TICKS_EVEN      313 /* a scale bar's ticks are not where their numbers are */
#define MUTANT_ALPHA_UNREAD    314 /* pictures that differ in alpha alone are said to be equal */
#define MUTANT_FLAT_RANGE      315 /* a chart's axis may have no width */
#define MUTANT_GAPS_CLOSED     316 /* a chart's line goes on where a value is missing */
#define MUTANT_NEVER_EXPIRES   112 /* an entry of the baseline excuses for ever */
#define MUTANT_EXPORT_NO_RAYS  115 /* export: the push constants say that there is no ray */
#define MUTANT_EXPORT_EXACT    116 /* export: only the exact numbers are right, to the bit */
#define MUTANT_EXPORT_ENDIAN   117 /* export: the bytes of a word in the other order */
#define MUTANT_COUNT_BELIEVED  118 /* a PLY file's counts are allocated for before they are read */
#define MUTANT_BLOB_BELIEVED   119 /* a packed tree from outside is traced unchecked */
#define MUTANT_ANY_CAUSE       100 /* the shrinker keeps the kind of a finding, but not its cause */
#define MUTANT_ONE_ROUND       101 /* it stops after a round, whatever that found */
#define MUTANT_UNPAID          102 /* its asks are not limited */
#define MUTANT_NOT_ASKED       103 /* it takes the candidate beside the one that shows it */
#define MUTANT_HANG_IS_CRASH   104 /* an engine that hangs is said to have crashed */
#define MUTANT_STATE_AHEAD     92 /* a campaign's state says that what workers still play is done */
#define MUTANT_SHARDS_OVERLAP  93 /* shard 2 of a campaign plays what shard 1 does */
#define MUTANT_BLAMED_TOGETHER 94 /* of trials played together the first is blamed for a death */
#define MUTANT_STILL_LEFT_OUT  95 /* an engine that died plays no more of its block */
#define MUTANT_ANY_TREE_FITS   300 /* a tree of another scene is taken */
#define MUTANT_NO_DOUBT        301 /* nothing is said of boxes that are too small */
#define MUTANT_STEPS_SWAPPED   302 /* of two transforms the second is done first */
#define MUTANT_MATERIAL_NEXT   303 /* construct: material k means k + 1, as in the seed */
#define MUTANT_WINDING_KEPT    304 /* construct: a mirrored model is turned inside out */
#define MUTANT_OWN_VERTICES    305 /* construct: a later model has the first one's vertices */
#define MUTANT_ORDER_UNREAD    306 /* records in any order are unpacked as if in pre-order */
#define MUTANT_DEATH_SPIRAL    350 /* after a stall all the time lost is made up for */
#define MUTANT_TWO_IN_FLIGHT   351 /* a frame is begun while one is in flight */
#define MUTANT_SAME_TREE       353 /* Figure 8: both handlers by the tree of one */
#define MUTANT_PIXELS_ALONE    354 /* frames with the same 8-bit pixels are equal */
#define MUTANT_SHADOW_BEYOND   320 /* what lies beyond a light shadows it */
#define MUTANT_POW_IS_EXACT    321 /* pow is taken to be the same everywhere */
#define MUTANT_EYE_UNLIT       322 /* the light at the eye stands at the origin */
#define MUTANT_STRIP_FORGOT    323 /* every strip of a large picture begins at the top */
#define MUTANT_LIGHT_SLIPPED   324 /* answers of shadow rays go to the first paths, asked or not */
#define MUTANT_T_BY_VALUE      370 /* diff: t of -0 and 0 is the same */
#define MUTANT_SHADOWS_UNSEEN  371 /* diff: a path may differ in its shadows */
#define MUTANT_BORDER_ANYWHERE 372 /* diff: a pixel may differ by 1, near a border or not */
#define MUTANT_NOBODY_WRONG    374 /* diff: wrong answers are explained, too */
#define MUTANT_PICTURE_TRUSTED 375 /* diff: an engine's picture is not held to its rays */
#define MUTANT_LAST_BIT        376 /* diff: the last number that differs is said to be the first */
#define MUTANT_KEY_IGNORED     373 /* window: the right arrow does nothing */
#define MUTANT_WARM_UP_KEPT    352 /* the first frame measured is the first drawn */
#define MUTANT_SQRT_OF_DRIVER  330 /* shader: the root is the driver's, uncorrected */
#define MUTANT_OFFSET_SIGN     331 /* shader: rays leave a surface on its other side */
#define MUTANT_SHADOW_BEHIND   332 /* shader: what is behind a light shades it, too */
#define MUTANT_WEIGHT_KEPT     333 /* shader: reflections do not grow weaker along a path */
#define MUTANT_LIGHT_LOST      334 /* shader: of several lights the first is not asked */
#define MUTANT_CORNER_SWAPPED  470 /* compact: corners of a first triangle swapped */
#define MUTANT_EDGE_SIGN       471 /* edges: the second edge runs the other way */
#define MUTANT_BLOCK_PRIM_LATE 472 /* compact: the first two triangles' numbers change places */
#define MUTANT_MOVED_HALVED    473 /* quantised: half of how far vertices moved is certified */
#define MUTANT_GRID_BELOW      474 /* quantised: vertices go to the grid point below */
#define MUTANT_GRID_AXIS       475 /* quantised, C and shader: z has the width of y */
#define MUTANT_WEIGHTS_ALONG   640 /* black box: u and v may weigh any point of the ray's line */
#define MUTANT_WEIGHTS_AT_T    641 /* black box: u and v must weigh the very point at t */
#define MUTANT_NO_SHAPE        642 /* black box: a sliver is allowed no more than any triangle */
#define MUTANT_BAND_OF_BEFORE  643 /* black box: 2^10 units are allowed */
#define MUTANT_EDGES_UNCOUNTED 644 /* black box: it may lose all hits that it may lose one by one */
#define MUTANT_FUZZ_EDGES      1240 /* fuzz, black box: what all trials lose is not added up */
#define MUTANT_EDGES_FORGOT    1241 /* fuzz: a resumed campaign forgets what was lost beside edges */
#define MUTANT_LINE_REFUSED    1242 /* black box: a triangle that is a line cannot be hit */
#define MUTANT_DIFF_OF_NOTHING 1243 /* diff: two pictures without a hit agree */
#define MUTANT_SCALE_BY_SHAPE  1244 /* fuzz: what axes of their own cure is always called scale */
#define MUTANT_P99_IS_P90      1245 /* black box: the 90th percentile of displacements for the 99th */
#define MUTANT_EDGES_WIDER     1246 /* black box: half as many hits again may be lost */
#define MUTANT_LISTS_BESIDE    1247 /* black box: what lists lose beside edges is not counted */
#define MUTANT_LISTS_NEAREST   1248 /* black box: the nearest hit of each list stands for it */
#define MUTANT_LISTS_AT_ENDS   1249 /* black box: a list loses hits at the range's ends for edges */
#define MUTANT_EDGES_REPEATED  645 /* black box: a ray given often counts as often */
#define MUTANT_FANS_FORGIVEN   646 /* --require watertight: what closed fans lose is not counted */
#define MUTANT_CONFORM_LENIENT 1220 /* conform: what is demanded beyond the judge's own is not */
#define MUTANT_EXPLAIN_SILENT  1221 /* explain --json: no file where no ray is wrong */
#define MUTANT_SHOULD_FOR_MUST 647 /* leaks: only rows that promise must keep a profile */
#define MUTANT_NEED_WITHOUT    476 /* quantised: the displacement excuses every answer */
#define MUTANT_GROUP_LATE      335 /* shader: a workgroup is there from its second path on */
#define MUTANT_AXIS_TRUSTED    436 /* a twin of baldwin_webber with C's axis alone */
#define MUTANT_TRANSFORM_EXACT 437 /* a twin of baldwin_webber whose transform has no error */

/* For raydiff fuzz --self-test: fuzz/selftest.txt says where each is planted. None is in the oracle
 * or the judge. */
#define MUTANT_CONTRACTED_EDGE     200 /* woop: an edge function of one fma and one product */
#define MUTANT_CONTRACTED_CROSS    201 /* mt: a cross product's component the same way */
#define MUTANT_THIRD_AXIS          202 /* woop never shears along z */
#define MUTANT_BACK_CULLED         203 /* mt: a negative determinant is a miss */
#define MUTANT_SIGN_KEPT           204 /* mt: v keeps its sign where the determinant is negative */
#define MUTANT_PARALLELOGRAM       205 /* mt: u + v <= 1 is not asked for */
#define MUTANT_UV_SWAPPED          206 /* mt: u and v change places */
#define MUTANT_TMIN_OPEN           207 /* > for >= at tmin */
#define MUTANT_TMIN_UNREAD         208 /* 0 for tmin */
#define MUTANT_TMAX_OPEN           209 /* < for <= at tmax */
#define MUTANT_TMAX_UNREAD         210 /* no triangle is too far */
#define MUTANT_PARALLEL_DIVIDED    211 /* box test: no case for a component of 0 */
#define MUTANT_PARALLEL_STRICT     212 /* box test: < for <= on an axis that the ray is parallel to */
#define MUTANT_SLAB_REARRANGED     213 /* box test: b / d - o / d for (b - o) / d at the far plane */
#define MUTANT_FIRST_HIT_KEPT      214 /* the first hit found is the answer */
#define MUTANT_LATER_WINS          215 /* <= for <: of equally near hits the last found */
#define MUTANT_NUMBERS_KEPT        216 /* a nearer hit changes the triangle, not t, u, v */
#define MUTANT_MISS_IS_ZERO        217 /* a miss is triangle 0 */
#define MUTANT_LAST_IS_EMPTY       218 /* the scene's last triangle is taken for an empty slot */
#define MUTANT_ANY_FIRST_ITEM      219 /* any-hit tests only the first item of each leaf */
#define MUTANT_ANY_TOO_EARLY       220 /* any-hit ends with the first triangle tested */
#define MUTANT_EQUAL_ENTRY_LOST    221 /* of two children met at the same t one is forgotten */
#define MUTANT_FAR_FIRST           222 /* the farther child is visited first */
#define MUTANT_POP_STRICT          223 /* < for <= where a node that waited is looked at again */
#define MUTANT_BOTTOM_UNREAD       224 /* the lowest entry of the stack is never popped */
#define MUTANT_STACK_WRAPPED       225 /* the stack's index is cut to two bits */
#define MUTANT_HALF_TRUNCATED      226 /* bounds rounded toward zero instead of outward */
#define MUTANT_HALF_FLUSHED        227 /* subnormal bounds become 0, inward too */
#define MUTANT_HALF_NO_CARRY       228 /* rounding away stops where it would carry */
#define MUTANT_HALF_ABOVE_ONLY     229 /* rounds outward only from the middle on */
#define MUTANT_HALF_SIGN           230 /* shader: a half's sign is dropped */
#define MUTANT_SND_OFFSET          231 /* rf16: the second child's record before its leaves are added */
#define MUTANT_RECORD_CUT          232 /* rf16: record of the second child cut to 14 bits */
#define MUTANT_ITEM_CUT            233 /* rf16: items cut to 15 bits */
#define MUTANT_EIGHT_IS_NONE       234 /* rf16: the number of items cut to three bits */
#define MUTANT_HI_CUT              235 /* f32: a copy of the upper bounds is one float short */
#define MUTANT_ITEMS_UNSORTED      236 /* indexed: items in the scene's order, not the tree's */
#define MUTANT_SLOTS_WRAPPED       237 /* f32: only the first two items of a leaf are read */
#define MUTANT_WORD_LATE           238 /* shader: a triangle's last vertex read one word early */
#define MUTANT_BOUNDS_ONE_SHORT    239 /* builder: a node's last triangle is not in its box */
#define MUTANT_BOUNDS_BY_EXTENT    240 /* builder: upper bound as lower bound plus extent, rounded */
#define MUTANT_BOUNDS_TWO_VERTICES 241 /* builder: a triangle's third vertex is not in its box */
#define MUTANT_SPLIT_LOSES         242 /* builder: a split drops one triangle and doubles another */
#define MUTANT_GROUPS_CUT          243 /* vulkan: the last group of rays, not full, is not traced */
#define MUTANT_ITEMS_SHORT         244 /* vulkan: the shader is told of one item less */
#define MUTANT_EDGE_TURNED         430 /* pluecker: one edge runs the other way */
#define MUTANT_BACK_LOST           431 /* pluecker: a negative determinant is a miss */
#define MUTANT_T_HALVED            432 /* pluecker: t over the sum of the weights, twice what it is */
#define MUTANT_WEIGHTS_SWAPPED     433 /* baldwin_webber: u and v change places */
#define MUTANT_AXIS_SIGNED         434 /* baldwin_webber: the largest component, not the largest size */
#define MUTANT_SUM_UNASKED         435 /* baldwin_webber: u + v <= 1 is not asked for */
#define MUTANT_FOUND_ANYWAY        290 /* the self-test takes any finding for its bug */
#define MUTANT_WEIGHT_ALONE        380 /* a reflection's weight is the last mirror's alone */
#define MUTANT_OTHER_OFFSET        381 /* the published profile with an offset of its own */
#define MUTANT_MICROSECONDS        382 /* frames are told in thousandths of ms */
#define MUTANT_NAMES_SWAPPED       383 /* legend of verdicts: right is called wrong */
#define MUTANT_LAST_CODE           384 /* report: the exit code is the last part's */
#define MUTANT_SHADOW_FOLLOWED     385 /* why paths part: never at a shadow */
#define MUTANT_ERROR_HALVED        386 /* pictures of errors: half of each */
#define MUTANT_CERTAIN_OF_ONE      387 /* one ratio bounds a median with 95 % confidence */
#define MUTANT_COUNTED_AGAIN       388 /* construct: a normal is filled in for every corner */
#define MUTANT_GENERAL_DULL        389 /* the pipeline for every scene reflects nothing */
#define MUTANT_WIDE_UNSORTED       400 /* children of a wide node wait in the order of slots */
#define MUTANT_WIDE_ONE_LOST       401 /* where five children of a wide node are hit, one is lost */
#define MUTANT_CLIP_INWARD         421 /* sbvh: parts of triangles are rounded inward */
#define MUTANT_PLANE_NUDGED        422 /* sbvh: the first part ends an ulp before the plane */
#define MUTANT_PIECE_DROPPED       423 /* sbvh: a part of some triangles is in no child */
#define MUTANT_REPEATS_KEPT        424 /* all hits: split trees list triangles as often as they are */
#define MUTANT_COVER_FILTER        420 /* exact cover check: no error is allowed for in double */
#define MUTANT_GRID_INWARD         450 /* grid: bounds are one code too far inward */
#define MUTANT_GRID_SUM_ROUNDED    451 /* grid: a bound is chosen by its rounded sum */
#define MUTANT_GRID_SUBNORMAL      452 /* grid: a bound may decode to a subnormal */
#define MUTANT_GRID_STRADDLE       453 /* shader: 12-bit codes that lie in two words are cut */
#define MUTANT_GRID_ITEM_BASE      454 /* grid: items of a node's second leaf are the first's */
#define MUTANT_GRID_SCALE_OF_X     455 /* shader: every axis has the scale of x */
#define MUTANT_NOISE_BELIEVED  600 /* any answer of an open determinant is taken for possible */
#define MUTANT_RANGE_UNASKED   601 /* Embree's t may lie outside the range */
#define MUTANT_EQUAL_APART     602 /* a replay's equal vertices may come to different numbers */
#define MUTANT_GRID_UNREAD     603 /* any quotient of a divisor is taken for a possible one */
#define MUTANT_RANGE_EXACT     604 /* Embree's t may not lie outside the range at all */
#define MUTANT_SUM_TO_NEAREST  605 /* a replay's sums are rounded to nearest whatever is allowed */
#define MUTANT_UNNAMED_BELIEVED 606 /* a black box's hits without a triangle are not judged */
#define MUTANT_UNNAMED_LOOK    607 /* the first look at triangles allows for no rounding */
#define MUTANT_ANY_EXCUSED     608 /* a tie excuses that any-hit and closest-hit disagree */
#define MUTANT_TRAIL_LOST          490 /* without a stack: on level 2 the other child is forgotten */
#define MUTANT_PAIRS_UNMET         505 /* a covering array ends before all pairs met */
#define MUTANT_HTML_UNESCAPED      360 /* report: text stands in the page as it is */
#define MUTANT_HTML_LEFT_OPEN      361 /* report: cells of tables are not closed */
#define MUTANT_BASE64_TAIL         362 /* report: the last bytes of a picture are lost */
#define MUTANT_WRONG_UNSEEN        363 /* report: a row that is wrong looks like any other */
#define MUTANT_PART_EXCUSED        364 /* report: a part that failed is not in the exit code */
#define MUTANT_PART_UNREAD         1260 /* report: nor is one whose result cannot be read */
#define MUTANT_PICTURE_BELIEVED    365 /* report: a damaged picture is taken as it is */
#define MUTANT_RULE_UNTOLD         772 /* fuzz: bytes that are no tree are unexplained */
#define MUTANT_RECORD_UNSAID       773 /* fuzz, replay: which record is at fault is left out */
#define MUTANT_EXPLAIN_NO_RECORD   774 /* explain: which record is at fault is left out */
#define MUTANT_DECODE_LAST         775 /* decode: the last record is not compared */
#define MUTANT_DECODE_SLOT         776 /* decode: the last slot of a node is not compared */
#define MUTANT_REPORT_NO_SHADER    770 /* report: a layout from outside goes without its shader */
#define MUTANT_MIN_LAYOUT_UNUSED   771 /* min: a layout that no finding is on is taken */
#define MUTANT_REPLAY_FORGOTTEN    366 /* report: a finding has no line that plays it again */
#define MUTANT_ITEMS_UNCOUNTED     367 /* report: size against speed without the item array */
#define MUTANT_EXPONENT_SHORT      460 /* cwbvh80: a node's exponents are one too small */
#define MUTANT_PLANE_INWARD        461 /* cwbvh80: upper planes are one step too low */
#define MUTANT_CHILD_ORDER         462 /* cwbvh80, shader: children that are nodes in reverse order */
#define MUTANT_GROWN_INWARD        463 /* amd64: growth makes boxes smaller */
#define MUTANT_WIDTH_UNREAD        464 /* amd64, shader: float32 nodes are read as float16 ones */
#define MUTANT_HALVES_SWAPPED      465 /* half4, shader: of two halves the other one is read */
#define MUTANT_TOP_BITS_CUT        466 /* tiny8: an upper plane's highest bit is cut */
#define MUTANT_ITEMS_BEFORE        467 /* tiny8, shader: nodes are counted as items before a leaf */
#define MUTANT_GROW_DEPTH          410 /* builders: the depth is not bounded */
#define MUTANT_GROW_BOUNDS         411 /* a node's box lacks its second child's */
#define MUTANT_PLUGIN_SIZES        480 /* what a plugin says of its arrays' sizes is not looked at */
#define MUTANT_PLUGIN_EMPTY_LEAF   481 /* a plugin's leaves may have no items */
#define MUTANT_PLUGIN_BELIEVED     482 /* a plugin's nodes are not looked at one by one */
#define MUTANT_PLUGIN_UNCHECKED    483 /* what a plugin packed is not checked against the scene */
#define MUTANT_PLUGIN_REFS_RAW     484 /* a plugin's references are passed on as they are */
#define MUTANT_PLUGIN_EXCUSED      485 /* a plugin's boxes may be too small */
#define MUTANT_PLUGIN_ANY_VERSION  486 /* a plugin of another version is taken */
#define MUTANT_PLUGIN_DEATH_UNSEEN 487 /* a plugin that crashed is said to have no memory */
#define MUTANT_PLUGIN_ANY_SLOT     540 /* a plugin's leaf may be a child slot of another record */
#define MUTANT_PLUGIN_LEAF_RECORD  541 /* a plugin's records of a wide tree may be leaves */
#define MUTANT_GLSL_LINES_LOST     488 /* errors in a plugin's shader at lines of the whole text */
#define MUTANT_GLSL_NOT_PINNED     489 /* a plugin's shader is traced as it was compiled */
#define MUTANT_BLOCK_CORNER        440 /* fast: vertices from the ninth on are taken for others */
#define MUTANT_CODE_NEAREST        441 /* fast: upper bounds are a step too low */
#define MUTANT_FAST_UNPADDED       442 /* fast: boxes without their padding */
#define MUTANT_FAST_CONTRACTED     443 /* fast: an edge function is contracted */
#define MUTANT_FAST_LAST_LEFT      535 /* fast, in pairs: the last ray is left where it was */
#define MUTANT_TURN_TWICE          536 /* a race: a round may begin with who ended the last */
#define MUTANT_CACHE_FIFO          500 /* the simulated cache drops the line that came first */
#define MUTANT_FRONT_OF_TWO        501 /* the front looks at size and speed, not at errors */
#define MUTANT_TOUCH_ONCE          502 /* of a leaf only the first triangle's vertices are read */
#define MUTANT_PACKET_LANE         503 /* Embree's packets: a lane that is switched off has a hit */
#define MUTANT_SHADOW_BEHIND_HIT   504 /* shadow rays begin behind the surface */
#define MUTANT_BIN_UNSHARED        412 /* of bins filled by several threads only one thread's count */
#define MUTANT_SORT_BACKWARDS      413 /* a shared sort puts later threads' equal keys first */
#define MUTANT_LINKS_DEEP          414 /* a tree from below is as deep as it happens to be */
#define MUTANT_COLLAPSE_OVER       415 /* leaves of one more than allowed are made */
#define MUTANT_MOVE_KEPT           416 /* a move that makes the tree worse is not taken back */
#define MUTANT_ROOM_KEPT           417 /* a tree that cannot be written leaves its nodes allocated */
#define MUTANT_COST_OF_LEAF        418 /* a leaf costs one triangle, however many it has */
#define MUTANT_OVERLAP_OWN         419 /* overlap counts the triangles of the node itself, too */
#define MUTANT_TRIAL_NOT_REFITTED  515 /* fuzz: a trial's tree stays as it was before the motion */
#define MUTANT_TURN_SECOND         542 /* a race: who ended a round is the next one's second */
#define MUTANT_FAST_FAR_FIRST      543 /* fast: of three children and more the farthest is first */
#define MUTANT_PAIR_OF_REBUILT     544 /* fuzz: what was rebuilt counts as what stood still */
#define MUTANT_PLANE_BY_DOUBLE     545 /* planes in a node's frame are what doubles say */
#define MUTANT_NAN_IN_Z            546 /* refit: z may be anything */
#define MUTANT_MEAN_OF_FIVE        547 /* bench matrix: a mean of one kind of rays too many */
#define MUTANT_REAL_MEDIAN         620 /* bench tightness: real errors are told by their median */
#define MUTANT_NORMAL_EXACT        621 /* twins: the error of the normal is left out of t */
#define MUTANT_OWN_FORGOTTEN       622 /* twins: roundings of mt's p and q are left out of t */
#define MUTANT_SHEAR_EXACT         623 /* twins: woop's shear moves nothing, for t */
#define MUTANT_NEAR_IS_EXACT       624 /* twins: t's near value is taken for exact */
#define MUTANT_SLAB_EXACT          821 /* judge: Embree's default box test misses nothing */
#define MUTANT_SLAB_TO_REACH       626 /* judge: the range's end cuts no box of Embree's */
#define MUTANT_EXACT_REPLAYED      627 /* judge: exact numbers must be those of an evaluation, too */
#define MUTANT_ENDS_REPLAYED       840 /* judge: likewise, at the ends of a range */
#define MUTANT_SUBNORMAL_EXACT     841 /* judge: float32 numbers have no least step */
#define MUTANT_RUNNING_KEPT        625 /* twins: t has its running error alone */
#define MUTANT_LOST_NOT_COUNTED    548 /* quantised: hits lost of the original are not counted */
#define MUTANT_PAIRS_BY_CHANCE     516 /* fuzz: the rarest pair is not preferred */
#define MUTANT_INFINITE_LEAF       517 /* wide trees: what no leaf can hold is one if all is dear */
#define MUTANT_REFIT_LEVEL         495 /* refit: the second level keeps its boxes */
#define MUTANT_REFIT_BEYOND        496 /* refit: what is beyond the frame of the scene is taken */
#define MUTANT_REFIT_ULP           497 /* refit: leaves end one ulp early */
#define MUTANT_REFIT_HALF          498 /* refit: a tree that is to be built anew is changed */
#define MUTANT_REFIT_VERTICES_OLD  499 /* refit: vertices beside the nodes stay where they were */
#define MUTANT_WORDS_KEPT          520 /* layouts: words are kept where there is no memory for items */
#define MUTANT_RANGE_UNREAD        740 /* every version lies in a range of versions */
#define MUTANT_WALK_OF_NOTHING     521 /* a walk without memory is one of an empty tree */
#define MUTANT_MEMORY_BELIEVED     523 /* there is always memory enough */
#define MUTANT_ROOT_WITHOUT_LEAF   522 /* a wide tree of one leaf has none */
#define MUTANT_STANDARD_CLOSED     700 /* a closed standard output is left for the next file */
#define MUTANT_ENDS_WHEN_DONE      701 /* a signal waits until the picture is whole */
#define MUTANT_GROUP_ONLY          702 /* of a peer's processes only its group is ended */
#define MUTANT_LINE_HELD           703 /* a peer's guardian holds both ends of its line */
#define MUTANT_SHRUNK_EARLY        704 /* a campaign that a signal ends shrinks what it has so far */
#define MUTANT_PLUGIN_ANY_FILE     705 /* a FIFO is opened as a plugin */

#endif
