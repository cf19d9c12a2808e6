#!/bin/sh
# What the program does now is what it did: the work of the solver (work.txt), the sizes of the errors that are told
# (errors.txt), and the answers to cards (answers.txt), of the decks of input/. These tables were printed by the program and
# are no truth: they guard the cost of a run, and what nobody sees in a listing, against changes that nobody means. They hang
# on roundings in part, so they are those of the reference LAPACK and BLAS. Where a change is meant and right, what is found
# here takes the place of the old: cp build/unchanged/work.txt tests/system/work.txt, and so on.
. tests/counting.sh

# left_out TABLE NAME: this deck is not looked at for this table.
left_out() {
   case $1:$2 in
   # Iterations that are those of their roundings, and bounds where equations are redundant.
   ways:dense_first_instant_chaotic|ways:peaucellier|proof:double_parallelogram) ;;
   # Errors of redundant cranks, whose sizes change by more than others.
   errors:parallel_cranks) ;;
   # Answers that take long.
   answers:cognates|answers:dead_point_9|answers:dixon|answers:ten_plates) ;;
   *) return 1;;
   esac
}

# run DECK NAME OPTION...: the log of a run.
run() {
   deck=$1
   log=$w/$2.log
   shift 2
   "$kinmat" --quiet "$@" --log "$log" "$deck" > "$w/run.txt" 2>&1
}

# The work of the solver, by its logs. Each deck is run in two steps as well, which the solver has to divide: with a proof and
# its bounds, by another method, and from estimates that are 70 deg off, by turns to either side.
for name in yoke yoke_mirrored crank_slider far_small; do
   sed -e '/^METHOD/d' -e 's/^END.*/METHOD  MATRIX\n&/' "input/$name.deck" > "$w/matrix.deck"
   run "$w/matrix.deck" "$name.matrix" -o "$w/run.lst"
done
for deck in input/*.deck tests/system/decks/*.deck; do
   name=$(basename "$deck" .deck)
   case $deck in input/*) run "$deck" "$name" --errors -o "$w/run.lst";; esac
   left_out ways "$name" && continue
   awk '/^TIME/ { $0 = "TIME    2       " substr($0, 17) } ! /^METHOD/ { print }' "$deck" > "$w/wide.deck"
   sed 's/^END.*/PROVE\n&/' "$w/wide.deck" > "$w/proof.deck"
   sed 's/^END.*/METHOD  DENSE\n&/' "$w/wide.deck" > "$w/dense.deck"
   awk '/^UNITS/ { off = $0 ~ /RAD/ ? atan2(1, 1)*70/45 : 70 }
      /^LINK/ { off = -off; $0 = sprintf("%-48s%.6f", substr($0, 1, 48), substr($0, 49, 16) + off) }
      { print }' "$w/wide.deck" > "$w/rough.deck"
   for way in proof dense rough; do run "$w/$way.deck" "$name.$way" -o "$w/$name.$way.lst"; done
   ! left_out proof "$name" || rm -f "$w/$name.proof.lst"
done
awk -f tests/system/work.awk "$w"/*.log > "$w/work.txt"
(cd "$w" && awk '
   /^ *(INSTANT|CHWILA)  / { on = 1; next }
   on && /[0-9]/ && ! /[*][*][*]/ { $1 = $1; print FILENAME, $0 }
   / (PARTS|CZESCI) [0-9]/ { on = 0 }' ./*.proof.lst) >> "$w/work.txt"
same 'the work of the solver' tests/system/work.txt "$w/work.txt"

# The errors that are told of all rows, but for a part: their sizes hang on roundings.
for deck in input/*.deck; do
   name=$(basename "$deck" .deck)
   left_out errors "$name" && continue
   sed -e '/^PRINT/d' -e 's/^END.*/PRINT   ALL\n&/' "$deck" > "$w/all.deck"
   "$kinmat" --no-listing --quiet --errors --csv "$w/$name.csv" "$w/all.deck" > "$w/run.txt" 2>&1
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

# What the cards EXTREMES, RANGE and ASSEMBLY make of each deck, by its digest: the listings build/unchanged/*.asked before and
# after a change are to be compared.
for deck in input/*.deck; do
   name=$(basename "$deck" .deck)
   left_out answers "$name" && continue
   grep -vE '^(METHOD|PRINT|EXTREMES|RANGE|ASSEMBLY|CIRCUITS)' "$deck" |
      sed 's/^END.*/PRINT   LINKS           999999\nEXTREMESALL\nRANGE\nASSEMBLY\n&/' > "$w/asked.deck"
   "$kinmat" --quiet "$w/asked.deck" > "$w/$name.asked" 2> "$w/run.txt"
done
(cd "$w" && cksum ./*.asked) > "$w/answers.txt"
same 'answers' tests/system/answers.txt "$w/answers.txt"
conclude
