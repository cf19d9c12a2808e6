#!/bin/sh
# contrib/kinmat-columns: a table of cards becomes a deck in columns.
. tests/counting.sh

# columns NAME EXPECTED: the cards that the lines on standard input become
columns() { equal "$1" "$2" "$(contrib/kinmat-columns 2>&1)"; }
joint='JOINT   A       CRANK   COUPLER 20.0            -1.25'
printf 'JOINT A CRANK COUPLER 20 -1.25\n' | columns 'by blanks' "$joint"
printf 'joint,a,crank,coupler,20,-1.25\r\n' | columns 'by commas, from Windows' "$joint"
printf 'JOINT, A, CRANK, COUPLER, 20, -1.25\n' | columns 'by commas and blanks' "$joint"
printf 'JOINT;A;CRANK;COUPLER;20;-1,25\n' | columns 'by semicolons, decimal commas' "$joint"
printf 'JOINT\tA\tCRANK\tCOUPLER\t20\t-1.25\n' | columns 'by tabs' "$joint"
printf 'LINK ROD - - = = 30\n' | columns 'blank labels and reals' 'LINK    ROD                                                     30.0'
printf 'LINK;ROD;;;;;30\n' | columns 'empty cells' 'LINK    ROD                                                     30.0'
printf 'DRIVE ANGLE CRANK RPM = 60\n' | columns 'a blank real' 'DRIVE   ANGLE   CRANK   RPM                     60.0'
printf 'TIME 12 0 1e-3\nPRINT LINKS 3\nVARY R1 5 T 1 2\n' | columns 'whole numbers' 'TIME    12                      0.0             1e-3
PRINT   LINKS           3
VARY    R1      5       T       1.0             2.0'
printf 'POINT T ROD 0.12345678901234567 1\n' | columns 'a long number' 'POINT   T       ROD
*       0.12345678901234567     1.0'
printf '# a, b\nTITLE  A, B; C\n\n$ x\nEND\n' | columns 'comments and titles' '# a, b
TITLE   A, B; C

$ x
END'
printf 'POINT T ROD 1 2 3 4\n' | columns 'too many numbers' 'kinmat-columns: line 1: more than three numbers: 4
POINT   T       ROD             1.0             2.0             3.0'
printf 'POINT LONGESTNAME ROD 1 2\n' | contrib/kinmat-columns > "$w/out" 2> "$w/err"
equal 'a long name: status' 1 $?
equal 'a long name' 'kinmat-columns: line 1: more than 8 characters: LONGESTNAME' "$(cat "$w/err")"

# Every deck of input/ without touching labels and numbers comes back as it is, typed with single blanks, and as a spreadsheet.
for deck in four_bar drawing watt; do
   grep -v '^[$#!]' "input/$deck.deck" | awk '{ line = sprintf("%-80s", $0)
      out = substr(line, 1, 8); sub(/ +$/, "", out)
      if (out == "TITLE") { print; next }
      if (out == "*") { print; next }
      split("9 17 25 33 49 65", from, " "); split("8 8 8 16 16 16", width, " ")
      last = 0
      for (i = 1; i <= 6; i++) { x = substr(line, from[i], width[i]); gsub(/ /, "", x); cell[i] = x; if (x != "") last = i }
      for (i = 1; i <= last; i++) out = out ";" cell[i]
      print out }' > "$w/$deck.csv"
   contrib/kinmat-columns "$w/$deck.csv" > "$w/$deck.deck" 2> "$w/err"
   "$kinmat" "$w/$deck.deck" > "$w/found" 2>&1
   "$kinmat" "input/$deck.deck" > "$w/expected" 2>&1
   same "$deck as a spreadsheet" "$w/expected" "$w/found"
done
conclude
