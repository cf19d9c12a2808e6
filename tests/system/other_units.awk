# awk [-v long=K] [-v late=K] [-v radians=1] -f other_units.awk DECK: the deck with its lengths times 10**long and its times
# times 10**late, by the exponents of its numbers, so that no decimal is rounded; with radians instead of degrees, on * cards
# in 17 digits. A card with * in column 1 has the numbers of the card above it, TOLER their tolerances, VARY values of one.

# What the three numbers of a card are: lengths l, angles a, times t, others -; behind a stroke the power of 1/time.
function kinds_of(card, form) {
   if (card == "DRIVE") { x = form ~ /^(X|Y|SLIDE)$/ ? "l" : "a"; return x " " x "/1 " x "/2" }
   if (card == "RISE") return "t t " x
   if (card == "ADD") return form == "TABLE" ? "t " x : form == "POWER" ? x "/" field(2) + 0 : x " a/1 a"
   return kinds[card]
}
function field(n,  text) { text = substr(line, first + (n - 1)*width, width); gsub(/ /, "", text); return toupper(text) }
function scaled(text, k,  i) {
   if (k == 0 || text == "") return text
   i = index(text, "E")
   return i ? substr(text, 1, i) (substr(text, i + 1) + k) : text "E" k
}
BEGIN {
   kinds["GROUND"] = kinds["LINK"] = "l l a"; kinds["POINT"] = kinds["JOINT"] = "l l"; kinds["PRISM"] = kinds["SLOT"] = "a l a"; kinds["LENGTH"] = kinds["CYLINDER"] = "l l"
   kinds["TIME"] = kinds["AT"] = "t t t"; kinds["BRANCH"] = "t"; kinds["EXTREMES"] = "l a"
}
/^[$]/ || /^ *$/ || /^TITLE/ { print; next }
/^END/ { degrees = 0 }
/^UNITS/ && radians && $3 == "DEG" { degrees = 1; sub(/DEG/, "RAD") }
{
   line = sprintf("%-80s", $0); star = line ~ /^\*/
   if (!star) { split(substr(line, 1, 8), c, " "); split(substr(line, 9, 8), f, " ") }
   width = star ? 24 : 16; first = star ? 9 : 33
   if (!star && c[1] !~ /^(TOLER|VARY)$/) { split("", kind); split(kinds_of(c[1], f[1]), kind, " ") }
   if (c[1] == "VARY" && !star) { varied = kind[substr(f[1], 2) + 0]; for (n = 1; n <= 3; n++) kind[n] = varied }
   labels = substr(line, 1, first - 1); numbers = exact = ""; turned = 0
   for (n = 1; n <= 3; n++) {
      split("", part); split(kind[n], part, "/")
      text = scaled(field(n), (part[1] == "l")*long + (part[1] == "t")*late - late*part[2])
      numbers = numbers sprintf("%-" width "s", text)
      if (degrees && part[1] == "a" && text != "") { turned = 1; text = sprintf("%.16E", text*atan2(1, 1)/45) }
      exact = exact sprintf("%-24s", text)
   }
   if (turned && !star) print labels
   line = turned ? "*       " exact : labels numbers
   sub(/ *$/, "", line); print line
}
