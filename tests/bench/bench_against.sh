#!/bin/bash
# make bench-against REF=COMMIT: the time of whole runs of this program over that of the program at COMMIT, on the same decks,
# the two in turn, in processor time. A run solves many steps and prints almost nothing. The least of RUNS runs each; RATIO is
# theirs, and beside it the median of the ratios of each turn. A ratio above LIMIT (1.03) ends it with status 1.
BUILD=${BUILD:-build}
REF=${REF:?REF=COMMIT says what to compare with}
RUNS=${RUNS:-15}
LIMIT=${LIMIT:-1.03}
LC_ALL=C
OPENBLAS_NUM_THREADS=1
export LC_ALL OPENBLAS_NUM_THREADS
w=$BUILD/against
. tests/bench/program_at.sh
program_at "$REF" "$w"
old=$at
new=$BUILD/kinmat

# many STEPS DECK: its first set with STEPS steps in its own time, of which the first and the last are printed
many() {
   awk -v steps="$1" '
      /^TIME/ { printf "TIME    %-8d%s\n", steps, substr($0, 17); next }
      /^AT/ || /^PRINT/ { next }
      /^END/ { printf "PRINT   ALL             %-8d\nEND\n", steps; exit }
      { print }' "$2"
}
# The processor's time of one run in seconds: of other work on the machine it feels the least.
TIMEFORMAT=%U
seconds() { { time "$@" > /dev/null; } 2>&1; }

tests/make_deck windows 1000 > "$w/windows_1000.deck" || exit 3
for scene in 'four_bar 300000' 'yoke 250000' 'andrews 100000' 'jansen 100000' 'windows_1000 300'; do
   set -- $scene
   deck=input/$1.deck
   [ -e "$deck" ] || deck=$w/$1.deck
   many "$2" "$deck" > "$w/many.deck"
   for run in $(seq "$RUNS"); do
      echo "$1 $2 $(seconds "$new" "$w/many.deck") $(seconds "$old" "$w/many.deck")"
   done
done > "$w/times.txt"
awk -v limit="$LIMIT" -v ref="$REF" '
   { if (!($1 in count)) { order[++n] = $1; new[$1] = $3; old[$1] = $4 }
     steps[$1] = $2; ratio[$1, ++count[$1]] = $3/$4
     if ($3 < new[$1]) new[$1] = $3
     if ($4 < old[$1]) old[$1] = $4 }
   function median(name,  i, k, m, x, list) {
      m = count[name]
      for (i = 1; i <= m; i++) list[i] = ratio[name, i]
      for (i = 2; i <= m; i++) { x = list[i]; for (k = i - 1; k >= 1 && list[k] > x; k--) list[k + 1] = list[k]; list[k + 1] = x }
      return (list[int((m + 1)/2)] + list[int((m + 2)/2)])/2
   }
   END {
      printf " %-16s%12s%12s%10s%10s\n", "SCENE", "NS A STEP", "AT " substr(ref, 1, 8), "RATIO", "MEDIAN"
      for (i = 1; i <= n; i++) {
         name = order[i]
         printf " %-16s%12.0f%12.0f%10.3f%10.3f\n", name, 1e9*new[name]/steps[name], 1e9*old[name]/steps[name], new[name]/old[name], median(name)
         if (new[name]/old[name] > limit) slower = 1
      }
      exit slower
   }' "$w/times.txt"
