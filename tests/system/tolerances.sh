#!/bin/sh
# Tolerances: sensitivities against differences of decks with changed numbers, by NEWTON, DENSE and MATRIX, in other units,
# beside a change point and with redundant equations; the root of the sum of squares against many decks with all numbers
# off by chance. An argument: so many of these (make tolerances: 10000).
BUILD=${BUILD:-build}
. tests/counting.sh
sets=${1:-400}
case $BUILD in
/*) kinmat=$BUILD/kinmat ;;
*) kinmat=$PWD/$BUILD/kinmat ;;
esac
w=$BUILD/tolerances
rm -rf "$w" && mkdir -p "$w" || exit 3

# toleranced FORMS: the first set of the deck on standard input, with a tolerance for each number of the cards FORMS
toleranced() {
   awk -v forms=" $1 " '
      /^END/ { print; exit }
      /^(TOLER|EXTREMES)/ { next }
      { print; name = substr($0, 1, 8); gsub(/ /, "", name) }
      index(forms, " " name " ") {
         three = name ~ /^(GROUND|PRISM|DRIVE)$/
         printf "TOLER                           0.01            0.02%s\n", three ? "            0.03" : ""
      }'
}
# differences NAME DECK STEP: the sensitivities of the deck are differences of decks whose numbers are off by STEP
differences() {
   "$kinmat" --no-listing --quiet --csv "$w/found.csv" "$2" > "$w/out" 2>&1
   awk -v h="$3" -f tests/system/perturbed_sets.awk "$2" > "$w/sets.deck"
   "$kinmat" --no-listing --quiet --csv "$w/sets.csv" "$w/sets.deck" > "$w/out" 2>&1
   equal "$1" "0 off" "$(awk -F, -v h="$3" '
      FNR == 1 { file++; next }
      { key = $2 "," $4 "," $5 }
      file == 1 && $4 ~ / PER / {
         split($4, kind, " PER ")
         row = $2 "," kind[1] "," $5
         number = ++numbers[row]
         for (c = 6; c <= 14; c++) s[row, number, c] = $c
         next
      }
      file == 2 {
         number = int(($1 + 1) / 2)
         for (c = 6; c <= 14; c++) {
            if (s[key, number, c] == "" || $c == "") continue
            if ($1 % 2) { up[key, c] = $c; continue }
            d = (up[key, c] - $c) / (2 * h)
            e = s[key, number, c] - d
            if (e < 0) e = -e
            compared++
            if (e > 2e-6 * (1 + (d < 0 ? -d : d))) off++
         }
      }
      END { print compared ? off + 0 : "nothing compared," , "off" }' "$w/found.csv" "$w/sets.csv")"
}

for deck in four_bar five_bar yoke; do
   toleranced 'GROUND POINT PRISM DRIVE' < "input/$deck.deck" | awk '/^TIME/ { print "AT                              0.7             2.3"; next }
      { print }' > "$w/$deck.deck"
   differences "$deck" "$w/$deck.deck" 1e-5
   for method in DENSE MATRIX; do
      sed "s/^AT /METHOD  $method\\
AT /" "$w/$deck.deck" > "$w/other.deck"
      differences "$deck, METHOD $method" "$w/other.deck" 1e-5
   done
done
toleranced 'JOINT POINT DRIVE' < input/drawing.deck > "$w/drawing.deck"
differences 'a drawing' "$w/drawing.deck" 1e-5
differences 'in millimetres, radians' input/guide_tolerances.deck 1e-4
# Five degrees from a change point, and on it: there is nothing.
toleranced 'POINT' < input/parallelogram_at.deck | awk '/^TIME/ { print "AT                              10.0            15.5            16.0"; next }
   { print }' > "$w/beside.deck"
differences 'beside a change point' "$w/beside.deck" 1e-6
equal 'on a change point' 0 "$(awk -F, '$2 == 2 && $4 ~ /RSS/ && $5 != "CRANK" && $6 $7 $8 $9 $12 != "" { n++ } END { print n + 0 }' "$w/found.csv")"
equal 'on a change point, the driven crank' yes "$(awk -F, '$2 == 2 && $4 == "LINK RSS" && $5 == "CRANK" && $14 != "" { print "yes" }' "$w/found.csv")"
# Nine bars that move because their lengths are what they are: the place of the whole and its drive may change, no length.
toleranced 'GROUND DRIVE' < input/dixon.deck | awk '/^TIME/ { print "AT                              0.7             2.3"; next } { print }' > "$w/dixon.deck"
differences 'redundant equations that agree' "$w/dixon.deck" 1e-5
toleranced 'DRIVE POINT' < input/dixon.deck > "$w/dixon.deck"
"$kinmat" "$w/dixon.deck" > "$w/listing" 2>&1
equal 'redundant equations that do not: status' 0 $?
equal 'redundant equations that do not: numbers named' yes "$(grep -c 'LEAVE NO ROOM' "$w/listing" | awk '$1 > 10 { print "yes" }')"
equal 'redundant equations that do not: no sensitivities' '' "$(grep -E '^  (WORST|RSS)' "$w/listing" | grep '[0-9]')"

# Poles and curves have none, which the listing says.
awk '/^END/ { print "POLE    BASE    ROCKER"; print; exit } { print }' input/tolerances.deck > "$w/poles.deck"
equal 'poles' ' --- POLES AND CURVES HAVE NO TOLERANCES' "$("$kinmat" "$w/poles.deck" | grep 'POLES AND CURVES')"

# The same mechanism in millimetres: a thousand times the numbers.
awk '/^(POINT|GROUND|TOLER|LINK) / {
      line = $0
      for (k = 1; k <= 3; k++) {
         text = substr($0, 17 + 16 * k, 16)
         scale = above ~ /^DRIVE/ || k == 3 ? 1 : 1000
         if (text ~ /[0-9]/) line = substr(sprintf("%-80s", line), 1, 16 + 16 * k) sprintf("%-16.8f", text * scale) substr(sprintf("%-80s", line), 33 + 16 * k)
      }
      print line; above = $0; next }
   { print; above = $0 }' input/tolerances.deck > "$w/large.deck"
"$kinmat" --csv "$w/large.csv" "$w/large.deck" > "$w/large.lst" 2>&1
"$kinmat" --csv "$w/small.csv" input/tolerances.deck > "$w/small.lst" 2>&1
equal 'in millimetres' '0 off' "$(awk -F, '
   FNR == 1 { file++; next }
   $4 !~ / RSS/ { next }
   file == 1 { for (c = 6; c <= 14; c++) x[$2 $4 $5, c] = $c; next }
   { for (c = 6; c <= 14; c++) {
        if ($c == "") continue
        y = $c / ($4 == "PAIR RSS" || c % 3 == 2 ? 1 : 1000)
        e = y - x[$2 $4 $5, c]; if (e < 0) e = -e
        n++
        if (e > 1e-11) off++ } }
   END { print n ? off + 0 : "nothing,", "off" }' "$w/small.csv" "$w/large.csv")"
equal 'in millimetres: shares' "$(sed -n 's/^ *\([0-9.]* %\).*/\1/p' "$w/small.lst" | md5sum)" \
   "$(sed -n 's/^ *\([0-9.]* %\).*/\1/p' "$w/large.lst" | md5sum)"

# By chance: the variance of each quantity over the square of its root of squares is 1, within five standard errors of a
# variance of so many numbers. What is of second order in the tolerances is a thousandth of it at most.
for deck in tolerances guide_tolerances; do
   sed 's/^TIME .*/AT                              2.0             5.0/' "input/$deck.deck" > "$w/base.deck"
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
            if (root[key] > 1e-9) { d = ($c - middle[key]) / root[key]; sum[key] += d; square[key] += d * d }
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
