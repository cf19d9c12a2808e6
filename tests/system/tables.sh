#!/bin/sh
# Tables: of every deck of input/ one a set, whose cells are those of the CSV; what is refused.
. tests/counting.sh

# cells TABLE CSV SET: what is wrong in the table of a set; then how many cells of the CSV it has. A row has all columns, and
# NaN where the cell of the CSV is empty.
cells() { awk -F, -v set="$3" '
   FILENAME == ARGV[1] && FNR == 1 { columns = NF; for (i = 1; i <= NF; i++) head[i] = $i; if (/ /) print "blanks in the heading"
      for (i = 1; i <= NF; i++) if (seen[$i]++) print "twice: " $i; next }
   FILENAME == ARGV[1] {
      rows++
      if (NF != columns || / /) print "row " rows
      for (i = 1; i <= NF; i++) table[rows, i] = $i
      at[$1] = rows
      next
   }
   FNR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
   $1 == set {
      names_of[$4, $5] = 1
      if (!($3 in at)) { print "no row at " $3; next }
      for (i in column) csv[at[$3], $4, $5, i] = $(column[i])
      has[at[$3], $4, $5] = 1
   }
   END {
      split("s v a theta omega alpha", words, " "); split("x vx ax x vx ax", names, " ")
      for (i = 1; i <= 6; i++) pair[words[i]] = names[i]
      for (i = 2; i <= columns; i++) {
         if (head[i] ~ /^(ANGLE|X|Y|RELANGLE|SLIDE)[.].*[A-Z0-9]$/) { drives++; if (i != drives + 1) print "a drive in " i; continue }
         full = head[i]
         word = full
         sub(/.*[.]/, "", word)
         name = substr(full, 1, length(full) - length(word) - 1)
         kind = (word in pair) ? "PAIR" : (("LINK", name) in names_of) ? "LINK" : "POINT"
         if (kind == "POINT" && !((kind, name) in names_of)) { sub(/[^.]*[.]/, "", name) }
         if (kind == "PAIR") word = pair[word]
         for (r = 1; r <= rows; r++) {
            if (!((r, kind, name) in has)) continue
            wanted = csv[r, kind, name, word]
            if (wanted != "") found++
            else wanted = "NaN"
            if (table[r, i] != wanted) print head[i] " in row " r ": " table[r, i] " is not " wanted
         }
      }
      print found + 0
   }' "$1" "$2"; }

# COLUMN cards choose cells: ratios.sh.
for deck in $(grep -LE '^(VARY|COLUMN)' input/*.deck); do
   name=$(basename "$deck" .deck)
   sets=$(grep -c '^END' "$deck")
   "$kinmat" "$deck" --csv "$w/$name.csv" --table "$w/$name.table.csv" > "$w/lst" 2> "$w/err"
   same "$name: the listing is as it was" "expected/$name.lst" "$w/lst"
   set=1
   while [ "$set" -le "$sets" ]; do
      table=$w/$name.table.csv
      [ "$sets" -eq 1 ] || table=$w/$name.table-$set.csv
      equal "$name, set $set: the cells of the CSV" "$(awk -F, -v set="$set" '$1 == set { for (i = 6; i < 15; i++) n += $i != "" && $4 ~ /^(LINK|POINT|PAIR)$/ }
         END { print n + 0 }' "$w/$name.csv")" "$(cells "$table" "$w/$name.csv" "$set")"
      set=$((set + 1))
   done
done
"$kinmat" input/four_bar.deck --sets 2/2 --table - > "$w/out"
same 'one set of two, on standard output' "$w/four_bar.table-2.csv" "$w/out"

# A four-bar that cannot go on after instant 2, a wheel that can, and two drives of one name: each row has every column, NaN
# where a value is missing, and no name stands twice.
{
   card UNITS M DEG S; card GROUND BASE
   for link in CRANK COUPLER ROCKER WHEEL; do card LINK $link; done
   card JOINT A0 BASE CRANK 0.0 0.0; card JOINT A CRANK COUPLER 2.0 0.0; card JOINT B COUPLER ROCKER 3.0 1.5
   card JOINT B0 ROCKER BASE 4.0 0.0; card JOINT W0 BASE WHEEL 6.0 0.0
   for link in CRANK WHEEL WHEEL; do card DRIVE ANGLE $link '' 0.0 30.0; done
   card POINT RIM WHEEL '' 7.0 0.0; card TIME 4 '' '' 0.0 4.0
   card PRINT POINTS B; card PRINT POINTS RIM; card END
} > "$w/missing.deck"
"$kinmat" --no-listing --table "$w/missing.csv" "$w/missing.deck"
equal 'what is missing: status' 2 $?
equal 'what is missing: names of columns' \
   't,ANGLE.CRANK,ANGLE.WHEEL,ANGLE.WHEEL.2,B.x,B.y,RIM.x,RIM.y,B.vx,B.vy,RIM.vx,RIM.vy,B.ax,B.ay,RIM.ax,RIM.ay' "$(head -n 1 "$w/missing.csv")"
equal 'what is missing: a row' '3.0000000000000000E+000,9.0000000000000000E+001,9.0000000000000000E+001,9.0000000000000000E+001,NaN,NaN' \
   "$(sed -n 5p "$w/missing.csv" | cut -d, -f1-6)"
equal 'what is missing: cells of a row' '16 16 16 16 16 16' "$(awk -F, '{ print NF }' "$w/missing.csv" | xargs)"
equal 'what is missing: numbers of the last row' 4,6 "$(awk -F, 'NR == 6 { for (i = 1; i <= NF; i++) n[$i == "NaN"]++; print n[0] - 6 "," n[1] }' "$w/missing.csv")"
sed '/DRIVE   ANGLE   CRANK/s/ 0.0 / 120.0 /' "$w/missing.deck" > "$w/beside.deck"
"$kinmat" --no-listing --table "$w/beside.csv" "$w/beside.deck"
sed -e '/DRIVE   ANGLE   WHEEL/a\
VARY    R2      LIST            30.0            20.0' -e '/^PRINT/d' "$w/missing.deck" | sed '/^END/i\
RANGE' > "$w/vary.deck"
"$kinmat" --no-listing --summary "$w/summary.csv" "$w/vary.deck" 2> "$w/err"
equal 'a summary: no column has the name of another one' '' "$(head -n 1 "$w/summary.csv" | tr , '\n' | sort | uniq -d)"
equal 'a summary: the second drive of a name' 'ANGLE.WHEEL.RATE,ANGLE.WHEEL.RATE.2,range.min.ANGLE.WHEEL,range.min.ANGLE.WHEEL.2' \
   "$(head -n 1 "$w/summary.csv" | tr , '\n' | grep '^[AR].*RATE\|range.min.*WHEEL' | paste -sd,)"

# docs/plot.gp draws a table: over time, and over the first drive. A gap is where a value is missing.
if command -v gnuplot > /dev/null; then
   plotted() { sort -u "$1.svg" | grep -cE '<text>[A-Z0-9-]+[.](v|a|)(x|y|phi)<'; }
   for over in 1 2; do
      gnuplot -e "table = '$w/four_bar.table-1.csv'; over = $over" docs/plot.gp > "$w/out" 2> "$w/err"
      equal "gnuplot, column $over: status and messages" '0 ' "$? $(cat "$w/err")"
      # Columns that are zero throughout are not drawn.
      equal "gnuplot, column $over: quantities of a table" "$(awk -F, '
         NR == 1 { for (c = 1; c <= NF; c++) name[c] = $c; next } { for (c = 1; c <= NF; c++) if ($c != "NaN" && $c != 0) drawn[c] = 1 }
         END { for (c in drawn) n += name[c] ~ /[.](v|a|)(x|y|phi)$/; print n }' "$w/four_bar.table-1.csv")" "$(plotted "$w/four_bar.table-1.csv")"
   done
   # The table as it is: 39 instants of the four-bar, those with velocities of a mechanism in its change points.
   points() { gnuplot -e "set datafile separator ','; set table '$w/points'; plot '$1' using $2; unset table" > /dev/null 2>&1
      grep -c ' i$' "$w/points"; }
   equal 'gnuplot reads a table: all rows' 39 "$(points "$w/four_bar.table-1.csv" 2:5)"
   equal 'gnuplot reads a table: positions' "$(sed 1d "$w/scott_russell_at.table.csv" | wc -l | tr -d ' ')" \
      "$(points "$w/scott_russell_at.table.csv" 1:5)"
   equal 'gnuplot reads a table: velocities' "$(awk -F, '$4 == "POINT" && $15 == ""' "$w/scott_russell_at.csv" | wc -l | tr -d ' ')" \
      "$(points "$w/scott_russell_at.table.csv" 1:23)"
   equal 'gnuplot: what is known beside what is not' 5 "$(points "$w/beside.csv" 1:8)"
   equal 'gnuplot: a gap' 3 "$(points "$w/missing.csv" '"t":"B.x"')"
else
   echo 'skipped: pictures of gnuplot (not installed)'
fi

# A drawing without a PRINT card: in the listing alone all points and, of links without axes of their own, the angle.
# drawing CARD...: a four-bar far from the origin, its crank of length 1 at 30 t degrees, with these cards before END
drawing() { card UNITS M DEG S; card GROUND BASE; card LINK CRANK; card LINK COUPLER; card LINK ROCKER '' '' $rocker
   card JOINT A0 BASE CRANK 10.0 10.0; card JOINT A CRANK COUPLER 11.0 10.0; card JOINT B COUPLER ROCKER 13.0 12.5
   card JOINT B0 ROCKER BASE 14.0 10.0; card POINT C COUPLER '' 12.0 12.0; card DRIVE ANGLE CRANK '' '' 30.0
   card TIME 4 '' '' 0.0 4.0; for more in "$@"; do echo "$more"; done; card END; }
# listed NAME CARD...: the listing, the CSV, the table and the picture of the drawing
listed() { name=$1; shift; drawing "$@" > "$w/$name.deck"
   "$kinmat" "$w/$name.deck" --csv "$w/$name.csv" --table "$w/$name.table" --svg "$w/$name.svg" > "$w/$name.lst" 2> "$w/err"; }
# rows NAME [HEAD]: the rows of the instants' tables whose head begins with HEAD, or of all
rows() { awk -v head="$2" '/^ INSTANT/ { on = 0; print "--" } /^ EXTREMES/ { exit } /^ (LINK|POINT|PAIR) / && /X|PHI|SLIDE/ { on = kind = $1; getline; next }
   # Heads stand again only where they change: the first row of the next instant is of the kind before it.
   !on && kind && NF && !/^ INSTANT/ { on = kind }
   on && NF && (head == "" || on == head) && !/^ (CONTINUATION|END|INSTANT)/' "$w/$1.lst"; }
rocker=
listed default
listed links "$(card PRINT LINKS)"
listed both "$(card PRINT LINKS)" "$(card PRINT POINTS)"
listed extremes "$(card EXTREMES LINKS)" "$(card EXTREMES POINTS C)"
listed extremes_of_links "$(card PRINT LINKS)" "$(card EXTREMES LINKS)" "$(card EXTREMES POINTS C)"
equal 'a drawing: the columns of links' 'LINK PHI VPHI APHI|DEG DEG/S DEG/S**2' \
   "$(awk '/^ INSTANT 0/ { on = NR } on && (NR == on + 1 || NR == on + 2) { $1 = $1; printf "%s%s", mark, $0; mark = "|" }' "$w/default.lst")"
equal 'a drawing: the angles of links' "$(rows links LINK | awk 'NF > 8 { $0 = $1 " " $4 " " $7 " " $10 } 1')" \
   "$(rows default LINK | awk '{ $1 = $1 } 1')"
equal 'a drawing: the points are those of PRINT POINTS' "$(rows both POINT)" "$(rows default POINT)"
equal 'a drawing: the end of the crank' "$(awk 'BEGIN { d = atan2(0, -1)/180
   for (t = 0; t < 5; t++) printf "%.5f %.5f\n", 10 + cos(30*t*d), 10 + sin(30*t*d) }')" "$(rows default POINT | awk '$1 == "A" { print $2, $3 }')"
equal 'a drawing: the rows at an instant' 'CRANK COUPLER ROCKER A0 A B B0 C' "$(rows default | awk '/^--/ { n++; next } n == 2 { print $1 }' | tr '\n' ' ' | sed 's/ $//')"
equal 'a drawing: what is echoed' ' PRINT    LINKS             1        PHI, VPHI, APHI (DEFAULT) PRINT    POINTS            1 (DEFAULT)' \
   "$(grep '^ PRINT' "$w/default.lst" | sed 's/   *(DEFAULT)/ (DEFAULT)/' | tr -d '\n')"
for suffix in csv table svg; do
   same "a drawing: $suffix as with PRINT LINKS" "$w/links.$suffix" "$w/default.$suffix"
   same "a drawing with EXTREMES: $suffix as with PRINT LINKS" "$w/extremes_of_links.$suffix" "$w/extremes.$suffix"
done
equal 'a drawing: EXTREMES LINKS has all columns' "$(awk '/^ EXTREMES   T/ { on = 1 } /^ CONTINUATION/ { exit } on' "$w/extremes_of_links.lst")" \
   "$(awk '/^ EXTREMES   T/ { on = 1 } /^ CONTINUATION/ { exit } on' "$w/extremes.lst")"
rocker='14.0 10.0 111.0'
listed own
listed own_links "$(card PRINT LINKS)"
equal 'a drawing: a link with axes of its own has all columns' "$(rows own_links LINK | grep -E 'ROCKER|--')" "$(rows own LINK | grep -E 'ROCKER|--')"
equal 'a drawing: its other links have their angles' "$(rows own_links LINK | awk 'NF > 8 && !/ROCKER/ { print $1, $4, $7, $10 }')" \
   "$(rows own LINK | awk '!/ROCKER|--/ { $1 = $1; print }')"
equal 'a drawing with axes of its own: what is echoed' 1 "$(grep -c '^ PRINT    LINKS             1        PHI, VPHI, APHI OF THOSE WITHOUT NUMBERS  *(DEFAULT)$' "$w/own.lst")"
# Against the closed form of a drawing, without its PRINT card.
grep -v '^PRINT   ALL' input/drawing.deck > "$w/drawing.deck"
"$BUILD/release/print_expected" "$w/drawing.deck" > "$w/drawing.expected" 2>&1
"$kinmat" "$w/drawing.deck" > "$w/drawing.lst" 2>&1
same 'a drawing: the closed form' "$w/drawing.expected" "$w/drawing.lst"
equal 'a drawing: the closed form has points that no card asks for' 25 "$(sed '1,/^ END OF SET 1/d' "$w/drawing.expected" | grep -c '^ POINT  *X')"
rocker=
# Tolerances, in Polish.
listed tolerances "$(card LANG PL)" "$(card JOINT D BASE BAR)" "$(card TOLER '' '' '' 0.01)" "$(card LINK BAR)" "$(card DRIVE ANGLE BAR '' '' 1.0)"
equal 'a drawing with tolerances: rows of its links' "$(printf 'BAR\nNAJGOR.\nRSS')" \
   "$(awk '/^ CHWILA 0/ { on = 1 } /^ PUNKT/ { exit } on && on++ > 3 { print $1 }' "$w/tolerances.lst" | tail -n 3)"
equal 'a drawing with tolerances: shares of no column that is not listed' '' "$(grep -E '^ OGNIWO [A-Z]+  [VA]?[XY] ' "$w/tolerances.lst")"
equal 'a drawing with tolerances: shares of points' yes "$(grep -qE '^ PUNKT D  X ' "$w/tolerances.lst" && echo yes)"

cp input/four_bar.deck "$w/own-1.deck"
rejected '--table without a file' 1 ' *** OPTION --table NEEDS A FILE NAME' "$w/own-1.deck" --table
rejected '--table twice' 1 ' *** OPTION --table IS GIVEN TWICE' "$w/own-1.deck" --table "$w/a" --table "$w/b"
rejected '--table and --check' 1 ' *** OPTION --check COMPUTES NO MOTION, WHICH --table NEEDS' "$w/own-1.deck" --table "$w/a" --check
rejected '--table and --time' 1 ' *** OPTION --time CAN ONLY BE COMBINED WITH -o AND --quiet' "$w/own-1.deck" --table "$w/a" --time
rejected 'two tables on standard output' 1 ' *** STANDARD OUTPUT TAKES ONE TABLE ONLY: CHOOSE A SET OF 2 WITH --sets K/2' \
   "$w/own-1.deck" --table -
rejected 'the table of a set is another output' 1 ' *** ONE FILE IS NAMED FOR TWO OUTPUTS' "$w/own-1.deck" --table "$w/a.x" --csv "$w/a-2.x"
rejected 'the table of a set is the deck' 1 " *** THE DECK $w/own-1.deck WOULD BE OVERWRITTEN" "$w/own-1.deck" --table "$w/own.deck"
same 'the table of a set is the deck: it is as it was' input/four_bar.deck "$w/own-1.deck"
rejected '--table to a file that cannot be' 3 ' *** FILE /nonexistent/x-1 CANNOT BE OPENED FOR WRITING (NO SUCH FILE OR DIRECTORY)' \
   "$w/own-1.deck" --table /nonexistent/x
equal 'no file is made by what is refused' '' "$(ls "$w"/a "$w"/a.x "$w"/a-* "$w/b" "$w/own-2.deck" 2> /dev/null)"
if [ -w /dev/full ]; then
   says '--table, disk full' 3 ' *** WRITING /dev/full FAILED (NO SPACE LEFT ON DEVICE)' \
      "$w/own-1.deck" --sets 1/2 --table /dev/full
fi
conclude
