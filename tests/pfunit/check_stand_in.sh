#!/bin/sh
# Tests the stand-in for pFUnit (pf2f90, funit.F90, tests.mk): what fails must be seen to fail.
#   check_stand_in.sh [DIRECTORY]   works in DIRECTORY (default: a temporary one, removed afterwards)
# With PFUNIT_DIR set the installed pFUnit runs the same files and its reports are compared.
# A path as it was called: one from the root may hold blanks, which make cannot have in the names of files.
here=$(dirname "$0")
export LC_ALL=C
work=$1
if [ -z "$work" ]; then
   work=$(mktemp -d) || exit 3
   trap 'rm -rf "$work"' EXIT
fi
unset MAKEFLAGS MFLAGS MAKELEVEL
pfunit_dir=$PFUNIT_DIR
unset PFUNIT_DIR
counts=$work/counts
mkdir -p "$work" && : > "$counts" || exit 3

# In a file, since half the checks run at the end of a pipe.
pass() { echo passed >> "$counts"; }
miss() { echo failed >> "$counts"; echo "check_stand_in: $*"; }

# unit NAME [VARIABLE=VALUE...]: runs the .pf files of $work/NAME; output in $work/NAME.out, exit status in $status. The stand-in
# itself, which takes longest to compile, is that of the first of them.
unit() {
   name=$1; shift
   if [ -e "$work/good/build/tests/funit.o" ] && [ ! -e "$work/$name/build" ]; then
      mkdir -p "$work/$name/build/tests" && cp -p "$work"/good/build/tests/funit*.o "$work"/good/build/tests/funit*.mod "$work/$name/build/tests/"
   fi
   make -f "$here/tests.mk" BUILD="$work/$name/build" TEST_DIR="$work/$name" TEST_LIB= TEST_LIBS= \
      TEST_MODULES="$work/$name" "$@" unit-build > "$work/$name.log" 2>&1 || { status=build; return; }
   make -s -f "$here/tests.mk" BUILD="$work/$name/build" TEST_DIR="$work/$name" TEST_LIB= TEST_LIBS= \
      TEST_MODULES="$work/$name" "$@" unit > "$work/$name.out" 2> "$work/$name.err"
   status=$?
}

# says FILE TEXT: the file has this line
says() { if grep -qxF -e "$2" "$1"; then pass; else miss "$1 lacks the line: $2"; fi; }
last_line() { if [ "$(tail -n 1 "$1")" = "$2" ]; then pass; else miss "$1 does not end with: $2"; fi; }
status_is() { if [ "$status" = "$1" ]; then pass; else miss "$name: status $status, not $1"; fi; }

# refuses LINE TEXT: pf2f90 refuses the file on standard input, in both modes, with this error in this line
refuses() {
   cat > "$work/test_wrong.pf"
   for mode in '' --join; do
      if "$here/pf2f90" $mode "$work/test_wrong.pf" > /dev/null 2> "$work/wrong.err"; then
         miss "not refused ($mode): $2"
      elif grep -qF -e "test_wrong.pf:$1: error: $2" "$work/wrong.err"; then
         pass
      else
         miss "line $1 should be refused for: $2; said: $(cat "$work/wrong.err")"
      fi
   done
}

# in_test: a module with one test around the lines on standard input, which begin in line 7
in_test() { printf 'module test_wrong\n   use funit\n   implicit none\ncontains\n   @test\n   subroutine one\n'
            cat; printf '   end subroutine one\nend module test_wrong\n'; }

rm -rf "$work/good" "$work/bad" "$work/stops" "$work/typed"
mkdir -p "$work/good" "$work/bad" "$work/stops" "$work/typed" || exit 3

# --- what holds passes -------------------------------------------------------------------------------------------
cat > "$work/good/test_good.pf" <<'END'
module test_good
   use, intrinsic :: iso_fortran_env, only: real64, real128
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_positive_inf
   use funit
   implicit none
   integer, parameter :: wp = real64, qp = real128
   integer :: befores = 0, afters = 0
contains
   @before
   subroutine set_up()
      befores = befores + 1
   end subroutine set_up

   @after
   ! a comment between is allowed
   subroutine clean_up
      afters = afters + 1
   end subroutine clean_up

   @test
   subroutine before_and_after_surround_each_test()
      @assertEqual(1, befores)
      @assertEqual(0, afters)
   end subroutine before_and_after_surround_each_test

   @Test
   subroutine numbers ! it's a comment
      real(wp) :: inf

      @assertEqual(2, befores)
      @assertEqual(1, afters)
      @assertEqual(3, 3, message='three')
      @assertEqual([1, 2], [1, 2])
      @assertEqual(7, reshape([7, 7, 7, 7], [2, 2]))
      @assertEqual(1.5_wp, 1.5_wp)
      @ASSERTEQUAL(1.0_wp, 1.25_wp, tolerance=0.25_wp)
      @assertEqual([1.0_wp, 2.0_wp], [1.0_wp, 2.5_wp], tolerance=0.5_wp, message='a, b')
      @assertEqual(0.0_wp, reshape([0.0_wp, 0.1_wp, 0.0_wp, -0.1_wp], [2, 2]), tolerance=0.1_wp)
      @assertEqual(1.0_qp, 1.0_qp + epsilon(1.0_qp), tolerance=epsilon(1.0_qp))
      @assertEqual(pack([1.0_wp], [.false.]), pack([2.0_wp], [.false.]))
      inf = ieee_value(inf, ieee_positive_inf)
      @assertEqual(inf, inf)
   end subroutine numbers

   @test
   subroutine the_rest()
      @assertEqual('a ! b', '  a ! b ')
      @assertEqual("it's", 'it''s', whitespace=KEEP_ALL)
      @assertEqual('', ' ')
      @assertEqual(['ab', 'c '], ['ab', 'c '])
      @assertEqual([.true., .false.], [.true., .false.])
      @assertTrue(.true.)
      @assertTrue([.true., .true.], message='both')
      @assertFalse(any([1, 2] == 3))
      @assertLessThan(1, 2)
      @assertLessThanOrEqual(1.0_wp, 1.0_wp)
      @assertGreaterThan(2.0_qp, 1.0_qp)
      @assertGreaterThanOrEqual(2, 2)
      @assertIsFinite(1.0_wp)
      @assertEqual(1 + &
                   2, &
                   & len('@as'), &
                   message='continued')
   end subroutine the_rest
end module test_good
END

# --- what does not hold fails, with file, line, expected and found, and ends its test ------------------------------
bad=$work/bad/test_bad.pf
# report NAME LINE TEXT: what the stand-in prints of a test whose assertion in this line fails
report() {
   printf 'Failure in: test_bad_suite.%s\n  Location: [test_bad.pf:%d]\n%s\n\n' "$1" "$2" "$3" >> "$work/bad.expected"
}
# fails NAME ASSERTION TEXT: a test that this assertion ends
fails() {
   printf '   @test\n   subroutine %s()\n      %s\n      count = count + 1\n   end subroutine\n\n' "$1" "$2" >> "$bad"
   report "$1" $(($(wc -l < "$bad") - 3)) "$3"
}
cat > "$bad" <<'END'
module test_bad
   use, intrinsic :: iso_fortran_env, only: real64
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use funit
   implicit none
   integer, parameter :: wp = real64
   integer :: count = 0
contains
END
: > "$work/bad.expected"
fails wrong_integer '@assertEqual(1, 2)' 'AssertEqual failure:
      Expected: <1>
        Actual: <2>
    Difference: <1>'
fails wrong_element "@assertEqual([1, 2, 3], [1, 5, 4], message='elements')" 'elements
ArrayAssertEqual failure:
      Expected: <2>
        Actual: <5>
    Difference: <3>
      at index: [2]'
fails wrong_real '@assertEqual(1.0_wp, 1.5_wp, tolerance=0.25_wp)' 'AssertEqual failure:
      Expected: <1.0000000000000000>
        Actual: <1.5000000000000000>
    Difference: <0.50000000000000000> (greater than tolerance of 0.25000000000000000)'
fails wrong_matrix '@assertEqual(0.0_wp, reshape([0.0_wp, 0.0_wp, 0.5_wp, 0.0_wp], [2, 2]))' 'ArrayAssertEqual failure:
      Expected: <0.0000000000000000>
        Actual: <0.50000000000000000>
    Difference: <0.50000000000000000> (greater than tolerance of 0.0000000000000000)
      at index: [1,2]'
fails wrong_shape '@assertEqual([1.0_wp], [1.0_wp, 1.0_wp])' 'Arrays not conformable failure:
    Expected shape: [1]
      Actual shape: [2]'
fails wrong_string "@assertEqual('abc', 'abd', message='text')" 'text String assertion failed:
    expected: <"abc">
   but found: <"abd">
  first diff:   --^'
fails wrong_blanks "@assertEqual('abc', 'abc ', whitespace=KEEP_ALL)" 'String assertion failed:
    expected: <"abc">
   but found: <"abc ">
  first diff:   ---^'
fails wrong_logical '@assertEqual(.true., .false.)' 'AssertEquivalent failure:
    Expected: <T>
    Actual:   <F>'
fails not_true "@assertTrue(count > 9, message='it is not so')" 'it is not so'
fails not_false "@assertFalse(count == 0, message='it is so')" 'it is so'
fails not_less '@assertLessThan(2, 2)' 'AssertLessThan failure:
              LHS: <2>
    not less than: <2>'
fails not_less_equal "@assertLessThanOrEqual(2.5_wp, 2.0_wp, message='bound')" 'bound
AssertLessThanOrEqual failure:
                          LHS: <2.5000000000000000>
    not less than or equal to: <2.0000000000000000>'
fails not_greater '@assertGreaterThan(1, 1)' 'AssertGreaterThan failure:
                 LHS: <1>
    not greater than: <1>'
fails not_greater_equal '@assertGreaterThanOrEqual(1.0_wp, 1.5_wp)' 'AssertGreaterThanOrEqual failure:
                             LHS: <1.0000000000000000>
    not greater than or equal to: <1.5000000000000000>'
fails not_finite "@assertIsFinite(ieee_value(1.0_wp, ieee_quiet_nan), message='NaN')" NaN
fails told_to_fail "@assertFail('always')" always
fails not_all_true "@assertTrue([.true., .false.], message='one of two')" 'one of two'
fails not_all_false "@assertFalse([.true., .false.], message='two of two')" 'two of two'
first=$(($(wc -l < "$bad") + 1))
cat >> "$bad" <<'END'
   subroutine helper
      @assertEqual(1 + &
                   1, 3)
      count = count + 1
   end subroutine helper

   @test
   subroutine fails_in_a_helper()
      call helper
      count = count + 1
      @assertTrue(.true.)
   end subroutine fails_in_a_helper

   @test
   subroutine one_that_holds()
      @assertTrue(.true.)
   end subroutine one_that_holds

   @test
   subroutine none_went_on()
      @assertEqual(1, count)
      @assertTrue(.false., message='after a continued annotation')
   end subroutine none_went_on
end module test_bad
END
report fails_in_a_helper $((first + 1)) 'AssertEqual failure:
      Expected: <2>
        Actual: <3>
    Difference: <1>'
report none_went_on $((first + 21)) 'after a continued annotation'
echo '1 passed, 20 failed' >> "$work/bad.expected"

# --- a program that ends early, by itself or by a trap, has not passed ---------------------------------------------
cat > "$work/stops/test_stops.pf" <<'END'
module test_stops
   use funit
   implicit none
contains
   @test
   subroutine first()
      @assertTrue(.true.)
   end subroutine first
   @test
   subroutine second()
      @assertTrue(.true.)
      if (.true.) stop
   end subroutine second
end module test_stops
END

# --- mixed kinds do not compile ------------------------------------------------------------------------------------
printf '   @assertEqual(1.0_8, 1.0_16)\n' | in_test | sed 's/test_wrong/test_typed/' > "$work/typed/test_typed.pf"

run_all() {
   unit good "$@"; status_is 0; last_line "$work/good.out" '3 passed, 0 failed'
   unit bad "$@"; status_is 2; last_line "$work/bad.out" '1 passed, 20 failed'
   unit stops "$@"; status_is 2; says "$work/stops.out" '0 of 2 tests were run to their end (exit status 0)'
   last_line "$work/stops.out" '0 passed, 2 failed'
   unit typed "$@"; status_is build
}

run_all
if cmp -s "$work/bad.out" "$work/bad.expected"; then pass; else miss 'reports:'; diff "$work/bad.expected" "$work/bad.out"; fi

# The program itself says by its exit status what `unit` reads from its last line.
"$work/good/build/tests/unit" > /dev/null && pass || miss 'the program ends badly after success'
if [ "$("$work/bad/build/tests/unit" -f one_that)" = '1 passed, 0 failed' ]; then pass; else miss 'tests of some names'; fi
"$work/bad/build/tests/unit" > /dev/null && miss 'the program ends well after failures' || pass

# A NaN equals nothing and does not trap (pFUnit traps).
mkdir -p "$work/nan" && rm -rf "$work/nan/build"
in_test << 'END' | sed 's/test_wrong/test_nan/' > "$work/nan/test_nan.pf"
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   double precision :: x
   x = ieee_value(x, ieee_quiet_nan)
   @assertEqual(x, x, tolerance=1.0d0)
END
unit nan; status_is 2; says "$work/nan.out" '  Location: [test_nan.pf:10]'; last_line "$work/nan.out" '0 passed, 1 failed'

# A new test file is taken up and a removed one is forgotten, without cleaning.
sed 's/test_good/test_more/' "$work/good/test_good.pf" > "$work/good/test_more.pf"
unit good; status_is 0; last_line "$work/good.out" '6 passed, 0 failed'
rm "$work/good/test_more.pf"
unit good; status_is 0; last_line "$work/good.out" '3 passed, 0 failed'

# Objects of helper modules, made elsewhere, are linked; their modules are found beside those under test.
mkdir -p "$work/helped" && rm -rf "$work/helped/build"
printf 'module first_helper\n   implicit none\n   integer, parameter :: one = 1\nend module first_helper\n' \
   > "$work/helped/first_helper.f90"
printf 'module another\n   use first_helper, only: one\n   implicit none\n   integer, parameter :: two = one + 1\n%s\n' \
   'end module another' > "$work/helped/another.f90"
printf '   @assertEqual(2, two)\n' | in_test |
   sed 's/test_wrong/test_helped/; s/use funit/use funit; use another/; /subroutine one$/s/one/two_is_two/' \
   > "$work/helped/test_helped.pf"
for helper in first_helper another; do
   "${FC:-gfortran}" -J"$work/helped" -c -o "$work/helped/$helper.o" "$work/helped/$helper.f90" || miss "$helper does not compile"
done
unit helped -j4 TEST_HELPERS="$work/helped/first_helper.o $work/helped/another.o"
status_is 0; last_line "$work/helped.out" '1 passed, 0 failed'

# No test at all is no success.
mkdir -p "$work/empty"
unit empty
if [ "$status" = 0 ]; then miss 'a run without tests succeeded'; else pass; fi

# --- what the preprocessor refuses -------------------------------------------------------------------------------
printf '   @assertEqul(1, 1)\n' | in_test | refuses 7 'unknown annotation @assertequl'
printf '   @testing\n' | in_test | refuses 7 'unknown annotation @testing'
printf '   @disable\n   @assertTrue(.true.)\n' | in_test | refuses 7 'unknown annotation @disable'
printf '   @assertEqual(1)\n' | in_test | refuses 7 '@assertequal needs 2 arguments, has 1'
printf '   @assertEqual(max(1, 2))\n' | in_test | refuses 7 '@assertequal needs 2 arguments, has 1'
printf '   @assertTrue()\n' | in_test | refuses 7 '@asserttrue needs 1 argument, has 0'
printf '   @assertTrue((.true.)\n' | in_test | refuses 7 '@asserttrue: the parentheses do not match'
printf '   @assertTrue(.true.))\n' | in_test | refuses 7 '@asserttrue: the parentheses do not match'
printf '   @assertTrue .true.\n' | in_test | refuses 7 '@asserttrue: the parentheses do not match'
printf '   @assertTrue(.true.) ! why\n' | in_test | refuses 7 'an annotation takes no comment'
printf '   @assertEqual(1, &\n\n   1)\n' | in_test | sed '8s/.*/! why/' | refuses 8 'an annotation takes no comment'
printf "   @assertEqual('a&\n   &b', 'ab')\n" | in_test | refuses 7 'a string of an annotation must end in its own line'
printf '   if (.true.) @assertTrue(.true.)\n' | in_test | refuses 7 'an annotation must begin its line'
printf '   integer :: i\n   i = 1\n' | in_test | refuses 6 'test `one` asserts nothing'
printf '#ifdef X\n   @assertTrue(.true.)\n#endif\n' | in_test | refuses 7 'no preprocessor lines in a .pf file'
in_module() { printf 'module test_wrong\n   use funit\ncontains\n'; cat; printf 'end module test_wrong\n'; }
body='   @assertTrue(.true.)\n   end subroutine one\n'
printf "   subroutine one()\n$body   @test\n   subroutine two\n   call other\n   end subroutine two\n" | in_module |
   refuses 4 'subroutine `one` is neither annotated (@test, @before, @after) nor called'
printf "   !@test\n   recursive subroutine one()\n$body" | in_module |
   refuses 5 'subroutine `one` is neither annotated (@test, @before, @after) nor called'
printf "   subroutine one()\n$body" | in_module | refuses 7 'no @test in this file'
printf "   @test\n   recursive subroutine one()\n$body" | in_module |
   refuses 4 '@test is not followed by a plain `subroutine NAME` without arguments'
printf "   @test\n   subroutine one(this)\n$body" | in_module |
   refuses 4 '@test is not followed by a plain `subroutine NAME` without arguments'
printf "   @test\n   integer function one()\n$body" | in_module |
   refuses 4 '@test is not followed by a plain `subroutine NAME` without arguments'
printf "   @test\n   @test\n   subroutine one()\n$body" | in_module | refuses 5 '@test is not followed by its subroutine'
printf "   @test(ifdef=X)\n   subroutine one()\n$body" | in_module | refuses 4 '@test stands alone in its line'
printf "   @test\n   subroutine one()\n$body   @test\n" | in_module | 
   refuses 8 '@test is not followed by a plain `subroutine NAME` without arguments'
printf "   @test\n   subroutine run()\n$body" | in_module | refuses 5 'the name `run` is taken by pFUnit'
printf '   @test' | in_test | sed '8,$d' | refuses 7 '@test is not followed by its subroutine'
printf "   @test\n   subroutine one()\n$body" | in_module | sed 's/module test_wrong/module test_other/' |
   refuses 1 'module `test_other` in file `test_wrong.pf`'

# --- the same files with pFUnit itself -------------------------------------------------------------------------------
# Its report in the stand-in's form: each label beside its value, progress, times and its own counts left out.
as_stand_in() {
   awk '/^Failure$/ || /^ in: $/ || /^  Location: $/ { printf "%s", $0; joined = 1; next }
        /^ *$/ && !reports { next }
        /^[.FE]+$/ || /^Time:/ || /FAILURES!!!/ || /^Tests run:/ || /^, Disabled:/ || /^STOP / { next }
        { if (joined) reports = 1; joined = 0; sub(/^ *$/, ""); print }' "$1"
}
if [ -n "$pfunit_dir" ]; then
   rm -rf "$work/good/build" "$work/bad/build" "$work/stops/build" "$work/typed/build"
   cp "$work/bad.expected" "$work/bad.stand_in"
   run_all PFUNIT_DIR="$pfunit_dir"
   as_stand_in "$work/bad.out" > "$work/bad.pfunit"
   if cmp -s "$work/bad.stand_in" "$work/bad.pfunit"; then pass; else miss 'pFUnit reports otherwise:'
      diff "$work/bad.stand_in" "$work/bad.pfunit"; fi
fi

passed=$(grep -c passed "$counts")
failed=$(grep -c failed "$counts")
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
