# Rules of make for each of the directories `builds` below `build`: which object needs which, from the use and include
# statements of sources and tests, and how the programs of tests/ are linked. `unit_helpers`: what the unit tests need.
function reach(name,  list, n, i) {
   if (seen[name]++) return
   n = split(uses[name], list, " ")
   for (i = 1; i <= n; i++) if (list[i] in helper) reach(list[i])
   if (name in helper) found = found " " name
}
FNR == 1 {
   name = FILENAME; sub(/^.*\//, "", name); kind = name; sub(/\.[^.]*$/, "", name); sub(/^.*\./, "", kind)
   names[++count] = name
   if (kind == "pf") suite[name] = 1
   else if (FILENAME ~ /^tests\//) helper[name] = 1
   else ours[name] = 1
}
$1 == "#include" { file = $2; gsub(/"/, "", file); includes[name] = includes[name] " " file }
tolower($1) == "use" { used = $2; sub(/,.*/, "", used); uses[name] = uses[name] " " used }
tolower($1) == "program" && name in helper { program[name] = 1 }
END {
   directories = split(builds, directory, " ")
   m = split(included, list, " ")
   for (j = 1; j <= m; j++) { file = list[j]; sub(/^.*\//, "", file); path[file] = list[j] }
   for (i = 1; i <= count; i++) {
      name = names[i]
      if (name in suite) { reach(name); continue }
      m = split(includes[name], list, " ")
      for (j = 1; j <= m; j++) if (list[j] in path)
         for (d = 1; d <= directories; d++) print build "/" directory[d] "/" name ".o: " path[list[j]]
      m = split(uses[name], list, " ")
      for (j = 1; j <= m; j++) if (list[j] in ours || list[j] in helper)
         for (d = 1; d <= directories; d++)
            print build "/" directory[d] "/" name ".o: " build "/" directory[d] "/" list[j] ".o"
   }
   print "unit_helpers :=" found
   for (i = 1; i <= count; i++) if (names[i] in program) {
      split("", seen); found = ""; reach(names[i])
      m = split(found, list, " ")
      for (d = 1; d <= directories; d++) {
         place = build "/" directory[d] "/"
         printf "%s:", place names[i]
         for (j = 1; j <= m; j++) printf " %s.o", place list[j]
         print " " place "libkinmat.a\n\t$(call link," (directory[d] == "timed" ? "" : "$(no_lto)") ")"
      }
   }
}
