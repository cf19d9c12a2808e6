#!/bin/sh
# Tolerances: sensitivities against differences of decks with changed numbers, in real128, by NEWTON, DENSE and MATRIX, in
# other units, beside a change point and with redundant equations; the root of the sum of squares against many decks with all numbers
# off by chance. An argument: so many of these (make tolerances: 10000).
. tests/counting.sh
sets=${1:-400}
quad=$kinmat-quad

# toleranced FORMS: the first set of the deck on standard input, with a small tolerance for each number of the cards FORMS
toleranced() {
   awk -v forms=" $1 " '
      /^END/ { print; exit }
      /^(TOLER|EXTREMES)/ { next }
      { print; name = substr($0, 1, 8); gsub(/ /, "", name) }
      index(forms, " " name " ") {
         three = name ~ /^(GROUND|PRISM|DRIVE)$/
         # Of a JOINT card both holes together: the drawing with other coordinates.
         printf "%-32s0.0005          0.0010%s\n", "TOLER   " (name == "JOINT" ? "BOTH" : ""), three ? "          0.0015" : ""
      }'
}
# differences NAME DECK STEP ALLOWED: the sensitivities of the deck, as those of the `methods`, are central differences, in
# real128, of the motions of decks whose numbers are off by STEP. They differ by ALLOWED at most, in the unit of either, or
# as a part of larger ones. A number of a row with velocities has a sensitivity. The two motions are subtracted by the first ten digits and the rest of each number: in one real
# the digits in which they differ would be lost.
methods=NEWTON
differences() {
   awk -v h="$3" -f tests/system/perturbed_sets.awk "$2" > "$w/sets.deck"
   "$quad" --no-listing --quiet --csv "$w/sets.csv" "$w/sets.deck" > "$w/out" 2>&1
   for method in $methods; do
      awk -v method="$method" '/^METHOD/ { next } /^(AT|TIME)/ && !done { printf "%-8s%s\n", "METHOD", method; done = 1 } { print }' \
         "$2" > "$w/deck"
      "$kinmat" --no-listing --quiet --csv "$w/found.csv" "$w/deck" > "$w/out" 2>&1
      equal "$1, METHOD $method" "0 off" "$(awk -F, -v h="$3" -v allowed="$4" '
      # The sign, the exponent, and the digits of x: of the first ten an integer, of the rest a part of one.
      function take_apart(x, of) {
         of["sign"] = sub(/^-/, "", x) ? -1 : 1
         of["power"] = substr(x, index(x, "E") + 1) + 0
         sub(/E.*/, "", x)
         sub(/[.]/, "", x)
         of["digits"] = x
      }
      function shift(of, n) { for (; n > 0; n--) { of["digits"] = "0" of["digits"]; of["power"]++ } }
      function difference(x, y) {
         take_apart(x, of_x)
         take_apart(y, of_y)
         if (x + 0 == 0) of_x["power"] = of_y["power"]
         if (y + 0 == 0) of_y["power"] = of_x["power"]
         shift(of_x, of_y["power"] - of_x["power"])
         shift(of_y, of_x["power"] - of_y["power"])
         return (of_x["sign"]*substr(of_x["digits"], 1, 10) - of_y["sign"]*substr(of_y["digits"], 1, 10) \
            + (of_x["sign"]*("0." substr(of_x["digits"], 11)) - of_y["sign"]*("0." substr(of_y["digits"], 11))))*10^(of_x["power"] - 9)
      }
      FNR == 1 { file++; next }
      { key = $2 "," $4 "," $5 }
      file == 1 && $4 ~ / PER / {
         split($4, kind, " PER ")
         row = $2 "," kind[1] "," $5
         number = ++numbers[row]
         for (c = 6; c <= 14; c++) s[row, number, c] = $c
         next
      }
      file == 1 { for (c = 6; c <= 14; c++) exists[key, c] = $9 != "" && $c != "" }
      file == 2 {
         number = int(($1 + 1) / 2)
         for (c = 6; c <= 14; c++) {
            if (exists[key, c] && s[key, number, c] == "") off++
            if (s[key, number, c] == "" || $c == "") continue
            if ($1 % 2) { up[key, c] = $c; continue }
            d = difference(up[key, c], $c)/(2*h)
            e = s[key, number, c] - d
            if (e < 0) e = -e
            e /= 1 + (d < 0 ? -d : d)
            compared++
            if (e > allowed) off++
         }
      }
      END { print compared ? off + 0 : "nothing compared," , "off" }' "$w/found.csv" "$w/sets.csv")"
   done
}
# at TIMES: the deck on standard input, at these times alone
at() {
   awk -v card="$(card AT '' '' '' "$@")" '/^(AT|TIME)/ { next } /^END/ { print card } { print }'
}

for deck in four_bar five_bar yoke; do
   toleranced 'GROUND POINT PRISM DRIVE' < "input/$deck.deck" | at 0.7 2.3 > "$w/$deck.deck"
   methods='NEWTON DENSE MATRIX'
   differences "$deck" "$w/$deck.deck" 1e-7 1e-8
   awk -v long=3 -v late=1 -f tests/system/other_units.awk "$w/$deck.deck" > "$w/units.deck"
   methods='NEWTON DENSE'
   differences "$deck in other units" "$w/units.deck" 1e-8 1e-8
done
# A change of a law's factor whose first step turns the crank by 2 pi, at 17.66 s: a return to where it was is no small one.
toleranced '' < input/four_bar.deck | awk -v law="$(card ADD POWER '' '' 0.0001 3.0)" -v bar="$(card TOLER '' '' '' 0.0001)" \
   -v times="$(card TIME 40 '' '' 16.0 18.0)" '/^(AT|TIME)/ { next } /^END/ { print times } { print } /^DRIVE/ { print law; print bar }' \
   > "$w/turn.deck"
differences 'a full turn by a change' "$w/turn.deck" 1e-7 1e-8
toleranced 'JOINT POINT DRIVE' < input/drawing.deck > "$w/drawing.deck"
differences 'a drawing' "$w/drawing.deck" 1e-7 1e-8
# A body vector without a length, which a tolerance gives it: the block's guide goes through the pin. The lever turns by 1/|OB|.
awk -v bar="$(card TOLER '' '' '' 0.01 0.01)" '{ sub(/^PRISM   O-LEVER B /, "PRISM   O-LEVER G "); print }
   /^POINT   B / { sub(/B /, "G "); print; print bar } /^END/ { exit }' input/yoke.deck | at 0.0 1.5 7.0 > "$w/block.deck"
differences 'a body vector without a length' "$w/block.deck" 1e-7 1e-8
equal 'a body vector without a length: the lever' 0.44721360 "$("$kinmat" --no-listing --csv - "$w/block.deck" |
   awk -F, '$4 == "LINK PER POINT G ETA" && $5 == "LEVER" && $3 == 0 { printf "%.8f", $8*atan2(1, 1)/45 }')"
# Numbers that are as drawn follow the drawing: direction, length and value of a driven cylinder; h of a guide at an angle,
# on a link of the ground that has tolerances, with beta, and a driven slide; the value of a driven place.
tolerance() { card TOLER '' '' '' "$@"; }
both() { card TOLER BOTH '' '' "$@"; }
bar=0.0005
{
   card UNITS M DEG S; card GROUND BASE; card LINK ARM '' '' 0.25 0.5 20.0; card LINK BARREL; card LINK ROD '' '' '' '' 35.0
   card JOINT O BASE ARM 0.125 0.25; both $bar $bar
   card JOINT B0 BASE BARREL 1.5 -0.75; both $bar $bar
   card JOINT B ROD ARM 2.25 1.5; both $bar $bar
   card POINT TIP ARM 3.0 0.5; card CYLINDER B0 B RAM; card DRIVE SLIDE RAM '' '' 0.25; card AT '' '' '' 0.5 1.5
   card PRINT ALL; card END
} > "$w/cylinder.deck"
differences 'a drawn cylinder' "$w/cylinder.deck" 1e-7 1e-8
drawn_slider() {
   card UNITS M DEG S; card GROUND BASE; card GROUND RAIL '' '' 0.25 0.5 10.0; tolerance $bar $bar $bar
   card LINK CRANK; card LINK ROD; card LINK SLIDER '' '' 3.0 0.5 40.0
   card JOINT A0 BASE CRANK 0.0 0.125; both $bar $bar
   card JOINT A CRANK ROD 0.25 1.0; both $bar $bar
   card JOINT B SLIDER ROD 3.0 0.5; both $bar $bar
   card POINT R RAIL 0.125 0.375; tolerance $bar $bar
   card POINT S SLIDER 0.25 -0.125; tolerance $bar $bar
   card PRISM R S GUIDE -15.0; tolerance $bar
   "$@"; card AT '' '' '' 0.5 1.5; card PRINT ALL; card END
}
drawn_slider card DRIVE ANGLE CRANK '' '' 30.0 > "$w/slider.deck"
differences 'a drawn slider' "$w/slider.deck" 1e-7 1e-8
drawn_slider card DRIVE SLIDE GUIDE '' '' -0.25 > "$w/slide.deck"
differences 'a driven slide as drawn' "$w/slide.deck" 1e-7 1e-8
drawn_slider card DRIVE X A '' '' -0.25 > "$w/place.deck"
differences 'a driven place as drawn' "$w/place.deck" 1e-7 1e-8
drawn_slider card DRIVE RELANGLE RAIL ROD '' 5.0 > "$w/relative.deck"
differences 'a driven relative angle as drawn' "$w/relative.deck" 1e-7 1e-8
differences 'in millimetres, radians' input/guide_tolerances.deck 1e-7 1e-8
# Five degrees from a change point, and on it: there is nothing.
toleranced 'POINT' < input/parallelogram_at.deck | at 10.0 15.5 16.0 > "$w/beside.deck"
differences 'beside a change point' "$w/beside.deck" 1e-9 1e-8
awk -v long=3 -v late=1 -f tests/system/other_units.awk "$w/beside.deck" > "$w/units.deck"
differences 'beside a change point in other units' "$w/units.deck" 1e-8 1e-8
methods=NEWTON
"$kinmat" --no-listing --quiet --csv "$w/found.csv" "$w/beside.deck" > "$w/out" 2>&1
equal 'on a change point' 0 "$(awk -F, '$2 == 2 && $4 ~ /RSS/ && $5 != "CRANK" && $6 $7 $8 $9 $12 != "" { n++ } END { print n + 0 }' "$w/found.csv")"
equal 'on a change point, the driven crank' yes "$(awk -F, '$2 == 2 && $4 == "LINK RSS" && $5 == "CRANK" && $14 != "" { print "yes" }' "$w/found.csv")"
# Nine bars that move because their lengths are what they are: the place of the whole and its drive may change, no length.
toleranced 'GROUND DRIVE' < input/dixon.deck | at 0.7 2.3 > "$w/dixon.deck"
differences 'redundant equations that agree' "$w/dixon.deck" 1e-7 1e-8
awk -v long=3 -v late=1 -f tests/system/other_units.awk "$w/dixon.deck" > "$w/units.deck"
differences 'redundant equations in other units' "$w/units.deck" 1e-8 1e-8
toleranced 'DRIVE POINT' < input/dixon.deck > "$w/dixon.deck"
"$kinmat" "$w/dixon.deck" > "$w/listing" 2>&1
equal 'redundant equations that do not: status' 0 $?
equal 'redundant equations that do not: numbers named' yes "$(grep -c 'MECHANISM JAMS' "$w/listing" | awk '$1 > 10 { print "yes" }')"
equal 'redundant equations that do not: no sensitivities' '' "$(grep -E '^  (WORST|RSS)' "$w/listing" | grep '[0-9]')"
# A piston that two drives push in one way is out of reach after a change near its dead point: that contradicts no
# equation. With the crank 1, the rod 3 and the eye at X the rod's angle has cos = (X**2 + 8)/(6 X).
{ inline_slider 40.0 0.766 0.643 -13.0 3.7 | sed "s/^POINT   B  .*/&\n$(card TOLER '' '' '' 0.001)/"
  card POINT P PISTON '' -0.5; card DRIVE X P '' 3.0 0.5; card DRIVE X P '' 3.0 0.5
  card TIME 18 '' '' 0.0 0.99; card PRINT LINKS ROD; card END; } > "$w/pushed.deck"
"$kinmat" --csv "$w/found.csv" "$w/pushed.deck" > "$w/listing" 2>&1
equal 'a change out of reach does not jam' 0 "$(grep -c JAMS "$w/listing")"
equal 'a change out of reach: angles of the rod' '19 of 19' "$(awk -F, '
   $4 == "LINK WORST" {
      x = 3.5 + 0.5*$3
      c = (x*x + 8)/(6*x)
      slope = (1 - 8/(x*x))/6/sqrt(1 - c*c)
      off = $8 - 0.001*slope*180/atan2(0, -1)
      n++
      near += $8 != "" && off*off < 1e-16
   }
   END { print near " of " n }' "$w/found.csv")"

# Poles and curves have none, which the listing says.
awk '/^END/ { print "POLE    BASE    ROCKER"; print; exit } { print }' input/tolerances.deck > "$w/poles.deck"
equal 'poles' ' --- POLES AND CURVES HAVE NO TOLERANCES' "$("$kinmat" "$w/poles.deck" | grep 'POLES AND CURVES')"

# By chance, at two instants behind one beside the estimates, which choose the assembly: the variance of each quantity over
# the square of its root of squares is 1, within five standard errors of a variance of so many numbers. What is of second
# order in the tolerances is a thousandth of it at most.
for deck in tolerances guide_tolerances four_bar five_bar parallelogram_at dixon; do
   case $deck in
   *_tolerances | tolerances) cat "input/$deck.deck" ;;
   dixon) toleranced 'GROUND DRIVE' < input/dixon.deck ;;
   *) toleranced 'GROUND POINT DRIVE' < "input/$deck.deck" ;;
   esac | at 0.0 2.0 5.0 > "$w/base.deck"
   # A set of Dixon's nine bars takes as long as ten others: a third of them. Their limit, 0.6, sees a root that is wrong by 1.7; each
   # sensitivity is compared above.
   [ $deck = dixon ] && sets=$((sets/3))
   awk -v n="$sets" -f tests/system/perturbed_sets.awk "$w/base.deck" > "$w/sets.deck"
   "$kinmat" --no-listing --quiet --csv "$w/base.csv" "$w/base.deck"
   "$kinmat" --no-listing --quiet --csv "$w/sets.csv" "$w/sets.deck"
   equal "$deck: $sets decks by chance" '0 off' "$(awk -F, -v sets="$sets" '
      FNR == 1 { file++; next }
      file == 1 && $4 ~ / RSS$/ { sub(/ RSS/, "", $4); for (c = 6; c <= 14; c++) root[$2 "," $4 "," $5, c] = $c; next }
      file == 1 && $4 !~ / / { for (c = 6; c <= 14; c++) middle[$2 "," $4 "," $5, c] = $c; next }
      file == 2 {
         for (c = 6; c <= 14; c++) {
            key = $2 "," $4 "," $5 SUBSEP c
            if ($2 > 0 && root[key] > 1e-9 && $c != "") { d = ($c - middle[key]) / root[key]; sum[key] += d; square[key] += d * d }
         }
      }
      END {
         limit = 5 * sqrt(2 / (sets - 1)) + 0.001
         for (key in sum) {
            n++
            variance = (square[key] - sum[key] * sum[key] / sets) / (sets - 1)
            if (variance > 1 + limit || variance < 1 - limit) off++
         }
         print n ? off + 0 : "nothing,", "off"
      }' "$w/base.csv" "$w/sets.csv")"
done
conclude
