#!/bin/sh
# The command as a user calls it: where a deck comes from and where results go, exit statuses, the exact words of every
# refusal, and that results do not depend on the build, the share or the linear algebra library.
. tests/counting.sh

# one_set RATE FOUR-BAR...: as still_four_bar, but in radians, at the instants 0, 1, 2, the crank at this rate
one_set() {
   rate=$1
   shift
   still_four_bar "$@" |
      sed -e 's/DEG/RAD/' -e "s/^\(DRIVE .*\) 30.0/\1 $rate/" -e "s/^AT .*/$(card TIME 2 '' '' 0.0 2.0)/"
}

# Two sets of computations of a crank-rocker.
{
   card TITLE 'TEST '; moving_four_bar '' '' '' '' "$(card TIME 8 '' '' 0.0 4.0)" "$(card PRINT ALL)"
   card TITLE 'TEST AT'; moving_four_bar '' '' '' '' "$(card AT '' '' '' 2.5 0.5 1.5)" "$(card PRINT ALL)"
} > "$w/m.deck"

# Where the deck comes from, where the listing goes.
"$kinmat" "$w/m.deck" > "$w/m.lst" 2> "$w/err"
equal 'deck by name: status' 0 $?
equal 'deck by name: standard error' '' "$(cat "$w/err")"
equal 'sets are numbered' \
   ' SET OF COMPUTATIONS NO. 1   TITLE   TEST SET OF COMPUTATIONS NO. 2   TITLE   TEST AT' \
   "$(grep 'SET OF COMPUTATIONS' "$w/m.lst" | tr -d '\n')"
equal 'last lines of the sets' \
   ' END OF SET 1:  INSTANTS SOLVED 9, FLAGGED 0 END OF SET 2:  INSTANTS SOLVED 3, FLAGGED 0' \
   "$(grep 'END OF SET' "$w/m.lst" | tr -d '\n')"
equal 'instants in the order wanted' 'T = 2.500000T = 0.500000T = 1.500000' \
   "$(sed '1,/^ END OF SET 1/d' "$w/m.lst" | grep '^ INSTANT ' | sed 's/.*\(T = [0-9.]*\).*/\1/' | tr -d '\n')"
"$kinmat" < "$w/m.deck" > "$w/out"
same 'deck from standard input' "$w/m.lst" "$w/out"
cat "$w/m.deck" | "$kinmat" > "$w/out"
same 'deck from a pipe' "$w/m.lst" "$w/out"
"$kinmat" - < "$w/m.deck" > "$w/out"
same 'deck -' "$w/m.lst" "$w/out"
echo 'an old and longer text' > "$w/o.lst"
"$kinmat" -o "$w/o.lst" "$w/m.deck" > "$w/out"
same '-o FILE' "$w/m.lst" "$w/o.lst"
equal '-o FILE: standard output' '' "$(cat "$w/out")"
echo kept > "$w/out"
"$kinmat" "$w/m.deck" >> "$w/out"
{ echo kept; cat "$w/m.lst"; } > "$w/wanted"
same 'standard output is appended to where the shell says so' "$w/wanted" "$w/out"
(cd "$w" && "$kinmat" m.deck) > "$w/out"
same 'deck in the working directory' "$w/m.lst" "$w/out"
mkdir -p "$w/a directory" && cp "$w/m.deck" "$w/a directory/a deck"
"$kinmat" "$w/a directory/a deck" -o "$w/a directory/a listing"
same 'names with blanks' "$w/m.lst" "$w/a directory/a listing"
sed "s/\$/$(printf '\r')/" "$w/m.deck" > "$w/crlf.deck"
"$kinmat" "$w/crlf.deck" > "$w/out"
same 'CR-LF' "$w/m.lst" "$w/out"

# --csv: form, 17 digits, and agreement with the listing.
"$kinmat" "$w/m.deck" --csv "$w/m.csv" > "$w/out"
same '--csv leaves the listing as it is' "$w/m.lst" "$w/out"
equal '--csv: header' 'set,step,t,kind,name,x,y,phi,vx,vy,vphi,ax,ay,aphi,mark' "$(head -n 1 "$w/m.csv")"
equal '--csv: one header' 1 "$(grep -c set "$w/m.csv")"
equal '--csv: 15 columns' '' "$(awk -F, 'NF != 15' "$w/m.csv")"
# PRINT ALL: 3 moving links, 8 points, 4 pairs at 9 + 3 instants.
equal '--csv: rows' $((12 * (3 + 8 + 4) + 1)) "$(wc -l < "$w/m.csv" | tr -d ' ')"
equal '--csv: kinds' 'LINK PAIR POINT ' "$(sed 1d "$w/m.csv" | cut -d, -f4 | sort -u | tr '\n' ' ')"
equal '--csv: form of a number' '' \
   "$(sed 1d "$w/m.csv" | cut -d, -f3,6-14 | tr ',' '\n' | grep -vE '^(-?[0-9][.][0-9]{16}E[-+][0-9]{3})?$')"
equal '--csv: numbers read back as the same number' '' "$(sed 1d "$w/m.csv" | cut -d, -f3,6-14 | tr ',' '\n' \
   | awk '$1 != "" { split($1, a, "E"); split(sprintf("%.16e", $1), b, "e"); if (a[1] != b[1] || a[2] + 0 != b[2] + 0) print }')"
equal '--csv: a value that a kind does not have is empty' '' "$(sed 1d "$w/m.csv" \
   | awk -F, '{ n = 0; for (i = 6; i <= 14; i++) n += ($i != ""); if (n != ($4 == "LINK" ? 9 : $4 == "POINT" ? 6 : 3)) print }')"

# --log
"$kinmat" "$w/m.deck" --log "$w/m.log" > "$w/out"
same '--log leaves the listing as it is' "$w/m.lst" "$w/out"
equal '--log: heads' ' SET 1   METHOD NEWTON SET 2   METHOD NEWTON' "$(grep ' SET ' "$w/m.log" | tr -d '\n')"
equal '--log: a line for each instant' 12 "$(grep -cE ' (CONVERGED|ROUNDING) ' "$w/m.log")"
"$kinmat" "$w/m.deck" --csv "$w/three.csv" --log "$w/three.log" -o "$w/three.lst" > "$w/out"
same 'three outputs: listing' "$w/m.lst" "$w/three.lst"
same 'three outputs: csv' "$w/m.csv" "$w/three.csv"
same 'three outputs: log' "$w/m.log" "$w/three.log"

# - is standard output, for one output; the listing then goes to a file or nowhere.
for option in -o --csv --log; do
   ends "$option -" 0 "$w/m.deck" $option -
   case $option in -o) name=lst ;; *) name=${option#--} ;; esac
   same "$option -" "$w/m.$name" "$w/out"
done
"$kinmat" "$w/m.deck" --svg - > "$w/out" 2> "$w/err"
"$kinmat" "$w/m.deck" --svg "$w/m.svg" > "$w/o.lst" 2> "$w/err"
same '--svg -' "$w/m.svg" "$w/out"
"$kinmat" "$w/m.deck" --csv - -o "$w/o.lst" > "$w/out"
same '--csv - and -o: the CSV' "$w/m.csv" "$w/out"
same '--csv - and -o: the listing' "$w/m.lst" "$w/o.lst"
equal 'no file is called -' '' "$(ls ./- 2> /dev/null)"
rejected 'two outputs to standard output' 1 ' *** ONLY ONE OUTPUT CAN GO TO STANDARD OUTPUT' "$w/m.deck" --csv - -o -
rejected 'two others to standard output' 1 ' *** ONLY ONE OUTPUT CAN GO TO STANDARD OUTPUT' --log - "$w/m.deck" --csv -

# --no-listing: the other outputs, messages and statuses are the same.
ends '--no-listing' 0 "$w/m.deck" --no-listing
equal '--no-listing: nothing is printed' '' "$(cat "$w/out" "$w/err")"
"$kinmat" --no-listing "$w/m.deck" --csv "$w/o.csv" --log "$w/o.log" > "$w/out"
same '--no-listing: the CSV' "$w/m.csv" "$w/o.csv"
same '--no-listing: the log' "$w/m.log" "$w/o.log"
rejected '--no-listing and -o' 1 ' *** OPTIONS --no-listing AND -o EXCLUDE EACH OTHER' "$w/m.deck" --no-listing -o "$w/x"

# --quiet: no remarks on standard error, but errors.
sed 's/^PRINT /GROUND  IDLE\n&/' "$w/m.deck" > "$w/remark.deck"
"$kinmat" "$w/remark.deck" --no-listing > "$w/out" 2> "$w/err"
equal 'without --quiet there are remarks' 2 "$(grep -c '^ --- .*IS A LINK WITHOUT' "$w/err")"
says '--quiet' 0 '' "$w/remark.deck" --no-listing --quiet
"$kinmat" --quiet "$w/remark.deck" > "$w/out" 2> "$w/err"
equal '--quiet: the listing has its remarks' 2 "$(grep -c '^ --- .*IS A LINK WITHOUT' "$w/out")"
sed '/^DRIVE/d' "$w/remark.deck" > "$w/quiet.deck"
"$kinmat" "$w/quiet.deck" --quiet > "$w/out" 2> "$w/err"
equal '--quiet: errors are told, and no remarks' '*** E101 *** E103 *** E101 *** E103 ' "$(awk '{ printf "%s %s ", $1, $2 }' "$w/err")"

# --errors: nine more columns, as empty as the numbers they belong to; estimates of a four-bar are some roundings.
"$kinmat" "$w/m.deck" --errors --csv "$w/e.csv" --log "$w/e.log" > "$w/out"
same '--errors leaves the listing as it is' "$w/m.lst" "$w/out"
cut -d, -f1-15 "$w/e.csv" > "$w/e15.csv"
same '--errors leaves the other columns as they are' "$w/m.csv" "$w/e15.csv"
equal '--errors: header' 'ex,ey,ephi,evx,evy,evphi,eax,eay,eaphi' "$(head -n 1 "$w/e.csv" | cut -d, -f16-)"
equal '--errors: an error for each number' '' "$(awk -F, '
   NR > 1 { for (i = 6; i < 15; i++) if (($i == "") != ($(i + 10) == "")) print }' "$w/e.csv")"
equal '--errors: their size' '' "$(awk -F, '
   NR > 1 { for (i = 16; i < 25; i++) if ($i != "" && ($i < 0 || $i > 1e-10)) print }' "$w/e.csv")"

# --check: the heads of the sets, without one instant.
says '--check' 0 '' --check "$w/m.deck"
awk '/^ INSTANT 0 / { skip = 1 } !skip { if (held) print line; line = $0; held = 1 }
   /^ END OF SET/ { skip = 0; held = 0; getline }' "$w/m.lst" > "$w/wanted"
same '--check: the heads' "$w/wanted" "$w/out"

# --sets: shares put together are the whole.
for shares in 1 2 3; do
   : > "$w/shares.lst"; : > "$w/shares.csv"
   share=1
   while [ $share -le $shares ]; do
      "$kinmat" "$w/m.deck" --sets $share/$shares --csv "$w/share.csv" > "$w/share.lst"
      equal "--sets $share/$shares: status" 0 $?
      cat "$w/share.lst" >> "$w/shares.lst"
      cat "$w/share.csv" >> "$w/shares.csv"
      share=$((share + 1))
   done
   same "$shares shares: listing" "$w/m.lst" "$w/shares.lst"
   same "$shares shares: csv" "$w/m.csv" "$w/shares.csv"
done
"$kinmat" "$w/m.deck" --sets 1/2 > "$w/share.lst"
equal '--sets 1/2: its sets' 1 "$(grep -c 'SET OF COMPUTATIONS' "$w/share.lst")"
for share in 0/2 3/2 x 1 1/ /2 1/2/3 -1/2 1/0 1.0/2 ''; do
   rejected "--sets '$share'" 1 ' *** OPTION --sets NEEDS K/N WITH 1 <= K <= N, SUCH AS 1/4' "$w/m.deck" --sets "$share"
done
rejected '--sets without a word' 1 ' *** OPTION --sets NEEDS K/N WITH 1 <= K <= N, SUCH AS 1/4' "$w/m.deck" --sets

# --jobs: the sets in several processes give the same bytes, and end as one process does.
for jobs in 1 2 3 8; do
   "$kinmat" "$w/m.deck" --jobs $jobs --csv "$w/jobs.csv" --log "$w/jobs.log" --table "$w/jobs.table" > "$w/jobs.lst" 2> "$w/err"
   equal "--jobs $jobs: status" 0 $?
   same "$jobs jobs: listing" "$w/m.lst" "$w/jobs.lst"
   same "$jobs jobs: csv" "$w/m.csv" "$w/jobs.csv"
   cat "$w/jobs.log" "$w"/jobs-*.table > "$w/jobs.$jobs"
   same "$jobs jobs: log and tables" "$w/jobs.1" "$w/jobs.$jobs"
done
"$kinmat" "$w/m.deck" --sets 2/2 --jobs 2 > "$w/out"
"$kinmat" "$w/m.deck" --sets 2/2 | same '--jobs with --sets' - "$w/out"
sh -c 'exec 3>&- 4>&- 5>&- 6>&- 7>&- 8>&- 9>&-; ulimit -n 4; exec "$0" "$1" --jobs 2' "$kinmat" "$w/m.deck" > "$w/out" 2> "$w/err"
equal '--jobs: no files: status' 3 $?
equal '--jobs: no files' ' *** CANNOT START A PROCESS FOR SETS 1 TO 1 (TOO MANY OPEN FILES)' "$(cat "$w/err")"
# Instants without an assembly are flagged, also where the system keeps no exit status of processes.
one_set 1.0 1.0 1.0 1.0 4.0 CRANK 0.0 0.9 1.9 0.0 "$(card PRINT ALL)" > "$w/open.deck"
cat "$w/open.deck" "$w/open.deck" > "$w/flagged.deck"
env --ignore-signal=CHLD "$kinmat" "$w/flagged.deck" --jobs 2 > "$w/out" 2> "$w/err"
equal '--jobs: flagged instants, SIGCHLD ignored' 2 $?
# Two processes, of which one cannot go on, since nobody reads its output; the other computes all further sets and waits for
# its turn, as the system's list of locks shows. One of them is killed.
sed 's/^TIME .*/TIME    360                     0.0             12.0/' input/four_bar.deck > "$w/long.deck"
cat "$w/long.deck" "$w/long.deck" > "$w/four.deck"
"$kinmat" "$w/four.deck" --jobs 1 --table "$w/kept.table" > "$w/four.lst"
mkfifo "$w/pipe"
for killed in waits writes; do
   "$kinmat" "$w/four.deck" --jobs 2 --table "$w/four.table" > "$w/pipe" 2> "$w/err" &
   job=$!
   exec 5< "$w/pipe"
   children=
   waits=
   waited=0
   until [ -n "$waits" ] || [ $waited -ge 200 ]; do
      sleep 0.02
      waited=$((waited + 1))
      children=$(cat /proc/$job/task/$job/children 2> /dev/null)
      for child in $children; do
         if awk -v child=$child '$2 == "->" && $6 == child { found = 1 } END { exit !found }' /proc/locks; then waits=$child; fi
      done
   done
   for child in $children; do
      if [ "$child" != "$waits" ]; then writes=$child; fi
   done
   if [ $killed = waits ]; then kill -KILL "$waits"; else kill -KILL "$writes"; fi
   cat <&5 > "$w/out"
   exec 5<&-
   wait $job
   equal "--jobs: the process that $killed is killed: status" 3 $?
   if [ $killed = waits ]; then
      "$kinmat" "$w/four.deck" --sets 1/4 | same '--jobs: what was written before' - "$w/out"
      set=2
   else
      head -c "$(wc -c < "$w/out" | tr -d ' ')" "$w/four.lst" | same '--jobs: what was written until then' - "$w/out"
      equal '--jobs: of the first set alone' 1 "$(grep -c 'SET OF COMPUTATIONS' "$w/out")"
      set=1
   fi
   # A table is written when its set is computed.
   for k in 2 3 4; do same "--jobs: $killed: the table of set $k" "$w/kept-$k.table" "$w/four-$k.table"; done
   rm "$w"/four-*.table
   equal "--jobs: the process that $killed is killed" " *** THE PROCESS FOR SETS $set TO $set WAS ENDED BY SIGNAL 9" "$(cat "$w/err")"
done
for jobs in 0 x 1025 -1 1.5 ''; do
   rejected "--jobs '$jobs'" 1 ' *** OPTION --jobs NEEDS A WHOLE NUMBER FROM 1 TO 1024' "$w/m.deck" --jobs "$jobs"
done
rejected '--study with --jobs' 1 ' *** OPTION --study CAN ONLY BE COMBINED WITH -o AND --quiet' "$w/m.deck" --study --jobs 2

# A share reads the whole deck, and a wrong set rejects each of them.
{ cat "$w/m.deck"; echo 'WRONG'; echo END; } > "$w/wrong.deck"
"$kinmat" "$w/wrong.deck" --sets 1/9 > "$w/out" 2>&1
equal 'a share beside a wrong set' 1 $?
"$kinmat" --sets 1/9 < "$w/wrong.deck" > "$w/out" 2> "$w/err"
equal 'a share of a pipe with a wrong set' 1 $?
ends 'the share of a wrong set' 1 "$w/wrong.deck" --sets 9/9

# --help, --version, --ruler
ends '--help' 0 --help
equal '--help: first line' 'Usage: kinmat [OPTIONS] [DECK]' "$(head -n 1 "$w/out")"
equal '--help: three examples' 3 "$(grep -c '^  kinmat ' "$w/out")"
equal '--help: a line an option, with a verb first' '' "$(grep -E '^  -' "$w/out" | cut -c 24- | grep -vE '^(Add|Check|Do not|Draw|Explain|Omit|Print|Run|Suppress|Write) ')"
equal '--help: no line of more than 80 columns' '' "$(grep -E '^.{81}' "$w/out")"
for option in -o --no-listing --quiet --csv --log --svg --table --check --errors --sets --ruler --explain --help --version; do
   equal "--help tells of $option" found "$(grep -qe "$option" "$w/out" && echo found)"
done
equal '--version' 'KINMAT 2.0, REAL64' "$("$kinmat" --version)"
equal '--ruler' '$NAME---LABEL-A|LABEL-B|LABEL-C|REAL-1---------|REAL-2---------|REAL-3---------|' "$("$kinmat" --ruler | head -n 1)"
equal '--ruler: all cards, and the * card' "$(for name in $("$kinmat" --ruler NOCARD 2>&1 | sed 's/.*CARDS ARE //'); do
   "$kinmat" --ruler "$name" | sed -n 2p; done)
*       R1 OF THE CARD ABOVE    R2                      R3" "$("$kinmat" --ruler | sed 1d)"
equal '--ruler CARD' '$NAME---LABEL-A|LABEL-B|LABEL-C|REAL-1---------|REAL-2---------|REAL-3---------|
JOINT   PAIR    LINK-I  LINK-J  X               Y
LABEL-A  name of the pair, and of its point: label; required
LABEL-B  link i: name of a GROUND or LINK card; required
LABEL-C  link j: name of a GROUND or LINK card; required
REAL-1   x of the joint in the drawing: real; default: 0.0; unit: length
REAL-2   y of the joint in the drawing: real; default: 0.0; unit: length' "$("$kinmat" --ruler JOINT)"
equal '--ruler CARD: a line for each field' '' "$(for name in $("$kinmat" --ruler NOCARD 2>&1 | sed 's/.*CARDS ARE //'); do
   "$kinmat" --ruler "$name" | awk -v name="$name" 'NR == 2 { split("9 17 25 33 49 65 81", from, " ")
         split("LABEL-A LABEL-B LABEL-C REAL-1 REAL-2 REAL-3", field, " ")
         for (i = 1; i <= 6; i++) if (name != "TITLE" && substr($0, from[i], from[i + 1] - from[i]) ~ /[^ ]/) fields = fields field[i] " " }
      NR > 2 && /^(LABEL|REAL)-/ { found = found $1 " " }
      length > 80 { print name ": " $0 }
      END { if (fields != found) print name ": " fields "/ " found }'; done)"
# --explain: the entry of a code, of words, of a whole message; each code of the documents has one.
equal '--explain CODE' 'E102   TOO MANY EQUATIONS BY n AMONG PAIRS ... AND DRIVES ...
       CAUSE  with E101: a drive, or a link of a JOINT card, is in the wrong
              place; lines LINKS as for E101
       CURE   move the drive to the links of E101, or correct the link' "$("$kinmat" --explain E102 | sed -n '/TOO MANY/,$p')"
equal '--explain CODE in small letters' "$("$kinmat" --explain E020)" "$("$kinmat" --explain e020)"
equal '--explain WORDS' '*** NO POSITION FOUND' "$("$kinmat" --explain 'NO POSITION FOUND' | head -n 1)"
equal '--explain WORDS, in small letters and as several words' "$("$kinmat" --explain 'NO POSITION FOUND')" "$("$kinmat" --explain no position  found)"
equal '--explain WORDS: all entries' 7 "$("$kinmat" --explain 'the name of a' | grep -c '^E0[145][0-9]')"
equal '--explain with a whole message' '*** CHANGE POINT, LINKS ... COLLINEAR: VELOCITIES NOT UNIQUE' \
   "$("$kinmat" --explain ' *** CHANGE POINT, LINKS COUPLER, ROCKER COLLINEAR: VELOCITIES NOT UNIQUE' | head -n 1)"
equal '--explain with a whole message that has a code' "$("$kinmat" --explain E018)" \
   "$("$kinmat" --explain ' *** E018  CARD 10  COLUMN 47  FIELD REAL-1: "2.75" CROSSES THE FIELD BORDER BETWEEN COLUMNS 48 AND 49')"
equal '--explain: every code' '' "$(grep -oE '^[|] E[0-9]+' docs/messages.md | tr -d '| ' | sort -u | while read -r code; do
   "$kinmat" --explain "$code" | grep -q "^$code" || echo "$code"; done)"
equal '--explain: entries without a cure, and lines over 80 columns' '' "$({ grep -oE '^[|] E[0-9]+' docs/messages.md | tr -d '| ' | sort -u | while read -r code; do
   "$kinmat" --explain "$code"; echo; done; "$kinmat" --explain '***'; echo; "$kinmat" --explain ---; } | awk 'BEGIN { RS = "" }
   !/\n       CURE   ./
   { entries++; n = split($0, line, "\n"); for (i = 1; i <= n; i++) if (length(line[i]) > 80) print line[i] }
   END { if (entries < 100) print entries }')"
rejected '--explain without words' 1 ' *** OPTION --explain NEEDS A CODE SUCH AS E101, OR WORDS OF A MESSAGE' --explain
rejected '--explain with blanks' 1 ' *** OPTION --explain NEEDS A CODE SUCH AS E101, OR WORDS OF A MESSAGE' --explain ' '
rejected '--explain with unknown words' 1 ' *** OPTION --explain NEEDS A CODE SUCH AS E101, OR WORDS OF A MESSAGE' --explain E999
equal '--ruler CARD, in small letters and before the option' "$("$kinmat" --ruler DRIVE)" "$("$kinmat" drive --ruler)"
rejected '--ruler with no card' 1 ' *** OPTION --ruler: NO CARD HAS THE NAME x.deck; CARDS ARE TITLE UNITS LANG GROUND LINK POINT REVOLUTE PRISM SLOT CYLINDER JOINT DRIVE ADD RISE LENGTH TOLER TIME AT METHOD PRINT COLUMN EXTREMES RANGE CIRCUITS POLE CURVE BRANCH VARY ASSEMBLY PROVE DISTANCE LINE ANGLE XI ETA SUM END' --ruler x.deck

# Refused commands: status 1 or 3, one sentence, no listing.
rejected 'unknown option' 1 ' *** OPTION --nope IS UNKNOWN; SEE kinmat --help' --nope "$w/m.deck"
rejected 'unknown option after the deck' 1 ' *** OPTION --nope IS UNKNOWN; SEE kinmat --help' "$w/m.deck" --nope
rejected 'two decks' 1 ' *** MORE THAN ONE DECK IS NAMED: one AND two' one two
rejected 'empty word' 1 ' *** THE NAME OF THE DECK IS EMPTY' ''
rejected '-o without a file' 1 ' *** OPTION -o NEEDS A FILE NAME' "$w/m.deck" -o
rejected '--csv with an option for a file name' 1 ' *** OPTION --csv NEEDS A FILE NAME' "$w/m.deck" --csv --svg
(cd "$w" && "$kinmat" m.deck --no-listing --csv ./--svg 2> err)
equal 'a file whose name begins with -' 'set,step' "$(head -n 1 "$w/--svg" | cut -c 1-8)"
rejected '--csv with an empty file name' 1 ' *** OPTION --csv NEEDS A FILE NAME' "$w/m.deck" --csv ''
rejected '--log twice' 1 ' *** OPTION --log IS GIVEN TWICE' "$w/m.deck" --log "$w/a" --log "$w/b"
rejected 'missing file' 3 " *** FILE $w/no.deck CANNOT BE OPENED (NO SUCH FILE OR DIRECTORY)" "$w/no.deck"
rejected 'deck is a directory' 3 " *** FILE $w CANNOT BE READ (IS A DIRECTORY)" "$w"
"$kinmat" < "$w" > "$w/out" 2> "$w/err"
equal 'standard input is a directory: status' 3 $?
equal 'standard input is a directory: sentence' ' *** STANDARD INPUT CANNOT BE READ (IS A DIRECTORY)' "$(cat "$w/err")"
"$kinmat" < /dev/null > "$w/out" 2> "$w/err"
equal 'empty deck: status' 1 $?
equal 'empty deck: sentence' ' *** E001  THE DECK IS EMPTY' "$(cat "$w/err")"
# To the superuser every file is readable.
cp "$w/m.deck" "$w/secret.deck" && chmod 000 "$w/secret.deck"
if [ -r "$w/secret.deck" ]; then
   echo 'skipped: unreadable deck (the superuser reads it)'
else
   ends 'unreadable deck' 3 "$w/secret.deck"
   equal 'unreadable deck: sentence' " *** FILE $w/secret.deck CANNOT BE OPENED" "$(sed 's/ (.*//' "$w/err")"
fi
chmod 600 "$w/secret.deck"

# A deck with an error: nothing is computed, no file is touched.
sed 's/^LINK    CRANK.*/LINK    CRANK                   O.0/' "$w/m.deck" > "$w/bad.deck"
echo kept > "$w/kept"
"$kinmat" "$w/bad.deck" -o "$w/kept" 2> "$w/err"
equal 'deck with an error: status' 1 $?
equal 'deck with an error: told for both sets' 2 "$(grep -c '^ \*\*\* E' "$w/err")"
equal 'deck with an error: the output file is left alone' kept "$(cat "$w/kept")"

# Files that cannot be written. Never a run-time error of the language.
for option in -o --csv --log --svg; do
   for case in '/nonexistent/x:NO SUCH FILE OR DIRECTORY' "$w:IS A DIRECTORY"; do
      rejected "$option $case" 3 " *** FILE ${case%%:*} CANNOT BE OPENED FOR WRITING (${case#*:})" \
         "$w/m.deck" $option "${case%%:*}"
   done
done
full() { equal "$1, disk full: status" 3 "$2"
   equal "$1, disk full: sentence" ' *** WRITING STANDARD OUTPUT FAILED (NO SPACE LEFT ON DEVICE)' "$(cat "$w/err")"; }
if [ -w /dev/full ]; then
   "$kinmat" "$w/m.deck" > /dev/full 2> "$w/err"
   full 'standard output' $?
   "$debug" "$w/m.deck" > /dev/full 2> "$w/err"
   full 'standard output, debug build' $?
   for option in --help --version --ruler '--explain E101'; do
      "$kinmat" $option > /dev/full 2> "$w/err"
      full "$option" $?
   done
fi

"$kinmat" "$w/m.deck" -o /dev/null --csv /dev/null --log /dev/null 2> "$w/err"
equal '/dev/null may serve for all' 0 $?

# What cannot be assembled is marked: 1 + 1 + 1 < 4.
"$kinmat" "$w/open.deck" --csv "$w/open.csv" --log "$w/open.log" > "$w/open.lst" 2> "$w/err"
equal 'no assembly: status' 2 $?
equal 'no assembly: standard error' '' "$(cat "$w/err")"
ends 'no assembly, no listing' 2 "$w/open.deck" --no-listing --csv "$w/o.csv"
same 'no assembly, no listing: the CSV' "$w/open.csv" "$w/o.csv"
equal 'no assembly: each instant is marked' 3 "$(grep -c '^ \*\*\* NO POSITION FOUND$' "$w/open.lst")"
equal 'no assembly: last line' ' END OF SET 1:  INSTANTS SOLVED 0, FLAGGED 3' "$(grep 'END OF SET' "$w/open.lst")"
equal 'no assembly: words for numbers' '        NONE        NONE        NONE' \
   "$(grep -m 1 '^ COUPLER .*NONE' "$w/open.lst" | cut -c 10-45)"
equal 'no assembly: the driven crank' 3 "$(grep -c '^ CRANK       0.000000    0.000000    .*    1.000000' "$w/open.lst")"
equal 'no assembly: NaN or asterisks' '' "$(grep -nEi 'nan|inf|[*]{4}' "$w/open.lst" "$w/open.csv" "$w/open.log")"
equal 'no assembly: csv' '1,0,0.0000000000000000E+000,LINK,COUPLER,,,,,,,,,,NO-POSITION' \
   "$(grep -m 1 COUPLER "$w/open.csv")"
equal 'no assembly: 15 columns' '' "$(awk -F, 'NF != 15' "$w/open.csv")"
equal 'no assembly: protocol' 3 "$(grep -cE ' (SINGULAR|LIMIT|DIVERGED) ' "$w/open.log")"

# The frozen form does not converge from anywhere: the largest eigenvalue of G = I - A^-1 J, of the closed form's two angles,
# is 1.864, 1.864 and 1.862 at the three positions. The crank turns, so that no instant begins at its own position.
one_set 0.1 1.0 2.0 2.5 2.0 CRANK 0.3 -2.0 -2.6 0.3 "$(card METHOD MATRIX)" > "$w/matrix.deck"
"$kinmat" "$w/matrix.deck" --log "$w/matrix.log" > "$w/matrix.lst" 2> "$w/err"
equal 'MATRIX without convergence: status' 2 $?
equal 'MATRIX without convergence: listing' 3 "$(grep -c '^ \*\*\* NO POSITION FOUND$' "$w/matrix.lst")"
equal 'MATRIX without convergence: protocol head' ' SET 1   METHOD MATRIX' "$(head -n 1 "$w/matrix.log")"
equal 'MATRIX without convergence: protocol' 3 "$(grep -cE ' (LIMIT|DIVERGED|SINGULAR) ' "$w/matrix.log")"
sed 's/^METHOD  MATRIX/METHOD  NEWTON/' "$w/matrix.deck" > "$w/newton.deck"
ends 'NEWTON converges there' 0 "$w/newton.deck"
# From a rough position it ran in circles; of the assembly there that eigenvalue is 0.406, and from nearer it converges.
one_set 0.0 1.0 2.0 2.0 2.8 CRANK 0.3 0.5 3.9 0.3 "$(card METHOD MATRIX)" > "$w/deck"
ends 'MATRIX converges from nearer' 0 "$w/deck"

# The two builds, and two linear algebra libraries, print the same bytes.
[ $both = yes ] || echo 'skipped: reference LAPACK against OpenBLAS (not both installed)'
for deck in input/*.deck "$w/m.deck" "$w/open.deck"; do
   "$kinmat" "$deck" > "$w/release.lst" 2> /dev/null
   released=$?
   "$debug" "$deck" > "$w/debug.lst" 2> "$w/err"
   equal "$deck: debug build: status" $released $?
   same "$deck: debug build" "$w/release.lst" "$w/debug.lst"
   equal "$deck: debug build: standard error" '' "$(head -n 4 "$w/err")"
   by_libraries "$deck" "$deck" "$w/release.lst"
done
# A blank unit of angles is the radian, and the listing says so.
sed 's/^UNITS .*/UNITS   MM/' "$w/m.deck" > "$w/units.deck"
equal 'the units of a card without a unit of angles' ' UNITS    MM       RAD      S' "$("$kinmat" "$w/units.deck" | grep -m 1 '^ UNITS' | sed 's/ *$//')"

conclude
