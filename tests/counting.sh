# To be sourced: counts checks and words what fails. The counts live in a file, since a check may end a pipe. Numbers have
# a point, whatever the user's language. `kinmat` and `debug` are the command in both builds; `w` is an empty
# directory for the files of the test. Their paths begin at the root, for scripts that change their directory.
BUILD=${BUILD:-build}
case $BUILD in /*) ;; *) BUILD=$PWD/$BUILD ;; esac
kinmat=$BUILD/kinmat debug=$BUILD/debug/kinmat
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

# by_libraries NAME DECK LISTING: the deck has this listing with the reference LAPACK and with OpenBLAS, if both are
# there (`both`)
lapack=/usr/lib/x86_64-linux-gnu/lapack:/usr/lib/x86_64-linux-gnu/blas
openblas=/usr/lib/x86_64-linux-gnu/openblas-pthread
both=no
[ -e "${lapack%%:*}/liblapack.so.3" ] && [ -e "${lapack##*:}/libblas.so.3" ] && [ -e $openblas/libopenblas.so.0 ] &&
   both=yes
by_libraries() {
   [ $both = yes ] || return 0
   for library in $lapack $openblas; do
      LD_LIBRARY_PATH=$library "$kinmat" "$2" > "$w/other.out" 2> "$w/other.err"
      same "$1: by ${library##*/}" "$3" "$w/other.out"
   done
}

# card NAME A B C R1 R2 R3: one card of a deck
card() {
   card=$1
   for width in 8 16 24 32 48 64; do
      [ $# -gt 1 ] || break
      shift
      [ -n "$1" ] || continue
      while [ ${#card} -lt $width ]; do card="$card "; done
      card=$card$1
   done
   echo "$card"
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

# ends NAME STATUS ARGUMENT...: the command ends with this status; $w/out and $w/err have what it prints
ends() {
   ended=$1; expected_status=$2
   shift 2
   "$kinmat" "$@" > "$w/out" 2> "$w/err"
   equal "$ended: status" "$expected_status" $?
}

# says NAME STATUS WORDS ARGUMENT...: the command ends with this status, and these words are all of its standard error
says() {
   name=$1; status=$2; words=$3
   shift 3
   ends "$name" "$status" "$@"
   equal "$name: sentence" "$words" "$(cat "$w/err")"
}

# rejected NAME STATUS WORDS ARGUMENT...: as `says`, and the command prints no listing
rejected() {
   says "$@"
   equal "$1: no listing" '' "$(cat "$w/out")"
}

# refused NAME WORDS: the deck on standard input is rejected; WORDS: its first error, with single blanks
refused() {
   cat > "$w/refused.deck"
   ends "$1" 1 "$w/refused.deck"
   equal "$1: words" "$2" "$(sed -n '/^ [*]* E[0-9]/{s/^ [*]* //p;q}' "$w/err" | tr -s ' ')"
}

# still_four_bar CRANK COUPLER ROCKER BASE DRIVEN PHI-CRANK PHI-COUPLER PHI-ROCKER VALUE CARD...: a four-bar at one instant,
# with these cards before END
still_four_bar() {
   card UNITS M DEG S
   card GROUND BASE
   card LINK CRANK '' '' 0.0 0.0 "$6"
   card LINK COUPLER '' '' "$1" 0.0 "$7"
   card LINK ROCKER '' '' "$4" 0.0 "$8"
   card POINT A0 BASE; card POINT B0 BASE '' "$4"
   card POINT C1 CRANK; card POINT C2 CRANK '' "$1"
   card POINT D1 COUPLER; card POINT D2 COUPLER '' "$2"
   card POINT E1 ROCKER; card POINT E2 ROCKER '' "$3"
   card REVOLUTE A0 C1 P1; card REVOLUTE C2 D1 P2; card REVOLUTE D2 E2 P3; card REVOLUTE B0 E1 P4
   card DRIVE ANGLE "$5" '' "$9" 30.0
   card AT '' '' '' 0.0
   shift 9
   printf '%s\n' "$@"
   card END
}

# moving_four_bar AFTER-CRANK AFTER-COUPLER AFTER-ROCKER AFTER-BASE CARD...: lengths 1.0, 3.5, 3.0, 4.0, with cards below them,
# and others before END
moving_four_bar() {
   card UNITS M DEG S; card GROUND BASE; card LINK CRANK
   card LINK COUPLER '' '' 1.0 0.0 55.0; card LINK ROCKER '' '' 4.0 0.0 110.0
   card POINT A0 BASE; card POINT B0 BASE '' 4.0; echo "$4"
   card POINT A0-CR CRANK; card POINT A-CR CRANK '' 1.0; echo "$1"
   card POINT A-CO COUPLER; card POINT B-CO COUPLER '' 3.5; echo "$2"
   card POINT B0-RO ROCKER; card POINT B-RO ROCKER '' 3.0; echo "$3"
   card REVOLUTE A0 A0-CR PAIR-A0; card REVOLUTE A-CR A-CO PAIR-A; card REVOLUTE B-CO B-RO PAIR-B
   card REVOLUTE B0-RO B0 PAIR-B0; card DRIVE ANGLE CRANK '' 0.0 30.0
   shift 4
   printf '%s\n' "$@"
   echo END
}

# tangent OFFSET PHI ALPHA CARD...: a block in a slot of a crank, OFFSET beside its pivot, and on a guide at ALPHA
# through (1, 0); the crank begins at PHI, 10 degrees a second, with these cards before END
tangent() {
   card UNITS M DEG S; card GROUND BASE; card LINK CRANK; card LINK BLOCK '' '' 1.0; card LINK SLIDER '' '' 1.0
   card POINT O BASE; card POINT G BASE '' 1.0; card POINT O1 CRANK; card POINT P CRANK '' 0.0 "$1"; card POINT Q BLOCK
   card POINT S SLIDER; card REVOLUTE O O1 PO; card REVOLUTE Q S PIN; card PRISM P Q SLOT; card PRISM G S GUIDE "$3"
   card DRIVE ANGLE CRANK '' "$2" 10.0
   shift 3
   printf '%s\n' "$@"
   card END
}

# inline_slider PHI-CRANK X-ROD Y-ROD PHI-ROD X-PISTON: the crank-slider of input/ on the x axis, at this estimate,
# without drive and instants
inline_slider() {
   awk '/^END/ { exit } /^(UNITS|GROUND|POINT|REVOLUTE|PRISM)/' input/crank_slider.deck |
      sed '/^POINT   G /s/ 0.5$/ 0.0/'
   card LINK CRANK '' '' 0.0 0.0 "$1"; card LINK ROD '' '' "$2" "$3" "$4"; card LINK PISTON '' '' "$5"
}

# angle A B C: between the sides A and B of a triangle, opposite C, in degrees
angle() { awk -v a="$1" -v b="$2" -v c="$3" 'BEGIN { x = (a*a + b*b - c*c)/(2*a*b)
   printf "%.12f", atan2(sqrt(1 - x*x), x)*45/atan2(1, 1) }'; }
# limit VALUE: ten digits
limit() { awk -v x="$1" 'BEGIN { printf "%#.10g", x }'; }
