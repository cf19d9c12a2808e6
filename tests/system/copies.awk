# No object that holds factors of KLU is copied by assignment, or is a function's result: both would share handles.
# Two passes over the same Fortran files (awk -f fortran.awk -f copies.awk pass=1 FILES pass=2 FILES): the types and their
# components;
# then assignments to whole variables or components of a type that holds a klu_t, directly or in a component, and
# functions with such results, one a line; at the end the types, "holds: TYPE".

# The type of component `name` of type `t`, or of the type that it extends.
function component_type(t, name) {
   while (t != "" && !((t " " name) in component)) t = parent[t]
   return t == "" ? "" : component[t " " name]
}

pass == 1 && /^ *type(, *[a-z_, ()]*)? *:: *[a-z_0-9]+ *$/ {
   inside = $NF
   if (match($0, /extends *\([a-z_0-9]+\)/)) {
      parent[inside] = substr($0, RSTART, RLENGTH); gsub(/extends *\(|\)/, "", parent[inside])
      holds[inside] = parent[inside]
      component[inside " " parent[inside]] = parent[inside]
   }
}
pass == 1 && /^ *end type/ { inside = "" }
pass == 1 && inside != "" && /^ *(type|class)\(.*::/ {
   sub(/^ *class/, "type")
   holds[inside] = holds[inside] " " type_of($0)
   count = split(names_of($0), list, ",")
   for (i = 1; i <= count; i++) { component[inside " " list[i]] = type_of($0); known[list[i] " " type_of($0)] = 1 }
}

pass == 2 && !ready {
   ready = 1
   held["klu_t"] = 1
   do {
      grown = 0
      for (one in holds) {
         if (one in held) continue
         count = split(holds[one], list, " ")
         for (i = 1; i <= count; i++) if (list[i] in held) { held[one] = 1; grown = 1 }
      }
   } while (grown)
   # Behind a name that is associated only the component's own name tells its type.
   for (pair in known) { split(pair, part, " "); if (part[2] in held) suspect[part[1]] = 1 }
   for (pair in known) { split(pair, part, " "); if (!(part[2] in held)) delete suspect[part[1]] }
}
pass == 2 && (FNR == 1 || /^ *([a-z_]+ +)*(subroutine|function|program) [a-z_0-9]+ *(\(|$)/) { split("", variable); result = "" }
pass == 2 && /function .*result *\(/ { result = $0; sub(/^.*result *\(/, "", result); sub(/\).*$/, "", result) }
pass == 2 && /^ *type\([a-z_0-9]+\) +function/ { if (type_of($0) in held) print FILENAME ":" FNR ": function " type_of($0) }
pass == 2 && /^ *(type|class)\(.*::/ {
   sub(/^ *class/, "type")
   count = split(names_of($0), list, ",")
   for (i = 1; i <= count; i++) {
      variable[list[i]] = type_of($0)
      if (list[i] == result && (type_of($0) in held)) print FILENAME ":" FNR ": function " type_of($0)
   }
   next
}
pass == 2 && /[a-z0-9_)] = / && !/::/ {
   line = $0
   sub(/^ *(if *\(.*\) +)?/, "", line)
   sub(/ = .*$/, "", line)
   while (sub(/\([^()]*\)/, "", line)) continue
   gsub(/ /, "", line)
   count = split(line, part, "%")
   if (part[1] in variable) {
      t = variable[part[1]]
      for (i = 2; i <= count; i++) t = component_type(t, part[i])
      copied = (t in held)
   } else copied = count > 1 && (part[count] in suspect)
   if (copied) print FILENAME ":" FNR ":" $0
}
pass == 2 && /allocate *\(.*source *=/ {
   line = $0
   sub(/^.*source *= */, "", line); sub(/[,%()].*$/, "", line)
   if (variable[line] in held) print FILENAME ":" FNR ":" $0
}
END { if (pass == 2) for (one in held) print "holds: " one }
