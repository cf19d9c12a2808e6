# Procedures without a head comment: no comment line stands directly above the statement, nor directly below it with its
# continuation lines. Bodies of interfaces are procedures too.
{ line = $0; sub(/^ +/, "", line) }
FNR == 1 { previous = ""; open = "" }
open != "" && continued { continued = (line ~ /&$/); next }
open != "" { if (line !~ /^!/) print open; open = "" }
line ~ /^([a-z_]+ *([(][^)]*[)] *)?)* *(subroutine|function) +[a-zA-Z]/ && line !~ /^end / {
   if (previous !~ /^!/) { open = FILENAME ":" FNR ": " line; continued = (line ~ /&$/) }
}
{ previous = line }
