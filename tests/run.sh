#!/bin/sh
# make test: unit tests, the test of their stand-in, make check, and the command as a user calls it, as many parts at a time
# as there are processors. What each prints comes in the order of the list, and the last line adds all of them up.
BUILD=${BUILD:-build}
export BUILD MAKE

# A part a line: its name, how many checks it has at least, so that none passes by looking at nothing, and its command, whose
# last line is "N passed, N failed". Longer ones come first. PARTS: a file of other ones.
parts() {
   if [ -n "$PARTS" ]; then cat "$PARTS"; return; fi
   sed 's/^ *//' <<'END'
   make check|1950|tests/system/check.sh
   relations between runs|220|tests/system/relations.sh --short
   faults by name|561|tests/system/faults.sh
   unit tests|352|"$MAKE" --no-print-directory unit
   units|340|tests/system/units.sh
   cards and options together|1000|tests/system/together.sh
   assemblies and runs|450|tests/system/assembly_relations.sh
   what is printed arrives|255|tests/system/output.sh
   mechanisms of a known motion|42|tests/fuzz/fuzz_mechanisms.sh 30 21
   the library for C and Python|140|tests/system/library.sh
   what is hard to compute|120|tests/oracle/hard.sh short
   real128|124|"$MAKE" --no-print-directory quad-check
   tolerances|49|tests/system/tolerances.sh
   the documents|1300|tests/system/documents.sh
   the method of 1987|1000|"$BUILD/release/matrix_1987" short
   all assemblies|100|tests/system/assemblies.sh
   drawings of other programs|50|tests/system/import.sh
   speed against error|70|"$MAKE" --no-print-directory study-short
   single precision|130|"$MAKE" --no-print-directory single-check
   the command|480|tests/system/command.sh
   extremes|41|tests/system/answers.sh
   extremes of laws|63|tests/fuzz/fuzz_extremes.sh --laws 40 20
   the tool of mutants|8|tests/mutants/self_test.sh
   the sources|60|tests/system/house.sh
   decks made by chance|250|FUZZ_BUILD=debug tests/fuzz/fuzz.sh 250
   the stand-in|75|"$MAKE" --no-print-directory unit-stand-in
   the reader of listings|93|tests/system/reader.sh
   what is installed|22|tests/system/install.sh
   the digits|1|tests/system/digits.sh
   ratios and columns|75|tests/system/ratios.sh
   cylinders by chance|40|tests/oracle/cylinders.sh 40
   results of the methods|97|"$MAKE" --no-print-directory bench-short
   nothing false is proved|2000|"$BUILD/release/fool_proofs" 2000
   circuits by chance|40|"$BUILD/release/circuits_by_chance" 40
   lengths|50|tests/system/lengths.sh
   estimates of errors|57|"$MAKE" --no-print-directory errors
   circuits of twins|20|"$BUILD/release/twins_by_chance" 20 24
   the closed forms|1100|"$BUILD/release/check_forms" input/*.deck
   measures|58|tests/system/measures.sh
   what a drawing needs|55|tests/system/drawn.sh
   what is as drawn|90|tests/system/as_drawn.sh
   dwells by chance|60|"$BUILD/release/dwells_by_chance" 60
   poles and curves|15|tests/system/centres.sh
   proofs|185|"$BUILD/release/proof_bounds" input/*.deck
   slots|10|tests/system/slots.sh
   many sets|7|tests/system/many_sets.sh
   tables become decks|15|tests/system/columns.sh
END
}

# run.sh --list: the parts, for tests/coverage.sh
if [ "$1" = --list ]; then parts; exit 0; fi

w=$BUILD/parts
# run.sh --part K: part K alone
if [ "$1" = --part ]; then
   command=$(parts | sed -n "$2s/^[^|]*|[^|]*|//p")
   sh -c "$command" > "$w/$2.txt" 2>&1
   echo $? > "$w/$2.status"
   exit 0
fi

rm -rf "$w"
mkdir -p "$w" || exit 3
count=$(parts | wc -l)
seq "$count" | xargs -P "$(nproc)" -n 1 sh "$0" --part
passed=0
failed=0
for k in $(seq "$count"); do
   name=$(parts | sed -n "${k}s/|.*//p")
   least=$(parts | sed -n "${k}s/^[^|]*|\([0-9]*\)|.*/\1/p")
   cat "$w/$k.txt"
   last=$(grep -E '^[0-9]+ passed, [0-9]+ failed$' "$w/$k.txt" | tail -n 1)
   if [ -z "$last" ] || [ "$last" = '0 passed, 0 failed' ]; then
      echo "FAILED: $name has looked at nothing"
      failed=$((failed + 1))
      continue
   fi
   set -- $last
   passed=$((passed + $1))
   failed=$((failed + $3))
   if [ $(($1 + $3)) -lt "$least" ]; then
      echo "FAILED: $name has $(($1 + $3)) checks, not $least or more"
      failed=$((failed + 1))
   fi
   if [ "$(cat "$w/$k.status")" -ne 0 ] && [ "$3" -eq 0 ]; then
      echo "FAILED: $name ends with status $(cat "$w/$k.status")"
      failed=$((failed + 1))
   fi
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
