#!/bin/sh
# Decks with JOINT cards: the drawing is the mechanism. Blank numbers are as drawn, cylinders, and the remarks on a drawing.
. tests/counting.sh

# run NAME OPTION...: the deck $w/NAME.deck; its listing, CSV and messages are in $w/NAME.*
run() {
   deck=$w/$1.deck
   base=$w/$1
   shift
   "$kinmat" "$deck" -o "$base.lst" --csv "$base.csv" "$@" 2> "$base.err"
   status=$?
}
# value NAME KIND SUBJECT COLUMN STEP: a number of a row of the CSV, with nine digits
value() { awk -F, -v kind="$2" -v name="$3" -v column="$4" -v step="$5" \
   'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } $(at["step"]) == step && $(at["kind"]) == kind && $(at["name"]) == name {
      x = $(at[column]); printf "%.9g\n", (x < 1e-12 && x > -1e-12) ? 0 : x }' "$w/$1.csv"; }
remarks() { sed -n 's/^ --- CARD [0-9]*  COLUMN [0-9]*: //p' "$w/$1.lst"; }
echoed() { grep -E "^ $2 " "$w/$1.lst" | head -n 1 | tr -s ' ' | sed 's/ $//'; }
number() { awk "BEGIN { pi = atan2(0, -1); printf \"%.9g\n\", $1 }"; }

# slider PHI PRISM-CARD DRIVE-CARD...: crank 1 about (0, 0), drawn upright, rod to a slider at (3, 0.5) with its axes at PHI
slider() {
   card UNITS M DEG S; card GROUND BASE; card LINK CRANK; card LINK ROD; card LINK SLIDER '' '' 3.0 0.5 "$1"
   card JOINT A0 BASE CRANK 0.0 0.0; card JOINT A CRANK ROD 0.0 1.0; card JOINT B SLIDER ROD 3.0 0.5
   card POINT O BASE '' 0.0 0.0
   shift
   printf '%s\n' "$@"; card PRINT ALL; card END
}
turn=$(card DRIVE ANGLE CRANK '' '' 30.0)
hours=$(card TIME 12 '' '' 0.0 12.0)

# The offset drawn makes an offset slider-crank: in the first instant all is where it is drawn; its stroke by Pythagoras.
slider '' "$(card PRISM O B GUIDE)" "$turn" "$(card TIME 720 '' '' 0.0 12.0)" "$(card EXTREMES PAIRS GUIDE)" > "$w/offset.deck"
run offset
equal 'an offset: status' 0 $status
equal 'an offset: the slider where it is drawn' '3 0.5' "$(echo $(value offset POINT B x 0) $(value offset POINT B y 0))"
equal 'an offset: echo' ' PRISM O B GUIDE 0.0 -0.5 (AS DRAWN) 0.0 (AS DRAWN)' "$(echoed offset PRISM)"
equal 'an offset: no remark' '' "$(remarks offset)"
equal 'an offset: stroke' "$(awk 'BEGIN { r = sqrt(9.25); printf "%.5f", sqrt((r + 1)^2 - 0.25) - sqrt((r - 1)^2 - 0.25) }')" \
   "$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } $(at["kind"]) == "PAIR" && $(at["name"]) == "GUIDE" {
      x = $(at["x"]); if (!n++ || x < a) a = x; if (n == 1 || x > b) b = x }
      END { printf "%.5f", b - a }' "$w/offset.csv")"
# A number on the card is a number, also 0.0; where it contradicts the drawing, that is said.
slider '' "$(card PRISM O B GUIDE '' 0.0 0.0)" "$turn" "$hours" > "$w/typed.deck"
run typed
equal 'h 0.0: the slider is moved to the axis' '2.87228132 0' "$(echo $(value typed POINT B x 0) $(value typed POINT B y 0))"
equal 'h 0.0: remark' '"GUIDE" ITS NUMBERS CONTRADICT THE DRAWING; CLOSURE ERROR THERE: -0.5 M' "$(remarks typed)"
slider 30.0 "$(card PRISM O B GUIDE '' -0.5 0.0)" "$turn" "$hours" > "$w/turned.deck"
run turned
equal 'beta 0.0 of axes at 30 deg: remark' '"GUIDE" ITS NUMBERS CONTRADICT THE DRAWING; CLOSURE ERROR THERE: 30.0 DEG' "$(remarks turned)"
slider 30.0 "$(card PRISM O B GUIDE)" "$turn" "$hours" > "$w/beta.deck"
run beta
equal 'beta as drawn' 30 "$(value beta LINK SLIDER phi 5)"
equal 'beta as drawn: echo' ' PRISM O B GUIDE 0.0 -0.5 (AS DRAWN) 30.0 (AS DRAWN)' "$(echoed beta PRISM)"
# Where only rounding makes a difference, h is 0: a guide at 30 deg through points of 17 digits.
slider '' "$(card POINT R SLIDER)" '*       0.86602540378443865     0.5' "$(card PRISM O R GUIDE 30.0)" "$turn" "$(card AT '' '' '' 0.0)" \
   | sed 's/^LINK    SLIDER.*/LINK    SLIDER/' > "$w/rounded.deck"
run rounded
equal 'a guide through both points' ' PRISM O R GUIDE 30.0 0.0 (AS DRAWN) 0.0 (AS DRAWN)' "$(echoed rounded PRISM)"
equal 'a guide through both points: no remark' '' "$(remarks rounded)"

# Drives begin where they are drawn.
# begins NAME DRIVE-CARD KIND SUBJECT COLUMN VALUE ECHO
begins() {
   slider 30.0 "$(card PRISM O B GUIDE -15.0 '' '')" "$2" "$hours" | sed 's/^LINK    CRANK$/LINK    CRANK                                                   20.0/' > "$w/drive.deck"
   run drive
   equal "$1: at t = 0" "$6" "$(value drive "$3" "$4" "$5" 0)"
   equal "$1: echo" " DRIVE $7" "$(echoed drive DRIVE)"
}
slide=$(number '3*cos(pi/12) - 0.5*sin(pi/12)')
begins 'a driven angle' "$turn" LINK CRANK phi 20 'ANGLE CRANK 20.0 (AS DRAWN) 30.0 0.0'
begins 'a driven relative angle' "$(card DRIVE RELANGLE CRANK SLIDER '' 1.0)" LINK CRANK phi 20 'RELANGLE CRANK SLIDER 10.0 (AS DRAWN) 1.0 0.0'
begins 'a driven place, x' "$(card DRIVE X B '' '' 0.01)" POINT B x 3 'X B 3.0 (AS DRAWN) 0.01 0.0'
begins 'a driven place, y' "$(card DRIVE Y B '' '' 0.01)" POINT B y 0.5 'Y B 0.5 (AS DRAWN) 0.01 0.0'
begins 'a driven slide' "$(card DRIVE SLIDE GUIDE '' '' 0.01)" PAIR GUIDE x "$slide" "SLIDE GUIDE $slide (AS DRAWN) 0.01 0.0"
# Tables are absolute; harmonics and rises are added to what is drawn.
slider '' "$(card PRISM O B GUIDE)" "$(card DRIVE SLIDE GUIDE)" "$(card ADD TABLE '' '' 0.0 2.5)" "$(card ADD TABLE '' '' 12.0 2.0)" \
   "$hours" > "$w/table.deck"
run table
equal 'a table is absolute' 2.5 "$(value table PAIR GUIDE x 0)"
equal 'a table is absolute: echo' ' DRIVE SLIDE GUIDE 0.0 0.0 0.0' "$(echoed table DRIVE)"
slider '' "$(card PRISM O B GUIDE)" "$(card DRIVE SLIDE GUIDE)" "$(card RISE CYCLOID '' '' 0.0 6.0 -0.5)" "$hours" > "$w/rise.deck"
run rise
equal 'a rise from where it is drawn' '3 2.5' "$(echo $(value rise PAIR GUIDE x 0) $(value rise PAIR GUIDE x 12))"
slider '' "$(card LANG PL)" "$(card PRISM O B GUIDE)" "$(card DRIVE ANGLE CRANK '' '' 30.0)" "$(card AT '' '' '' 1.0)" > "$w/polish.deck"
run polish
equal 'in Polish: echo' ' PRISM O B GUIDE 0.0 -0.5 (WG RYS.) 0.0 (WG RYS.)' "$(echoed polish PRISM)"

# A variant of coordinates moves what is drawn, as the deck with the numbers does: a row of the summary and all results.
# vary NAME BELOW NUMBER VALUES...: VARY below the card that BELOW matches; SED puts each value into it
vary() {
   name=$1; below=$2; place=$3
   shift 3
   awk -v below="$below" -v vary="$(card VARY "R$place" LIST '' "$@")" '{ print } $0 ~ below { print vary }' "$w/plain.deck" > "$w/vary.deck"
   "$kinmat" "$w/vary.deck" --summary "$w/vary.sum" -o "$w/vary.lst" 2> "$w/vary.err"
   n=0
   for one in "$@"; do
      n=$((n + 1))
      awk -v below="$below" -v place="$place" -v one="$one" '$0 ~ below {
         line = sprintf("%-80s", $0)
         $0 = substr(line, 1, 16 + 16*place) sprintf("%-16s", one) substr(line, 33 + 16*place) }
         { print }' "$w/plain.deck" | sed "s/ *$//;s/^TIME.*/&\n$(card VARY R1 1 '' 0.0)/" > "$w/one.deck"
      "$kinmat" "$w/one.deck" --summary "$w/one.sum" -o "$w/one.lst" 2> "$w/one.err"
      equal "$name $one" "$(awk -F, 'NR == 2 { for (i = 4; i <= NF; i++) printf "%.11g ", $i }' "$w/one.sum")" \
         "$(awk -F, -v n=$n 'NR == 1 + n { for (i = 4; i <= NF; i++) printf "%.11g ", $i }' "$w/vary.sum")"
   done
}
slider 30.0 "$(card PRISM O B GUIDE -15.0)" "$(card DRIVE SLIDE GUIDE '' '' -0.02)" "$hours" "$(card EXTREMES POINTS A)" | grep -v '^PRINT' > "$w/plain.deck"
vary 'a joint that varies' '^JOINT   B ' 2 0.5 0.75 0.25
vary 'a point that varies' '^POINT   O ' 1 0.5 -0.25 0.125
vary 'alpha that varies' '^PRISM' 1 -10.0 -5.0 0.0
vary 'a blank h that varies' '^PRISM' 2 -1.25 -1.0 -0.75
vary 'a value of a drive that varies' '^DRIVE' 1 2.9 2.8 2.7

# Cylinders. A boom about (0, 0), its eye at (1.5, 1); the cylinder stands on (2, -1).
# boom P-X P-Y CARD...
boom() {
   card UNITS M DEG S; card GROUND BASE; card LINK BOOM; card LINK BARREL; card LINK ROD '' '' '' '' 15.0
   card JOINT O BASE BOOM 0.0 0.0; card JOINT P BASE BARREL "$1" "$2"
   card JOINT Q ROD BOOM 1.5 1.0
   shift 2
   printf '%s\n' "$@"; card PRINT ALL; card END
}
push=$(card DRIVE SLIDE RAM '' '' 0.1)
for foot in '2.0 -1.0' '1.5 -1.0' '3.0 1.0' '-1.0 2.0' '0.5 1.0' '1.25 3.0'; do
   boom $foot "$(card CYLINDER P Q RAM)" "$push" "$(card AT '' '' '' 0.0 0.25)" "$(card PROVE)" > "$w/boom.deck"
   run boom --svg "$w/boom.svg"
   length=$(echo $foot | awk '{ printf "%.9g\n", sqrt((1.5 - $1)^2 + (1 - $2)^2) }')
   equal "cylinder from $foot: status" 0 $status
   equal "cylinder from $foot: its slide is its length" "$length" "$(value boom PAIR RAM x 0)"
   equal "cylinder from $foot: where it is drawn" '1.5 1 15' \
      "$(echo $(value boom POINT Q x 0) $(value boom POINT Q y 0) $(value boom LINK ROD phi 0))"
   equal "cylinder from $foot: its length grows" "$(awk "BEGIN { printf \"%.8g\", $length + 0.025 }")" \
      "$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } $(at["step"]) == 1 && $(at["kind"]) == "POINT" {
         x[$(at["name"])] = $(at["x"]); y[$(at["name"])] = $(at["y"]) }
         END { printf "%.8g", sqrt((x["Q"] - x["P"])^2 + (y["Q"] - y["P"])^2) }' "$w/boom.csv")"
   equal "cylinder from $foot: proved, no marks" ' INSTANTS PROVED 2 / 2' "$(grep -o ' INSTANTS PROVED .* / [0-9]*' "$w/boom.lst")$(grep '?:' "$w/boom.lst")"
   equal "cylinder from $foot: a picture" yes "$([ -s "$w/boom.svg" ] && echo yes)"
done
equal 'ruler' 'CYLINDERPOINT-P POINT-Q PAIR    LEAST           GREATEST' "$("$kinmat" --ruler CYLINDER | sed -n 2p)"
ram=$(card CYLINDER P Q RAM)
boom 1.5 1.0 "$ram" "$push" "$hours" |
   refused 'a cylinder without a length' \
      'E069 CARD 9 COLUMN 17 FIELD LABEL-B: "Q" BOTH POINTS ARE DRAWN AT ONE PLACE: THE CYLINDER HAS NO DIRECTION'
boom 2.0 -1.0 "$ram" "$(card TOLER '' '' '' 0.1)" "$push" "$hours" | refused 'a tolerance of a cylinder' \
   'E046 CARD 10 COLUMN 33 FIELD REAL-1: "0.1" IS A TOLERANCE FOR A FIELD THAT CANNOT HAVE ONE'
boom 2.0 -1.0 "$(card CYLINDER P Q RAM '' '' 1.0)" "$push" "$hours" |
   refused 'a third number on a cylinder' \
      'E019 CARD 9 COLUMN 65 FIELD REAL-3: "1.0" IS IN A FIELD THAT THIS CARD DOES NOT USE'
{
   card GROUND BASE; card LINK BARREL; card LINK ROD; card POINT P0 BASE; card POINT P BARREL; card POINT Q ROD '' 1.0
   card REVOLUTE P0 P FOOT; card CYLINDER P Q RAM; card DRIVE ANGLE BARREL; card DRIVE SLIDE RAM '' 1.0; card AT '' '' '' 0.0; card END
} |
   refused 'a cylinder without a drawing' \
      'E065 CARD 8 COLUMN 1 FIELD NAME: "CYLINDER" A CYLINDER NEEDS A DRAWING, THAT IS JOINT CARDS; OTHERWISE USE PRISM'

# The same decks with POINT, REVOLUTE and PRISM cards, and all numbers typed in: the same results but for the last digits.
for deck in drawn_slider drawn_cylinder drawing; do
   sed '/^PRINT/d;s/^END.*/PRINT   ALL\n&/' "input/$deck.deck" > "$w/drawn.deck"
   awk -v change=whole -v map=/dev/null -f tests/system/relation_deck.awk "$w/drawn.deck" > "$w/typed.deck"
   run drawn
   run typed
   equal "$deck, typed in" 'compared, 0 off' "$(awk -F, 'FNR == 1 { file++; next } $4 == "POINT" && $5 ~ /-2$/ { next }
      { key = $1 "," $2 "," $4 "," $5 }
      file == 1 { row[key] = $0; next }
      key in row { split(row[key], x, ","); compared = "compared"
         for (i = 6; i <= 14; i++) { d = $i - x[i]; if (d > 1e-10 || d < -1e-10) off++ } }
      END { print compared ", " off + 0 " off" }' "$w/drawn.csv" "$w/typed.csv")"
done

# The numbers of a drawing that contradict it by points: a pair of two points that lie apart.
slider '' "$(card LINK ARM)" "$(card POINT S ROD '' 1.5 0.75)" "$(card POINT S2 ARM '' 1.5 1.0)" "$(card REVOLUTE S S2 PIN)" \
   "$(card JOINT T BASE ARM 1.5 3.0)" "$turn" "$(card DRIVE ANGLE SLIDER)" "$(card AT '' '' '' 0.0)" > "$w/pin.deck"
run pin
equal 'two points of a pair drawn apart' '"PIN" ITS NUMBERS CONTRADICT THE DRAWING; CLOSURE ERROR THERE: 0.25 M' "$(remarks pin | grep PIN)"
conclude
