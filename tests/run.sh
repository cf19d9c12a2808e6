#!/bin/sh
# make test: unit tests, the test of their stand-in, make check, and the command as a user calls it, as many parts at a time
# as there are processors. What each prints comes in the order of the list, and the last line adds all of them up.
BUILD=${BUILD:-build}
export BUILD MAKE

# A part a line: its name, and its command, whose last line is "N passed, N failed". Longer ones come first.
parts() {
   sed 's/^ *//' <<'END'
   faults by name|tests/system/faults.sh
   real128|"$MAKE" --no-print-directory quad-check
   single precision|"$MAKE" --no-print-directory single-check
   speed against error|"$MAKE" --no-print-directory study-short
   results of the methods|"$MAKE" --no-print-directory bench-short
   the command|tests/system/command.sh
   what is printed arrives|tests/system/output.sh
   unit tests|"$MAKE" --no-print-directory unit
   the stand-in|"$MAKE" --no-print-directory unit-stand-in
   the sources|tests/system/house.sh
   the closed forms|"$BUILD/release/check_forms" input/*.deck
   make check|tests/system/check.sh
   the documents|tests/system/documents.sh
   estimates of errors|"$MAKE" --no-print-directory errors
   units of length|tests/system/units.sh
   the methods against one another|tests/system/methods.sh
   independent mechanisms|tests/system/independent.sh
   the digits|tests/system/digits.sh
   wide blocks|tests/system/wide.sh
   drives between instants|tests/system/drives.sh
   decks made by chance|FUZZ_BUILD=debug tests/fuzz/fuzz.sh 1000
   mechanisms of a known motion|tests/fuzz/fuzz_mechanisms.sh 200
   the method of 1987|"$BUILD/release/matrix_1987" short
   what is hard to compute|tests/oracle/hard.sh short
END
}

w=$BUILD/parts
# run.sh --part K: part K alone
if [ "$1" = --part ]; then
   command=$(parts | sed -n "$2s/^[^|]*|//p")
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
   if [ "$(cat "$w/$k.status")" -ne 0 ] && [ "$3" -eq 0 ]; then
      echo "FAILED: $name ends with status $(cat "$w/$k.status")"
      failed=$((failed + 1))
   fi
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
