#!/bin/sh
# The cards DISTANCE, LINE, ANGLE, XI, ETA and SUM: tables against closed forms in real128, by all methods; a deck that is
# turned, moved or in other units; directions over whole turns, alone and in lanes; points that meet; where rows appear;
# what is refused.
. tests/counting.sh

# measured FILE: the rows of measures in a CSV: t, name, mark, values
measured() { awk -F, '$4 == "MEASURE" { print $3, $5, $15, $6, $9, $12 }' "$1"; }
# near A B TOLERANCE: how many numbers of two files of measures there are, and the first that differs by more than a part
# of the largest of its column; of the second file lengths are so many times as large
near() {
   awk -v scale="${4:-1}" -v part="$3" -v angles="BA BB0 MU RESERVE TURN DIRPO BACK" '
      BEGIN { split(angles, list, " "); for (i in list) is_angle[list[i]] }
      NR == FNR { row[FNR] = $0; n++; for (i = 3; i <= NF; i++) if ($i ~ /[0-9]/) { x = $i < 0 ? -$i : $i; k = $2 " " (NF - i)
         if (x > most[k]) most[k] = x }; next }
      { split(row[FNR], a, " ")
        if (a[2] != $2) { print "rows differ: " $0; exit }
        factor = $2 in is_angle ? 1 : scale
        for (i = 3; i <= NF; i++) {
           if ($i !~ /[0-9]/) { if ($i != a[i]) print "words differ: " $0; continue }
           count++
           x = a[i] - $i/factor
           if (x < 0) x = -x
           if (x > part*(most[$2 " " (NF - i)] + 1e-3)) { print "numbers differ: " row[FNR] " / " $0; exit } } }
      END { print count " numbers" }' "$1" "$2"
}

# By METHOD DENSE and METHOD MATRIX: the bytes of the closed forms but for the cards and the count of steps.
rows() { awk '/^ (INSTANT|CHWILA) / { on = 1 } /^ (EXTREMES  |CONTINUATION:|KONTYNUACJA:|END OF|KONIEC)/ { exit } on && NF' "$1"; }
for deck in transmission geneva points_meet; do
   rows expected/$deck.lst > "$w/expected"
   # METHOD MATRIX does not find all positions of the first.
   for method in DENSE $([ $deck = transmission ] || echo MATRIX); do
      with $deck "$(card METHOD $method)" | grep -v '^EXTREMES' > "$w/deck"
      "$kinmat" "$w/deck" > "$w/listing" 2>&1
      rows "$w/listing" > "$w/rows"
      same "$deck, METHOD $method" "$w/expected" "$w/rows"
   done
done

# Moved, turned by 37 degrees, in kilometres and in millimetres: the same measures. A direction turns by 37 degrees.
"$kinmat" --no-listing --csv "$w/csv" input/transmission.deck
measured "$w/csv" > "$w/first"
# changed SCALE ANGLE DX DY
changed() {
   awk -v scale="$1" -v angle="$2" -v dx="$3" -v dy="$4" '
      BEGIN { c = cos(angle*atan2(1, 1)/45); s = sin(angle*atan2(1, 1)/45) }
      /^JOINT/ { x = substr($0, 33, 16); y = substr($0, 49, 16)
         printf "%s\n*       %24.16E%24.16E\n", substr($0, 1, 32), scale*(c*x - s*y + dx), scale*(s*x + c*y + dy); next }
      { print }' input/transmission.deck
}
for change in '1000 0 0 0' '0.001 0 0 0' '1 0 7 -3' '1000 37 2 5' '1 37 0 0'; do
   set -- $change
   changed $change > "$w/deck"
   "$kinmat" --no-listing --csv "$w/csv" "$w/deck"
   measured "$w/csv" | awk -v angle="$2" '$2 ~ /^B/ { $3 = sprintf("%.15g", $3 - angle + ($3 - angle <= -180 ? 360 : 0)) } { print }' > "$w/changed"
   equal "scaled, turned and moved by $change" '195 numbers' "$(near "$w/first" "$w/changed" 1e-12 "$1")"
done

# A crank over three turns and more; a bar of its own direction, and the angle between them: alone, at each of 16 and more
# variants in lanes, by several processes, in steps that end elsewhere. phi and LINE are the same angle.
turning() {
   cat <<DECK
UNITS   M       DEG     S
GROUND  BASE
LINK    CRANK
LINK    ROD
LINK    BLOCK
JOINT   O       BASE    CRANK   0.0             0.0
JOINT   A       CRANK   ROD     1.0             0.0
JOINT   B       ROD     BLOCK   3.0             0.0
POINT   G       BASE
POINT   C       BLOCK           3.0             0.0
PRISM   G       C       GUIDE   0.0             0.0             0.0
LINE    O       A       OA
LINE    A       B       AB
ANGLE   OA      AB      GAMMA
ANGLE   CRANK   ROD     GLINKS
DECK
}
{ turning; card DRIVE ANGLE CRANK '' '' 120.0; card TIME 40 '' '' 0.0 10.0; card PRINT ALL '' 40; echo END; } > "$w/turns.deck"
"$kinmat" --no-listing --csv "$w/csv" "$w/turns.deck"
equal 'LINE over three turns' '1200.000000 1200.000000 -1200.000000' "$(awk -F, '$2 == 40 && $5 == "OA" { a = $6 }
   $2 == 40 && $5 == "CRANK" { b = $8 } $2 == 40 && $5 == "AB" { c = $6 } $2 == 40 && $5 == "GAMMA" { d = $6 }
   END { printf "%.6f %.6f %.6f\n", a, b, d - c }' "$w/csv")"
# So do instants that no card prints, and instants of AT.
{ turning; card DRIVE ANGLE CRANK '' '' 120.0; card TIME 400 '' '' 0.0 10.0; card PRINT ALL '' 400; echo END; } > "$w/fine.deck"
"$kinmat" --no-listing --csv "$w/fine.csv" "$w/fine.deck"
equal 'in ten times as many steps' '24 numbers' "$(measured "$w/csv" > "$w/a"; measured "$w/fine.csv" > "$w/b"; near "$w/a" "$w/b" 1e-13)"
{ turning; card DRIVE ANGLE CRANK '' '' 120.0; card AT '' '' '' 0.0 0.75 1.5; card AT '' '' '' 2.25 3.0 3.75
   card AT '' '' '' 3.0 2.25; card PRINT MEASURES OA; echo END; } > "$w/at.deck"
"$kinmat" --no-listing --csv "$w/at.csv" "$w/at.deck"
equal 'AT cards in their order' '0 90 180 270 360 450 360 270' "$(measured "$w/at.csv" | awk '{ printf "%s%.0f", sep, $3; sep = " " }')"
# A direction of -180 degrees is 180 at the first instant. A set begins anew.
{ turning; card DRIVE ANGLE CRANK '' -180.0 90.0; card TIME 2 '' '' 0.0 2.0; card PRINT MEASURES OA; echo END
   turning; card DRIVE ANGLE CRANK '' 350.0 90.0; card TIME 2 '' '' 0.0 2.0; card PRINT MEASURES OA; echo END; } > "$w/begin.deck"
"$kinmat" --no-listing --csv "$w/begin.csv" "$w/begin.deck"
equal 'at the first instant' '180 270 360 -10 80 170' "$(measured "$w/begin.csv" | awk '{ printf "%s%.0f", sep, $3; sep = " " }')"
# Over change points, also those at which an instant stands and has no velocities: directions of points of two links, in a
# linkage whose change points are passed, count turns as the angle of their link does.
for deck in antiparallelogram_across antiparallelogram_at parallelogram_at; do
   with $deck "$(card LINE A0 A-CR OA; card LINE B0 B-RO OB; card ANGLE OA OB OAB; card PRINT MEASURES)" | sed -e 's/^POINT   B-RO /&/' > "$w/deck"
   "$kinmat" --no-listing --csv "$w/csv" "$w/deck"
   equal "$deck: directions over change points" '0 off' "$(awk -F, '$5 == "CRANK" && $4 == "LINK" { crank[$2] = $8 } $5 == "ROCKER" { rocker[$2] = $8 }
      $5 == "OA" { a[$2] = $6 } $5 == "OB" { b[$2] = $6 } $5 == "OAB" { ab[$2] = $6 }
      END { for (k in a) { n++; x = a[k] - crank[k]; y = b[k] - rocker[k] - b[0] + rocker[0]; z = ab[k] - b[k] + a[k] - ab[0] + b[0] - a[0]
         if (x*x + y*y + z*z > 1e-10) off++ } if (n < 10) print n " instants"; print off + 0 " off" }' "$w/csv")"
done
# Backwards.
{ turning; card DRIVE ANGLE CRANK '' '' -120.0; card TIME 30 '' '' 0.0 10.0; card PRINT MEASURES '' 30; echo END; } > "$w/back.deck"
"$kinmat" --no-listing --csv "$w/back.csv" "$w/back.deck"
equal 'backwards' '-1200' "$(measured "$w/back.csv" | awk '$2 == "OA" { x = sprintf("%.0f", $3) } END { print x }')"

# Rows of variants: in lanes, alone, and by three processes; extremes of directions that count turns.
{ turning; card DRIVE ANGLE CRANK '' '' 100.0; card VARY R2 20 '' 100.0 120.0; card TIME 720 '' '' 0.0 10.0; card EXTREMES MEASURES; echo END; } > "$w/lanes.deck"
"$kinmat" --summary "$w/lanes.csv" "$w/lanes.deck" > "$w/lanes" 2>&1
equal 'in lanes: the greatest direction is that of the drive' '20 variants' "$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
   { x = $at["OA.theta.max"] - 10*$3; if (x < 0) x = -x; if (x > 1e-9) print $2, x; n++ } END { print n " variants" }' "$w/lanes.csv")"
"$kinmat" --jobs 3 --summary "$w/jobs.csv" "$w/lanes.deck" > "$w/jobs" 2>&1
same 'variants by three processes' "$w/lanes" "$w/jobs"
same 'variants by three processes: the summary' "$w/lanes.csv" "$w/jobs.csv"
# With a PRINT card the engine solves each alone.
sed 's/^EXTREMES/PRINT   MEASURES        720\n&/' "$w/lanes.deck" > "$w/alone.deck"
"$kinmat" --summary "$w/alone.csv" "$w/alone.deck" > /dev/null 2>&1
equal 'variants alone' '0' "$(awk -F, 'NR == FNR { row[FNR] = $0; next } FNR > 1 { n = split(row[FNR], a, ",")
   for (i = 1; i <= n; i++) { if (sprintf("%.9e", a[i]) != sprintf("%.9e", $i)) { x = a[i] - $i; if (x*x > 1e-18) bad++ } } }
   END { print bad + 0 }' "$w/lanes.csv" "$w/alone.csv")"

# A line that turns far from instant to instant: a remark, once.
{ turning; card DRIVE ANGLE CRANK '' '' 100.0; card TIME 5 '' '' 0.0 7.0; card PRINT MEASURES OA; echo END; } > "$w/deck"
equal 'a line that turns far' ' --- LINE OA TURNS BY 140. DEG IN THE STEP TO T = 1.400000 S: ITS WHOLE TURNS ARE UNCERTAIN, USE SMALLER TIME STEPS' \
   "$("$kinmat" "$w/deck" | awk '/^ ---/' | tr '\n' ' ' | sed -e 's/: *--- /: /' -e 's/ *$//')"
equal 'a line that turns less' '' "$(sed 's/7\.0$/5.9/' "$w/deck" | "$kinmat" | grep '^ ---')"

# Points that meet between the instants, at T = 1 and at T = sqrt(5) - 1, and at an instant: the least distance is 0 and is
# found, both sides of the kink are searched, and nothing is said to be missed.
meeting() {
   grep -v '^\(PRINT\|TIME\|LANG\|END\)' input/points_meet.deck
   card LINE Q O DIRQO; card TIME "$1" '' '' 0.0 2.0; card EXTREMES MEASURES '' '' 0.1 10.0; echo END
}
for steps in 4 7 10 33; do
   meeting $steps > "$w/deck"
   "$kinmat" "$w/deck" > "$w/listing" 2>&1
   equal "points that meet, $steps steps: nothing is missed" '' "$(grep -E 'MISSED|NOT SEARCHED|[?]' "$w/listing")"
   awk '/^ EXTREMES  / { on = 1 } !on { next } $2 == "DRIVE" && $1 != "AT" { name = $1 } $1 == "MIN" || $1 == "MAX" { what = $1; value = $2 }
      /^  AT T/ { print name, what, value, name !~ /^DIR/ ? $3 : "" } /^ DWELL/ { print name, $1, $2, $3, $5, $8, $10 }' "$w/listing" > "$w/found"
   cat > "$w/expected" <<'TRUTH'
PO MIN 0.000000 1.000000
PO MAX 1.000000 0.000000
QO MIN 0.000000 1.236068
QO MAX 1.000000 0.000000
DIRPO MAX 180.000000
DIRQO MAX 90.000000
PO DWELL LENGTH MIN 0.100000 0.900000 1.100000
QO DWELL LENGTH MIN 0.100000 1.144761 1.323790
DIRPO DWELL ANGLE MIN 10.000000 0.000000 1.000000
DIRQO DWELL ANGLE MAX 10.000000 0.000000 1.236068
DOUBLE MIN 0.000000 1.000000
TRUTH
   equal "points that meet, $steps steps" '' "$(sed 's/ *$//' "$w/found" > "$w/lines"; while read -r line; do grep -qxF -- "$line" "$w/lines" || echo "$line"; done < "$w/expected")"
done
# Velocities on both sides of the kink: those of Q are -sqrt(5)/2 and up to 1.5.
equal 'rates beside the kink' 'MIN -1.118034 -0.500000 MAX 1.500000 0.500000' \
   "$(meeting 7 | "$kinmat" | awk '/^ QO  / { on++ } on == 9 && ($1 == "MIN" || $1 == "MAX") { printf "%s%s %s %s", sep, $1, $3, $4; sep = " " } /STROKE/ && on == 9 { exit }')"
# Points that pass at a distance: the least distance is that, or something is said to be missed.
for by in 1.0E-3 1.0E-5; do
   meeting 7 | sed -e "s/^POINT   Q .*/&\nPOINT   PM      BLOCK           0.5             $by/" -e 's/^DISTANCEP /DISTANCEPM/' \
      -e 's/^LINE    P /LINE    PM/' > "$w/deck"
   "$kinmat" --csv /dev/null "$w/deck" > "$w/listing" 2>&1
   equal "points that pass at $by" "$(printf '%.6f 0.500000' $by)" \
      "$(awk '/^ EXTREMES  / { on = 1 } on && /^ PO / { name = 1 } name && $1 == "MIN" { x = $2 } name && /^  AT T/ { print x, $3; exit }' "$w/listing")"
done

# Near such a place digits of the direction are lost, as roundings grow with the inverse of the distance.
for by in 1.0E-6 1.0E-10 1.0E-13 1.0E-15; do
   meeting 4 | sed -e "s/^POINT   Q .*/&\nPOINT   PM      BLOCK           0.5             $by/" -e 's/^LINE    P /LINE    PM/' -e '/^EXTREMES/d' > "$w/deck"
   "$kinmat" --csv "$w/csv" "$w/deck" | awk '/^ INSTANT 1 / { on = 1 } on && /^ DIRPO/ { print $2; exit }'
done > "$w/near"
equal 'digits near points that meet' '-90.0000?? -90.?????? -1??.?????? ?' "$(tr '\n' ' ' < "$w/near" | sed 's/ $//')"
equal 'the CSV near points that meet' 'UNKNOWN' "$(awk -F, '$2 == 1 && $5 == "DIRPO" { print $6 $9 $12 $15 }' "$w/csv")"

# The rows of measures: without PRINT, PRINT ALL, PRINT MEASURES, but PRINT PAIRS; the table, the CSV.
names() { "$kinmat" --no-listing --csv "$w/csv" "$1"; cut -d, -f4 "$w/csv" | sort -u | tr '\n' ' '; }
for print in '' 'PRINT   ALL' 'PRINT   MEASURESMU' 'PRINT   PAIRS'; do
   grep -v '^\(PRINT\|EXTREMES\)' input/transmission.deck | sed "s/^END/$print\nEND/" | sed '/^$/d' > "$w/deck"
   case $print in '') kinds='LINK MEASURE kind ' ;; *ALL) kinds='LINK MEASURE PAIR POINT kind ' ;; *MU) kinds='MEASURE kind ' ;; *) kinds='PAIR kind ' ;; esac
   equal "rows with '$print'" "$kinds" "$(names "$w/deck")"
done
"$kinmat" --no-listing --table "$w/table" input/transmission.deck
equal 'the table' 't,ANGLE.CRANK,DIAGONAL.s,BA.theta,BB0.theta,MU.theta,RESERVE.theta,DIAGONAL.v,BA.omega,BB0.omega,MU.omega,RESERVE.omega,DIAGONAL.a,BA.alpha,BB0.alpha,MU.alpha,RESERVE.alpha' \
   "$(head -n 1 "$w/table")"
"$kinmat" --no-listing --table "$w/table" --csv "$w/csv" input/points_meet.deck
equal 'the table where points meet' '0.0000000000000000E+000,NaN' "$(sed -n 4p "$w/table" | cut -d, -f4,5)"
equal 'the CSV where points meet' 'PO COINCIDE 0.0000000000000000E+000  BACK COINCIDE   ' \
   "$(awk -F, '$2 == 2 && $15 == "COINCIDE" && $5 ~ /^(PO|BACK)$/ { printf "%s %s %s %s ", $5, $15, $6, $9 }' "$w/csv")"
# Tolerances: the reserve goes with the angle; a distance by the coordinate of its point.
with transmission | awk '/^JOINT   B / { print; print "TOLER                           0.001           0.001"; next } { print }' > "$w/deck"
"$kinmat" --no-listing --csv "$w/csv" "$w/deck"
equal 'tolerances: kinds' 'MEASURE MEASURE PER B IN COUPLER X MEASURE PER B IN COUPLER Y MEASURE PER B IN ROCKER X MEASURE PER B IN ROCKER Y MEASURE RSS MEASURE WORST ' \
   "$(awk -F, '$4 ~ /^MEASURE/ { print $4 }' "$w/csv" | sort -u | tr '\n' ' ')"
equal 'tolerances: the sum' 13 "$(awk -F, '$4 == "MEASURE WORST" && $5 == "MU" { x = $6 } $4 == "MEASURE WORST" && $5 == "RESERVE" { if ((x - $6)^2 < 1e-24*x*x) n++ } END { print n }' "$w/csv")"

# Bad input.
bad() { with transmission "$2" | refused "$1" "$1"; }
bad 'E062 CARD 35 COLUMN 17 FIELD LABEL-B: "A" IS NAMED TWICE: NAME TWO POINTS' "$(card LINE A A X)"
bad 'E050 CARD 35 COLUMN 25 FIELD LABEL-C: "MU" IS A NAME DEFINED TWICE; FIRST ON CARD 29' "$(card DISTANCE A B MU)"
bad 'E050 CARD 35 COLUMN 25 FIELD LABEL-C: "B" IS A NAME DEFINED TWICE; FIRST ON CARD 24' "$(card DISTANCE A B B)"
bad 'E059 CARD 35 COLUMN 9 FIELD LABEL-A: "DIAGONAL" IS NOT THE NAME OF A LINE OR LINK (A MEASURE HAS IT)' \
   "$(card ANGLE DIAGONAL CRANK X)"
bad 'E055 CARD 35 COLUMN 17 FIELD LABEL-B: "CRANK" IS NOT THE NAME OF A PAIR OR MEASURE (A LINK HAS IT)' \
   "$(card SUM MU CRANK X)"
bad 'E061 CARD 35 COLUMN 17 FIELD LABEL-B: "DIAGONAL" CANNOT BE ADDED: A LENGTH AND AN ANGLE, OR A SUM THAT CONTAINS ITSELF' \
   "$(card SUM MU DIAGONAL X)"
bad 'E061 CARD 35 COLUMN 9 FIELD LABEL-A: "Y" CANNOT BE ADDED: A LENGTH AND AN ANGLE, OR A SUM THAT CONTAINS ITSELF' \
   "$(card SUM Y '' X; card SUM MU X Y)"
bad 'E067 CARD 36 COLUMN 9 FIELD LABEL-A: "CRANK" IS A LINE AND A LINK: RENAME ONE' \
   "$(card LINE A B CRANK; card ANGLE CRANK BA X)"
bad 'E074 CARD 35 COLUMN 17 FIELD LABEL-B: "BA" IS NAMED TWICE: NAME TWO LINKS' "$(card ANGLE BA BA X)"
bad 'E019 CARD 35 COLUMN 49 FIELD REAL-2: "2.0" IS IN A FIELD THAT THIS CARD DOES NOT USE' "$(card SUM MU '' X '' 2.0)"
bad 'E047 CARD 35 COLUMN 17 FIELD LABEL-B: "B" IS NOT THE NAME OF A MEASURE (A POINT HAS IT)' "$(card PRINT MEASURES B)"
bad 'E052 CARD 35 COLUMN 9 FIELD LABEL-A: "CRANK" IS NOT THE NAME OF A POINT (A LINK HAS IT)' \
   "$(card XI CRANK ROCKER X)"
bad 'E071 CARD 38 COLUMN 17 FIELD LABEL-B: "X" IS GROUND: NAME WHAT MOVES' \
   "$(card DISTANCE G1 G2 X; card POINT G1 BASE; card POINT G2 BASE '' 1.0; card EXTREMES MEASURES X)"
for place in 'END 34' 'TITLE 14'; do
   set -- $place
   meeting 4 | sed "s/^$1/DISTANCEP       Q       PQ\n&/" |
      refused "a distance between mechanisms, before $1" \
         "E107 CARD $2 COLUMN 17 FIELD LABEL-B: \"Q\" IS IN ANOTHER INDEPENDENT MECHANISM: NAME A GROUND LINK INSTEAD"
done
# A sum of sums is the sum of their terms: 2 (MU + 3 DEG) - (MU + MU) = 6 DEG.
with transmission "$(card SUM MU '' S1 1.0 '' 3.0; card SUM MU MU S2; card SUM S1 S2 S3 2.0 -1.0)" > "$w/deck"
"$kinmat" --no-listing --csv "$w/csv" "$w/deck"
equal 'a sum of sums' 13 "$(measured "$w/csv" | awk '$2 == "S3" && ($3 - 6)^2 < 1e-20 && $4^2 < 1e-20' | wc -l | tr -d ' ')"
# The line through two points that nearly meet has lost digits: those that are printed are right. P and Q are on cranks with 1E-7 deg
# between them.
{ card UNITS M DEG S; card GROUND BASE; card LINK LEFT; card LINK RIGHT; card POINT O BASE; card POINT O1 LEFT; card POINT O2 RIGHT
   card POINT P LEFT '' 1.0; card POINT Q RIGHT '' 1.0; card REVOLUTE O O1 P1; card REVOLUTE O O2 P2; card DRIVE ANGLE LEFT '' 30.0 20.0
   card DRIVE RELANGLE LEFT RIGHT 1.0E-7; card LINE P Q PQ; card TIME 2 '' '' 0.0 2.0; card PRINT MEASURES; card END; } > "$w/deck"
equal 'a line through points that nearly meet' '120.00 140.00 160.00' "$("$kinmat" "$w/deck" | awk '/^ PQ / {
   angle = $2; sub(/[?].*/, "", angle); if (index(100 + 20*++n ".000000", angle) != 1) print $0
   printf "%s%s", s, substr(angle, 1, 6); s = " " } END { print "" }')"
conclude
