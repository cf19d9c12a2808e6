#!/bin/sh
# Cards LENGTH, and LINK with FROM and TO: drawings made by chance against closed forms, variants against decks with the numbers
# typed, and what is rejected.
. tests/counting.sh

# Six-bars, their values and sensitivities, in real128: a check a row.
"$BUILD/release/lengths_by_chance" deck 60 > "$w/chance.deck"
"$kinmat" "$w/chance.deck" --no-listing --csv "$w/chance.csv" 2> "$w/chance.err"
equal 'drawings made by chance: status' 0 $?
"$BUILD/release/lengths_by_chance" check 60 < "$w/chance.csv" > "$w/chance.txt"
equal 'drawings made by chance' '0 failed' "$(tail -n 1 "$w/chance.txt" | sed 's/.*, //')"

# A book's four-bar: 12 cards of mechanism, three of them LENGTH between moving joints, and no arc tangent.
book() {
   card GROUND BASE; card LINK CRANK A0 A; card LINK COUPLER A B; card LINK ROCKER B0 B
   card JOINT A0 BASE CRANK 0.0 0.0; card JOINT A CRANK COUPLER 20.0 20.0; card JOINT B COUPLER ROCKER 80.0 60.0
   card JOINT B0 ROCKER BASE 90.0 0.0
   card LENGTH A0 A '' "${1-30.0}"; echo "$5"; card LENGTH A B '' "${2-70.0}"; echo "$6"; card LENGTH B0 B '' "${3-65.0}"; echo "$7"
   card DRIVE ANGLE CRANK '' 30.0 60.0
}
# made NAME: $w/NAME.deck of the cards on standard input; run NAME [STATUS]: its outputs, and how it ends
made() { { card UNITS MM DEG S; cat; card END; } > "$w/$1.deck"; }
run() { "$kinmat" "$w/$1.deck" -o "$w/$1.lst" --csv "$w/$1.csv" 2> "$w/$1.err"; equal "$1: status" "${2:-0}" $?; }
hours=$(card TIME 6 '' '' 0.0 6.0)
{ book; echo "$hours"; } | made book
run book
equal 'a four-bar of a book: cards' 12 "$(grep -cE '^(GROUND|LINK|JOINT|LENGTH|DRIVE)' "$w/book.deck")"
# PHI are the directions of the bars: by Freudenstein's equations at 30 deg.
equal 'a four-bar of a book: angles' "$(awk 'BEGIN { q = atan2(0, -1)/6; x = 90 - 30*cos(q); y = -30*sin(q); d = sqrt(x*x + y*y)
   k = (70*70 + d*d - 65*65)/(2*70*d); t = atan2(y, x) + atan2(sqrt(1 - k*k), k); bx = 30*cos(q) + 70*cos(t); by = 30*sin(q) + 70*sin(t)
   u = 180/atan2(0, -1); printf "30.000000 %.6f %.6f\n", t*u, atan2(by, bx - 90)*u }')" \
   "$(awk '/^ INSTANT 0/ { on = 1 } /^ POINT/ { on = 0 } on && /^ (CRANK|COUPLER|ROCKER)/ { printf "%s%s", s, $4; s = " " } END { print "" }' "$w/book.lst")"

# The echo has what the lengths make of each point Q, and the axes.
echoed() { grep -E "^ $2 " "$w/$1.lst" | tr -s ' ' | sed 's/ $//'; }
equal 'a four-bar of a book: echo of lengths' "$(awk 'BEGIN { a = 30/sqrt(2); d = sqrt(3600 + 1600); e = sqrt(100 + 3600)
   printf " LENGTH A0 A 30.0 X = %.7f Y = %.7f\n", a, a; printf " LENGTH A B 70.0 X = %.7f Y = %.7f\n", 20 + 70*60/d, 20 + 70*40/d
   printf " LENGTH B0 B 65.0 X = %.7f Y = %.6f\n", 90 - 650/e, 3900/e }')" "$(echoed book LENGTH)"
equal 'a four-bar of a book: echo of axes' " LINK CRANK A0 A 0.0 (FROM TO) 0.0 (FROM TO) 45.0 (FROM TO)" "$(echoed book 'LINK     CRANK')"
equal 'a four-bar of a book: no remark' '' "$(grep -e --- "$w/book.lst")"

# The rows of a variant are those of the deck with its numbers, to the last digit; a length that is refused has its error.
for a in 28.0 32.0; do for b in 69.0 71.5; do
   { book $a $b; echo "$hours"; card PRINT LINKS; card PRINT POINTS; } | made one
   run one
   sed -n '2,$p' "$w/one.csv"
done; done > "$w/single.rows"
{ book 30.0 70.0 65.0 '' "$(card VARY R1 LIST '' 28.0 32.0)" "$(card VARY R1 2 '' 69.0 71.5)"; echo "$hours"; card PRINT LINKS; card PRINT POINTS; } |
   made varied
run varied
sed -n '2,$p' "$w/varied.csv" | cut -d, -f1,3- > "$w/varied.rows"
same 'variants of lengths' "$w/single.rows" "$w/varied.rows"
{ book 30.0 70.0 65.0 '' '' '' "$(card VARY R1 LIST '' 65.0 -1.0)"; echo "$hours"; } | made negative
run negative 2
equal 'a length that is refused: its row' ' *** E036 CARD 14 COLUMN 33 FIELD REAL-1: "65.0" IS OUT OF RANGE; ALLOWED: ABOVE 0.0' "$(grep 'E036' "$w/negative.lst" | tr -s ' ')"

# Cards that ASSEMBLY prints, with the LENGTH cards: each starts at that assembly, also with a POINT that lengths have moved.
four() { { card UNITS MM DEG S; book '' '' '' | sed -e '/^LENGTH/d' -e 's/^LINK    \([A-Z]*\).*/LINK    \1/'; card POINT C COUPLER '' 40.0 70.0; card POINT D COUPLER '' 10.0 10.0
   card LENGTH A0 A '' 30.0; card LENGTH A B '' 70.0; card LENGTH B0 B '' 65.0; card LENGTH A C '' 45.0; card LENGTH B C '' 50.0
   card AT '' '' '' 0.0 1.0; card PRINT POINTS; card ASSEMBLY; card END; } > "$w/four.deck"; run four; }
four
for n in 1 2; do
   awk -v n=$n 'FNR == NR { if (/^ ASSEMBLY /) on = $2 == n; if (on && /^[A-Z]/) card[sprintf("%-16.16s", $0)] = $0; next }
      { name = sprintf("%-16.16s", $0); print (name in card ? card[name] : $0) }' "$w/four.lst" "$w/four.deck" > "$w/pasted$n.deck"
   run pasted$n
   equal "assembly $n with its lengths: cards" 4 "$(grep -c '^JOINT.*[.][0-9][0-9][0-9]' "$w/pasted$n.deck")"
   # The joint B that ASSEMBLY prints is where this run begins, and A C, B C are as long as their cards say.
   equal "assembly $n with its lengths: where it begins" yes "$(awk -F, -v b="$(grep '^JOINT   B ' "$w/pasted$n.deck" | cut -c33-64)" '
      $2 == 0 && $4 == "POINT" { x[$5] = $6; y[$5] = $7 }
      function off(p, q, l) { return (sqrt((x[p] - x[q])^2 + (y[p] - y[q])^2) - l)^2 > 1e-22 }
      END { split(b, at, " "); print (x["B"] - at[1])^2 + (y["B"] - at[2])^2 < 1e-18 && !off("A", "C", 45) && !off("B", "C", 50) \
         && !off("A", "B", 70) ? "yes" : "no" }' "$w/pasted$n.csv")"
done

# A plate of three joints: two lengths, the side on which C is drawn; its sensitivity to one of them, with the law of cosines.
plate() {
   card GROUND BASE; card LINK CRANK A0 A; card LINK PLATE A B; card LINK ROCKER B0 B; card LINK ROD C E; card LINK ARM D0 E
   card JOINT A0 BASE CRANK 0.0 0.0; card JOINT A CRANK PLATE 20.0 20.0; card JOINT B PLATE ROCKER 80.0 60.0
   card JOINT B0 ROCKER BASE 90.0 0.0; card JOINT C PLATE ROD 30.0 70.0; card JOINT E ROD ARM 0.0 100.0; card JOINT D0 ARM BASE -60.0 70.0
   printf '%s\n' "$@"
}
turn=$(card DRIVE ANGLE CRANK '' '' 60.0)
{ plate "$(card LENGTH A B '' 70.0)" "$(card LENGTH A C '' 50.0)" "$(card LENGTH B C '' 55.0)" "$turn" "$(card AT '' '' '' 0.0)" \
   "$(card XI C PLATE C-XI)" "$(card ETA C PLATE C-ETA)" "$(card PRINT MEASURES)"; } | made plate
run plate
equal 'a plate: C in its axes' "$(awk 'BEGIN { x = (4900 + 2500 - 3025)/140; printf "%.4f %.4f", x, sqrt(2500 - x*x) }')" \
   "$(awk '/^ C-XI/ { x = $2 } /^ C-ETA/ { printf "%.4f %.4f", x, $2 }' "$w/plate.lst")"

# TOLER of a JOINT: the hole of each link by itself, all joints of a link at one place as one hole. Two rods on one pin A: as in a
# deck of POINT cards, in which the crank has one point for both.
drawn() {
   card UNITS MM DEG S; card GROUND BASE; card LINK CRANK; card LINK ROD; card LINK ROD2; card LINK TOP; card LINK LOW
   card JOINT O BASE CRANK 0.0 0.0; tol O; card JOINT A CRANK ROD 20.0 10.0; tol A; card JOINT A2 CRANK ROD2 20.0 10.0
   card JOINT B TOP ROD 100.0 20.0; card JOINT B2 LOW ROD2 90.0 -30.0; card POINT G BASE '' 0.0 20.0; card POINT G2 BASE '' 0.0 -30.0
   card PRISM G B GUIDE; card PRISM G2 B2 LOWER; rest
}
plain() {
   card UNITS MM DEG S; card GROUND BASE; card LINK CRANK; card LINK ROD; card LINK ROD2; card LINK TOP; card LINK LOW
   card POINT O0 BASE; tol O; card POINT O1 CRANK; tol O; card POINT AC CRANK '' 20.0 10.0; tol A; card POINT AR ROD '' 20.0 10.0; tol A
   card POINT AR2 ROD2 '' 20.0 10.0; card POINT BR ROD '' 100.0 20.0; card POINT B TOP '' 100.0 20.0; card POINT BR2 ROD2 '' 90.0 -30.0
   card POINT B2 LOW '' 90.0 -30.0; card REVOLUTE O0 O1 PO; card REVOLUTE AC AR PA; card REVOLUTE AC AR2 PA2; card REVOLUTE B BR PB
   card REVOLUTE B2 BR2 PB2; card POINT G BASE '' 0.0 20.0; card POINT G2 BASE '' 0.0 -30.0; card PRISM G B GUIDE; card PRISM G2 B2 LOWER; rest
}
tol() { card TOLER '' '' '' 0.05 0.04; }
rest() { card DRIVE ANGLE CRANK '' 0.0 60.0; card AT '' '' '' 0.0 0.5 1.0; card PRINT LINKS ROD; card PRINT LINKS ROD2; card PRINT PAIRS GUIDE; card PRINT PAIRS LOWER; card END; }
drawn > "$w/drawn.deck"
plain > "$w/plain.deck"
run drawn
run plain
rows() { grep -E '^  (WORST|RSS) ' "$w/$1.lst"; }
rows plain > "$w/plain.rows"
rows drawn > "$w/drawn.rows"
same 'holes of joints' "$w/plain.rows" "$w/drawn.rows"
equal 'holes of joints: rows' 24 "$(wc -l < "$w/plain.rows" | tr -d ' ')"
equal 'holes of joints: their names' 'A IN CRANK X,A IN CRANK Y,A IN ROD X,A IN ROD Y,O IN BASE X,O IN BASE Y,O IN CRANK X,O IN CRANK Y' \
   "$(sed -n 's/.*%  \([AO] IN [A-Z]* [XY]\) .*/\1/p' "$w/drawn.lst" | sort -u | tr '\n' ',' | sed 's/,$//')"
# A pin A of an in-line slider-crank: +-0.05 in both links, 0.05 sqrt(2); of one link 0.05; both holes together 0.
inline() {
   card UNITS MM DEG S; card GROUND BASE; card LINK CRANK; card LINK ROD; card LINK SLIDER; card JOINT O BASE CRANK 0.0 0.0
   card JOINT A CRANK ROD 30.0 0.0; printf '%s\n' "$@"; card JOINT B SLIDER ROD 110.0 0.0; card POINT G BASE; card PRISM G B GUIDE
   card DRIVE ANGLE CRANK '' '' 30.0; card AT '' '' '' 0.0; card PRINT POINTS B; card END
}
spread() { inline "$@" > "$w/inline.deck"; run inline; awk '/^  RSS/ { print $2; exit }' "$w/inline.lst"; }
equal 'both holes' 0.07071 "$(spread "$(card TOLER '' '' '' 0.05)")"
equal 'one hole' 0.05000 "$(spread "$(card TOLER ROD '' '' 0.05)")"
equal 'each hole its own' 0.05000 "$(spread "$(card TOLER ROD '' '' 0.04)" "$(card TOLER CRANK '' '' 0.03)")"
equal 'both holes together' 0.00000 "$(spread "$(card TOLER BOTH '' '' 0.05)")"
# Two cranks, mechanisms of their own, on ground joints that lengths give: P0 (0, 0), R0 (3, 0), Q1 (0, 4), Q2 (3, 4). If P0 Q1
# grows by d, Q1 moves by (4/3, 1) d on its circle about R0, and Q2 on both of its circles by (4/3, 0) d.
{ card UNITS MM DEG S; card GROUND BASE; card LINK FIRST; card LINK SECOND; card POINT P0 BASE; card POINT R0 BASE '' 3.0
   card JOINT Q1 BASE FIRST 0.0 4.0; card JOINT Q2 BASE SECOND 3.0 4.0; card POINT E SECOND '' 4.0 4.0
   card LENGTH P0 Q1 '' 4.0; card TOLER '' '' '' 0.03; card LENGTH R0 Q1 '' 5.0; card LENGTH Q1 Q2 '' 3.0; card LENGTH R0 Q2 '' 4.0
   card DRIVE ANGLE FIRST '' 0.0 30.0; card DRIVE ANGLE SECOND '' 0.0 20.0; card AT '' '' '' 1.0; card PRINT POINTS E; card END
} > "$w/apart.deck"
run apart
equal 'a length moves the ground joint of another mechanism' '0.040000 0.000000' "$(awk '/^  WORST/ { print $2, $3 }' "$w/apart.lst")"

# Both holes of A together move the drawn direction of the crank, with which its drive begins: 0.1 mm*20/(20**2 + 20**2) rad.
{ book | sed -e 's/^JOINT   A .*/&\nTOLER   BOTH                    0.0             0.1/' -e 's/^\(DRIVE.*\) 30.0/\1     /'; card AT '' '' '' 0.0; card PRINT LINKS CRANK; } | made both
run both
equal 'both holes and lengths' 0.14323945 "$(awk -F, '$4 == "LINK RSS" { printf "%.8f", $8 }' "$w/both.csv")"

# TOLER is the difference of decks with other numbers: of drawn directions that lengths turn, of the points and ground links from
# which they are counted, in two mechanisms.
# typed CARD K NUMBER TOLER: the deck on standard input with number K of a card, and a TOLER card below it, unless that is blank
typed() { awk -v card="$1" -v k="$2" -v number="$3" -v toler="$4" 'index($0, card) == 1 {
   $0 = sprintf("%-80s", $0); print substr($0, 1, 16 + 16*k) sprintf("%-16s", number) substr($0, 33 + 16*k); if (toler != "") print toler; next } 1'; }
# differences NAME CARD K NUMBER LINK: how many numbers of rows of $w/typed.deck have other sensitivities than differences of decks
differences() {
   for change in -0.001 0.001 0.0; do
      toler=
      [ $change != 0.0 ] || toler=$(printf "TOLER   %-24s%*s1.0E-5" "$5" $((16*$3 - 16)) '')
      typed "$2" "$3" "$(awk -v x="$4" -v d=$change 'BEGIN { printf "%.6f", x + d }')" "$toler" < "$w/typed.deck" > "$w/changed.deck"
      "$kinmat" "$w/changed.deck" --no-listing --csv - 2> "$w/err" | awk -F, -v change=$change '$4 ~ /^(LINK|POINT)( RSS)?$/ {
         for (k = 6; k <= 14; k++) if ($k != "") print change, $4, $5, k, $k }'
   done | sed 's/ RSS/-RSS/' > "$w/rows"
   equal "$1: sensitivities by differences" '0 wrong' "$(awk '{ value[$1 " " $2 " " $3 " " $4] = $5 } $2 ~ /-RSS/ { list[++n] = $3 " " $4; sub(/-RSS/, "", $2); kind[n] = $2 }
      END { for (i = 1; i <= n; i++) { s = value["0.0 " kind[i] "-RSS " list[i]]/1e-5
         d = (value["0.001 " kind[i] " " list[i]] - value["-0.001 " kind[i] " " list[i]])/0.002; if (d < 0) d = -d
         if (s - d > 1e-4*(1 + d) || d - s > 1e-4*(1 + d)) wrong++ }
         print (n > 0 ? wrong + 0 : "no") " wrong" }' "$w/rows")"
}
plate "$(card LENGTH A B '' 70.0)" "$(card LENGTH A C '' 50.0)" "$(card LENGTH B C '' 55.0)" "$(card DRIVE ANGLE PLATE '' '' 10.0)" \
   "$(card AT '' '' '' 0.0)" "$(card PRINT LINKS)" | sed 's/^\(LINK    PLATE *A *\)B/\1C/' | made typed
for number in 'A 1 20.0' 'A 2 20.0' 'B 1 80.0' 'C 1 30.0' 'B0 1 90.0'; do
   set -- $number
   differences "joint $1" "JOINT   $1 " $2 $3 BOTH
done
{ card UNITS MM DEG S; card GROUND BASE; card GROUND SOIL '' '' 0.5 -0.2 10.0; card LINK FIRST; card LINK SECOND; card LINK THIRD
   card POINT P SOIL '' -0.4 0.1; card POINT R SOIL '' 2.5 0.3; card POINT M SOIL '' 1.0 -3.0; card POINT N SOIL '' 2.4 -2.5
   card JOINT Q1 BASE FIRST 0.0 4.0; card JOINT Q2 BASE SECOND 3.0 4.0; card POINT E SECOND '' 4.0 4.0; card POINT N1 THIRD
   card POINT T THIRD '' 2.0 1.0; card REVOLUTE N N1 PN
   card LENGTH P Q1 '' 4.0; card LENGTH R Q1 '' 5.0; card LENGTH Q1 Q2 '' 3.0; card LENGTH R Q2 '' 4.0; card LENGTH M N '' 2.0
   for link in FIRST SECOND THIRD; do card DRIVE ANGLE $link '' 0.0 20.0; done; card AT '' '' '' 1.0; card PRINT POINTS; card END
} > "$w/typed.deck"
for number in 'POINT:R 1 2.5' 'POINT:P 2 0.1' 'POINT:M 1 1.0' 'GROUND:SOIL 1 0.5' 'GROUND:SOIL 3 10.0'; do
   set -- $number
   differences "$1" "$(card "${1%:*}" "${1#*:}") " $2 $3
done
for joint in 'Q1 0.0' 'Q2 3.0'; do set -- $joint; differences "joint $1 of two mechanisms" "JOINT   $1 " 1 $2 BOTH; done

# Six-bars made by chance, the coupler's axes towards a joint that two lengths place, driven from where it is drawn.
for k in 1 2 3 4 5; do
   awk -v k=$k 'BEGIN { n = 1 } n == k; /^END/ { n++ }' "$w/chance.deck" | sed -e '/^TOLER/d' -e '/^PRINT   POINTS/d' \
      -e 's/^\(LINK    COUPLER\).*/\1 A       C/' -e "s/^DRIVE.*/$(card DRIVE ANGLE COUPLER '' '' 1.0)/" -e "s/^AT .*/$(card AT '' '' '' 0.0)/" > "$w/typed.deck"
   for joint in A B C; do
      differences "drawn by chance $k, joint $joint" "JOINT   $joint " 1 "$(awk -v name=$joint '$1 == "JOINT" && $2 == name { print substr($0, 33, 16) + 0 }' "$w/typed.deck")" BOTH
   done
done

# What is rejected.
# error NAME WORDS: as `refused`, of the cards on standard input
error() { { card UNITS MM DEG S; cat; card END; } | refused "$@"; }
plate "$(card LENGTH A B '' 70.0)" "$(card LENGTH A C '' 50.0)" "$(card LENGTH B C '' 15.0)" "$turn" "$hours" |
   error 'circles apart' 'E099 CARD 17 COLUMN 33 FIELD REAL-1: "15.0" DOES NOT MEET THE OTHER LENGTH OF THIS POINT; MISSING 5.0 MM'
plate "$(card LENGTH A B '' 70.0)" "$(card LENGTH A C '' 150.0)" "$(card LENGTH B C '' 60.0)" "$turn" "$hours" |
   error 'one circle in the other' 'E099 CARD 17 COLUMN 33 FIELD REAL-1: "60.0" DOES NOT MEET THE OTHER LENGTH OF THIS POINT; MISSING 20.0 MM'
plate "$(card LENGTH A C '' 50.0)" "$(card LENGTH B C '' 55.0)" "$(card LENGTH A B '' 70.0)" "$turn" "$hours" |
   error 'Q was used as P' 'E095 CARD 17 COLUMN 17 FIELD LABEL-B: "B" WOULD MOVE AFTER ITS USE: EXCHANGE THE TWO POINTS; IT WAS USED ON CARD 16'
plate "$(card LENGTH A B '' 70.0)" "$(card LENGTH A C '' 50.0)" "$(card LENGTH B C '' 55.0)" "$(card LENGTH A C '' 50.0)" "$turn" "$hours" |
   error 'three lengths' 'E097 CARD 18 COLUMN 17 FIELD LABEL-B: "C" HAS TWO LENGTHS ALREADY: REMOVE ONE OF THE THREE; FIRST ON CARD 16'
plate "$(card LENGTH A B '' 70.0)" "$(card LENGTH A B '' 70.0)" "$turn" "$hours" |
   error 'a length twice' 'E096 CARD 16 COLUMN 17 FIELD LABEL-B: "B" IS REPEATED; FIRST ON CARD 15'
plate "$(card LENGTH A B '' 70.0)" "$(card LENGTH B A '' 70.0)" "$turn" "$hours" |
   error 'a length back' 'E095 CARD 16 COLUMN 17 FIELD LABEL-B: "A" WOULD MOVE AFTER ITS USE: EXCHANGE THE TWO POINTS; IT WAS USED ON CARD 15'
plate "$(card LENGTH A E '' 70.0)" "$turn" "$hours" |
   error 'two links' 'E090 CARD 15 COLUMN 17 FIELD LABEL-B: "E" IS ON NO LINK OF THE POINT BEFORE IT: NAME POINTS OF ONE LINK OR OF GROUND'
plate "$(card LENGTH A B CRANK 70.0)" "$turn" "$hours" |
   error 'another link' 'E092 CARD 15 COLUMN 25 FIELD LABEL-C: "CRANK" IS NOT A LINK OF BOTH POINTS'
plate "$(card LENGTH A A '' 70.0)" "$turn" "$hours" | error 'one point' 'E062 CARD 15 COLUMN 17 FIELD LABEL-B: "A" IS NAMED TWICE: NAME TWO POINTS'
plate "$(card LENGTH A B)" "$turn" "$hours" | error 'no length' 'E034 CARD 15 COLUMN 33 FIELD REAL-1: THE FIELD IS BLANK: FILL IT IN'
plate "$(card LENGTH A B '' 0.0)" "$turn" "$hours" | error 'length 0' 'E036 CARD 15 COLUMN 33 FIELD REAL-1: "0.0" IS OUT OF RANGE; ALLOWED: ABOVE 0.0'
plate "$(card POINT T PLATE '' 10.0 5.0)" "$(card LENGTH A T '' 12.0)" "$turn" "$hours" |
   error 'a point of a bar' 'E094 CARD 16 COLUMN 17 FIELD LABEL-B: "T" HAS EXACT COORDINATES, COUNTED ALONG THE BAR OF ITS LINK: OMIT ITS LENGTH'
plate "$(card LENGTH A B '' 70.0)" "$(card LENGTH A C '' 50.0)" "$(card LENGTH B C '' 55.0)" "$turn" "$hours" | sed 's/^JOINT   C .*/JOINT   C       PLATE   ROD     50.0            40.0/' |
   error 'on no side' 'E086 CARD 16 COLUMN 17 FIELD LABEL-B: "C" IS DRAWN IN LINE WITH BOTH OTHER POINTS: DRAW IT ON ITS SIDE OF THEM'
plate "$(card LENGTH A C '' 50.0)" "$turn" "$hours" | sed 's/^JOINT   C .*/JOINT   C       PLATE   ROD     20.0            20.0/' |
   error 'at one place' 'E093 CARD 15 COLUMN 17 FIELD LABEL-B: "C" IS DRAWN AT THE PLACE OF THE OTHER POINT: DRAW THEM APART'
{ card GROUND BASE; card LINK CRANK; card LINK ROD; card JOINT A0 BASE CRANK 0.0 0.0; card JOINT A CRANK ROD 1.0 0.0; card JOINT B CRANK ROD 2.0 0.0
  card LENGTH A B '' 1.5; echo "$turn"; echo "$hours"; } | error 'several links' 'E091 CARD 8 COLUMN 25 FIELD LABEL-C: BOTH POINTS ARE ON SEVERAL LINKS: NAME ONE OF THESE LINKS'
plate "$turn" "$hours" | sed 's/^LINK    ROD .*/LINK    ROD     C       B/' | error 'TO on another link' 'E073 CARD 6 COLUMN 25 FIELD LABEL-C: "B" IS NOT A JOINT OF THIS LINK'
plate "$turn" "$hours" | sed 's/^LINK    ROD .*/LINK    ROD     C/' | error 'no TO' 'E034 CARD 6 COLUMN 25 FIELD LABEL-C: THE FIELD IS BLANK: FILL IT IN'
plate "$turn" "$hours" | sed 's/^LINK    ROD .*/LINK    ROD     C       EE/' | error 'TO unknown' 'E052 CARD 6 COLUMN 25 FIELD LABEL-C: "EE" IS NOT THE NAME OF A POINT (NEAREST NAME: E)'
plate "$turn" "$hours" | sed 's/^LINK    ROD .*/LINK    ROD     C       C/' |
   error 'FROM is TO' 'E076 CARD 6 COLUMN 25 FIELD LABEL-C: "C" IS DRAWN AT THE PLACE OF THE OTHER JOINT: THE AXES HAVE NO DIRECTION'
{ card GROUND BASE; card LINK CRANK O T; card POINT O BASE; card POINT O1 CRANK; card POINT T CRANK '' 1.0; card REVOLUTE O O1 PO; echo "$turn"; echo "$hours"; } |
   error 'no drawing' 'E072 CARD 3 COLUMN 17 FIELD LABEL-B: "O" NEEDS A DRAWING, THAT IS JOINT CARDS: AXES ALONG A BAR BEGIN AT A JOINT'
card TOLER BASE '' '' 0.1 | { read -r bar; inline "$bar" | sed '1d;$d'; } |
   error 'a hole of another link' 'E044 CARD 8 COLUMN 9 FIELD LABEL-A: "BASE" IS NO LINK OF THE JOINT ABOVE: NAME ONE OF ITS LINKS, OR BOTH'
# Two lengths give the place of C on the plate, none that on the rod.
placed() { plate "$(card LENGTH A C '' 50.0)" "$(card LENGTH B C '' 55.0)" "$turn" "$(card AT '' '' '' 0.0)" | sed "s/^JOINT   C .*/&\n$1/"; }
for link in '' PLATE; do
   placed "$(card TOLER "$link" '' '' 0.1)" |
      error "the place of two lengths, $link" 'E048 CARD 13 COLUMN 1 FIELD NAME: "TOLER" IS FOR A PLACE THAT TWO LENGTHS GIVE: PUT IT BELOW THE LENGTH CARDS'
done
for link in ROD BOTH; do
   placed "$(card TOLER "$link" '' '' 0.1)" | made placed
   run placed
   equal "a hole beside two lengths: $link" '' "$(cat "$w/placed.err")"
done
plate "$(card POINT F PLATE '' 60.0 80.0)" "$(card TOLER '' '' '' 0.1)" "$(card LENGTH A F '' 60.0)" "$(card LENGTH B F '' 40.0)" "$turn" "$hours" |
   sed 's/^LINK    PLATE.*/LINK    PLATE/' |
   error 'a point that two lengths place' 'E048 CARD 16 COLUMN 1 FIELD NAME: "TOLER" IS FOR A PLACE THAT TWO LENGTHS GIVE: PUT IT BELOW THE LENGTH CARDS'
inline "$(card TOLER ROD '' '' 0.1)" "$(card TOLER ROD '' '' 0.1)" | sed '1d;$d' |
   error 'a hole twice' 'E042 CARD 9 COLUMN 1 FIELD NAME: "TOLER" IS A SECOND * OR TOLER CARD FOR THE SAME CARD'
inline "$(card TOLER ROD '' '' 0.1)" "$(card TOLER '' '' '' 0.1)" | sed '1d;$d' |
   error 'a hole and all' 'E042 CARD 9 COLUMN 1 FIELD NAME: "TOLER" IS A SECOND * OR TOLER CARD FOR THE SAME CARD'
inline | sed -e 's/^DRIVE.*/&\nTOLER   CRANK                   0.1/' -e '1d;$d' |
   error 'a link for a drive' 'E019 CARD 13 COLUMN 9 FIELD LABEL-A: "CRANK" IS IN A FIELD THAT THIS CARD DOES NOT USE'
conclude
