# awk -F, -f error_sizes.awk CSV...: of each CSV with errors (--errors), and of each kind of row in it, the name, the kind, how
# many errors are not told, and the largest of the nine.
function put_file(  kind, k, line) {
   for (kind in seen) {
      line = name " " kind " " untold[kind] + 0
      for (k = 0; k < 9; k++) line = line sprintf(" %.2g", largest[kind, k])
      print line | "sort"
   }
   close("sort")
   split("", seen); split("", untold); split("", largest)
   name = FILENAME; sub(/.*\//, "", name); sub(/[.]csv$/, "", name)
}
FNR == 1 { put_file(); for (i = 1; i <= NF; i++) at[$i] = i; next }
{
   kind = $at["kind"]; gsub(/ /, "_", kind); seen[kind]
   for (k = 0; k < 9; k++) {
      error = $(at["ex"] + k)
      if (error == "") untold[kind]++
      else if (error + 0 > largest[kind, k]) largest[kind, k] = error + 0
   }
}
END { put_file() }
