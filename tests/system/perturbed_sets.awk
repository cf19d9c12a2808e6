# Sets of a deck with its toleranced numbers changed, without its TOLER cards, for tests/system/tolerances.sh.
#    awk -v n=0 ...       two sets for each number, in the order of the TOLER cards: it is larger, then smaller, by h
#    awk -v n=400 ...     n sets with all numbers off by normal deviates, a tolerance being one standard deviation
# The numbers stand on * cards with 16 digits; the card above a TOLER card has none of its own.
function dice() { seed = (seed * 16807) % 2147483647; return seed / 2147483647 }
function normal() { return sqrt(-2 * log(dice())) * cos(6.283185307179586 * dice()) }
# The card `line` with its reals on a * card, number k changed by d[k].
function put(line, d,    k, text, star) {
   printf "%s\n", substr(line, 1, 32)
   star = "*       "
   for (k = 1; k <= 3; k++) {
      text = substr(line, 17 + 16 * k, 16)
      gsub(/ /, "", text)
      if (d[k] != 0) text = n ? sprintf("%.15E", text + d[k]) : sprintf("%." decimals "f", text + d[k])
      star = star sprintf("%-24s", text)
   }
   print star
}
BEGIN { seed = 19870923; decimals = 2 - log(h ? h : 1)/log(10) }
/^END/ { exit }
/^TOLER/ {
   for (k = 1; k <= 3; k++) {
      text = substr($0, 17 + 16 * k, 16)
      gsub(/ /, "", text)
      tolerance[lines, k] = text + 0
      if (text + 0 > 0) { count++; of[count] = lines; place[count] = k }
   }
   next
}
{ line[++lines] = $0 }
END {
   sets = n ? n : 2 * count
   for (s = 1; s <= sets; s++) {
      for (i = 1; i <= lines; i++) {
         for (k = 1; k <= 3; k++) {
            d[k] = 0
            if (n && tolerance[i, k]) d[k] = tolerance[i, k] * normal()
            if (!n && of[int((s + 1) / 2)] == i && place[int((s + 1) / 2)] == k) d[k] = s % 2 ? h : -h
         }
         if (d[1] || d[2] || d[3]) put(line[i], d)
         else print line[i]
      }
      print "END"
   }
}
