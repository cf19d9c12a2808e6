# The order of src/, from its use statements: a file uses files of its own folder and of folders that stand before it in
# `order`; inside a folder there are no circles. Prints what breaks this, a line each.
function visit(name,  list, n, i) {
   if (state[name] == 2) return
   if (state[name] == 1) { print name ": IN A CIRCLE"; return }
   state[name] = 1
   n = split(uses[name], list, " ")
   for (i = 1; i <= n; i++) if (list[i] in folder && folder[list[i]] == folder[name]) visit(list[i])
   state[name] = 2
}
BEGIN { n = split(order, list, " "); for (i = 1; i <= n; i++) place[list[i]] = i }
FNR == 1 {
   parts = split(FILENAME, path, "/")
   name = path[parts]; sub(/\.[fF]90$/, "", name)
   folder[name] = parts > 2 ? path[2] : "src"
   names[++count] = name
   if (!(folder[name] in place)) print FILENAME ": ITS FOLDER HAS NO PLACE"
}
tolower($1) == "use" { used = $2; sub(/,.*/, "", used); uses[name] = uses[name] " " used }
END {
   for (i = 1; i <= count; i++) {
      name = names[i]
      n = split(uses[name], list, " ")
      for (j = 1; j <= n; j++)
         if (list[j] in folder && place[folder[list[j]]] > place[folder[name]])
            print folder[name] "/" name ": USES " folder[list[j]] "/" list[j]
      visit(name)
   }
}
