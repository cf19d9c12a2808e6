# Dummies of one letter: awk -f letters.awk README FILES... prints each that the table of letters of README does not
# give to its type. A row of the table is | `letter` | `type` ... |.
FNR == NR { if (match($0, /^\| `[a-z]` \| `/)) { split($0, cell, "|"); gsub(/[ `]/, "", cell[2]); types[cell[2]] = cell[3] } next }
FNR == 1 { text = ""; depth = 0 }
{ line = $0; sub(/^ +/, "", line) }
line ~ /^!/ { next }
{
   # A statement with its continuation lines, without its comment (a `!` in a text would be part of a declaration of
   # a constant, which is no dummy).
   sub(/ *!.*/, "", line)
   if (text == "") begins = FNR
   text = text line
   if (text ~ /&$/) { sub(/ *&$/, " ", text); next }
   statement = text; text = ""
   if (statement !~ /^(real|integer|logical|character|complex|type|class|procedure)[ (,].*(intent *[(]|, *value)/) next
   split(statement, part, / *:: */)
   names = part[2]
   while (gsub(/[(][^()]*[)]/, "", names)) { }
   n = split(names, name, / *, */)
   kind = part[1]
   if (match(kind, /^(type|class) *[(][a-z_]+/)) { kind = substr(kind, RSTART, RLENGTH); sub(/.*[(]/, "", kind) }
   else sub(/[ (,].*/, "", kind)
   for (i = 1; i <= n; i++) {
      if (length(name[i]) != 1) continue
      if (!(name[i] in types) || index(types[name[i]], "`" kind "`") == 0)
         print FILENAME ":" begins ": " name[i] " is no letter for " kind
   }
}
