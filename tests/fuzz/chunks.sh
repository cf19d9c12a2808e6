# Read by fuzz.sh and fuzz_mechanisms.sh: seeds in chunks, several at a time, each in a directory of its own. The caller
# sets `work` (where decks and results go), `driver`, `chunk` (seeds), `jobs` (chunks at a time), `known` (seeds that are
# run beforehand) and `decks` (further words for the driver).

# run_chunk FIRST LAST: the driver again behind every seed at which it does not come back. The decks that fail are kept.
run_chunk() {
   first=$1
   last=$2
   place=$(mktemp -d "$work/chunk.XXXXXX") || exit 3
   while [ "$first" -le "$last" ]; do
      "$driver" "$first" "$last" "$place" $decks > "$place/out" 2> "$place/err"
      status=$?
      cat "$place/out"
      if grep -aq '^SUMS ' "$place/out"; then
         if [ "$status" -ne 0 ]; then
            why=$(grep -a -m 1 -E 'ERROR|SUMMARY' "$place/err")
            echo "FAILED: SEEDS $first TO $last: STATUS $status AT THE END: $why"
            echo CRASHED
         fi
         break
      fi
      seed=$(head -n 1 "$place/seed" 2> /dev/null)
      if [ -z "$seed" ]; then
         echo "FAILED: SEEDS $first TO $last: THE DRIVER DOES NOT START: $(head -n 1 "$place/err")"
         echo CRASHED
         break
      fi
      grep -a '^SUMS ' "$place/seed"
      why=$(grep -a -m 1 -E 'runtime error|Fortran runtime|AddressSanitizer|SIG[A-Z]+' "$place/err")
      [ "$status" -eq 142 ] && why='NO END IN TIME'
      at=$(grep -a -m 1 -oE 'src/[a-z_0-9/]+\.f90:[0-9]+' "$place/err")
      echo "FAILED: SEED $seed: STATUS $status: ${why:-$(grep -a -m 1 . "$place/err")} $at"
      echo CRASHED
      cp "$place/deck" "$place/$seed.deck"
      first=$((seed + 1))
   done
   find "$place" -name '[0-9]*.deck' -exec mv {} "$work/" ';'
   rm -rf "$place"
}

# run_seeds COUNT FIRST: so many seeds, and each of `known` alone; lines of failures and of sums to $work/results.
run_seeds() {
   last=$(($2 + $1 - 1))
   {
      for a in $known; do
         echo "$a $a"
      done
      seq "$2" "$chunk" "$last" | while read -r a; do
         b=$((a + chunk - 1))
         [ "$b" -gt "$last" ] && b=$last
         echo "$a $b"
      done
   } | xargs -P "$jobs" -n 2 "$0" --chunk > "$work/results"
}

if [ "$1" = --chunk ]; then
   run_chunk "$2" "$3"
   exit 0
fi
