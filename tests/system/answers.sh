#!/bin/sh
# The answer of the card EXTREMES: against closed forms in real128, which search by values alone; a range that takes long to find;
# what is refused.
. tests/counting.sh

# extremes FILE: the tables of extremes
extremes() { awk '/^ (EXTREMES|EKSTREMA)  / { on = 1 } /^ (BRANCH|GALAZ):/ { on = 0 } on' "$1"; }

# All links, points and pairs, with dwells: the same bytes as from closed forms. At the change points of the third deck
# there are no velocities, and beside them nothing is searched.
for deck in four_bar five_bar dixon parallelogram_at crank_slider; do
   with $deck "$(card EXTREMES ALL '' '' 0.01 1.0)" > "$w/$deck.deck"
   "$BUILD/release/print_expected" "$w/$deck.deck" > "$w/$deck.expected" 2>&1
   "$kinmat" "$w/$deck.deck" > "$w/$deck.listing" 2>&1
   same "$deck" "$w/$deck.expected" "$w/$deck.listing"
done
for deck in four_bar five_bar crank_slider; do
   with $deck "$(card EXTREMES ALL '' '' 0.01 1.0)" "$(card METHOD DENSE)" | awk '/^METHOD/ && !/DENSE/ { next } { print }' \
      > "$w/$deck.dense.deck"
   "$kinmat" "$w/$deck.dense.deck" > "$w/listing" 2>&1
   extremes "$w/listing" > "$w/dense"
   extremes "$w/$deck.expected" > "$w/newton"
   same "$deck, METHOD DENSE" "$w/newton" "$w/dense"
done

# DENSE ends at a change point: up to there it gives the table of NEWTON. Redundant equations it refuses.
for method in NEWTON DENSE; do
   with parallelogram_at "$(card EXTREMES ALL)" "$(card METHOD $method)" | sed "s/^TIME .*/$(card TIME 15 '' '' 0.0 15.0)/" \
      > "$w/deck"
   "$kinmat" "$w/deck" > "$w/listing" 2>&1
   extremes "$w/listing" > "$w/$method"
done
same 'parallelogram_at before its change point, METHOD DENSE' "$w/NEWTON" "$w/DENSE"
with dixon "$(card EXTREMES ALL)" "$(card METHOD DENSE)" > "$w/deck"
equal 'dixon, METHOD DENSE' 'E104' "$("$kinmat" "$w/deck" 2>&1 | sed -n 's/^ [*]* *\(E[0-9][0-9][0-9]\) .*/\1/p')"

# An instant on a change point that is found later only by rounding is passed over once.
with scott_russell_at "$(card EXTREMES LINKS BAR)" > "$w/deck"
equal 'instants on change points' ' --- EXTREMES MAY BE MISSED WITHIN T = 4.99609 .. 5.00391, 19.99609 .. 20.00391 S
 --- NOT COVERED, SINCE NOT ALL OF THE MOTION IS KNOWN: T = 5.00000, 20.00000 S' "$("$kinmat" "$w/deck" | grep 'MISSED\|COVERED')"

# A whole turn in one step of TIME: it is halved, and the table is the same; backwards the strokes change places.
sed "s/^TIME .*/$(card TIME 1 '' '' 0.0 12.0)/" input/stroke.deck > "$w/deck"
"$kinmat" "$w/deck" > "$w/listing" 2>&1
extremes "$w/listing" > "$w/one"
extremes expected/stroke.lst > "$w/small"
same 'a turn in one step' "$w/small" "$w/one"
sed "s/^TIME .*/$(card TIME 24 '' '' 12.0 0.0)/" input/stroke.deck > "$w/deck"
"$kinmat" "$w/deck" > "$w/listing" 2>&1
equal 'backwards' "$(awk '/^  (MIN-MAX|MAX-MIN|RATIO) / { print $2 }' "$w/small" | sort)" \
   "$(extremes "$w/listing" | awk '/^  (MIN-MAX|MAX-MIN|RATIO) / { print $2 }' | sort)"

# In other units of length and time the numbers have the same digits.
awk '/^(LINK|POINT) / { head = sprintf("%-32s", substr($0, 1, 32)); x = substr($0, 33, 16) + 0; y = substr($0, 49, 16) + 0
      printf "%s%-16.6E%-16.6E%s\n", head, x*1e6, y*1e6, substr($0, 65); next } { print }' input/stroke.deck > "$w/large.deck"
"$kinmat" "$w/large.deck" > "$w/listing" 2>&1
extremes "$w/listing" | grep -v '10[*][*]' > "$w/large"
extremes expected/stroke.lst > "$w/small"
same 'a million times as large' "$w/small" "$w/large"

# Polish: the same table.
with stroke "$(card LANG PL)" > "$w/stroke.deck"
"$BUILD/release/print_expected" "$w/stroke.deck" > "$w/expected" 2>&1
"$kinmat" "$w/stroke.deck" > "$w/listing" 2>&1
same 'in Polish' "$w/expected" "$w/listing"

# Without the listing nothing is searched, and the other outputs are the same with the card and without it.
with stroke "$(card RANGE)" > "$w/stroke.deck"
"$kinmat" --no-listing --csv "$w/with.csv" "$w/stroke.deck"
grep -v '^EXTREMES' input/stroke.deck > "$w/without.deck"
"$kinmat" --csv "$w/without.csv" "$w/without.deck" > /dev/null
"$kinmat" --csv "$w/listed.csv" "$w/stroke.deck" > /dev/null
same 'the CSV with and without EXTREMES' "$w/without.csv" "$w/with.csv"
same 'the CSV with and without the search' "$w/without.csv" "$w/listed.csv"

# Closer than rounding can tell, 1E-10: the ends to 1E-6 degrees, with the reason, which a run to there gives as well.
still_four_bar 3.0 1.1 2.6499999999 0.75 CRANK 50.0 -35.8 38.6 50.0 RANGE > "$w/deck"
"$kinmat" "$w/deck" > "$w/out"
equal 'at the limit of Grashof' 'MIN 0 MAX 0' "$(awk -v a="$(angle 3 0.75 3.7499999999)" '/^   (MIN|MAX) / && /DEG   LIMIT OR CHANGE POINT, TOO CLOSE TO TELL$/ {
   d = ($2 < 0 ? -$2 : $2) - a; printf "%s%s %d", sep, $1, ((d < 0 ? -d : d) > 1e-6); sep = " " }' "$w/out")"
sed "s/^AT .*/$(card TIME 100 '' '' 0.0 5.0)/" "$w/deck" > "$w/run.deck"
equal 'at the limit of Grashof: a run' ' *** THE MOTION IS FOLLOWED TO T = 4.33329...E+00: LIMIT OR CHANGE POINT, TOO CLOSE TO TELL' \
   "$("$kinmat" "$w/run.deck" | sed -n 's/^\( .*T = 4.33329\)[0-9]*\(.* TOO CLOSE .*\)/\1...\2/p')"

# refusal NAME CARD CODE: the deck stroke with this card
refusal() {
   with stroke "$2" > "$w/deck"
   "$kinmat" "$w/deck" > "$w/out" 2> "$w/err"
   equal "$1: status" 1 $?
   equal "$1: code" "$3" "$(sed -n 's/^ [*]* *\(E[0-9][0-9][0-9]\) .*/\1/p' "$w/err")"
}
refusal 'a ground link' "$(card EXTREMES LINKS BASE)" E099
refusal 'a ground point' "$(card EXTREMES POINTS A0)" E099
refusal 'twice' "$(card EXTREMES POINTS C)" E096
refusal 'no such pair' "$(card EXTREMES PAIRS NONE)" E053
refusal 'a negative distance' "$(card EXTREMES LINKS CRANK '' '' -1.0)" E036
refusal 'ranges with a field' "$(card RANGE CRANK)" E019
sed -e 's/^TIME .*/AT                              1.0/' input/stroke.deck > "$w/deck"
"$kinmat" "$w/deck" > "$w/out" 2> "$w/err"
equal 'no TIME card' 1 $?
equal 'no TIME card: codes' 'E098 E098 E098' "$(sed -n 's/^ [*]* *\(E[0-9][0-9][0-9]\) .*/\1/p' "$w/err" | tr '\n' ' ' | sed 's/ $//')"
conclude
