#!/bin/sh
# The tool behind `make mutants`: the changes that it makes of a few lines, and what it says of five mutants of a small program.
. tests/counting.sh
tiny=$w
mkdir -p "$tiny/src/base" "$tiny/docs" "$tiny/input" "$tiny/expected" "$tiny/tests/mutants" "$tiny/tests/system" || exit 3

# Strings, comments, use statements, headings and declarations stay.
cat > "$tiny/sample.f90" <<'FORTRAN'
module m
   use k, only: a => b
   real, parameter :: c = 0.5
   character(9) :: form = '(i0, 2x)' ! 1 + 1
contains
   pure integer function f(x)
      integer, intent(in) :: x(2)
      do i = 1, size(x) - 1
         if (x(i) >= 3 .and. .not. d) exit ! a < b
         f = max(f, -x(i), &
            i*2)
      end do
      write (*, '(a)') '1 + 1'
   end function f
end module m
FORTRAN
cat > "$tiny/changes.txt" <<'CHANGES'
3|3|real, parameter :: c = (2*0.5)
8|8|do i = 1 + 1, size(x) - 1
8|8|do i = 1, size(x) - 1 - 1
8|8|do i = 2, size(x) - 1
8|8|do i = 0, size(x) - 1
8|8|do i = 1, size(x) + 1
8|8|do i = 1, size(x) - 2
8|8|do i = 1, size(x) - 0
9|9|
9|9|if (.not. (x(i) >= 3 .and. .not. d)) exit ! a < b
9|9|if (x(i) > 3 .and. .not. d) exit ! a < b
9|9|if (x(i) < 3 .and. .not. d) exit ! a < b
9|9|if (x(i) >= 4 .and. .not. d) exit ! a < b
9|9|if (x(i) >= 2 .and. .not. d) exit ! a < b
9|9|if (x(i) >= 3 .or. .not. d) exit ! a < b
9|9|if (x(i) >= 3 .and. d) exit ! a < b
9|9|if (x(i) >= 3 .and. .not. d) cycle ! a < b
10|11|
10|10|f = min(f, -x(i), &
10|10|f = max(f, x(i), &
11|11|i/2)
11|11|i*3)
11|11|i*1)
CHANGES
awk -v all=1 -f tests/mutants/mutate.awk "$tiny/sample.f90" | cut -f 3,4,6 | tr '\t' '|' > "$tiny/found.txt"
same 'the changes of a few lines' "$tiny/changes.txt" "$tiny/found.txt"

# A choice is the same every time; another seed makes another one; each line is changed once at most.
choice() { awk -v seed="$1" -v wanted=4 -f tests/mutants/mutate.awk "$tiny/sample.f90" | sort -n; }
equal 'a choice comes again' "$(choice 1)" "$(choice 1)"
equal 'another seed' different "$([ "$(choice 1)" = "$(choice 2)" ] && echo the same || echo different)"
equal 'lines are changed once' '' "$(choice 1 | cut -f 3 | sort | uniq -d)"

# A program of which one statement is held by an assertion, one by a run-time trap, one by a listing, one by nothing, and one
# without which it never ends.
cat > "$tiny/src/base/tiny.f90" <<'FORTRAN'
module tiny
   implicit none
   integer :: held, trapped, listed, free, last
contains
   subroutine set_all()
      held = 2
      trapped = 2
      listed = 2
      free = 2
      last = 2
   end subroutine set_all
end module tiny
FORTRAN
cat > "$tiny/tests/unit.f90" <<'FORTRAN'
program unit
   use tiny
   implicit none
   call set_all()
   if (held /= 2) print '(a)', 'Failure in: held', '0 passed, 1 failed'
   if (trapped /= 2) error stop
   do while (last /= 2)
   end do
   if (held == 2) print '(a)', '1 passed, 0 failed'
end program unit
FORTRAN
cat > "$tiny/src/main.f90" <<'FORTRAN'
program main
   use tiny
   implicit none
   call set_all()
   print '(i0)', listed
end program main
FORTRAN
cat > "$tiny/tests/system/check.sh" <<'SHELL'
#!/bin/sh
if [ "$("$BUILD/kinmat")" = 2 ]; then echo '1 passed, 0 failed'; else echo 'FAILED: listed'; exit 1; fi
SHELL
cat > "$tiny/Makefile" <<'MAKE'
$(BUILD)/debug/tiny.o: src/base/tiny.f90
	mkdir -p $(@D) $(BUILD)/tests
	$(FC) -J$(@D) -c -o $@ $<
%/libkinmat.a: %/tiny.o
	ar cr $@ $<
$(BUILD)/tests/unit: tests/unit.f90 $(BUILD)/debug/libkinmat.a
	$(FC) -I$(BUILD)/debug -o $@ $^
$(BUILD)/debug/kinmat: src/main.f90 $(BUILD)/debug/libkinmat.a
	$(FC) -I$(BUILD)/debug -o $@ $^
MAKE
: > "$tiny/README.md"
: > "$tiny/expected/none.lst"
# What `make mutants` builds before: the closed forms' printer.
mkdir -p "$tiny/build/release" && : > "$tiny/build/release/print_expected"
chmod +x "$tiny/tests/system/check.sh"
cp tests/mutants/* "$tiny/tests/mutants/"
echo tests/system/check.sh > "$tiny/parts"
(cd "$tiny" && PARTS=parts BUILD=build N=5 SEED=1 UNIT_TIME=1 FC="${FC:-gfortran}" FILES=src/base/tiny.f90 tests/mutants/mutants.sh) > "$tiny/said.txt" 2>&1
equal 'five mutants: the last line' '5 mutants: 4 killed (1 by unit tests'"'"' assertions, 2 by run-time traps alone, 1 by listings alone), 1 survive' \
   "$(tail -n 1 "$tiny/said.txt")"
equal 'the one that never ends' 'Killed by time: 1, counted as traps. Equivalent survivors: 0.' "$(grep '^Killed' "$tiny/said.txt")"
equal 'the survivor' 'SURVIVES src/base/tiny.f90:9' "$(grep '^SURVIVES' "$tiny/said.txt")"
equal 'what has seen a fault' 'assertion: held' "$(sed -n 's/^[0-9]*: \(assertion.*\): src.*/\1/p' "$tiny/said.txt")"
echo 'src/base/tiny.f90|listed = 2|listed = 1' > "$tiny/only.txt"
(cd "$tiny" && PARTS=parts BUILD=build N=5 ONLY=only.txt FC="${FC:-gfortran}" tests/mutants/mutants.sh) > "$tiny/said.txt" 2>&1
equal 'one change alone' '1: listing: tests/system/check.sh: listed: src/base/tiny.f90:8: {listed = 2} -> {listed = 1}' "$(head -n 1 "$tiny/said.txt")"
equal 'the sources are as they were' 'held = 2' "$(sed -n 's/^ *\(held = .*\)/\1/p' "$tiny/src/base/tiny.f90")"
conclude
