# awk -f work.awk LOG...: the work of the solver, by its logs (--log), a line a log: its name, instants, iterations (each with
# its factorization), substeps, and the words of the branch, each with the number of instants in a row that have it.
function put_branch() { if (word != "") branches = branches " " word (many > 1 ? "*" many : ""); word = ""; many = 0 }
function put_log() {
   put_branch()
   if (instants) printf "%s %d %d %d%s\n", name, instants, iterations, substeps, branches
   instants = iterations = substeps = 0; branches = ""
   name = FILENAME; sub(/.*\//, "", name); sub(/[.]log$/, "", name)
}
FNR == 1 { put_log() }
$1 ~ /^[0-9]+$/ {
   instants++; iterations += $4; substeps += $9
   if ($8 != word) put_branch()
   word = $8; many++
}
END { put_log() }
