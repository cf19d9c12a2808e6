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

# four_bar, as still_four_bar: with RANGE
four_bar() { still_four_bar "$@" "$(card METHOD "${method:-NEWTON}")" RANGE; }
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

# Watt II: a crank-rocker 1, 3.5, 3 on 4, whose rocker is the crank of a second four-bar with 1.9 and 2.3 on a base of 2: that
# one ends where these are in line, 4.2 from the end of the first rocker to the last pivot. That rocker's angle follows by the
# law of cosines, and both angles of the crank by the triangle of crank and coupler.
{
   four_bar 1.0 3.5 3.0 4.0 CRANK 60.0 36.0 103.0 60.0 | grep -v '^\(AT\|RANGE\|END\|DRIVE\)'
   card LINK COUPLER2 '' '' 3.3 2.9 -26.0; card LINK ROCKER2 '' '' 6.0 0.0 115.0
   card POINT G0 BASE '' 6.0
   card POINT F1 COUPLER2; card POINT F2 COUPLER2 '' 1.9; card POINT G1 ROCKER2; card POINT G2 ROCKER2 '' 2.3
   card REVOLUTE E2 F1 P5; card REVOLUTE F2 G2 P6; card REVOLUTE G0 G1 P7
   card DRIVE ANGLE CRANK '' 60.0 30.0; card AT '' '' '' 0.0; card RANGE; card END
} > "$w/deck"
ends=$(awk 'function arccos(x) { return atan2(sqrt(1 - x*x), x) }
   BEGIN { cosine = -(4.2^2 - 3^2 - 2^2)/(2*3*2); x = 4 + 3*cosine; y = 3*sqrt(1 - cosine^2); d = sqrt(x*x + y*y)
      middle = atan2(y, x); half = arccos((1 + d*d - 3.5^2)/(2*d)); degree = atan2(1, 1)/45
      printf "%.9E %.9E", (middle - half)/degree, (middle + half)/degree }')
range 'Watt II' " ANGLE CRANK
   MIN  ${ends% *} DEG   LINKS COUPLER2, ROCKER2 AT THE LIMIT, IN LINE
   MAX  ${ends#* } DEG   LINKS COUPLER2, ROCKER2 AT THE LIMIT, IN LINE"

# Stephenson III: a dyad 2.6, 1.9 from the point (1.75, 1.25) of that coupler to (5, 1): it is in line where that point's path is
# 4.5 from there, found by bisection on the path in closed form.
{
   four_bar 1.0 3.5 3.0 4.0 CRANK 60.0 36.0 103.0 60.0 | grep -v '^\(AT\|RANGE\|END\|DRIVE\)'
   card LINK COUPLER2 '' '' 1.2 2.9 -11.0; card LINK ROCKER2 '' '' 5.0 1.0 132.0
   card POINT G0 BASE '' 5.0 1.0; card POINT C COUPLER '' 1.75 1.25
   card POINT F1 COUPLER2; card POINT F2 COUPLER2 '' 2.6; card POINT G1 ROCKER2; card POINT G2 ROCKER2 '' 1.9
   card REVOLUTE C F1 P5; card REVOLUTE F2 G2 P6; card REVOLUTE G0 G1 P7
   card DRIVE ANGLE CRANK '' 60.0 30.0; card AT '' '' '' 0.0; card RANGE; card END
} > "$w/deck"
ends=$(awk 'function arccos(x) { return atan2(sqrt(1 - x*x), x) }
   function apart(phi,  x, y, d, turn) {
      x = 4 - cos(phi); y = -sin(phi); d = sqrt(x*x + y*y); turn = atan2(y, x) + arccos((3.5^2 + d*d - 3^2)/(2*3.5*d))
      x = cos(phi) + 1.75*cos(turn) - 1.25*sin(turn) - 5; y = sin(phi) + 1.75*sin(turn) + 1.25*cos(turn) - 1
      return sqrt(x*x + y*y) - 4.5
   }
   function limit(way,  a, b, c) {
      degree = atan2(1, 1)/45
      for (b = 60*degree; apart(b) < 0; b += way*degree) a = b
      while ((c = (a + b)/2) != a && c != b) if (apart(c) < 0) a = c; else b = c
      return a/degree
   }
   BEGIN { printf "%.9E %.9E", limit(-1), limit(1) }')
range 'Stephenson III' " ANGLE CRANK
   MIN  ${ends% *} DEG   LINKS COUPLER2, ROCKER2 AT THE LIMIT, IN LINE
   MAX  ${ends#* } DEG   LINKS COUPLER2, ROCKER2 AT THE LIMIT, IN LINE"

# Dixon's nine bars: x(i)**2 of the points A and y(j)**2 of the points B, on two lines at right angles, grow by what the others
# lose. The angle at A1 of B1 and B2 is least where B3 is on the line of the A, and the three bars to it in line.
with dixon "$(card RANGE)" > "$w/deck"
equal 'Dixon' "$(awk 'BEGIN { a = (atan2(sqrt(64^2 - 29^2), 29) + atan2(sqrt(41^2 - 29^2), 29))*45/atan2(1, 1)
   printf "%.9E %.9E", a - 360, -a }')" "$("$kinmat" "$w/deck" | awk '/^   (MIN|MAX) / { printf "%s%s", sep, $2; sep = " " }')"

# A parallelogram passes its two change points a turn on the smooth branch.
for method in NEWTON DENSE; do
   with parallelogram_at "$(card RANGE)" "$(card METHOD $method)" > "$w/deck"
   range "a parallelogram, $method" ' ANGLE CRANK
   ALL: NO LIMIT, AND THE MOTION CLOSES; TURNS 1
   CHANGE POINTS PASSED 2'
done
# Each of the two cranks of a five-bar alone.
for method in NEWTON DENSE; do
   with five_bar "$(card RANGE)" "$(card METHOD $method)" > "$w/deck"
   range "a five-bar, $method" ' ANGLE LEFT
   ALL: NO LIMIT, AND THE MOTION CLOSES; TURNS 1
 RELANGLE LEFT RIGHT
   ALL: NO LIMIT, AND THE MOTION CLOSES; TURNS 1'
done

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
