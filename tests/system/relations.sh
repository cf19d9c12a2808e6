#!/bin/sh
# Relations between runs, for every deck of input/: in three and seven times the steps, with its cards in the opposite order,
# moved, mirrored, and in other units of length and time, a mechanism has the same motion, and the same instants are flagged.
# Numbers may differ by the errors that --errors tells of both.
export LC_ALL=C
BUILD=${BUILD:-build}
. tests/counting.sh
kin=$BUILD/kinmat
work=$BUILD/relations
rm -rf "$work" && mkdir -p "$work" || exit 3

# changed CHANGE DECK: the deck moved by (3, -2) ("moved"), mirrored in the x axis ("mirrored"), with the cards of each set
# in the opposite order ("turned"), with its lengths times 25.4 and its times times 60 ("units"), or with
# "3" or "7" times the steps. The numbers of a card and of its * card go to one.
changed() {
   awk -v change="$1" '
      function trim(s) { gsub(/^ +| +$/, "", s); return s }
      # A number as text, its exponent D as E.
      function value(s) { s = toupper(trim(s)); sub(/D/, "E", s); return s + 0 }
      function digits(x) { return sprintf("%-24s", sprintf("%.16E", x)) }
      function number(k,  x) {
         x = value(star == "" ? "" : substr(star, 24*k - 15, 24))
         return x == 0 ? value(substr(card, 16*k + 17, 16)) : x
      }
      function is_given(k) { return trim(substr(card, 16*k + 17, 16) (star == "" ? "" : substr(star, 24*k - 15, 24))) != "" }
      # The cards of which the numbers change: which of them are turned round, and by how much they are moved.
      function work_on(  k, turned, n) {
         name = trim(substr(card, 1, 8)); form = trim(substr(card, 9, 8)); n = 3; turned = "000"
         split("0 0 0", by, " "); split("1 1 1", times, " ")
         if (name == "GROUND" || name == "LINK") { turned = "011"; by[1] = 3; by[2] = -2; times[1] = times[2] = 25.4 }
         else if (name == "POINT") { turned = "01"; n = 2; times[1] = times[2] = 25.4 }
         else if (name == "PRISM") { turned = "111"; times[2] = 25.4 }
         else if (name == "DRIVE") {
            kind = form; turned = kind ~ /^(Y|ANGLE|RELANGLE)$/ ? "111" : "000"
            by[1] = kind == "X" ? 3 : kind == "Y" ? -2 : 0
            long = kind ~ /ANGLE/ ? 1 : 25.4; times[1] = long; times[2] = long/60; times[3] = long/3600
         } else if (name == "ADD") {
            turned = kind !~ /^(Y|ANGLE|RELANGLE)$/ ? "000" : form == "TABLE" ? "010" : "100"
            if (form == "HARMONIC") { times[1] = long; times[2] = 1/60 } else n = 2
            if (form == "TABLE") { times[1] = 60; times[2] = long }
            if (form == "POWER") times[1] = long/60^number(2)
         } else if (name == "RISE") {
            turned = kind ~ /^(Y|ANGLE|RELANGLE)$/ ? "001" : "000"
            times[1] = times[2] = 60; times[3] = long
         } else if (change == "units" && name ~ /^(TIME|AT|BRANCH)$/) {
            times[1] = times[2] = times[3] = 60; n = name == "AT" ? 3 : name == "TIME" ? 2 : 1
         }
         else { add_card(card (star == "" ? "" : "\n" star)); return }
         out = "*       "
         for (k = 1; k <= n; k++) {
            x = number(k)
            if (name == "AT" && !is_given(k)) continue
            if (change == "units") x *= times[k]
            if (change == "mirrored" && substr(turned, k, 1) == "1") x = -x
            if (change == "moved") x += by[k]
            out = out digits(x)
         }
         sub(/ *$/, "", out)
         add_card(substr(sprintf("%-32s", card), 1, 32) "\n" out)
      }
      # What belongs to a card stays below it.
      function add_card(text) {
         if (name ~ /^(ADD|RISE)$/) cards[n_cards] = cards[n_cards] "\n" text
         else cards[++n_cards] = text
      }
      function finish() { if (card == "") return; name = trim(substr(card, 1, 8)); work_on(); card = ""; star = "" }
      /^[$]/ || /^ *$/ { next }
      /^\*/ { star = $0; next }
      { finish(); card = $0 }
      /^TIME/ && change ~ /^[37]$/ { card = sprintf("%-8s%-8s%s", "TIME", change*substr($0, 9, 8), substr($0, 17)) }
      /^END/ {
         card = ""
         for (k = 1; k <= n_cards; k++) { text = cards[change == "turned" ? n_cards + 1 - k : k]; gsub(/ +\n/, "\n", text); print text }
         print "END"; n_cards = 0
      }' "$2"
}

# run NAME: its results with errors
run() { "$kin" "$work/$1.deck" --errors --csv "$work/$1.csv" -o "$work/$1.lst" 2> "$work/$1.err"; }

# differing CHANGE: numbers of the deck and of the changed one that differ by more than their errors, and rows flagged in one
# alone. An error is known to a small factor only; where none is told a number is not compared.
differing() {
   awk -F, -v change="$1" '
      function size(x) { return x < 0 ? -x : x }
      FNR == 1 { next }
      FNR == NR { row[$1 "," $2 "," $4 "," $5] = $0; next }
      { many = change ~ /^[37]$/ ? change : 1
        key = $1 "," $2/many "," $4 "," $5
        # Instants of AT cards have other numbers where there are more steps.
        if ($2 % many || !(key in row) || change == "units" && $4 == "PAIR") next
        split(row[key], a, ",")
        if (size(a[3] - $3/(change == "units" ? 60 : 1)) > 1e-9*size(a[3])) next
        compared++
        if (a[15] != $15) { print "flag " key " " a[15] " " $15; next }
        for (c = 6; c <= 14; c++) {
           if ($c == "" || a[c] == "" || a[c + 10] == "" || $(c + 10) == "") continue
           x = $c
           if (change == "mirrored" && $4 != "PAIR" && (c - 6) % 3 > 0) x = -x
           # A relative angle is turned round, a slide is not.
           if (change == "mirrored" && $4 == "PAIR" && size(x + a[c]) < size(x - a[c])) x = -x
           unit = change == "units" ? ((c - 6) % 3 < 2 ? 25.4 : 1)/60^int((c - 6)/3) : 1
           x /= unit
           if (change == "moved" && $4 != "PAIR" && c == 6) x -= 3
           if (change == "moved" && $4 != "PAIR" && c == 7) x += 2
           if (size(x - a[c]) > 30*(a[c + 10] + $(c + 10)/unit) + 1e-14*(size(x) + (change == "moved" && c < 8 ? 5 : 0))) \
              print key " column " c ": " a[c] " " x " " a[c + 10] " " $(c + 10)
        } }
      END { if (compared < 10) print compared + 0 " rows" }' "$work/$deck.csv" "$work/$deck.$1.csv" | head -n 3
}

for path in ${*:-input/*.deck}; do
   deck=$(basename "$path" .deck)
   cp "$path" "$work/$deck.deck"
   run "$deck"
   for change in 3 7 turned moved mirrored units; do
      changed $change "$path" > "$work/$deck.$change.deck"
      run "$deck.$change"
      equal "$deck, $change" '' "$(cat "$work/$deck.$change.err"; differing $change)"
   done
done
conclude
