#!/bin/sh
# What a drawing needs: a closing tolerance for rounded coordinates (METHOD, REAL-2), against closed forms of the exact drawing.
. tests/counting.sh

# cranks SEED TOLERANCE: a platform on three or four equal cranks, in coordinates rounded to 0.001; the first crank from its drawn
# angle by 360 degrees. In `exact`: crank, start and pins.
cranks() {
   awk -v seed="$1" -v tolerance="$2" -v exact="$w/exact" '
      function card(name, a, b, c, x, y) { printf "%-8s%-8s%-8s%-8s%-16s%-16s\n", name, a, b, c, x, y }
      BEGIN { srand(seed); pi = atan2(0, -1)
         n = 3 + seed % 2; r = 0.5 + 2*rand(); start = 2*pi*rand()
         card("UNITS", "M", "RAD", "S"); card("GROUND", "BASE"); card("LINK", "TABLE")
         for (i = 1; i <= n; i++) {
            # No change point: the pins stand around a circle.
            x[i] = 3*cos(2*pi*(i + 0.3*rand())/n); y[i] = 2*sin(2*pi*(i + 0.3*rand())/n)
            card("LINK", "C" i)
            card("JOINT", "O" i, "BASE", "C" i, sprintf("%.3f", x[i]), sprintf("%.3f", y[i]))
            card("JOINT", "P" i, "C" i, "TABLE", sprintf("%.3f", x[i] + r*cos(start)), sprintf("%.3f", y[i] + r*sin(start)))
            print "P" i, x[i], y[i], r, start > exact }
         card("DRIVE", "ANGLE", "C1", "", "0.0", "1.0"); card("TIME", "12", "", "", "0.0", "6.2831853")
         card("PRINT", "POINTS"); card("PRINT", "LINKS", "TABLE")
         if (tolerance) card("METHOD", "NEWTON", "", "", "", tolerance)
         print "END" }'
}

# Errors contain what the rounding of the drawing has changed, and all digits that are shown are right.
for seed in $(seq 1 "${N:-8}"); do
   cranks "$seed" 5.0E-3 > "$w/deck"
   "$kinmat" --errors -o "$w/listing" --csv "$w/csv" "$w/deck"
   equal "cranks $seed: status" 0 $?
   # All cranks may be rounded alike.
   grep -q 'IN CHARACTERISTIC LENGTHS: BELOW' "$w/listing" && continue
   equal "cranks $seed: errors contain the closed form" '' "$(awk -F, -v exact="$w/exact" '
      BEGIN { while ((getline line < exact) > 0) { split(line, a, " "); x[a[1]] = a[2]; y[a[1]] = a[3]; r = a[4]; start = a[5] } }
      function far(name, found, true, error) { d = found - true; if (d < 0) d = -d
         if (d > ratio) ratio = d; if (d > error) print name, $3, $5, found, true, error }
      $4 == "POINT" && $5 in x { n++; c = r*cos(start + $3); s = r*sin(start + $3)
         far("x", $6, x[$5] + c, $16); far("y", $7, y[$5] + s, $17)
         far("vx", $9, -s, $19); far("vy", $10, c, $20); far("ax", $12, -c, $22); far("ay", $13, -s, $23) }
      $4 == "LINK" { n++; far("phi", $8, 0, $18); far("vphi", $11, 0, $21); far("aphi", $14, 0, $24) }
      END { if (n < 39) print n " rows" }' "$w/csv" | head -n 3)"
   closure=$(sed -n 's/^ --- NO NUMBER IS KNOWN BETTER.*: *//p' "$w/listing")
   equal "cranks $seed: the closure error, and that of each pin" '' "$(awk -F, -v least="$closure" '
      $4 == "POINT" && $5 ~ /^P/ && $16 + $17 < least { print $5, $16, $17, least }
      END { if (!(least > 1e-10 && least < 5e-3)) print "closure error " least }' "$w/csv")"
   cranks "$seed" '' > "$w/deck"
   "$kinmat" "$w/deck" > "$w/listing"
   equal "cranks $seed: without a tolerance" \
      ' *** REDUNDANT EQUATIONS ARE INCONSISTENT: FOR ROUNDED NUMBERS GIVE METHOD, REAL-2, A CLOSING TOLERANCE' \
      "$(grep INCONSISTENT "$w/listing" | sort -u)"
done

# Exact numbers need no tolerance, and with one they are the same bytes; nor does it bend what does not fit.
for deck in dixon parallel_cranks two_guides; do
   with $deck "$(card METHOD NEWTON '' '' '' 1.0E-2)" > "$w/deck"
   "$kinmat" "$w/deck" | grep -v '^ METHOD' > "$w/listing"
   grep -v '^ METHOD' expected/$deck.lst > "$w/expected"
   same "$deck with a closing tolerance" "$w/expected" "$w/listing"
done
sed 's/^\(LINK    CRANK-3  *\)2\.0/\12.0/; s/^\(POINT   C       COUPLER         \)2\.0/\13.0/' input/parallel_cranks.deck |
   sed 's/^END/METHOD  NEWTON                                  1.0E-2\n&/' > "$w/deck"
equal 'a coupler that does not fit by 1.0' '2  END OF SET 1:  INSTANTS SOLVED 0, FLAGGED 25' \
   "$("$kinmat" "$w/deck" > "$w/listing"; echo "$? $(grep END "$w/listing")")"

with parallel_cranks "$(card METHOD '' '' '' '' 1.0E-3)" > "$w/deck"
equal 'a closing tolerance, and NEWTON by default' 0 "$("$kinmat" "$w/deck" > "$w/listing"; echo $?)"

# boom STROKE1 STROKE2 CARD...: a boom on a cylinder from F (2, -1) to E (1.5, 1), with the boom's bearing at 0
boom() {
   card UNITS M DEG S; card GROUND BASE; card LINK BOOM; card LINK BARREL; card LINK ROD
   card JOINT O BASE BOOM 0.0 0.0; card JOINT F BASE BARREL 2.0 -1.0; card JOINT E ROD BOOM 1.5 1.0
   card CYLINDER F E RAM "$1" "$2"
   shift 2
   printf '%s\n' "$@"
   card END
}
# A table of variants says what its `?` are, of rounding and of the closure error, once below all variants; none without `?`.
for n in 1 3; do
   cranks 1 5.0E-3 | sed -e '/^PRINT/d' -e "s/^DRIVE.*/&\n$(card VARY R2 $n '' 1.0 $([ $n = 1 ] || echo 2.0))/" \
      -e "s/^END/$(card EXTREMES LINKS C1)\n&/" -e "s/^TIME .*/$(card TIME 12 '' '' 0.0 1.0)/" > "$w/deck"
   "$kinmat" --quiet "$w/deck" > "$w/listing"
   equal "$n variants with a closing tolerance" '1 yes' "$(grep -c '^ --- ?: DIGITS LOST TO ROUNDING OR TO THE CLOSURE ERROR$' "$w/listing") \
$(awk '/^ RESULTS/ { on = 1 } on && /[0-9]\?/ { digits = 1 } /^ --- \?/ && digits { print "yes" }' "$w/listing")"
done
sed 's/^END/LANG    PL\n&/' "$w/deck" > "$w/polish.deck"
equal 'variants with a closing tolerance, in Polish' 1 "$("$kinmat" --quiet "$w/polish.deck" | grep -c '^ --- ?: CYFRY UTRACONE PRZEZ ZAOKRAGLENIE LUB BLAD ZAMKNIECIA$')"
boom '' '' "$(card DRIVE ANGLE BOOM '' '' 10.0)" "$(card TIME 6 '' '' 0.0 6.0)" "$(card EXTREMES PAIRS RAM)" |
   sed "s/^JOINT   E.*/&\n$(card VARY R1 3 '' 1.5 1.75)/" > "$w/deck"
equal 'variants without ?' 0 "$("$kinmat" --quiet "$w/deck" | grep -c '^ --- ?:')"

# What is out of range, and methods that take no redundant equations.
for value in 0.02 -1.0E-3 1.0E-11; do
   with parallel_cranks "$(card METHOD NEWTON '' '' '' $value)" | refused "a closing tolerance of $value" \
      "E036 CARD 41 COLUMN 49 FIELD REAL-2: \"$value\" IS OUT OF RANGE; ALLOWED: 1E-10 TO 1E-2"
done
with four_bar "$(card METHOD DENSE '' '' '' 1.0E-3)" |
   refused 'a closing tolerance and METHOD DENSE' 'E087 CARD 40 COLUMN 49 FIELD REAL-2: "1.0E-3" REQUIRES METHOD NEWTON'
# turns STEPS TURNS T0 RATE CARD...: a crank whose run is counted in turns
turns() {
   card UNITS M DEG S; card GROUND BASE; card LINK CRANK; card LINK OTHER
   card JOINT O BASE CRANK 0.0 0.0; card JOINT P BASE OTHER 1.0 0.0
   card DRIVE ANGLE CRANK '' 10.0 "$4"; card TIME "$1" TURNS '' "$3" "$2"
   shift 4
   printf '%s\n' "$@"
   card END
}
other="$(card DRIVE ANGLE OTHER '' 5.0)"
turns 4 1.5 2.0 -45.0 "$other" > "$w/deck"
equal 'one and a half turns: times and angles' '2 -80;5 -215;8 -350;11 -485;14 -620;' \
   "$("$kinmat" --no-listing --csv - "$w/deck" | awk -F, '$4 == "LINK" && $5 == "CRANK" { printf "%.12g %.12g;", $3, $8 }')"
turns 2 0.25 0.0 -90.0 "$other" | sed '/^DRIVE   ANGLE   CRANK/a VARY    R2      LIST            -90.0           45.0            0.0' > "$w/deck"
equal 'turns of a rate that varies' 'E077' "$("$kinmat" --summary - --no-listing "$w/deck" 2>&1 | grep -o 'E077' | sort -u)"
turns 2 0.25 1.0E60 -90.0 "$other" | refused 'turns lost to rounding beside the first time' \
   'E036 CARD 8 COLUMN 33 FIELD REAL-1: "1.0E60" IS OUT OF RANGE; ALLOWED: A TIME THAT THE TURNS CHANGE'
for wrong in "$(card DRIVE ANGLE OTHER '' 5.0 1.0)" "$other
$(card ADD HARMONIC '' '' 1.0 1.0)"; do
   turns 4 1.5 0.0 90.0 "$wrong" > "$w/deck"
   case $wrong in *ADD*) expected=0 ;; *) expected=1 ;; esac
   "$kinmat" "$w/deck" > "$w/out" 2>&1
   equal "turns beside: $wrong" $expected "$(grep -c E077 "$w/out")"
done

# Lengths by the law of cosines: L**2 = |F|**2 + |E|**2 - 2 |F| |E| cos(angle between).
boom 1.8 2.4 "$(card DRIVE ANGLE BOOM '' '' 10.0)" "$(card TIME 6 '' '' 0.0 6.0)" "$(card PRINT PAIRS RAM)" RANGE ASSEMBLY CIRCUITS > "$w/deck"
"$kinmat" -o "$w/out" --csv "$w/csv" "$w/deck"
equal 'a stroke: status' 2 $?
equal 'a stroke: marks' '' "$(awk -F, '$4 == "PAIR" { b = atan2(1, 1.5) + $3*atan2(1, 1)*2/9 - atan2(-1, 2); l = sqrt(5 + 3.25 - 2*sqrt(5*3.25)*cos(b))
   mark = l > 2.4 || l < 1.8 ? "STROKE" : ""; d = $6 - l; if (d*d > 1e-24 || mark != $15) print $3, $6, l, $15 }' "$w/csv")"
equal 'a stroke: RANGE' '  MIN  -8.674586115 DEG   CYLINDER RAM: OUT OF STROKE
  MAX  11.75515298 DEG   CYLINDER RAM: OUT OF STROKE' "$(sed -n '/^ ANGLE BOOM/,/^$/p' "$w/out" | grep -E 'MIN|MAX' | cut -c2-)"
equal 'a stroke: assemblies' '1 1' "$(grep -c '^ ASSEMBLY ' "$w/out") $(sed -n 's/^ --- ASSEMBLIES WITH A CYLINDER.*: //p' "$w/out")"
equal 'a stroke: circuits' ' 1       1       1             TURNS FULLY, CLOSES AFTER 1 TURN' "$(grep 'TURNS FULLY' "$w/out")"
# Two cylinders, drawn 2 long, at an end of their strokes; then beyond an end, which leaves no range.
rams() {
   card UNITS M DEG S; card GROUND BASE; card LINK BOOM; card LINK BARREL; card LINK ROD; card LINK ARM; card LINK BARREL2; card LINK ROD2
   card JOINT O BASE BOOM 0.0 0.0; card JOINT F BASE BARREL 2.0 0.0; card JOINT E ROD BOOM 3.2 1.6; card CYLINDER F E RAM "$1" "$2"
   card JOINT A BOOM ARM 5.0 0.0; card JOINT G BARREL2 BOOM 7.0 0.0; card JOINT H ROD2 ARM 8.2 1.6; card CYLINDER G H RAM2 "$1" "$2"
   card DRIVE SLIDE RAM '' '' 0.1; card DRIVE SLIDE RAM2 '' '' 0.1; card AT '' '' '' 0.0; card RANGE; card END
}
for case in '2.0 2.8 2.000000000 2.800000000' '1.6 2.0 1.600000000 2.000000000' '2.1 2.8 2.100000000 2.100000000' '1.7 1.9 1.900000000 1.900000000'; do
   set -- $case
   rams "$1" "$2" > "$w/deck"
   "$kinmat" "$w/deck" > "$w/out" 2>&1
   equal "ends of strokes $1 $2: RANGE" "RAM $3 RAM $4 RAM RAM2 $3 RAM2 $4 RAM2" "$(awk '/^ SLIDE RAM/ && NF == 2 { printf "%s%s", n++ ? " " : "", $2 }
      /^   (MIN|MAX) / { sub(/:/, "", $5); printf " %s %s", $2, $5 }' "$w/out")"
done
# Strokes that vary: a greatest length of 2.2, 2.4 and 2.75, by the law of cosines; one below the least length has its error.
boom 1.8 2.4 "$(card DRIVE ANGLE BOOM '' '' 10.0)" "$(card TIME 6 '' '' 0.0 6.0)" RANGE |
   sed "s/^CYLINDER.*/&\n$(card VARY R2 LIST '' 2.2 2.4 2.75)\n$(card VARY R2 LIST '' 1.8)/" > "$w/deck"
"$kinmat" --no-listing --summary "$w/csv" "$w/deck" > "$w/out" 2>&1
equal 'strokes that vary' "$(awk 'BEGIN { pi = atan2(0, -1); a = atan2(1, 1.5) - atan2(-1, 2); n = split("2.2 2.4 2.75", most, " ")
   for (k = 1; k <= n; k++) {
      c = (8.25 - most[k]^2)/(2*sqrt(16.25)); limit = (atan2(sqrt(1 - c*c), c) - a)*180/pi
      printf "%d %.9f STROKE;", int(limit/10) + 1, limit
   } print "0 0.000000000 E078;" }')" \
   "$(awk -F, 'NR > 1 { printf "%d %.9f %s;", $4, $13, $8 } END { print "" }' "$w/csv")"
equal 'strokes that vary: their name' CYLINDER.RAM.GREATEST "$(head -n 1 "$w/csv" | cut -d, -f3)"
boom 1.8 2.4 "$(card DRIVE ANGLE BOOM '' '' 10.0)" "$(card AT '' '' '' 0.0)" | sed "s/^CYLINDER.*/&\n$(card TOLER '' '' '' '' 0.1)/" |
   refused 'a tolerance of a stroke' \
      'E046 CARD 10 COLUMN 49 FIELD REAL-2: "0.1" IS A TOLERANCE FOR A FIELD THAT CANNOT HAVE ONE'
# A step over the length 0, with both sides solved, is not made: both eyes at one radius.
through() {
   card UNITS M DEG S; card GROUND BASE; card LINK GATE; card LINK BARREL; card LINK ROD
   card JOINT O BASE GATE 0.0 0.0; card JOINT F BASE BARREL 2.0 0.0; card JOINT E ROD GATE 1.2 1.6
   card CYLINDER F E CYL "$1"; shift
   printf '%s\n' "$@"
   card END
}
through '' "$(card DRIVE SLIDE CYL '' '' -0.3)" "$(card TIME 10 '' '' 0.0 10.0)" RANGE CIRCUITS "$(card LANG PL)" > "$w/deck"
ends 'length 0' 2 "$w/deck"
equal 'length 0: the limit' 1 "$(grep -c 'SILOWNIK CYL: DLUGOSC 0, DLA SUWU PRZEZ 0 UZYJ PRISM' "$w/out" | awk '{ print ($1 > 0) }')"
equal 'length 0: RANGE and circuits' '0.000000000 4.000000000' "$(awk '/ZAKRES(Y)? / { on = 1 } on && /^   (MIN|MAX)/ { printf "%s ", $2 }' "$w/out" | sed 's/ $//')"
through '' "$(card DRIVE SLIDE CYL '' -0.5 0.1)" "$(card AT '' '' '' 0.0)" | refused 'a law that begins below 0' \
   'E109 CARD 10 COLUMN 17 FIELD LABEL-B: "CYL" THE CYLINDER BEGINS AT A LENGTH OF 0 OR LESS: FOR A SLIDE THROUGH 0 USE PRISM'
# A barrel that points away from the boom's circle: no position but with a length below 0.
boom '' '' "$(card DRIVE ANGLE BARREL '' 180.0)" "$(card AT '' '' '' 0.0)" > "$w/deck"
equal 'only lengths below 0' ' *** NO POSITION FOUND
 *** CYLINDER RAM: ONLY LENGTHS BELOW 0, FOR A SLIDE THROUGH 0 USE PRISM' "$("$kinmat" "$w/deck" | grep '[*][*][*]')"
# proof: whether the first assembly of a listing is PROVED or NOT PROVED
proof() { sed -n 's/^ ASSEMBLY 1 .*DETERMINANTS [-+]*  *\([A-Z ]*PROVED\).*/\1/p'; }
# near_zero Y: bars of 1 and 1 with feet 2 - 1E-12 apart hold B at h = 1E-6, which 4 roundings of the numbers move by 1E-8. A rod
# follows B, and its cylinder has the length h - Y.
near_zero() {
   card UNITS M DEG S; card GROUND BASE; card LINK CRANK; card LINK ONE; card LINK TWO; card LINK ROD
   card JOINT A0 BASE CRANK -1.0; card JOINT A CRANK ONE 0.0 0.0; card JOINT B ONE TWO 1.0 0.3; card JOINT D TWO BASE 1.999999999999
   card LENGTH A B '' 1.0; card LENGTH D B '' 1.0
   card POINT P BASE '' 2.0 "$1"; card POINT Q ROD '' 2.0 0.3; card POINT S ROD '' 1.0 0.3
   card CYLINDER P Q RAM; card SLOT S B GROOVE; card DRIVE ANGLE CRANK '' 0.0 1.0; card AT '' '' '' 0.0; card ASSEMBLY; card END
}
for case in '0.5E-6:PROVED 1' '0.99E-6:NOT PROVED 1' '1.01E-6:NOT PROVED 1' '1.5E-6: 2'; do
   near_zero "${case%%:*}" > "$w/deck"
   "$kinmat" "$w/deck" > "$w/out" 2>&1
   equal "a proved ball and the length 0: ${case%%:*}" "${case#*:}" \
      "$(proof < "$w/out") $(sed -n 's/^ --- ASSEMBLIES WITH A CYLINDER.*: //p' "$w/out")"
   equal "no stroke, no mark: ${case%%:*}" 0 "$(grep -c 'PROVED.*OUT OF STROKE' "$w/out")"
done
# The digits of a deck leave 1E-10 uncertain: so short a length may be 0, though its position is proved.
for case in '0.99999999995 NOT PROVED' '0.9999999995 PROVED'; do
   { card UNITS M DEG S; card GROUND BASE; card LINK CRANK; card LINK BARREL; card LINK ROD; card JOINT O BASE CRANK 0.0 0.0
      card JOINT B ROD CRANK 1.0 0.0; card JOINT C BASE BARREL "${case%% *}" 0.0; card CYLINDER C B RAM
      card DRIVE ANGLE BARREL '' 0.0 1.0; card AT '' '' '' 0.0; card ASSEMBLY; card END; } > "$w/deck"
   equal "a length of 1 - ${case%% *}" "${case#* }" "$("$kinmat" "$w/deck" | proof)"
done
through 2.0 "$(card DRIVE SLIDE CYL '' '' 0.1)" "$(card AT '' '' '' 0.0)" > "$w/deck"
equal 'a drawing out of its stroke' 1 "$("$kinmat" --check "$w/deck" 2>&1 | grep -c 'IS DRAWN OUT OF STROKE')"
for stroke in '0.0 2.4 33 1 0.0' '1.8 -2.4 49 2 -2.4'; do
   set -- $stroke
   boom "$1" "$2" "$(card DRIVE ANGLE BOOM '' '' 10.0)" "$(card AT '' '' '' 0.0)" | refused "a stroke $1 $2" \
      "E036 CARD 9 COLUMN $3 FIELD REAL-$4: \"$5\" IS OUT OF RANGE; ALLOWED: ABOVE 0.0"
done
boom '' '' "$(card DRIVE ANGLE BOOM '' '' 10.0)" "$(card TIME 4 TURN '' 0.0 1.0)" |
   refused 'a word on TIME' 'E070 CARD 11 COLUMN 17 FIELD LABEL-B: "TURN" IS NOT ONE OF TURNS'
boom 2.4 1.8 "$(card DRIVE ANGLE BOOM '' '' 10.0)" "$(card AT '' '' '' 0.0)" | refused 'a stroke the other way round' \
   'E078 CARD 9 COLUMN 49 FIELD REAL-2: "1.8" IS NOT ABOVE THE LEAST LENGTH: GIVE THE LEAST LENGTH FIRST'
conclude
