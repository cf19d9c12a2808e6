#!/bin/sh
# A deck with all its lengths times a power of ten prints the same digits: every deck of input/, from millionths to
# millions. The lengths are changed in the text of the cards, by their exponents, so that no decimal is rounded.
. tests/counting.sh

# enlarged K DECK: the deck with its lengths times 10**K. A card with * in column 1 has the numbers of the card above it,
# TOLER their tolerances.
enlarged() {
   awk -v k="$1" '
      function scaled(text,  e, i) {
         gsub(/ /, "", text)
         if (text == "") return text
         text = toupper(text); i = index(text, "E")
         e = i ? substr(text, i + 1) + k : k
         return (i ? substr(text, 1, i - 1) : text) "E" e
      }
      # Which of the three numbers of a card are lengths.
      function lengths(card, form) {
         if (card == "GROUND" || card == "LINK" || card == "POINT" || card == "JOINT") return "110"
         if (card == "PRISM") return "010"
         if (card == "DRIVE") { driven = form ~ /^(X|Y|SLIDE)$/; return driven ? "111" : "000" }
         if (card == "ADD" && driven) return form == "TABLE" ? "010" : "100"
         if (card == "RISE" && driven) return "001"
         return "000"
      }
      /^[$]/ || /^ *$/ || /^TITLE/ { print; next }
      {
         line = sprintf("%-80s", $0); star = line ~ /^\*/
         if (!star) { split(substr(line, 1, 8), c, " "); split(substr(line, 9, 8), f, " ") }
         if (!star && c[1] != "TOLER") which = lengths(c[1], f[1])
         width = star ? 24 : 16; first = star ? 9 : 33
         out = substr(line, 1, first - 1)
         for (n = 0; n < 3; n++) {
            field = substr(line, first + n*width, width)
            if (substr(which, n + 1, 1) == 1) field = scaled(field)
            out = out sprintf("%-" width "s", field)
         }
         sub(/ *$/, "", out); print out
      }' "$2"
}

# digits LISTING: its rows of numbers without points, leading zeros and powers of ten.
digits() {
   awk '/^ RESULTS|^ WYNIKI/ { told = 1 } /^ SET OF |^ KOMPLET / { told = 0 }
        told && NF > 1 && $NF ~ /^(-?[0-9.?]+(E[-+][0-9]+)?|NONE)$/ && $1 !~ /^(INSTANT|CHWILA|END|KONIEC)/ {
      line = $1
      for (i = 2; i <= NF; i++) {
         minus = $i ~ /^-/ ? "-" : ""; gsub(/[-.]/, "", $i); sub(/^0+/, "", $i); line = line " " minus $i
      }
      print line }' "$1"
}

for deck in $(grep -L '^VARY' input/*.deck); do
   name=$(basename "$deck" .deck)
   digits "expected/$name.lst" > "$w/wanted"
   equal "$name: rows are compared" yes "$([ "$(wc -l < "$w/wanted")" -gt 10 ] && echo yes)"
   powers='-6 -3 -1 2 3 6'
   # Their largest numbers take all the room of a column; in tenths and hundreds there is none for as many decimals.
   case $name in far_small|dead_point_*) powers='-6 -3 3 6' ;; esac
   for k in $powers; do
      enlarged $k "$deck" > "$w/deck"
      "$BUILD/kinmat" "$w/deck" > "$w/lst" 2> "$w/err"
      status=$?
      equal "$name times 10**$k: status" "$(grep -qE ' (FLAGGED|ZAZNACZONE) [1-9]' "expected/$name.lst" && echo 2 || echo 0)" $status
      digits "$w/lst" > "$w/out"
      same "$name times 10**$k: the same digits" "$w/wanted" "$w/out"
   done
done
conclude
