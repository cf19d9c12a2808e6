#!/bin/sh
# Relations between runs: with more steps, with its cards in the opposite order, moved, mirrored, in other units, with other
# reference points and axes of its links, beside another mechanism, begun in the middle and backwards, a mechanism has the
# same motion, and the same instants are flagged (tests/system/relation_deck.awk makes these decks). Numbers may differ by
# the errors that --errors tells of both.
#
#    relations.sh [DECK...]               every change of these decks, or of all of input/
#    relations.sh --short                 a fifth of the changes of each deck of input/, and of six decks by the dice, and
#                                         some changes of decks that have failed
#    relations.sh --random COUNT [FIRST]  decks of tests/fuzz/fuzz_mechanisms, COUNT of them from seed FIRST on; those that
#                                         fail are kept
#    relations.sh --drawn COUNT [FIRST]   drawings of tests/fuzz/drawn_decks, likewise
. tests/counting.sh
work=$w

# Of the changes of deck number n those with a number k, k + n divisible by `every`.
changes='3 7 turned moved mirrored units axes beside middle back'
every=1
n=0

# changed CHANGE DECK: makes $w/CHANGE.deck and its map
changed() {
   awk -v change="$1" -v csv="$w/whole.csv" -v lst="$w/whole.lst" -v map="$w/$1.map" -f tests/system/relation_deck.awk \
      "$2" > "$w/$1.deck"
}

# run CHANGE: its results with errors
run() { "$kinmat" "$w/$1.deck" --errors --csv "$w/$1.csv" -o "$w/$1.lst" 2> "$w/$1.err"; }

# differing CHANGE MAP: what the run says, or what is different in its results
differing() {
   if [ -s "$w/$1.err" ]; then cat "$w/$1.err"; return; fi
   awk -v change="$1" -v is_close="$(grep -c 'NOT DISTINGUISHABLE' "$w/$1.lst")" -f tests/system/relation_rows.awk "$2" \
      "$w/whole.csv" "$w/$1.csv" | head -n 3
}

# relate DECK: changes of it against the deck
relate() {
   deck=$(basename "$1" .deck)
   w=$work/$deck
   mkdir -p "$w"
   awk -v change=whole -v map=/dev/null -f tests/system/relation_deck.awk "$1" > "$w/whole.deck"
   run whole
   equal "$deck is read" '' "$(cat "$w/whole.err")"
   n=$((n + 1))
   k=0
   for change in $changes; do
      k=$((k + 1))
      [ $(((k + n) % every)) -eq 0 ] || continue
      changed $change "$w/whole.deck"
      run $change
      equal "$deck, $change" '' "$(differing $change "$w/$change.map")"
   done
}

# random COUNT FIRST PROGRAM...: decks by a program; those with VARY cards or errors are left out
random() {
   count=$1
   first=$2
   shift 2
   for seed in $(seq "$first" $((first + count - 1))); do
      "$BUILD/$@" "$seed" "$work/$seed.deck" || exit 3
      if grep -q '^VARY' "$work/$seed.deck" || ! "$kinmat" --quiet --check "$work/$seed.deck" > "$work/out" 2>&1; then
         grep -q '^VARY' "$work/$seed.deck" || grep -qE ' E10[49] ' "$work/out" || equal "$seed is a deck" '' "$(head -n 5 "$work/out")"
         rm "$work/$seed.deck"
         continue
      fi
      # With more steps the motion may begin elsewhere if the first instant has no position.
      if "$kinmat" --quiet "$work/$seed.deck" | grep -qE 'NO POSITION FOUND|SOLVED 0,'; then
         rm "$work/$seed.deck"
         continue
      fi
      failed_before=$(grep -c failed "$counts")
      relate "$work/$seed.deck"
      [ "$(grep -c failed "$counts")" -gt "$failed_before" ] || rm -r "$work/$seed" "$work/$seed.deck"
   done
}

case $1 in
--random) random "$2" "${3:-1}" release/fuzz_mechanisms --deck ;;
--drawn) random "$2" "${3:-1}" debug/fuzz --drawn ;;
--short)
   every=5
   for path in $(grep -LE '^VARY' input/*.deck); do relate "$path"; done
   random 6 1 release/fuzz_mechanisms --deck
   random 8 1 debug/fuzz --drawn
   every=1
   changes=3 random 1 7059 release/fuzz_mechanisms --deck
   changes=axes random 1 7173 release/fuzz_mechanisms --deck ;;
*) for path in ${*:-$(grep -LE '^VARY' input/*.deck)}; do relate "$path"; done ;;
esac

# Axes that are not known to be others make differences.
w=$work/four_bar
[ -f "$w/whole.deck" ] || relate input/four_bar.deck
changed axes "$w/whole.deck"
run axes
grep -v '^link' "$w/axes.map" > "$w/no_axes.map"
equal 'differences are seen' 3 "$(differing axes "$w/no_axes.map" | grep -c '1,0,LINK,.* column')"
# So are a blank cell, a row that is missing, and results without a number.
changed moved "$w/whole.deck"
run moved
cp "$w/moved.csv" "$w/all.csv"
awk -F, -v OFS=, '$1 == 1 && $2 == 1 && $5 == "CRANK" { $8 = "" } { print }' "$w/all.csv" > "$w/moved.csv"
equal 'a blank cell is seen' 'blank: 1,1,LINK,CRANK column 8' "$(differing moved "$w/moved.map" | sed 's/: [^:]*$//')"
awk -F, '$1 != 1 || $2 != 1 || $5 != "CRANK"' "$w/all.csv" > "$w/moved.csv"
equal 'a missing row is seen' 'missing: 1,1,LINK,CRANK' "$(differing moved "$w/moved.map")"
sed 1q "$w/all.csv" > "$w/moved.csv"
equal 'no results are seen' 'no number is compared' \
   "$(awk -v change=moved -f tests/system/relation_rows.awk "$w/moved.map" "$w/whole.csv" "$w/moved.csv" | tail -n 1)"
# A length of other units that is off by 1 of 100 makes differences.
w=$work/book_four_bar
[ -f "$w/whole.deck" ] || relate input/book_four_bar.deck
changed units "$w/whole.deck"
awk '/^LENGTH  A  / { print; getline; sub(/[0-9.]+E/, "1.8E") } { print }' "$w/units.deck" > "$w/one.deck"
mv "$w/one.deck" "$w/units.deck"
run units
equal 'a length that is off is seen' 3 "$(differing units "$w/units.map" | grep -c ' column')"
# Assemblies in another order, and one more of them, are seen as well.
w=$work/triple_rocker
[ -f "$w/whole.deck" ] || relate input/triple_rocker.deck
changed moved "$w/whole.deck"
run moved
cp "$w/moved.csv" "$w/two.csv"
sed 's/ASSEMBLY 1/ASSEMBLY 0/; s/ASSEMBLY 2/ASSEMBLY 1/; s/ASSEMBLY 0/ASSEMBLY 2/' "$w/two.csv" > "$w/moved.csv"
equal 'another order of assemblies is seen' 3 "$(differing moved "$w/moved.map" | grep -c ' column')"
sed 's/ASSEMBLY 2/&/p; s/ASSEMBLY 2/ASSEMBLY 3/' "$w/two.csv" > "$w/moved.csv"
equal 'one more assembly is seen' 3 "$(differing moved "$w/moved.map" | grep -c 'one more')"
conclude
