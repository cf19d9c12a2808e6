#!/bin/sh
# Variants (VARY cards): values and their order; rows against closed forms, and against decks with the numbers typed in; what
# is refused; memory.
. tests/counting.sh

vary() { card VARY "$@"; }
turn=$(card TIME 24 '' '' 0.0 12.0)
# rows FILE NAME...: the columns with these names of a summary, without the head
rows() {
   file=$1
   shift
   awk -F, -v names="$*" '
      NR == 1 { n = split(names, name, " "); for (i = 1; i <= NF; i++) place[$i] = i
         for (i = 1; i <= n; i++) if (!place[name[i]]) print "no column " name[i]; next }
      { line = $(place[name[1]]); for (i = 2; i <= n; i++) line = line " " $(place[name[i]]); print line }' "$file"
}
# worst FILE FORM: the largest |$1 - form|, in units of 1E-9, of rows of numbers; the program FORM sets `form` from the others
worst() { awk "function acos(c) { return atan2(sqrt(1 - c*c), c) } { $2; d = \$1 - form; if (d < 0) d = -d
   if (d > most) most = d } END { print NR, (most < 1e-9 ? \"agree\" : \"differ by \" most) }" "$1"; }
# run NAME [STATUS]: the deck $w/NAME.deck, which ends with this status or 0, its listing and its summary
run() {
   "$kinmat" "$w/$1.deck" -o "$w/$1.lst" --summary "$w/$1.csv" > "$w/$1.out" 2>&1
   equal "$1: status" "${2:-0}" $?
   equal "$1: lines over 120 columns, NaN" '' "$(awk 'length > 120' "$w/$1.lst"; grep -iw nan "$w/$1.lst" "$w/$1.csv")"
}

# Values: a range, a list of four values on two cards, tied to it; a grid, the last number runs fastest.
moving_four_bar "$(vary R1 4 A 0.5 1.25)" "$(vary R1 2 '' 3.25 3.5)" "$(vary R1 LIST A 3.0 2.75 2.5; vary R1 LIST A 2.625)" '' \
   "$turn" > "$w/order.deck"
run order
rows "$w/order.csv" variant POINT.A-CR.XI POINT.B-RO.XI POINT.B-CO.XI | awk '{ print $1, $2 + 0, $3 + 0, $4 + 0 }' > "$w/order"
printf '%s\n' '1 0.5 3 3.25' '2 0.5 3 3.5' '3 0.75 2.75 3.25' '4 0.75 2.75 3.5' '5 1 2.5 3.25' '6 1 2.5 3.5' \
   '7 1.25 2.625 3.25' '8 1.25 2.625 3.5' > "$w/order.expected"
same 'order of the values' "$w/order.expected" "$w/order"

# The swing of a rocker by the law of cosines: its extremes are where crank a and coupler b are in line, stretched or folded,
# at the angle acos((c^2 + g^2 - (b +- a)^2)/(2 c g)) of the rocker c with the ground g.
moving_four_bar "$(vary R1 5 '' 0.5 1.25)" "$(vary R1 4 '' 3.25 3.75)" "$(vary R1 3 '' 2.75 3.25)" '' "$turn" \
   "$(card EXTREMES LINKS ROCKER)" "$(card EXTREMES PAIRS PAIR-B)" > "$w/swing.deck"
run swing
swing='a = $2; b = $3; c = $4; g = 4'
for side in max:- min:+; do
   rows "$w/swing.csv" ROCKER.phi.${side%:*} POINT.A-CR.XI POINT.B-CO.XI POINT.B-RO.XI > "$w/swing"
   equal "swing, ${side%:*}" '60 agree' "$(worst "$w/swing" "$swing; pi = atan2(0, -1)
      form = 180/pi*(pi - acos((c*c + g*g - (b ${side#*:} a)^2)/(2*c*g)))")"
done
rows "$w/swing.csv" ROCKER.phi.stroke POINT.A-CR.XI POINT.B-CO.XI POINT.B-RO.XI > "$w/swing"
equal 'swing, stroke' '60 agree' "$(worst "$w/swing" "$swing; pi = atan2(0, -1)
   form = 180/pi*(acos((c*c + g*g - (b + a)^2)/(2*c*g)) - acos((c*c + g*g - (b - a)^2)/(2*c*g)))")"
# The crank turns steadily from one of these positions to the other: by its angles with the ground there.
rows "$w/swing.csv" ROCKER.phi.ratio POINT.A-CR.XI POINT.B-CO.XI POINT.B-RO.XI > "$w/swing"
equal 'swing, ratio of times' '60 agree' "$(worst "$w/swing" "$swing; pi = atan2(0, -1)
   turn = pi + acos((g*g + (b - a)^2 - c*c)/(2*g*(b - a))) - acos((g*g + (b + a)^2 - c*c)/(2*g*(b + a)))
   form = turn/(2*pi - turn); if (form < 1) form = 1/form")"
# The transmission angle is least or greatest where the crank lies along the ground: between b and c against g -+ a. The angle
# of the pair is that from the coupler to the rocker, which are drawn from their common point B in opposite senses.
for side in min:- max:+; do
   rows "$w/swing.csv" PAIR-B.theta.${side%:*} POINT.A-CR.XI POINT.B-CO.XI POINT.B-RO.XI > "$w/swing"
   equal "transmission angle, ${side%:*}" '60 agree' "$(worst "$w/swing" "$swing
      form = 180/atan2(0, -1)*acos((b*b + c*c - (g ${side#*:} a)^2)/(2*b*c))")"
done

# A small stroke has digits of its own: y of the end of a crank of 2E-4, whose pivot is at 7, moves by twice as much.
{
   card GROUND BASE; card LINK CRANK; card POINT O BASE '' 0.0 7.0; card POINT O1 CRANK
   card POINT A CRANK '' 2.0E-4; vary R1 2 '' 1.0E-4 2.0E-4; card REVOLUTE O O1 PIVOT
   card DRIVE ANGLE CRANK '' 0.3 1.0; card TIME 12 '' '' 0.0 6.2831853; card EXTREMES POINTS A; card END
} > "$w/small.deck"
run small
equal 'a small stroke' '200.0000E-06 1.000000 400.0000E-06 1.000000' "$(awk '/Y STROKE/ { on = 1; at = index($0, "Y STROKE") }
   on && /^ +[12] 69/ { split(substr($0, at - 8), f, " "); printf "%s%s %s", mark, f[1], f[2]; mark = " " }' "$w/small.lst")"

# Grashof: a crank a turns fully if, and only if, a + g < b + c and |a - g| > |b - c|; otherwise its limits are where coupler
# and rocker are in line. None of these lengths is at the border.
moving_four_bar "$(vary R1 7 '' 0.55 5.15)" "$(vary R1 5 '' 1.5 4.75)" "$(vary R1 4 '' 1.75 3.25)" "$(vary R1 2 '' 2.8 4.0)" \
   "$(card TIME 1 '' '' 0.0 0.1)" "$(card RANGE)" > "$w/grashof.deck"
run grashof 2
rows "$w/grashof.csv" range.turns.ANGLE.CRANK flagged POINT.A-CR.XI POINT.B-CO.XI POINT.B-RO.XI POINT.B0.XI > "$w/grashof"
equal 'Grashof: variants, wrong ones' '280 0' "$(awk '
   function size(x) { return x < 0 ? -x : x }
   NF == 6 && $2 == 0 { full = $3 + $6 < $4 + $5 && size($3 - $6) > size($4 - $5); if (full != ($1 == 1)) wrong++ }
   END { print NR, wrong + 0 }' "$w/grashof")"
equal 'Grashof: of both kinds' yes "$(awk 'NF == 6 { $1 == 1 ? full++ : part++ } END { print (full > 20 && part > 20 ? "yes" : full " " part) }' \
   "$w/grashof")"

# A slider-crank off its line by e: the stroke is sqrt((l + r)^2 - e^2) - sqrt((l - r)^2 - e^2). The offset is that of the
# PRISM card; the rate is given in turns a minute, and TIME is tied to it so that each run is one turn.
{
   card UNITS MM DEG S; card GROUND BASE; card LINK CRANK; card LINK ROD '' '' 30.0 0.0 -10.0; card LINK PISTON '' '' 120.0
   card POINT O BASE; card POINT O1 CRANK; card POINT A1 CRANK '' 30.0; vary R1 3 '' 20.0 40.0
   card POINT A2 ROD; card POINT B2 ROD '' 100.0; vary R1 4 '' 90.0 120.0; card POINT B PISTON
   card REVOLUTE O O1 PAIR-O; card REVOLUTE A1 A2 PAIR-A; card REVOLUTE B2 B PAIR-B
   card PRISM O B GUIDE 0.0 10.0; vary R2 LIST '' -10.0 0.0 12.5
   card DRIVE ANGLE CRANK RPM 0.0 60.0; vary R2 2 RATE 60.0 120.0
   card TIME 24 '' '' 0.0 1.0; vary R2 2 RATE 1.0 0.5
   card EXTREMES PAIRS GUIDE; card PRINT PAIRS GUIDE 12; card END
} > "$w/slider.deck"
run slider
rows "$w/slider.csv" GUIDE.s.max GUIDE.s.min POINT.A1.XI POINT.B2.XI PRISM.GUIDE.H | awk '{ $1 = sprintf("%.15g", $1 - $2); print }' > "$w/stroke"
equal 'stroke of a slider' '72 agree' "$(worst "$w/stroke" 'r = $3; l = $4; e = $5
   form = sqrt((l + r)^2 - e*e) - sqrt((l - r)^2 - e*e)')"
rows "$w/slider.csv" ANGLE.CRANK.RATE TIME.T1 GUIDE.s.max.ANGLE.CRANK | awk '{ print ($1*$2 == 60 && $3 >= 0 && $3 <= 360) }' \
   | sort | uniq -c | tr -s ' ' > "$w/tied"
equal 'rate and time are tied' ' 72 1' "$(cat "$w/tied")"
equal 'slider: tables of each variant' '72 72 216' "$(awk '/^ VARIANT [0-9]+ / { a++ } /^ END OF VARIANT/ { b++ } /^ INSTANT / { c++ }
   END { print a, b, c }' "$w/slider.lst")"

# A row is that of the deck with the numbers typed in, and so are the tables and the CSV of a variant.
typed() { sed -e '/^VARY    R1      3 /d' -e '/^VARY    R1      4 /d' -e '/LIST/d' -e 's/^\(POINT   A1 .*\) 30.0/\1 40.0/' \
   -e 's/^\(POINT   B2 .*\) 100.0/\1 110.0/' -e 's/^\(PRISM .*\) 10.0/\1 12.5/' -e "$1" "$w/slider.deck"; }
typed 's/^\(VARY    R2  \)    2       RATE.*\( 60.0\|  1.0\) .*/\1    1                \2/' > "$w/typed.deck"
run typed
rows "$w/slider.csv" variant POINT.A1.XI POINT.B2.XI PRISM.GUIDE.H ANGLE.CRANK.RATE \
   | awk '$2 == 40 && $3 == 110 && $4 == 12.5 && $5 == 60 { print $1 }' > "$w/number"
equal 'typed in: one variant' 1 "$(grep -c . "$w/number")"
number=$(cat "$w/number")
all=$(head -n 1 "$w/slider.csv" | tr ',' '\n' | sed -n '/^solved/,$p' | tr '\n' ' ')
rows "$w/slider.csv" variant $all | sed -n "s/^$number //p" > "$w/row"
rows "$w/typed.csv" $all > "$w/row.typed"
same 'typed in: the row' "$w/row.typed" "$w/row"
typed '/^VARY/d' > "$w/plain.deck"
"$kinmat" "$w/slider.deck" --no-listing --csv "$w/all.csv"
"$kinmat" "$w/plain.deck" -o "$w/plain.lst" --csv "$w/plain.csv"
awk -F, -v OFS=, -v n="$number" 'NR == 1 || $2 == n { for (i = 2; i < NF; i++) $i = $(i + 1); NF--; print }' "$w/all.csv" \
   > "$w/variant.csv"
same 'typed in: CSV' "$w/plain.csv" "$w/variant.csv"
sed -n "/^ VARIANT $number /,/^ END OF VARIANT/p" "$w/slider.lst" | sed '1,/^$/d;$d' > "$w/variant.lst"
sed -n '/^ RESULTS/,/^ END OF SET/p' "$w/plain.lst" | sed '1,/^$/d;$d' > "$w/plain.tables"
same 'typed in: tables' "$w/plain.tables" "$w/variant.lst"
# A crank of 2.5 passes a change point (2.5 + 4.0 = 3.5 + 3.0). Next to it digits are in doubt: those of the variant alone,
# whatever variant has lent it its structure. Sixteen run at a time; they differ in a point that nobody uses.
doubts() {
   moving_four_bar "$(vary R1 LIST '' "$@"; card POINT P CRANK; vary R1 16 '' 1.0 2.5)" '' '' '' "$turn" \
      "$(card EXTREMES LINKS ROCKER)" > "$w/doubt.deck"
   "$kinmat" --jobs 1 "$w/doubt.deck" | grep '^        [ 0-9][0-9] ' | cut -c 11- | grep '[?]' | tail -n 32
}
doubts 2.49999999999 > "$w/alone"
doubts 2.499999999 2.49999999999 > "$w/after"
equal 'typed in: rows with digits in doubt' 32 "$(grep -c . "$w/alone")"
same 'typed in: digits in doubt' "$w/alone" "$w/after"

# A drawing: a joint that moves takes the lengths of both its links with it.
{
   card UNITS M DEG S; card GROUND BASE; card LINK CRANK; card LINK COUPLER; card LINK ROCKER
   card JOINT A0 BASE CRANK 0.5; card JOINT A CRANK COUPLER 0.0 1.0; card JOINT B COUPLER ROCKER 3.0 2.75
   vary R1 3 '' 2.75 3.25; card JOINT B0 ROCKER BASE 4.0; card DRIVE ANGLE CRANK '' '' -30.0; card TIME 2 '' '' 0.0 1.0
   card PRINT POINTS B 2; card LANG PL; card END
} > "$w/drawing.deck"
"$kinmat" "$w/drawing.deck" --csv "$w/drawing.csv" -o "$w/drawing.lst"
equal 'a joint of a drawing' '2.75 2.75;3 2.75;3.25 2.75;' "$(awk -F, '$3 == 0 { printf "%.6g %.6g;", $7, $8 }' "$w/drawing.csv")"
equal 'in Polish' '3 1' "$(awk '/^ WARIANT [0-9]+ / { a++ } /^ KONIEC KOMPLETU 1:  WARIANTY 3/ { b++ } END { print a, b }' \
   "$w/drawing.lst")"

# What cannot be computed is a row that says so, and the run goes on: no position, a limit, a number that a check refuses.
moving_four_bar "$(vary R1 LIST '' 1.0 20.0 3.75)" '' '' '' "$turn" "$(card EXTREMES LINKS ROCKER)" > "$w/impossible.deck"
run impossible 2
rows "$w/impossible.csv" variant solved flagged flag.t flag.mark > "$w/impossible"
equal 'impossible: rows' '1 25 0  ;2 0 25 0 NO-POSITION;3 7 18 NO-POSITION;' "$(awk '{ $4 = $4 == "" ? "" : $4 + 0
   if ($1 == 3) print $1, $2, $3, $5; else print }' "$w/impossible" | sed 's/1 25 0.*/1 25 0  /' | tr '\n' ';')"
# The limit is where b and c are in line: cos(phi) = (a^2 + g^2 - (b + c)^2)/(2 a g).
rows "$w/impossible.csv" limit.value variant | sed -n 's/ 3$//p' > "$w/limit"
equal 'impossible: limit' '1 agree' "$(worst "$w/limit" 'form = 180/atan2(0, -1)*acos((14.0625 + 16 - 42.25)/30)')"
{
   moving_four_bar '' '' '' '' | sed '/^END/d'
   card RISE CYCLOID '' '' 1.0 2.0 20.0; vary R2 LIST '' 2.0 -1.0 1.0; echo "$turn"; card END
} > "$w/refused.deck"
run refused 2
equal 'refused: rows' '1 25 0 ;2 0 0 E036;3 25 0 ;' "$(rows "$w/refused.csv" variant solved flagged flag.mark | tr '\n' ';')"
equal 'refused: words' 1 "$(grep -c '^ \*\*\* E036 .*IS OUT OF RANGE; ALLOWED: ABOVE 0.0' "$w/refused.lst")"

# What a table cannot hold. Faults of VARY cards are in tests/unit/deck/test_deck_variants.pf.
"$kinmat" "$w/order.deck" --no-listing --table "$w/table.csv" > "$w/out" 2>&1
equal 'no table: status' 1 $?
equal 'no table' ' *** OPTION --table TAKES NO DECK WITH VARY CARDS: USE --summary OR --csv' "$(cat "$w/out")"

# Shares of tolerances have no columns in the table: it says where they are.
for print in '' "$(card PRINT PAIRS PAIR-B0)"; do
   moving_four_bar "$(card TOLER '' '' '' 0.01; vary R1 2 '' 0.5 0.75)" '' '' '' "$turn" "$print" | sed '/^$/d' > "$w/toler.deck"
   "$kinmat" "$w/toler.deck" > "$w/toler.lst"
   equal "tolerances of variants, $print" "$([ -n "$print" ] && echo 2 || echo 0)" \
      "$(grep -c '^ TOLERANCES: CONTRIBUTIONS AT' "$w/toler.lst")"
done

# Rows alone are solved in lanes, otherwise by the engine: as they are printed they are the same.
for name in 'EXTREMES ALL' RANGE PROVE; do
   moving_four_bar "$(vary R1 9 '' 0.5 2.9)" '' '' '' "$(card TIME 90 '' '' 0.0 12.0)" "$(card $name)" > "$w/lanes.deck"
   "$kinmat" "$w/lanes.deck" -o "$w/lanes.lst" > "$w/lanes.out" 2>&1
   status=$?
   "$kinmat" "$w/lanes.deck" -o "$w/engine.lst" --log "$w/engine.log" > "$w/lanes.out" 2>&1
   equal "$name: status by lanes" "$?" "$status"
   same "$name: rows by lanes and by the engine" "$w/engine.lst" "$w/lanes.lst"
done

# With PROVE a column says how many instants are not proved: none of a crank that turns fully; of one that ends at a dead
# point those beyond it, and at most the last step before it.
moving_four_bar "$(vary R1 2 '' 0.5 2.9)" '' '' '' "$(card TIME 90 '' '' 0.0 12.0)" "$(card PROVE)" > "$w/proved.deck"
"$kinmat" "$w/proved.deck" --summary "$w/proved.csv" > "$w/proved.lst"
equal 'proofs of variants' '0 0;1 1;' "$(rows "$w/proved.csv" flagged unproved | awk '{ printf "%d %d;", ($1 > 0), ($2 > 0 && ($2 == $1 || $2 == $1 + 1)) }')"
equal 'proofs of variants: in the listing' 1 "$(grep -c '  NOT PROVED$' "$w/proved.lst")"
equal 'proofs of variants: the same' "$(rows "$w/proved.csv" unproved | xargs)" "$(awk '/^         [12] / { print $NF }' "$w/proved.lst" | xargs)"

# In several processes, and in shares: the same bytes. Three sets, one of them without VARY cards.
{
   cat "$w/slider.deck"; moving_four_bar '' '' '' '' "$(card TIME 2 '' '' 0.0 1.0)"
   sed 's/^VARY    R1      2 /VARY    R1      5 /' "$w/order.deck"
} > "$w/three.deck"
"$kinmat" "$w/three.deck" --jobs 1 -o "$w/one.lst" --summary "$w/one.csv" --csv "$w/one.all" --log "$w/one.log"
equal 'one process' '0 72 20' "$? $(awk -F, '$1 == 1 { a++ } $1 == 3 { b++ } END { print a, b }' "$w/one.csv")"
for jobs in 2 7; do
   "$kinmat" "$w/three.deck" --jobs $jobs -o "$w/some.lst" --summary "$w/some.csv" --csv "$w/some.all" --log "$w/some.log"
   for kind in lst csv all log; do same "$jobs processes: $kind" "$w/one.$kind" "$w/some.$kind"; done
done
for kind in lst csv all log; do : > "$w/joined.$kind"; done
for k in 1 2 3 4 5; do
   "$kinmat" "$w/three.deck" --jobs 1 --sets $k/5 -o "$w/some.lst" --summary "$w/some.csv" --csv "$w/some.all" --log "$w/some.log"
   for kind in lst csv all log; do cat "$w/some.$kind" >> "$w/joined.$kind"; done
done
for kind in lst csv all log; do same "five shares: $kind" "$w/one.$kind" "$w/joined.$kind"; done
"$kinmat" "$w/three.deck" --sets 1/5 --no-listing --svg "$w/x.svg" > "$w/out" 2>&1
equal 'no picture of a share' ' *** PICTURES OF A DECK WITH VARY CARDS CANNOT BE DIVIDED: OMIT --sets' "$(cat "$w/out")"
"$kinmat" "$w/three.deck" --no-listing --svg "$w/three.svg" --animate "$w/moving.svg"
equal 'a picture of the numbers of the deck' 0 $?

# What a variant keeps of the structure of the one before: lengths of zero, with which links lack a drive, and a drive at rest.
moving_four_bar "$(vary R1 LIST '' 1.0 0.0 0.5)" "$(vary R1 LIST '' 3.5 0.0)" "$(vary R1 LIST '' 0.0 3.0)" '' "$turn" \
   "$(card EXTREMES PAIRS PAIR-B0)" | sed 's/^DRIVE .*/&\nVARY    R2      LIST            30.0            0.0/' > "$w/zeros.deck"
"$kinmat" "$w/zeros.deck" --jobs 1 --no-listing --summary "$w/one.csv" > "$w/out" 2>&1
equal 'lengths of zero: variants refused' 18 "$(grep -c ',E101,' "$w/one.csv")"
for k in 1 2 3 4 5 6 7 8; do
   "$kinmat" "$w/zeros.deck" --jobs 1 --sets $k/8 --no-listing --summary "$w/some.csv" > "$w/out" 2>&1
   cat "$w/some.csv"
done > "$w/joined.csv"
same 'lengths of zero: eight shares' "$w/one.csv" "$w/joined.csv"

# Guides that vary: variants that are solved together have the numbers of variants that are solved one by one, for their log.
awk '/^END/ { print; exit } 1' input/crank_slider.deck | sed -e '/^PRINT/d' -e '/^EXTREMES/d' -e "s/^PRISM.*/&\n$(card VARY R1 3 '' -2.0 2.0)\n$(card VARY R2 8 '' -0.3 0.3)/" \
   -e "s/^END/$(card EXTREMES PAIRS BORE)\nEND/" > "$w/guides.deck"
"$kinmat" "$w/guides.deck" --jobs 1 --no-listing --summary "$w/together.csv"
"$kinmat" "$w/guides.deck" --jobs 1 --no-listing --summary "$w/alone.csv" --log "$w/alone.log"
same 'guides that vary, together' "$w/alone.csv" "$w/together.csv"
equal 'guides that vary: other strokes' 24 "$(sed 1d "$w/alone.csv" | cut -d, -f13,16 | sort -u | wc -l | tr -d ' ')"

# Units stand below the heads of ranges as well: the drive is an angle.
with crank_rockers "$(card RANGE)" > "$w/ranges.deck"
equal 'ranges of variants: units' 'M M M S DEG DEG' "$("$kinmat" "$w/ranges.deck" | awk '/RANGE MIN/ { getline; $1 = $1; print; exit }')"

# More variants in all sets than a whole number counts: 215 sets of 3162**2.
moving_four_bar "$(vary R1 3162 '' 0.5 1.25)" "$(vary R1 3162 '' 3.25 3.75)" '' '' "$(card AT '' '' '' 0.0)" > "$w/grid.deck"
for i in $(seq 215); do cat "$w/grid.deck"; done > "$w/grids.deck"
rejected 'variants of all sets' 1 ' *** TOO MANY VARIANTS IN ALL SETS: DIVIDE THE DECK' --no-listing --summary "$w/grids.csv" "$w/grids.deck"

# The shares of tolerances stand in the tables of a variant: rows alone do without, and are the same.
moving_four_bar "$(vary R1 3 '' 0.5 1.25)" "$(card TOLER '' '' '' 0.01)" '' '' "$(card TIME 4 '' '' 0.0 1.0; card PRINT ALL)" > "$w/toler.deck"
ends 'tolerances' 0 "$w/toler.deck" --summary "$w/tables.csv"
"$kinmat" "$w/toler.deck" --no-listing --summary "$w/alone.csv" > "$w/out" 2>&1
equal 'tolerances, rows alone: status' 0 $?
same 'tolerances, rows alone' "$w/tables.csv" "$w/alone.csv"

# Memory does not grow with the variants: 40 times as many need no more room than is free for a few.
moving_four_bar "$(vary R1 50 '' 0.5 1.25)" "$(vary R1 40 '' 3.25 3.75)" '' '' "$(card TIME 1 '' '' 0.0 1.0)" > "$w/many.deck"
(ulimit -v 200000; "$kinmat" "$w/many.deck" --no-listing --summary "$w/many.csv") > "$w/out" 2>&1
equal '2000 variants: status' 0 $?
equal '2000 variants: rows' 2000 "$(rows "$w/many.csv" solved | grep -c '^2$')"
# A time in a table keeps its unit if TIME counts turns; only the duration has none then.
{ card GROUND BASE; card LINK CRANK; card LINK CAM; card JOINT A BASE CRANK; card JOINT B BASE CAM 5.0; card DRIVE ANGLE CRANK '' '' 10.0
   card DRIVE ANGLE CAM; card ADD TABLE '' '' 0.0 0.0; card ADD TABLE '' '' 3.0 90.0; vary R1 2 '' 3.0 3.5; card ADD TABLE '' '' 6.0 0.0
   card TIME 2 TURNS '' 0.0 0.1; card END
} > "$w/table_turns.deck"
"$kinmat" "$w/table_turns.deck" > "$w/table_turns.lst"
equal 'the unit of a time in a table, with TURNS' 'S S' "$(awk '/FIRST FLAG$/ { getline; getline; print $1, $2; exit }' "$w/table_turns.lst")"
conclude
