# Differences of two outputs, OLD NEW, of the kind `kind`: csv (with --errors), sum or lst. All words are the same; a number of
# the CSV differs by at most its error in OLD, or 1E-9 of it or of 1; another by that, or by 1.5 in its last place.
# `marks`: numbers with digits marked as lost (?) may differ from the first such digit on, and have other digits marked.
function places(text,  point, e) {
   sub(/[DE].*/, "", text)
   point = index(text, ".")
   return point ? length(text) - point : 0
}
function power_of(text) { return match(text, /[DE][-+]?[0-9]+$/) ? substr(text, RSTART + 1) + 0 : 0 }
# How much a digit is worth that is marked as lost, the first in `text`.
function lost(text,  point, at) {
   at = index(text, "?")
   if (!at) return 0
   point = index(text, ".")
   if (!point) point = length(text) + 1
   return 10^(power_of(text) + (at < point ? point - at - 1 : point - at))
}
function near(a, b, error,  scale) {
   if (a == b) return 1
   if (marks && (a ~ /[?]/ || b ~ /[?]/)) {
      error += 10*(lost(a) + lost(b))
      gsub(/[?]/, "0", a)
      gsub(/[?]/, "0", b)
   }
   if (a !~ number || b !~ number) return 0
   scale = a < 0 ? -a : a + 0
   if (scale < 1) scale = 1
   if (kind == "lst" && places(a)) error += 1.5*10^(power_of(a) - places(a))
   return (a - b <= error + 1e-9*scale) && (b - a <= error + 1e-9*scale)
}
BEGIN {
   number = "^[-+]?([0-9]+[.]?[0-9]*|[.][0-9]+)([DE][-+]?[0-9]+)?$"
   separator = kind == "lst" ? " +" : ","
}
# The line that says what the marks mean stands below a table that has any.
marks && /^ --- [?]: / { next }
FILENAME == ARGV[1] { old[++lines] = $0; next }
{ new++ }
# The first of the nine values stands after `name`; a deck with variants has one column more.
new == 1 && kind == "csv" { first = $0 ~ /^set,variant/ ? 7 : 6 }
new > lines { print kind " has more: " $0; exit }
$0 == old[new] { next }
{
   n = split(old[new], a, separator)
   if (split($0, b, separator) != n) { print kind " " new ": " old[new] "  ->  " $0; next }
   # What is estimated of errors is judged by make errors, not here.
   if (kind == "csv") n = first + 9
   for (i = 1; i <= n; i++) {
      error = 0
      if (kind == "csv" && i >= first && i < first + 9) error = a[i + 10] + 0
      if (!near(a[i], b[i], error)) { print kind " " new ": " a[i] "  ->  " b[i]; break }
   }
}
END { if (new < lines) print kind " has less: " old[new + 1] }
