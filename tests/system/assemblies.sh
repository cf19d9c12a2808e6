#!/bin/sh
# Card ASSEMBLY: the counts of another program, the LINK cards that it prints, other units and another order of cards.
. tests/counting.sh

# assemblies DECK: what the listing says of them
assemblies() { "$kinmat" --quiet "$1" 2>&1 | awk '/^ (ASSEMBLIES|MONTAZE) / { on = 1 } /^ (CONTINUATION|KONTYNUACJA|RANGES|LARGEST)/ { on = 0 } on'; }

# Blocks made by chance: as many solutions, and as many of them real, as PHCpack finds. The table has 100 of them.
last=${1:-30}
equal 'blocks in the table' 100 "$(grep -c . tests/validation/assemblies.txt)"
while read -r seed links finite real; do
   [ "$seed" -le "$last" ] || break
   "$BUILD/release/random_blocks" "$seed" deck > "$w/block.deck"
   equal "block $seed, $links links" "$finite FINITE, 0 FAILED, $real REAL" "$(assemblies "$w/block.deck" |
      sed -n 's/.* PATHS [0-9]* = \([0-9]*\) FINITE + [0-9]* AT INFINITY + \([0-9]*\) FAILED   REAL \([0-9]*\)/\1 FINITE, \2 FAILED, \3 REAL/p')"
done < tests/validation/assemblies.txt

# pasted DECK K: the deck with the LINK, JOINT and DRIVE cards of its assembly K in place of its own
pasted() {
   assemblies "$1" | awk -v k="$2" '/^ (ASSEMBLY|MONTAZ) / { on = $2 == k } on && /^(LINK|JOINT|DRIVE|\*) /' > "$w/cards"
   awk -v cards="$w/cards" '
      # What a card is about: a drive has a kind, too, and a second link.
      function key_of(text) { return substr(sprintf("%-32s", text), 1, text ~ /^DRIVE/ ? 32 : 16) }
      BEGIN {
         while ((getline line < cards) > 0) {
            if (line ~ /^\*/) { own[key] = own[key] "\n" line; continue }
            key = key_of(line); own[key] = line
         }
      }
      /^\*/ { if (!left_out) print; next }
      { key = key_of($0); left_out = key in own }
      left_out { print own[key]; next } { print }' "$1"
}

# is_taken NAME DECK K: its assembly K, pasted, is the one that a run takes
is_taken() {
   pasted "$2" "$3" > "$w/pasted.deck"
   equal "$1: assembly $3 is taken" "$(assemblies "$2" | sed -n "s/^ ASSEMBLY $3   DISTANCE = [0-9.]*  *//p" | sed 's/   CHOSEN.*//')" \
      "$(assemblies "$w/pasted.deck" | sed -n 's/^ ASSEMBLY 1   DISTANCE = 0.00[0-9]*  *\(.*\)   CHOSEN BY THE ESTIMATE/\1/p')"
}

# Each assembly, pasted, is the one that a run takes: the deck of one set (the first of the deck of input/).
# taken DECK NUMBER [SET [SED]]: changed by the sed expression
taken() {
   awk -v set="${3:-1}" 'BEGIN { n = 1 } n == set; /^END/ { n++ }' "input/$1.deck" | sed "${4:-}" | awk '/^END/ { print "ASSEMBLY" } { print }' > "$w/$1.deck"
   equal "$1: assemblies" "$2" "$(assemblies "$w/$1.deck" | grep -c '^ ASSEMBLY ')"
   for k in $(seq "$2"); do is_taken "$1" "$w/$1.deck" "$k"; done
}
taken four_bar 2
taken crank_slider 2
taken inverted_slider 2
taken drawing 2 2
taken drawn_slider 2
taken drawn_slider 2 2
taken drawn_cylinder 2
# The motion begins off the drawing: the value of the drive at t = 0 is that of the drawing before.
taken drawn_slider 2 1 's/^TIME.*/AT                              0.5/'
taken drawn_cylinder 2 1 's/^TIME.*/AT                              0.5/'
taken drawing 2 1 's/^TIME.*/AT                              2.0/'
taken far_small 2
taken stephenson_output 2
taken three_rrr_cranks 2
taken three_rrr 8
taken cognates 2
taken double_parallelogram 1

# Numbers of cards leave a blank between, whatever their size; what has no room has a * card, and the dimensions stay.
for scale in 0.1 0.003 3e-6 300.0; do
   awk -v scale=$scale 'BEGIN { n = 1 } n == 2; /^END/ { n++ }' input/drawing.deck | awk -v scale=$scale '
      /^(LINK|JOINT|POINT) / && substr($0, 33) != "" {
         printf "%s\n*       %-24s%.12E\n", substr($0, 1, 32), sprintf("%.12E", substr($0, 33, 16)*scale), substr($0, 49, 16)*scale; next }
      /^END/ { print "ASSEMBLY" } { print }' > "$w/small.deck"
   assemblies "$w/small.deck" > "$w/small.lst"
   equal "numbers that touch, $scale" '2 0' "$(awk '
      /^ ASSEMBLY / { n++ }
      /^(LINK|JOINT) / && (substr($0, 33, 1) substr($0, 49, 1) substr($0, 65, 1)) !~ /^ *$/ { touch++ }
      /^\*/ && (substr($0, 9, 1) substr($0, 33, 1) substr($0, 57, 1)) !~ /^ *$/ { touch++ }
      END { print n, touch + 0 }' "$w/small.lst")"
   for k in 1 2; do is_taken "numbers that touch, $scale" "$w/small.deck" $k; done
done

# Lazy tongs of four stages, driven by their height h. With n stages upward, h is (2 n - 4) times the height of a stage: n is
# 3 or 4, which are five choices, and the slide is on either side. Two paths almost meet on the way.
for size in '2.442369423937087 0.55962212899206532 0.39120118' '2.16759960793283035 1.23774550194012889 1.95892131'; do
   echo "$size" | awk '
      function card(name, a, b, c) { printf "%-8s%-8s%-8s%s\n", name, a, b, c }
      function joint(name, a, b, x, y) { card("JOINT", name, a, b); printf "*       %-24.17f%-24.17f\n", x, y }
      { w = $1; h = $2
        card("UNITS", "M", "DEG", "S"); card("GROUND", "G")
        for (i = 0; i < 4; i++) { card("LINK", "A" i); card("LINK", "B" i) }
        card("LINK", "SL")
        joint("O", "G", "A0", 0, 0); joint("W", "B0", "SL", w, 0)
        card("POINT", "Z", "G"); card("POINT", "WS", "SL"); printf "*       %-24.17f\n", w; card("PRISM", "Z", "WS", "WAY")
        for (i = 0; i < 4; i++) {
           joint("M" i, "A" i, "B" i, w/2, h*(i + 0.5))
           if (i > 0) { joint("P" i, "A" i - 1, "B" i, w, h*i); joint("Q" i, "B" i - 1, "A" i, 0, h*i) }
        }
        card("POINT", "T", "B3"); printf "*       %-24.17f%-24.17f\n", 0, 4*h
        printf "%-48s%s\n%-32s0.0\nASSEMBLY\nEND\n", "DRIVE   Y       T", $3, "AT" }' > "$w/tongs.deck"
   equal "tongs, $size" '0 FAILED   REAL 10, 10 PROVED' "$(assemblies "$w/tongs.deck" | awk '
      /PATHS/ { printf "%s", substr($0, index($0, " FAILED") - 1) } /^ ASSEMBLY .*PROVED/ { n++ } END { print ", " n " PROVED" }')"
done

# A link on two parallel guides that agree to rounding: its assembly is there. A block without unknowns has no line.
{
   card GROUND G; card LINK L
   card POINT P1 G '' -4.27 -3.07; card POINT P2 L '' 2.64 1.02; card POINT P3 G '' -2.83 -1.07; card POINT P4 L '' 3.48 -3.27
   card PRISM P1 P2 J1 0.7; card PRISM P3 P4 J2 0.7 4.4243267456768
   card DRIVE SLIDE J1 '' '' 1.0; card AT '' '' '' 0.0; card ASSEMBLY; card END
} > "$w/guides.deck"
"$kinmat" --quiet -o "$w/guides.lst" "$w/guides.deck"
equal 'two guides' ' ASSEMBLY 1   DISTANCE = 0.2500   PROVED   CHOSEN BY THE ESTIMATE,' \
   "$(grep -E '^   BLOCK|^ ASSEMBLY [0-9]|\*\*\*|NONE' "$w/guides.lst" | tr '\n' ',')"
# summed DECK CARD VALUES...: the column of --summary of the deck, in which R1 of the card takes these values
summed() {
   deck=$1
   varied=$2
   shift 2
   awk -v varied="$varied" -v vary="$(card VARY R1 LIST '' "$@")" '{ print } index($0, varied) == 1 { print vary }' "$deck" > "$w/varied.deck"
   "$kinmat" --quiet --summary "$w/summary" -o "$w/varied.lst" "$w/varied.deck"
   awk -F , 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "assemblies") k = i } { print $k ";" }' "$w/summary" | tr -d '\n'
}
equal 'two guides: --summary' 'assemblies;1;1;' "$(summed "$w/guides.deck" 'DRIVE ' 1.0 2.0)"

# A block that finds no angle has the names of the links that get their places there.
{
   card UNITS M DEG S; card GROUND BASE; card LINK L0; card LINK L4; card LINK L3
   card JOINT J0 BASE L0 2.0 1.0; card POINT P3 BASE '' 3.0 3.0; card POINT Q3 L3 '' '' 3.0; card PRISM P3 Q3 S3 180.0
   card JOINT J4 L3 L4 3.0 3.0; card POINT P5 L0 '' 2.0 2.0; card POINT Q5 L4 '' 1.0 3.0; card PRISM P5 Q5 S5 135.0
   card DRIVE ANGLE L0 '' '' 10.0; card AT '' '' '' 0.0; card ASSEMBLY; card END
} > "$w/slides.deck"
equal 'a block of slides' '   BLOCK 1: LINKS L4, L3' "$(assemblies "$w/slides.deck" | grep '^   BLOCK')"

# Three parallel cranks of 8 digits: at 5 deg their equations agree, but not in their rates. The run flags it, nothing is proved.
{
   card UNITS M DEG S; card GROUND G; for k in C0 C1 C2 ROD; do card LINK $k; done
   card JOINT A0 G C0 2.4176509E-01 -1.7762218E-01; card JOINT B0 C0 ROD 5.1676257E-01 -1.2704922E+00
   card JOINT A1 G C1 -7.9325126E-01 -1.5864036E+00; card JOINT B1 C1 ROD -5.1825379E-01 -2.6792736E+00
   card JOINT A2 G C2 -1.5471722E+00 -2.6125804E+00; card JOINT B2 C2 ROD -1.2721747E+00 -3.7054505E+00
   card DRIVE ANGLE C0 '' 5.0 30.0; card AT '' '' '' 0.0; card ASSEMBLY; card END
} > "$w/open.deck"
equal 'rates that contradict one another' \
   ' *** LINKS C0, C1, C2, ROD: REDUNDANT EQUATIONS ARE INCONSISTENT,   NOT PROVED' \
   "$(assemblies "$w/open.deck" | sed -n 's/.*\(   [NOT ]*PROVED\).*/\1/p; /\*\*\*/p' | tr '\n' ',' | sed 's/,$//')"

# Coupler and rocker of one length, whose ends meet: they turn freely, and the run begins at one of their positions. It is not
# listed, so how many assemblies there are is not told.
{
   card GROUND BASE; card LINK CRANK; card LINK COUPLER '' '' '' '' 1.0; card LINK ROCKER '' '' 4.0 '' 1.0
   card POINT A0 BASE; card POINT B0 BASE '' 4.0; card POINT A0-CR CRANK; card POINT A-CR CRANK '' 4.0
   card POINT A-CO COUPLER; card POINT B-CO COUPLER '' 3.0; card POINT B0-RO ROCKER; card POINT B-RO ROCKER '' 3.0
   card REVOLUTE A0 A0-CR PA0; card REVOLUTE A-CR A-CO PA; card REVOLUTE B-CO B-RO PB; card REVOLUTE B0 B0-RO PB0
   card DRIVE ANGLE CRANK; card AT '' '' '' 0.0; card ASSEMBLY; card END
} > "$w/free.deck"
"$kinmat" --quiet -o "$w/free.lst" "$w/free.deck"
equal 'a first position that is missed' 1 "$(grep -c '^ \*\*\* ASSEMBLIES MAY BE MISSING: THAT IN WHICH THE RUN BEGINS WAS NOT FOUND' "$w/free.lst")"
equal 'a first position that is missed: --summary' 'assemblies;;;' "$(summed "$w/free.deck" 'LINK    CRANK' 0.0 0.1)"

# In other units, and with the cards in another order, the same assemblies.
rows() { assemblies "$1" | awk '/^ ASSEMBLY/ { sub(/DETERMINANTS [-+.0]*/, "") } /^ ASSEMBLY|UNKNOWNS/'; }
angles() { assemblies "$1" | awk '/^LINK/ { print substr($0, 9, 8), substr($0, 65) }'; }
rows "$w/three_rrr_cranks.deck" > "$w/rows"
angles "$w/three_rrr_cranks.deck" > "$w/angles"
awk -v long=6 -f tests/system/other_units.awk "$w/three_rrr_cranks.deck" > "$w/large.deck"
rows "$w/large.deck" > "$w/large.rows"
angles "$w/large.deck" > "$w/large.angles"
same 'a million times as large: assemblies' "$w/rows" "$w/large.rows"
same 'a million times as large: angles' "$w/angles" "$w/large.angles"
{ grep -v '^END' "$w/three_rrr_cranks.deck" | sed '1!G;h;$!d'; card END; } > "$w/order.deck"
rows "$w/order.deck" | sed 's/LINKS.*//' > "$w/order.rows"
angles "$w/order.deck" | sort > "$w/order.angles"
sort "$w/angles" > "$w/sorted.angles"
same 'another order: assemblies' "$w/rows" "$w/order.rows"
same 'another order: angles' "$w/sorted.angles" "$w/order.angles"

# A block of more than 12 unknowns is named, and nothing is listed of it; from a guess that is 0.6 rad off the first instant may
# not be the nearest. A linkage that can move with its drives held is named. A ring of seven links, each with a leg to the ground.
awk 'function card(a, b, c, d, x, y, z) { printf "%-8s%-8s%-8s%-8s%-16s%-16s%s\n", a, b, c, d, x, y, z }
   function real(x) { return sprintf("%.9f", x) }
   BEGIN {
      card("GROUND", "BASE")
      pi = atan2(0, -1)
      side = 4*sin(pi/7)
      for (k = 1; k <= 7; k++) {
         phi = 2*pi*k/7 + pi/7 + pi/2
         x = 2*cos(2*pi*k/7)
         y = 2*sin(2*pi*k/7)
         u = x + side/2*cos(phi)
         v = y + side/2*sin(phi)
         card("LINK", "R" k, "", "", real(x), real(y), real(phi + 0.6))
         card("LINK", "L" k, "", "", real(1.5*u), real(1.5*v + 1), real(atan2(-v/2 - 1, -u/2) + 0.6))
         card("POINT", "A" k, "BASE", "", real(1.5*u), real(1.5*v + 1))
         card("POINT", "B" k, "L" k)
         card("POINT", "C" k, "L" k, "", real(sqrt(u*u/4 + (v/2 + 1)^2)))
         card("POINT", "D" k, "R" k)
         card("POINT", "E" k, "R" k, "", real(side/2))
         card("POINT", "F" k, "R" k, "", real(side))
         card("REVOLUTE", "A" k, "B" k, "U" k)
         card("REVOLUTE", "C" k, "E" k, "V" k)
         card("REVOLUTE", "F" k, "D" k % 7 + 1, "W" k)
      }
      card("AT", "", "", "", "0.0")
      card("ASSEMBLY")
      card("END")
   }' | sed 's/ *$//' > "$w/wide.deck"
equal 'a wide block' ' *** LINKS R1, L1, R2, L2, R3, L3, R4, L4 AND 6 MORE: TOO MANY UNKNOWNS IN ONE BLOCK TO FIND ALL ASSEMBLIES, *** ASSEMBLIES MAY BE MISSING: THAT IN WHICH THE RUN BEGINS WAS NOT FOUND,   NONE' \
   "$(assemblies "$w/wide.deck" | grep -E '\*\*\*|NONE' | tr '\n' ',' | sed 's/,$//')"
with peaucellier "$(card ASSEMBLY)" > "$w/peaucellier.deck"
equal 'a wide block: the first instant' 1 "$("$kinmat" --quiet "$w/wide.deck" 2>&1 | tr -d '\n' | grep -c 'A NEARER ASSEMBLY MAY EXIST')"
equal 'bars that turn freely' ' *** LINKS BAR-AP, BAR-BP: NON-ISOLATED SOLUTIONS, LINKS MAY MOVE WITH ALL DRIVES HELD' \
   "$(assemblies "$w/peaucellier.deck" | grep -F '***')"

# Poor estimates, all angles 0: with the card the run begins in the nearest assembly, whose LINK cards give the same motion, and
# without it in another; the other methods, and the deck of bars that would turn freely, likewise.
motion() { "$kinmat" --quiet "$1" | awk '/^ INSTANT/ { on = 1 } /^ (ASSEMBLIES|CONTINUATION)/ { on = 0 } on && !/ ---/'; }
for deck in yoke_mirrored stephenson_output peaucellier; do
   awk '/^LINK / { $0 = sprintf("%-64s0.0", substr($0, 1, 64)) } { print }' "input/$deck.deck" > "$w/poor.deck"
   motion "$w/poor.deck" > "$w/without"
   sed -i "s/^END/$(card ASSEMBLY)\n&/" "$w/poor.deck"
   motion "$w/poor.deck" > "$w/with"
   pasted "$w/poor.deck" 1 | sed '/^ASSEMBLY/d' > "$w/pasted.deck"
   motion "$w/pasted.deck" > "$w/motion"
   same "$deck: the nearest" "$w/motion" "$w/with"
   cmp -s "$w/without" "$w/with"
   equal "$deck: another one without the card" 1 $?
   [ "$deck" = yoke_mirrored ] || continue
   sed 's/^ASSEMBLY/METHOD  DENSE\n&/' "$w/poor.deck" > "$w/dense.deck"
   motion "$w/dense.deck" > "$w/dense"
   same "$deck: the nearest, METHOD DENSE" "$w/with" "$w/dense"
done

# In all decks of input/ alike: where the first instant without the card is not in the nearest assembly, the listing says which
# estimated angle was off; none is taken in silence.
silent=
others=
for deck in input/*.deck; do
   name=$(basename "$deck" .deck)
   awk '/^LINK / { $0 = sprintf("%-64s0.0", substr($0, 1, 64)) } /^TIME/ { $0 = "TIME    1       " substr($0, 17) } !/^ASSEMBLY/' \
      "$deck" > "$w/poor.deck"
   sed "s/^END/$(card ASSEMBLY)\n&/" "$w/poor.deck" > "$w/near.deck"
   for one in poor near; do "$kinmat" --quiet -o "$w/$one" --csv "$w/$one.csv" "$w/$one.deck" 2> "$w/errors"; done
   awk -F , '!/,LINK,/ { next } FNR == NR { near[$1, $2, $5] = $6 " " $7 " " $8; next }
      $2 == 0 { split(near[$1, $2, $5], x, " "); far = far || ($6 - x[1])^2 + ($7 - x[2])^2 + ($8 - x[3])^2 > 1e-8 }
      END { exit !far }' "$w/near.csv" "$w/poor.csv" || continue
   others="$others $name"
   grep -qE 'THE ASSEMBLY FOUND DIFFERS FROM THE INITIAL ANGLE BY|KAT PRZYBLIZONY ODBIEGAL O' "$w/poor" || silent="$silent $name"
done
equal 'poor estimates: another assembly than the nearest' ' cognates grounds jansen peaucellier stephenson stephenson_output three_rrr watt_output yoke_mirrored' "$others"
equal 'poor estimates: none of them in silence' '' "$silent"

# Beside VARY a column with their number: none where the tip of the crank is less than 3.5 - 3 from the rocker's pivot, 1 at this
# limit, otherwise 2.
with stroke "$(card ASSEMBLY)" | sed "s/^POINT   A-CR .*/&\n$(card VARY R1 LIST '' 3.75 3.5 2.5)/" > "$w/vary.deck"
"$kinmat" --quiet --summary "$w/summary" "$w/vary.deck" > "$w/listing"
equal 'beside VARY' 'assemblies 0 1 2' "$(awk -F , 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "assemblies") k = i } { print $k }' "$w/summary" | xargs)"

# In the CSV a row for each assembly, as the LINK cards have it; the first is the row itself.
"$kinmat" --quiet --csv "$w/rows.csv" input/platform.deck > "$w/listing"
awk '/^ASSEM|^ ASSEM/ { n = $2 } n && /^LINK +PLATFORM/ { printf "%s %.6f %.6f %.5f\n", n, $3, $4, $5 }' "$w/listing" > "$w/rows"
awk -F , '$4 ~ /^LINK ASSEMBLY/ && $5 == "PLATFORM" { sub(/.* /, "", $4); printf "%s %.6f %.6f %.5f\n", $4, $6, $7, $8 }' "$w/rows.csv" > "$w/found"
same 'rows of the CSV' "$w/rows" "$w/found"
equal 'the chosen one' 1 "$(awk -F , '$5 == "PLATFORM" && $4 == "LINK" { first = sprintf("%.9f %.9f", $6, $8) }
   $5 == "PLATFORM" && $4 == "LINK ASSEMBLY 1" { print first == sprintf("%.9f %.9f", $6, $8) }' "$w/rows.csv")"

# Polish; two cards; a card that costs nothing where there is no listing.
with four_bar "$(card LANG PL)" "$(card ASSEMBLY)" > "$w/polish.deck"
equal 'in Polish' 'MONTAZE WYBRANY' "$("$kinmat" "$w/polish.deck" | grep -oE 'MONTAZE  |WYBRANY' | head -n 2 | tr -s ' \n' ' ' | sed 's/ $//')"
with four_bar "$(card ASSEMBLY)" "$(card ASSEMBLY)" > "$w/twice.deck"
equal 'two cards, in each of two sets' 2 "$("$kinmat" "$w/twice.deck" 2>&1 | grep -c E013)"
# A chain of four links on two pivots; two drives hold the first three of them at angles to one another, of 7 and of -13 rad
# or the other way round. Without the whole turns in these the positions are the same ones.
# held FROM-1 FROM-2: the deck; at_rest: the sines and cosines of the angles of its links, and how many assemblies it has
held() { card GROUND BASE; card LINK A '' '' 0.0 0.0 0.5; card LINK B '' '' 1.0 0.5 1.2; card LINK C '' '' 2.0 1.0 0.2; card LINK D '' '' 4.0 0.0 1.5
   card POINT O BASE; card POINT O1 A; card REVOLUTE O O1 PO; card POINT P A '' 2.0; card POINT P1 B; card POINT Q B '' 1.5; card POINT Q1 C; card POINT R C '' 1.0
   card POINT R1 D '' 3.0; card POINT S D; card POINT S1 BASE '' 4.0; card REVOLUTE P P1 PP; card REVOLUTE Q Q1 PQ; card REVOLUTE R R1 PR
   card REVOLUTE S S1 PS; card DRIVE RELANGLE A B "$1"; card DRIVE RELANGLE B C "$2"; card AT '' '' '' 0.0; card ASSEMBLY; card END; }
at_rest() { "$kinmat" --csv - -o "$w/out" "$w/deck" | awk -F, 'NR > 1 && $5 ~ /^[A-D]$/ { printf "%.8f %.8f ", sin($8), cos($8) }'
   sed -n 's/.* REAL \([0-9]*\).*/\1/p' "$w/out"; }
held 0.716814692820 -0.433629385641 > "$w/deck"
nearest=$(at_rest)
held 7.0 -13.0 > "$w/deck"
equal 'whole turns of two drives on one link' "$nearest" "$(at_rest)"
held -0.433629385641 0.716814692820 > "$w/deck"
nearest=$(at_rest)
held -13.0 7.0 > "$w/deck"
equal 'whole turns of two drives on one link, the other way round' "$nearest" "$(at_rest)"
# Without angles the estimate leads to another assembly than the nearest, which is taken; also if the first link moves.
awk '/^END/ { print "ASSEMBLY"; print; exit } /^LINK/ { $0 = substr($0, 1, 64) } /^TIME/ { $0 = sprintf("%-32s%s", "AT", "0.0") } 1' \
   input/yoke_mirrored.deck > "$w/ground_first.deck"
awk '/^GROUND/ { links = $0; next } /^LINK/ { links = $0 "\n" links; next } /^POINT/ && links != "" { print links; links = "" } 1' \
   "$w/ground_first.deck" > "$w/ground_later.deck"
for order in first later; do
   "$kinmat" "$w/ground_$order.deck" --no-listing --csv - | grep ',LINK,' | sort > "$w/ground_$order"
done
equal 'no angles: the rod of the nearest assembly' "$(awk 'BEGIN { s = (5 - 8/sqrt(5))/2; printf "%.6f", atan2(s, sqrt(1 - s*s))*180/atan2(0, -1) }')" \
   "$(awk -F, '$5 == "ROD" { printf "%.6f", $8 }' "$w/ground_first")"
same 'no angles: links in another order, the ground behind them' "$w/ground_first" "$w/ground_later"
# A number that fills its columns stands on a * card: -10.0 with 12 decimals would touch the number before it.
{ card UNITS M DEG S; card GROUND BASE; card LINK CRANK; card LINK COUPLER; card LINK ROCKER; card JOINT A0 BASE CRANK 0.0 -9.9999999999996
   card JOINT A CRANK COUPLER 1.0 -9.0; card JOINT B COUPLER ROCKER 3.0 -7.0; card JOINT B0 ROCKER BASE 4.0 -9.0
   card DRIVE ANGLE CRANK '' '' 1.0; card AT '' '' '' 0.0; card ASSEMBLY; card END; } > "$w/deck"
equal 'a number that fills its columns' '* 0.000000000000 -10.000000000000' "$(assemblies "$w/deck" | awk '/^JOINT   A0 / { getline; $1 = $1; print; exit }')"
# A parallelogram with a third crank at 40 deg. Redundant drives hold both other cranks beside the first; one is off by
# 1E-9 deg, which is rounding of the deck: there is one assembly.
{ card UNITS M DEG S; card GROUND BASE; card LINK CRANK '' '' 0.0 0.0 40.0; card LINK COUPLER '' '' 1.5 1.3
   card LINK MIDDLE '' '' 2.0 0.0 43.0; card LINK ROCKER '' '' 4.0 0.0 45.0
   for x in 0.0 2.0 4.0; do card POINT "A$x" BASE '' "$x"; card POINT "B$x" COUPLER '' "$x"; done
   for link in 'CRANK 0.0' 'MIDDLE 2.0' 'ROCKER 4.0'; do
      set -- $link
      card POINT "C$2" "$1"; card POINT "D$2" "$1" '' 2.0; card REVOLUTE "A$2" "C$2" "P$2"; card REVOLUTE "B$2" "D$2" "Q$2"
   done
   card DRIVE ANGLE CRANK '' 40.0; card DRIVE RELANGLE CRANK MIDDLE; card DRIVE RELANGLE CRANK ROCKER 1.0E-9
   card AT '' '' '' 0.0; card ASSEMBLY; card END; } > "$w/deck"
equal 'redundant drives that are rounded' 'REAL 1' "$(assemblies "$w/deck" | sed -n 's/.* \(REAL [0-9]*\).*/\1/p')"
conclude
