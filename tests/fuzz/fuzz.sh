#!/bin/sh
# make fuzz: random decks through the debug build with sanitizers, COUNT of them from seed FIRST on, in chunks, two at a
# time. What a seed's deck is depends on its number alone. The last line is "N passed, N failed".
#
#    tests/fuzz/fuzz.sh COUNT [FIRST]     runs them
#    tests/fuzz/fuzz.sh --seed SEED       writes the deck of one seed to $BUILD/fuzz/SEED.deck and runs it alone
#    tests/fuzz/fuzz.sh --chunk FIRST LAST      what the two at a time are
export LC_ALL=C
BUILD=${BUILD:-build}
work=$BUILD/fuzz
driver=$BUILD/${FUZZ_BUILD:-fuzz}/fuzz
chunk=${FUZZ_CHUNK:-500}
jobs=${FUZZ_JOBS:-2}
decks=$(echo input/*.deck)
known=
mkdir -p "$work" || exit 3
# Leaks are told at a chunk's end, as a failure of their own; the traps belong to the program, not to the sanitizers; memory
# given back is kept from use for a while, 16 MB of it.
quiet=handle_sigfpe=0:handle_segv=0:allocator_may_return_null=1:quarantine_size_mb=16:malloc_context_size=6
export ASAN_OPTIONS="${ASAN_OPTIONS:-$quiet}"
# One thread for a BLAS that would take all.
export OPENBLAS_NUM_THREADS=1
export UBSAN_OPTIONS="${UBSAN_OPTIONS:-print_stacktrace=1}"

. tests/fuzz/chunks.sh

if [ "$1" = --seed ]; then
   "$driver" --deck "$2" "$work/$2.deck" $decks || exit 3
   echo "$work/$2.deck"
   mkdir -p "$work/$2" && "$driver" "$2" "$2" "$work/$2" $decks
   exit
fi

run_seeds "${1:-2000}" "${2:-1}"
grep -a '^FAILED' "$work/results" | sort -k 3 -n | sed 's/^FAILED: SEED \([0-9]*\): .*/&\n   tests\/fuzz\/fuzz.sh --seed \1/'
awk '
   $1 == "SUMS" { passed += $2; failed += $3; for (i = 0; i < 4; i++) ended[i] += $(4 + i)
      instants += $8; closures += $9; ill += $10
      for (i = 0; i < 3; i++) if ($(11 + i) > worst[i]) worst[i] = $(11 + i) }
   $1 == "CRASHED" { failed++ }
   END {
      printf "statuses 0, 1, 2, 3: %d, %d, %d, %d\n", ended[0], ended[1], ended[2], ended[3]
      printf "instants %d, closures recomputed %d, of them held to the condition %d\n", instants, closures, ill
      printf "largest residuals, of what is allowed: positions %.3f, velocities %.3f, accelerations %.3f\n", \
         worst[0], worst[1], worst[2]
      printf "%d passed, %d failed\n", passed, failed
      exit (failed > 0)
   }' "$work/results"
