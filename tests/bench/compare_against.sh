#!/bin/bash
# make compare-against REF=COMMIT [N=3000] [SEED=1]: what this program answers and what the program at COMMIT answers, on the
# decks of input/ and tests/, and on N random decks with questions. Statuses, messages, and all words of the listing are the
# same. Numbers of the CSV differ by at most what --errors of COMMIT says, or by 1E-9 of them; numbers of the listing, whose
# digits are fewer, by one in the last place in addition. Each deck that differs is kept and named with its first differences.
# The last line is "N passed, N failed".
BUILD=${BUILD:-build}
REF=${REF:?REF=COMMIT says what to compare with}
N=${N:-3000}
SEED=${SEED:-1}
export LC_ALL=C OPENBLAS_NUM_THREADS=1
# A run that takes longer is ended, and counts as one that says so.
seconds=30
w=$BUILD/compare
. tests/bench/program_at.sh

# compare NAME DECK: a line for each difference
compare() {
   for side in old new; do
      program=$BUILD/kinmat
      [ $side = old ] && program=$at
      rm -f "$place/$side".*
      timeout "$seconds" "$program" "$2" --jobs 1 --errors -o "$place/$side.lst" --csv "$place/$side.csv" --summary "$place/$side.sum" \
         2> "$place/$side.err"
      echo "STATUS $?" >> "$place/$side.err"
      touch "$place/$side.lst" "$place/$side.csv" "$place/$side.sum"
   done
   cmp -s "$place/old.err" "$place/new.err" || diff "$place/old.err" "$place/new.err" | grep '^[<>]' | sed 's/^/messages /'
   for kind in csv sum lst; do
      cmp -s "$place/old.$kind" "$place/new.$kind" && continue
      awk -v kind=$kind -f tests/bench/compare_against.awk "$place/old.$kind" "$place/new.$kind"
   done
}

# questions SEED DECK: the deck with cards that ask something before its last END, chosen by the seed's digits
questions() {
   awk -v seed="$1" '
      { line[++n] = $0 }
      /^LINK/ { links++ }
      /^METHOD/ { method = 1 }
      /^POINT/ && seed % 5 == 0 && length($0) < 49 { line[++n] = "TOLER                           0.01" }
      /^END/ { last = n }
      END {
         if (seed % 2) more = more "EXTREMESALL\n"
         if (seed % 3 == 0) more = more "RANGE\n"
         if (seed % 3 == 1) more = more "ASSEMBLY\n"
         if (seed % 4 == 2) more = more "PROVE\n"
         if (seed % 7 == 0 && links <= 5) more = more "CIRCUITS\n"
         if (seed % 11 == 5 && !method) more = more "METHOD  DENSE\n"
         if (seed % 11 == 7 && !method) more = more "METHOD  MATRIX\n"
         for (i = 1; i <= n; i++) { if (i == last) printf "%s", more; print line[i] }
      }' "$2"
}

# one NAME DECK: a verdict
one() {
   compare "$1" "$2" > "$place/differences"
   if [ -s "$place/differences" ]; then
      cp "$2" "$w/$1.deck"
      echo "DIFFERENT $w/$1.deck"
      head -n 4 "$place/differences" | cut -c 1-160 | sed 's/^/   /'
   else
      echo SAME
   fi
}

# share K: every K-th of two shares of all decks
share() {
   place=$w/share$1
   mkdir -p "$place"
   k=0
   for deck in input/*.deck tests/system/decks/*.deck; do
      k=$((k + 1))
      [ $((k % 2)) = "$1" ] && one "$(basename "$deck" .deck)" "$deck"
   done
   for seed in $(seq "$SEED" $((SEED + N - 1))); do
      [ $((seed % 2)) = "$1" ] || continue
      if [ $((seed % 4)) -lt 2 ]; then
         "$BUILD/debug/fuzz" --deck "$seed" "$place/drawn" input/*.deck
      else
         "$BUILD/release/fuzz_mechanisms" --deck "$seed" "$place/drawn"
      fi
      questions "$((seed/4))" "$place/drawn" > "$place/deck"
      one "$seed" "$place/deck"
   done
}

rm -rf "$w/share"* "$w"/*.deck
mkdir -p "$w" || exit 3
program_at "$REF" "$w"
export at
share 0 > "$w/0.txt" &
share 1 > "$w/1.txt"
wait
grep -hv '^SAME$' "$w"/[01].txt
cat "$w"/[01].txt | awk '/^SAME$/ { passed++ } /^DIFFERENT/ { failed++ }
   END { printf "%d passed, %d failed\n", passed, failed; exit failed > 0 }'
