#!/bin/sh
# The answer of the card RANGE: against the law of cosines and paths in closed form, to ten digits.
. tests/counting.sh

# four_bar, as still_four_bar: with RANGE
four_bar() { still_four_bar "$@" "$(card METHOD "${method:-NEWTON}")" RANGE; }
# range NAME EXPECTED: the lines between the head of the ranges and the next blank line, for $w/deck; $w/run: its whole listing
range() { equal "$1" "$2" "$("$kinmat" "$w/deck" 2>&1 | tee "$w/run" | awk '/^ RANGES/ { on = 1; next } /^$/ { on = 0 } on')"; }

for method in NEWTON DENSE; do
   # Grashof: 1 + 4 < 3.5 + 3, the shortest link turns fully.
   four_bar 1.0 3.5 3.0 4.0 CRANK 0.0 55.0 110.0 0.0 > "$w/deck"
   range "a crank, $method" " ANGLE CRANK
   TURNS FULLY, CLOSES AFTER 1 TURN"
   # Its rocker: between the two positions with crank and coupler in line.
   four_bar 1.0 3.5 3.0 4.0 ROCKER 85.0 35.0 120.0 120.0 > "$w/deck"
   range "a rocker, $method" " ANGLE ROCKER
   MIN  $(limit "$(awk -v a="$(angle 3 4 4.5)" 'BEGIN { printf "%.12f", 180 - a }')") DEG   LINKS CRANK, COUPLER AT THE LIMIT, COLLINEAR
   MAX  $(limit "$(awk -v a="$(angle 3 4 2.5)" 'BEGIN { printf "%.12f", 180 - a }')") DEG   LINKS CRANK, COUPLER AT THE LIMIT, COLLINEAR"
   # 1.5 + 4 > 2 + 3: no link turns fully; coupler and rocker in line, on either side of the base.
   four_bar 2.0 1.5 3.0 4.0 CRANK 57.0 20.0 105.0 57.0 > "$w/deck"
   range "a triple rocker, $method" " ANGLE CRANK
   MIN  $(limit "-$(angle 2 4 4.5)") DEG   LINKS COUPLER, ROCKER AT THE LIMIT, COLLINEAR
   MAX  $(limit "$(angle 2 4 4.5)") DEG   LINKS COUPLER, ROCKER AT THE LIMIT, COLLINEAR"
done

# Near Grashof's limit, 3 + 0.75 longer than 1.1 + 2.649997 by 3E-6: crank, coupler and rocker are almost in line at the ends.
four_bar 3.0 1.1 2.649997 0.75 CRANK 50.0 -35.8 38.6 50.0 > "$w/deck"
"$kinmat" "$w/deck" > "$w/out"
equal 'near the limit of Grashof' "-$(limit "$(angle 3 0.75 3.749997)") $(limit "$(angle 3 0.75 3.749997)")" \
   "$(awk '/^   (MIN|MAX) / { printf "%s%s", sep, $2; sep = " " }' "$w/out")"

# Stephenson III: a dyad 2.6, 1.9 from the point (1.75, 1.25) of the coupler of 1, 3.5, 3 on 4 to (5, 1): it is in line where that point's path is
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
   BEGIN { printf "%#.10g %#.10g", limit(-1), limit(1) }')
range 'Stephenson III' " ANGLE CRANK
   MIN  ${ends% *} DEG   LINKS COUPLER2, ROCKER2 AT THE LIMIT, COLLINEAR
   MAX  ${ends#* } DEG   LINKS COUPLER2, ROCKER2 AT THE LIMIT, COLLINEAR"

# Dixon's nine bars: x(i)**2 of the points A and y(j)**2 of the points B, on two lines at right angles, grow by what the others
# lose. The angle at A1 of B1 and B2 is least where B3 is on the line of the A, and the three bars to it in line.
with dixon "$(card RANGE)" > "$w/deck"
equal 'Dixon' "$(awk 'BEGIN { a = (atan2(sqrt(64^2 - 29^2), 29) + atan2(sqrt(41^2 - 29^2), 29))*45/atan2(1, 1)
   printf "%#.10g %#.10g", a - 360, -a }')" "$("$kinmat" "$w/deck" | awk '/^   (MIN|MAX) / { printf "%s%s", sep, $2; sep = " " }')"

# A parallelogram passes its two change points a turn on the smooth branch.
for method in NEWTON DENSE; do
   with parallelogram_at "$(card RANGE)" "$(card METHOD $method)" > "$w/deck"
   range "a parallelogram, $method" ' ANGLE CRANK
   TURNS FULLY, CLOSES AFTER 1 TURN
   CHANGE POINTS ON THE WAY 2'
done
# So it does from one of them, where its velocities are not unique: the motion on either branch closes after a turn.
for method in NEWTON DENSE; do
   four_bar 2.0 4.0 2.0 4.0 CRANK 180.0 0.0 180.0 180.0 > "$w/deck"
   range "a parallelogram at its change point, $method" ' ANGLE CRANK
   TURNS FULLY, CLOSES AFTER 1 TURN
   CHANGE POINTS ON THE WAY 2'
done
# The line at the end of a set counts on the steps to instants that were found, RANGE on its way: a landing gear passes a change
# point before its limit, with no instant between.
{ card UNITS MM DEG S; card GROUND WING; for link in LEG BRACE1 BRACE2 CYL ROD; do card LINK $link; done
  card JOINT O WING LEG 0.0 0.0; card JOINT B LEG BRACE1 0.0 -700.0; card JOINT K BRACE1 BRACE2 330.0 -330.0
  card JOINT C WING BRACE2 700.0 0.0; card JOINT D WING CYL 450.0 60.0; card JOINT E LEG ROD 0.0 -250.0
  card POINT DC CYL '' 450.0 60.0; card POINT ER ROD '' 0.0 -250.0; card PRISM DC ER PISTON -145.437612 0.0 0.0
  card DRIVE SLIDE PISTON '' 546.44304369 -50.0; card TIME 8 '' '' 0.0 8.0; card RANGE; card END; } > "$w/deck"
equal 'a landing gear' '   CHANGE POINTS ON THE WAY 1
 CONTINUATION:  STEPS CERTIFIED 6 OF 6, CHANGE POINTS PASSED 1' "$("$kinmat" "$w/deck" | grep 'CHANGE POINTS')"
sed "s/^RANGE/&\n$(card LANG PL)/" "$w/deck" > "$w/polish"
equal 'a landing gear, in Polish' '   PUNKTY ZMIANY NA DRODZE 1' "$("$kinmat" "$w/polish" | grep 'NA DRODZE')"

# A slide goes to infinity where a slot is parallel to a guide at the angle ALPHA: from ALPHA - 180 to ALPHA exactly, whether an
# instant of the way along the drive, every 5 degrees, is there, just before or just behind; a run that lands there has its limit.
for alpha in 90 90.00001 89.99999 90.001 89.999 90.1 87.3; do
   case $alpha in *.*) guide=$alpha ;; *) guide=$alpha.0 ;; esac
   tangent 0.3 0.0 $guide "$(card TIME 12 '' '' 0.0 12.0)" RANGE > "$w/deck"
   range "a slide to infinity, $alpha" " ANGLE CRANK
   MIN  $(limit "$(awk "BEGIN { printf \"%.12f\", $alpha - 180 }")") DEG   LINK SLIDER AT THE LIMIT
   MAX  $(limit $alpha) DEG   LINK SLIDER AT THE LIMIT"
   equal "a run to infinity, $alpha" "$(limit "$alpha")" "$(sed -n 's/^ [*]* DRIVE ANGLE CRANK = \(.*\) DEG, .*AT THE LIMIT.*/\1/p' "$w/run")"
done

# Two dyads 3, 3.2 on one slide, mirrored but for a little of a height: the dyad of the greater height h is in line first, at
# 5 -+ sqrt(6.2**2 - (h - 2)**2). The loops make the second dyad build on the first, whichever comes to its limit earlier.
dyad() { card LINK "ROD$1" '' '' 3.0 "$2" "$4"; card LINK "JAW$1" '' '' 5.0 "$3" "$5"
   card POINT "P$1" SL '' 0.0 "$2"; card POINT "A$1" "ROD$1"; card POINT "B$1" "ROD$1" '' 3.0
   card POINT "G$1" BASE '' 5.0 "$3"; card POINT "C$1" "JAW$1"; card POINT "D$1" "JAW$1" '' 3.2
   card REVOLUTE "P$1" "A$1" "PA$1"; card REVOLUTE "B$1" "D$1" "BD$1"; card REVOLUTE "G$1" "C$1" "GC$1"; }
for height in 4.000000002 4.0000002 4.00002 4.002 3.999999998 3.9999998 3.99998 3.998; do
   { card UNITS M DEG S; card GROUND BASE; card LINK SL '' '' 3.0
     dyad 0 2.0 4.0 111.5 165.7; dyad 1 -2.0 "-$height" -111.5 -165.7
     card POINT O BASE; card POINT S SL; card PRISM O S GUIDE 0.0; card DRIVE SLIDE GUIDE '' 3.0 1.0; card AT '' '' '' 0.0; card RANGE
     card END; } > "$w/deck"
   first=$(awk -v h="$height" 'BEGIN { k = h > 4; o = sqrt(6.2^2 - ((k ? h : 4) - 2)^2); printf "%d %.12f %.12f", k, 5 - o, 5 + o }')
   set -- $first
   range "two dyads that are in line almost together, $height" " SLIDE GUIDE
   MIN  $(limit "$2") M   LINKS ROD$1, JAW$1 AT THE LIMIT, COLLINEAR
   MAX  $(limit "$3") M   LINKS ROD$1, JAW$1 AT THE LIMIT, COLLINEAR"
done

# Each of the two cranks of a five-bar alone.
for method in NEWTON DENSE; do
   with five_bar "$(card RANGE)" "$(card METHOD $method)" > "$w/deck"
   range "a five-bar, $method" ' ANGLE LEFT
   TURNS FULLY, CLOSES AFTER 1 TURN
 RELANGLE LEFT RIGHT
   TURNS FULLY, CLOSES AFTER 1 TURN'
done
conclude
