#!/bin/sh
# Relations between runs: with more steps, with its cards in the opposite order, moved, mirrored, in other units, with other
# reference points and axes of its links, beside another mechanism, begun in the middle and backwards, a mechanism has the
# same motion, and the same instants are flagged (tests/system/relation_deck.awk makes these decks). Numbers may differ by
# the errors that --errors tells of both.
#
#    relations.sh [DECK...]               every change of these decks, or of all of input/
#    relations.sh --short                 a fourth of the changes of each deck of input/, and of six decks by the dice, and
#                                         some changes of decks that have failed
#    relations.sh --random COUNT [FIRST]  decks of tests/fuzz/fuzz_mechanisms, COUNT of them from seed FIRST on; those that
#                                         fail are kept
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

# random COUNT FIRST
random() {
   for seed in $(seq "$2" $(($2 + $1 - 1))); do
      "$BUILD/release/fuzz_mechanisms" --deck "$seed" "$work/$seed.deck" || exit 3
      failed_before=$(grep -c failed "$counts")
      relate "$work/$seed.deck"
      [ "$(grep -c failed "$counts")" -gt "$failed_before" ] || rm -r "$work/$seed" "$work/$seed.deck"
   done
}

case $1 in
--random) random "$2" "${3:-1}" ;;
--short)
   every=4
   for path in $(grep -LE '^(VARY|LENGTH|SLOT)' input/*.deck); do relate "$path"; done
   random 6 1
   every=1
   changes=3 random 1 7059
   changes=axes random 1 7173 ;;
*) for path in ${*:-$(grep -LE '^(VARY|LENGTH|SLOT)' input/*.deck)}; do relate "$path"; done ;;
esac

# Axes that are not known to be others make differences.
w=$work/four_bar
[ -f "$w/whole.deck" ] || relate input/four_bar.deck
changed axes "$w/whole.deck"
run axes
grep -v '^link' "$w/axes.map" > "$w/no_axes.map"
equal 'differences are seen' 3 "$(differing axes "$w/no_axes.map" | grep -c '1,0,LINK,.* column')"
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
