#!/bin/sh
# What drives do between two instants: decks in few steps, compared at their instants with the same deck in fifty times
# as many. A law that goes out and comes back within a step must be followed out and back.
. tests/counting.sh

# four_bar FOUR-BAR...: as still_four_bar, in radians, without drive and instant; one that rocks, one that turns
four_bar() { still_four_bar "$@" | sed -e 's/DEG/RAD/' -e '/^\(DRIVE\|AT\|END\)/d'; }
rocking='2.0 1.5 1.5 4.0 CRANK 0.7 -0.1 2.28 0.7'
turning='1.0 3.5 3.0 4.0 CRANK 0.5 0.78 1.78 0.5'
# angle VALUE: the drive of the crank, to be followed by what is added
angle() { printf 'DRIVE   ANGLE   CRANK\n*       %s\n' "$1"; }
# cam RISE: in each unit of time from 0 to 4 a rise and a return, between a fifth and four fifths of it
cam() {
   LC_ALL=C awk -v rise="$1" 'BEGIN { pi = atan2(0, -1)
      for (k = 0; k <= 160; k++) { u = k % 40/40; v = u > 0.2 && u < 0.8 ? rise*(0.5 - 0.5*cos(2*pi*(u - 0.2)/0.6)) : 0
         printf "ADD     TABLE\n*       %-24.16E%.16E\n", k/40, v } }'
}
# added FORM R1 R2 R3
added() { LC_ALL=C printf 'ADD     %s\n*       %-24s%-24s%s\n' "$1" "$2" "$3" "$4"; }
# rises LAW LIFT: in each unit of time from 0 to 4 a rise and a return, from a fifth on and up to four fifths
rises() {
   LC_ALL=C awk -v law="$1" -v lift="$2" 'BEGIN { for (k = 0; k < 4; k++)
      printf "RISE    %s\n*       %-24s0.3                     %.2f\nRISE    %s\n*       %-24s0.3                     %.2f\n", \
         law, k + 0.2, lift, law, k + 0.5, -lift }'
}
# time_card STEPS FROM TO
time_card() { LC_ALL=C printf 'TIME    %s\n*       %-24s%s\nEND\n' "$1" "$2" "$3"; }

# compare NAME FROM TO STEPS FLAGGED: the deck NAME.part in STEPS steps and in fifty times as many; so many instants of
# the first are without a position, and wherever both have one it is the same
compare() {
   { cat "$w/$1.part"; time_card "$4" "$2" "$3"; } > "$w/$1.deck"
   { cat "$w/$1.part"; time_card $(($4*50)) "$2" "$3"; } > "$w/$1.fine.deck"
   for deck in "$1" "$1.fine"; do
      "$kinmat" "$w/$deck.deck" -o "$w/$deck.lst" --csv "$w/$deck.csv" 2> "$w/$deck.err"
      echo $? >> "$w/$deck.err"
   done
   equal "$1: flagged" "$5" "$(sed -n 's/^ END OF SET.*FLAGGED //p' "$w/$1.lst")"
   equal "$1: other than in small steps" '' "$(LC_ALL=C awk -F, 'FNR == NR { if (FNR > 1) fine[$2 "," $5] = $0; next }
      FNR > 1 { split(fine[$2*50 "," $5], other, ",")
         if (($6 == "") != (other[6] == "")) { print; next }
         for (i = 6; i <= 8; i++) if ($i != "" && ($i - other[i])^2 > 1e-14*(1 + $i^2)) { print; next } }' \
      "$w/$1.fine.csv" "$w/$1.csv" | head -n 4)"
}

# A four-bar whose crank, from 0.7, can rise to 0.8127: cams below and beyond that, by one step a cam.
{ four_bar $rocking; angle 0.7; cam 0.10; } > "$w/cam_below.part"
compare cam_below 0.0 4.0 4 0
{ four_bar $rocking; angle 0.7; cam 0.14; } > "$w/cam_beyond.part"
compare cam_beyond 0.0 4.0 4 4
equal 'cam_beyond: its limit' 'T = 0.412746 S' "$(sed -n 's/.*LIMIT OF MOTION AT //p' "$w/cam_beyond.lst" | sort -u)"
# The same of rises by each law.
for law in CYCLOID 3-4-5 HARMONIC PARABOLA; do
   { four_bar $rocking; angle 0.7; rises $law 0.10; } > "$w/$law.below.part"
   compare $law.below 0.0 4.0 4 0
   { four_bar $rocking; angle 0.7; rises $law 0.14; } > "$w/$law.beyond.part"
   compare $law.beyond 0.0 4.0 4 4
   { four_bar $turning; angle 0.5; rises $law 30.0; } > "$w/$law.turning.part"
   compare $law.turning 0.0 4.0 4 0
done
# A harmonic of exactly one period a step, on the same four-bar and on one whose crank turns fully.
{ four_bar $rocking; angle 0.7; added HARMONIC -0.10 6.2831853071795862 0.0; } > "$w/period_below.part"
compare period_below 0.0 4.0 4 0
{ four_bar $rocking; angle 0.7; added HARMONIC 0.14 6.2831853071795862 0.0; } > "$w/period_beyond.part"
compare period_beyond 0.0 4.0 4 4
{ four_bar $turning; angle 0.5; added HARMONIC 30.0 6.2831853071795862 0.0; } > "$w/period_turning.part"
compare period_turning 0.0 4.0 4 0
# 0.001/t^2 turns the crank by a thousand radians at first, and then hardly any more.
{ four_bar 1.0 3.5 3.0 4.0 CRANK 1000.5 0.56 1.89 1000.5; angle 0.5; added POWER 1.0E-3 -2.0; } > "$w/power.part"
compare power 0.001 10.001 10 0
# A root rises most steeply where it begins.
{ four_bar $turning; angle 0.5; added POWER 20.0 0.5; } > "$w/root.part"
compare root 0.000001 4.0 4 0

# Three cylinders go round a cusp between t = 0 and 1, each by little: the assembly at t = 1 is the other one. Later a
# limit is met.
sed '/^TIME/,$d' tests/system/decks/cusp.deck > "$w/cusp.part"
echo 'PRINT   LINKS   PLAT' >> "$w/cusp.part"
compare cusp 0.0 2.0 2 1
# A parallelogram on a link that turns, its crank driven against that link, each by a law that bends: straight on past its
# change point.
cat > "$w/on_a_turning_link.part" <<'DECK'
TITLE   PARALLELOGRAM ON A TURNING LINK
GROUND  BASE
LINK    ARM                     0.0             0.0             0.3
LINK    CRANK                   0.955           0.296           -0.4
LINK    COUPLER                 1.876           -0.094          0.3
LINK    ROCKER                  2.866           0.887           -0.4
POINT   O       BASE
POINT   O-ARM   ARM
POINT   A0      ARM             1.0
POINT   B0      ARM             3.0
POINT   A0-CR   CRANK
POINT   A-CR    CRANK           1.0
POINT   A-CO    COUPLER
POINT   B-CO    COUPLER         2.0
POINT   B0-RO   ROCKER
POINT   B-RO    ROCKER          1.0
REVOLUTEO       O-ARM   PAIR-O
REVOLUTEA0      A0-CR   PAIR-A0
REVOLUTEA-CR    A-CO    PAIR-A
REVOLUTEB-CO    B-RO    PAIR-B
REVOLUTEB0      B0-RO   PAIR-B0
DRIVE   ANGLE   ARM             0.3             0.2             0.8
DRIVE   RELANGLEARM     CRANK   -0.7            1.0             -0.6
PRINT   LINKS
DECK
compare on_a_turning_link 0.0 1.25 4 0
equal 'on_a_turning_link: its change point' 1 "$(grep -c 'CHANGE POINT AT .*, LINKS COUPLER, ROCKER: PASSED ON THE SMOOTH' "$w/on_a_turning_link.lst")"
equal 'on_a_turning_link: coupler parallel to its base' '' "$(LC_ALL=C awk -F, '$5 == "ARM" { phi = $8 }
   $5 == "COUPLER" && ($8 == "" || ($8 - phi)^2 > 1e-24)' "$w/on_a_turning_link.csv")"
# A parallelogram on moving links takes its other branch, on which a dyad on its coupler goes many times as far as that.
"$kinmat" tests/system/decks/branch_below_dyad.deck > "$w/branch_below_dyad.lst"
equal 'branch_below_dyad: its other branch' 1 "$(grep -c 'CHANGE POINT AT .*, LINKS L22, L21: PASSED TO THE OTHER' "$w/branch_below_dyad.lst")"
equal 'branch_below_dyad: flagged' 0 "$(sed -n 's/^ END OF SET.*FLAGGED //p' "$w/branch_below_dyad.lst")"
equal 'cusp: the other assembly' 1 "$(grep -c '^ PLAT *8\.85715 *-8\.19202 ' "$w/cusp.lst")"

# A drive that turns just beyond a limit and comes back before the next instant: the triple rocker 2, 1.5, 3, 4 ends where
# cos = (2^2 + 4^2 - 4.5^2)/16, at 90.89528299 deg, and the drive goes up to 90.9: sin(pi t) = 33.89528299/33.9 there.
{ still_four_bar 2.0 1.5 3.0 4.0 CRANK 57.0 20.0 105.0 57.0 | grep -vE '^(AT|DRIVE|END)'
  card DRIVE ANGLE CRANK '' 57.0; card ADD HARMONIC '' '' 33.9 180.0; card TIME 1 '' '' 0.0 0.955; card END; } > "$w/deck"
equal 'beyond a limit and back between two instants' \
   ' *** NO POSITION: BEYOND THE LIMIT OF MOTION AT T = 0.4946899 S
 *** DRIVE ANGLE CRANK = 90.89528299 DEG' \
   "$("$kinmat" "$w/deck" 2>&1 | sed -n '/LIMIT OF/p; s/^\( [*]* DRIVE .*\), LINKS .*/\1/p')"
# A piston comes to its dead point, at crank + rod, at t = 45 and turns back there: x = 4 - (t - 45)^2/4096. The crank turns
# on through it, by the law of cosines, whatever the steps.
new_line='
'
for steps in 4 7 18 45; do
   { inline_slider 52.0 0.61 0.79 -15.0 3.5; card DRIVE X B '' 3.505615234375 0.02197265625 -0.00048828125
     card PRINT LINKS CRANK
     time_card $steps 0.0 90.0; } > "$w/deck"
   "$kinmat" "$w/deck" --csv "$w/csv" > "$w/lst" 2> "$w/err"
   # An instant on it stands there, and the next one tells the way on.
   at=$([ $((steps % 2)) -eq 1 ] || echo ' --- CHANGE POINT AT T = 45.00000 S, LINKS CRANK, ROD: THIS INSTANT IS AT THE CHANGE POINT')
   equal "piston on its dead point, $steps steps: time" \
      "$at${at:+$new_line} --- CHANGE POINT AT T = 45.00000 S, LINKS CRANK, ROD: PASSED ON THE SMOOTH BRANCH" "$(grep 'CHANGE POINT AT' "$w/lst")"
   equal "piston on its dead point, $steps steps: crank" "$((steps + 1))" "$(LC_ALL=C awk -F, '$5 == "CRANK" { x = 4 - ($3 - 45)^2/4096
      c = (x^2 - 8)/(2*x); phi = atan2(sqrt(c < 1 ? 1 - c^2 : 0), c)*45/atan2(1, 1); if ($3 > 45) phi = -phi
      n += ($8 - phi)^2 < 1e-12 } END { print n }' "$w/csv")"
done
conclude
