#!/bin/sh
# The shared library: its symbols, its numbers against `kinmat --table`, threads, and calls that have a fault.
. tests/counting.sh

"${MAKE:-make}" --no-print-directory BUILD="$BUILD" shared > "$w/out" 2>&1
equal 'make shared: status' 0 $?
LD_LIBRARY_PATH=$BUILD
LIBKINMAT=$BUILD/libkinmat.so.2
export LD_LIBRARY_PATH LIBKINMAT
equal 'symbols of the library' "$(grep -oE '^[a-z].*[*]kinmat_[a-z]+|^(int|void|kinmat) .*kinmat_[a-z]+[(]' contrib/kinmat.h | grep -oE 'kinmat_[a-z]+' | sort)" \
   "$(nm -D --defined-only "$LIBKINMAT" | sed 's/.* //' | sort)"
gcc -std=c99 -Wall -Wextra -pedantic -Werror -O1 -Icontrib -o "$w/library" tests/library/library.c "$LIBKINMAT" -lpthread -lm > "$w/err" 2>&1
equal 'a program in C is compiled' '' "$(cat "$w/err")"
printf '#include "kinmat.h"\nint main() { return kinmat_version() == 0; }\n' > "$w/header.cpp"
if command -v g++ > /dev/null; then equal 'the header in C++' '' "$(g++ -Wall -Wextra -pedantic -fsyntax-only -Icontrib "$w/header.cpp" 2>&1)"; fi

# Every deck of one set without VARY: the same bytes as --table, and the same status.
decks=$(grep -c '^END' input/*.deck | sed -n 's/:1$//p' | xargs grep -L '^VARY')
for deck in $decks; do
   "$kinmat" --no-listing --quiet --table "$w/table" "$deck" > "$w/out" 2> "$w/err"
   status=$?
   "$w/library" table "$deck" > "$w/found" 2> "$w/err"
   equal "$deck: status" "$status" $?
   if cmp -s "$w/table" "$w/found"; then pass; else miss "$deck: the table"; diff "$w/table" "$w/found" | head -n 4; fi
done
equal 'decks are compared' yes "$([ "$(echo "$decks" | wc -l)" -ge 50 ] && echo yes)"

# Decks that are rejected: the message of the command.
with four_bar "$(card POINT X NOWHERE)" > "$w/label.deck"
grep -v '^DRIVE' input/four_bar.deck > "$w/loose.deck"
printf 'A\rB\n' > "$w/return.deck"
: > "$w/empty.deck"
for deck in label loose empty; do
   ends "$deck: it is rejected" 1 "$w/$deck.deck"
   "$w/library" table "$w/$deck.deck" > "$w/found"
   equal "$deck: status" 1 $?
   equal "$deck: message" "$(sed '1s/^ [*]* //' "$w/err")" "$(sed '1s/^ [*]* //' "$w/found")"
done
equal 'a carriage return: message' 'THE TEXT IS NOT A DECK: LINE 1 HAS A CARRIAGE RETURN INSIDE; END LINES WITH LF OR CR-LF' \
   "$("$w/library" table "$w/return.deck")"
{ printf '\357\273\277'; sed 's/$/\r/' input/four_bar.deck; } > "$w/marked.deck"
equal 'a text with a byte order mark and CR-LF' "$("$w/library" table input/four_bar.deck | cksum)" "$("$w/library" table "$w/marked.deck" | cksum)"
equal 'a set with VARY cards' 'THE LIBRARY TAKES NO SET WITH VARY CARDS: CHANGE THE TEXT OF THE DECK' "$("$w/library" table input/crank_rockers.deck)"
"$w/library" calls input/four_bar.deck "$w/label.deck" > "$w/found"
cat > "$w/expected" <<'END'
version KINMAT 2.0
read 0 ''
instants 1
columns 35 none none
later 0
earlier 1 NaN
not a number 1
infinite 1
again 0 as before
set -1: 1 'THE DECK HAS NO SET OF THIS NUMBER'
set 2: 0 ''
rejected: columns 0, column none, instants 0, advance 1
null: 1 ' *** E001  THE DECK IS EMPTY'
null: 'NOT ENOUGH MEMORY' columns 0, advance 1
END
same 'calls with a fault' "$w/expected" "$w/found"

# Four threads; blocks of the nets are solved by KLU.
tests/make_deck lattice 5 18 > "$w/net_5.deck"
tests/make_deck lattice 7 18 > "$w/net_7.deck"
"$w/library" threads 4 "$w/net_5.deck" "$w/net_7.deck" \
   $(ls $decks | grep -E '(ten_plates|andrews|jansen|yoke|geneva|scissor|three_rrr|platform|guide_tolerances|excavator)') \
   "$w/label.deck" "$w/loose.deck" > "$w/found"
equal 'four threads' '0 differ' "$(sed 's/.*, //' "$w/found")"

# Four threads with one structure and one geometry, and states of their own.
"${FC:-gfortran}" -std=f2018 -Wall -Wextra -pedantic -Werror -fopenmp -O1 -fno-lto -fno-use-linker-plugin -I"$BUILD/release" -J"$w" \
   -o "$w/one_structure" tests/library/threads.f90 "$BUILD/release/libkinmat.a" -lklu -llapack -lblas > "$w/err" 2>&1
equal 'a program of four threads is compiled' '' "$(cat "$w/err")"
for deck in input/four_bar.deck input/scissor.deck input/ten_plates.deck "$w/net_7.deck"; do
   equal "four threads with one structure: $deck" '4 threads, 0 differ' \
      "$("$w/one_structure" "$deck" 2>&1 | sed 's/ of [1-9][0-9]* numbers//')"
done

# kinmat.py, with numpy and without.
for lists in '' --lists; do
   if [ -z "$lists" ] && ! python3 -c 'import numpy' 2> /dev/null; then echo 'skipped: kinmat.py with numpy (not installed)'; continue; fi
   equal "kinmat.py $lists" '' "$(PYTHONDONTWRITEBYTECODE=1 python3 tests/library/kinmat_test.py $lists "$kinmat" input/jansen.deck \
      input/cylinder.deck input/stroke.deck input/ten_plates.deck 2>&1)"
done

# Without memory for a deck: status 3, and the process goes on.
tests/make_deck windows 3000 1 > "$w/long.deck"
equal 'a deck without memory for it' "3 'NOT ENOUGH MEMORY' 0
0 ''" "$("$w/library" memory "$w/long.deck" 2>&1)"

# Nothing is lost, and nothing is used that was not set.
if command -v valgrind > /dev/null; then
   valgrind -q --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite,indirect,possible \
      "$w/library" reads 6 input/jansen.deck "$w/label.deck" "$w/net_5.deck" > "$w/found" 2> "$w/err"
   equal 'memory of the library, by valgrind' '' "$(cat "$w/err")"
else
   echo 'skipped: the memory of the library (no valgrind)'
fi
conclude
