#!/bin/sh
# make test: unit tests, the test of their stand-in, make check, and the command as a user calls it. The last line
# adds all of them up.
BUILD=${BUILD:-build}
passed=0
failed=0

# part NAME COMMAND...: runs one part and adds its closing line "N passed, N failed" to the sums
part() {
   name=$1
   shift
   "$@" > "$BUILD/part.txt" 2>&1
   status=$?
   cat "$BUILD/part.txt"
   last=$(grep -E '^[0-9]+ passed, [0-9]+ failed$' "$BUILD/part.txt" | tail -n 1)
   if [ -z "$last" ]; then
      echo "FAILED: $name gives no count"
      failed=$((failed + 1))
      return
   fi
   if [ "$last" = '0 passed, 0 failed' ]; then
      echo "FAILED: $name has looked at nothing"
      failed=$((failed + 1))
      return
   fi
   set -- $last
   passed=$((passed + $1))
   failed=$((failed + $3))
   if [ "$status" -ne 0 ] && [ "$3" -eq 0 ]; then
      echo "FAILED: $name ends with status $status"
      failed=$((failed + 1))
   fi
}

part 'unit tests' "$MAKE" --no-print-directory unit
part 'the stand-in' "$MAKE" --no-print-directory unit-stand-in
part 'the house' tests/house.sh
part 'the closed forms' "$BUILD/release/check_forms" input/*.deck
part 'make check' tests/check.sh
part 'the documents' tests/documents.sh
part 'estimates of errors' "$MAKE" --no-print-directory errors
part 'the command' tests/command.sh
part 'what is printed arrives' tests/output.sh
part 'real128' "$MAKE" --no-print-directory quad-check
part 'single precision' "$MAKE" --no-print-directory single-check
part 'units of length' tests/units.sh
part 'faults by name' tests/faults.sh
part 'the methods against one another' tests/methods.sh
part 'independent mechanisms' tests/independent.sh
part 'the digits' tests/digits.sh
part 'wide blocks' tests/wide.sh
part 'drives between instants' tests/drives.sh
part 'decks made by chance' tests/fuzz.sh 1000
part 'the method of 1987' "$BUILD/release/matrix_1987" short
part 'what is hard to compute' tests/hard.sh short
part 'speed against error' "$MAKE" --no-print-directory study-short
part 'results of the methods' "$MAKE" --no-print-directory bench-short
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
