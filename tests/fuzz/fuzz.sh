#!/bin/sh
# make fuzz: decks made by chance through the debug build with sanitizers, COUNT of them from seed FIRST on, in chunks, two at
# a time. What a seed's deck is depends on its number alone. The last line is "N passed, N failed".
#
#    tests/fuzz/fuzz.sh COUNT [FIRST]     runs them
#    tests/fuzz/fuzz.sh --seed SEED       writes the deck of one seed to $BUILD/fuzz/SEED.deck and runs it alone
#    tests/fuzz/fuzz.sh --chunk FIRST LAST      what the two at a time are
export LC_ALL=C
BUILD=${BUILD:-build}
mkdir -p "$BUILD/fuzz" || exit 3
driver=$BUILD/${FUZZ_BUILD:-fuzz}/fuzz
chunk=${FUZZ_CHUNK:-500}
# Leaks are told at a chunk's end, as a failure of their own; the traps belong to the program, not to the sanitizers; memory
# given back is kept from use for a while, 16 MB of it.
quiet=handle_sigfpe=0:handle_segv=0:allocator_may_return_null=1:quarantine_size_mb=16:malloc_context_size=6
export ASAN_OPTIONS="${ASAN_OPTIONS:-$quiet}"
# One thread for a BLAS that would take all.
export OPENBLAS_NUM_THREADS=1
export UBSAN_OPTIONS="${UBSAN_OPTIONS:-print_stacktrace=1}"

# run_chunk FIRST LAST: the driver again behind every seed at which it does not come back
run_chunk() {
   first=$1
   last=$2
   place=$(mktemp -d "$BUILD/fuzz/chunk.XXXXXX") || exit 3
   while [ "$first" -le "$last" ]; do
      "$driver" "$first" "$last" "$place" input/*.deck > "$place/out" 2> "$place/err"
      status=$?
      cat "$place/out"
      if grep -aq '^SUMS ' "$place/out"; then
         if [ "$status" -ne 0 ]; then
            echo "FAILED: SEEDS $first TO $last: STATUS $status AT THE END: $(grep -a -m 1 -E 'ERROR|SUMMARY' "$place/err")"
            echo 'CRASHED'
         fi
         break
      fi
      seed=$(head -n 1 "$place/seed" 2> /dev/null)
      if [ -z "$seed" ]; then
         echo "FAILED: SEEDS $first TO $last: THE DRIVER DOES NOT START: $(head -n 1 "$place/err")"
         echo 'CRASHED'
         break
      fi
      grep -a '^SUMS ' "$place/seed"
      why=$(grep -a -m 1 -E 'runtime error|Fortran runtime|AddressSanitizer|SIG[A-Z]+' "$place/err")
      [ "$status" -eq 142 ] && why='NO END IN TIME'
      at=$(grep -a -m 1 -oE 'src/[a-z_0-9/]+\.f90:[0-9]+' "$place/err")
      echo "FAILED: SEED $seed: STATUS $status: $why $at"
      echo 'CRASHED'
      first=$((seed + 1))
   done
   rm -rf "$place"
}

case $1 in
--chunk)
   run_chunk "$2" "$3"
   exit 0
   ;;
--seed)
   "$driver" --deck "$2" "$BUILD/fuzz/$2.deck" input/*.deck || exit 3
   echo "$BUILD/fuzz/$2.deck"
   mkdir -p "$BUILD/fuzz/$2" && "$driver" "$2" "$2" "$BUILD/fuzz/$2" input/*.deck
   exit
   ;;
esac

count=${1:-2000}
first=${2:-1}
last=$((first + count - 1))
all() {
   a=$first
   while [ "$a" -le "$last" ]; do
      b=$((a + chunk - 1))
      [ "$b" -gt "$last" ] && b=$last
      echo "$a $b"
      a=$((b + 1))
   done
}
if command -v parallel > /dev/null 2>&1; then
   all | parallel --will-cite -j 2 --colsep ' ' "$0" --chunk '{1}' '{2}'
else
   all | while read -r a b; do run_chunk "$a" "$b"; done
fi > "$BUILD/fuzz/results"

grep -a '^FAILED' "$BUILD/fuzz/results" | sort -k 3 -n | sed 's/^FAILED: SEED \([0-9]*\): .*/&\n   tests\/fuzz\/fuzz.sh --seed \1/'
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
   }' "$BUILD/fuzz/results"
