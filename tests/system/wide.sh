#!/bin/sh
# Wide blocks, solved by KLU, at instants whose velocities do not exist: on a change point of another mechanism of the
# same deck, and where the block's own Jacobian has no inverse that could be told from rounding.
. tests/counting.sh

# unfolded: the sentences of a listing, each line of which ends at column 120, in one line
unfolded() { tr '\n' ' ' | sed 's/  \*\*\* / /g'; }

# differing NAME: rows of both.csv that are in NAME.csv too, but with other numbers: by more than 1E-7 where both have
# some, or where a position is in one alone
differing() {
   LC_ALL=C awk -F, 'FNR == NR { if (FNR > 1) alone[$2 "," $5] = $0; next }
      FNR > 1 && ($2 "," $5) in alone { rows++
         split(alone[$2 "," $5], other, ",")
         for (i = 6; i <= 14; i++) {
            if (($i == "" || other[i] == "") && (i > 8 || $i == other[i])) continue
            if ($i == "" || other[i] == "" || ($i - other[i])^2 > 1e-14*(1 + $i^2)) { print; break }
         } }
      END { print rows " rows" }' "$w/$1.csv" "$w/both.csv"
}

# A lattice (one block of 49 unknowns) beside a parallelogram whose ninth instant is on its change point: each as it is
# alone; velocities are asked for where both tell them.
tests/make_deck lattice 5 18 | grep -v '^PRINT\|^END' > "$w/lattice.part"
grep '^TIME' -A 1 "$w/lattice.part" | grep -v '^\*' > "$w/time.part"
grep -v '^TIME' "$w/lattice.part" > "$w/bodies.part"
{ grep -E '^(LINK|POINT|REVOLUTE)' input/parallelogram_at.deck | sed -e 's/ 20[.]0$/ 3.12/' \
     -e '/^LINK    COUPLER/s/1.9             0.7 /-2.0            0.03/'
  printf 'DRIVE   ANGLE   CRANK\n*       3.12588469033979299E+00 1.00000000000000000E+00\n'; } > "$w/parallelogram.part"
printf 'PRINT   LINKS\nEND\n' > "$w/end.part"
cat "$w/bodies.part" "$w/parallelogram.part" "$w/time.part" "$w/end.part" > "$w/both.deck"
cat "$w/bodies.part" "$w/time.part" "$w/end.part" > "$w/lattice.deck"
{ printf 'TITLE   ALONE\nUNITS   M       RAD     S\nGROUND  BASE\n'
  cat "$w/parallelogram.part" "$w/time.part" "$w/end.part"; } > "$w/parallelogram.deck"
for deck in both lattice parallelogram; do
   "$kinmat" "$w/$deck.deck" -o "$w/$deck.lst" --csv "$w/$deck.csv" 2> "$w/$deck.err"
   echo $? >> "$w/$deck.err"
done
equal 'a change point beside a wide block: status' 2 "$(tail -n 1 "$w/both.err")"
equal 'the wide block alone: status' 0 "$(tail -n 1 "$w/lattice.err")"
equal 'the change point is passed' 1 "$(grep -c 'CHANGE POINTS PASSED 1$' "$w/both.lst")"
equal 'the wide block beside the change point' '931 rows' "$(differing lattice)"
equal 'the change point beside the wide block' '57 rows' "$(differing parallelogram)"

# Nets of 49 and of 449 rods, which pass change points: all legs turn as the first one, 1 + t, with the rate 1. Of the larger one
# every tenth instant is printed.
for size in 5 15; do
   tests/make_deck lattice $size 390 | if [ $size = 5 ]; then cat; else sed 's/^PRINT   LINKS .*/PRINT   LINKS           10/'; fi > "$w/net.deck"
   "$kinmat" "$w/net.deck" --errors -o "$w/net.lst" --csv "$w/net.csv" 2> "$w/net.err"
   equal "a net of $size x $size beside a change point: status" 0 $?
   equal "all instants of $size x $size" 1 "$(grep -c '^ END OF SET 1:  INSTANTS SOLVED 391, FLAGGED 0$' "$w/net.lst")"
   # 2 N - 1 legs, at 391 or 40 instants: off by three times what is told of their errors, at most.
   equal "legs of $size x $size" "$(((2*size - 1)*(size == 5 ? 391 : 40)))" "$(awk -F, '
      function off(x, error) { x = x < 0 ? -x : x; return x > 3*error + 1e-14 }
      NR > 1 && $5 ~ /^L[0-9]/ { if ($8 == "" || $11 == "" || off($8 - 1 - $3, $18) || off($11 - 1, $21)) { if (!bad++) print } else n++ }
      END { print n }' "$w/net.csv")"
done

# Up to 100 unknowns are proved (lattice: 49), more are not, and it says so.
sed 's/^END/PROVE\nEND/' "$w/lattice.deck" > "$w/narrow.deck"
tests/make_deck lattice 17 300 | sed 's/^TIME    300 /TIME    1   /; s/^END/PROVE\nEND/' > "$w/net.deck"
equal 'a lattice is proved' '19 / 19' "$("$kinmat" "$w/narrow.deck" 2> "$w/net.err" | sed -n 's/^ INSTANTS PROVED \(.*\),  PARTS.*/\1/p')"
equal 'a net is too wide for a proof' 2 "$("$kinmat" "$w/net.deck" 2> "$w/net.err" | unfolded | grep -o ': NOT PROVED: LINKS [^:]* MORE: BLOCK TOO LARGE, UNKNOWNS 577 ' | grep -c .)"
conclude
