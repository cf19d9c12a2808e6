#!/bin/sh
# make fuzz-extremes: the tables of EXTREMES of mechanisms by the dice, seeds FIRST to FIRST + COUNT - 1, against runs in
# steps 16 times finer: no number of these may lie beyond its extreme. The decks of those that fail are kept in
# $BUILD/extremes. The last line is "N passed, N failed".
#
#    tests/fuzz/fuzz_extremes.sh COUNT [FIRST [STEPS]]     STEPS of TIME in a run, 96 if not given
#    tests/fuzz/fuzz_extremes.sh --deck DECK STEPS         one deck
#    tests/fuzz/fuzz_extremes.sh --laws RISES CRANKS [FIRST]   random laws of drives against closed forms: see extremes_by_chance
export LC_ALL=C OPENBLAS_NUM_THREADS=1
BUILD=${BUILD:-build}
work=$BUILD/extremes
kinmat=${KINMAT:-$BUILD/kinmat}
finer=16
mkdir -p "$work" || exit 3

# deck_of DECK STEPS CARD: the deck with so many steps and this card instead of its requests. A set that has only AT cards
# runs from the first of their times to the last; about a single time for a hundredth of the unit.
deck_of() {
   awk -v n="$2" -v card="$3" '
      function run(low, high) {
         printf "%-8s%d\n*       %-24.16E%-24.16E\n", "TIME", n, low, high + (low < high ? 0 : 0.01)
      }
      function take_times(line, first, width,  text) {
         for (; first <= length(line); first += width) {
            text = substr(line, first, width)
            if (text !~ /[0-9]/) continue
            if (!times++ || text + 0 < low) low = text + 0
            if (times == 1 || text + 0 > high) high = text + 0
         }
      }
      /^AT/ { take_times($0, 33, 16) }
      /^[*]/ && name == "AT" { take_times($0, 9, 24) }
      !/^[*]/ { name = substr($0, 1, 8); sub(/ *$/, "", name) }
      name ~ /^(EXTREMES|PRINT|AT|VARY|POLE|CURVE|TOLER)$/ { next }
      /^TIME/ { has_run = 1; printf "%-8s%-24d%s\n", "TIME", n, substr($0, 33); next }
      /^END/ {
         if (!has_run) run(low, high)
         print card
         has_run = times = 0
      }
      { print }' "$1"
}

# fine NAME STEPS OPTION: the CSV of the run in fine steps
fine() { "$kinmat" --quiet --no-listing $3 --csv "$work/$1.csv" "$work/$1.fine.deck" > /dev/null 2>&1; }

# compare NAME DECK STEPS: a line for each number that is missed, then the counts. Errors of the fine run are asked for only
# where some number seems to be missed.
compare() {
   deck_of "$2" "$3" 'EXTREMESALL' > "$work/$1.deck"
   deck_of "$2" "$(($3*finer))" 'PRINT   ALL' > "$work/$1.fine.deck"
   "$kinmat" --quiet "$work/$1.deck" > "$work/$1.lst" 2> "$work/$1.err"
   status=$?
   if [ "$status" -ne 0 ] && [ "$status" -ne 2 ]; then
      echo "FAILED: $1: STATUS $status: $(grep -m 1 . "$work/$1.err")"
      echo "SUMS 0 0 1 0 0 $1"
      return
   fi
   fine "$1" "$3"
   awk -f tests/fuzz/extremes_check.awk "$work/$1.lst" "$work/$1.csv" > "$work/$1.out"
   if grep -q '^MISSED' "$work/$1.out"; then
      fine "$1" "$3" --errors
      awk -f tests/fuzz/extremes_check.awk "$work/$1.lst" "$work/$1.csv" > "$work/$1.out"
   fi
   sed -e "s/^MISSED:/FAILED: $1:/" -e "s/^UNKNOWN:/UNKNOWN: $1:/" -e "/^SUMS/s/\$/ $1/" "$work/$1.out"
   grep -q '^MISSED' "$work/$1.out" || rm -f "$work/$1.deck"
   rm -f "$work/$1.fine.deck" "$work/$1.csv" "$work/$1.lst" "$work/$1.err" "$work/$1.out"
}

# laws KIND FIRST COUNT: the tables of so many laws against closed forms
laws() {
   "$BUILD/release/extremes_by_chance" decks "$@" > "$work/$1.deck"
   "$kinmat" --quiet "$work/$1.deck" > "$work/$1.lst"
   "$BUILD/release/extremes_by_chance" judge "$@" "$work/$1.lst"
}

case $1 in
--deck)
   compare "$(basename "$2" .deck)" "$2" "$3"
   exit
   ;;
--laws)
   { laws rises "${4:-1}" "$2"; laws cranks "${4:-1}" "$3"; } | tee "$work/laws" | grep -v ' passed, '
   awk '/ passed, .* failed$/ { passed += $1; failed += $3 }
      END { printf "%d passed, %d failed\n", passed, failed; exit (failed > 0) }' "$work/laws"
   exit
   ;;
esac
count=${1:-200}
first=${2:-1}
for seed in $(seq "$first" $((first + count - 1))); do
   "$BUILD/release/fuzz_mechanisms" --deck "$seed" "$work/seed" || exit 3
   compare "$seed" "$work/seed" "${3:-96}"
done | tee "$work/results" | grep -v '^SUMS'
awk '$1 == "SUMS" { checked += $2; extremes += $3; missed += $4; unknown += $5; passed_over += $6
      if ($2) compared++
      if ($4) failed++; else passed++ }
   END { printf "mechanisms compared %d of %d; numbers %d, where the table covers nothing %d\n", compared, passed + failed, checked, passed_over
      printf "extremes %d; missed %d, all digits open %d\n", extremes, missed, unknown
      printf "%d passed, %d failed\n", passed, failed
      exit (failed > 0) }' "$work/results"
