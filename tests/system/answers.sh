#!/bin/sh
# The answer of the card EXTREMES: against closed forms in real128, which search by values alone; a range whose ends rounding leaves open;
# what is refused.
. tests/counting.sh

# extremes FILE: the tables of extremes
extremes() { awk '/^ (EXTREMES|EKSTREMA)  / { on = 1 } /^ (CONTINUATION|KONTYNUACJA):/ { on = 0 } on' "$1"; }

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

# The transmission angle of a drawing by two lines, as in its how-to: the law of cosines
# with coupler 3, rocker 2.5, crank 1 and a base of the root of 11.25.
near=$(awk 'BEGIN { printf "%.15f", sqrt(11.25) - 1 }')
far=$(awk 'BEGIN { printf "%.15f", sqrt(11.25) + 1 }')
awk '/^```deck/ { on = 1; next } /^```/ && on { exit } on' docs/howto/transmission_angle.md > "$w/deck"
"$kinmat" "$w/deck" > "$w/listing" 2>&1
equal 'the transmission angle of a drawing' "MIN $(printf %.6f "$(angle 3 2.5 "$near")") MAX $(printf %.6f "$(angle 3 2.5 "$far")")" \
   "$(extremes "$w/listing" | awk '/^  (MIN|MAX) / { printf "%s%s %s", mark, $1, $2; mark = " " }')"
sed 's/^EXTREMES.*/EXTREMESPAIRS   B/' "$w/deck" > "$w/plain.deck"
"$kinmat" "$w/plain.deck" > "$w/listing" 2>&1
equal 'the angle of the pair begins at 0' "$(awk -v a="$(angle 3 2.5 "$near")" -v b="$(angle 3 2.5 "$far")" 'BEGIN { printf "MIN %.6f MAX %.6f", a - 90, b - 90 }')" \
   "$(extremes "$w/listing" | awk '/^  (MIN|MAX) / { printf "%s%s %s", mark, $1, $2; mark = " " }')"

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
 --- NOT SEARCHED (MOTION NOT AVAILABLE): T = 5.00000, 20.00000 S' "$("$kinmat" "$w/deck" | grep 'MISSED\|NOT SEARCHED')"
with scott_russell_at "$(card EXTREMES LINKS BAR)" | sed "s/^TIME .*/$(card TIME 18 '' '' 0.0 90.0)/" > "$w/deck"
equal 'instants on change points, three turns' ' --- NOT SEARCHED (MOTION NOT AVAILABLE): T = 5.00000, 20.00000, 35.00000, 50.00000 S AND 2 MORE' \
   "$("$kinmat" "$w/deck" | grep 'NOT SEARCHED')"

# From an antiparallelogram to a parallelogram, whose coupler does not turn: least and greatest rate are limits at the change point.
with antiparallelogram_branch "$(card EXTREMES LINKS COUPLER)" > "$w/deck"
equal 'the times of limits' '27.60000 360.000000 27.60000 360.000000' "$("$kinmat" "$w/deck" | awk '/^ EXTREMES  / { on = 1 }
   on && /^  AT T/ { t = $8 } on && /^ AT DRIVE/ { text = text s t " " $8; s = " " } END { print text }')"

# A whole turn in one step of TIME: it is halved, and the table is the same; backwards the strokes change places.
sed "s/^TIME .*/$(card TIME 1 '' '' 0.0 12.0)/" input/stroke.deck > "$w/deck"
"$kinmat" "$w/deck" > "$w/listing" 2>&1
extremes "$w/listing" > "$w/one"
extremes expected/stroke.lst > "$w/small"
same 'a turn in one step' "$w/small" "$w/one"
# strokes [1]: the times from MIN to MAX and back, 1: in the other order
strokes() { sed -n 's/.*TIME MIN TO MAX \([0-9.]*\) S   TIME MAX TO MIN \([0-9.]*\) S .*/\1 \2/p' | awk -v back="$1" '{ print back ? $2 " " $1 : $0 }'; }
sed "s/^TIME .*/$(card TIME 24 '' '' 12.0 0.0)/" input/stroke.deck > "$w/deck"
"$kinmat" "$w/deck" > "$w/listing" 2>&1
equal 'backwards' "$(strokes < "$w/small")" "$(extremes "$w/listing" | strokes 1)"

# found ROW COLUMN: the value in that row and column (0 to 8) of the table in $w/listing, with its time
found() { extremes "$w/listing" | awk -v row="$1" -v at="$((10 + 12*$2))" '/^  (MIN|MAX|AT T)  / { cell = substr($0, at, 12); gsub(/ /, "", cell)
   if ($1 == row) value = cell; else if (value != "" && $1 == "AT") { print value " AT " cell; exit } }'; }
# A RISE shorter than a step, at rest and on a crank that turns: its greatest velocity, 2 or 1.875 times lift over duration, is
# in its middle. The accelerations at its ends are rounding.
for rise in '0.37 0.03 0.5 12' '0.55 0.02 0.5 10'; do
   set -- $rise
   { card GROUND G; card LINK S; card POINT P G; card POINT Q S; card PRISM P Q J; card DRIVE SLIDE J '' 0.0
      card RISE CYCLOID '' '' "$1" "$2" "$3"; card TIME "$4" '' '' 0.0 1.0; card EXTREMES PAIRS J; card END; } > "$w/deck"
   "$kinmat" "$w/deck" > "$w/listing"
   equal "a rise of $2 in $4 steps" "$(awk -v a="$1" -v d="$2" -v l="$3" 'BEGIN { printf "%.5f AT %.6f", 2*l/d, a + d/2 }')" "$(found MAX 1)"
done
{ card UNITS M RAD S; card GROUND G; card LINK C; card JOINT O G C 0.0 0.0; card DRIVE ANGLE C '' 0.0 -1.4322948
   card RISE 3-4-5 '' '' 1.3693661 0.10832686 -0.68935590; card TIME 12 '' '' 0.0 2.0; card EXTREMES LINKS C; card END; } > "$w/deck"
"$kinmat" "$w/deck" > "$w/listing"
equal 'a short rise on a turning crank' "$(awk 'BEGIN { printf "%.5f AT %.6f", -1.4322948 - 1.875*0.68935590/0.10832686, 1.3693661 + 0.10832686/2 }')" \
   "$(found MIN 5)"
# Accelerations of a fast crank that differ by little: their times are those of the sine, as far as digits are known.
{ card UNITS M DEG S; card GROUND BASE; card LINK L1 '' '' '' '' 166.02; card POINT P3 BASE; card POINT Q4 L1; card REVOLUTE P3 Q4 J2
   card DRIVE ANGLE L1 '' 166.02374 57.29578; card RISE CYCLOID '' '' -1.9522E-01 0.001 -26.94576
   card ADD HARMONIC '' '' 11.459156 114.591559 28.64789; card TIME 24 '' '' 0.0 6.28; card EXTREMES LINKS L1; card END; } > "$w/deck"
"$kinmat" "$w/deck" > "$w/listing"
for turn in 'MIN 1' 'MAX 3'; do
   set -- $turn
   equal "a fast crank: $1 of its acceleration" 1 "$(found "$1" 8 | awk -v n="$2" '{ t = (n*atan2(1, 0) - 0.5)/2; known = $3; sub(/[?]+$/, "", known)
      sub(/[.].*/, "", $3); digit = 10^-(length(known) - 2); d = known - t
      print (length(known) >= 6 && (d < 0 ? -d : d) <= digit) }')"
done
# An acceleration that turns just before the end of a rise, on an instant: by real128.
"$kinmat" tests/system/decks/rise_ends_on_instant.deck > "$w/listing"
equal 'an acceleration beside the end of a rise' '4.44766 AT 0.327168' "$(found MAX 6)"

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

# At another time than 0 all drives are held where they are then: the same with their values typed.
ranges() { { cat; card RANGE; card END; } | "$kinmat" 2>&1 | sed -n '/^ RANGES/,/^ CONTINUATION/p'; }
sed -e '/^END/,$d' -e "s/^TIME .*/$(card AT '' '' '' 0.5)/" input/three_rrr.deck > "$w/cards_at"
ranges < "$w/cards_at" > "$w/moving"
awk '/^ADD/ { next }
   /^DRIVE   X / { value = 5 + 0.8*sin(0.5) } /^DRIVE   Y / { value = 3 + 0.6*sin(1.5) } /^DRIVE   ANGLE / { value = 0.1 + 0.25*sin(0.75) }
   /^DRIVE/ { printf "%-32s%.11f\n", substr($0, 1, 24), value; next } 1' "$w/cards_at" | ranges > "$w/typed"
same 'drives that are held at another time than 0' "$w/typed" "$w/moving"
equal 'drives that are held at another time than 0: ends' 6 "$(grep -cE '^   M(IN|AX) ' "$w/typed")"

# Closer than rounding can tell, 1E-10: the ends to 1E-5 degrees, with the reason, which a run to there gives as well.
still_four_bar 3.0 1.1 2.6499999999 0.75 CRANK 50.0 -35.8 38.6 50.0 RANGE > "$w/deck"
"$kinmat" "$w/deck" > "$w/out"
equal 'at the limit of Grashof' 'MIN 0 MAX 0' "$(awk -v a="$(angle 3 0.75 3.7499999999)" '/^   (MIN|MAX) / && /DEG   LIMIT OR CHANGE POINT, NOT DISTINGUISHABLE [(]ROUNDING ERROR[)]$/ {
   d = ($2 < 0 ? -$2 : $2) - a; printf "%s%s %d", sep, $1, ((d < 0 ? -d : d) > 1e-5); sep = " " }' "$w/out")"
sed -e "s/^AT .*/$(card TIME 100 '' '' 0.0 5.0)/" -e /^RANGE/d "$w/deck" > "$w/run.deck"
equal 'at the limit of Grashof: a run' ' *** THE MOTION IS FOLLOWED TO T = 4.33329... S: LIMIT OR CHANGE POINT, NOT DISTINGUISHABLE (ROUNDING ERROR)' \
   "$("$kinmat" "$w/run.deck" | sed -n 's/^\( .*T = 4.33329\)[0-9]* \(.* NOT DIST.*\)/\1... \2/p')"
# A dyad on the coupler of a parallelogram whose lengths are off by 3E-12 follows the accelerations that grow beside the change
# point: that is no limit of the dyad, which is far from its dead points.
{
   card UNITS M DEG S; card GROUND BASE
   card LINK CRANK '' '' 0.0 0.0 1060.0; card LINK COUPLER '' '' 1.87938524 -0.684040287 0.0
   card LINK ROCKER '' '' 3.0 0.0 1060.0
   card LINK D1 '' '' 3.37938524 0.815959713 136.343611; card LINK D2 '' '' 4.54976137 2.76809647 157.025925
   card POINT A0 BASE; card POINT B0 BASE '' 3.0; card POINT G BASE '' 4.54976137 2.76809647
   card POINT A1 CRANK; card POINT A2 CRANK '' 2.0; card POINT C1 COUPLER; card POINT C2 COUPLER '' 2.99999999999696
   card POINT CP COUPLER '' 1.5 1.5; card POINT R1 ROCKER; card POINT R2 ROCKER '' 2.0
   card POINT Q1 D1; card POINT Q2 D1 '' 6.38221977; card POINT S1 D2; card POINT S2 D2 '' 6.28650173
   card REVOLUTE A0 A1 K0; card REVOLUTE A2 C1 K1; card REVOLUTE C2 R2 K2; card REVOLUTE B0 R1 K3
   card REVOLUTE CP Q1 K4; card REVOLUTE Q2 S2 K5; card REVOLUTE G S1 K6
   card DRIVE ANGLE CRANK '' 1060.0 50.3900617
   card TIME 12 '' '' 0.0 2.59669322
   card END
} > "$w/run.deck"
equal 'a dyad beside a change point is at no limit' ' *** THE MOTION IS FOLLOWED TO T = 0.396903 S: LIMIT OR CHANGE POINT, NOT DISTINGUISHABLE (ROUNDING ERROR)' \
   "$("$kinmat" "$w/run.deck" | grep -E '[*] .*(FOLLOWED|LIMIT)')"

with stroke "$(card EXTREMES LINKS BASE)" | refused 'a ground link' \
   'E071 CARD 35 COLUMN 17 FIELD LABEL-B: "BASE" IS GROUND: NAME WHAT MOVES'
with stroke "$(card EXTREMES POINTS A0)" | refused 'a ground point' \
   'E071 CARD 35 COLUMN 17 FIELD LABEL-B: "A0" IS GROUND: NAME WHAT MOVES'
with stroke "$(card EXTREMES POINTS C)" | refused 'twice' \
   'E096 CARD 35 COLUMN 9 FIELD LABEL-A: "POINTS" IS REPEATED; FIRST ON CARD 33'
with stroke "$(card EXTREMES PAIRS NONE)" | refused 'no such pair' \
   'E053 CARD 35 COLUMN 17 FIELD LABEL-B: "NONE" IS NOT THE NAME OF A PAIR'
with stroke "$(card EXTREMES LINKS CRANK '' '' -1.0)" | refused 'a negative distance' \
   'E036 CARD 35 COLUMN 49 FIELD REAL-2: "-1.0" IS OUT OF RANGE; ALLOWED: 0.0 AND UP'
with stroke "$(card RANGE CRANK)" | refused 'ranges with a field' \
   'E019 CARD 35 COLUMN 9 FIELD LABEL-A: "CRANK" IS IN A FIELD THAT THIS CARD DOES NOT USE'
sed -e 's/^TIME .*/AT                              1.0/' input/stroke.deck > "$w/deck"
ends 'no TIME card' 1 "$w/deck"
equal 'no TIME card: codes' 'E098 E098 E098' "$(sed -n 's/^ [*]* *\(E[0-9][0-9][0-9]\) .*/\1/p' "$w/err" | tr '\n' ' ' | sed 's/ $//')"
conclude
