#!/bin/sh
# make quad-check, make single-check: every deck of input/ by a build of that kind of real, its results against the closed
# forms, and from double on its listing against expected/, byte for byte. All links are asked for, at all instants.
. tests/counting.sh

case $KIND in
single) real=REAL32; digits=9 ;;
double) real=REAL64; digits=17 ;;
quad) real=REAL128; digits=36 ;;
esac
equal '--version' "KINMAT 2.0, $real" "$("$BUILD/kinmat" --version)"
equal '--csv: digits' "$digits" "$("$BUILD/kinmat" --csv - input/four_bar.deck | sed -n 2p | cut -d, -f3 | sed 's/E.*//' | tr -dc 0-9 | wc -c | tr -d ' ')"

for deck in $(grep -L '^VARY' input/*.deck); do
   name=$(basename "$deck" .deck)
   awk '/^(PRINT   LINKS|PRINT   RATIOS|COLUMN|TOLER)/ { next }
      /^PRINT   ALL/ { $0 = "PRINT   ALL"; all = 1 }
      /^END/ { if (!all) print "PRINT   LINKS"; all = 0 }
      { print }' "$deck" > "$w/$name.deck"
   "$BUILD/kinmat" --no-listing --csv "$w/$name.csv" "$w/$name.deck" 2> "$w/$name.err"
   status=$?
   # Whether 24 bits tell which way leads on from a change point is a matter of the last bit: of the processor and of LAPACK.
   # Where they do not, instants are marked; the results that there are must be right all the same (kind_errors).
   case "$KIND $name" in 'single '*_across|'single '*_at|'single '*_branch)
      equal "$name: exit status 0 or 2" yes "$(case $status in 0|2) echo yes ;; *) echo "$status" ;; esac)"
      continue
   esac
   # A gap of 1E-6 and less beside 4 is next to none in 24 bits.
   case "$KIND $name" in 'single dead_point'*)
      rm "$w/$name.deck"
      continue
   esac
   equal "$name: exit status" "$(grep -qE ' (FLAGGED|ZAZNACZONE) [1-9]' "expected/$name.lst" && echo 2 || echo 0)" "$status"
   # Digits that 53 bits leave open are known to 113.
   case $name in dead_point_*) continue ;; esac
   # Sensitivities have no masks: near the dead points of this brace differences leave a thousandth open in 24 bits.
   case "$KIND $name" in 'single landing_gear') continue ;; esac
   "$BUILD/kinmat" "$deck" > "$BUILD/$name.lst"
   # Those that 24 bits leave open are masked.
   if [ "$KIND" = single ]; then
      awk -f tests/system/shown_digits.awk "expected/$name.lst" "$BUILD/$name.lst" > "$w/$name.txt"
      equal "$name: the digits shown" '' "$(sed '$d' "$w/$name.txt" | head -n 5)"
      tail -n 1 "$w/$name.txt" >> "$w/compared"
      continue
   fi
   same "$name: listing" "expected/$name.lst" "$BUILD/$name.lst"
done
[ "$KIND" = single ] && equal 'numbers compared, in thousands' yes \
   "$(awk '{ n += $1 } END { print (n > 80000 ? "yes" : n) }' "$w/compared")"
# The other methods come to the same.
for name in four_bar crank_slider; do
   for method in DENSE MATRIX; do
      deck=$w/$name.$method.deck
      awk -v method=$method '/^METHOD/ { next } /^END/ { print "METHOD  " method } { print }' "$w/$name.deck" > "$deck"
      "$BUILD/kinmat" --no-listing --csv "${deck%deck}csv" "$deck"
      equal "$name, METHOD $method: exit status" 0 $?
   done
done
"$BUILD/release/kind_errors" "$w"/*.deck > "$BUILD/kind_errors.txt"
cat "$BUILD/kind_errors.txt"
equal 'results against the closed forms' ', 0 failed' "$(sed -n '$s/.* passed//p' "$BUILD/kind_errors.txt")"
conclude
