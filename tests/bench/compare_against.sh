#!/bin/bash
# make compare-against REF=COMMIT [N=3000] [SEED=1]: what this program answers and what the program at COMMIT answers, on the
# decks of input/ and tests/, on those of input/ with all questions, and on N random decks (tests/bench/ask_cards.awk).
# Statuses, messages, and all words of the listing are the same. Numbers of the CSV differ by at most what --errors of COMMIT
# says, or by 1E-9 of them; numbers of the listing, whose digits are fewer, by one in the last place in addition.
# MARKS=1: marks `?` of lost digits may differ. AT=PROGRAM: this program instead of the one that COMMIT makes.
# Each deck that differs is kept and named with its first differences. Below them: how many random decks with a card the old
# program took; of 200 decks or more some have each card. The last line is "N passed, N failed".
BUILD=${BUILD:-build}
[ -n "$REF$AT" ] || { echo 'REF=COMMIT says what to compare with'; exit 3; }
N=${N:-3000}
SEED=${SEED:-1}
export LC_ALL=C OPENBLAS_NUM_THREADS=1 MARKS=${MARKS:-0}
# Seconds of the processor for a run of the old program, and of this one. A deck that takes the old one longer is passed over.
old_seconds=10
new_seconds=30
w=$BUILD/compare
. tests/bench/program_at.sh

# run PROGRAM SECONDS OUT DECK: its outputs OUT.lst, .csv, .sum and .err, which has the status. A set with VARY cards and
# without PRINT is asked for rows alone: then as many variants are solved together as there are lanes.
run() {
   local program=$1 limit=$2 out=$3 deck=$4 numbers="--errors --csv $3.csv"
   rm -f "$out".{lst,csv,sum}
   grep -q '^VARY' "$deck" && ! grep -qE '^(PRINT|POLE|CURVE|PROVE)' "$deck" && numbers=
   { (ulimit -t "$limit"; exec timeout 600 "$program" "$deck" --jobs 1 -o "$out.lst" \
      --summary "$out.sum" $numbers 2> "$out.err"); } 2> /dev/null
   echo "STATUS $?" >> "$out.err"
   touch "$out".{lst,csv,sum}
}

# compare NAME DECK: a line for each difference. What the old program answers is kept for the next time.
compare() {
   local old=$kept/$1 new=$place/new kind
   cmp -s "$2" "$old.deck" || { run "$at" "$old_seconds" "$old" "$2"; cp "$2" "$old.deck"; }
   grep -qE '^STATUS (124|137|152)' "$old.err" && return
   run "$BUILD/kinmat" "$new_seconds" "$new" "$2"
   cmp -s "$old.err" "$new.err" || diff "$old.err" "$new.err" | grep '^[<>]' | sed 's/^/messages /'
   for kind in csv sum lst; do
      cmp -s "$old.$kind" "$new.$kind" && continue
      awk -v kind=$kind -v marks="$MARKS" -f tests/bench/compare_against.awk "$old.$kind" "$new.$kind"
   done
}

# one NAME DECK: a verdict
one() {
   compare "$1" "$2" > "$place/differences"
   if [ -s "$place/differences" ]; then
      cp "$2" "$w/$1.deck"
      echo "DIFFERENT $w/$1.deck"
      head -n 4 "$place/differences" | cut -c 1-160 | sed 's/^/   /'
   elif grep -qE '^STATUS (124|137|152)' "$kept/$1.err"; then
      echo SLOW
   else
      echo SAME
   fi
}

# carried NAME DECK: a line for each card that the deck has, if the old program took it.
carried() {
   grep -qE '^STATUS [02]$' "$kept/$1.err" || return
   { sed -nE 's/^(EXTREMES|RANGE|ASSEMBLY|CIRCUITS|TOLER|PROVE|VARY|POLE|CURVE|BRANCH|JOINT|METHOD  (DENSE|MATRIX)).*/\1/p' "$2"
     sed -n 's/^[$] SEVERAL$/SEVERAL MECHANISMS/p' "$2"
     grep -oE '^ --- REDUNDANT EQUATION' "$kept/$1.lst" | sed 's/^ --- //'
     grep -q '^VARY' "$2" && [ ! -s "$kept/$1.csv" ] && echo 'ROWS OF VARIANTS ALONE'
   } | sort -u | sed 's/^/CARRIED /'
}

# share K: every K-th of two shares of all decks
share() {
   place=$w/share$1
   mkdir -p "$place"
   k=0
   for deck in input/*.deck tests/system/decks/*.deck; do
      k=$((k + 1))
      [ $((k % 2)) = "$1" ] || continue
      name=$(basename "$deck" .deck)
      one "$name" "$deck"
      [ "${deck%/*}" = input ] || continue
      grep -vE '^(METHOD|EXTREMES|RANGE|ASSEMBLY|CIRCUITS)' "$deck" |
         sed 's/^END.*/EXTREMESALL\nRANGE\nASSEMBLY\n&/' > "$place/deck"
      one "$name.asked" "$place/deck"
   done
   for seed in $(seq "$SEED" $((SEED + N - 1))); do
      [ $((seed % 2)) = "$1" ] || continue
      case $((seed % 8)) in
      0|1|2|3) "$BUILD/debug/fuzz" --deck "$seed" "$place/drawn" input/*.deck;;
      4|5) "$BUILD/release/fuzz_mechanisms" --surplus "$seed" "$place/plain" "$place/drawn";;
      *) "$BUILD/release/fuzz_mechanisms" --deck "$seed" "$place/drawn";;
      esac
      awk -v seed="$seed" -f tests/bench/ask_cards.awk "$place/drawn" > "$place/deck"
      one "$seed" "$place/deck"
      carried "$seed" "$place/deck"
   done
}

rm -rf "$w/share"* "$w"/*.deck
mkdir -p "$w" || exit 3
at=$AT
[ -n "$at" ] || program_at "$REF" "$w"
[ -x "$at" ] || exit 3
kept=$w/kept.$(cksum < "$at" | tr ' ' .)
mkdir -p "$kept" || exit 3
share 0 > "$w/0.txt" &
share 1 > "$w/1.txt"
wait
grep -hvE '^(SAME$|SLOW$|CARRIED)' "$w"/[01].txt
cat "$w"/[01].txt | awk -v n="$N" '
   BEGIN {
      count = split("ASSEMBLY,BRANCH,CIRCUITS,CURVE,EXTREMES,JOINT,METHOD  DENSE,METHOD  MATRIX,POLE,PROVE,RANGE," \
         "REDUNDANT EQUATION,ROWS OF VARIANTS ALONE,SEVERAL MECHANISMS,TOLER,VARY", card, ",")
   }
   /^SAME$/ { passed++ }
   /^DIFFERENT/ { failed++ }
   /^SLOW$/ { slow++ }
   sub(/^CARRIED /, "") { carried[$0]++ }
   END {
      for (i = 1; i <= count; i++) {
         printf "%s%s %d", (i == 1 ? "RANDOM DECKS: " : ", "), card[i], carried[card[i]]
         if (n >= 200 && !carried[card[i]]) missing = missing "\nNO DECK CARRIES " card[i]
      }
      printf "%s\n%d decks take the old program too long\n", missing, slow
      printf "%d passed, %d failed\n", passed, failed
      exit failed > 0 || missing != ""
   }'
