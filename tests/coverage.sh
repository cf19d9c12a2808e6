#!/bin/sh
# make coverage: how many lines of each file of src/ the tests run, by gcov: the unit tests, and all parts that call the command
# or the library. Files below 90 per cent come first. BUILD: the directory of the builds; each is compiled again, without
# optimization. Processes that end by _exit or by a signal write their counts, too (coverage_counts.c).
cover=$BUILD/coverage
: "${MAKE:=make}"
tests/run.sh --list | grep -vE '^(real128|single precision|results of the methods|what is installed|the stand-in|the sources|the closed forms|the documents|estimates of errors|proofs|nothing false|the digits|the method of 1987|what is hard|the tool of mutants)' \
   | sed 's|"$MAKE" --no-print-directory study-short|tests/study/study_short.sh|' \
   > "$BUILD/coverage.parts"
mkdir -p "$cover" && "${CC:-gcc}" -O1 -fPIC -c -o "$cover/coverage_counts.o" tests/coverage_counts.c || exit 3
"$MAKE" --no-print-directory BUILD="$cover" COVERAGE=--coverage RELEASE='-O0 -fPIC' DEBUG=-O0 \
   LIBS="$cover/coverage_counts.o -lklu -llapack -lblas" "$cover/libkinmat.so.2" "$cover/kinmat" "$cover/debug/kinmat" "$cover/debug/fuzz" "$cover/tests/unit" \
   "$cover/release/read_listing" $(for name in circuits_by_chance twins_by_chance dwells_by_chance lengths_by_chance cylinders_by_chance random_blocks fuzz_mechanisms extremes_by_chance print_expected; do echo "$cover/release/$name"; done) || exit 3
find "$cover" -name '*.gcda' -exec rm {} +
# The other kinds serve as they are.
for kind in quad single; do
   [ -x "$BUILD/kinmat-$kind" ] && ln -sf "$(cd "$BUILD" && pwd)/kinmat-$kind" "$cover/kinmat-$kind"
done
# A process that cannot write its counts says nothing of it: tests compare messages.
export GCOV_ERROR_FILE=/dev/null
mkdir -p "$cover/expected" && cp expected/*.lst "$cover/expected"
PARTS=$BUILD/coverage.parts BUILD=$cover tests/run.sh > "$BUILD/coverage.log" 2>&1
tail -n 1 "$BUILD/coverage.log"
# A line is run if one of the builds runs it.
for build in release debug; do
   find "$cover/$build" -name '*.gcno' | xargs -r gcov -t 2> "$BUILD/coverage.err"
done | awk -F: '
   $3 == "Source" || $2 + 0 == 0 { if ($3 == "Source") { file = $4; ours = file ~ /^src\// } next }
   # The end of a module is counted as a line if its types are copied.
   !ours || $1 ~ /-[ ]*$/ || $3 ~ /^ *end module / { next }
   { line = file SUBSEP ($2 + 0); if (!(line in seen)) { seen[line] = 1; lines[file]++ }
     if ($1 !~ /[#=]/ && !(line in run)) { run[line] = 1; runs[file]++ } }
   END {
      for (file in lines) { printf "%5.1f %6d %s\n", 100*runs[file]/lines[file], lines[file], file; all += lines[file]; total += runs[file] }
      printf "%5.1f %6d %s\n", all ? 100*total/all : 0, all, "all" }' | sort -n | awk '
   BEGIN { print " per cent  lines  file" }
   $3 == "all" { last = $0; next }
   { print "    " $0 }
   END { print "    " last }'
