#!/bin/sh
# A reader of its own for the listings: every number of expected/ and of decks that print what no deck of input/ does is the
# value of the CSV, rounded to the digits that are printed, and the rows are those that the PRINT cards ask for. Then listings
# with a fault are read, each of which it must find.
. tests/counting.sh

reader=$BUILD/release/read_listing

# read_one NAME LISTING: against $w/NAME.csv; the counts go to a file
read_one() {
   found=$("$reader" "$2" "$w/$1.csv")
   equal "$1: every number of the listing is that of the CSV" 0 "$?${found##*[0-9] absent}"
   echo "$found" >> "$w/counts"
}

# Ratios and the table of COLUMN cards are beside the CSV in ratios.sh.
for deck in $(grep -LE '^(VARY|COLUMN|PRINT   RATIOS)' input/*.deck); do
   name=$(basename "$deck" .deck)
   "$BUILD/kinmat" --csv "$w/$name.csv" "$deck" > "$w/$name.lst" 2> "$w/err"
   # The assemblies stand in the listing as LINK cards.
   sed -i "/ ASSEMBLY /d" "$w/$name.csv"
   read_one "$name" "expected/$name.lst"
done
# Powers of ten of each table, in Polish, beyond limits; places of sizes that a plain form has no room for; drives of every
# kind, more than there is room for, units too long for their columns. A slide and times so large that they have powers.
for name in two_sizes estimate_of_twenty_links cusp mixed_drives; do
   sed -e '/^DRIVE   SLIDE   GUIDE-X/s/5.0E5/5.0E8/' -e '/^TIME/s/1.0E6/1.0E7/' "tests/system/decks/$name.deck" > "$w/$name.deck"
   "$BUILD/kinmat" --csv "$w/$name.csv" "$w/$name.deck" > "$w/$name.lst" 2> "$w/err"
   read_one "$name" "$w/$name.lst"
done

# sum_of WORD: of all listings
sum_of() { awk -v word="$1" '{ for (i = 2; i <= NF; i++) if ($i ~ "^" word) n += $(i - 1) } END { print n + 0 }' "$w/counts"; }
# at_least NAME LEAST FOUND
at_least() { if [ "$3" -ge "$2" ]; then pass; else miss "$1: $3, not $2 or more"; fi; }
at_least 'numbers read' 79573 "$(sum_of numbers)"
at_least 'masked numbers read' 155 "$(sum_of masked)"
at_least 'numbers that do not exist' 160 "$(sum_of absent)"
equal 'a least count that is not met' 'FEWER NUMBERS THAN THERE MUST BE' "$("$reader" expected/yoke.lst "$w/yoke.csv" 4861)"

# fault NAME DECK AWK WORDS: one change of a listing of expected/ or above; the reader finds it, in words that begin so
fault() {
   listing=expected/$2.lst
   [ -e "$listing" ] || listing=$w/$2.lst
   awk "$3" "$listing" > "$w/fault.lst"
   if cmp -s "$listing" "$w/fault.lst"; then miss "$1: nothing has been changed"; return; fi
   found=$("$reader" "$w/fault.lst" "$w/$2.csv")
   status=$?
   case "$status $found" in
   1\ $4*) pass ;;
   *) miss "$1 is not found: status $status, $found" ;;
   esac
}
# first WHERE WHAT: awk that does this to the first such line; at INSTANT WHERE WHAT: from this instant on
first() { echo "!n && $1 { $2; n = 1 } 1"; }
at() { echo "/^ INSTANT $1 / { on = 1 } on && !n && $2 { $3; n = 1 } 1"; }
fault 'a last digit' yoke \
   "$(at 7 '/[.][0-9]+[1-8]$/' 'd = substr($0, length($0)) + 1; sub(/.$/, d)')" '-*[0-9.]* IS NOT '
fault 'a first digit' jansen \
   "$(at 5 'match($0, / [1-8][.][0-9]/)' '$0 = substr($0, 1, RSTART) substr($0, RSTART + 1, 1) + 1 substr($0, RSTART + 2)')" \
   '[2-9].[0-9]* IS NOT '
fault 'a sign' four_bar "$(at 3 '/ -[0-9]/' 'sub(/ -/, "  ")')" '[0-9.]* IS NOT -'
fault 'a digit of a time' four_bar "$(first '/^ INSTANT 3 /' 'sub(/1[.]/, "2.")')" '2.00000 IS NOT '
fault 'a power of ten' far_small "$(first '/1[.]E-06/' 'sub(/1[.]E-06/, "1.E-05")')" '*IS NOT*'
fault 'a power of ten out of its column' far_small \
   "$(first '/1[.]E-06/' 'sub(/1[.]E-06 /, " 1.E-06")')" 'CANNOT BE READ: '
fault 'a unit' four_bar "$(first '/M\/S\*\*2/' 'sub(/M\/S\*\*2/, "   M/S")')" 'CANNOT BE READ: UNITS'
fault 'a unit left out' four_bar "$(first '/M\/S\*\*2/' 'sub(/M\/S\*\*2/, "      ")')" 'CANNOT BE READ: UNITS'
fault 'a line of units left out' four_bar "$(first '/M\/S\*\*2/' 'n = 1; next')" 'CANNOT BE READ: UNITS'
fault 'the unit of the time' four_bar "$(first '/^ INSTANT 3 /' 'sub(/ S  /, " H  ")')" 'CANNOT BE READ: '
fault 'the value of a drive' four_bar "$(first '/^ INSTANT 3 /' 'sub(/0[.]0+ DEG/, "1.000000 DEG")')" 'CANNOT BE READ: '
fault 'the unit of a drive' four_bar "$(first '/^ INSTANT 3 /' 'sub(/DEG/, "RAD")')" 'CANNOT BE READ: '
fault 'the power of ten of a drive' mixed_drives \
   "$(first '/SLIDE GUIDE-X.*1[.]E[+]06/' 'sub(/1[.]E[+]06 /, "")')" 'CANNOT BE READ: '
fault 'a drive left out' excavator "$(first '/^ INSTANT 3 /' 'sub(/   SLIDE CYL-3 .*/, "")')" 'CANNOT BE READ: '
fault 'a slide in the column of angles' yoke "$(first '/^ SLOT/' 'sub(/ [0-9.]+/, "            &")')" 'CANNOT BE READ'
fault 'a power of ten of a head' two_sizes "$(first '/1[.]E-09/' 'sub(/1[.]E-09/, "1.E-08")')" '*IS NOT*'
fault 'a line of powers left out' two_sizes "$(first '/^ *1[.]E[-+]/' 'n = 1; next')" '*IS NOT*'
fault 'a power of ten of the times' two_sizes "$(first '/^ CHWILA 5 /' 'sub(/1[.]E[+]06/, "1.E+03")')" '*IS NOT*'
fault 'a row left out' yoke "$(at 9 '/[.][0-9]+$/' 'n = 1; next')" 'ANOTHER ROW'
fault 'the last row left out' four_bar '/[.][0-9]+$/ { last = NR } { line[NR] = $0 }
   END { for (i = 1; i <= NR; i++) if (i != last) print line[i] }' 'THE LISTING HAS TOO FEW ROWS'
fault 'a row twice' four_bar "$(at 2 '/^ CRANK/' 'print')" 'ANOTHER ROW'
fault 'two rows of other names' four_bar "$(at 2 '/^ CRANK/' 'sub(/CRANK/, "CRANC")')" 'ANOTHER ROW'
fault 'two heads for one another' four_bar \
   "$(first '/^ LINK.*VX/' 'sub(/VX          VY/, "VY          VX")')" '*IS NOT*'
fault 'a number left out' four_bar "$(at 2 '/^ CRANK/' 'sub(/[0-9.]+$/, "")')" 'CANNOT BE READ'
fault 'a number out of its column' four_bar "$(at 2 '/^ CRANK/' 'sub(/ [0-9.]+$/, " &")')" 'CANNOT BE READ'
fault 'a number for NONE' kite_at "$(first '/NONE/' 'sub(/    NONE/, "0.000000")')" 'PRINTED BUT NOT IN THE CSV'
fault 'NONE for a number' four_bar "$(at 2 '/^ CRANK/' 'sub(/0[.]000000/, "    NONE")')" '*'
fault 'a shown digit before a mask' dead_point_9 "$(first '/2937[?]/' 'sub(/2937[?]/, "2938?")')" '2938*IS NOT'
fault 'a digit after a mask' dead_point_9 "$(first '/2937[?][?]/' 'sub(/2937[?][?]/, "2937?5")')" '*'
fault 'an exponent' dead_point_9 "$(first '/E[+]016/' 'sub(/E[+]016/, "E+017")')" '*IS NOT*'
fault 'a zero with a sign' four_bar "$(at 2 '/ 0[.]000000/' 'sub(/ 0[.]000000/, "-0.000000")')" '-0.0*IS NOT'
fault 'the last line of the set' four_bar "$(first '/^ END OF SET/' 'n = 1; next')" '*'
fault 'the second set' four_bar "$(first '/^ END OF SET 1/' 'print; exit')" 'THE LISTING HAS NO ROW FOR'
conclude
