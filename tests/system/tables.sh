#!/bin/sh
# Tables: of every deck of input/ one a set, whose cells are those of the CSV; what is refused.
BUILD=${BUILD:-build}
. tests/counting.sh

kinmat=$BUILD/kinmat
w=$BUILD/tables
rm -rf "$w" && mkdir -p "$w" || exit 3

# cells TABLE CSV SET: what is wrong in the table of a set; then how many cells the CSV has, those
# counted that a row leaves out since another one before them does not exist
cells() { awk -F, -v set="$3" '
   FILENAME == ARGV[1] && FNR == 1 { columns = NF; for (i = 1; i <= NF; i++) head[i] = $i; if (/ /) print "blanks in the heading"
      for (i = 1; i <= NF; i++) if (seen[$i]++) print "twice: " $i; next }
   FILENAME == ARGV[1] {
      rows++
      if (NF > columns || gsub(/, /, ",") != NF - 1 || / /) print "row " rows
      for (i = 1; i <= NF; i++) table[rows, i] = $i
      length_of[rows] = NF
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
         word = head[i]
         sub(/.*[.]/, "", word)
         name = substr(head[i], 1, length(head[i]) - length(word) - 1)
         kind = (word in pair) ? "PAIR" : (("LINK", name) in names_of) ? "LINK" : "POINT"
         if (kind == "POINT" && !((kind, name) in names_of)) { sub(/[^.]*[.]/, "", name) }
         if (kind == "PAIR") word = pair[word]
         for (r = 1; r <= rows; r++) {
            if (!((r, kind, name) in has)) continue
            wanted = csv[r, kind, name, word]
            if (i <= length_of[r]) { found++; if (table[r, i] != wanted) print head[i] " in row " r ": " table[r, i] " is not " wanted }
            if (i == length_of[r] + 1 && wanted != "") print "row " r " ends before " wanted
            if (i > length_of[r] && wanted != "") found++
         }
      }
      print found + 0
   }' "$1" "$2"; }

for deck in input/*.deck; do
   name=$(basename "$deck" .deck)
   sets=$(grep -c '^END' "$deck")
   "$kinmat" "$deck" --csv "$w/$name.csv" --table "$w/$name.table.csv" > "$w/lst" 2> "$w/err"
   same "$name: the listing is as it was" "expected/$name.lst" "$w/lst"
   set=1
   while [ "$set" -le "$sets" ]; do
      table=$w/$name.table.csv
      [ "$sets" -eq 1 ] || table=$w/$name.table-$set.csv
      equal "$name, set $set: the cells of the CSV" "$(awk -F, -v set="$set" '$1 == set { for (i = 6; i < 15; i++) n += $i != "" }
         END { print n + 0 }' "$w/$name.csv")" "$(cells "$table" "$w/$name.csv" "$set")"
      set=$((set + 1))
   done
done
"$kinmat" input/four_bar.deck --sets 2/2 --table - > "$w/out"
same 'one set of two, on standard output' "$w/four_bar.table-2.csv" "$w/out"

# The words of the command.
refused() { expected=$2; want=$3; name=$1; shift 3; "$kinmat" "$@" > "$w/out" 2> "$w/err"
   equal "$name: status" "$expected" $?; equal "$name: sentence" "$want" "$(cat "$w/err")"; equal "$name: no listing" '' "$(cat "$w/out")"; }
cp input/four_bar.deck "$w/own-1.deck"
refused '--table without a file' 1 ' *** OPTION --table NEEDS A FILE NAME' "$w/own-1.deck" --table
refused '--table twice' 1 ' *** OPTION --table IS GIVEN TWICE' "$w/own-1.deck" --table "$w/a" --table "$w/b"
refused '--table and --check' 1 ' *** OPTION --check COMPUTES NO MOTION, WHICH --table NEEDS' "$w/own-1.deck" --table "$w/a" --check
refused '--table and --time' 1 ' *** OPTION --time GOES WITH NO OTHER OPTION BUT -o' "$w/own-1.deck" --table "$w/a" --time
refused 'two tables on standard output' 1 ' *** STANDARD OUTPUT TAKES THE TABLE OF ONE SET: CHOOSE THE K-TH OF 2 WITH --sets K/2' \
   "$w/own-1.deck" --table -
refused 'the table of a set is another output' 1 ' *** ONE FILE IS NAMED FOR TWO OUTPUTS' "$w/own-1.deck" --table "$w/a.x" --csv "$w/a-2.x"
refused 'the table of a set is the deck' 1 " *** THE DECK $w/own-1.deck WOULD BE OVERWRITTEN" "$w/own-1.deck" --table "$w/own.deck"
same 'the table of a set is the deck: it is as it was' input/four_bar.deck "$w/own-1.deck"
refused '--table to a file that cannot be' 3 ' *** FILE /nonexistent/x-1 CANNOT BE OPENED FOR WRITING (NO SUCH FILE OR DIRECTORY)' \
   "$w/own-1.deck" --table /nonexistent/x
equal 'no file is made by what is refused' '' "$(ls "$w"/a "$w"/a.x "$w"/a-* "$w/own-2.deck" 2> /dev/null)"
if [ -w /dev/full ]; then
   "$kinmat" "$w/own-1.deck" --sets 1/2 --table /dev/full > "$w/out" 2> "$w/err"
   equal '--table, disk full: status' 3 $?
   equal '--table, disk full: sentence' ' *** WRITING /dev/full FAILED (NO SPACE LEFT ON DEVICE)' "$(cat "$w/err")"
fi
conclude
