# Procedures without a head comment: no comment line stands directly above the statement, nor directly below it with its
# continuation lines. Bodies of interfaces are procedures too.
{ line = $0; sub(/^ +/, "", line) }
FNR == 1 { previous = ""; open = "" }
open != "" && continued { continued = (line ~ /&$/); next }
open != "" { if (line !~ /^!/) print open; open = "" }
# What stands before the keyword is words alone, types in parentheses apart. One pattern for all of it takes mawk ages.
match(line, /(^|[ )])(subroutine|function) +[a-zA-Z]/) && line !~ /^end / {
   before = substr(line, 1, RSTART - 1)
   gsub(/[(][^)]*[)]/, "", before)
   if (before ~ /[^a-z_ )]/) { previous = line; next }
   if (previous !~ /^!/) { open = FILENAME ":" FNR ": " line; continued = (line ~ /&$/) }
}
{ previous = line }
