#!/bin/sh
# --study on one small deck: what its table must show whatever the clock says, and what the option refuses. Errors are
# those against kinmat-quad, whose own are measured against closed forms by `make quad-check`.
. tests/counting.sh

awk '{ print } /^END/ { exit }' input/four_bar.deck > "$w/four_bar.deck"
mkdir "$w/tmp"
TMPDIR=$w/tmp
export TMPDIR

# not_studied NAME STATUS SENTENCE ARGUMENT...: status and last sentence of a call that prints no table
not_studied() {
   name=$1; status=$2; sentence=$3
   shift 3
   ends "$name" "$status" "$@"
   equal "$name: sentence" "$sentence" "$(tail -n 1 "$w/err")"
   equal "$name: standard output" '' "$(head -n 2 "$w/out")"
}

"$kinmat" --study "$w/four_bar.deck" > "$w/study.txt" 2> "$w/err"
equal 'status' 0 $?
equal 'standard error' '' "$(cat "$w/err")"
equal 'lines over 120 columns' '' "$(awk 'length > 120' "$w/study.txt")"
equal 'asterisks, NaN' '' "$(grep -E '\*\*|NaN|Inf' "$w/study.txt")"

# The rows of the first set: method, predictor, tolerance, time, ratio, iterations, errors of position, velocity, acceleration.
rows() { awk '/^ (NEWTON|DENSE|MATRIX)/ { predictor = substr($0, 10, 7); sub(/ER /, "", predictor)
   print $1, predictor, substr($0, 21, 9), substr($0, 30, 10), substr($0, 60, 8), substr($0, 68, 7), substr($0, 75, 11), substr($0, 86, 11), substr($0, 97, 11) }' "$1"; }
rows "$w/study.txt" > "$w/rows"
equal 'trials made' '7 DENSE OWN,7 MATRIX OWN,1 NEWTON ORD0,1 NEWTON ORD1,1 NEWTON ORD2,1 NEWTON ORD3,7 NEWTON OWN' \
   "$(awk '{ print $1, $2 }' "$w/rows" | sort | uniq -c | awk '{ printf "%s%s", (NR > 1 ? "," : ""), $1 " " $2 " " $3 }')"
equal 'trials without a time' '' "$(awk '!($4 > 0 && $5 > 0)' "$w/rows")"
equal 'what errors are compared with' ' ERRORS: AGAINST kinmat-quad (REAL128), AT 39 OF 39 INSTANTS' "$(sed -n 3p "$w/study.txt")"

# all NAME CONDITION: every row that CONDITION selects does what it says, and there is one at least
all() { equal "$1" 'some, all' "$(awk "$2" "$w/rows")"; }
told='END { print (n ? "some" : "none") (bad ? ", but not " bad : ", all") }'

# A tolerance that is a hundred times smaller leaves no larger error, until rounding, 100 roundings at most, is all that is left.
all 'errors fall with the tolerance' '$2 == "OWN" { if ($1 == m) { n++
   for (k = 7; k <= 9; k++) if ($k > last[k] && $k > 2.2e-14) bad = bad " " $1 $3 }
   m = $1; for (k = 7; k <= 9; k++) last[k] = $k } '"$told"
all 'a large tolerance leaves a large error' '$3 == "1.0E-02" { n++; if (!($8 > 1e-5)) bad = bad " " $1 } '"$told"
all 'to rounding: blocks, all at once and the matrices agree with the truth' \
   '$3 == "ROUNDING" { n++; for (k = 7; k <= 9; k++) if (!($k < 1e-13)) bad = bad " " $0 } '"$told"
# Half a unit of the last place of a coordinate of size 1 at one link of one instant, at least; of a motion with many: more.
all 'no double is nearer than its digits' '{ n++; if (!($7 >= 1e-17 && $8 >= 1e-17)) bad = bad " " $0 } '"$told"
# Linear against quadratic: METHOD MATRIX leaves at least a hundredth of its tolerance, Newton far less in positions.
all 'the matrix leaves of its tolerance what its rate says' '$1 == "MATRIX" && $3 ~ /1.0E-(04|06|08|10|12)/ { n++
   t = $3 + 0; if (!($7 < 5*t && $7 > t/100)) bad = bad " " $0 } '"$told"
all 'a better predictor takes fewer iterations' '$2 ~ /^ORD/ { if ($2 != "ORD0") { n++; if ($6 > last) bad = bad " " $0 } last = $6 } '"$told"
all 'the default is the measure' '$1 == "NEWTON" && $2 == "OWN" && $3 == "ROUNDING" { n++; if ($5 != 1) bad = bad " " $0 } '"$told"

# Ratios have dimensions of their own; a set of ratios and pairs without accelerations.
for one in 'jacobian 4 number' 'boom 4 UNKNOWN'; do
   set -- $one
   "$kinmat" --study "input/$1.deck" > "$w/ratios.txt" 2> "$w/err"
   equal "$1: status" 0 $?
   equal "$1: to rounding the errors of all rows; accelerations" "$2 0 $3" "$(rows "$w/ratios.txt" | awk '$1 == "NEWTON" && $2 ~ /^ORD/ { n++
      for (k = 7; k <= 9; k++) if (!($k < 1e-13 || $k == "UNKNOWN")) bad++ ; word = $9 == "UNKNOWN" ? $9 : "number" } END { print n + 0, bad + 0, word }')"
done

# Rows that are printed at every second instant only: the table of kinmat-quad has all instants.
awk '/^PRINT/ { next } /^END/ { printf "%-8s%-16s%s\n", "PRINT", "ALL", "2" } { print }' "$w/four_bar.deck" > "$w/second.deck"
"$kinmat" --study "$w/second.deck" > "$w/second.txt" 2> "$w/err"
equal 'every second instant: what errors are compared with' ' ERRORS: AGAINST kinmat-quad (REAL128), AT 20 OF 39 INSTANTS' \
   "$(sed -n 3p "$w/second.txt")"
equal 'every second instant: to rounding the methods agree with the truth' '7 0' "$(rows "$w/second.txt" | awk '$3 == "ROUNDING" { n++
   for (k = 7; k <= 9; k++) bad += !($k < 1e-13) } END { print n, bad + 0 }')"

# Errors are relative: in millimetres they are the same where rounding does not count. They are printed with two digits.
awk '/^UNITS/ { sub(/M /, "MM") }
   /^(LINK|POINT)/ { $0 = sprintf("%-32s%-16.1f%-16.1f%s", substr($0, 1, 32), substr($0, 33, 16)*1000, substr($0, 49, 16)*1000, substr($0, 65)) }
   { print }' "$w/four_bar.deck" > "$w/millimetres.deck"
"$kinmat" --study "$w/millimetres.deck" > "$w/millimetres.txt" 2> "$w/err"
rows "$w/millimetres.txt" | paste -d ' ' "$w/rows" - > "$w/both"
equal 'in millimetres: the same errors' '18 0' "$(awk '$1 != "MATRIX" { for (k = 7; k <= 9; k++) if ($k > 1e-12) {
   n++
   bad += !($(k + 9) > 0.9*$k && $(k + 9) < 1.1*$k)
   } } END { print n, bad + 0 }' "$w/both")"

# Beside no reference: the estimates, which are never below the true errors to rounding. MIN is printed with two digits.
mkdir -p "$w/alone" && cp "$BUILD/kinmat" "$w/alone/"
PATH=$w:$PATH "$w/alone/kinmat" --study "$w/four_bar.deck" > "$w/estimates.txt" 2> "$w/err"
equal 'without kinmat-quad: status' 0 $?
equal 'without kinmat-quad: what errors are' ' ERRORS: THE ESTIMATES OF --errors, AT 39 OF 39 INSTANTS; kinmat-quad HAS NO ROWS OF THIS SET (make kinds)' \
   "$(sed -n 3p "$w/estimates.txt")"
rows "$w/estimates.txt" | paste -d ' ' "$w/rows" - > "$w/both"
equal 'without kinmat-quad: no estimate below the error' '7 0' "$(awk '$3 == "ROUNDING" { n++
   for (k = 7; k <= 9; k++) bad += $(k + 9) < 0.99*$k } END { print n, bad + 0 }' "$w/both")"
# Another program of that name is none.
cp "$BUILD/kinmat" "$w/alone/kinmat-quad"
"$w/alone/kinmat" --study "$w/four_bar.deck" 2>&1 | sed -n 3p > "$w/out"
equal 'another program' "$(sed -n 3p "$w/estimates.txt")" "$(cat "$w/out")"

# In single precision and in real128: their own errors, and none.
"$BUILD/kinmat-single" --study "$w/four_bar.deck" > "$w/single.txt" 2> "$w/err"
equal 'kinmat-single' '4 REAL32' "$(rows "$w/single.txt" | awk '$1 == "NEWTON" && $3 == "ROUNDING" { for (k = 7; k <= 9; k++) good += $k > 1e-8 && $k < 1e-5 }
   END { print good/3 - 1 }') $(sed -n '2s/.* //p' "$w/single.txt")"
"$BUILD/kinmat-quad" --study "$w/four_bar.deck" > "$w/quad.txt" 2> "$w/err"
equal 'kinmat-quad' '4 REAL128' "$(rows "$w/quad.txt" | awk '$1 == "NEWTON" && $3 == "ROUNDING" { for (k = 7; k <= 9; k++) good += $k < 1e-28 }
   END { print good/3 - 1 }') $(sed -n '2s/.* //p' "$w/quad.txt")"

# By the debug build with its checks the same, but for the clock.
without_clock() { rows "$1" | awk '{ print $1, $2, $3, $6, ($7 < 1e-12 ? "" : $7) }'; }
without_clock "$w/study.txt" > "$w/wanted"
PATH=$(dirname "$kinmat"):$PATH "$debug" --study "$w/four_bar.deck" > "$w/debug.txt" 2> "$w/err"
equal 'debug build: status' 0 $?
equal 'debug build: standard error' '' "$(head -n 4 "$w/err")"
without_clock "$w/debug.txt" > "$w/out"
same 'debug build: the same errors' "$w/wanted" "$w/out"

# A trial that does not find every position says so: METHOD MATRIX of Andrews' second set.
awk 'on { print } /^END/ { on = 1 }' input/andrews.deck > "$w/andrews.deck"
"$kinmat" --study "$w/andrews.deck" > "$w/andrews.txt" 2> "$w/err"
equal 'Andrews: status' 0 $?
equal 'Andrews: the matrices' 1 "$(grep -c '^ MATRIX .* ROUNDING   NOT SOLVED AT [0-9]* INSTANTS OR MORE$' "$w/andrews.txt")"

# METHOD NEWTON alone: redundant equations, and more equations than the full matrix is for; a set of one instant has no steps.
only_newton() {
   "$kinmat" --study "$2" > "$w/out" 2> "$w/err"
   equal "$1" "0 $3 11 NEWTON" "$? $(sed -n 4p "$w/out") $(rows "$w/out" | awk '{ n[$1]++ } END { for (m in n) print n[m], m }')"
}
awk '{ print } /^END/ { exit }' input/parallel_cranks.deck > "$w/cranks.deck"
only_newton 'redundant equations' "$w/cranks.deck" ' METHODS DENSE AND MATRIX ARE NOT TRIED: EQUATIONS ARE REDUNDANT'
tests/make_deck windows 30 3 > "$w/windows.deck"
only_newton 'many equations' "$w/windows.deck" " METHODS DENSE AND MATRIX ARE NOT TRIED: $((3*$(grep -c '^LINK' "$w/windows.deck"))) EQUATIONS"
awk '/^TIME/ { next } /^AT/ { $0 = sprintf("AT%33s", "0.1") } { print }' "$w/four_bar.deck" > "$w/one.deck"
equal 'one instant' '0  NOT STUDIED: ONE INSTANT' "$("$kinmat" --study "$w/one.deck" > "$w/out" 2>&1; echo "$?" "$(tail -n 1 "$w/out")")"

# What is refused.
only=' *** OPTION --study CAN ONLY BE COMBINED WITH -o AND --quiet'
deck=$w/four_bar.deck
not_studied '--csv' 1 "$only" --study --csv "$w/x.csv" "$deck"
not_studied '--log' 1 "$only" --study --log "$w/x.log" "$deck"
not_studied '--errors' 1 "$only" --study --errors "$deck"
not_studied '--check' 1 "$only" --check --study "$deck"
not_studied '--sets' 1 "$only" --study --sets 1/2 "$deck"
not_studied '--time' 1 "$only" --study --time "$deck"
not_studied '--time and --csv' 1 ' *** OPTION --time CAN ONLY BE COMBINED WITH -o AND --quiet' --time --csv "$w/x.csv" "$deck"
not_studied 'no deck' 1 ' *** OPTION --study NEEDS THE DECK AS A FILE' --study
not_studied 'its own deck' 1 " *** THE DECK $deck WOULD BE OVERWRITTEN" --study -o "$deck" "$deck"
sed 's/^END/EMD/' "$deck" > "$w/bad.deck"
not_studied 'a bad deck' 1 "$("$kinmat" "$w/bad.deck" 2>&1 > "$w/out" | tail -n 1)" --study "$w/bad.deck"
sed '/^DRIVE/d' "$deck" > "$w/loose.deck"
not_studied 'a loose deck' 1 "$("$kinmat" "$w/loose.deck" 2>&1 > "$w/out" | tail -n 1)" --study "$w/loose.deck"
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
equal 'a table to the last instant: compared' ' ERRORS: AGAINST kinmat-quad (REAL128), AT 9 OF 9 INSTANTS' "$(sed -n 3p "$w/table.txt")"
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
conclude
