# awk -f work.awk LOG...: what the solver did, by its logs (--log), a line a log: its name, instants, iterations, substeps, the
# sum of the Kantorovich ratios (0 where they are roundings), the least reciprocal condition, the sum of the determinants'
# signs, and the words of the branch, each with the number of instants in a row that have it.
function put_branch() { if (word != "") branches = branches " " word (many > 1 ? "*" many : ""); word = ""; many = 0 }
function put_log() {
   put_branch()
   if (instants) printf "%s %d %d %d %s %.3g %d%s\n", name, instants, iterations, substeps, \
      ratio < 1e-4 ? 0 : sprintf("%.3g", ratio), least, signs, branches
   instants = iterations = substeps = ratio = signs = 0; least = 1; branches = ""
   name = FILENAME; sub(/.*\//, "", name); sub(/[.]log$/, "", name)
}
FNR == 1 { put_log() }
$1 ~ /^[0-9]+$/ {
   instants++; iterations += $4; substeps += $11; ratio += $12; signs += $9
   if ($8 < least) least = $8 < 1e-9 ? 0 : $8
   if ($10 != word) put_branch()
   word = $10; many++
}
END { put_log() }
