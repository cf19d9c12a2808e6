#!/bin/sh
# 100000 numbers as they are printed, compared with the formats of the run-time library; counted as one check.
. tests/counting.sh
"$BUILD/release/compare_digits" 100000 > "$BUILD/digits.txt" 2>&1
equal 'digits: as the run-time library prints them' '100000 passed, 0 failed' "$(tail -n 1 "$BUILD/digits.txt")"
conclude
