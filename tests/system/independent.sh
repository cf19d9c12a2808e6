#!/bin/sh
# A mechanism's numbers do not depend on what else is in its deck: alone, and beside a copy of 1E-12, 1E-6, 1E6 and 1E12
# times its size, before it or after it in the deck, its rows in the CSV are the same bytes, with their errors.
. tests/counting.sh

# link, point, joint, drive: cards of one mechanism, whose names end in
# $mark and whose lengths are in units of 10**$unit, of two digits
long() { case $1 in '' | 0.0) length=0.0 ;; *) length=${1}E$unit ;; esac; }
# long_card NAME A B X Y Z: X and Y are lengths
long_card() { long "$4"; x=$length; long "$5"; card "$1" "$2" "$3" '' "$x" "$length" "$6"; }
ground() { long_card GROUND "$1$mark" '' "$2" "$3" 0.0; }
link() { long_card LINK "$1$mark" '' "$2" "$3" "$4"; }
point() { long_card POINT "$1$mark" "$2$mark" "$3" "$4"; }
joint() { card REVOLUTE "$1$mark" "$2$mark" "$3$mark"; }
angle() { card DRIVE ANGLE "$1$mark" '' "$2" "$3" "${4:-0.0}"; }

# chain CRANK COUPLER ROCKER BASE PHI-CRANK PHI-COUPLER PHI-ROCKER: a four-bar linkage
chain() {
   ground G
   link CR 0.0 0.0 "$5"; link CO "$1" 0.0 "$6"; link RO "$4" 0.0 "$7"
   point A0 G; point B0 G "$4"; point A1 CR; point A2 CR "$1"; point C1 CO; point C2 CO "$2"; point R1 RO; point R2 RO "$3"
   joint A0 A1 PA0; joint A2 C1 PA; joint C2 R2 PB; joint R1 B0 PB0
}

# What a mechanism may be; each moves for 2 s.
four_bar() { chain 1.0 3.5 3.0 4.0 0.25 0.9 1.9; point P CO 1.7 0.6; angle CR 0.25 1.0 0.1; }
# The crank passes the limit at about 1 s.
limit() { chain 3.0 3.5 1.0 4.0 0.2 0.9 1.9; angle CR 0.2 0.9; }
# A parallelogram, through its change point, and an instant on it.
change() { chain 2.0 4.0 2.0 4.0 2.0 0.0 2.0; angle CR 2.14159265358979 1.0; }
branch() { change; card BRANCH "CO$mark" '' '' 0.0; }
at_start() { chain 2.0 4.0 2.0 4.0 0.0 0.0 0.0; angle CR 0.0 0.5; }
# Three parallel cranks: one equation too many, by nothing or by a tenth of a crank.
cranks() {
   ground G
   link CR 0.0 0.0 0.5; link R2 4.0 0.0 0.5; link R3 2.0 1.0 0.5; link CO 1.3 0.7 0.0
   point A0 G; point B0 G 4.0; point C0 G 2.0 1.0
   point A1 CR; point A2 CR 1.5; point B1 R2; point B2 R2 1.5; point C1 R3; point C2 R3 "$1"
   point A CO; point B CO 4.0; point C CO 2.0 1.0
   joint A0 A1 PA0; joint B0 B1 PB0; joint C0 C1 PC0; joint A2 A PA; joint B2 B PB; joint C2 C PC
   angle CR 0.5 1.0
}
redundant() { cranks 1.5; }
contradiction() { cranks 1.65; }
# A crank, a rod and a piston that a SLIDE drives.
slider() {
   ground G
   link CR 0.0 0.0 0.8; link RO 0.7 0.7 -0.3; link PI 3.5 0.2 0.0
   point O G; point H G 0.0 0.2; point O1 CR; point A1 CR 1.0; point A2 RO; point B2 RO 3.0; point B PI
   joint O O1 PO; joint A1 A2 PA; joint B2 B PB
   card PRISM "H$mark" "B$mark" "GU$mark" 0.0 0.0 0.0
   card DRIVE SLIDE "GU$mark" '' "3.5E$unit" "-0.4E$unit" 0.0
}
dead_point() { chain 1.0 3.5 3.0 4.0 0.25 0.9 1.9; angle RO 1.9 -0.1; }

# deck: the mechanisms on standard input, one a line: NAME MARK POWER; what else a set needs
deck() {
   card TITLE 'INDEPENDENT MECHANISMS'
   card METHOD "${method:-NEWTON}"
   while read -r kind mark unit; do $kind; done
   card TIME 10 '' '' 0.0 2.0
   card PRINT ALL
   card END
}

# rows FILE MARK: the rows of one mechanism, its mark left out
rows() { grep "^[^,]*,[^,]*,[^,]*,[A-Z]*,[A-Z0-9]*$2," "$1" | sed "s/^\([^,]*,[^,]*,[^,]*,[A-Z]*,[A-Z0-9]*\)$2,/\1,/"; }

# run DECK: its listing, and its results with errors
run() { "$kinmat" "$1.deck" -o "$1.lst" --csv "$1.csv" --errors 2> "$1.err"; }

# beside NAME POWER: NAME alone and a copy of 10**POWER times its size alone, and the two in one deck
beside() {
   echo "$1 + +00" | deck > "$w/alone.deck"; run "$w/alone"
   echo "$1 - $2" | deck > "$w/copy.deck"; run "$w/copy"
   printf '%s\n' "$1 + +00" "$1 - $2" | deck > "$w/before.deck"; run "$w/before"
   printf '%s\n' "$1 - $2" "$1 + +00" | deck > "$w/after.deck"; run "$w/after"
   rows "$w/alone.csv" + > "$w/alone.rows"; rows "$w/copy.csv" - > "$w/copy.rows"
   for order in before after; do
      rows "$w/$order.csv" + > "$w/a.rows"; rows "$w/$order.csv" - > "$w/b.rows"
      same "$method $1, $order a copy of 1E$2" "$w/alone.rows" "$w/a.rows"
      same "$method $1, $order: the copy of 1E$2" "$w/copy.rows" "$w/b.rows"
   done
   equal "$method $1, 1E$2: rows" "$(grep -c . "$w/alone.rows")" "$(grep -c . "$w/b.rows")"
}

method=NEWTON
for k in -12 -06 +06 +12; do beside four_bar $k; done
for kind in limit change redundant; do beside $kind -12; beside $kind +06; done
for kind in branch at_start contradiction slider dead_point; do beside $kind -06; done
for method in DENSE MATRIX; do beside four_bar -12; beside limit +06; done
method=NEWTON

# The listing: each has its own power of ten, so that the small one has its seven digits too.
printf '%s\n' 'four_bar + +00' 'four_bar - -12' | deck > "$w/two.deck"; run "$w/two"
equal 'the large one of two' ' RO+         4.000000' "$(grep -m 1 '^ RO+ ' "$w/two.lst" | cut -c 1-21)"
equal 'the small one of two' ' RO-         4.000000' "$(grep -m 1 '^ RO- ' "$w/two.lst" | cut -c 1-21)"
equal 'its power of ten' '               1.E-12      1.E-12                  1.E-12      1.E-12                  1.E-12      1.E-12' \
   "$(grep -m 1 ' 1[.]E' "$w/two.lst")"
equal 'lines over 120 columns' '' "$(awk 'length > 120' "$w/two.lst")"

# One that is at its limit, or that contradicts itself, flags the instant, and not the rows of the other.
printf '%s\n' 'four_bar + +00' 'contradiction - -10' | deck > "$w/gap.deck"; run "$w/gap"
equal 'a contradiction in a small mechanism: status' 2 "$("$kinmat" "$w/gap.deck" -o "$w/gap.lst"; echo $?)"
equal 'a contradiction in a small mechanism: marks' '11 OPEN' \
   "$(rows "$w/gap.csv" - | awk -F, '$5 == "CO" { n[$15]++ } END { for (k in n) print n[k], k }')"
equal 'a contradiction in a small mechanism: the other' '11 ' \
   "$(rows "$w/gap.csv" + | awk -F, '$5 == "CO" { n[$15]++ } END { for (k in n) print n[k], k }')"

# Redundant cranks a millionth as large on a link of a large mechanism: a tenth too long is open, and by nothing is not.
# on_a_large_link LENGTH: three cranks on the coupler of a four-bar linkage
on_a_large_link() {
   card TITLE 'SMALL ON LARGE'
   mark=; unit=+03; four_bar
   mark==; unit=-03
   link CR 0.0 0.0 0.9; link R2 0.0 0.0 0.9; link R3 0.0 0.0 0.9; link CO 0.0 0.0 0.4
   card POINT A0= CO; card POINT B0= CO '' 0.004 0.0; card POINT C0= CO '' 0.002 0.001
   point A1 CR; point A2 CR 1.5; point B1 R2; point B2 R2 1.5; point C1 R3; point C2 R3 "$1"
   point A CO; point B CO 4.0; point C CO 2.0 1.0
   joint A0 A1 PA0; joint B0 B1 PB0; joint C0 C1 PC0; joint A2 A PA; joint B2 B PB; joint C2 C PC
   card DRIVE RELANGLE CO CR= 0.5 1.0
   card TIME 2 '' '' 0.0 1.0
   card PRINT ALL
   card END
}
on_a_large_link 1.5 > "$w/fits.deck"; run "$w/fits"
equal 'small cranks on a large link: solved' ' END OF SET 1:  INSTANTS SOLVED 3, FLAGGED 0' "$(grep 'END OF SET' "$w/fits.lst")"
on_a_large_link 1.65 > "$w/open.deck"; run "$w/open"
equal 'small cranks on a large link, one too long' ' *** REDUNDANT EQUATIONS ARE INCONSISTENT' \
   "$(grep -m 1 'INCONSISTENT' "$w/open.lst")"

# A point in no pair changes no digit of the links.
{ card TITLE 'FAR POINT'; mark=+; unit=+00; four_bar; card TIME 10 '' '' 0.0 2.0; } > "$w/set"
{ cat "$w/set"; card PRINT LINKS; card PRINT POINTS P+; card END; } > "$w/near.deck"; "$kinmat" "$w/near.deck" --csv "$w/near.csv" > "$w/out"
{ sed 's/^\(POINT   P+ .*\)1.7E+00 /\14.7E+02 /' "$w/set"; card PRINT LINKS; card PRINT POINTS P+; card END; } > "$w/far.deck"
"$kinmat" "$w/far.deck" --csv "$w/far.csv" > "$w/out"
grep LINK "$w/near.csv" > "$w/near.rows"; grep LINK "$w/far.csv" > "$w/far.rows"
same 'a point far away, in no pair' "$w/near.rows" "$w/far.rows"
equal 'a point far away: it is far' 11 "$(grep -c 'POINT,P+,[-0-9.]*E+002' "$w/far.csv")"
conclude
