# Array constructors that hold the result of a function whose type has allocatable components: gfortran 12 does not free what
# they hold. Two passes over the same Fortran files (awk -f fortran.awk -f constructors.awk pass=1 FILES pass=2 FILES); each
# place on a line, at the end "functions: N" that are looked for.
{ code = $0; sub(/!.*/, "", code) }
pass == 1 && code ~ /^ *type(, *[a-z_, ()]*)? *:: *[a-z_0-9]+ *$/ { inside = code; gsub(/^.*:: *| /, "", inside) }
pass == 1 && code ~ /^ *end type/ { inside = "" }
pass == 1 && inside != "" && code ~ /allocatable.*::/ { owns[inside] = 1 }
pass == 1 && inside != "" && code ~ /^ *type\(.*::/ { holds[inside] = holds[inside] " " type_of(code) }
pass == 1 && code ~ /(^| )function +[a-z_0-9]+ *\(/ && code !~ /end function/ {
   name = code; sub(/^.*function +/, "", name); sub(/ *\(.*/, "", name)
   answer = name
   if (match(code, /result *\([a-z_0-9]+\)/)) { answer = substr(code, RSTART, RLENGTH); gsub(/result *\(|\)/, "", answer) }
   if (match(code, /type\([a-z_0-9]+\) *function/)) { result_of[name] = type_of(substr(code, RSTART)); answer = "" }
}
pass == 1 && code ~ /^ *end function/ { answer = "" }
pass == 1 && answer != "" && code ~ /^ *type\(.*::/ {
   if (index("," names_of(code) ",", "," answer ",")) { result_of[name] = type_of(code); answer = "" }
}
pass == 2 && !ready {
   ready = 1
   do {
      grown = 0
      for (one in holds) {
         count = split(holds[one], parts, " ")
         for (i = 1; i <= count; i++) if ((parts[i] in owns) && !(one in owns)) { owns[one] = 1; grown = 1 }
      }
   } while (grown)
   for (one in result_of) if (result_of[one] in owns) functions++
}
pass == 2 && code ~ /\[.*[a-z_0-9]+\(/ {
   rest = code; sub(/^[^[]*\[/, "", rest)
   while (match(rest, /[a-z_][a-z_0-9]*\(/)) {
      one = substr(rest, RSTART, RLENGTH - 1)
      before = substr(rest, RSTART - 1, 1)
      if (before != "%" && (one in result_of) && (result_of[one] in owns)) print FILENAME ":" FNR ": " one
      rest = substr(rest, RSTART + RLENGTH)
   }
}
END { print "functions: " functions + 0 }
