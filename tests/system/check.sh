#!/bin/sh
# make check: every deck of input/ is run and its listing compared, byte for byte, with expected/, which closed forms
# have printed; those closed forms are run again, so that expected/ cannot drift from them. Then the scripts below that
# have closed forms of their own and take a second or two.
. tests/counting.sh

for deck in input/*.deck; do
   name=$(basename "$deck" .deck)
   "$BUILD/kinmat" "$deck" > "$BUILD/$name.lst" 2> "$BUILD/$name.err"
   status=$?
   equal "$name: exit status" "$(grep -qE ' (FLAGGED|ZAZNACZONE) [1-9]' "expected/$name.lst" && echo 2 || echo 0)" $status
   equal "$name: standard error" '' "$(cat "$BUILD/$name.err")"
   same "$name: listing" "expected/$name.lst" "$BUILD/$name.lst"
   "$BUILD/kinmat" --errors --log "$w/$name.log" "$deck" > "$BUILD/$name.errors.lst" 2> /dev/null
   same "$name: listing, with --errors" "expected/$name.lst" "$BUILD/$name.errors.lst"
   same "$name: closed form" "expected/$name.lst" "$BUILD/expected/$name.lst"
   equal "$name: NaN, Inf or asterisks" '' "$(grep -nEiw 'nan|inf|infinity|[*]{4,}' "$BUILD/$name.lst" | grep -v ' PATHS ')"
   equal "$name: negative zero" '' "$(grep -nE -e '-0[.]0*( |$)' "$BUILD/$name.lst")"
   equal "$name: lines over 120 columns" '' "$(awk 'length > 120' "$BUILD/$name.lst")"
done
for listing in expected/*.lst; do
   equal "$listing: its deck" "$(ls "input/$(basename "$listing" .lst).deck" 2> /dev/null)" \
      "input/$(basename "$listing" .lst).deck"
done

# The paper's own iteration prints the same tables as Newton.
for name in yoke yoke_mirrored crank_slider far_small; do
   sed -e '/^METHOD/d' -e 's/^END.*/METHOD  MATRIX\n&/' "input/$name.deck" > "$BUILD/matrix.deck"
   "$BUILD/kinmat" --log "$w/$name.matrix.log" "$BUILD/matrix.deck" > "$BUILD/matrix.lst"
   equal "$name by METHOD MATRIX: exit status" 0 $?
   grep -vE '^ (METHOD|BRANCH:|GALAZ:)' "$BUILD/matrix.lst" > "$BUILD/matrix.txt"
   grep -vE '^ (METHOD|BRANCH:|GALAZ:)' "expected/$name.lst" > "$BUILD/newton.txt"
   same "$name by METHOD MATRIX" "$BUILD/newton.txt" "$BUILD/matrix.txt"
done

# What the solver does for each deck, by its logs, is what it did: tests/system/work.txt. This is no truth: it guards the cost
# of a run, and what nobody sees in a listing, against changes that nobody means. Where a change is meant and right, what is
# found here takes the place of the old: cp build/check/work.txt tests/system/work.txt. Each deck is run in two steps as well,
# which the solver has to divide: with a proof and its bounds, by another method, and from estimates that are 70 deg off, by
# turns to either side; but for two decks whose iterations are those of their roundings.
for deck in input/*.deck tests/system/decks/*.deck; do
   name=$(basename "$deck" .deck)
   case $name in dense_first_instant_chaotic|peaucellier) continue;; esac
   awk '/^TIME/ { $0 = "TIME    2       " substr($0, 17) } ! /^METHOD/ { print }' "$deck" > "$w/wide.deck"
   sed 's/^END.*/PROVE\n&/' "$w/wide.deck" > "$w/proof.deck"
   sed 's/^END.*/METHOD  DENSE\n&/' "$w/wide.deck" > "$w/dense.deck"
   awk '/^UNITS/ { off = $0 ~ /RAD/ ? atan2(1, 1)*70/45 : 70 }
      /^LINK/ { off = -off; $0 = sprintf("%-48s%.6f", substr($0, 1, 48), substr($0, 49, 16) + off) }
      { print }' "$w/wide.deck" > "$w/rough.deck"
   for way in proof dense rough; do
      "$BUILD/kinmat" --quiet -o "$w/$name.$way.lst" --log "$w/$name.$way.log" "$w/$way.deck" > "$w/way.txt" 2>&1
   done
done
awk -f tests/system/work.awk "$w"/*.log > "$w/work.txt"
# Bounds where equations are redundant hang on roundings, and so on the library of linear algebra.
rm -f "$w/double_parallelogram.proof.lst"
(cd "$w" && awk '
   /^ *(INSTANT|CHWILA)  / { on = 1; next }
   on && /[0-9]/ && ! /[*][*][*]/ { $1 = $1; print FILENAME, $0 }
   / (PARTS|CZESCI) [0-9]/ { on = 0 }' ./*.proof.lst) >> "$w/work.txt"
same 'the work of the solver' tests/system/work.txt "$w/work.txt"

# So are the errors that are told of all rows, but for a part: their sizes hang on roundings; those of redundant cranks do so
# by more. A change that is meant: cp build/check/errors.txt tests/system/errors.txt.
for deck in input/*.deck; do
   [ "$deck" != input/parallel_cranks.deck ] || continue
   sed -e '/^PRINT/d' -e 's/^END.*/PRINT   ALL\n&/' "$deck" > "$w/all.deck"
   "$BUILD/kinmat" --no-listing --quiet --errors --csv "$w/$(basename "$deck" .deck).csv" "$w/all.deck" > "$w/way.txt" 2>&1
done
awk -F, -f tests/system/error_sizes.awk "$w"/*.csv > "$w/errors.txt"
equal 'sizes of errors: see tests/system/errors.txt' '' "$(awk '
   FNR == NR { old[$1, $2] = $0; next }
   {
      is_same = split(old[$1, $2], before) == NF && $3 == before[3]
      for (i = 4; i <= NF; i++) if ($i > 1.5*before[i] || before[i] > 1.5*$i) is_same = 0
      if (!is_same) print
      delete old[$1, $2]
   }
   END { for (k in old) print "missing: " old[k] }' tests/system/errors.txt "$w/errors.txt")"

# And what the cards EXTREMES, RANGE and ASSEMBLY make of each deck, by its digest: tests/system/answers.txt, which is renewed
# as work.txt is, once the listings build/check/*.asked before and after a change were compared. Four that take long are left
# out.
for deck in input/*.deck; do
   name=$(basename "$deck" .deck)
   case $name in cognates|dead_point_9|dixon|ten_plates) continue;; esac
   grep -vE '^(METHOD|PRINT|EXTREMES|RANGE|ASSEMBLY|CIRCUITS)' "$deck" |
      sed 's/^END.*/PRINT   LINKS           999999\nEXTREMESALL\nRANGE\nASSEMBLY\n&/' > "$w/asked.deck"
   "$BUILD/kinmat" --quiet "$w/asked.deck" > "$w/$name.asked" 2> "$w/way.txt"
done
(cd "$w" && cksum ./*.asked) > "$w/answers.txt"
same 'answers' tests/system/answers.txt "$w/answers.txt"

# The manual's first deck: the tip of a crank of length 0.25 at 6.28 rad/s.
sed -n '/^GROUND  BASE/,/^END/p' docs/manual.md > "$BUILD/first.deck"
"$BUILD/kinmat" "$BUILD/first.deck" > "$BUILD/first.lst"
equal "the manual, first deck: exit status" 0 $?
equal "the manual, first deck: t = 0" \
   ' TIP        0.2500000   0.0000000                0.000000    1.570000               -9.859600    0.000000' \
   "$(grep '^ TIP' "$BUILD/first.lst" | head -n 1)"
equal "the manual, first deck: instants" 11 "$(grep -c '^ TIP' "$BUILD/first.lst")"
# Other programs' results: every number agrees to its precision, except six in which ADAMS is off by so many half units of
# its last digit. There the closed forms agree with this program.
compare() {
   "$BUILD/kinmat" --csv "$BUILD/$1.csv" "input/$1.deck" > /dev/null
   awk -f tests/validation/compare.awk "tests/validation/$1.csv" "$BUILD/$1.csv" > "$BUILD/$1.txt"
   equal "$1, $2: numbers compared, and those that are off" "$3" "$(sed '$d' "$BUILD/$1.txt")"
   equal "$1: the numbers in docs/evidence.md" 1 "$(grep -c "^| $2 | $1 | ${3%% *} |" docs/evidence.md)"
   echo "$1, $2: $(tail -n 1 "$BUILD/$1.txt") of the precision"
}
compare ten_plates 'MSC ADAMS' '816 numbers
C10 ay at 0.3: -8.679552e-02 is off by 2.48
C10 vx at 1.4: 6.693253e-03 is off by 26
C10 ay at 1.4: 5.435094e-01 is off by 1.12
C8 vphi at 1.4: 3.994449e-01 is off by 1.18
K.C8 ay at 1.4: 9.597453e-01 is off by 2.33
K.C8 x at 4.3: 7.798329e-01 is off by 1.02'
compare teaching_four_bar 'MATLAB R2024a' '1071 numbers'
compare watt_i 'MATLAB R2024a' '1650 numbers'
sed 's/8.295521e-01/8.295523e-01/' tests/validation/ten_plates.csv > "$BUILD/ten_plates.wrong"
equal 'one wrong digit is seen' 'C10 x at 0: 8.295523e-01 is off by 3.88' \
   "$(awk -f tests/validation/compare.awk "$BUILD/ten_plates.wrong" "$BUILD/ten_plates.csv" | grep '^C10 x')"

# The pictures of the documents are those that the program draws.
docs/pictures.sh "$kinmat" "$w" > "$w/pictures.txt" 2>&1
equal 'pictures: status' 0 $?
for picture in docs/pictures/*.svg; do same "$picture" "$picture" "$w/${picture##*/}"; done

# What cards ask for, by closed forms and by the cards' own numbers: each script counts its checks, and they count here.
for part in ranges circuits drives singular variants wide tables independent methods pictures; do
   BUILD=$BUILD "tests/system/$part.sh" > "$w/$part.txt"
   equal "$part: status" 0 $?
   sed '$d' "$w/$part.txt"
   cat "$BUILD/counts.$part" >> "$counts"
done
conclude
