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

# What is out of range, and methods that take no redundant equations.
for value in 0.02 -1.0E-3 1.0E-11; do
   with parallel_cranks "$(card METHOD NEWTON '' '' '' $value)" > "$w/deck"
   equal "a closing tolerance of $value" "E036  CARD 41  COLUMN 49  FIELD REAL-2: \"$value\" IS OUT OF RANGE; ALLOWED: 1E-10 TO 1E-2" \
      "$("$kinmat" "$w/deck" 2>&1 | sed -n 's/.*\*\*\* E036/E036/p' | head -n 1)"
done
with four_bar "$(card METHOD DENSE '' '' '' 1.0E-3)" > "$w/deck"
equal 'a closing tolerance and METHOD DENSE' 'COLUMN 49  FIELD REAL-2: "1.0E-3" REQUIRES METHOD NEWTON' \
   "$("$kinmat" "$w/deck" 2>&1 | sed -n 's/.*E087  CARD [0-9]*  //p' | head -n 1)"
conclude
