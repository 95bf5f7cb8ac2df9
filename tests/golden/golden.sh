#!/bin/sh
# A wide record of what the commands say and write: any change of it that was not meant is seen.
#   sh tests/golden/golden.sh BUILD/raydiff             compares with tests/golden/record
#   sh tests/golden/golden.sh BUILD/raydiff --write     records anew
#   sh tests/golden/golden.sh BUILD/raydiff --case N    the whole output of a case, by its number or a part of its name
#   ... --drawn: other cases (tests/golden/drawn.pl, and more edits), and their record, tests/golden/drawn: of `make deep`
#   ... --first: until a case differs; --only TEXT: cases whose name has it; --list: their names; --times: the slowest; --twice: which differ by chance
# Cases stand in tests/golden/tables, of:
#   word NAME TEXT        what @NAME@ stands for, in all later files
#   table COMMAND         cases of that command, {} is where values come; they meet in pairs:
#   axis A | B | ...      each value meets each value of every other axis of the table, in some case
#   wrong A | B | ...     each with the first values of the axes, in a case of its own
#   also OPTIONS          so, too, but added to these
#                         of an option that a case would have twice the last one stands: twice it is refused unplayed
#   limits COMMAND        every option that its help names, without a value, and with values at and beyond its range
#   chain NAME, step ...  a case of several commands
#   edits FILE COMMAND    files that differ from FILE in one place each, at {} of the command
# A line that begins with a blank goes on with the line before. A case runs in a folder of its own; in/ has what
# ready.txt makes and tests/golden/input. The record has, for each case, 18 bits of every line of the standard output,
# the standard error and each file written, or of several where there are many; times left out (normal.pl), pictures by
# their pixels.
exec perl tests/golden/golden.pl "$@"
