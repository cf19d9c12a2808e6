# Differences of two outputs, OLD NEW, of the kind `kind`: csv (with --errors), sum or lst. All words are the same; a number of
# the CSV differs by at most its error in OLD, or 1E-9 of it or of 1; another by that, or by 1.5 in its last place.
function places(text,  point, e) {
   sub(/[DE].*/, "", text)
   point = index(text, ".")
   return point ? length(text) - point : 0
}
function near(a, b, error,  scale, exponent) {
   if (a == b) return 1
   if (a !~ number || b !~ number) return 0
   scale = a < 0 ? -a : a + 0
   if (scale < 1) scale = 1
   if (kind == "lst" && places(a)) {
      exponent = match(a, /[DE][-+]?[0-9]+$/) ? substr(a, RSTART + 1) : 0
      error += 1.5*10^(exponent - places(a))
   }
   return (a - b <= error + 1e-9*scale) && (b - a <= error + 1e-9*scale)
}
BEGIN {
   number = "^[-+]?([0-9]+[.]?[0-9]*|[.][0-9]+)([DE][-+]?[0-9]+)?$"
   separator = kind == "lst" ? " +" : ","
}
FNR == NR { old[FNR] = $0; lines = FNR; next }
# The first of the nine values stands after `name`; a deck with variants has one column more.
FNR == 1 && kind == "csv" { first = $0 ~ /^set,variant/ ? 7 : 6 }
FNR > lines { print kind " has more: " $0; exit }
$0 == old[FNR] { next }
{
   n = split(old[FNR], a, separator)
   if (split($0, b, separator) != n) { print kind " " FNR ": " old[FNR] "  ->  " $0; next }
   # What is estimated of errors is judged by make errors, not here.
   if (kind == "csv") n = first + 9
   for (i = 1; i <= n; i++) {
      error = 0
      if (kind == "csv" && i >= first && i < first + 9) error = a[i + 10] + 0
      if (!near(a[i], b[i], error)) { print kind " " FNR ": " a[i] "  ->  " b[i]; break }
   }
}
END { if (FNR < lines && FNR != NR) print kind " has less: " old[FNR + 1] }
