#!/bin/sh
# cylinders.sh COUNT [FIRST SEED]: mechanisms with cylinders made by chance, against the law of cosines.
. tests/counting.sh
oracle=$BUILD/release/cylinders_by_chance
"$oracle" deck "$1" "${2:-1}" > "$w/deck"
"$kinmat" -o "$w/listing" --csv "$w/csv" "$w/deck" 2> "$w/err"
"$oracle" check "$1" "$w/listing" "$w/csv" "${2:-1}"
