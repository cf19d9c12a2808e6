#!/bin/sh
# The answers of the cards EXTREMES and RANGE: extremes against closed forms in real128, which search by values alone;
# ranges against the law of cosines, to ten digits.
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

# four_bar CRANK COUPLER ROCKER BASE DRIVEN PHI-CRANK PHI-COUPLER PHI-ROCKER VALUE: a four-bar with RANGE
four_bar() {
   card UNITS M DEG S
   card GROUND BASE
   card LINK CRANK '' '' 0.0 0.0 "$6"
   card LINK COUPLER '' '' "$1" 0.0 "$7"
   card LINK ROCKER '' '' "$4" 0.0 "$8"
   card POINT A0 BASE; card POINT B0 BASE '' "$4"
   card POINT C1 CRANK; card POINT C2 CRANK '' "$1"
   card POINT D1 COUPLER; card POINT D2 COUPLER '' "$2"
   card POINT E1 ROCKER; card POINT E2 ROCKER '' "$3"
   card REVOLUTE A0 C1 P1; card REVOLUTE C2 D1 P2; card REVOLUTE D2 E2 P3; card REVOLUTE B0 E1 P4
   card DRIVE ANGLE "$5" '' "$9" 30.0
   card AT '' '' '' 0.0
   card METHOD "${method:-NEWTON}"
   card RANGE
   card END
}
# range NAME EXPECTED: the lines between the head of the ranges and the next blank line, for $w/deck
range() { equal "$1" "$2" "$("$kinmat" "$w/deck" 2>&1 | awk '/^ RANGES/ { on = 1; next } /^$/ { on = 0 } on')"; }
# angle A B C: between the sides A and B of a triangle, opposite C, in degrees
angle() { awk -v a="$1" -v b="$2" -v c="$3" 'BEGIN { x = (a*a + b*b - c*c)/(2*a*b)
   printf "%.12f", atan2(sqrt(1 - x*x), x)*45/atan2(1, 1) }'; }
# limit VALUE: ten digits
limit() { awk -v x="$1" 'BEGIN { printf "%.9E", x }'; }

for method in NEWTON DENSE; do
   # Grashof: 1 + 4 < 3.5 + 3, the shortest link turns fully.
   four_bar 1.0 3.5 3.0 4.0 CRANK 0.0 55.0 110.0 0.0 > "$w/deck"
   range "a crank, $method" " ANGLE CRANK
   ALL: NO LIMIT, AND THE MOTION CLOSES; TURNS 1"
   # Its rocker: between the two positions with crank and coupler in line.
   four_bar 1.0 3.5 3.0 4.0 ROCKER 85.0 35.0 120.0 120.0 > "$w/deck"
   range "a rocker, $method" " ANGLE ROCKER
   MIN  $(limit "$(awk -v a="$(angle 3 4 4.5)" 'BEGIN { printf "%.12f", 180 - a }')") DEG   LINKS CRANK, COUPLER AT THE LIMIT, IN LINE
   MAX  $(limit "$(awk -v a="$(angle 3 4 2.5)" 'BEGIN { printf "%.12f", 180 - a }')") DEG   LINKS CRANK, COUPLER AT THE LIMIT, IN LINE"
   # 1.5 + 4 > 2 + 3: no link turns fully; coupler and rocker in line, on either side of the base.
   four_bar 2.0 1.5 3.0 4.0 CRANK 57.0 20.0 105.0 57.0 > "$w/deck"
   range "a triple rocker, $method" " ANGLE CRANK
   MIN  $(limit "-$(angle 2 4 4.5)") DEG   LINKS COUPLER, ROCKER AT THE LIMIT, IN LINE
   MAX  $(limit "$(angle 2 4 4.5)") DEG   LINKS COUPLER, ROCKER AT THE LIMIT, IN LINE"
done

# Near Grashof's limit, 3 + 0.75 longer than 1.1 + 2.649997 by 3E-6: crank, coupler and rocker are almost in line at the ends.
four_bar 3.0 1.1 2.649997 0.75 CRANK 50.0 -35.8 38.6 50.0 > "$w/deck"
"$kinmat" "$w/deck" > "$w/out"
equal 'near the limit of Grashof' "-$(limit "$(angle 3 0.75 3.749997)") $(limit "$(angle 3 0.75 3.749997)")" \
   "$(awk '/^   (MIN|MAX) / { printf "%s%s", sep, $2; sep = " " }' "$w/out")"

# Closer than rounding can tell, 1E-10: the ends to 1E-6 degrees, with the reason, which a run to there gives as well.
method=NEWTON
four_bar 3.0 1.1 2.6499999999 0.75 CRANK 50.0 -35.8 38.6 50.0 > "$w/deck"
"$kinmat" "$w/deck" > "$w/out"
equal 'at the limit of Grashof' 'MIN 0 MAX 0' "$(awk -v a="$(angle 3 0.75 3.7499999999)" '/^   (MIN|MAX) / && /DEG   LIMIT OR CHANGE POINT, TOO CLOSE TO TELL$/ {
   d = ($2 < 0 ? -$2 : $2) - a; printf "%s%s %d", sep, $1, ((d < 0 ? -d : d) > 1e-6); sep = " " }' "$w/out")"
sed "s/^AT .*/$(card TIME 100 '' '' 0.0 5.0)/" "$w/deck" > "$w/run.deck"
equal 'at the limit of Grashof: a run' ' *** THE MOTION IS FOLLOWED TO T = 4.33329...E+00: LIMIT OR CHANGE POINT, TOO CLOSE TO TELL' \
   "$("$kinmat" "$w/run.deck" | sed -n 's/^\( .*T = 4.33329\)[0-9]*\(.* TOO CLOSE .*\)/\1...\2/p')"

# A parallelogram passes its two change points a turn on the smooth branch.
with parallelogram_at "$(card RANGE)" > "$w/deck"
range 'a parallelogram' ' ANGLE CRANK
   ALL: NO LIMIT, AND THE MOTION CLOSES; TURNS 1
   CHANGE POINTS PASSED 2'
# Each of the two cranks of a five-bar alone.
with five_bar "$(card RANGE)" > "$w/deck"
range 'a five-bar' ' ANGLE LEFT
   ALL: NO LIMIT, AND THE MOTION CLOSES; TURNS 1
 RELANGLE LEFT RIGHT
   ALL: NO LIMIT, AND THE MOTION CLOSES; TURNS 1'

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
