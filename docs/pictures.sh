#!/bin/sh
# The pictures of the documents: pictures.sh KINMAT DIRECTORY, from the directory of README.md.
kinmat=$1 to=$2
mkdir -p "$to" || exit 1
awk '/^```deck/ { on = 1; next } /^```/ && on { exit } on' README.md | "$kinmat" --no-listing --svg "$to/four_bar.svg" || exit 1
for name in yoke jansen cardan platform; do
   sed '/^END/q' "input/$name.deck" | "$kinmat" --no-listing --svg "$to/$name.svg" || exit 1
done
for name in jansen cardan; do
   sed '/^END/q' "input/$name.deck" | "$kinmat" --no-listing --animate "$to/${name}_moving.svg" || exit 1
done
"$kinmat" --no-listing --circuits "$to/circuits.svg" input/triple_rocker.deck
