# awk -f where_to_add.awk src/README.md SOURCES...: what is not true of the table "Where to add", a line each. Its cells: what
# is added; examples, or nothing; the files that name one of the examples, all of them and no others; what is written there.
# Names in backquotes are files (`folder/file` of src/, docs/...), or identifiers of the sources; `word_...` is their beginning.
function file_named(name) { return name in path }
function known(name) {
   if (name ~ /^docs\//) return (getline < name) >= 0
   if (file_named(name)) return 1
   if (sub(/[.][.][.]$/, "", name)) { for (one in words) if (index(one, name) == 1) return 1; return 0 }
   return tolower(name) in words
}
# The names in backquotes of a cell, in `list`.
function names_in(cell,  n) {
   n = 0
   split("", list)
   while (match(cell, /`[^`]*`/)) { list[++n] = substr(cell, RSTART + 1, RLENGTH - 2); cell = substr(cell, RSTART + RLENGTH) }
   return n
}
FILENAME ~ /README.md$/ {
   if (/^## /) inside = $0 ~ /^## Where to add/
   if (inside && /^[|]/ && ++lines > 2) row[++rows] = $0
   next
}
FNR == 1 {
   name = FILENAME
   sub(/^src\//, "", name)
   sub(/[.][fF]90$/, "", name)
   path[name] = 1
   is_comment = 0
}
!/^ *!/ {
   line = tolower($0)
   while (match(line, /[a-z][a-z0-9_]*/)) {
      word = substr(line, RSTART, RLENGTH)
      line = substr(line, RSTART + RLENGTH)
      words[word]
      mentions[word, name]
   }
}
END {
   if (!rows) print "NO TABLE"
   for (i = 1; i <= rows; i++) {
      split(row[i], cell, / *[|] */)
      n = names_in(row[i])
      for (k = 1; k <= n; k++) if (!known(list[k])) print cell[2] ": `" list[k] "` is no file and no name of the sources"
      m = names_in(cell[3])
      if (m == 0) continue
      split("", examples)
      for (k = 1; k <= m; k++) examples[k] = list[k]
      n = names_in(cell[4])
      split("", told)
      for (k = 1; k <= n; k++) told[list[k]]
      for (one in path) {
         named = ""
         for (k = 1; k <= m && named == ""; k++) if ((examples[k], one) in mentions) named = examples[k]
         if (named != "" && !(one in told)) print cell[2] ": `" one "` names " named
         if (named == "" && (one in told)) print cell[2] ": `" one "` does not name " examples[1]
      }
   }
}
