# awk -f compare.awk TABLE CSV: the numbers of another program in TABLE against those that kinmat has written to CSV. The
# table has the columns of that, an empty cell where there is no number. The word behind "# precision:" is a part of the
# largest number of the same kind (lengths or angles, of the same derivative), or "half": half a unit of the last digit.
# The first line printed has how many numbers were compared; a line for each that differs by more follows, and last comes
# the greatest difference of the others, in parts of the precision.
BEGIN { FS = ","; columns = split("x y phi vx vy vphi ax ay aphi", heading, " ") }

# The unit of the last digit of a number as text.
function last_digit(text,  exponent, point) {
   text = tolower(text)
   exponent = 0
   if (index(text, "e")) { exponent = substr(text, index(text, "e") + 1) + 0; text = substr(text, 1, index(text, "e") - 1) }
   point = index(text, ".")
   return 10^(exponent - (point ? length(text) - point : 0))
}
function size(x) { return x < 0 ? -x : x }
# Lengths and angles of a derivative: 0 to 5.
function kind(c) { return 2*int((c - 6)/3) + ((c - 6) % 3 == 2) }

FNR == NR && /^# precision:/ { precision = $0; sub(/^# precision: */, "", precision); sub(/ .*/, "", precision) }
/^#/ || /^set,/ { next }
FNR == NR {
   rows[++n] = $0
   for (c = 6; c <= 14; c++) if ($c != "" && size($c) > largest[kind(c)]) largest[kind(c)] = size($c)
   next
}
{ found[$1 "," $2 "," $4 "," $5] = $0 }

END {
   for (i = 1; i <= n; i++) {
      split(rows[i], theirs, ",")
      key = theirs[1] "," theirs[2] "," theirs[4] "," theirs[5]
      if (!(key in found)) { print "no row " key; continue }
      split(found[key], ours, ",")
      if (size(theirs[3] - ours[3]) > 1e-12) { print key " at another time: " ours[3]; continue }
      for (c = 6; c <= 14; c++) {
         if (theirs[c] == "") continue
         if (ours[c] == "") { print "no number " key " " heading[c - 5]; continue }
         numbers++
         allowed = precision == "half" ? last_digit(theirs[c])/2 : precision*largest[kind(c)]
         difference = size(ours[c] - theirs[c])/allowed
         if (difference <= 1) { if (difference > greatest) greatest = difference; continue }
         off[++n_off] = sprintf("%s %s at %s: %s is off by %.3g", theirs[5], heading[c - 5], theirs[3] + 0, theirs[c], difference)
      }
   }
   print numbers + 0 " numbers"
   for (i = 1; i <= n_off; i++) print off[i]
   printf "greatest difference %.2g\n", greatest
}
