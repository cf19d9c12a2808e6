# To be sourced: counts checks and words what fails. The counts live in a file, since a check may end a pipe. Numbers have
# a point, whatever the user's language. `kinmat` and `debug` are the command in both builds, from whatever directory it is
# called; `w` is an empty directory for the files of the test.
BUILD=${BUILD:-build}
case $BUILD in
/*) kinmat=$BUILD/kinmat debug=$BUILD/debug/kinmat ;;
*) kinmat=$PWD/$BUILD/kinmat debug=$PWD/$BUILD/debug/kinmat ;;
esac
w=$BUILD/$(basename "$0" .sh)
rm -rf "$w" && mkdir -p "$w" || exit 3
LC_ALL=C
# One thread for a BLAS that would take all, with room and time of its own for each.
OPENBLAS_NUM_THREADS=1
export LC_ALL OPENBLAS_NUM_THREADS
counts=$BUILD/counts.$(basename "$0" .sh)
: > "$counts" || exit 3
pass() { echo passed >> "$counts"; }
miss() { echo failed >> "$counts"; echo "FAILED: $*"; }

# same NAME EXPECTED FOUND: the two files hold the same bytes
same() { if diff -u "$2" "$3" > "$counts.diff" 2>&1; then pass; else miss "$1"; head -n 20 "$counts.diff"; fi; }

# equal NAME EXPECTED FOUND: the two texts are the same
equal() { if [ "$2" = "$3" ]; then pass; else miss "$1"; echo "  expected: $2"; echo "  found:    $3"; fi; }

# conclude: the closing line; the status is that of the checks, of which there must be one
conclude() {
   failed=$(grep -c failed "$counts")
   echo "$(grep -c passed "$counts") passed, $failed failed"
   [ "$failed" -eq 0 ] && [ -s "$counts" ]
}

# card NAME A B C R1 R2 R3: one card of a deck
card() {
   card=$(printf '%-8s%-8s%-8s%-8s%-16s%-16s%-16s.' "$1" "$2" "$3" "$4" "$5" "$6" "$7")
   card=${card%.}
   echo "${card%"${card##*[! ]}"}"
}

# with DECK CARD...: the deck of input/ with these cards before each END
with() {
   deck=$1
   shift
   printf '%s\n' "$@" > "$w/cards"
   awk -v cards="$w/cards" '
      /^END/ { while ((getline line < cards) > 0) print line; close(cards) }
      { print }' "input/$deck.deck"
}
