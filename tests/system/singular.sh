#!/bin/sh
# What a singular position is: a change point, where velocities exist and are not unique, a dead point, where none are
# finite, or what cannot be told. By every method, whatever the unit of length; and of independent mechanisms each.
. tests/counting.sh

# link, point, joint, slide: cards of one mechanism, whose names end in $mark
link() { card LINK "$1$mark" '' '' "$2" "$3" "$4"; }
point() { card POINT "$1$mark" "$2" '' "${3:-0.0}" "${4:-0.0}"; }
joint() { card REVOLUTE "$1$mark" "$2$mark" "$3$mark"; }
slide() { card DRIVE X "$1$mark" '' "$2" "$3"; }
angle() { card DRIVE ANGLE "$1$mark" '' "$2" "$3" "$4"; }

# four_bar CRANK COUPLER ROCKER BASE PHI-CRANK PHI-COUPLER PHI-ROCKER, in degrees
four_bar() {
   link CR 0.0 0.0 "$5"; link CO 0.0 0.0 "$6"; link RO "$4" 0.0 "$7"
   point A0 BASE; point B0 BASE "$4"; point A1 "CR$mark"; point A2 "CR$mark" "$1"
   point C1 "CO$mark"; point C2 "CO$mark" "$2"; point R1 "RO$mark"; point R2 "RO$mark" "$3"
   joint A0 A1 PA0; joint A2 C1 PA; joint C2 R2 PB; joint R1 B0 PB0
}
# slider PHI-CRANK PHI-ROD X CRANK: crank 1 unless given, rod 3 and a piston on the line y = 0
slider() {
   link CR 0.0 0.0 "$1"; link RD 0.0 0.0 "$2"; link PI "$3" 0.0 0.0
   point O BASE; point O1 "CR$mark"; point A1 "CR$mark" "${4:-1.0}"; point A2 "RD$mark"; point B2 "RD$mark" 3.0; point B "PI$mark"
   joint O O1 PO; joint A1 A2 PA; joint B2 B PB
   card PRISM "O$mark" "B$mark" "GU$mark" 0.0 0.0 0.0
}

# Mechanisms that stand at a singular position at T = 0 and leave it, or come to it at T = 1.
parallelogram() { four_bar 2.0 4.0 2.0 4.0 0.0 0.0 0.0; angle CR 0.0 40.0; }
parallelogram_later() { four_bar 2.0 4.0 2.0 4.0 150.0 0.0 150.0; angle CR 150.0 30.0; }
kite_later() { four_bar 2.0 3.0 3.0 2.0 -30.0 30.0 110.0; angle CR -30.0 30.0; }
# A chain of the full length 1 + 3 + 2 = 6 on a base of 6 has that position alone: its crank can turn neither way.
stretched() { four_bar 1.0 3.0 2.0 6.0 0.0 0.0 180.0; angle CR 0.0 30.0; }
far_end() { slider 0.0 0.0 4.0; slide B 4.0 -0.25; }
near_end() { slider 180.0 0.0 2.0; slide B 2.0 0.25; }
far_end_later() { slider 40.0 -10.0 3.5; slide B 3.5 0.5; }
# Crank and coupler in line, 1.5 + 3.5 = 5, over the base of 4: the rocker of 3 stands across it.
rocker() { four_bar 1.5 3.5 3.0 4.0 36.869897645844 36.869897645844 90.0; angle RO 90.0 -10.0; }
rocker_later() { four_bar 1.5 3.5 3.0 4.0 60.0 30.0 80.0; angle RO 80.0 10.0; }
# At its limit the drive turns round: the crank goes on or back, at two finite velocities of opposite signs.
rocker_turns() { four_bar 1.5 3.5 3.0 4.0 36.869897645844 36.869897645844 90.0; angle RO 90.0 0.0 20.0; }
# It turns at T = 1, at 100 - 20 t + 10 t**2 deg; or it accelerates beyond its limit: that position is alone.
rocker_turns_later() { four_bar 1.5 3.5 3.0 4.0 60.0 20.0 100.0; angle RO 100.0 -20.0 20.0; }
parallelogram_turns() { four_bar 2.0 4.0 2.0 4.0 60.0 0.0 60.0; angle CR 60.0 -120.0 120.0; }
rocker_turns_out() { four_bar 1.5 3.5 3.0 4.0 36.869897645844 36.869897645844 90.0; angle RO 90.0 0.0 -20.0; }
far_end_turns() { slider 0.0 0.0 4.0; card DRIVE X "B$mark" '' 4.0 0.0 -0.5; }
# The angle that a parallelogram keeps, driven at a speed, and at rest.
idle() { four_bar 2.0 4.0 2.0 4.0 40.0 0.0 40.0; angle CO 0.0 30.0; }
idle_at_rest() { four_bar 2.0 4.0 2.0 4.0 40.0 0.0 40.0; angle CO 0.0 0.0; }

# deck METHOD LANGUAGE NAME...: one set with these mechanisms
deck() {
   method=$1; language=$2; shift 2
   card TITLE SINGULAR; card UNITS M DEG S; card LANG "$language"; card GROUND BASE '' '' 0.0 0.0 0.0
   mark=
   for name; do mark=$mark+; "$name"; done
   card METHOD "$method"; card TIME 1 '' '' 0.0 1.0; card END
}
# Two dyads on one crank: a parallelogram at its change point, and one that is stretched across the crank.
two_dyads() {
   parallelogram
   link C3 0.0 0.0 90.0; link R3 2.0 5.0 270.0; point G3 BASE 2.0 5.0; point C31 "C3$mark"; point C32 "C3$mark" 2.0
   point R31 "R3$mark"; point R32 "R3$mark" 3.0; joint A2 C31 P3; joint C32 R32 P4; joint R31 G3 P5
}

# of_instant K LISTING [SETS]: which sentences on singular positions stand under instant K; SETS: a line for each set before them
of_instant() {
   awk -v k="$1" -v sets="$3" '/^ (INSTANT|CHWILA) / { at = $2 }
      /^ SET OF COMPUTATIONS/ && sets { print "SET" } /^ [*][*][*] (JACOBIAN|CHANGE POINT[,:]|DEAD|JAKOBIAN|PUNKT [A-Z]*[,:])/ && at == k { print substr($0, 6) }' "$2"
}

change=': VELOCITIES NOT UNIQUE'
dead=': NO FINITE VELOCITIES'
unclear=': NO UNIQUE VELOCITIES'

# sentences K WORDS NAME...: by these METHODS, in m, mm and km, a set each of one run
sentences() {
   k=$1; words=$2; shift 2
   deck NEWTON EN "$@" > "$w/one.deck"
   for method in $METHODS; do
      for power in 0 -3 3; do
         sed "s/^\(METHOD  \).*/\1$method/" "$w/one.deck" | awk -v long=$power -f tests/system/other_units.awk
      done
   done > "$w/deck"
   "$kinmat" "$w/deck" > "$w/out" 2> "$w/err"
   equal "$*: standard error" '' "$(cat "$w/err")"
   equal "$*, METHOD $METHODS, each in m, mm and km" "$(for method in $METHODS; do for unit in m mm km; do echo "SET"; echo "$words"; done; done)" \
      "$(of_instant "$k" "$w/out" 1)"
}

METHODS='NEWTON DENSE MATRIX'
sentences 0 "CHANGE POINT, LINKS CO+, RO+ COLLINEAR$change" parallelogram
sentences 1 "CHANGE POINT, LINKS CO+, RO+ COLLINEAR$change" parallelogram_later
sentences 0 "DEAD POINT, LINKS CR+, RD+ COLLINEAR$dead" far_end
sentences 0 "DEAD POINT, LINKS CR+, RD+ COLLINEAR$dead" near_end
sentences 0 "JACOBIAN SINGULAR, LINKS CR+, RO+$unclear" idle_at_rest
METHODS='NEWTON DENSE'
sentences 0 "DEAD POINT, LINKS CR+, CO+ COLLINEAR$dead" rocker
sentences 0 "CHANGE POINT, LINKS CR+, CO+ COLLINEAR$change" rocker_turns
sentences 1 "CHANGE POINT, LINKS CR+, CO+ COLLINEAR$change" rocker_turns_later
sentences 0 "CHANGE POINT, LINKS CR+, RD+ COLLINEAR$change" far_end_turns
sentences 1 "CHANGE POINT, LINKS CO+, RO+ COLLINEAR$change" parallelogram_turns
sentences 0 "JACOBIAN SINGULAR, LINKS CR+, CO+ COLLINEAR$unclear" rocker_turns_out
sentences 1 "CHANGE POINT, LINKS CO+, RO+ COLLINEAR$change" kite_later
sentences 1 "DEAD POINT, LINKS CR+, RD+ COLLINEAR$dead" far_end_later
sentences 1 "DEAD POINT, LINKS CR+, CO+ COLLINEAR$dead" rocker_later
sentences 0 "JACOBIAN SINGULAR, LINKS CR+, RO+$unclear" idle
sentences 0 "JACOBIAN SINGULAR, LINKS CO+, RO+ COLLINEAR$unclear" stretched
sentences 0 "DEAD POINT, LINKS C3+, R3+ COLLINEAR$dead" two_dyads
sentences 0 "CHANGE POINT, LINKS CO+, RO+ COLLINEAR$change
DEAD POINT, LINKS CR++, RD++ COLLINEAR$dead" parallelogram far_end
sentences 0 "DEAD POINT, LINKS CR+, CO+ COLLINEAR$dead
CHANGE POINT, LINKS CO++, RO++ COLLINEAR$change" rocker parallelogram
sentences 0 "JACOBIAN SINGULAR, LINKS CR+, CO+ COLLINEAR$unclear
CHANGE POINT, LINKS CO++, RO++ COLLINEAR$change
CHANGE POINT, LINKS CO+++, RO+++ COLLINEAR$change
DEAD POINT, LINKS CR++++, RD++++ COLLINEAR$dead" rocker_turns_out parallelogram parallelogram far_end
deck NEWTON PL rocker_turns_out parallelogram far_end > "$w/deck"
"$kinmat" "$w/deck" > "$w/out" 2> "$w/err"
equal 'in Polish' 'JAKOBIAN OSOBLIWY, OGNIWA CR+, CO+ WSPOLLINIOWE: BRAK JEDNOZNACZNYCH PREDKOSCI
PUNKT ZMIANY, OGNIWA CO++, RO++ WSPOLLINIOWE: PREDKOSCI NIEJEDNOZNACZNE
PUNKT MARTWY, OGNIWA CR+++, RD+++ WSPOLLINIOWE: BRAK SKONCZONYCH PREDKOSCI' "$(of_instant 0 "$w/out")"
# The equations determine a singular position to 1E-7 rad only; the digits of its angles are right all the same, from an
# estimate far away and at the end of a motion. A rocker across the base is reached by the crank that is in line.
far_end_guessed() { slider 20.0 -10.0 3.5; slide B 4.0 -0.25; }
far_end_reached() { slider 40.0 -10.0 3.5; slide B 3.7 0.3; }
far_end_of_a_short_crank() { slider 20.0 -10.0 3.0 0.001; slide B 3.001 -0.0001; }
parallelogram_guessed() { four_bar 2.0 4.0 2.0 4.0 180.0 15.0 210.0; angle CR 180.0 40.0; }
# And after a hundred turns, whose rounding leaves the equations open by more than theirs.
rocker_after_turns() { four_bar 1.5 3.5 3.0 4.0 60.0 20.0 36450.0; angle RO 36450.0 -10.0; }
parallelogram_begun() { four_bar 2.0 4.0 2.0 4.0 10.0 0.0 10.0; angle CR 10.0 10.0; }
rocker_guessed() { four_bar 1.5 3.5 3.0 4.0 60.0 20.0 90.0; angle RO 90.0 -10.0; }
# angles K WORDS NAME: the angles of its three links at instant K, in degrees
angles() {
   deck NEWTON EN "$3" > "$w/deck"
   "$kinmat" "$w/deck" > "$w/out" 2> "$w/err"
   equal "$3: angles" "$2" \
      "$(awk -v k="$1" '/^ INSTANT/ { at = $2 } /^ CONTINUATION/ { exit } at "" == k && NF == 10 && $4 ~ /[0-9]/ { printf "%s ", $4 }' "$w/out")"
}
angles 0 '0.000000 0.000000 0.000000 ' far_end_guessed
angles 1 '0.000000 0.000000 0.000000 ' far_end_reached
angles 0 '0.000000 0.000000 0.000000 ' far_end_of_a_short_crank
angles 0 '180.000000 0.000000 180.000000 ' parallelogram_guessed
angles 0 '36.869898 36.869898 90.000000 ' rocker_guessed
angles 0 '36.869898 36.869898 36450.00000 ' rocker_after_turns
# A link that is driven has the rate and acceleration of its drive there: 0 and what turns it, in deg/s and deg/s**2.
# driven K WORDS NAME LINK
driven() {
   for method in NEWTON DENSE; do
      deck "$method" EN "$3" > "$w/deck"
      equal "$3, METHOD $method: rate and acceleration of $4" "$2" "$("$kinmat" "$w/deck" 2> "$w/err" |
         awk -v k="$1" -v link="$4+" '/^ INSTANT/ { at = $2 } at "" == k && $1 == link { printf "%.9g %.9g", $7, $10; exit }')"
   done
}
driven 1 '0 20' rocker_turns_later RO
driven 1 '0 120' parallelogram_turns CR
# The position at the start does not say how the motion goes on: the estimate does, and the listing says so, once.
begins=' --- THE MOTION BEGINS HERE, IN THE ASSEMBLY NEAREST TO THE INITIAL GUESS'
angles 1 '220.000000 0.000000 220.000000 ' parallelogram_guessed
equal 'begins beside a change point' "$begins" "$(awk '/^ INSTANT 1/ { at = 1 } at && /---/' "$w/out")"
angles 0 '10.000000 0.000000 10.000000 ' parallelogram_begun
equal 'begins at once' '' "$(grep -e "$begins" "$w/out")"
conclude
