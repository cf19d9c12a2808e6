#!/bin/bash
# make bench-against REF=COMMIT: processor time of whole runs of this program, compared with the program at COMMIT.
# Each scene runs in many steps and in few, on both programs in turn, RUNS times for each of three links, which differ in the
# number of parts that the linker works on (1, 2, 4). The time of a link is that of its fastest run in many steps less that
# in few. NS is the median over the links, for a step or a variant, and RATIO the quotient of both medians. LINKS are the
# times of the links, of this program and of the other: where the linker puts the code decides on up to 15 per cent of a
# short step. INSTR is the ratio of instructions, if valgrind is installed.
# A ratio above LIMIT (1.03) ends it with status 1. About two minutes on two quiet cores, and two for the first links.
BUILD=${BUILD:-build}
REF=${REF:?REF=COMMIT says what to compare with}
RUNS=${RUNS:-7}
LIMIT=${LIMIT:-1.03}
export LC_ALL=C OPENBLAS_NUM_THREADS=1
w=$BUILD/against
. tests/bench/program_at.sh
program_at "$REF" "$w"

# link TREE BUILD NAME: the program of TREE/BUILD linked anew by the command that make has, as NAME.1, NAME.2 and NAME.4.
link() {
   local parts out command program=$2/release/kinmat
   for parts in 1 2 4; do
      out=$(realpath -m "$3.$parts")
      [ "$out" -nt "$1/$2/kinmat" ] && continue
      command=$(cd "$1" && env -u MAKEFLAGS -u MAKELEVEL make BUILD="$2" -n -W "$2/release/libkinmat.a" "$program" |
         grep -e "-o $program ")
      command=${command/lto-partitions=2/lto-partitions=$parts}
      (cd "$1" && eval "${command/-o $program /-o "'"$out"'" }") > /dev/null || exit 3
   done
}
link . "$BUILD" "$w/new"
link "$w/$commit" build "$w/$commit/old"

# with_steps STEPS EVERY DECK: its first set with STEPS steps in its own time, with rows at each EVERY instants.
with_steps() {
   awk -v steps="$1" -v every="$2" '
      /^TIME/ { printf "TIME    %-8d%s\n", steps, substr($0, 17); next }
      /^AT/ || /^PRINT/ { next }
      /^END/ { printf "PRINT   ALL             %-8d\nEND\n", every; exit }
      { print }' "$3"
}

# variants COUNT STEPS CARD: COUNT variants of the four-bar, whose rows alone are printed; they have a further CARD.
variants() {
   with_steps "$2" 1 tests/bench/s1.deck | awk -v count="$1" -v card="$3" '
      /^PRINT/ { if (card != "") print card; next }
      { print }
      /^POINT   R1/ { printf "VARY    R1      %-8d                3.0             3.5\n", count }'
}

# scene NAME N: a deck of so many steps; of sweeps, so many variants; of sets, so many copies of a deck.
scene() {
   case $1 in
   s1|s2) with_steps "$2" "$2" "tests/bench/$1.deck";;
   listing) with_steps "$2" 1 tests/bench/s1.deck;;
   windows) tests/make_deck windows 1000 > "$w/windows"; with_steps "$2" "$2" "$w/windows";;
   sets) awk -v count="$2" '{ text = text $0 "\n" } END { for (i = 0; i < count; i++) printf "%s", text }' input/andrews.deck;;
   sweep_3600) variants "$2" 3600 'EXTREMESPAIRS   J4';;
   sweep_360) variants "$2" 360;;
   *) with_steps "$2" "$2" "input/$1.deck";;
   esac
}

# seconds PROGRAM DECK, instructions PROGRAM DECK: of one run. Other work on the machine is felt least in the processor's time.
TIMEFORMAT=%U
seconds() { { time "$1" --jobs 1 "$2" > /dev/null; } 2>&1; }
instructions() {
   valgrind --tool=cachegrind --cache-sim=no --cachegrind-out-file=/dev/null "$1" --jobs 1 "$2" 2>&1 > /dev/null |
      awk '/I +refs/ { gsub(/,/, ""); print $NF }'
}

# Each scene with the steps, or variants, of a run that is timed, and of one whose instructions are counted.
while read -r name many few; do
   scene "$name" "$many" > "$w/many.deck"
   scene "$name" "$few" > "$w/few.deck"
   for run in $(seq "$RUNS"); do
      for parts in 1 2 4; do
         echo "$name time $((many - few)) $parts $(seconds "$w/new.$parts" "$w/many.deck") $(seconds "$w/new.$parts" "$w/few.deck")" \
            "$(seconds "$w/$commit/old.$parts" "$w/many.deck") $(seconds "$w/$commit/old.$parts" "$w/few.deck")"
      done
   done
   command -v valgrind > /dev/null || continue
   scene "$name" $((2*few)) > "$w/many.deck"
   echo "$name instructions $(instructions "$w/new.2" "$w/many.deck") $(instructions "$w/new.2" "$w/few.deck")" \
      "$(instructions "$w/$commit/old.2" "$w/many.deck") $(instructions "$w/$commit/old.2" "$w/few.deck")"
done > "$w/times.txt" << 'END'
s1          400000   1000
s2          500000   1000
four_bar    300000   1000
yoke        250000   1000
andrews     100000   1000
jansen      100000   1000
windows     510      10
listing     20000    300
sets        1000     20
sweep_3600  320      32
sweep_360   1000     64
END
awk -v limit="$LIMIT" -v ref="$REF" '
   function median(a, b, c) { return a > b ? (b > c ? b : (a > c ? c : a)) : (a > c ? a : (b > c ? c : b)) }
   $2 == "instructions" { counted[$1] = sprintf("%.3f", ($3 - $4)/($5 - $6)); next }
   !($1 in size) { order[++n] = $1; size[$1] = $3 }
   { for (k = 0; k <= 3; k++) if (!(($1, k, $4) in least) || $(5 + k) < least[$1, k, $4]) least[$1, k, $4] = $(5 + k) }
   # Nanoseconds a step in the link of so many parts, of this program (0) or the other (1).
   function ns(name, k, parts) { return 1e9*(least[name, 2*k, parts] - least[name, 2*k + 1, parts])/size[name] }
   END {
      printf " %-12s%12s%12s%8s%8s   %s\n", "SCENE", "NS", "AT " substr(ref, 1, 8), "RATIO", "INSTR", "LINKS"
      for (i = 1; i <= n; i++) {
         name = order[i]
         for (k = 0; k <= 1; k++) {
            time[k] = median(ns(name, k, 1), ns(name, k, 2), ns(name, k, 4))
            links[k] = sprintf("%.0f %.0f %.0f", ns(name, k, 1), ns(name, k, 2), ns(name, k, 4))
         }
         printf " %-12s%12.0f%12.0f%8.3f%8s   %s, %s\n", name, time[0], time[1], time[0]/time[1], counted[name], links[0], links[1]
         if (time[0]/time[1] > limit) slower = 1
      }
      exit slower
   }' "$w/times.txt"
