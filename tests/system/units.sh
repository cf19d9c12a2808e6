#!/bin/sh
# A deck with all its lengths times a power of ten prints the same digits: every deck of input/, from millionths to
# millions: by these two powers and one between them, by turns; units.sh all: by six. The answers of the cards EXTREMES,
# RANGE, POLE, CURVE and TOLER, by NEWTON and DENSE, have the same digits with other units of time, too; in radians they
# are the same numbers.
. tests/counting.sh

# digits LISTING: its rows of numbers, LINK cards left out, without points, leading zeros and powers of ten.
digits() {
   awk '/^ RESULTS|^ WYNIKI/ { told = 1 } /^ SET OF |^ KOMPLET / { told = 0 }
        told && !/^LINK/ && !/^ *1[.]E[-+]/ && NF > 1 && $NF ~ /^(-?[0-9.?]+(E[-+][0-9]+)?|NONE|INFINITE|UNBOUNDED|REST)$/ && $1 !~ /^(INSTANT|CHWILA|END|KONIEC)/ {
      line = $1
      for (i = 2; i <= NF; i++) {
         minus = $i ~ /^-/ ? "-" : ""; gsub(/[-.]/, "", $i); sub(/^0+/, "", $i); line = line " " minus $i
      }
      print line }' "$1"
}

between='-3 -1 2 3'
for deck in $(grep -L '^VARY' input/*.deck); do
   name=$(basename "$deck" .deck)
   digits "expected/$name.lst" > "$w/wanted"
   equal "$name: rows are compared" yes "$([ "$(wc -l < "$w/wanted")" -gt 10 ] && echo yes)"
   # Their largest numbers take all the room of a column; in tenths and hundreds there is none for as many decimals.
   case $name in far_small|dead_point_*) some='-3 3'; turn=$some ;; *) some=$between; turn=${between%% *}; between="${between#* } $turn" ;; esac
   powers="-6 6 $([ "$1" = all ] && echo "$some" || echo "$turn")"
   # One deck, one run: its sets times each of these powers.
   for k in $powers; do
      awk -v long=$k -f tests/system/other_units.awk "$deck"
      cat "$w/wanted" >&3
   done > "$w/deck" 3> "$w/all_wanted"
   "$BUILD/kinmat" "$w/deck" > "$w/lst" 2> "$w/err"
   status=$?
   flagged=$(grep -cE ' (FLAGGED|ZAZNACZONE) [1-9]' "expected/$name.lst")
   equal "$name times 10**($powers): status" "$([ "$flagged" -gt 0 ] && echo 2 || echo 0)" $status
   equal "$name times 10**($powers): sets with flagged instants" $((flagged*$(echo $powers | wc -w))) \
      "$(grep -cE ' (FLAGGED|ZAZNACZONE) [1-9]' "$w/lst")"
   digits "$w/lst" > "$w/out"
   same "$name times 10**($powers): the same digits" "$w/all_wanted" "$w/out"
done

# A crank at 150 degrees, of 1E-4 to 1E7: the same digits of x, and a power of ten only where they have no room without one.
for crank in '1.0E-4 1.E-06 -86.6025' '1.0E-3 -.000866025' '1.0E-2 -0.00866025' '1.0E-1 -0.0866025' '1.0 -0.866025' \
   '1.0E3 -866.025' '1.0E5 -86602.5' '1.0E6 -866025.' '1.0E7 1.E+06 -8.66025'; do
   set -- $crank
   { card UNITS M DEG S; card GROUND BASE; card LINK CRANK '' '' 0.0 0.0 150.0; card POINT O BASE; card POINT P CRANK
     card POINT TIP CRANK '' "$1"; card REVOLUTE O P PIVOT; card DRIVE ANGLE CRANK '' 150.0; card AT '' '' '' 0.0
     card PRINT POINTS TIP; card END; } > "$w/deck"
   "$kinmat" "$w/deck" > "$w/lst"
   equal "a crank of $1: power and digits" "${crank#* }" \
      "$(awk '/^ POINT  .* VX / { on = 1; next } !on { next } /^ *1[.]E/ { printf "%s ", $1 } /^ TIP / { print $2; exit }' "$w/lst")"
done

# asked METHOD DECK LINK LINK LINK POINT: its first set, all cards in it, poles and curves of these, tolerances of all points
# and drives; TIME of one variant, so that --summary has extremes and ranges in 17 digits.
asked() {
   with "$2" "$(card METHOD "$1")" "$(card EXTREMES ALL '' '' 0.01 1.0)" "$(card RANGE)" "$(card POLE BASE "$3")" \
      "$(card POLE "$4" "$5")" "$(card CURVE "$6")" "$(card CURVE "$6" "$4")" |
      if [ "$1 $2" = 'DENSE parallelogram_at' ]; then sed "s/^TIME .*/$(card TIME 15 '' '' 0.0 15.0)/"; else cat; fi |
      awk '/^END/ { print; exit } { print } /^TIME/ { printf "VARY    R2      LIST            %s\n", substr($0, 49, 16) }
         /^(POINT|DRIVE)/ { print "TOLER                           0.01            0.02" }'
}
# answers LISTING: the digits of its tables; ranges; shares of tolerances, and sensitivities without powers of ten.
answers() {
   digits "$1"
   awk '/^RANGES|^   (MIN|MAX|TURNS)|CHANGE POINTS ON THE WAY/ { print } / %  / { sub(/ S = +/, "S "); sub(/E.*/, ""); print }' "$1"
}
# as_degrees UNIT FILE: the numbers of a CSV or summary, those of angles times UNIT, and sensitivities to angles over it.
as_degrees() {
   awk -F, -v u="$1" '
      FNR == 1 { n = split($0, head, ","); next }
      { for (i = 1; i <= n; i++) {
         x = $i
         if (x ~ /^-?[0-9.E+-]+$/) {
            if (head[i] ~ /(phi|theta|omega|alpha)([.](min|max|stroke))?$|ANGLE[.][A-Z0-9.-]*$/ && head[i] !~ /turns/ || i > 6 && $5 ~ /^PAIR/) x *= u
            if (i > 6 && $5 ~ / PER (REL)?ANGLE/) x /= u
            x = sprintf("%.9f", x)
         }
         printf "%s%s", x, i < n ? "," : "\n" } }' "$2" | sed 's/-\(0[.]0*\(,\|$\)\)/\1/g'
}
for deck in 'four_bar COUPLER CRANK ROCKER C' 'five_bar ROD-L LEFT RIGHT C' 'dixon BAR-33 BAR-12 BAR-21 B3-33' \
   'parallelogram_at COUPLER CRANK ROCKER B-CO'; do
   for method in NEWTON DENSE; do
      # Redundant equations DENSE refuses; at a change point it ends.
      [ "$method ${deck%% *}" != 'DENSE dixon' ] || continue
      name="${deck%% *}, $method"
      asked $method $deck > "$w/whole.deck"
      "$BUILD/kinmat" --csv "$w/whole.csv" --summary "$w/whole.sum" "$w/whole.deck" > "$w/whole" 2>&1
      answers "$w/whole" > "$w/wanted"
      for units in 'long=3 late=0' 'long=-3 late=2' 'long=0 late=-3'; do
         awk -v ${units% *} -v ${units#* } -f tests/system/other_units.awk "$w/whole.deck" > "$w/deck"
         "$BUILD/kinmat" "$w/deck" > "$w/lst" 2>&1
         answers "$w/lst" > "$w/out"
         same "$name, $units" "$w/wanted" "$w/out"
      done
      awk -v radians=1 -f tests/system/other_units.awk "$w/whole.deck" > "$w/deck"
      "$BUILD/kinmat" --csv "$w/rad.csv" --summary "$w/rad.sum" "$w/deck" > "$w/lst" 2>&1
      for file in csv sum; do
         as_degrees 1 "$w/whole.$file" > "$w/wanted.$file"
         as_degrees 57.295779513082320877 "$w/rad.$file" > "$w/out.$file"
         same "$name, radians, $file" "$w/wanted.$file" "$w/out.$file"
      done
   done
done
# The bounds of PROVE are printed in the characteristic length and rate, with one digit: with other units of time as well.
awk '/^END/ { print "PROVE"; print; exit } { print }' input/four_bar.deck > "$w/proved.deck"
bounds() { "$BUILD/kinmat" "$1" | awk '/ PROOF:/ { told = 1 } / INSTANTS PROVED/ { told = 0 } told && $1 ~ /^[0-9]+$/ { print $5, $6, $7 }'; }
bounds "$w/proved.deck" > "$w/wanted"
awk -v long=0 -v late=3 -f tests/system/other_units.awk "$w/proved.deck" > "$w/deck"
bounds "$w/deck" | paste -d ' ' "$w/wanted" - > "$w/out"
equal 'bounds of proofs, late=3' '117 0' "$(awk '{ for (k = 1; k <= 3; k++) { n++; bad += !($(k + 3) > 0.4*$k && $(k + 3) < 2.5*$k) } }
   END { print n, bad }' "$w/out")"
conclude
