#!/bin/sh
# The pictures of the documents that the program draws: pictures.sh KINMAT DIRECTORY, from the directory of README.md.
# Drawn by hand: link_axes, prism, dyad, dead_change, circuit_branch and rise_laws.
kinmat=$1 to=$2
mkdir -p "$to" || exit 1
# draw DECK OPTION FILE: draws it also if an instant is flagged
draw() { "$kinmat" --no-listing --quiet "$2" "$to/$3.svg" < "$1" || [ $? -eq 2 ]; }
# first FILE: the first deck of a document
first() { awk '/^```deck/ { on = 1; next } /^```/ && on { exit } on' "$1"; }
deck=$(mktemp) notes=$(mktemp) || exit 1
trap 'rm -f "$deck" "$notes"' EXIT
first README.md > "$deck"; draw "$deck" --svg four_bar || exit 1
# The listing of the same deck, with notes.
while IFS='|' read -r line note; do printf '%s\t%s\n' "$line" "$note"; done > "$notes" << 'END'
KINEMATICS OF|
SET OF COMPUTATIONS|set and title

INPUT DATA|the cards with the values in use
^ GROUND|
^ LINK|
...|
^ STRUCTURE|
^ LINKS|what the deck has
^ COORDINATES|count: S equals DRIVES
ASSUR GROUPS|
DRIVEN|links moved by a drive
COUPLER  ROCKER|links solved together: a dyad

^ RESULTS|

^ INSTANT 0|time, value of the drive
^ POINT|position, velocity, acceleration
 M/S|units
^ C |
...|
^ CONTINUATION|every step is certified
^ END OF SET|no instant is flagged: exit status 0
END
sed '1a TITLE   FOUR-BAR LINKAGE' "$deck" | "$kinmat" | awk -v notes="$notes" -f docs/tools/listing.awk > "$to/listing.svg" || exit 1
first docs/tutorial.md > "$deck"; draw "$deck" --svg tutorial || exit 1
for name in yoke jansen cardan drawn_cylinder; do
   sed '/^END/q' "input/$name.deck" > "$deck"; draw "$deck" --svg "$name" || exit 1
done
for name in jansen cardan; do
   sed '/^END/q' "input/$name.deck" > "$deck"; draw "$deck" --animate "${name}_moving" || exit 1
done
draw input/triple_rocker.deck --circuits circuits || exit 1
# Each how-to has the picture of its first deck.
for page in docs/howto/*.md; do
   name=howto_$(basename "$page" .md)
   grep -q "/$name.svg" "$page" || continue
   option=--svg
   [ "$name" = howto_circuits ] && option=--circuits
   first "$page" > "$deck"; draw "$deck" "$option" "$name" || exit 1
done
