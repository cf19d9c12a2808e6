# awk -v set=N -v assembly=1 -f initial_assembly.awk DECK: set number N of a deck at its first instant alone, by METHOD NEWTON, with the
# card PRINT ALL and, where it is asked for, ASSEMBLY. `cards`: a file with cards that stand in place of its own.
# What a card is about: a drive has a kind, too, and a second link.
function key_of(text) { return substr(sprintf("%-32s", text), 1, text ~ /^DRIVE/ ? 32 : 16) }
function blank(text) { gsub(/ /, "", text); return text == "" }
function flush_card() {
   if (card == "") return
   key = key_of(card)
   if (key in own) card = own[key]
   else if (star != "") card = card "\n" star
   if (card !~ /^(PRINT|BRANCH|METHOD|TOLER|VARY|EXTREMES|CIRCUITS|RANGE|PROVE|POLE|CURVE|ASSEMBLY|TIME|AT)/) print card
   if (card ~ /^TIME/ || card ~ /^AT/ && instant == "") {
      if (star != "") instant = "AT\n" substr(star, 1, 32)
      else instant = sprintf("%-32s%s", "AT", blank(substr(card, 33, 16)) ? "0.0" : substr(card, 33, 16))
   }
   card = star = ""
}
BEGIN {
   n = 1
   if (cards != "") while ((getline line < cards) > 0) {
      if (line ~ /^\*/) own[key] = own[key] "\n" line
      else { key = key_of(line); own[key] = line }
   }
}
/^[$#!]/ || /^ *$/ { next }
/^\*/ { if (n == set) star = $0; next }
n == set { flush_card(); card = $0 }
/^END/ { if (n == set) card = ""; n++ }
END { print instant; print "PRINT   ALL"; if (assembly) print "ASSEMBLY"; print "END" }
