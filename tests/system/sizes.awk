# Sizes of the sources: awk -v limits=tests/system/sizes.txt -f sizes.awk FILES... prints a table of figures and limits; with
# -v over=1 only a sentence for each figure above its limit.
#   FOLDER       lines of code: neither blank nor a comment alone; `src` has the files of no folder
#   all          their sum
#   types        definitions of derived types
#   thresholds   named real constants of modules whose value is or begins with a number, as 1.0E-9_wp or 8*epsilon(1.0_wp);
#                an array counts once
#   public       names in public statements
#   twice        names that two types or more have
#   small        procedures of at most 20 lines of code, first and last included, that one procedure alone calls or names as
#                an argument; those bound to a type or in a generic interface do not count
# With -v list=small (or types ...) what is counted stands above the table, a line each.
BEGIN {
   small_lines = 20
   n = split("all|lines of code|types|derived types|thresholds|thresholds|public|public names|twice|names of two types or more|" \
      "small|procedures of at most " small_lines " lines with one caller", words, "|")
   for (i = 1; i < n; i += 2) { order[++many] = words[i]; meaning[words[i]] = words[i + 1] }
   while ((getline limit < limits) > 0)
      if (limit !~ /^#/ && split(limit, words, " ") == 2) {
         most[words[1]] = words[2]
         if (!(words[1] in meaning)) folders[words[1]]
      }
}

# The statement without what is in quotes and without its comment.
function code_of(text) {
   gsub(/'[^']*'/, "''", text)
   gsub(/"[^"]*"/, "\"\"", text)
   sub(/!.*/, "", text)
   return text
}
# A whole statement of file `file` at the level of the module; `text` has no continuation marks.
function at_module_level(text,  n, parts, i, names) {
   if (text ~ /^ *public *::/) {
      sub(/^ *public *:: */, "", text)
      n = split(text, parts, / *, */)
      for (i = 1; i <= n; i++) { sub(/ +$/, "", parts[i]); count("public", parts[i]); is_public[file, parts[i]] = 1 }
   } else if (text ~ /^ *use /) {
      names = text
      sub(/^ *use *(, *intrinsic)? *(::)? */, "", names)
      n = split(names, parts, / *[,:] */)
      for (i = 2; i <= n; i++) {
         if (parts[i] ~ /=>/) { split(parts[i], two, / *=> */); renamed[file, two[1]] = two[2]; parts[i] = two[1] }
         sub(/ +$/, "", parts[i])
         used[file, parts[i]] = parts[1]
      }
   } else if (text ~ /^ *real *[(].*parameter.*::/) {
      sub(/.*:: */, "", text)
      while (text ~ /[(\[][^()\[\]]*[)\]]/) sub(/[(\[][^()\[\]]*[)\]]/, has_digit(text), text)
      n = split(text, parts, / *, */)
      for (i = 1; i <= n; i++) if (parts[i] ~ /= *[-+]?([0-9]|[.][0-9]|#)/) count("thresholds", parts[i])
   } else if (text ~ /^ *type *(,[^:]*)?:: *[a-z]/ && text !~ /^ *type *[(]/) {
      sub(/.*:: */, "", text)
      sub(/ .*/, "", text)
      count("types", text)
      if (++types_of[text] == 2) count("twice", text ", " first_file[text])
      first_file[text] = file
   }
}
# What stands for the inner brackets of `text`: a number if the first thing inside is one and they are an array's.
function has_digit(text) {
   match(text, /[(\[][^()\[\]]*[)\]]/)
   return substr(text, RSTART, RLENGTH) ~ /^[\[] *[-+]?[0-9#]/ ? "#" : "_"
}
function show(name, words,  line) {
   if (!over) printf "%-16s%8d%8s\n", name, figure[name], name in most ? most[name] : "none"
   else if (!(name in most)) print name ": NO LIMIT IN " limits
   else if (figure[name] > most[name]) print words ": " figure[name] ", at most " most[name] " (" limits ")"
}
function count(what, name) { figure[what]++; if (list == what) print file ": " name }

FNR == 1 {
   file = FILENAME
   parts = split(FILENAME, path, "/")
   folder = parts > 2 ? path[parts - 1] : "src"
   module = path[parts]
   sub(/[.].*/, "", module)
   file_of[module] = file
   depth = 0
   in_interface = 0
   statement = ""
}
/^ *!/ || /^ *$/ || /^#/ { if ($0 !~ /^#/) next }
{
   lines[folder]++
   figure["all"]++
   for (i = 1; i <= depth; i++) code[inner[i]]++
   text = code_of($0)
   continued = text ~ /& *$/
   sub(/& *$/, "", text)
   sub(/^ *&/, "", text)
   statement = statement " " text
   if (continued) next
   whole = tolower(statement)
   statement = ""
   if (whole ~ /^ *end *interface/) { in_interface = 0; next }
   if (whole ~ /^ *(abstract +)?interface( |$)/) in_interface = 1
   if (!in_interface && whole ~ /^ *end *(subroutine|function|procedure)/) { depth--; next }
   before = whole
   if (!in_interface && whole !~ /^ *end/ && match(before, /(^|[ )])(subroutine|function) +[a-z][a-z0-9_]*/)) {
      head = substr(before, RSTART, RLENGTH)
      before = substr(before, 1, RSTART)
      gsub(/[(][^)]*[)]/, "", before)
      if (before ~ /^[a-z_ )]*$/) {
         sub(/.* /, "", head)
         depth++
         inner[depth] = file SUBSEP head
         code[inner[depth]] = 1
         procedures[file, head] = FNR
      }
   }
   if (depth == 0) at_module_level(whole)
   statements++
   text_of[statements] = whole
   place_of[statements] = depth ? inner[depth] : ""
   origin[statements] = file
}
END {
   # Who names which procedure.
   for (k = 1; k <= statements; k++) {
      rest = text_of[k]
      if (rest ~ /^ *(use|public|private) /) continue
      while (match(rest, /[a-z][a-z0-9_]*/)) {
         name = substr(rest, RSTART, RLENGTH)
         before = substr(rest, 1, RSTART - 1)
         rest = substr(rest, RSTART + RLENGTH)
         if (before ~ /[%a-z0-9_] *$/ && before ~ /%[ ]*$/) continue
         file = origin[k]
         if ((file, name) in procedures) target = file SUBSEP name
         else if ((file, name) in used) {
            from = file_of[used[file, name]]
            target = from SUBSEP ((file, name) in renamed ? renamed[file, name] : name)
            if (!(target in procedures)) continue
         } else continue
         if (target == place_of[k]) continue
         if (place_of[k] == "") callers[target] += 2
         else if (!((target, place_of[k]) in seen)) { seen[target, place_of[k]] = 1; callers[target]++ }
      }
   }
   for (one in procedures) {
      if (code[one] > small_lines || callers[one] != 1) continue
      split(one, part, SUBSEP)
      file = part[1]
      count("small", part[2])
   }
   for (one in lines) { folders[one]; figure[one] = lines[one] }
   if (!over) printf "%-16s%8s%8s\n", "SIZE", "FIGURE", "LIMIT"
   m = 0
   for (one in folders) { for (k = m++; k >= 1 && sorted[k] > one; k--) sorted[k + 1] = sorted[k]; sorted[k + 1] = one }
   for (k = 1; k <= m; k++) show(sorted[k], "lines of code in src/" (sorted[k] == "src" ? " itself" : sorted[k] "/"))
   for (i = 1; i <= many; i++) show(order[i], meaning[order[i]] " in src/")
}
