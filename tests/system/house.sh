#!/bin/sh
# The sources: a file uses only files of its own folder and of folders before it, as src/README.md lists them; only main
# stops or prints; lines and files keep their size.
. tests/counting.sh

sources=$(find src -name '*.f90' -o -name '*.F90' | LC_ALL=C sort)
# The folders in their order: the first cells of the table of src/README.md.
order=$(sed -n 's/^| `\([a-z]*\)\/` .*/\1/p' src/README.md | tr '\n' ' ')
equal 'folders of src/README.md' "$(ls -d src/*/ | sed 's/^src\/\(.*\)\/$/\1/' | LC_ALL=C sort | tr '\n' ' ')src " \
   "$(echo "$order" | tr ' ' '\n' | grep -v '^src$' | grep . | LC_ALL=C sort | tr '\n' ' ')src "
equal 'the order of the folders' '' "$(awk -v order="$order src" -f tests/system/folders.awk $sources)"
# The check sees what it is there for.
mkdir -p "$BUILD/order/src/base" "$BUILD/order/src/deck"
printf 'module a\n   use b\nend module a\n' > "$BUILD/order/src/base/a.f90"
printf 'module b\n   use c\nend module b\n' > "$BUILD/order/src/deck/b.f90"
printf 'module c\n   use b, only: x\nend module c\n' > "$BUILD/order/src/deck/c.f90"
equal 'an arrow the wrong way and a circle are found' 'base/a: USES deck/b,b: IN A CIRCLE' \
   "$(cd "$BUILD/order" && awk -v order='base deck' -f "$OLDPWD/tests/system/folders.awk" src/base/a.f90 src/deck/b.f90 src/deck/c.f90 |
   tr '\n' ',' | sed 's/,$//')"
equal 'tests that cannot be run' '' "$(find tests/system -name '*.sh' ! -perm -u=x)"
equal 'lines over 120 columns' '' "$(awk 'length > 120 { print FILENAME ":" FNR }' $sources $(find src -name '*.inc'))"
equal 'stop or print outside main' '' \
   "$(grep -nE '^ *((error +)?stop( |$)|print +[^=]*$|write *[(] *[*])' $sources | grep -v '^src/main.f90')"
equal 'files over 600 lines' '' "$(for file in $sources; do awk 'END { if (NR > 600) print FILENAME }' "$file"; done)"
equal 'src/README.md, where to add' '' "$(awk -f tests/system/where_to_add.awk src/README.md $sources)"
sed -e '/^| a remark about a deck/s/`[a-z]*\/mechanism`/`job`, `base\/none`/' src/README.md > "$BUILD/order/README.md"
equal 'src/README.md, where to add: what is not true is found' 'a remark about a deck: `base/none` is no file and no name of the sources
a remark about a deck: `job` does not name remark_jumps
a remark about a deck: `mechanism/mechanism` names remark_jumps' \
   "$(awk -f tests/system/where_to_add.awk "$BUILD/order/README.md" $sources | LC_ALL=C sort)"
# Sizes, and the limits that they keep: tests/system/sizes.txt.
equal 'sizes above their limits' '' "$(awk -v over=1 -v limits=tests/system/sizes.txt -f tests/system/sizes.awk $sources $(find src -name '*.inc'))"
mkdir -p "$BUILD/order/sizes"
cat > "$BUILD/order/sizes/a.f90" <<'CODE'
module a
   implicit none
   private
   public :: one_t, start, &
      go
   ! A comment, and four constants, of which one is no threshold.
   real(wp), parameter :: small = 1.0e-9_wp, list(2) = [1.0_wp, 2.0_wp], other = small
   real(wp), parameter :: rounding = 8*epsilon(1.0_wp)
   type :: one_t
      integer :: n = 0
   end type one_t
contains
   subroutine start()
      call go()
      call go()
   end subroutine start
   subroutine go()
   end subroutine go
end module a
CODE
sed -e 's/module a/module b/' -e 's/call go/call stop_here/' "$BUILD/order/sizes/a.f90" > "$BUILD/order/sizes/b.f90"
printf 'all 36\nsizes 35\ntypes 2\nthresholds 6\npublic 6\ntwice 1\nsmall 0\n' > "$BUILD/order/sizes.txt"
equal 'sizes above their limits are found' "lines of code in src/sizes/: 36, at most 35 ($BUILD/order/sizes.txt)
procedures of at most 20 lines with one caller in src/: 1, at most 0 ($BUILD/order/sizes.txt)" \
   "$(awk -v over=1 -v limits="$BUILD/order/sizes.txt" -f tests/system/sizes.awk "$BUILD"/order/sizes/[ab].f90)"
equal 'procedures without a head comment' '' "$(awk -f tests/system/heads.awk $sources $(find src -name '*.inc'))"
printf '   !> Doc.\n   pure function a(x)\n   end function a\n\n   real(wp) function b(x, &\n      y)\n      integer :: x\n' > "$BUILD/order/heads.f90"
equal 'a procedure without a head comment is found' "$BUILD/order/heads.f90:5: real(wp) function b(x, &" \
   "$(awk -f tests/system/heads.awk "$BUILD/order/heads.f90")"
# Each dummy has its meaning, unit and shape where it is declared, but for interfaces of LAPACK and these files.
explained=$(find src -name '*.f90' -o -name '*.F90' -o -name '*.inc' | LC_ALL=C sort | grep -v lapack_routines)
equal 'dummies without their meaning' '' "$(awk -f tests/system/dummies.awk $explained)"
printf '      integer, intent(in) :: a !< One.\n      real(wp), intent(in) :: b\n      type(x_t), intent(in) :: c\n' > "$BUILD/order/dummies.f90"
equal 'a dummy without its meaning is found' "$BUILD/order/dummies.f90:2:       real(wp), intent(in) :: b" \
   "$(awk -f tests/system/dummies.awk "$BUILD/order/dummies.f90")"
# Dummies of one letter: the table of src/README.md. Interfaces of LAPACK keep the letters of its documentation.
equal 'dummies of one letter that mean something else' '' "$(awk -f tests/system/letters.awk src/README.md $explained)"
printf '      integer, intent(in) :: i, m, &\n         long\n      type(motion_t), intent(in) :: q(:, :), x\n' > "$BUILD/order/letters.f90"
equal 'a letter that means something else is found' "$BUILD/order/letters.f90:1: m is no letter for integer
$BUILD/order/letters.f90:3: x is no letter for motion_t" "$(awk -f tests/system/letters.awk src/README.md "$BUILD/order/letters.f90")"
equal 'tabs' '' "$(grep -ln "$(printf '\t')" $sources)"
# pFUnit writes procedures and variables of these names around every suite.
equal 'names that hide those of pFUnit' '' "$(awk '
   FNR == 1 { inside = 0 }
   /^contains/ { inside = 1 }
   /(subroutine|function) (run|test|suite|initialize|finalize|throw) *[(]/ && !/^ *(!|end)/ { print FILENAME ":" FNR }
   /^ *use .*only:/ && /[:,] *(run|test|suite|initialize|finalize|throw) *(,|$)/ { print FILENAME ":" FNR }
   !inside && /parameter ::.*[ ,]t = / { print FILENAME ":" FNR }' $(find tests -name 'test_*.pf'))"
# make in a directory whose name holds blanks; where it cannot be, it is said. Without the variables of the make above.
plain_make() { env -u MAKEFLAGS -u MFLAGS -u MAKELEVEL make --no-print-directory "$@"; }
blanks="$BUILD/with a blank"
rm -rf "$blanks"
mkdir -p "$blanks" && cp -R Makefile src tests input "$blanks/" && mkdir "$blanks/docs" && cp -R docs/tools "$blanks/docs/" && chmod -R u+w "$blanks" || exit 3
(cd "$blanks" && plain_make FC="${FC:-gfortran}" BUILD=built built/debug/cards.o) > "$BUILD/blanks.txt" 2>&1
equal 'make below a directory with blanks: status' 0 $?
# A short line a file; make -s prints none, make V=1 whole commands.
equal 'make: a line a file' 'FC deck/cards.f90 (debug)' "$(sort -u "$BUILD/blanks.txt" | grep cards)"
equal 'make: no other line' '' "$(grep -vE '^FC [a-z]+/[a-z_]+[.][fF]90 [(]debug[)]$' "$BUILD/blanks.txt")"
rm "$blanks/built/debug/cards.o"
equal 'make -s prints nothing' '' "$(cd "$blanks" && plain_make -s FC="${FC:-gfortran}" BUILD=built built/debug/cards.o 2>&1)"
rm "$blanks/built/debug/cards.o"
equal 'make V=1 prints whole commands' 1 \
   "$(cd "$blanks" && plain_make V=1 FC="${FC:-gfortran}" BUILD=built built/debug/cards.o 2>&1 | grep -c -- ' -o built/debug/cards.o src/deck/cards.f90$')"
equal 'make below a directory with blanks: its object' yes "$([ -s "$blanks/built/debug/cards.o" ] && echo yes)"
equal 'a build directory with blanks is refused' 1 "$(plain_make -n BUILD="$PWD/a b" all 2>&1 | grep -c ' holds blanks')"
rm -rf "$blanks"
# make test: a part that looks at nothing, at too little, or ends without its counts, fails.
cat > "$BUILD/some_parts.txt" <<'PARTS'
good|2|echo '2 passed, 0 failed'
empty|0|echo '0 passed, 0 failed'
few|3|echo '2 passed, 0 failed'
silent|1|true
PARTS
PARTS="$BUILD/some_parts.txt" BUILD="$BUILD/some_parts" tests/run.sh > "$BUILD/some_parts.out" 2>&1
equal 'parts without checks: status' 1 $?
equal 'parts without checks' \
   'FAILED: empty has looked at nothing,FAILED: few has 2 checks, not 3 or more,FAILED: silent has looked at nothing,4 passed, 3 failed' \
   "$(grep -vE '^[02] passed' "$BUILD/some_parts.out" | tr '\n' ',' | sed 's/,$//')"
for file in $sources; do
   equal "$file: module of that name" "$(basename "${file%.?90}")" \
      "$(sed -n 's/^\(module\|program\) \([a-z_0-9]*\)$/\2/p' "$file" | head -n 1)"
done
conclude
