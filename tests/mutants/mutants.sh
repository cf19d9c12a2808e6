#!/bin/sh
# make mutants N=200 SEED=1: N faults, one at a time, in a copy of the sources below BUILD/mutants; which of them do the unit
# tests (debug build) and `make check` (release build, without -flto) see? Lists those that survive. JOBS=2: two at a time;
# FILES='src/deck/cards.f90 ...': faults in these alone.
#
# A mutant is killed by an assertion of a unit test, in the debug build or, where that stops at a run-time trap first, in a
# build without traps; or else by a listing that is not the one of closed forms; or else by the trap, or the time limit, alone.
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
CHECK_TIME=10 CHECK_CLOCK=300
unset MAKEFLAGS MFLAGS MAKELEVEL
place=$(mkdir -p "$BUILD/mutants" && cd "$BUILD/mutants" && pwd) || exit 3
tab=$(printf '\t')
awk=${AWK:-awk}

# build DIRECTORY TARGET...: make in a tree, with nothing optimized across files, since that takes seconds.
build() {
   tree=$1
   shift
   make -s -j1 -C "$tree" BUILD=build FC="${FC:-gfortran}" RELEASE=-O2 "$@" > "$tree/make.log" 2>&1
}

# The same with debug objects that do not stop at faults.
build_plain() {
   tree=$1
   shift
   make -s -j1 -C "$tree" BUILD=plain FC="${FC:-gfortran}" DEBUG='-O0 -finit-real=snan -finit-derived' "$@" > "$tree/make.log" 2>&1
}

# run_until DIRECTORY PATTERN LOG PROCESSOR CLOCK COMMAND...: runs the command there, with limits, until it ends or a line of
# its output begins like PATTERN. Status: 1 where there is such a line, 2 where time was up, 3 after another failure.
run_until() {
   pattern=$2 log=$1/$3
   (cd "$1" && ulimit -t "$4" && ulimit -v 4000000 && ulimit -f 200000 && ulimit -c 0 && clock=$5 && shift 5 &&
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

# unit TREE BUILD: the unit tests of one build; all of them must have been run.
unit() {
   run_until "$1/$2/tests" 'Failure in:' unit.log $UNIT_TIME $UNIT_CLOCK ./unit
   status=$?
   [ $status -ne 0 ] || [ "$(tail -n 1 "$1/$2/tests/unit.log")" = "$(cat "$place/base/unit.count")" ] || status=3
   return $status
}

check() {
   run_until "$1" 'FAILED' build/check.log $CHECK_TIME $CHECK_CLOCK env BUILD=build tests/system/check.sh
   status=$?
   [ $status -ne 0 ] || [ "$(tail -n 1 "$1/build/check.log")" = "$(cat "$place/base/check.count")" ] || status=3
   return $status
}

# The sources and tests as they are now, and their builds, which must pass.
prepare() {
   base=$place/base
   mkdir -p "$base" || return 3
   kept='Makefile README.md docs src tests input expected'
   files=$(find $kept -type f) || return 3
   for file in $files; do
      cmp -s "$file" "$base/$file" || { mkdir -p "$(dirname "$base/$file")"; cp "$file" "$base/$file" || return 3; }
   done
   (cd "$base" && find $kept -type f 2> /dev/null) | while read -r file; do
      [ -f "$file" ] || { rm "$base/$file"; name=${file##*/}; rm -f "$base"/*/*/"${name%.*}".*; }
   done
   mkdir -p "$base/build/expected"
   # expected/ is what closed forms print; that they still do is for `make check` itself.
   cp expected/*.lst "$base/build/expected/" || return 3
   build "$base" build/kinmat build/tests/unit || { tail -n 20 "$base/make.log"; return 3; }
   build_plain "$base" plain/tests/unit || { tail -n 20 "$base/make.log"; return 3; }
   for kind in build plain; do
      (cd "$base/$kind/tests" && ./unit > unit.log 2>&1) || { echo "the unit tests fail without a mutant ($kind)"; return 3; }
   done
   tail -n 1 "$base/build/tests/unit.log" > "$base/unit.count"
   (cd "$base" && BUILD=build tests/system/check.sh > build/check.log 2>&1) || { echo 'make check fails without a mutant'; return 3; }
   tail -n 1 "$base/build/check.log" > "$base/check.count"
}

# relink TREE BUILD KIND: one object of $name has changed. Where no other can see it (its .mod is the same) nothing else is compiled.
relink() {
   tree=$1 kind=$2
   if cmp -s "$tree/$kind/debug/$name.mod" "$place/base/$kind/debug/$name.mod" || [ ! -f "$place/base/$kind/debug/$name.mod" ]; then
      touch -c -r "$tree/$kind/debug/$name.o" "$tree/$kind"/*/*.o
      rm -f "$tree/$kind/debug/libkinmat.a" "$tree/$kind/release/libkinmat.a"
      [ "$kind" = plain ] || build "$tree" build/debug/libkinmat.a build/release/libkinmat.a || return 1
      [ "$kind" = build ] || build_plain "$tree" plain/debug/libkinmat.a || return 1
      touch -c -r "$tree/$kind/debug/libkinmat.a" "$tree/$kind"/tests/*.o
   else
      touch "$tree/altered"
   fi
   rm -f "$tree/$kind/tests/unit"
   if [ "$kind" = plain ]; then build_plain "$tree" plain/tests/unit; else build "$tree" build/tests/unit build/kinmat; fi
}

# verdict TREE: what sees the fault, in `said`.
verdict() {
   tree=$1
   said='does not compile'
   relink "$tree" build || return
   unit "$tree" build
   trapped=$?
   said="assertion: $(sed -n 's/^Failure in: //p' "$tree/build/tests/unit.log" | head -n 1)"
   [ $trapped -eq 1 ] && return
   if [ $trapped -eq 3 ]; then
      trap_text=$(grep -am 1 -E '^(At line|Program received|Fortran runtime|Error)' "$tree/build/tests/unit.log")
      if build_plain "$tree" "plain/debug/$name.o" && relink "$tree" plain && ! unit "$tree" plain; then
         said="assertion: $(sed -n 's/^Failure in: //p' "$tree/plain/tests/unit.log" | head -n 1) (without traps)"
         grep -qa '^Failure in: ' "$tree/plain/tests/unit.log" && return
      fi
   fi
   check "$tree"
   case $? in
      0) ;;
      2) [ $trapped -eq 0 ] && trapped=2;;
      *) said="listing: $(sed -n 's/^FAILED: //p' "$tree/build/check.log" | head -n 1)"; return;;
   esac
   case $trapped in
      0) said=survives;;
      2) said='time';;
      *) said="trap: $trap_text";;
   esac
}

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
      build "$tree" "build/debug/$name.o" "build/release/$name.o" && verdict "$tree"
      case $said in
         'does not compile') printf '%s\n' "$file:$first: {$old} -> {$new}" >> "$place/uncompiled";;
         *) printf '%s\t%s\t%s\t%s\t%s\n' "$said" "$file" "$first" "$old" "$new" >> "$place/result"
            printf '%s\n' "$(grep -c . "$place/result"): $said: $file:$first: {$old} -> {$new}";;
      esac
      if [ -f "$tree/altered" ]; then
         rm -rf "$tree/build" "$tree/plain"
         cp -a "$place/base/build" "$place/base/plain" "$tree/" || exit 3
      else
         for object in build/debug build/release plain/debug; do
            [ ! -f "$place/base/$object/$name.o" ] || cp -p "$place/base/$object/$name.o" "$tree/$object/$name.o"
         done
         touch "$tree/now"
         touch -c -r "$tree/now" "$tree"/build/*/*.o "$tree"/plain/*/*.o
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
trap 'for p in $workers; do kill $p 2> /dev/null; done; exit 3' 1 2 13 15
rm -f "$place/result" "$place/uncompiled"
: > "$place/result"
prepare || exit 3
(cd "$place/base" &&
   $awk -v seed="$SEED" -v wanted="$N" -f tests/mutants/mutate.awk ${FILES:-$(find src -name '*.f90' -o -name '*.F90' | sort)}) |
   sort -n | $awk -v OFS="$tab" -F "$tab" '{ $1 = NR; print }' > "$place/list"
for k in $(seq "$JOBS"); do
   worker "$k" &
   workers="$workers $!"
done
wait
report tests/mutants/equivalent.txt
