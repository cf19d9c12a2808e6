#!/bin/sh
# make mutants N=200 SEED=1: puts N faults, one at a time, into a copy of the sources below BUILD/mutants, and lists those that
# survive the unit tests and the `parts` below. JOBS=2: two at a time; FILES='src/deck/cards.f90 ...': only faults in these
# files; ONLY=file: only its changes, a line each, as in equivalent.txt below; PARTS: a file of other parts.
#
# A mutant is built without traps and without optimization, which takes a second. It is killed by an assertion of a unit test;
# or else by a check of a part; or else by the unit tests of a build that stops at run-time traps, or by the time limit.
# tests/mutants/equivalent.txt names changes that change nothing, a line each: file|old text|new text|why.
N=${N:-200}
SEED=${SEED:-1}
JOBS=${JOBS:-1}
BUILD=${BUILD:-build}
LC_ALL=C
OPENBLAS_NUM_THREADS=1
export LC_ALL OPENBLAS_NUM_THREADS
# Seconds of processor time of one process, and seconds by the clock: many times what the tests take.
UNIT_TIME=${UNIT_TIME:-60} UNIT_CLOCK=${UNIT_CLOCK:-900}
CHECK_TIME=${CHECK_TIME:-10} CHECK_CLOCK=${CHECK_CLOCK:-300}
# Parts of `make test` that run only the command, the shortest first.
parts() {
   if [ -n "$PARTS" ]; then cat "$PARTS"; return; fi
   sed 's/^ *//' <<'END'
   tests/system/slots.sh
   tests/system/many_sets.sh
   tests/system/centres.sh
   tests/system/measures.sh
   tests/system/as_drawn.sh
   tests/system/drawn.sh
   tests/system/lengths.sh
   tests/oracle/cylinders.sh 40
   tests/system/ratios.sh
   tests/system/answers.sh
   tests/system/assemblies.sh
   tests/system/command.sh
   tests/system/output.sh
   tests/system/together.sh
   tests/system/tolerances.sh
   tests/study/study_short.sh
   tests/system/units.sh
   tests/system/faults.sh
   tests/system/check.sh
END
}
# What the parts need in addition to the command.
tools='kinmat-quad kinmat-single release/print_expected release/cylinders_by_chance release/fuzz_mechanisms release/lengths_by_chance release/random_blocks'
unset MAKEFLAGS MFLAGS MAKELEVEL
place=$(mkdir -p "$BUILD/mutants" && cd "$BUILD/mutants" && pwd) || exit 3
tab=$(printf '\t')
awk=${AWK:-awk}

# build TREE KIND TARGET...: make in a tree. Kind `plain`: whatever nobody has set is NaN, or a whole number that is too large;
# kind `traps`: the debug build.
build() {
   tree=$1 kind=$2
   shift 2
   set -- "$@" BUILD="$kind" FC="${FC:-gfortran}"
   [ "$kind" = traps ] || set -- "$@" DEBUG='-O0 -finit-real=snan -finit-integer=99991 -finit-derived'
   make -s -j1 -C "$tree" "$@" > "$tree/make.log" 2>&1
}

# run_until DIRECTORY PATTERN LOG PROCESSOR CLOCK COMMAND...: runs the command there, with limits, until it ends or a line of
# its output begins like PATTERN. Status: 1 where there is such a line, 2 where time was up, 3 after another failure.
run_until() {
   pattern=$2 log=$1/$3
   (cd "$1" && ulimit -t "$4" && ulimit -v 4000000 && ulimit -f 500000 && ulimit -c 0 && clock=$5 && shift 5 &&
      exec timeout -k 5 "$clock" "$@") > "$log" 2>&1 < /dev/null &
   running=$!
   while kill -0 $running 2> /dev/null; do
      sleep 0.2
      if grep -qa "^$pattern" "$log"; then kill $running 2> /dev/null; break; fi
   done
   wait $running 2> /dev/null
   status=$?
   running=
   grep -qa "^$pattern" "$log" && return 1
   case $status in
      0) return 0;;
      124|137|152) return 2;;
      *) return 3;;
   esac
}

# unit TREE KIND: the unit tests, which all must have been run.
unit() {
   run_until "$1/$2/tests" 'Failure in:' unit.log $UNIT_TIME $UNIT_CLOCK ./unit
   status=$?
   [ $status -ne 0 ] || has_ended "$1" "$2/tests/unit.log" || status=3
   return $status
}

# part TREE K: the part in line K of the list, which must have made all of its checks.
part() {
   run_until "$1" 'FAILED' "plain/$2.log" $CHECK_TIME $CHECK_CLOCK env -u N -u SEED BUILD=plain $(parts | sed -n "$2p")
   status=$?
   [ $status -ne 0 ] || has_ended "$1" "plain/$2.log" || status=3
   return $status
}

# has_ended TREE LOG: the last line is that of the sources without a mutant.
has_ended() { [ "$(tail -n 1 "$1/$2")" = "$(tail -n 1 "$place/base/$2")" ]; }

# The sources and tests as they are now, and their builds, which must pass; those that have passed already need not again.
prepare() {
   base=$place/base
   mkdir -p "$base" || return 3
   kept='Makefile README.md docs src tests input expected'
   files=$(find $kept -type f) || return 3
   for file in $files; do
      cmp -s "$file" "$base/$file" || { rm -f "$base/passed"; mkdir -p "$(dirname "$base/$file")"; cp "$file" "$base/$file" || return 3; }
   done
   (cd "$base" && find $kept -type f 2> /dev/null) | while read -r file; do
      [ -f "$file" ] || { rm -f "$base/passed" "$base/$file"; name=${file##*/}; rm -f "$base"/*/*/"${name%.*}".*; }
   done
   [ "$(cat "$base/passed" 2> /dev/null)" != "$(parts)" ] || return 0
   mkdir -p "$base/plain/expected"
   # expected/ is what closed forms print; that they still do is for `make check` itself.
   mkdir -p "$base/plain/release"
   cp expected/*.lst "$base/plain/expected/" || return 3
   for tool in $tools; do
      [ ! -f "$BUILD/$tool" ] || cp -p "$BUILD/$tool" "$base/plain/$tool" || return 3
   done
   for kind in plain traps; do
      build "$base" $kind $kind/tests/unit || { tail -n 20 "$base/make.log"; return 3; }
      unit "$base" $kind || { echo "the unit tests fail without a mutant ($kind)"; return 3; }
   done
   build "$base" plain plain/debug/kinmat || { tail -n 20 "$base/make.log"; return 3; }
   cp "$base/plain/debug/kinmat" "$base/plain/kinmat"
   for k in $(seq "$(parts | wc -l)"); do
      part "$base" "$k" || { echo "$(parts | sed -n "${k}p") fails without a mutant"; cat "$base/plain/$k.log"; return 3; }
   done
   parts > "$base/passed"
}

# relink TREE KIND TARGET...: the object of $name has changed. Where no other can see it (its .mod is the same) nothing else is compiled.
relink() {
   tree=$1 objects=$1/$2/debug
   if cmp -s "$objects/$name.mod" "$place/base/$2/debug/$name.mod" || [ ! -f "$place/base/$2/debug/$name.mod" ]; then
      touch -c -r "$objects/$name.o" "$tree/$2"/*/*.o
      rm -f "$objects/libkinmat.a"
      build "$tree" "$2" "$2/debug/libkinmat.a" || return 1
      touch -c -r "$objects/libkinmat.a" "$tree/$2"/tests/*.o
   else
      touch "$tree/altered"
   fi
   rm -f "$tree/$2/tests/unit" "$objects/kinmat"
   shift
   build "$tree" "$@"
}

# verdict TREE: what sees the fault, in `said`.
verdict() {
   tree=$1
   said='does not compile'
   relink "$tree" plain plain/tests/unit || return
   unit "$tree" plain
   stopped=$?
   [ $stopped -ne 1 ] || { said="assertion: $(first_failure "$tree/plain")"; return; }

   build "$tree" plain plain/debug/kinmat || return
   cp "$tree/plain/debug/kinmat" "$tree/plain/kinmat"
   for k in $(seq "$(parts | wc -l)"); do
      part "$tree" "$k"
      case $? in
         0) ;;
         2) [ $stopped -ne 0 ] || stopped=2; break;;
         *) said="listing: $(parts | sed -n "${k}p"): $(sed -n 's/^FAILED: //p' "$tree/plain/$k.log" | head -n 1)"; return;;
      esac
   done

   kind=plain
   if [ $stopped -eq 0 ]; then
      kind=traps
      build "$tree" traps "traps/debug/$name.o" && relink "$tree" traps traps/tests/unit || return
      unit "$tree" traps
      stopped=$?
   fi
   case $stopped in
      0) said=survives;;
      1) said="assertion: $(first_failure "$tree/traps")";;
      2) said='time';;
      *) said="trap: $(grep -am 1 -E '^(At line|Program received|Fortran runtime|Error)' "$tree/$kind/tests/unit.log")";;
   esac
}

first_failure() { sed -n 's/^Failure in: //p' "$1/tests/unit.log" | head -n 1; }

# worker K: every JOBS-th mutant of the list, until N are counted by all.
worker() {
   trap '[ -z "$running" ] || kill $running; exit 3' 1 2 13 15
   tree=$place/$1
   rm -rf "$tree"
   cp -a "$place/base" "$tree" || exit 3
   $awk -v k="$1" -v jobs="$JOBS" 'NR % jobs == k % jobs' "$place/list" > "$tree/list"
   export TMPDIR="$tree/tmp"
   mkdir -p "$TMPDIR"
   while IFS=$tab read -r number file first last old new; do
      [ "$(grep -c . "$place/result")" -ge "$N" ] && break
      name=${file##*/} name=${name%.*}
      # The text of the list has lost its indentation.
      $awk -v first="$first" -v last="$last" -v number="$number" '
         NR == FNR { if (!found) { n = split($0, f, "\t"); if (f[1] == number) { found = 1; new = n > 5 ? f[6] : "" } } next }
         FNR == first { print new; next } FNR > first && FNR <= last { print ""; next } { print }' \
         "$tree/list" "$place/base/$file" > "$tree/mutant" && cp "$tree/mutant" "$tree/$file" || exit 3
      rm -f "$tree/altered"
      said='does not compile'
      build "$tree" plain "plain/debug/$name.o" && verdict "$tree"
      case $said in
         'does not compile') printf '%s\n' "$file:$first: {$old} -> {$new}" >> "$place/uncompiled";;
         *) printf '%s\t%s\t%s\t%s\t%s\n' "$said" "$file" "$first" "$old" "$new" >> "$place/result"
            printf '%s\n' "$(grep -c . "$place/result"): $said: $file:$first: {$old} -> {$new}";;
      esac
      if [ -f "$tree/altered" ]; then
         rm -rf "$tree/plain" "$tree/traps"
         cp -a "$place/base/plain" "$place/base/traps" "$tree/" || exit 3
      else
         for kind in plain traps; do
            [ ! -f "$place/base/$kind/debug/$name.o" ] || cp -p "$place/base/$kind/debug/$name.o" "$tree/$kind/debug/$name.o"
         done
         touch "$tree/now"
         touch -c -r "$tree/now" "$tree"/plain/*/*.o "$tree"/traps/*/*.o
      fi
      cp -p "$place/base/$file" "$tree/$file" || exit 3
   done < "$tree/list"
}

report() {
   head -n "$N" "$place/result" | $awk -F "$tab" -v known="$1" '
      BEGIN { while ((getline s < known) > 0) { split(s, f, "|"); if (s !~ /^#/) why[f[1] "|" f[2] "|" f[3]] = f[4] } }
      { n++; kind = $1; sub(/:.*/, "", kind); count[kind]++ }
      kind == "survives" {
         key = $2 "|" $4 "|" $5
         printf "SURVIVES %s:%d\n   old: %s\n   new: %s\n", $2, $3, $4, $5
         if (key in why) { equivalent++; print "   equivalent: " why[key] }
      }
      END {
         printf "Killed by time: %d, counted as traps. Equivalent survivors: %d.\n", count["time"], equivalent
         printf "%d mutants: %d killed (%d by unit tests\047 assertions, %d by run-time traps alone, %d by listings alone), %d survive\n",
            n, n - count["survives"], count["assertion"], count["trap"] + count["time"], count["listing"], count["survives"]
      }'
}

running=
workers=
[ -z "$ONLY" ] || ONLY=$(cd "$(dirname "$ONLY")" && pwd)/$(basename "$ONLY")
trap 'for p in $workers; do kill $p 2> /dev/null; done; exit 3' 1 2 13 15
rm -f "$place/result" "$place/uncompiled"
: > "$place/result"
prepare || exit 3
(cd "$place/base" &&
   $awk -v seed="$SEED" -v wanted="$N" -v all="$ONLY" -f tests/mutants/mutate.awk ${FILES:-$(find src -name '*.f90' -o -name '*.F90' -o -name '*.inc' | sort)}) |
   $awk -F "$tab" -v only="$ONLY" '
      BEGIN { if (only != "") while ((getline s < only) > 0) { split(s, f, "|"); asked[f[1] "|" f[2] "|" f[3]] = 1 } }
      only == "" || ($2 "|" $5 "|" $6) in asked' |
   sort -n | $awk -v OFS="$tab" -F "$tab" '{ $1 = NR; print }' > "$place/list"
for k in $(seq "$JOBS"); do
   worker "$k" &
   workers="$workers $!"
done
wait
report tests/mutants/equivalent.txt
