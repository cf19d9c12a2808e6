#!/bin/sh
# make check: every deck of input/ is run and its listing compared, byte for byte, with expected/, which closed forms
# have printed; those closed forms are run again, so that expected/ cannot drift from them.
BUILD=${BUILD:-build}
. tests/counting.sh

for deck in input/*.deck; do
   name=$(basename "$deck" .deck)
   "$BUILD/kinmat" "$deck" > "$BUILD/$name.lst" 2> "$BUILD/$name.err"
   equal "$name: exit status" 0 $?
   equal "$name: standard error" '' "$(cat "$BUILD/$name.err")"
   same "$name: listing" "expected/$name.lst" "$BUILD/$name.lst"
   same "$name: closed form" "expected/$name.lst" "$BUILD/expected/$name.lst"
   equal "$name: NaN, Inf or asterisks" '' "$(grep -nEiw 'nan|inf|infinity|[*]{4,}' "$BUILD/$name.lst")"
   equal "$name: negative zero" '' "$(grep -nE -e '-0[.]0*( |$)' "$BUILD/$name.lst")"
   equal "$name: lines over 120 columns" '' "$(awk 'length > 120' "$BUILD/$name.lst")"
done
for listing in expected/*.lst; do
   equal "$listing: its deck" "$(ls "input/$(basename "$listing" .lst).deck" 2> /dev/null)" \
      "input/$(basename "$listing" .lst).deck"
done
conclude
