#!/bin/sh
# Cards PRINT RATIOS and COLUMN. Ratios are velocities and accelerations of runs in which one drive has the rate 1 and the
# others rest; times the rates of the drives they are the velocities of the run itself: in decks of input/ and in random
# mechanisms. Closed forms of a boom and of an arm. The table of COLUMN has the numbers of the other tables.
. tests/counting.sh

# A ratio may differ by rounding, which grows in a mechanism near a dead point: parts of the greatest value of its kind.
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
   "$kinmat" "$w/own.deck" --quiet --no-listing --csv "$w/own.csv" 2> "$w/err"
   equal "$1: ratios times rates" 'agree' "$(awk -F, -v e=$tolerance '
      function rate(d, k,   p, r) { split(d, p, " ")
         if (p[1] == "ANGLE") return f["LINK," p[2], "phi", k]
         if (p[1] == "RELANGLE") return f["LINK," p[3], "phi", k] - f["LINK," p[2], "phi", k]
         if (p[1] == "X") return f["POINT," p[2], "x", k]
         if (p[1] == "Y") return f["POINT," p[2], "y", k]
         return f["PAIR," p[2], "x", k] }
      function size(a) { return a < 0 ? -a : a }
      # Of an instant with a flag not all rates are there.
      function judge(  i, p, d, q, sum, second, most, most2) {
         if (flagged) split("", ratio)
         for (i in ratio) { split(i, p, " BY "); q = p[1]; d = p[2]
            sum[q] += ratio[i]*rate(d, 1); most[q] += size(ratio[i]*rate(d, 1)); drives[q]++
            second[q] += derivative[i]*rate(d, 1)^2 + ratio[i]*rate(d, 2)
            most2[q] += size(derivative[i]*rate(d, 1)^2) + size(ratio[i]*rate(d, 2)) }
         for (q in sum) { n++
            if (size(sum[q] - velocity[q]) > e*(1 + most[q])) bad = bad " " q "@" step
            if (drives[q] == 1 && size(second[q] - acceleration[q]) > e*(1 + most2[q])) bad = bad " " q "@@" step }
         split("", ratio); split("", f); split("", velocity); split("", drives); flagged = 0 }
      NR == 1 { next }
      $2 != step { judge(); step = $2 }
      $15 != "" { flagged = 1; next }
      $4 == "RATIO" { ratio[$5] = $6; derivative[$5] = $9; next }
      { f[$4 "," $5, "x", 1] = $9; f[$4 "," $5, "y", 1] = $10; f[$4 "," $5, "phi", 1] = $11
        f[$4 "," $5, "x", 2] = $12; f[$4 "," $5, "y", 2] = $13; f[$4 "," $5, "phi", 2] = $14 }
      $4 == "PAIR" || $4 == "MEASURE" { velocity[$5] = $9; acceleration[$5] = $12 }
      END { judge(); print (n > 0 && bad == "" ? "agree" : "differ:" bad " of " n) }' "$w/own.csv")"
}

for deck in four_bar crank_slider whitworth andrews five_bar pantograph two_loops xy_table three_rrr three_rrr_cranks \
   excavator ten_plates drawn_cylinder cylinder jansen; do
   against_unit_runs "$deck" "input/$deck.deck"
   against_velocities "$deck" "input/$deck.deck"
done
for seed in $(seq "${SEED:-1}" $((${SEED:-1} + ${N:-12} - 1))); do
   "$BUILD/release/fuzz_mechanisms" --deck "$seed" "$w/$seed.deck" > /dev/null || continue
   against_velocities "random mechanism $seed" "$w/$seed.deck"
done
conclude
