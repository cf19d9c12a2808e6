#!/bin/sh
# make hard: errors in units of what the condition allows, a line a scene; make hard-short (hard.sh short): in fewer instants
# and without the longest chain. The last line is `N passed, N failed`.
BUILD=${BUILD:-build}
decks=$BUILD/hard
mkdir -p "$decks" || exit 3
for n in 50 200 1000; do
   tests/make_deck scissor $n > "$decks/scissor_$n.deck" || exit 3
done
exec "$BUILD/release/hard" "$1" "$decks" input/*.deck
