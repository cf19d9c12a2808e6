#!/bin/sh
# make fuzz-mechanisms: mechanisms by the dice whose motion is known in real128, COUNT of them from seed FIRST on, and some
# known ones, in chunks, as many at a time as there are processors. Three of four are chains of dyads, one of five has
# triads or tetrads, and one of twenty a group of 12 to 18 links. The deck of each that fails is kept. The last line is
# "N passed, N failed".
#
#    tests/fuzz/fuzz_mechanisms.sh COUNT [FIRST]       runs them
#    tests/fuzz/fuzz_mechanisms.sh --seed SEED         writes the deck of one seed to $BUILD/mechanisms/SEED.deck and runs it
#    tests/fuzz/fuzz_mechanisms.sh --chunk FIRST LAST  what some at a time are
export LC_ALL=C OPENBLAS_NUM_THREADS=1
BUILD=${BUILD:-build}
work=$BUILD/mechanisms
driver=$BUILD/release/fuzz_mechanisms
chunk=${FUZZ_CHUNK:-200}
jobs=${FUZZ_JOBS:-$(nproc)}
decks=
# Seeds that have found faults: a parallelogram of four cranks with links of a hundredth of its size in one block, whose
# velocities were worse than told; a small dyad on a long link, turned by the wrong angle of that one; a limit where the
# drive is slow; the other branch of a parallelogram that a dyad near its dead point builds on; a substep that ended next to
# where there are no velocities beside a change point; a parallelogram far from the first ground link; rates by METHOD DENSE
# and MATRIX that hang on arms which are zero but for rounding; an instant at the end of a rise that an estimate of errors put
# before it. And what may be: a tiny dyad in the one matrix of redundant equations, or of METHOD DENSE; a BRANCH card where several parallelograms are one block, since equations are redundant.
known='668292 1010852 1004109 739164 1032987 695632 9040787 9651168 9597347 10034684 17000996 9906375 10091989'
mkdir -p "$work" || exit 3

. tests/fuzz/chunks.sh

if [ "$1" = --seed ]; then
   "$driver" --deck "$2" "$work/$2.deck" || exit 3
   echo "$work/$2.deck"
   run_chunk "$2" "$2"
   exit
fi

run_seeds "${1:-1000}" "${2:-1}"
grep '^FAILED' "$work/results" | sort -k 3 -n
awk '
   $1 == "SUMS" { for (i = 1; i <= 9; i++) sum[i] += $(1 + i)
      above += $14
      for (i = 0; i < 3; i++) if ($(11 + i) > worst[i]) worst[i] = $(11 + i) }
   $1 == "CRASHED" { sum[4]++ }
   END {
      printf "chains of dyads %d, with triads and tetrads %d, with wide groups %d\n", sum[1], sum[2], sum[3]
      printf "instants %d, numbers %d; rows beyond limits %d, without a known truth %d, flagged near a singularity %d\n", \
         sum[5], sum[6], sum[7], sum[8], sum[9]
      printf "numbers off by more than the error told %d\n", above
      printf "largest errors, of what is allowed: positions %.3f, velocities %.3f, accelerations %.3f\n", \
         worst[0], worst[1], worst[2]
      printf "%d passed, %d failed\n", sum[1] + sum[2] + sum[3], sum[4]
      exit (sum[4] > 0)
   }' "$work/results"
