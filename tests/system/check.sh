#!/bin/sh
# make check: every deck of input/ is run and its listing compared, byte for byte, with expected/, which closed forms
# have printed; those closed forms are run again, so that expected/ cannot drift from them. Then the scripts below that
# have closed forms of their own and take a second or two.
. tests/counting.sh

for deck in input/*.deck; do
   name=${deck#input/}
   name=${name%.deck}
   "$BUILD/kinmat" "$deck" > "$BUILD/$name.lst" 2> "$BUILD/$name.err"
   status=$?
   equal "$name: exit status" "$(grep -qE ' (FLAGGED|ZAZNACZONE) [1-9]' "expected/$name.lst" && echo 2 || echo 0)" $status
   equal "$name: standard error" '' "$(cat "$BUILD/$name.err")"
   same "$name: listing" "expected/$name.lst" "$BUILD/$name.lst"
   "$BUILD/kinmat" --errors "$deck" > "$BUILD/$name.errors.lst" 2> /dev/null
   same "$name: listing, with --errors" "expected/$name.lst" "$BUILD/$name.errors.lst"
   same "$name: closed form" "expected/$name.lst" "$BUILD/expected/$name.lst"
   equal "$name: NaN, Inf or asterisks, negative zero, lines over 120 columns" '' "$(awk '
      length > 120 || /-0[.]0*( |$)/ || /[*][*][*][*]/ { print; next }
      !/ PATHS / && tolower($0) ~ /(^|[^a-z0-9_])(nan|inf|infinity)([^a-z0-9_]|$)/' "$BUILD/$name.lst")"
done
for listing in expected/*.lst; do
   name=${listing#expected/}
   if [ -e "input/${name%.lst}.deck" ]; then pass; else miss "$listing has no deck"; fi
done

# The paper's own iteration prints the same tables as Newton.
for name in yoke yoke_mirrored crank_slider far_small; do
   sed -e '/^METHOD/d' -e 's/^END.*/METHOD  MATRIX\n&/' "input/$name.deck" > "$BUILD/matrix.deck"
   "$BUILD/kinmat" "$BUILD/matrix.deck" > "$BUILD/matrix.lst"
   equal "$name by METHOD MATRIX: exit status" 0 $?
   grep -vE '^ (METHOD|CONTINUATION:|KONTYNUACJA:)' "$BUILD/matrix.lst" > "$BUILD/matrix.txt"
   grep -vE '^ (METHOD|CONTINUATION:|KONTYNUACJA:)' "expected/$name.lst" > "$BUILD/newton.txt"
   same "$name by METHOD MATRIX" "$BUILD/newton.txt" "$BUILD/matrix.txt"
done

# The tables of what the program did before, which hang in their last digits on the library of linear algebra, are those of the
# reference LAPACK and BLAS.
libraries=$(ldd "$kinmat" | awk '$1 ~ /^lib(lapack|blas)[.]so/ { print $3 }' | xargs readlink -f)
case $libraries in
*/lapack/*/blas/*|*/blas/*/lapack/*) unchanged=unchanged;;
*) echo 'tables of what was before: not compared, since LAPACK and BLAS are not the reference'; unchanged=;;
esac

# The first deck of docs/cards.md: the tip of a crank of length 0.25 at 6.28 rad/s.
awk '/^```deck/ { on = 1; next } /^```/ && on { exit } on' docs/cards.md > "$BUILD/first.deck"
"$BUILD/kinmat" "$BUILD/first.deck" > "$BUILD/first.lst"
equal "docs/cards.md, first deck: exit status" 0 $?
equal "docs/cards.md, first deck: t = 0" \
   ' TIP        0.2500000   0.0000000                0.000000    1.570000               -9.859600    0.000000' \
   "$(grep '^ TIP' "$BUILD/first.lst" | head -n 1)"
equal "docs/cards.md, first deck: instants" 11 "$(grep -c '^ TIP' "$BUILD/first.lst")"
# What `make run` prints: the paper's example at 0 and 1 s, whose rows are rows of the closed form of its whole motion; then where
# that is, and how to see a picture.
"${MAKE:-make}" --no-print-directory -n BUILD="$BUILD" run 2> /dev/null | tail -n 2 | sh > "$w/run.txt"
equal 'make run: exit status' 0 $?
equal 'make run: rows of the whole motion' '10 of 10' "$(grep -E '^ (CRANK|BLOCK|LEVER|ROD|RAM) ' "$w/run.txt" > "$w/rows"
   echo "$(awk '/^ INSTANT/ { at = $2 } / END OF SET/ { exit } at == 0 || at == 2' expected/yoke.lst | grep -cxFf "$w/rows")" of "$(wc -l < "$w/rows" | tr -d ' ')")"
equal 'make run: a screen and a half' yes "$([ "$(wc -l < "$w/run.txt")" -le 66 ] && echo yes)"
equal 'make run: the last line' \
   " THE WHOLE MOTION: $BUILD/kinmat input/yoke.deck   ITS PICTURE: $BUILD/kinmat --no-listing --svg yoke.svg input/yoke.deck" "$(tail -n 1 "$w/run.txt")"
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

# The pictures of the documents are those that the program draws, or drawn by hand.
drawn=$w/drawn
docs/tools/pictures.sh "$kinmat" "$drawn" > "$w/pictures.txt" 2>&1
equal 'pictures: status' 0 $?
for picture in "$drawn"/*.svg; do same "docs/pictures/${picture##*/}" "docs/pictures/${picture##*/}" "$picture"; done
equal 'pictures: those that nobody draws' '' "$(for picture in docs/pictures/*.svg; do
   [ -e "$drawn/${picture##*/}" ] || sed -n 's/^# Drawn by hand: //p' docs/tools/pictures.sh | tr -d ',.' | grep -qw "$(basename "$picture" .svg)" \
      || echo "$picture"
done)"

# What cards ask for, by closed forms and by the cards' own numbers: each script counts its checks, and they count here.
for part in $unchanged ranges circuits drives singular variants wide tables independent methods pictures; do
   BUILD=$BUILD "tests/system/$part.sh" > "$w/$part.txt"
   equal "$part: status" 0 $?
   sed '$d' "$w/$part.txt"
   cat "$BUILD/counts.$part" >> "$counts"
done
conclude
