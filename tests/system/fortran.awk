# Declarations in Fortran, read line by line: for awk -f fortran.awk -f SCRIPT.

# The type of type(...).
function type_of(line) { sub(/^ *type\(/, "", line); sub(/\).*$/, "", line); return line }
# The names that are declared, with commas between them.
function names_of(line) {
   sub(/^.*:: */, "", line); sub(/!.*$/, "", line)
   while (sub(/\([^()]*\)/, "", line)) continue
   gsub(/=[^,]*/, "", line); gsub(/ /, "", line)
   return line
}
