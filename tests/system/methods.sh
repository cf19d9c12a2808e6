#!/bin/sh
# METHOD DENSE and METHOD MATRIX against METHOD NEWTON: each instant is that of the blocks, turns included, or marked. With
# both linear algebra libraries: the same instants are marked.
. tests/counting.sh

# deck_by METHOD DECK: the deck $w/METHOD.deck, DECK by METHOD
deck_by() { sed -e '/^METHOD/d' -e "s/^END.*/METHOD  $1\n&/" "$2" > "$w/$1.deck"; }
# by METHOD DECK [LIBRARY]: the rows of DECK by METHOD, links alone, in $w/METHOD.csv
by() {
   deck_by "$1" "$2"
   LD_LIBRARY_PATH=$3 "$kinmat" "$w/$1.deck" -o "$w/$1.lst" --csv "$w/$1.all"
   grep ',LINK,' "$w/$1.all" > "$w/$1.csv"
}

# against METHOD: rows of METHOD that differ from NEWTON's by more than 1E-6 of the largest of the set, and are not
# marked; rows that it has, and that NEWTON has; instants of which it has all three links
against() {
   awk -F, '
      function far(a, b, unit) { return a - b > 1e-6*unit || b - a > 1e-6*unit }
      { row = $1 " " $2 " " $5 }
      NR == FNR { for (i = 6; i <= 8; i++) at[row, i] = $i
         for (i = 6; i < 8; i++) { v = $i < 0 ? -$i : $i + 0; if (v > size[$1]) size[$1] = v }
         if ($15 == "") newton++; else lost[row]; next }
      $15 == "" { has++; if (++links[$1, $2] == 3) instants++
         if (!((row, 6) in at) || row in lost || far(at[row, 6], $6, size[$1]) || far(at[row, 7], $7, size[$1]) ||
            far(at[row, 8], $8, 1)) wrong++ }
      END { print wrong + 0, has + 0, newton + 0, instants + 0 }' "$w/NEWTON.csv" "$w/$1.csv"
}

# A limit, and five instants beyond it in the steps of the deck at which another assembly is not far.
by NEWTON tests/system/decks/dense_passes_limit.deck
by DENSE tests/system/decks/dense_passes_limit.deck
equal 'a limit between two instants: rows of another assembly, rows found, rows of NEWTON' '0 41 41' "$(against DENSE | cut -d' ' -f1-3)"
equal 'the limit is told' "$(grep -m 2 LIMIT "$w/NEWTON.lst")" "$(grep -m 2 LIMIT "$w/DENSE.lst")"

# An estimate 3 degrees off, from which Newton's iteration for all equations falls a thousand radians away.
for library in $lapack $openblas; do
   [ -d "${library%%:*}" ] || continue
   by NEWTON tests/system/decks/dense_first_instant_chaotic.deck "$library"
   by DENSE tests/system/decks/dense_first_instant_chaotic.deck "$library"
   set -- $(against DENSE)
   equal "a far iteration, ${library##*/}: rows of another assembly" 0 "$1"
   equal "a far iteration, ${library##*/}: rows as many as NEWTON's" "$3" "$2"
   tr -d '0-9.E+-' < "$w/DENSE.csv" > "$w/marks.${library##*/}"
done
[ -e "$w/marks.blas" ] && [ -e "$w/marks.openblas-pthread" ] \
   && same 'a far iteration: the same instants by both libraries' "$w/marks.blas" "$w/marks.openblas-pthread"

# guide ANGLE SIDE: a crank of 2, its pin's block on a guide that a lever of 4 carries across its end, pivoted 6 away, by the
# closed form to ten decimals: (6 - x) cos r - y sin r + 4 = 0 with (x, y) the pin
guide() {
   LC_ALL=C awk -v a="$1" -v side="$2" 'BEGIN {
      pi = atan2(0, -1); x = 2*cos(a*pi/180); y = 2*sin(a*pi/180); far = sqrt((6 - x)^2 + y^2); c = -4/far
      r = (atan2(-y, 6 - x) + side*atan2(sqrt(1 - c*c), c))*180/pi
      print "UNITS   IN      DEG     S\nGROUND  FRAME\nPOINT   O2      FRAME\nPOINT   O4      FRAME           6.0"
      form = "LINK    %-24s%-16.10f%-16.10f%.10f\n"
      printf form form form, "CRANK", 0, 0, a, "BLOCK", x, y, r + 90, "ROCKER", 6, 0, r
      print "POINT   A0      CRANK\nPOINT   A       CRANK           2.0\nPOINT   A3      BLOCK"
      print "POINT   B0      ROCKER\nPOINT   B       ROCKER          4.0"
      print "REVOLUTEO2      A0      JO2\nREVOLUTEA       A3      JA\nREVOLUTEO4      B0      JO4"
      print "PRISM   B       A3      SLOT    90.0            0.0             90.0"
      printf "DRIVE   ANGLE   CRANK           %-16.10f0.0\nAT                              0.0\nEND\n", a }'
}

# From estimates exact to 1E-10 the iteration of 1987 is repelled at 30 of 70 positions (at 0 is a dead point), and goes to
# the other assembly from 18 of them: it finds the estimated one or says so. METHOD DENSE finds all.
for side in 1 -1; do for angle in $(seq 10 10 350); do guide "$angle" $side; done; done > "$w/deck"
for method in NEWTON DENSE MATRIX; do by $method "$w/deck"; done
equal 'a turning guide: rows of another assembly, rows found, rows of NEWTON by METHOD DENSE, sets' '0 210 210 70' "$(against DENSE)"
set -- $(against MATRIX)
equal 'a turning guide: rows of another assembly by METHOD MATRIX' 0 "$1"
equal 'a turning guide: METHOD MATRIX finds, or says that NEWTON does' 70 "$(($4 + $(grep -c 'METHOD NEWTON FINDS A POSITION' "$w/MATRIX.lst")))"
# On a change point: the crank, which its drive alone moves, has its velocity and acceleration by any method.
for method in NEWTON DENSE; do
   by $method input/parallelogram_at.deck
   equal "on a change point, $method: rates of the crank" 10.00000 \
      "$(awk '/^ INSTANT/ { crank = "" } /^ CRANK / { crank = $7 } /CHANGE POINT, LINKS COUPLER, ROCKER COLLINEAR:/ { print crank; exit }' "$w/$method.lst")"
done
# --errors by METHOD DENSE and by NEWTON estimates the same roundings, also at positions far from those of the deck. Counted: numbers
# whose two estimates differ by more than 30 times (the most is 11, accelerations near zero of drag_link), and whether there are many.
for deck in drag_link whitworth four_bar; do
   for method in NEWTON DENSE; do
      deck_by $method "input/$deck.deck"
      "$kinmat" "$w/$method.deck" --errors --no-listing --csv "$w/told.$method"
   done
   equal "$deck: told errors by METHOD DENSE" '0 many' "$(paste -d, "$w/told.NEWTON" "$w/told.DENSE" | awk -F, '
      NR > 1 { n = NF/2
         for (i = 16; i <= 24; i++) {
            if (($i != "") != ($(i + n) != "")) off++
            if ($i > 0 && $(i + n) > 0) { count++; if ($i > 30*$(i + n) || $(i + n) > 30*$i) off++ } } }
      END { print off + 0, (count > 500 ? "many" : "few") }')"
done

# The paper: each iteration factors and solves the system of all links, the four moving ones of a four-bar with 9 equations, and so
# do the velocities and the accelerations, from the factors of the Jacobian. METHOD MATRIX factors the Jacobian besides.
# METHOD NEWTON solves no such system.
solves=$w/count_solves.so
"${FC:-gfortran}" -shared -fPIC -J"$w" -o "$solves" tests/system/count_solves.f90 || exit 3
for method in NEWTON DENSE MATRIX; do
   deck_by $method input/drag_link.deck
   [ $method = MATRIX ] && deck_by MATRIX input/four_bar.deck
   rm -f "$w/solved"
   touch "$w/solved"
   LD_PRELOAD=$solves SOLVES=$w/solved "$kinmat" "$w/$method.deck" --no-listing --log "$w/log"
   set -- $(awk '$1 ~ /^[0-9]+$/ { instants++; iterations += $4 } END { print instants, iterations }' "$w/log")
   case $method in
   NEWTON) expected='0 0' ;;
   DENSE) expected="$2 $(($2 + 2*$1))" ;;
   MATRIX) expected="$(($1 + $2)) $(($2 + 2*$1))" ;;
   esac
   equal "METHOD $method: systems of 9 equations factored and solved" "$expected" \
      "$(awk '$2 == 9 { n[$1]++ } END { print n["DGETRF"] + 0, n["DGETRS"] + 0 }' "$w/solved")"
   equal "METHOD $method: none is larger" 0 "$(awk '$2 > 9' "$w/solved" | grep -c .)"
done

# A dyad of 1E-7 on a crank of 1, of which all equations at once lose digits: those that are printed are NEWTON's, to a unit
# of the last, and the others are masked.
for method in NEWTON DENSE; do
   by $method tests/system/decks/dense_tiny_dyad.deck
   grep -E '^ (CRANK|TCR|TCO|BLK) .*[0-9]' "$w/$method.lst" > "$w/$method.rows"
done
equal 'a tiny dyad by DENSE: wrong digits, any masked' '0 yes' "$(paste "$w/NEWTON.rows" "$w/DENSE.rows" | LC_ALL=C awk '
   NF == 20 { for (i = 2; i <= 10; i++) {
      if ($i $(i + 10) ~ /[?]/) { masked = "yes"; continue }
      unit = 10^-(length($i) - index($i, "."))
      if ($i - $(i + 10) > 1.5*unit || $(i + 10) - $i > 1.5*unit) wrong++ } }
   END { print wrong + 0, masked }')"

# The log of an instant without a position: no determinant has a sign there.
"$kinmat" tests/system/decks/two_sizes.deck --no-listing --quiet --log "$w/log"
equal 'signs of determinants of instants without a position' 0 "$(awk '$3 == "DIVERGED" { print $7 }' "$w/log" | sort -u)"

conclude
