#!/bin/sh
# Cards PRINT RATIOS and COLUMN. Ratios are velocities and accelerations of runs in which one drive has the rate 1 and the
# others rest; times the rates of the drives they are the velocities of the run itself: in decks of input/ and in random
# mechanisms. The table of COLUMN has the numbers of the other tables.
. tests/counting.sh

# A ratio may differ by rounding: parts of the greatest value of its kind, or, in random mechanisms, which may be near a
# dead point, what --errors tells of all numbers that are compared.
tolerance=1e-12

# one_set: the cards of the first set that make its mechanism and its instants, with all rows
one_set() {
   awk '/^END/ { print "PRINT   ALL"; print "PRINT   RATIOS"; print; exit }
      /^(PRINT|EXTREMES|RANGE|CIRCUITS|ASSEMBLY|PROVE|POLE|CURVE|TOLER|COLUMN|BRANCH)/ { next }
      /^VARY/ { next } { print }' "$1"
}

# unit_drive K VALUES: the mechanism with these values of the drives at the only instant, of which drive K has the rate 1
unit_drive() {
   awk -v k="$1" -v values="$2" 'BEGIN { split(values, value, ",") }
      /^(GROUND|LINK|POINT|JOINT|REVOLUTE|PRISM|CYLINDER|UNITS|DISTANCE|LINE|ANGLE|XI|ETA|SUM)/ { print; on = 1; next }
      /^DRIVE/ { c = substr($0, 25, 8); if (c ~ /^RPM/) c = ""
         printf "%-24s%s\n", substr($0, 1, 24), c
         printf "%-8s%24s%24s%24s\n", "*", value[++n], n == k ? "1.0" : "0.0", "0.0"; on = 0; next }
      /^[*]/ { if (on) print; next }
      /^END/ { print "AT                              0.0"; print "PRINT   ALL"; print; exit }
      { on = 0 }' "$3"
}

# The rows of pairs and measures at instant 0, and the ratios: name, velocity, acceleration.
numbers() { awk -F, -v kinds="$1" '$2 == 0 && $4 ~ kinds { print $5 "," $6 "," $9 "," $12 }' "$2"; }

# against_unit_runs NAME DECK: at the first instant
against_unit_runs() {
   one_set "$2" > "$w/own.deck"
   "$kinmat" "$w/own.deck" --quiet --no-listing --csv "$w/own.csv" --table "$w/own.table" 2> "$w/err"
   numbers '^RATIO$' "$w/own.csv" > "$w/ratios"
   drives=$(awk '/^DRIVE/ { n++ } /^END/ { exit } END { print n }' "$w/own.deck")
   values=$(awk -F, -v n="$drives" 'NR == 2 { for (i = 2; i <= n + 1; i++) printf "%s,", $i }' "$w/own.table")
   : > "$w/units"
   k=1
   while [ $k -le "$drives" ]; do
      name=$(awk -v k=$k '/^DRIVE/ && ++n == k { a = substr($0, 9, 8); b = substr($0, 17, 8); c = substr($0, 25, 8)
         gsub(/ /, "", a); gsub(/ /, "", b); gsub(/ /, "", c); print a " " b (c != "" && c != "RPM" ? " " c : ""); exit }' "$w/own.deck")
      unit_drive $k "$values" "$w/own.deck" > "$w/unit.deck"
      "$kinmat" "$w/unit.deck" --quiet --no-listing --csv "$w/unit.csv" 2>> "$w/err"
      numbers '^(PAIR|MEASURE)$' "$w/unit.csv" | awk -F, -v by="$name" '{ print $1 " BY " by "," $3 "," $4 }' >> "$w/units"
      k=$((k + 1))
   done
   equal "$1: ratios and unit runs" 'agree' "$(awk -F, -v e=$tolerance '
      function off(a, b, most) { a -= b; if (a < 0) a = -a; return a > e*(most > 1 ? most : 1) }
      NR == FNR { v[$1] = $2; a[$1] = $3
         if ($2 < 0) $2 = -$2; if ($3 < 0) $3 = -$3; if ($2 > mv) mv = $2; if ($3 > ma) ma = $3; next }
      { n++; seen[$1] = 1; if ($2 == "") bad = bad " " $1 ": NONE"; else if (off($2, v[$1], mv) || off($3, a[$1], ma)) bad = bad " " $1 }
      # What has no row is not moved.
      END { for (i in v) if (!(i in seen) && (off(v[i], 0, mv) || off(a[i], 0, ma))) bad = bad " no " i
         print (n > 0 && bad == "" ? "agree" : "differ:" bad " of " n) }' "$w/units" "$w/ratios")"
}

# against_velocities NAME DECK: at all instants; with one drive also the accelerations
against_velocities() {
   one_set "$2" > "$w/own.deck"
   "$kinmat" "$w/own.deck" --quiet --no-listing --errors --csv "$w/own.csv" 2> "$w/err"
   equal "$1: ratios times rates" 'agree' "$(awk -F, -v e=$tolerance '
      function rate(d, k,   p, r) { split(d, p, " ")
         if (p[1] == "ANGLE") return f["LINK," p[2], "phi", k]
         if (p[1] == "RELANGLE") { r = f["LINK," p[2], "phi", k]; return f["LINK," p[3], "phi", k] + (k > 2 ? r : -r) }
         if (p[1] == "X") return f["POINT," p[2], "x", k]
         if (p[1] == "Y") return f["POINT," p[2], "y", k]
         return f["PAIR," p[2], "x", k] }
      function size(a) { return a < 0 ? -a : a }
      # Of an instant with a flag not all rates are there.
      function judge(  i, p, d, q, v, a, vo, ao, sum, second, most, most2) {
         if (flagged) split("", ratio)
         for (i in ratio) { split(i, p, " BY "); q = p[1]; d = p[2]; drives[q]++
            v = rate(d, 1); a = rate(d, 2); vo = size(rate(d, 3)); ao = size(rate(d, 4))
            sum[q] += ratio[i]*v; second[q] += derivative[i]*v^2 + ratio[i]*a
            most[q] += e*size(ratio[i]*v) + off1[i]*size(v) + size(ratio[i])*vo
            most2[q] += e*(size(derivative[i]*v^2) + size(ratio[i]*a)) + off2[i]*v^2 + 2*size(derivative[i]*v)*vo \
               + off1[i]*size(a) + size(ratio[i])*ao }
         for (q in sum) { n++
            if (size(sum[q] - velocity[q]) > most[q] + open1[q]) bad = bad " " q "@" step
            if (drives[q] == 1 && size(second[q] - acceleration[q]) > most2[q] + open2[q]) bad = bad " " q "@@" step }
         split("", ratio); split("", f); split("", velocity); split("", drives); flagged = 0 }
      NR == 1 { next }
      $2 != step { judge(); step = $2 }
      $15 != "" { flagged = 1; next }
      $4 == "RATIO" { ratio[$5] = $6; derivative[$5] = $9; off1[$5] = $16; off2[$5] = $19; next }
      { f[$4 "," $5, "x", 1] = $9; f[$4 "," $5, "y", 1] = $10; f[$4 "," $5, "phi", 1] = $11
        f[$4 "," $5, "x", 2] = $12; f[$4 "," $5, "y", 2] = $13; f[$4 "," $5, "phi", 2] = $14
        f[$4 "," $5, "x", 3] = $19; f[$4 "," $5, "y", 3] = $20; f[$4 "," $5, "phi", 3] = $21
        f[$4 "," $5, "x", 4] = $22; f[$4 "," $5, "y", 4] = $23; f[$4 "," $5, "phi", 4] = $24 }
      $4 == "PAIR" || $4 == "MEASURE" { velocity[$5] = $9; acceleration[$5] = $12; open1[$5] = $19; open2[$5] = $22 }
      END { judge(); print (n > 0 && bad == "" ? "agree" : "differ:" bad " of " n) }' "$w/own.csv")"
}

for deck in four_bar crank_slider whitworth andrews five_bar pantograph two_loops xy_table three_rrr three_rrr_cranks \
   excavator ten_plates drawn_cylinder cylinder jansen boom leverage jacobian; do
   against_unit_runs "$deck" "input/$deck.deck"
   against_velocities "$deck" "input/$deck.deck"
done
# Of seed 245 lengths are a million times as large as angles.
for seed in $(seq "${SEED:-1}" $((${SEED:-1} + ${N:-12} - 1))) 245; do
   "$BUILD/release/fuzz_mechanisms" --deck "$seed" "$w/$seed.deck" > /dev/null || continue
   against_velocities "random mechanism $seed" "$w/$seed.deck"
done

# column N FILE: the words of column N of the table over the instants
lines() { awk '/^ RESULTS/ { on = 1 } /^ (EXTREMES|CONTINUATION)/ { on = 0 } on && $1 ~ /^[0-9.]+[*]?$/' "$1"; }
# ratio_of NAME FILE: the values and derivatives of a ratio in a CSV
ratio_of() { awk -F, -v name="$1" '$4 == "RATIO" && $5 == name { print $6, $9 }' "$2"; }

# The boom of input/, whose columns closed forms print in expected/. The laws do not matter: at rest the ratios are
# the same numbers, and by other methods.
ratio='AXLE BY SLIDE RAM'
sed "s/^END/$(card PRINT RATIOS AXLE)\n&/" input/boom.deck > "$w/boom.deck"
"$kinmat" "$w/boom.deck" -o "$w/boom.lst" --csv "$w/boom.csv" --table "$w/boom.table"
sed '/^DRIVE/s/ 0.5$/ 0.0             0.5/' "$w/boom.deck" > "$w/rest.deck"
"$kinmat" "$w/rest.deck" --no-listing --csv "$w/rest.csv"
equal 'boom: at rest' "$(ratio_of "$ratio" "$w/boom.csv" | head -n 1)" "$(ratio_of "$ratio" "$w/rest.csv" | head -n 1)"
for method in DENSE MATRIX; do
   { echo "METHOD  $method"; cat "$w/boom.deck"; } > "$w/method.deck"
   "$kinmat" "$w/method.deck" -o "$w/method.lst"
   equal "boom: METHOD $method" "$(lines "$w/boom.lst")" "$(lines "$w/method.lst")"
done

# The table of COLUMN has the digits of PRINT, and --table the same columns; EXTREMES of a ratio are those of its values here,
# which fall or rise all the way.
equal 'boom: columns and rows' "$(awk '/^ AXLE BY/ { print $5, $6 }' "$w/boom.lst")" \
   "$(lines "$w/boom.lst" | awk '{ print $5, $6 }')"
equal 'boom: --table' 't,SLIDE.RAM,AXLE.theta,HEIGHT.s,AXLE.by.SLIDE.RAM,AXLE.by.SLIDE.RAM.d,HEIGHT.by.SLIDE.RAM' \
   "$(head -n 1 "$w/boom.table")"
equal 'boom: --table and CSV' "$(ratio_of "$ratio" "$w/boom.csv")" "$(awk -F, 'NR > 1 { print $5, $6 }' "$w/boom.table")"
equal 'boom: extremes' "$(lines "$w/boom.lst" | awk 'NR == 1 { print $5, $6 } { last = $5 " " $6 } END { print last }')" \
   "$(awk '/^ EXTREMES   T/ { on = 1 } on && /^  M(IN|AX)/ { print $2, $3 }' "$w/boom.lst")"
sed '/^PRINT/d; /^EXTREMES/d' "$w/boom.deck" > "$w/alone.deck"
"$kinmat" "$w/alone.deck" -o "$w/alone.lst"
equal 'COLUMN alone: no other table' "$(lines "$w/boom.lst")" "$(lines "$w/alone.lst")"
equal 'COLUMN alone: no instants' 0 "$(grep -c INSTANT "$w/alone.lst" | tr -d ' ' | sed 's/^1$/0/')"

# A flag is * behind T; its words stand below the table, or at the instant where PRINT has one.
cat > "$w/limit.deck" <<'LAST'
UNITS   M       DEG     S
GROUND  BASE
LINK    CRANK
LINK    COUPLER
LINK    ROCKER
JOINT   A0      BASE    CRANK   0.0             0.0
JOINT   A       CRANK   COUPLER 1.2             1.6
JOINT   B       COUPLER ROCKER  2.4             2.5
JOINT   B0      ROCKER  BASE    4.0             0.0
DRIVE   ANGLE   CRANK                           10.0
TIME    6                       0.0             6.0
COLUMN  PAIRS   B
COLUMN  RATIOS  A0
COLUMN  RATIOS  B
END
LAST
"$kinmat" "$w/limit.deck" > "$w/limit.lst"
equal 'flags: status' 2 $?
equal 'flags: stars' '4.000000* 5.000000* 6.000000*' "$(lines "$w/limit.lst" | awk '$1 ~ /[*]/ { printf "%s%s", sep, $1; sep = " " }')"
equal 'flags: what is not known, and what is' 'NONE 1.000000 NONE' "$(lines "$w/limit.lst" | awk 'END { print $3, $4, $5 }')"
equal 'flags: words below the table' ' *** NO POSITION: BEYOND THE LIMIT OF MOTION AT T = 3.674275 S' \
   "$(sed -n '/^ *6.000000[*]/,$p' "$w/limit.lst" | grep '[*][*][*] NO')"
{ sed '$d' "$w/limit.deck"; card PRINT PAIRS B; echo END; } > "$w/printed.deck"
"$kinmat" "$w/printed.deck" > "$w/printed.lst"
equal 'flags with PRINT' ' --- *: INSTANT FLAGGED, SEE ABOVE' "$(grep -e '^ --- [*]' "$w/printed.lst")"

# Without numbers on its LINK card x and y of a link are no question of EXTREMES LINKS; a card with its name or a COLUMN card
# asks for them. asked CARD...: the heads of the extremes of links
asked() {
   { sed "/^COLUMN/d; \$d; s/^TIME.*/$(card TIME 6 '' '' 0.0 3.0)/" "$w/limit.deck"; printf '%s\n' "$@"
     echo END; } > "$w/axes.deck"
   "$kinmat" "$w/axes.deck" > "$w/axes.lst"
   awk '/^ EXTREMES   T/ { on = 1 } on && /^ LINK/ { $1 = $1; print; exit }' "$w/axes.lst"
}
all='LINK X Y PHI VX VY VPHI AX AY APHI'
equal 'axes that nobody placed' 'LINK PHI VPHI APHI' "$(asked "$(card EXTREMES LINKS)")"
equal 'a column asks for x' "$all" "$(asked "$(card EXTREMES LINKS)" "$(card COLUMN LINKS ROCKER X)")"
equal 'a name asks for x' "$all" "$(asked "$(card EXTREMES LINKS)" "$(card EXTREMES LINKS ROCKER)")"
asked "$(card EXTREMES ALL)" "$(card COLUMN LINKS ROCKER VPHI)" > "$w/heads"
equal 'EXTREMES ALL with COLUMN: only those' '1 2' "$(awk '/^ EXTREMES   T/ { on = 1 }
   on && /^ (LINK|PAIR|POINT)/ { kinds++ } on && /^  M(IN|AX)/ { n += NF } END { print kinds, n/2 }' "$w/axes.lst")"

# More columns than a line has room for.
{ sed '/^COLUMN/d; $d' "$w/limit.deck"; for quantity in X Y VX VY AX AY; do card COLUMN POINTS A $quantity; card COLUMN POINTS B $quantity; done
   echo END; } > "$w/wide.deck"
"$kinmat" "$w/wide.deck" > "$w/wide.lst"
equal 'wide: two tables of 7 instants' 14 "$(lines "$w/wide.lst" | wc -l | tr -d ' ')"
equal 'wide: at most 120 columns' 0 "$(awk 'length > 120' "$w/wide.lst" | wc -l | tr -d ' ')"

# bad SENTENCE CARD...: an error
bad() {
   words=$1
   shift
   { sed '$d' "$w/limit.deck"; card "$@"; echo END; } | refused "$*" "$words"
}
bad 'E070 CARD 15 COLUMN 9 FIELD LABEL-A: "FOO" IS NOT ONE OF LINKS, POINTS, PAIRS, MEASURES, RATIOS' COLUMN FOO B
bad 'E034 CARD 15 COLUMN 17 FIELD LABEL-B: THE FIELD IS BLANK: FILL IT IN' COLUMN PAIRS
bad 'E053 CARD 15 COLUMN 17 FIELD LABEL-B: "Q" IS NOT THE NAME OF A PAIR' COLUMN PAIRS Q
bad 'E055 CARD 15 COLUMN 17 FIELD LABEL-B: "Q" IS NOT THE NAME OF A PAIR OR MEASURE' COLUMN RATIOS Q
bad 'E070 CARD 15 COLUMN 25 FIELD LABEL-C: "PHI" IS NOT ONE OF X, Y, VX, VY, AX, AY' COLUMN POINTS A PHI
bad 'E070 CARD 15 COLUMN 25 FIELD LABEL-C: "X" IS NOT ONE OF VALUE, VVALUE, AVALUE' COLUMN PAIRS A X
bad 'E070 CARD 15 COLUMN 25 FIELD LABEL-C: "AVALUE" IS NOT ONE OF VALUE, DERIV' COLUMN RATIOS A AVALUE
bad 'E096 CARD 15 COLUMN 17 FIELD LABEL-B: "B" IS REPEATED; FIRST ON CARD 12' COLUMN PAIRS B VALUE
{ sed '$d' "$w/limit.deck" | sed '/^COLUMN/d; /^JOINT   B /d'
   echo 'DRIVE   RELANGLECRANK   COUPLER 0.0             1.0'; echo 'DRIVE   ANGLE   ROCKER                          1.0'; card EXTREMES RATIOS A; echo END; } |
   refused 'several drives' \
      'E066 CARD 13 COLUMN 17 FIELD LABEL-B: "A" HAS SEVERAL DRIVES: EXTREMES OF ITS RATIOS ARE NOT SEARCHED'
# Two drives: the upper arm is not moved by the angle of the lower one, and has no column for it.
sed '/^PRINT/d; /^END/d' input/jacobian.deck > "$w/columns.deck"
{ card COLUMN PAIRS SHOULDER; card COLUMN RATIOS SHOULDER; card COLUMN RATIOS X-HAND; echo END; } >> "$w/columns.deck"
equal 'columns of what a drive moves' 'ANGLE.UPPER,RELANGLE.UPPER.FORE,SHOULDER.theta,SHOULDER.by.ANGLE.UPPER,X-HAND.by.ANGLE.UPPER,X-HAND.by.RELANGLE.UPPER.FORE' \
   "$("$kinmat" --no-listing --table - "$w/columns.deck" | head -n 1 | cut -d, -f2-)"
conclude
