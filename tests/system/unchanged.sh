#!/bin/sh
# The work of the solver on the decks of input/ and tests/ is what it was: iterations, each with its factorization, and
# substeps. tests/system/work.txt was printed by the program and is no truth: it guards the cost of a run against changes that
# nobody means. It hangs on roundings in part, so it is that of the reference LAPACK and BLAS. Where a change is meant and
# right, what is found here takes the place of the old: cp build/unchanged/work.txt tests/system/work.txt.
# Answers are compared with those of another commit by make compare-against.
. tests/counting.sh

# run DECK NAME OPTION...: the log of a run.
run() {
   deck=$1
   log=$w/$2.log
   shift 2
   "$kinmat" --quiet "$@" --log "$log" "$deck" > "$w/run.txt" 2>&1
}

# Each deck is run in two steps as well, which the solver has to divide: with a proof, by another method, and from estimates
# that are 70 deg off, by turns to either side. Two decks have iterations that are those of their roundings.
for name in yoke yoke_mirrored crank_slider far_small; do
   sed -e '/^METHOD/d' -e 's/^END.*/METHOD  MATRIX\n&/' "input/$name.deck" > "$w/matrix.deck"
   run "$w/matrix.deck" "$name.matrix" -o "$w/run.lst"
done
for deck in input/*.deck tests/system/decks/*.deck; do
   name=$(basename "$deck" .deck)
   case $deck in input/*) run "$deck" "$name" --errors -o "$w/run.lst";; esac
   case $name in dense_first_instant_chaotic|peaucellier) continue;; esac
   awk '/^TIME/ { $0 = "TIME    2       " substr($0, 17) } ! /^METHOD/ { print }' "$deck" > "$w/wide.deck"
   sed 's/^END.*/PROVE\n&/' "$w/wide.deck" > "$w/proof.deck"
   sed 's/^END.*/METHOD  DENSE\n&/' "$w/wide.deck" > "$w/dense.deck"
   awk '/^UNITS/ { off = $0 ~ /RAD/ ? atan2(1, 1)*70/45 : 70 }
      /^LINK/ { off = -off; $0 = sprintf("%-48s%.6f", substr($0, 1, 48), substr($0, 49, 16) + off) }
      { print }' "$w/wide.deck" > "$w/rough.deck"
   for way in proof dense rough; do run "$w/$way.deck" "$name.$way" -o "$w/run.lst"; done
done
awk -f tests/system/work.awk "$w"/*.log > "$w/work.txt"
same 'the work of the solver' tests/system/work.txt "$w/work.txt"
conclude
