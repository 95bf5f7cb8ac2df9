/* The two halves of raydiff diff: pictures, and engines on a scene. */
#ifndef CMD_DIFF_H
#define CMD_DIFF_H

/* raydiff diff A.png B.png; argv[0] is "diff". Returns the exit code. */
int cmd_diff_images(int argc, char **argv);

#endif
