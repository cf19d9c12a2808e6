#!/bin/sh
# What is printed arrives, or it is said that it does not: closed descriptors, one file under two names, writes that fail,
# signals, broken pipes, decks that cannot be read.
. tests/counting.sh

home=$PWD
cd "$w" || exit 3

cp "$home/input/four_bar.deck" deck
# A run of some minutes, whose listing is long.
sed -e 's/^TIME    36  /TIME    9000000/' deck > long
"$kinmat" deck --csv whole.csv --log whole.log > whole.lst

# told NAME STATUS SENTENCE: the status before, and what is on standard error
told() { equal "$1: status" "$2" "$3"; equal "$1: sentence" "$4" "$(cat err)"; }

# Descriptors that are closed. What is printed goes nowhere else.
"$kinmat" deck >&- 2> err
told 'closed standard output' 3 $? ' *** STANDARD OUTPUT IS CLOSED'
"$debug" deck >&- 2> err
told 'closed standard output, debug build' 3 $? ' *** STANDARD OUTPUT IS CLOSED'
"$kinmat" deck --csv new.csv --log new.log >&- 2> err
told 'closed standard output, with --csv' 3 $? ' *** STANDARD OUTPUT IS CLOSED'
equal 'closed standard output: no file is made' '' "$(ls new.* 2> /dev/null)"
"$kinmat" deck > out 1< deck 2> err
told 'standard output that is open for reading' 3 $? ' *** STANDARD OUTPUT IS CLOSED'
"$kinmat" deck -o out --csv csv --log log >&- 2> err
told 'closed standard output, -o' 0 $? ''
"$kinmat" deck -o out.3 --csv csv.3 --log log.3 <&- >&- 2>&-
equal 'all three closed: status' 0 $?
for name in out out.3; do same "closed: listing $name" whole.lst $name; done
for name in csv csv.3; do same "closed: csv $name" whole.csv $name; done
for name in log log.3; do same "closed: log $name" whole.log $name; done
empty=$("$kinmat" < /dev/null 2>&1)
"$kinmat" <&- > out 2> err
told 'closed standard input' 1 $? "$empty"
"$kinmat" -o out <&- >&- 2> err
told 'closed standard input and output' 1 $? "$empty"
"$kinmat" nothing --csv csv > out 2>&-
equal 'closed standard error: status' 3 $?
equal 'closed standard error: standard output' '' "$(cat out)"
for option in --help --version --ruler; do
   "$kinmat" $option >&- 2> err
   told "$option, closed standard output" 3 $? ' *** STANDARD OUTPUT IS CLOSED'
done

# One file under two names: by its path, by links, under /dev/shm, through standard output. Nothing is made or emptied.
twice=' *** ONE FILE IS NAMED FOR TWO OUTPUTS'
ln -s target link
says 'a file that is not there, two paths' 1 "$twice" deck -o x1 --csv ./x1
says 'a file that is not there, three paths' 1 "$twice" deck --log ../output/x1 --csv "$PWD/x1"
says 'a link to a file that is not there' 1 "$twice" deck -o link --csv target
says 'a file that is not there, and a link to it' 1 "$twice" deck -o target --log link
equal 'refused outputs are not made' '' "$(ls x1 2> /dev/null)"
equal 'what a link led to is empty' '' "$(cat target)"
rm target
equal 'a link to a refused output stays' target "$(readlink link)"
says 'the second output cannot be opened' 3 ' *** FILE /nonexistent/x CANNOT BE OPENED FOR WRITING (NO SUCH FILE OR DIRECTORY)' \
   deck -o x1 --csv /nonexistent/x
equal 'the first output is not made then' '' "$(ls x1 2> /dev/null)"
echo kept > old
"$kinmat" deck -o old --csv /nonexistent/x 2> err
equal 'nor emptied' kept "$(cat old)"
ln old hard
says 'a hard link' 1 "$twice" deck -o old --csv hard
equal 'a hard link: nothing is emptied' kept "$(cat old)"
echo before > both
"$kinmat" deck --csv both >> both 2> err
told 'standard output is the CSV' 1 $? "$twice"
equal 'standard output is the CSV: nothing is emptied' before "$(cat both)"
"$kinmat" deck --csv /dev/stdout > both 2> err
told 'the CSV by the name of standard output' 1 $? "$twice"
"$kinmat" deck --csv /dev/stdout 2> err | cat > both
equal 'a pipe may serve twice' 2 "$(grep -cE '^ END OF SET|^set,step' both | awk '{ print ($1 >= 2) ? 2 : $1 }')"

# kept NAME SENTENCE: the deck is as it was, and that was said
kept() { equal "$1: status" 1 "$status"; equal "$1: sentence" "$2" "$(cat err)"; same "$1: the deck" deck "$3"; }
cp deck own; ln own own.hard; ln -s own own.link
for option in -o --csv --log --svg; do
   for path in own own.hard own.link; do
      "$kinmat" own $option $path > out 2> err; status=$?
      kept "$option $path" ' *** THE DECK own WOULD BE OVERWRITTEN' own
      "$kinmat" $option $path < own > out 2> err; status=$?
      kept "$option $path, deck on standard input" ' *** THE DECK ON STANDARD INPUT WOULD BE OVERWRITTEN' own
   done
done
"$kinmat" own >> own 2> err; status=$?
kept 'standard output is the deck' ' *** THE DECK own WOULD BE OVERWRITTEN' own
"$kinmat" < own >> own.hard 2> err; status=$?
kept 'standard output is the deck on standard input' ' *** THE DECK ON STANDARD INPUT WOULD BE OVERWRITTEN' own
"$kinmat" --study own -o own.hard > out 2> err; status=$?
kept '--study' ' *** THE DECK own WOULD BE OVERWRITTEN' own
"$kinmat" --time own -o own.hard > out 2> err; status=$?
kept '--time' ' *** THE DECK own WOULD BE OVERWRITTEN' own
if memory=$(mktemp /dev/shm/kinmat.XXXXXX 2> /dev/null); then
   cp deck "$memory"
   "$kinmat" "$memory" -o "$memory" > out 2> err; status=$?
   kept 'a deck under /dev/shm' " *** THE DECK $memory WOULD BE OVERWRITTEN" "$memory"
   rm -f "$memory"
fi
equal 'no file is left of all these' '' "$(ls x1 target new.* 2> /dev/null)"

# A write that fails ends the run, in seconds not minutes; the other outputs end with whole lines.
# short NAME COMMAND...: the command, which has 20 s
short() { ran=$1; shift; timeout -k 1 20 env --default-signal=INT,TERM,PIPE "$@" 2> err; }
# whole NAME FILE: ends with the end of a line
whole() { equal "$1: ends with a whole line" '' "$(tail -c 1 "$2")"; }
# columns FILE: lines of the CSV that are none
columns() { equal "$1: whole lines" '' "$(awk -F, 'NF != 15' "$2")"; }
if [ -w /dev/full ]; then
   short 'full' "$kinmat" long > /dev/full
   told 'a full disk' 3 $? ' *** WRITING STANDARD OUTPUT FAILED (NO SPACE LEFT ON DEVICE)'
   for option in --csv --log; do
      short 'full' "$kinmat" long -o out $option /dev/full
      told "a full disk, $option" 3 $? ' *** WRITING /dev/full FAILED (NO SPACE LEFT ON DEVICE)'
      whole "a full disk, $option" out
   done
   short 'full' "$kinmat" long -o /dev/full
   told 'a full disk, -o' 3 $? ' *** WRITING /dev/full FAILED (NO SPACE LEFT ON DEVICE)'
fi
# A limit on the size of files: after so many blocks of 512 bytes.
(ulimit -f 400; exec timeout -k 1 20 "$kinmat" long -o limited --csv limited.csv --errors 2> err)
told 'a file that may not grow' 3 $? ' *** WRITING limited.csv FAILED (FILE TOO LARGE)'
whole 'a file that may not grow: listing' limited
equal 'a file that may not grow: the listing says so' 1 "$(tail -n 1 limited | grep -c '^ \*\*\* THE RUN WAS BROKEN OFF AFTER INSTANT [0-9]*$')"

# A reader that goes: quietly, with the status of a broken pipe; a sentence where a broken pipe is not to end a process.
piped() { { short piped "$kinmat" long "$@"; echo $? > status; } | head -n 1 > out; told_pipe=$(cat status); }
piped
told 'kinmat | head' 141 "$told_pipe" ''
piped --csv pipe.csv
told 'kinmat --csv | head' 141 "$told_pipe" ''
whole 'kinmat --csv | head' pipe.csv
columns 'kinmat --csv | head' pipe.csv
{ (trap '' PIPE; exec timeout -k 1 20 "$kinmat" long 2> err); echo $? > status; } | head -n 1 > out
told 'a broken pipe that is ignored' 3 "$(cat status)" ' *** WRITING STANDARD OUTPUT FAILED (BROKEN PIPE)'

# SIGINT and SIGTERM: whole lines, a line that says so, the signal's status. In both languages.
# stopped SIGNAL DECK: a run that has begun is sent the signal
stopped() {
   rm -f stop.lst
   env --default-signal=INT,TERM "$kinmat" "$2" --jobs 1 -o stop.lst --csv stop.csv --log stop.log --table stop.table 2> err &
   pid=$!
   waited=0
   until [ -s stop.csv ] && [ "$(wc -l < stop.csv)" -gt 10 ] || [ $waited -ge 200 ]; do sleep 0.05; waited=$((waited + 1)); done
   kill -"$1" $pid
   # One that does not end is ended.
   (sleep 20; kill -KILL $pid) > /dev/null 2>&1 &
   killer=$!
   wait $pid
   status=$?
   kill $killer 2> /dev/null
}
{ sed '/^LANG/d' long | awk '{ print } /^TITLE/ && !told { print "LANG    PL"; told = 1 }'; } > polish
rm -f stop[.-]*
release=$kinmat
for one in 'INT 130 long' 'TERM 143 long' 'TERM 143 polish' 'INT 130 polish debug'; do
   set -- $one
   [ -z "$4" ] || kinmat=$debug
   stopped "$1" "$3"
   told "SIG$1, $3" "$2" $status ''
   case $3 in polish) words='OBLICZENIA PRZERWANO PO CHWILI' ;; *) words='THE RUN WAS BROKEN OFF AFTER INSTANT' ;; esac
   last=$(tail -n 1 stop.log | awk '{ print $1 }')
   equal "SIG$1, $3: last lines of the listing" "
 *** $words $last" "$(tail -n 2 stop.lst)"
   equal "SIG$1, $3: the last instant of the CSV" "1,$last" "$(tail -n 1 stop.csv | cut -d, -f1,2)"
   equal "SIG$1, $3: the last row of the table" "$(tail -n 1 stop.csv | cut -d, -f3)" "$(tail -n 1 stop-1.table | cut -d, -f1)"
   equal "SIG$1, $3: rows of the table" '' "$(awk -F, 'NR == 1 { n = NF } NF != n' stop-1.table | head -n 2)"
   for name in stop.lst stop.csv stop.log stop-1.table; do whole "SIG$1, $3: $name" $name; done
   equal "SIG$1, $3: a set that was not reached has no table" '' "$(ls stop-2.table 2> /dev/null)"
   columns "SIG$1, $3" stop.csv
   rm -f stop[.-]*
done
kinmat=$release
# Sixteen variants run together: those that are broken off have no row.
moving_four_bar "$(card VARY R1 16 '' 0.5 1.25)" '' '' '' "$(card TIME 9000000 '' '' 0.0 12.0)" > variants
env --default-signal=INT,TERM "$kinmat" variants --jobs 1 -o stop.lst --summary stop.csv 2> err &
pid=$!
sleep 1
kill -TERM $pid
wait $pid
equal 'SIGTERM, variants: status' 143 $?
equal 'SIGTERM, variants: no row' '' "$(sed 1d stop.csv)"
rm -f stop[.-]*

# A signal that comes anywhere, mostly between two sets: the last line says after which, for each number of processes.
{ card GROUND BASE; card LINK CRANK; card JOINT O BASE CRANK; card DRIVE ANGLE CRANK '' 1.0; card TIME 2 '' '' 0.0 1.0; echo END; } > one.deck
awk -v count=5000 '{ text = text $0 "\n" } END { for (i = 0; i < count; i++) printf "%s", text }' one.deck > sets
# terminated JOBS PAUSE: SIGTERM comes so many seconds after the first text, which is looked for without a rest
terminated() {
   rm -f stop.lst
   env --default-signal=INT,TERM "$kinmat" sets --jobs "$1" -o stop.lst 2> err &
   pid=$!
   waited=0
   until [ -s stop.lst ] || [ $waited -ge 2000000 ]; do waited=$((waited + 1)); done
   sleep "$2"
   kill -TERM $pid
   wait $pid 2> /dev/null
}
for pause in 0 0.02 0.05 0.08; do
   for jobs in 1 2; do
      terminated $jobs $pause
      told "SIGTERM between sets, $jobs processes, $pause s" 143 $? ''
      equal "SIGTERM between sets, $jobs processes, $pause s: the last line" yes "$(tail -n 1 stop.lst | awk -v set="$(grep -c '^ END OF SET' stop.lst)" \
         '/^ [*][*][*] THE RUN WAS BROKEN OFF AFTER SET [0-9]+$/ && $NF == set { print "yes" }
          /^ [*][*][*] THE RUN WAS BROKEN OFF AFTER INSTANT [0-2]$/ { print "yes" }')"
   done
done

# A signal that comes while processes are started: each of them ends by itself.
for k in $(seq 20); do terminated 4 0; cat err; done > started
equal 'SIGTERM while processes are started' '' "$(cat started)"

head -n 12 sets > two
# A line without an end.
long_line=' IS NOT A DECK: LINE 1 HAS MORE THAN 10000000 COLUMNS'
short 'no end' "$kinmat" < /dev/zero > out
told 'a line without an end' 1 $? " *** STANDARD INPUT$long_line"
head -c 10000001 /dev/zero | tr '\0' ' ' > long_line
says 'a line of too many columns' 1 " *** FILE long_line$long_line" long_line
{ head -c 9999900 /dev/zero | tr '\0' ' '; echo; cat two; } > blank_line
says 'a line of many blanks' 0 '' blank_line
printf '$ A COMMENT\rTITLE   LOST\r\n' | cat - two > returns
says 'a carriage return that would hide a card' 1 ' *** FILE returns IS NOT A DECK: LINE 1 HAS A CARRIAGE RETURN INSIDE; END LINES WITH LF OR CR-LF' \
   returns
tr '\n' '\r' < two | "$kinmat" --check > out 2> err
told 'lines that end in CR' 1 $? \
   ' *** STANDARD INPUT IS NOT A DECK: LINE 1 HAS A CARRIAGE RETURN INSIDE; END LINES WITH LF OR CR-LF'
for line in '\r' '\r\n'; do
   printf "$line" | "$kinmat" > out 2> err
   told "a deck of $line alone" 1 $? ' *** E001  THE DECK IS EMPTY'
done

# Memory is short, at several limits: from where one deck of two sets can be read, to where 20,000 of them cannot.
awk '{ deck = deck $0 "\n" } END { for (i = 1; i <= 10000; i++) printf "%s", deck }' two > many
memory=16000
until (ulimit -v $memory; exec "$kinmat" --check two) > out 2> err; do memory=$((memory + 4000)); done
for more in 4000 8000 12000 16000 24000 32000; do
   for jobs in 1 2; do
      (ulimit -v $((memory + more)); exec "$kinmat" --check many --jobs $jobs) > out 2> err
      told "$more kB more than enough for two sets, --jobs $jobs" 3 $? ' *** NOT ENOUGH MEMORY FOR THE DECK'
   done
done
# Memory that ends after the deck is read: a net of many links.
(cd "$home" && tests/make_deck windows 3000 3) > windows
(ulimit -v $((memory + 12000)); exec "$kinmat" windows) > out 2> err
told 'no memory after the deck' 3 $? ' *** NOT ENOUGH MEMORY FOR THE DECK'

# Decks that cannot be read.
says 'a read error' 3 ' *** FILE /proc/self/mem CANNOT BE READ (INPUT/OUTPUT ERROR)' /proc/self/mem
ln -s loop.a loop.b; ln -s loop.b loop.a
says 'links in a loop' 3 ' *** FILE loop.a CANNOT BE OPENED (TOO MANY LEVELS OF SYMBOLIC LINKS)' loop.a
says '-o, links in a loop' 3 ' *** FILE loop.a CANNOT BE OPENED FOR WRITING (TOO MANY LEVELS OF SYMBOLIC LINKS)' \
   deck -o loop.a
says 'a file in the place of a directory' 3 ' *** FILE deck/deck CANNOT BE OPENED (NOT A DIRECTORY)' deck/deck
# A deck that comes in pieces.
{ head -c 100 deck; sleep 0.2; tail -c +101 deck; } | "$kinmat" > out
same 'a deck in pieces' whole.lst out
# The language of the user changes no number and no word (where it is installed).
for language in pl_PL.UTF-8 de_DE.UTF-8; do
   LC_ALL=$language LANGUAGE=${language%%_*} "$kinmat" deck --errors --csv errors.csv > out 2> err
   same "$language: listing" whole.lst out
   cut -d, -f1-15 errors.csv > csv
   same "$language: csv" whole.csv csv
   LC_ALL=$language "$kinmat" nothing > out 2> err
   told "$language: a refusal" 3 $? ' *** FILE nothing CANNOT BE OPENED (NO SUCH FILE OR DIRECTORY)'
done
cd "$home" || exit 3
conclude
