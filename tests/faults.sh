#!/bin/sh
# Wrong decks and wrong mechanisms: what is said of them, by name. Whole decks through the command; the numbers in the
# words are closed forms. Every deck runs in both builds and with both linear algebra libraries: the same bytes.
BUILD=${BUILD:-build}
. tests/counting.sh

case $BUILD in
/*) home=$BUILD ;;
*) home=$PWD/$BUILD ;;
esac
kinmat=$home/kinmat
debug=$home/debug/kinmat
w=$BUILD/faults
rm -rf "$w" && mkdir -p "$w" || exit 3
lapack=/usr/lib/x86_64-linux-gnu/lapack:/usr/lib/x86_64-linux-gnu/blas
openblas=/usr/lib/x86_64-linux-gnu/openblas-pthread
both=no
[ -e "${lapack%%:*}/liblapack.so.3" ] && [ -e "${lapack##*:}/libblas.so.3" ] && [ -e $openblas/libopenblas.so.0 ] && both=yes

# card NAME A B C R1 R2 R3: one card of a deck
card() { printf '%-8s%-8s%-8s%-8s%-16s%-16s%-16s\n' "$1" "$2" "$3" "$4" "$5" "$6" "$7" | sed 's/ *$//'; }

# link NAME X Y PHI, point NAME LINK XI ETA, joint POINT POINT NAME, drive KIND SUBJECT SECOND VALUE RATE ACCELERATION
link() { card LINK "$1" '' '' "$2" "$3" "$4"; }
point() { card POINT "$1" "$2" '' "${3:-0.0}" "${4:-0.0}"; }
joint() { card REVOLUTE "$1" "$2" "$3"; }
drive() { card DRIVE "$@"; }
head_of() { card TITLE "$1"; card UNITS "${2:-M}" "${3:-DEG}" S; card GROUND BASE '' '' 0.0 0.0 0.0; }
# until N T: N steps from 0 to T, and the end of the set
until_time() { card TIME "$1" '' '' 0.0 "$2"; card END; }

# four_bar MARK X CRANK COUPLER ROCKER BASE PHI-CRANK PHI-COUPLER PHI-ROCKER: its names end in MARK, it begins at X
four_bar() {
   far=$(awk "BEGIN { printf \"%.6f\", $2 + $6 }")
   link "CRANK$1" "$2" 0.0 "$7"; link "COUPL$1" "$2" 0.0 "$8"; link "ROCK$1" "$far" 0.0 "$9"
   point "A0$1" BASE "$2"; point "B0$1" BASE "$far"
   point "A1$1" "CRANK$1"; point "A2$1" "CRANK$1" "$3"
   point "C1$1" "COUPL$1"; point "C2$1" "COUPL$1" "$4"
   point "R1$1" "ROCK$1"; point "R2$1" "ROCK$1" "$5"
   joint "A0$1" "A1$1" "PA0$1"; joint "A2$1" "C1$1" "PA$1"; joint "C2$1" "R2$1" "PB$1"; joint "R1$1" "B0$1" "PB0$1"
}

# slider CRANK ROD PHI OFFSET: crank, rod and a piston on the line y = OFFSET
slider() {
   link CRANK 0.0 0.0 "$3"; link ROD 0.0 0.0 -10.0; link PISTON "$2" "$4" 0.0
   point O BASE; point G BASE 0.0 "$4"; point O1 CRANK; point A1 CRANK "$1"; point A2 ROD; point B2 ROD "$2"; point B PISTON
   joint O O1 PAIR-O; joint A1 A2 PAIR-A; joint B2 B PAIR-B
   card PRISM G B GUIDE 0.0 0.0 0.0
}

# three_cranks EXCESS PHI: a parallelogram with a third crank, off its line and longer than the others by EXCESS
three_cranks() {
   link CRANK-1 0.0 0.0 "$2"; link CRANK-2 4.0 0.0 "$2"; link CRANK-3 2.0 1.0 "$2"; link COUPLER 1.5 0.3 0.0
   point A0 BASE; point B0 BASE 4.0; point C0 BASE 2.0 1.0
   point A1 CRANK-1; point A2 CRANK-1 1.5; point B1 CRANK-2; point B2 CRANK-2 1.5; point C1 CRANK-3
   card POINT C2 CRANK-3 '' "$(awk "BEGIN { printf \"%.14f\", 1.5 + $1 }")"
   point A COUPLER; point B COUPLER 4.0; point C COUPLER 2.0 1.0
   joint A0 A1 PAIR-A0; joint B0 B1 PAIR-B0; joint C0 C1 PAIR-C0; joint A2 A PAIR-A; joint B2 B PAIR-B; joint C2 C PAIR-C
}

# said LISTING: the remarks, each after the number of its instant
said() { awk '/^ (INSTANT|CHWILA) / { k = $2 } /^ (\*\*\*|---) / { print k ":" $0 } /^ (LARGEST|NAJW)/' "$1"; }

# told NAME STATUS WORDS: the deck in $w/deck, its status and all that is said of it
told() {
   "$kinmat" "$w/deck" > "$w/out" 2> "$w/err"
   equal "$1: status" "$2" $?
   equal "$1: words" "$3" "$(cat "$w/err"; said "$w/out")"
   equal "$1: NaN, Inf or asterisks" '' "$(grep -nEiw 'nan|inf|infinity|[*]{4,}' "$w/out")"
   "$debug" "$w/deck" > "$w/debug.out" 2> "$w/debug.err"
   same "$1: debug build" "$w/out" "$w/debug.out"
   same "$1: debug build, refusal" "$w/err" "$w/debug.err"
   [ $both = yes ] || return
   LD_LIBRARY_PATH=$lapack "$kinmat" "$w/deck" > "$w/other.out" 2> "$w/err"
   same "$1: reference LAPACK" "$w/out" "$w/other.out"
   LD_LIBRARY_PATH=$openblas "$kinmat" "$w/deck" > "$w/other.out" 2> "$w/err"
   same "$1: OpenBLAS" "$w/out" "$w/other.out"
}

# found WHAT: what an awk expression gives, as the listing writes it
found() { awk "function acos(x) { return atan2(sqrt(1 - x*x), x) } function asin(x) { return atan2(x, sqrt(1 - x*x)) }
   BEGIN { pi = atan2(0, -1); printf \"%.9E\", $1 }"; }
small() { awk "BEGIN { pi = atan2(0, -1); printf \"%.2E\", $1 }"; }

singular=' *** JACOBIAN SINGULAR: VELOCITIES AND ACCELERATIONS DO NOT EXIST'
open=' *** TOO MANY EQUATIONS, AND THEY CONTRADICT ONE ANOTHER'
none=' *** NO POSITION FOUND'
below=' LARGEST GAP OF REDUNDANT EQUATIONS, OF THE SIZE: BELOW 1.E-13'

# Freedoms by structure: which links, how many drives, which equations.
crank_rocker='0.0 1.0 3.5 3.0 4.0 14.0 50.0 110.0'
{ head_of FIVE-BAR; link ONE 0.0 0.0 90.0; link TWO 0.0 1.0 20.0; link THREE 4.0 1.0 160.0; link FOUR 4.0 0.0 90.0
   point O BASE; point Q BASE 4.0; point O1 ONE; point A1 ONE 1.0; point A2 TWO; point B2 TWO 3.0; point C3 THREE
   point B3 THREE 3.0; point Q4 FOUR; point C4 FOUR 1.0
   joint O O1 PO; joint A1 A2 PA; joint B2 B3 PB; joint C3 C4 PC; joint Q4 Q PQ; until_time 2 1.0; } > "$w/deck"
told 'five-bar without drives' 1 ' *** E101  SET 1: LINKS ONE, TWO, THREE, FOUR: 2 FREEDOMS LEFT, ADD DRIVES
 *** E103  SET 1: W = 15 COORDINATES LESS R = 13 EQUATIONS LEAVE S = 2 FREEDOMS, DRIVES ARE 0'
sed 's/^TIME /'"$(drive ANGLE TWO '' 20.0)"'\n&/' "$w/deck" > "$w/one.deck" && mv "$w/one.deck" "$w/deck"
told 'five-bar with one drive' 1 ' *** E101  SET 1: LINKS ONE, TWO, THREE, FOUR: 1 FREEDOM LEFT, ADD A DRIVE
 *** E103  SET 1: W = 15 COORDINATES LESS R = 13 EQUATIONS LEAVE S = 2 FREEDOMS, DRIVES ARE 1'
{ head_of TWO; four_bar 1 $crank_rocker; four_bar 2 1$crank_rocker; until_time 2 1.0; } > "$w/deck"
told 'two mechanisms without drives' 1 ' *** E101  SET 1: LINKS CRANK1, COUPL1, ROCK1: 1 FREEDOM LEFT, ADD A DRIVE
 *** E101  SET 1: LINKS CRANK2, COUPL2, ROCK2: 1 FREEDOM LEFT, ADD A DRIVE
 *** E103  SET 1: W = 21 COORDINATES LESS R = 19 EQUATIONS LEAVE S = 2 FREEDOMS, DRIVES ARE 0'
{ head_of TWO; four_bar 1 $crank_rocker; four_bar 2 1$crank_rocker
   drive ANGLE CRANK1 '' 14.0 9.0; drive ANGLE ROCK1 '' 99.0 9.0; until_time 2 1.0; } > "$w/deck"
told 'two drives on one mechanism, none on the other' 1 \
   ' *** E101  SET 1: LINKS CRANK2, COUPL2, ROCK2: 1 FREEDOM LEFT, ADD A DRIVE
 *** E102  SET 1: TOO MANY EQUATIONS BY 1 AMONG PAIRS PA01, PA1, PB1, PB01 AND DRIVES ANGLE CRANK1, ANGLE ROCK1
 *** E103  SET 1: W = 21 COORDINATES LESS R = 19 EQUATIONS LEAVE S = 2 FREEDOMS, DRIVES ARE 2'
block() { head_of BLOCK; link BLOCK 0.0 0.0 0.0; point O BASE; point O1 BLOCK; card PRISM O O1 GUIDE 0.0 0.0 0.0
   "$@"; until_time 2 1.0; }
block drive ANGLE BLOCK '' 0.0 > "$w/deck"
told 'an angle that a guide keeps is driven' 1 ' *** E101  SET 1: LINK BLOCK: 1 FREEDOM LEFT, ADD A DRIVE
 *** E102  SET 1: TOO MANY EQUATIONS BY 1 AMONG PAIRS GUIDE AND DRIVES ANGLE BLOCK
 *** E103  SET 1: W = 6 COORDINATES LESS R = 5 EQUATIONS LEAVE S = 1 FREEDOMS, DRIVES ARE 1'
{ head_of PIVOT; four_bar '' $crank_rocker; drive X A1 '' 0.0; until_time 2 1.0; } > "$w/deck"
told 'a drive on a fixed pivot moves nothing' 1 ' *** E101  SET 1: LINKS CRANK, COUPL, ROCK: 1 FREEDOM LEFT, ADD A DRIVE
 *** E102  SET 1: TOO MANY EQUATIONS BY 1 AMONG PAIRS PA0 AND DRIVES X A1
 *** E103  SET 1: W = 12 COORDINATES LESS R = 11 EQUATIONS LEAVE S = 1 FREEDOMS, DRIVES ARE 1'
{ head_of MATRIX; four_bar '' $crank_rocker; drive ANGLE CRANK '' 14.0 9.0; drive RELANGLE CRANK COUPL 1.0; card METHOD MATRIX
   until_time 2 1.0; } > "$w/deck"
told 'too many equations for METHOD MATRIX' 1 \
   ' *** E104  SET 1: ONLY METHOD NEWTON TAKES TOO MANY EQUATIONS BY 1 AMONG PAIRS PA0, PA, PB, PB0 AND DRIVES ANGLE CRANK, RELANGLE CRANK COUPL'

# Freedoms by rank: the count is right and the structure too, the numbers are not.
parallelogram() { head_of PARALLEL; four_bar '' 0.0 2.0 4.0 2.0 4.0 40.0 0.0 40.0; "$@"; until_time 1 1.0; }
parallelogram drive ANGLE COUPL '' 0.0 > "$w/deck"
told 'the coupler of a parallelogram is driven' 2 "0:$singular
0: *** LINKS CRANK, ROCK CAN STILL MOVE, ADD A DRIVE
1:$singular"
scott_russell() { head_of 'SCOTT RUSSELL'; link CRANK 0.0 0.0 30.0; link BAR 0.87 0.5 -30.0; link BLOCK 1.73 0.0 0.0
   point O BASE; point O1 CRANK; point A1 CRANK 1.0; point A2 BAR; point B2 BAR 1.0; point C BAR -1.0; point B BLOCK
   joint O O1 PO; joint A1 A2 PA; joint B2 B PB; card PRISM O B GUIDE 0.0 0.0 0.0; "$@"; until_time 1 1.0; }
scott_russell drive X C '' 0.0 > "$w/deck"
told 'a drive across a straight line that the point cannot leave' 2 "0:$singular
0: *** LINKS CRANK, BAR CAN STILL MOVE, ADD A DRIVE
1:$singular"
{ head_of 'THIRD CRANK'; three_cranks 0.0 30.0; until_time 1 1.0; } > "$w/deck"
told 'three cranks without a drive' 2 "0:$singular
0: *** LINKS CRANK-1, CRANK-2, CRANK-3 CAN STILL MOVE, ADD A DRIVE
1:$singular"

# Redundant and consistent: of those that depend on one another, the last of the deck.
{ head_of TWICE; four_bar '' $crank_rocker; drive ANGLE CRANK '' 14.0 9.0
   drive ANGLE CRANK '' 14.0 9.0; until_time 2 1.0; } > "$w/deck"
told 'one drive twice' 0 "0: --- REDUNDANT EQUATION: DRIVE ANGLE CRANK
$below"
{ head_of 'THIRD CRANK'; three_cranks 0.0 30.0; drive ANGLE CRANK-1 '' 30.0 30.0; until_time 1 2.0; } > "$w/deck"
told 'three cranks' 0 "0: --- REDUNDANT EQUATION: PAIR PAIR-C
$below"
block drive SLIDE GUIDE '' 0.0 1.0 > "$w/slide.deck"
sed 's/^TIME /'"$(drive Y O1 '' 0.0)"'\n&/' "$w/slide.deck" > "$w/deck"
told 'a drive that asks for what is so anyway' 0 "0: --- REDUNDANT EQUATION: DRIVE Y O1
$below"

# Lock-up: the limit by the cosine law, by crank and rod in line, by the rod across the guide.
limit="acos((9.0 + 16.0 - 16.0)/24.0)*180/pi"
{ head_of LIMIT; four_bar '' 0.0 3.0 2.0 2.0 4.0 0.0 30.0 120.0; drive ANGLE CRANK '' 0.0 20.0; until_time 6 6.0; } > "$w/deck"
told 'coupler and rocker in line' 2 "4:$none
4: *** LIMIT OF MOTION AT T = $(found "$limit/20"), DRIVE ANGLE CRANK = $(found "$limit") DEG
4: *** LINKS COUPL, ROCK AT THE LIMIT, IN LINE
5:$none
6:$none"
equal 'coupler and rocker in line: the steps before' 4 "$(grep -c '^ COUPL .*[0-9]$' "$w/out")"
{ head_of PISTON; slider 1.0 3.0 60.0 0.0; drive X B '' 3.5 0.2; until_time 2 3.0; } > "$w/deck"
told 'a piston beyond its reach' 2 "2:$none
2: *** LIMIT OF MOTION AT T = $(found 2.5), DRIVE X B = $(found 4) M
2: *** LINKS CRANK, ROD AT THE LIMIT, IN LINE"
{ head_of PISTON MM; slider 100.0 300.0 60.0 50.0; drive SLIDE GUIDE '' 330.0 20.0; until_time 3 6.0; } > "$w/deck"
told 'a piston beside its guide, in millimetres' 2 "2:$none
2: *** LIMIT OF MOTION AT T = $(found '(sqrt(160000 - 2500) - 330)/20'), DRIVE SLIDE GUIDE = $(found 'sqrt(160000 - 2500)') MM
2: *** LINKS CRANK, ROD AT THE LIMIT, IN LINE
3:$none"
{ head_of PISTON; slider 1.0 3.0 60.0 0.0; drive X B '' 3.5 0.0
   card ADD HARMONIC '' '' 0.6 30.0 0.0; until_time 3 3.0; } > "$w/deck"
told 'a piston that swings' 2 "2:$none
2: *** LIMIT OF MOTION AT T = $(found 'asin(5/6)*180/pi/30'), DRIVE X B = $(found 4) M
2: *** LINKS CRANK, ROD AT THE LIMIT, IN LINE
3:$none"
{ head_of PISTON; slider 1.0 3.0 60.0 0.0; drive X B '' 3.5 -0.2; card AT '' '' '' 0.0 -2.0 -3.0; card END; } > "$w/deck"
told 'time runs backwards' 2 "2:$none
2: *** LIMIT OF MOTION AT T = $(found -2.5), DRIVE X B = $(found 4) M
2: *** LINKS CRANK, ROD AT THE LIMIT, IN LINE"
{ head_of 'SHORT ROD'; slider 2.0 1.0 0.0 0.0; drive ANGLE CRANK '' 0.0 9.0; until_time 2 4.0; } > "$w/deck"
told 'the rod across its guide' 2 "2:$none
2: *** LIMIT OF MOTION AT T = $(found 30/9), DRIVE ANGLE CRANK = $(found 30) DEG
2: *** LINK ROD AT THE LIMIT"
{ head_of 'SHORT ROD' M RAD; slider 2.0 1.0 0.0 0.0; drive ANGLE CRANK '' 0.0 0.15
   until_time 2 4.0; } | sed 's/-10.0$/-0.1/' > "$w/deck"
told 'the rod across its guide, in radians' 2 "2:$none
2: *** LIMIT OF MOTION AT T = $(found pi/6/0.15), DRIVE ANGLE CRANK = $(found pi/6) RAD
2: *** LINK ROD AT THE LIMIT"

# From the rough positions: what cannot be closed, by how much and where; what was far, and what was close.
{ head_of REACH; slider 1.0 3.0 60.0 0.0; drive X B '' 4.5 0.0; until_time 1 1.0; } > "$w/deck"
told 'a piston beyond its reach from the start' 2 "0:$none
0: *** DRIVE X B STAYS OPEN BY $(small 0.5) M
1:$none
1: *** DRIVE X B STAYS OPEN BY $(small 0.5) M"

# Decks that are no decks: refused in bounded time and memory, in few words, and nothing is computed.
# refused NAME WORDS: the deck in $w/deck, in 20 s of computing and 1 GB; WORDS: the first sentence
refused() {
   (ulimit -t 20; ulimit -v 1000000; exec "$kinmat" "$w/deck") > "$w/out" 2> "$w/err"
   equal "$1: status" 1 $?
   equal "$1: standard output" 0 "$(wc -c < "$w/out" | tr -d ' ')"
   equal "$1: words" "$2" "$(grep -a -m 1 '\*\*\*' "$w/err")"
   equal "$1: at most 50 sentences and their cards" yes "$([ "$(wc -l < "$w/err")" -le 201 ] && echo yes)"
   equal "$1: characters that cannot be printed" 0 "$(LC_ALL=C tr -d '\n -~' < "$w/err" | wc -c | tr -d ' ')"
}
: > "$w/deck"
refused 'an empty file' ' *** E001  THE DECK IS EMPTY'
yes '$ A COMMENT OF EIGHTY CHARACTERS, OF WHICH THERE ARE SO MANY THAT NOBODY READS THEM' | head -c 200000000 > "$w/deck"
refused '200 MB' ' *** E006  THE DECK IS TOO LONG; CARDS ALLOWED: 2000000'
awk 'BEGIN { print "GROUND  BASE"; for (i = 1; i <= 1000000; i++) printf "LINK    L%d\n", i; print "END" }' > "$w/deck"
refused 'a million cards' ' *** E005  CARD 1000002  COLUMN 1  FIELD NAME: "END" CLOSES A SET WITHOUT A TIME OR AT CARD'
awk 'BEGIN { for (i = 1; i <= 1000000; i++) print "NONSENSE" }' > "$w/deck"
refused 'a million wrong cards' ' *** E010  CARD 1  COLUMN 1  FIELD NAME: "NONSENSE" IS NOT THE NAME OF A CARD'
equal 'a million wrong cards: the rest is counted' ' *** AND 999951 MORE' "$(tail -n 1 "$w/err")"
{ head -c 1000000 /dev/zero | tr '\0' X; echo; } > "$w/deck"
refused 'a line of a million characters' \
   ' *** E014  CARD 1  COLUMN 81  FIELD PAST-80: "XXXXXXXXXXXXXXXXXXXXXXXX" STANDS PAST COLUMN 80'
equal 'a line of a million characters: few of them told' yes "$([ "$(wc -c < "$w/err")" -lt 2000 ] && echo yes)"
{ printf 'TITLE   A'; head -c 1000000 /dev/zero | tr '\0' ' '; echo B; echo END; } > "$w/deck"
refused 'a million blanks in a line' ' *** E014  CARD 1  COLUMN 1000010  FIELD PAST-80: "B" STANDS PAST COLUMN 80'
head -c 1000000 /dev/zero > "$w/deck"
refused 'a million zero bytes' ' *** E016  CARD 1  COLUMN 1  FIELD NAME: "????????" IS OR HOLDS A CONTROL CHARACTER'
cp "$kinmat" "$w/deck"
refused 'the program as its own deck' ' *** E016  CARD 1  COLUMN 1  FIELD NAME: "?ELF????" IS OR HOLDS A CONTROL CHARACTER'
rm -f "$w/deck"

# A pipe that ends in the middle of a card.
{ head_of CUT; slider 1.0 3.0 60.0 0.0; drive ANGLE CRANK '' 60.0 9.0; until_time 2 1.0; } > "$w/deck"
cut_at() { head -c "$2" "$w/deck" | "$kinmat" > "$w/out" 2> "$w/err"
   equal "$1: status" 1 $?
   equal "$1: words" "$3" "$(grep '\*\*\*' "$w/err" | tail -n 1)"
   equal "$1: standard output" 0 "$(wc -c < "$w/out" | tr -d ' ')"; }
bytes=$(wc -c < "$w/deck")
last=$(wc -l < "$w/deck")
cut_at 'cut in the TIME card' $((bytes - 6)) \
   " *** E002  CARD $((last - 1))  COLUMN 1  FIELD NAME: \"TIME\" IS THE LAST CARD OF THE DECK, BUT NOT END"
cut_at 'cut in the END card' $((bytes - 2)) \
   " *** E010  CARD $last  COLUMN 1  FIELD NAME: \"EN\" IS NOT THE NAME OF A CARD (IS IT END?)"
head -c $((bytes - 1)) "$w/deck" | "$kinmat" > "$w/out"
equal 'cut after END: status' 0 $?
(head -c 300 "$w/deck"; sleep 1; tail -c +301 "$w/deck") | "$kinmat" > "$w/slow.out"
same 'a pipe that halts in the middle of a card' "$w/out" "$w/slow.out"
conclude
