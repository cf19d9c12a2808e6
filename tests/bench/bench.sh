#!/bin/sh
# make bench: times as ratios measured in one run, then results compared; the last line counts the comparisons.
# make bench-short (bench.sh short): the comparisons alone, in few steps; no clock is looked at.
BUILD=${BUILD:-build}
decks=$BUILD/bench
bench=$BUILD/timed/bench
[ "$1" = short ] && bench=$BUILD/release/bench
mkdir -p "$decks" || exit 3
# OpenBLAS would start threads for matrices of three rows, and wait for them.
OPENBLAS_NUM_THREADS=${OPENBLAS_NUM_THREADS:-1}
export OPENBLAS_NUM_THREADS

# chain KIND N: the deck KIND_N.deck, if it is not there yet
chain() {
   deck=$decks/$1_$2.deck
   [ -s "$deck" ] && [ "$deck" -nt tests/make_deck ] && return
   tests/make_deck "$1" "$2" > "$deck.new" && mv "$deck.new" "$deck" || exit 3
}
for n in 1 10 30 1000; do chain windows $n; done
for n in 2 30 1000; do chain scissor $n; done
for n in 10 60 1000; do chain arm $n; done
for n in 3 5 7 15; do chain lattice $n; done
# It counts which library factors the matrices of METHOD MATRIX, of dense and of wide blocks.
libraries=$(ldd "$bench" 2> /dev/null | awk '/lapack|blas/ { print $3 }' | while read -r file; do
   readlink -f "$file" | sed 's/.*-linux-gnu[/]//'
done)
if [ "$1" = short ]; then
   "$bench" sines 100000 || exit 1
   exec "$bench" results "$decks" 24 input/*.deck
fi

for n in 100 10000; do chain windows $n; done
for n in 9 31; do chain lattice $n; done
echo " LIBRARIES:" $libraries
"$bench" steps || exit 3
"$bench" sines 10000000 || exit 1
"$bench" lanes "$decks" || exit 3
"$bench" chains "$decks" || exit 3
"$bench" results "$decks" 360 input/*.deck
