#!/bin/sh
# Card ASSEMBLY and runs, as relations: the position that a run finds at the first instant is among the assemblies listed, or the
# listing says that some may be missing; each assembly, pasted, is the first instant of a run; equations that say again what
# others say leave the assemblies that there are without them. A run begins in the nearest assembly, or the listing says that a
# nearer one may exist.
#
#    assembly_relations.sh                          every set of input/, 20 random decks with redundant equations, 500 of dyads
#    assembly_relations.sh --random COUNT [FIRST]   COUNT of these, from seed FIRST on; decks that fail are kept
#    assembly_relations.sh --nearest COUNT [FIRST]  COUNT chains of random dyads
. tests/counting.sh
# Of the largest coordinate, or rad.
level=1e-9
# So many assemblies of a mechanism are pasted.
most=8

# solve NAME: the run of $w/NAME.deck
solve() { "$kinmat" --quiet "$w/$1.deck" --csv "$w/$1.csv" -o "$w/$1.lst" 2> "$w/$1.err"; }

# rows MODE FILE OTHER ASSIGNMENT...: what assembly_rows.awk says of two runs
rows() {
   mode=$1; file=$2; other=$3
   shift 3
   for one in "$@"; do set -- "$@" -v "$one"; shift; done
   awk -v mode="$mode" -v level="$level" "$@" -f tests/system/assembly_rows.awk "$w/$file.lst" "$w/$file.csv" "$w/$other.lst" "$w/$other.csv"
}

# cards FILE MECHANISM K: the LINK, JOINT and DRIVE cards of an assembly
cards() {
   awk -v c="$2" -v k="$3" '
      BEGIN { mechanism = 1 }
      /^ INDEPENDENT MECHANISM/ { mechanism = $3; on = 0 }
      /^ (ASSEMBLY|CONTINUATION:) / { on = /ASSEMBLY/ && mechanism == c && $2 == k }
      on && /^(LINK|JOINT|DRIVE|\*) /' "$w/$1.lst"
}

# relate NAME DECK SET: the relations of one set
relate() {
   awk -v set="$3" -v assembly=1 -f tests/system/initial_assembly.awk "$2" > "$w/all.deck"
   awk -v set="$3" -f tests/system/initial_assembly.awk "$2" > "$w/run.deck"
   solve all
   solve run
   equal "$1 is read" '' "$(cat "$w/all.err" "$w/run.err")"
   equal "$1: the first position is listed" '' "$(rows first all run)"
   # Where redundant equations contradict one another nothing is proved.
   if grep -q 'REDUNDANT EQUATIONS ARE INCONSISTENT' "$w/run.lst"; then
      equal "$1: nothing is proved where equations contradict one another" 0 \
         "$(awk '/^ INDEPENDENT MECHANISM/ { on = 0 } /INCONSISTENT/ && /LINK/ { on = 1 } on && /   PROVED/' "$w/all.lst" | grep -c .)"
   fi
   for pair in $(awk -v most=$most 'BEGIN { c = 1 } /^ INDEPENDENT MECHANISM/ { c = $3 }
      /^ ASSEMBLY / && $2 <= most { print c ":" $2 }' "$w/all.lst"); do
      cards all "${pair%:*}" "${pair#*:}" > "$w/cards"
      awk -v set=1 -v cards="$w/cards" -f tests/system/initial_assembly.awk "$w/run.deck" > "$w/pasted.deck"
      solve pasted
      equal "$1: mechanism ${pair%:*}, assembly ${pair#*:}, pasted" '' \
         "$(cat "$w/pasted.err"; rows taken all pasted mechanism_taken="${pair%:*}" k_taken="${pair#*:}")"
   done
}

# random COUNT FIRST
random() {
   : > "$w/missing"
   for seed in $(seq "$2" $(($2 + $1 - 1))); do
      "$BUILD/release/fuzz_mechanisms" --surplus "$seed" "$w/plain_deck" "$w/deck" || exit 3
      failed_before=$(grep -c failed "$counts")
      relate "seed $seed" "$w/deck" 1
      # A coordinate that is held besides may leave out some; numbers of 12 digits move places.
      awk -v set=1 -v assembly=1 -f tests/system/initial_assembly.awk "$w/plain_deck" > "$w/plain.deck"
      solve plain
      held() { grep -cE '^DRIVE   [XY] ' "$w/$1"; }
      all=$([ "$(held deck)" -eq "$(held plain_deck)" ] && echo 1 || echo 0)
      equal "seed $seed: with and without redundant equations" '' "$(level=1e-6; rows among all plain all="$all")"
      grep -qE 'MAY BE MISSING|NOT ALL SOLUTIONS ARE SEPARATE|TOO MANY UNKNOWNS' "$w/all.lst" && echo "$seed" >> "$w/missing"
      [ "$(grep -c failed "$counts")" -gt "$failed_before" ] && cp "$w/deck" "$w/$seed.deck"
   done
   equal 'some may be missing: in few decks only' yes "$([ $((50*$(grep -c . "$w/missing"))) -le "$1" ] && echo yes)"
}

# nearest COUNT FIRST: the assemblies in which runs of random dyads begin, by DISTANCE; seed = FIRST - 1 + number of the set
nearest() {
   for assembly in '' 1; do
      awk -v first="$2" -v sets="$1" -v assembly=$assembly -f tests/system/random_dyads.awk > "$w/${assembly:-run}.deck"
      solve "${assembly:-run}"
   done
   awk -f tests/system/nearest.awk "$w/run.deck" "$w/1.lst" "$w/1.csv" "$w/run.lst" "$w/run.csv" > "$w/found"
   equal 'dyads: each begins in the nearest assembly, or says that a nearer one may exist' '' "$(sed '$d' "$w/found")"
   set -- "$1" $(tail -n 1 "$w/found")
   equal 'dyads: most are compared' yes "$([ $((100*$2)) -ge $((95*$1)) ] && echo yes)"
   equal 'dyads: some begin in another one' yes "$([ "$3" -gt 0 ] && [ $((10*$3)) -le "$2" ] && echo yes)"
   equal 'dyads: at most 1 of 100 says so needlessly' yes "$([ $((100*$4)) -le "$2" ] && echo yes)"
}

# first_instants: decks with the places and angles of their nearest assemblies, which another program found
first_instants() {
   while read -r deck link x y phi; do
      "$kinmat" --quiet "tests/system/decks/$deck.deck" --csv "$w/first.csv" -o "$w/first.lst"
      equal "$deck, $link: the first instant" '' "$(awk -F , -v link="$link" -v x="$x" -v y="$y" -v phi="$phi" -v level=$level '
         function off(a, b) { a -= b; b = (b < 0 ? -b : b) + 1; return (a < 0 ? -a : a) > level*b }
         $2 == 0 && $4 == "LINK" && $5 == link { found = 1; if (off($6, x) || off($7, y) || off($8, phi)) print $6, $7, $8 }
         END { if (!found) print "not found" }' "$w/first.csv")"
      equal "$deck: nothing is said of a nearer one" 0 "$(grep -c 'A NEARER ASSEMBLY' "$w/first.lst")"
   done < tests/system/decks/first_instants.txt
}

case $1 in
--random) random "$2" "${3:-1}" ;;
--nearest) nearest "$2" "${3:-1}" ;;
*)
   for deck in input/*.deck; do
      for set in $(seq "$(grep -c '^END' "$deck")"); do relate "$(basename "$deck" .deck) $set" "$deck" "$set"; done
   done
   random 20 1
   nearest 500 1
   first_instants ;;
esac
conclude
