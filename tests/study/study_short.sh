#!/bin/sh
# --study on one small deck: what its table must show whatever the clock says, and what the option refuses. Errors are
# those against kinmat-quad, whose own are measured against closed forms by `make quad-check`.
. tests/counting.sh

awk '{ print } /^END/ { exit }' input/four_bar.deck > "$w/four_bar.deck"
mkdir "$w/tmp"
TMPDIR=$w/tmp
export TMPDIR

# refused NAME STATUS SENTENCE ARGUMENT...: status and sentence of a call that prints no table
refused() {
   name=$1; status=$2; sentence=$3
   shift 3
   "$kinmat" "$@" > "$w/out" 2> "$w/err"
   equal "$name: status" "$status" $?
   equal "$name: sentence" "$sentence" "$(tail -n 1 "$w/err")"
   equal "$name: standard output" '' "$(head -n 2 "$w/out")"
}

"$kinmat" --study "$w/four_bar.deck" > "$w/study.txt" 2> "$w/err"
equal 'status' 0 $?
equal 'standard error' '' "$(cat "$w/err")"
equal 'lines over 120 columns' '' "$(awk 'length > 120' "$w/study.txt")"
equal 'asterisks, NaN' '' "$(grep -E '\*\*|NaN|Inf' "$w/study.txt")"

# The rows: section, method, order, tolerance, steps, time, ratio, iterations, errors of position, velocity, acceleration.
awk '/^ [1-4]  [A-Z]/ { section = $1 }
   /^ CHEAPEST/ { exit }
   section && /^ (BLOCKS|DENSE|MATRIX)/ {
      method = substr($0, 2, 12); gsub(/ /, "", method)
      print section, method, substr($0, 14, 6), substr($0, 20, 10), substr($0, 30, 6), substr($0, 36, 8), substr($0, 60, 7),
         substr($0, 67, 6), substr($0, 73, 8), substr($0, 89, 8), substr($0, 105, 8)
   }' "$w/study.txt" > "$w/rows"
equal 'trials made' 'BLOCKS BLOCKSQP BLOCKSSP DENSE DENSEQP DENSESP MATRIX MATRIXFIXED' \
   "$(awk '{ print $2 }' "$w/rows" | sort -u | tr '\n' ' ' | sed 's/ $//')"
equal 'tolerances of each method' '10 10 10 10' \
   "$(for m in BLOCKS DENSE MATRIX MATRIXFIXED; do awk -v m=$m '$1 == 1 && $2 == m && $5 == 36' "$w/rows" | wc -l; done | tr -d ' ' | tr '\n' ' ' | sed 's/ $//')"
equal 'trials without a time' '' "$(awk '!($6 > 0 && $7 > 0)' "$w/rows")"

# all NAME CONDITION: every row that CONDITION selects does what it says, and there is one at least
all() { equal "$1" 'some, all' "$(awk "$2" "$w/rows")"; }
told='END { print (n ? "some" : "none") (bad ? ", but not " bad : ", all") }'

# A tolerance that is ten times smaller leaves no larger error, until rounding, 100 roundings at most, is all that is left.
all 'errors fall with the tolerance' '$1 == 1 && $5 == 36 { if ($2 == m) { n++
   for (k = 9; k <= 11; k++) if ($k > last[k] && $k > 2.2e-14) bad = bad " " $2 $4 }
   m = $2; for (k = 9; k <= 11; k++) last[k] = $k } '"$told"
all 'a large tolerance leaves a large error' '$1 == 1 && $5 == 36 && $4 == "1.E-02" { n++; if (!($10 > 1e-5)) bad = bad " " $2 } '"$told"
all 'to rounding: blocks, all at once and the matrices agree with the truth' \
   '$1 < 4 && $4 == "ROUNDING" { n++; for (k = 9; k <= 11; k++) if (!($k < 1e-13)) bad = bad " " $0 } '"$told"
# Half a unit of the last place of a coordinate of size 1 at one link of one instant, at least; of a motion with many: more.
all 'no double is nearer than its digits' '$2 !~ /QP/ { n++; if (!($9 >= 1e-17 && $10 >= 1e-17)) bad = bad " " $0 } '"$told"
all 'single precision' '$2 ~ /SP/ && $4 == "ROUNDING" { n++
   for (k = 9; k <= 11; k++) if (!($k > 1e-8 && $k < 1e-5)) bad = bad " " $0 } '"$told"
all 'real128 is nearer than any double' '$2 ~ /QP/ && $4 == "ROUNDING" { n++
   for (k = 9; k <= 11; k++) { sub(/</, "", $k); if (!($k + 0 < 1e-28)) bad = bad " " $0 } } '"$told"
all 'the matrix leaves more at 1E-2 than at 1E-10' '$1 == 1 && $2 ~ /MATRIX/ && $4 == "1.E-02" { first = $9 }
   $1 == 1 && $2 ~ /MATRIX/ && $4 == "1.E-10" { n++; if (!(first > 1e4*$9)) bad = bad " " $0 } '"$told"
# Linear against quadratic: METHOD MATRIX leaves at least a hundredth of its tolerance, Newton far less in positions.
all 'the matrix leaves of its tolerance what its rate says' '$1 == 1 && $2 ~ /MATRIX/ && $4 ~ /1.E-(04|06|08|10|12)/ { n++
   t = $4 + 0; if (!($9 < t && $9 > t/100)) bad = bad " " $0 } '"$told"
all 'a better start takes fewer iterations' '$1 == 3 && $4 == "ROUNDING" { key = $2 $5
   if ($3 == "OWN" && $2 != "BLOCKS") next
   if ($3 != "0") { n++; if ($8 > last) bad = bad " " $0 } last = $8 } '"$told"
all 'shorter steps take fewer iterations' '$1 == 2 { if ($2 == m) { n++; if ($8 > last) bad = bad " " $0 } m = $2; last = $8 } '"$told"
all 'the default is the measure' '$1 == 4 && $2 == "BLOCKS" { n++; if ($7 != 1) bad = bad " " $0 } '"$told"

# The cheapest trials: below their level, and no cheaper for a smaller error.
awk '/^ CHEAPEST/ { on = 1; last = 0 } /^ ERROR EST/ { on = 0 } on && /^ +1.E/ && !/NONE/ {
   n++; if (!($NF < $1)) print "not below " $0; if ($(NF - 1) < last) print "cheaper " $0; last = $(NF - 1) }
   END { if (n < 7) print "only " n }' "$w/study.txt" > "$w/out"
equal 'the cheapest trials' '' "$(cat "$w/out")"
# The estimates are never below the true errors; MIN is printed with two digits.
awk '/^ ERROR EST/ { on = 1 } on && (/^ +1.E/ || /^ +ROUND/) { n++; for (k = 5; k <= 13; k += 4) if (!($k >= 1)) print $0 }
   END { if (n != 4) print n " rows" }' "$w/study.txt" > "$w/out"
equal 'the estimates of --errors' '' "$(cat "$w/out")"

# By the debug build with its checks the same, but for the clock.
without_clock() { awk '/^ CHEAPEST/ { off = 1 } /^ ERROR EST/ { off = 0 } !off { print substr($0, 1, 35) substr($0, 67) }' "$1"; }
without_clock "$w/study.txt" > "$w/wanted"
PATH=$(dirname "$kinmat"):$PATH "$debug" --study "$w/four_bar.deck" > "$w/debug.txt" 2> "$w/err"
equal 'debug build: status' 0 $?
equal 'debug build: standard error' '' "$(head -n 4 "$w/err")"
without_clock "$w/debug.txt" > "$w/out"
equal 'debug build: the same errors' '' "$(paste -d '\n' "$w/wanted" "$w/out" | grep -v '^ BLOCKS\|^ DENSE\|^ MATRIX\|  ROUND\|  1.E' \
   | awk 'NR%2 { first = $0; next } $0 != first')"

# Where another position is found, or none, the table says so: of Andrews' second set.
awk 'on { print } /^END/ { on = 1 }' input/andrews.deck > "$w/andrews.deck"
"$kinmat" --study "$w/andrews.deck" > "$w/andrews.txt" 2> "$w/err"
equal 'Andrews: status' 0 $?
equal 'Andrews: the matrices at small tolerances' 1 "$(grep -A1 '^ MATRIX  .* ROUNDING' "$w/andrews.txt" | grep -c 'DID NOT CONVERGE' | awk '{ print ($1 > 4) }')"

# What is refused.
only=' *** OPTION --study CAN ONLY BE COMBINED WITH -o AND --quiet'
deck=$w/four_bar.deck
refused '--csv' 1 "$only" --study --csv "$w/x.csv" "$deck"
refused '--log' 1 "$only" --study --log "$w/x.log" "$deck"
refused '--errors' 1 "$only" --study --errors "$deck"
refused '--check' 1 "$only" --check --study "$deck"
refused '--sets' 1 "$only" --study --sets 1/2 "$deck"
refused '--time' 1 "$only" --study --time "$deck"
refused '--time and --csv' 1 ' *** OPTION --time CAN ONLY BE COMBINED WITH -o AND --quiet' --time --csv "$w/x.csv" "$deck"
refused 'no deck' 1 ' *** OPTION --study NEEDS THE DECK AS A FILE' --study
refused 'its own deck' 1 " *** THE DECK $deck WOULD BE OVERWRITTEN" --study -o "$deck" "$deck"
sed 's/^END/EMD/' "$deck" > "$w/bad.deck"
refused 'a bad deck' 1 "$("$kinmat" "$w/bad.deck" 2>&1 > "$w/out" | tail -n 1)" --study "$w/bad.deck"
sed '/^DRIVE/d' "$deck" > "$w/loose.deck"
refused 'a loose deck' 1 "$("$kinmat" "$w/loose.deck" 2>&1 > "$w/out" | tail -n 1)" --study "$w/loose.deck"
kinmat=$BUILD/kinmat-quad refused 'kinmat-quad' 1 ' *** --study IS AVAILABLE ONLY IN kinmat (REAL64), NOT IN THIS BUILD' --study "$deck"
# A decimal with the exponent D is the double in every kind, and no other number; a table that ends at that decimal reaches it.
awk -v t='0.1D0' '/^TIME/ { next } /^AT/ { $0 = sprintf("AT%30s%s", "", t) } { print }' "$deck" > "$w/at_double.deck"
sed 's/0[.]1D0/0.1/' "$w/at_double.deck" > "$w/at_decimal.deck"
instant_of() { "$1" --csv /dev/stdout -o /dev/null "$2" | awk -F, 'NR == 2 { print $3 }'; }
equal '0.1D0 in real128' 1.000000000000000055511151231257827E-0001 "$(instant_of "$BUILD/kinmat-quad" "$w/at_double.deck" | sed 's/\(.\{35\}\)[0-9]*E/\1E/')"
equal '0.1 in real128' 1.000000000000000000000000000000000E-0001 "$(instant_of "$BUILD/kinmat-quad" "$w/at_decimal.deck" | sed 's/\(.\{35\}\)[0-9]*E/\1E/')"
equal '0.1D0 in real64' "$(instant_of "$kinmat" "$w/at_decimal.deck")" "$(instant_of "$kinmat" "$w/at_double.deck")"
cat > "$w/table.deck" << 'END_OF_DECK'
GROUND  BASE
LINK    CRANK
POINT   O       BASE
POINT   C       CRANK
POINT   TIP     CRANK           1.0
REVOLUTEO       C       PIVOT
DRIVE   ANGLE   CRANK
ADD     TABLE                   0.3             0.0
ADD     TABLE                   0.5             1.0
ADD     TABLE                   0.7             3.0
TIME    8                       0.3             0.7
PRINT   POINTS  TIP
END
END_OF_DECK
# Found in PATH, into a file, from a name that a shell would take apart.
cp "$w/table.deck" "$w/it's a deck.deck"
PATH=$(dirname "$kinmat"):$PATH sh -c 'kinmat --study "$1" -o "$2"' sh "$w/it's a deck.deck" "$w/table.txt" > "$w/out" 2> "$w/err"
equal 'a table to the last instant: status' 0 $?
equal 'a table to the last instant: said' '' "$(cat "$w/out" "$w/err")"
equal 'a table to the last instant: compared' ' 8 STEPS, 2 LINKS; THE TRUTH: kinmat-quad (REAL128), 129 OF 129 INSTANTS COMPARED' "$(sed -n 2p "$w/table.txt")"
if [ -c /dev/full ]; then
   "$kinmat" --time "$w/table.deck" > /dev/full 2> "$w/err"
   equal 'disk full: status' 3 $?
fi

# The time of a step, of any kind, from standard input too; a set that has none.
for k in kinmat kinmat-quad kinmat-single; do
   "$BUILD/$k" --time < "$deck" > "$w/times"
   equal "$k --time" '0 2 1 38 yes' "$? $(awk 'END { print NR, $1, $2, ($5 > 0 && $4 >= $5 && $6 >= $4 && $3 >= 1 ? "yes" : $0) }' "$w/times")"
done
"$kinmat" --time "$w/at_decimal.deck" > "$w/times"
equal '--time: one instant' '0     1         0       0.00   NOT TIMED: ONE INSTANT' "$? $(tail -n 1 "$w/times")"
equal 'files left behind' '' "$(ls "$w/tmp")"
mkdir -p "$w/alone" && cp "$BUILD/kinmat" "$w/alone/"
alone=$w/alone/kinmat
kinmat=$alone refused 'alone' 3 ' *** --study NEEDS kinmat-quad BESIDE THIS PROGRAM OR IN PATH: make kinds' --study "$deck"
cp "$BUILD/kinmat" "$w/alone/kinmat-quad"
kinmat=$alone refused 'another program' 3 \
   ' *** kinmat-quad HAS GIVEN NO RESULTS, OR NOT THOSE ASKED FOR (IS IT OF ANOTHER VERSION? make kinds)' --study "$deck"
conclude
