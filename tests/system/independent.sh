#!/bin/sh
# A mechanism's numbers do not depend on what else is in its deck: alone, and beside a copy of 1E-12, 1E-6, 1E6 and 1E12
# times its size, before it or after it in the deck, its rows in the CSV are the same bytes, with their errors.
. tests/counting.sh

# mechanism NAME: a deck of input/, some of them changed
mechanism() {
   case $1 in
   limit) sed "s/^TIME .*/$(card TIME 8 '' '' 0.0 8.0)/" input/triple_rocker.deck ;;
   branch) sed '/^BRANCH   /d' input/parallelogram_branch.deck ;;
   at_start) sed 's/\([ 2]\)20[.]0\( \|$\)/\10.0\2/' input/parallelogram_at.deck ;;
   # One of three parallel cranks is a tenth too long.
   contradiction) sed 's/^\(POINT   C-CR .*\)1.5 /\11.65/' input/parallel_cranks.deck ;;
   *) cat "input/$1.deck" ;;
   esac
}
# marked NAME MARK POWER: the cards of a mechanism, its lengths times 10**POWER, its names with MARK behind them
marked() {
   mechanism "$1" | awk -v long="$3" -f tests/system/other_units.awk | awk -v mark="$2" '
      function name(column,   text) {
         text = substr($0, column, 8)
         sub(/ +$/, "", text)
         return sprintf("%-8s", text (text == "" ? "" : mark))
      }
      /^END/ { exit }
      /^(GROUND|LINK|POINT|REVOLUTE|PRISM)/ { print substr($0, 1, 8) name(9) name(17) name(25) substr($0, 33) }
      /^DRIVE/ { print substr($0, 1, 16) name(17) name(25) substr($0, 33) }
      /^BRANCH/ { print substr($0, 1, 8) name(9) substr($0, 17) }
      /^(ADD|[*])/'
}
# deck: the mechanisms on standard input, one a line: NAME MARK POWER; units and times are those of the last, in nine
# steps, which end on the change point of parallelogram_at
deck() {
   card METHOD "${method:-NEWTON}"
   while read -r name mark power; do
      marked "$name" "$mark" "$power"
      last=$name
   done
   mechanism "$last" | awk '/^UNITS/ { print } /^TIME/ { print "TIME    9       " substr($0, 17) } /^END/ { exit }'
   card PRINT ALL
   card END
}

# rows FILE MARK: the rows of one mechanism, its mark left out
rows() { grep "^[^,]*,[^,]*,[^,]*,[A-Z]*,[A-Z0-9-]*$2," "$1" | sed "s/^\([^,]*,[^,]*,[^,]*,[A-Z]*,[A-Z0-9-]*\)$2,/\1,/"; }

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
for name in limit parallelogram_at parallel_cranks; do beside $name -12; beside $name +06; done
for name in branch at_start contradiction cylinder dead_point_9; do beside $name -06; done
for method in DENSE MATRIX; do beside four_bar -12; beside limit +06; done
method=NEWTON

# The listing: each has its own power of ten, so that the small one has its seven digits too.
printf '%s\n' 'four_bar + +00' 'four_bar - -12' | deck > "$w/two.deck"; run "$w/two"
equal 'the large one of two' ' ROCKER+     4.000000' "$(grep -m 1 '^ ROCKER+ ' "$w/two.lst" | cut -c 1-21)"
equal 'the small one of two' ' ROCKER-     4.000000' "$(grep -m 1 '^ ROCKER- ' "$w/two.lst" | cut -c 1-21)"
equal 'its power of ten' '               1.E-12      1.E-12                  1.E-12      1.E-12                  1.E-12      1.E-12' \
   "$(grep -m 1 ' 1[.]E' "$w/two.lst")"
equal 'lines over 120 columns' '' "$(awk 'length > 120' "$w/two.lst")"

# One that is at its limit, or that contradicts itself, flags the instant, and not the rows of the other.
printf '%s\n' 'four_bar + +00' 'contradiction - -10' | deck > "$w/gap.deck"; run "$w/gap"
equal 'a contradiction in a small mechanism: status' 2 "$("$kinmat" "$w/gap.deck" -o "$w/gap.lst"; echo $?)"
equal 'a contradiction in a small mechanism: marks' '10 OPEN' \
   "$(rows "$w/gap.csv" - | awk -F, '$5 == "COUPLER" { n[$15]++ } END { for (k in n) print n[k], k }')"
equal 'a contradiction in a small mechanism: the other' '10 ' \
   "$(rows "$w/gap.csv" + | awk -F, '$5 == "COUPLER" { n[$15]++ } END { for (k in n) print n[k], k }')"

# Redundant cranks a millionth as large on a link of a large mechanism: a tenth too long is open, and by nothing is not.
# on_a_large_link NAME: three cranks on the coupler of a four-bar linkage
on_a_large_link() {
   card UNITS M DEG S
   marked four_bar + +03
   marked "$1" = -03 | sed -e '/^GROUND/d' -e 's/BASE=   /COUPLER+/' \
      -e "s/^DRIVE.*/$(card DRIVE RELANGLE COUPLER+ CRANK-1= 30.0 60.0)/"
   card TIME 2 '' '' 0.0 1.0
   card PRINT ALL
   card END
}
on_a_large_link parallel_cranks > "$w/fits.deck"; run "$w/fits"
equal 'small cranks on a large link: solved' ' END OF SET 1:  INSTANTS SOLVED 3, FLAGGED 0' "$(grep 'END OF SET' "$w/fits.lst")"
on_a_large_link contradiction > "$w/open.deck"; run "$w/open"
equal 'small cranks on a large link, one too long' ' *** REDUNDANT EQUATIONS ARE INCONSISTENT' \
   "$(grep -m 1 'INCONSISTENT' "$w/open.lst")"

# A point in no pair changes no digit of the links.
sed '/^END/q' input/four_bar.deck > "$w/near.deck"
sed 's/^\(POINT   C .*\)1.75/\1475.0/' "$w/near.deck" > "$w/far.deck"
for deck in near far; do
   "$kinmat" "$w/$deck.deck" --csv "$w/$deck.csv" > "$w/out"
   grep LINK "$w/$deck.csv" > "$w/$deck.rows"
done
same 'a point far away, in no pair' "$w/near.rows" "$w/far.rows"
equal 'a point far away: it is far' 39 "$(grep -c 'POINT,C,[-0-9.]*E+002' "$w/far.csv")"
conclude
