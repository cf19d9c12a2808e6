#!/bin/sh
# Card SLOT: its results are those of a block with a REVOLUTE and a PRISM pair, to the last digit, and the block is nowhere.
. tests/counting.sh

# whole NAME BLOCK: the deck, and the deck with a block in the place of its first SLOT card: LINK STONE, its pin at
# PIN, and the pairs. BLOCK: the cards of the block and its pairs, ^ between them.
whole() {
   name=$1
   awk -v block="$2" '/^SLOT/ && !k++ { n = split(block, cards, "^"); for (i = 1; i <= n; i++) print cards[i]; next } { print }' \
      "$w/$name.deck" > "$w/$name-block.deck"
   for deck in "$name" "$name-block"; do
      "$kinmat" "$w/$deck.deck" -o "$w/$deck.lst" --csv "$w/$deck.csv" --summary "$w/$deck.sum" --svg "$w/$deck.svg" --animate "$w/$deck.html" 2> "$w/$deck.err"
      echo $? > "$w/$deck.status"
   done
   equal "$name: status" "0 0" "$(cat "$w/$name-block.status") $(cat "$w/$name.status")"
   # TOLER names the number by its card.
   sed -i 's/PRISM SLOT \([AH][A-Z]*\)/SLOT SLOT \1 /' "$w/$name-block.lst"
   sed -i 's/PRISM SLOT/SLOT SLOT/' "$w/$name-block.csv"
   # All rows; the table of circuits, ranges, extremes, tolerances, proofs.
   same "$name: CSV" "$w/$name-block.csv" "$w/$name.csv"
   for deck in "$name" "$name-block"; do
      sed -e '1,/^ RESULTS/d' -e '/^LINK    STONE/d' -e 's/LINKS \(.*\), STONE$/LINK \1/' -e 's/LINKS \(.*\), STONE /LINK \1 /' \
         "$w/$deck.lst" > "$w/$deck.end"
   done
   same "$name: the listing after its head" "$w/$name-block.end" "$w/$name.end"
   equal "$name: no block" '' "$(grep STONE "$w/$name.lst" "$w/$name.csv" "$w/$name.sum" "$w/$name.err")"
   equal "$name: no link without a name" '' "$(grep -lE 'data-(link|pair|point)="" ?' "$w/$name.svg" "$w/$name.html")"
   equal "$name: W, R and S" "$(grep ' W = ' "$w/$name-block.lst")" "$(grep ' W = ' "$w/$name.lst")"
}

# A crank shaper by coordinates of links: the pin of the crank in the slot of a rocker, whose end drives the ram.
shaper() {
   card UNITS M DEG S; card GROUND BASE
   card LINK CRANK '' '' 0.0 1.0 30.0; card LINK ROCKER '' '' 0.0 0.0 70.0; card LINK RAM '' '' 0.5 2.5 0.0
   card POINT C BASE '' 0.0 1.0; card POINT O BASE; card POINT TRACK BASE '' 0.0 2.5
   card POINT C1 CRANK; card POINT A CRANK '' 0.4; card POINT O1 ROCKER; card POINT Q RAM
   card REVOLUTE C C1 PC; card REVOLUTE O O1 PO
   card SLOT O1 A SLOT '' 0.05
   card SLOT O1 Q TOP
   card PRISM TRACK Q GUIDE
   card DRIVE ANGLE CRANK '' 30.0 60.0
}
# Its other SLOT card stays in both decks.
{ shaper; card TIME 6 '' '' 0.0 6.0; card PRINT LINKS CRANK; card PRINT LINKS ROCKER; card PRINT LINKS RAM; card PRINT PAIRS SLOT
  card PRINT PAIRS TOP; card EXTREMES PAIRS SLOT; card EXTREMES PAIRS GUIDE; card RANGE; card PROVE; card END; } > "$w/shaper.deck"
whole shaper "$(card LINK STONE '' '' 0.34641016 1.2 70.0)^$(card POINT QB STONE)^$(card REVOLUTE QB A PIN)^$(card PRISM O1 QB SLOT '' 0.05)"
equal 'a shaper: its counts' ' LINKS 4, GROUND 1;  REVOLUTE PAIRS 2;  PRISMATIC PAIRS 3
 COORDINATES W = 18;  EQUATIONS R = 17;  DEGREES OF FREEDOM BY COUNT (13): S = 1;  DRIVES 1' "$(grep -E '^ (LINKS|COORD)' "$w/shaper.lst")"
# Its stroke: the ram is at 2.5 tan of the rocker from the upright, and the slot passes O at 0.05: sin = (0.4 +- 0.05)/1.
equal 'a shaper: stroke of the ram' "$(awk 'BEGIN { a = 0.45; b = 0.35; printf "%.4f", 2.5*(a/sqrt(1 - a*a) + b/sqrt(1 - b*b)) }')" \
   "$(awk '/^ GUIDE/ { mine = 1 } mine && / STROKE/ { printf "%.4f", $2; exit }' "$w/shaper.lst")"

# h: (P - Q) . n, P = (12, -20), Q = (30, 5), n = (-sin 60, cos 60)
h=$(awk 'BEGIN { printf "%.10f", 18*sqrt(3)/2 - 25/2 }')
# A drawn pin in the slot of a moving link, all questions, in degrees; h as drawn.
{ card UNITS MM DEG S; card GROUND BASE; card LINK CRANK; card LINK ARM; card JOINT O BASE CRANK 0.0 0.0; card JOINT A0 BASE ARM 10.0 -60.0
  card POINT PIN CRANK '' 30.0 5.0; card TOLER '' '' '' 0.1 0.1; card POINT TIP ARM '' 40.0 90.0; card POINT S ARM '' 12.0 -20.0
  card SLOT S PIN SLOT 60.0 "$h"; card TOLER '' '' '' 0.1 0.05; card DRIVE ANGLE CRANK '' '' 90.0; card TIME 8 '' '' 0.0 4.0
  card PRINT LINKS CRANK; card PRINT LINKS ARM; card PRINT POINTS TIP; card PRINT PAIRS SLOT; card EXTREMES PAIRS SLOT; card CIRCUITS; card RANGE
  card ASSEMBLY; card END; } > "$w/drawn.deck"
whole drawn "$(card LINK STONE '' '' 30.0 5.0 0.0)^$(card POINT PB STONE)^$(card REVOLUTE PB PIN PIN)^$(card PRISM S PB SLOT 60.0 "$h")"
conclude
