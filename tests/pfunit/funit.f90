!> Stand-in for the module `funit` of pFUnit 4 where pFUnit is not installed: the assertions that our tests use, with
!> pFUnit's names, arguments and report. What it lacks does not compile, so a test that builds here builds there.
module funit
   use, intrinsic :: iso_fortran_env, only: real64, real128, output_unit
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   implicit none
   private
   public :: sourcelocation, anyexceptions, whitespaceoptions, keep_all, trim_all
   public :: assertequal, asserttrue, assertfalse, assertisfinite, assertfail
   public :: assertlessthan, assertlessthanorequal, assertgreaterthan, assertgreaterthanorequal
   public :: run_test, report_tests

   type :: sourcelocation
      character(255) :: file = ''
      integer :: line = 0
   end type sourcelocation

   !> How strings are compared: without blanks and tabs at both ends (the default), or as they are.
   type :: whitespaceoptions
      integer :: value = 0
   end type whitespaceoptions
   type(whitespaceoptions), parameter :: trim_all = whitespaceoptions(1), keep_all = whitespaceoptions(2)

   abstract interface
      subroutine test_procedure()
      end subroutine test_procedure
   end interface

   !> The digits are the ranks of expected and actual value. Explicit ranks, since gfortran 12 passes some function
   !> results (PACK) to assumed-rank arguments with a wrong rank.
   interface assertequal
      module procedure integer_00, integer_01, integer_11, integer_02, integer_22
      module procedure logical_00, logical_01, logical_11
      module procedure real64_00, real64_01, real64_11, real64_02, real64_22
      module procedure real128_00, real128_01, real128_11, real128_02, real128_22
      module procedure equal_string, equal_strings
   end interface assertequal

   interface asserttrue
      module procedure true_scalar, true_array
   end interface asserttrue

   interface assertfalse
      module procedure false_scalar, false_array
   end interface assertfalse

   interface assertisfinite
      module procedure finite_real64, finite_real128
   end interface assertisfinite

   interface assertlessthan
      module procedure less_integer, less_real64, less_real128
   end interface assertlessthan

   interface assertlessthanorequal
      module procedure less_equal_integer, less_equal_real64, less_equal_real128
   end interface assertlessthanorequal

   interface assertgreaterthan
      module procedure greater_integer, greater_real64, greater_real128
   end interface assertgreaterthan

   interface assertgreaterthanorequal
      module procedure greater_equal_integer, greater_equal_real64, greater_equal_real128
   end interface assertgreaterthanorequal

   interface assertfail
      module procedure fail
   end interface assertfail

   interface text
      module procedure text_integer, text_logical, text_real64, text_real128
   end interface text

   character, parameter :: newline = new_line('a')

   !> State of the run: assertions have no other way to tell the runner.
   character(:), allocatable :: running
   integer :: raised = 0, passed = 0, failed = 0

contains

   !> Runs one test between `before` and `after`; as in pFUnit neither it nor `after` runs once `before` has failed, and of the
   !> command's `-f TEXT` only the tests whose names hold the text are run.
   subroutine run_test(name, test, before, after)
      character(*), intent(in) :: name
      procedure(test_procedure) :: test
      procedure(test_procedure), optional :: before, after

      if (.not. is_chosen(name)) return
      running = name
      raised = 0
      if (present(before)) call before
      if (raised == 0) then
         call test
         if (present(after)) call after
      end if
      if (raised == 0) then
         passed = passed + 1
      else
         failed = failed + 1
      end if
   end subroutine run_test

   !> Whether the command asks for this test.
   logical function is_chosen(name)
      character(*), intent(in) :: name
      character(80) :: option, part

      call get_command_argument(1, option)
      call get_command_argument(2, part)
      is_chosen = option /= '-f' .or. index(name, trim(part)) > 0
   end function is_chosen

   !> Prints the counts and ends the run: status 1 unless every test passed and there was one.
   subroutine report_tests()
      write (output_unit, '(i0, a, i0, a)') passed, ' passed, ', failed, ' failed'
      flush (output_unit)
      if (failed > 0 .or. passed == 0) stop 1, quiet=.true.
   end subroutine report_tests

   !> True once an assertion of the running test has failed.
   logical function anyexceptions()
      anyexceptions = raised > 0
   end function anyexceptions

   !> A failed assertion: reported at once, so that a crash later in the test does not hide it.
   subroutine fail(message, location)
      character(*), intent(in) :: message
      type(sourcelocation), intent(in), optional :: location

      raised = raised + 1
      write (output_unit, '(2a)') 'Failure in: ', running
      if (present(location)) write (output_unit, '(3a, i0, a)') '  Location: [', trim(location%file), ':', &
         location%line, ']'
      write (output_unit, '(a, /)') trim(message)
      flush (output_unit)
   end subroutine fail

   !> Head line of a report: the test's own message, then the assertion's name.
   function head(assertion, message)
      character(*), intent(in) :: assertion
      character(*), intent(in), optional :: message
      character(:), allocatable :: head

      head = assertion//' failure:'
      if (present(message)) head = message//newline//head
   end function head

   subroutine true_scalar(condition, message, location)
      logical, intent(in) :: condition
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      if (condition) return
      if (present(message)) then
         call fail(message, location)
      else
         call fail('Condition failure', location)
      end if
   end subroutine true_scalar

   subroutine true_array(condition, message, location)
      logical, intent(in) :: condition(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call true_scalar(all(condition), message, location)
   end subroutine true_array

   subroutine false_scalar(condition, message, location)
      logical, intent(in) :: condition
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call true_scalar(.not. condition, message, location)
   end subroutine false_scalar

   subroutine false_array(condition, message, location)
      logical, intent(in) :: condition(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call true_scalar(.not. any(condition), message, location)
   end subroutine false_array

   subroutine finite_real64(x, message, location)
      real(real64), intent(in) :: x
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call true_scalar(ieee_is_finite(x), message, location)
   end subroutine finite_real64

   subroutine finite_real128(x, message, location)
      real(real128), intent(in) :: x
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call true_scalar(ieee_is_finite(x), message, location)
   end subroutine finite_real128

   !> True if the shapes agree or the expected value is a scalar; reports a failure if not.
   logical function conform(expected, actual, message, location)
      integer, intent(in) :: expected(:), actual(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      conform = size(expected) == 0
      if (size(expected) == size(actual)) conform = conform .or. all(expected == actual)
      if (.not. conform) call fail(head('Arrays not conformable', message)//newline// &
         '    Expected shape: '//list(expected)//newline//'      Actual shape: '//list(actual), location)
   end function conform

   !> Reports unequal values, without a difference for logicals. `where_` is the position in array element order in an
   !> array of the shape `extent`.
   subroutine unequal(assertion, expected, actual, difference, where_, extent, message, location)
      character(*), intent(in) :: assertion, expected, actual, difference
      integer, intent(in) :: where_, extent(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location
      character(:), allocatable :: lines
      integer :: subscript(size(extent)), rest, k

      lines = head(trim(merge('Array', '     ', size(extent) > 0))//assertion, message)//newline
      if (difference /= '') then
         lines = lines//'      Expected: <'//expected//'>'//newline//'        Actual: <'//actual//'>'//newline// &
            '    Difference: '//difference
      else
         lines = lines//'    Expected: <'//expected//'>'//newline//'    Actual:   <'//actual//'>'
      end if
      if (size(extent) > 0) then
         rest = where_ - 1
         do k = 1, size(extent)
            subscript(k) = mod(rest, extent(k)) + 1
            rest = rest/extent(k)
         end do
         lines = lines//newline//'      at index: '//list(subscript)
      end if
      call fail(lines, location)
   end subroutine unequal

   !> Elements in array element order and the shapes; of an expected scalar there is one element.
   subroutine equal_integer(expected, shape_expected, actual, shape_actual, message, location)
      integer, intent(in) :: expected(:), actual(:)
      integer, intent(in) :: shape_expected(:), shape_actual(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location
      integer :: e, a
      integer :: k

      if (.not. conform(shape_expected, shape_actual, message, location)) return
      do k = 1, size(actual)
         a = actual(k)
         e = expected(min(k, size(expected)))
         if (e == a) cycle
         call unequal('AssertEqual', text(e), text(a), '<'//text(a - e)//'>', k, shape_actual, message, location)
         return
      end do
   end subroutine equal_integer

   subroutine integer_00(expected, actual, message, location)
      integer, intent(in) :: expected, actual
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_integer([expected], shape(expected), [actual], shape(actual), message, location)
   end subroutine integer_00

   subroutine integer_01(expected, actual, message, location)
      integer, intent(in) :: expected
      integer, intent(in) :: actual(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_integer([expected], shape(expected), actual, shape(actual), message, location)
   end subroutine integer_01

   subroutine integer_11(expected, actual, message, location)
      integer, intent(in) :: expected(:), actual(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_integer(expected, shape(expected), actual, shape(actual), message, location)
   end subroutine integer_11

   subroutine integer_02(expected, actual, message, location)
      integer, intent(in) :: expected
      integer, intent(in) :: actual(:, :)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_integer([expected], shape(expected), reshape(actual, [size(actual)]), shape(actual), message, location)
   end subroutine integer_02

   subroutine integer_22(expected, actual, message, location)
      integer, intent(in) :: expected(:, :), actual(:, :)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_integer(reshape(expected, [size(expected)]), shape(expected), reshape(actual, [size(actual)]), &
         shape(actual), &
         message, location)
   end subroutine integer_22

   !> Elements in array element order and the shapes; of an expected scalar there is one element.
   subroutine equal_logical(expected, shape_expected, actual, shape_actual, message, location)
      logical, intent(in) :: expected(:), actual(:)
      integer, intent(in) :: shape_expected(:), shape_actual(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location
      logical :: e, a
      integer :: k

      if (.not. conform(shape_expected, shape_actual, message, location)) return
      do k = 1, size(actual)
         a = actual(k)
         e = expected(min(k, size(expected)))
         if (e .eqv. a) cycle
         call unequal('AssertEquivalent', text(e), text(a), '', k, shape_actual, message, location)
         return
      end do
   end subroutine equal_logical

   subroutine logical_00(expected, actual, message, location)
      logical, intent(in) :: expected, actual
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_logical([expected], shape(expected), [actual], shape(actual), message, location)
   end subroutine logical_00

   subroutine logical_01(expected, actual, message, location)
      logical, intent(in) :: expected
      logical, intent(in) :: actual(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_logical([expected], shape(expected), actual, shape(actual), message, location)
   end subroutine logical_01

   subroutine logical_11(expected, actual, message, location)
      logical, intent(in) :: expected(:), actual(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_logical(expected, shape(expected), actual, shape(actual), message, location)
   end subroutine logical_11

   !> A NaN is unequal to everything; it is sorted out first, as `<` with a NaN traps. Equal infinities are equal:
   !> they must not reach the difference, which traps too.
   subroutine equal_real64(expected, shape_expected, actual, shape_actual, tolerance, message, location)
      real(real64), intent(in) :: expected(:), actual(:)
      integer, intent(in) :: shape_expected(:), shape_actual(:)
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location
      real(real64) :: e, a, t
      integer :: k

      t = 0.0_real64
      if (present(tolerance)) t = tolerance
      if (.not. conform(shape_expected, shape_actual, message, location)) return
      do k = 1, size(actual)
         a = actual(k)
         e = expected(min(k, size(expected)))
         if (.not. ieee_is_nan(a) .and. .not. ieee_is_nan(e)) then
            if (.not. (e < a .or. e > a)) cycle
            if (abs(a - e) <= t) cycle
         end if
         call unequal('AssertEqual', text(e), text(a), &
            '<'//text(a - e)//'> (greater than tolerance of '//text(t)//')', &
                      k, shape_actual, message, location)
         return
      end do
   end subroutine equal_real64

   subroutine real64_00(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected, actual
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_real64([expected], shape(expected), [actual], shape(actual), tolerance, message, location)
   end subroutine real64_00

   subroutine real64_01(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected
      real(real64), intent(in) :: actual(:)
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_real64([expected], shape(expected), actual, shape(actual), tolerance, message, location)
   end subroutine real64_01

   subroutine real64_11(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected(:), actual(:)
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_real64(expected, shape(expected), actual, shape(actual), tolerance, message, location)
   end subroutine real64_11

   subroutine real64_02(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected
      real(real64), intent(in) :: actual(:, :)
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_real64([expected], shape(expected), reshape(actual, [size(actual)]), shape(actual), tolerance, &
         message, location)
   end subroutine real64_02

   subroutine real64_22(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected(:, :), actual(:, :)
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_real64(reshape(expected, [size(expected)]), shape(expected), reshape(actual, [size(actual)]), &
         shape(actual), &
         tolerance, message, location)
   end subroutine real64_22

   !> A NaN is unequal to everything; it is sorted out first, as `<` with a NaN traps. Equal infinities are equal:
   !> they must not reach the difference, which traps too.
   subroutine equal_real128(expected, shape_expected, actual, shape_actual, tolerance, message, location)
      real(real128), intent(in) :: expected(:), actual(:)
      integer, intent(in) :: shape_expected(:), shape_actual(:)
      real(real128), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location
      real(real128) :: e, a, t
      integer :: k

      t = 0.0_real128
      if (present(tolerance)) t = tolerance
      if (.not. conform(shape_expected, shape_actual, message, location)) return
      do k = 1, size(actual)
         a = actual(k)
         e = expected(min(k, size(expected)))
         if (.not. ieee_is_nan(a) .and. .not. ieee_is_nan(e)) then
            if (.not. (e < a .or. e > a)) cycle
            if (abs(a - e) <= t) cycle
         end if
         call unequal('AssertEqual', text(e), text(a), &
            '<'//text(a - e)//'> (greater than tolerance of '//text(t)//')', &
                      k, shape_actual, message, location)
         return
      end do
   end subroutine equal_real128

   subroutine real128_00(expected, actual, tolerance, message, location)
      real(real128), intent(in) :: expected, actual
      real(real128), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_real128([expected], shape(expected), [actual], shape(actual), tolerance, message, location)
   end subroutine real128_00

   subroutine real128_01(expected, actual, tolerance, message, location)
      real(real128), intent(in) :: expected
      real(real128), intent(in) :: actual(:)
      real(real128), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_real128([expected], shape(expected), actual, shape(actual), tolerance, message, location)
   end subroutine real128_01

   subroutine real128_11(expected, actual, tolerance, message, location)
      real(real128), intent(in) :: expected(:), actual(:)
      real(real128), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_real128(expected, shape(expected), actual, shape(actual), tolerance, message, location)
   end subroutine real128_11

   subroutine real128_02(expected, actual, tolerance, message, location)
      real(real128), intent(in) :: expected
      real(real128), intent(in) :: actual(:, :)
      real(real128), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_real128([expected], shape(expected), reshape(actual, [size(actual)]), shape(actual), &
         tolerance, message, location)
   end subroutine real128_02

   subroutine real128_22(expected, actual, tolerance, message, location)
      real(real128), intent(in) :: expected(:, :), actual(:, :)
      real(real128), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call equal_real128(reshape(expected, [size(expected)]), shape(expected), reshape(actual, [size(actual)]), &
         shape(actual), &
         tolerance, message, location)
   end subroutine real128_22

   subroutine equal_string(expected, actual, message, location, whitespace)
      character(*), intent(in) :: expected, actual
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location
      type(whitespaceoptions), intent(in), optional :: whitespace
      character(:), allocatable :: e, a, lines
      logical :: trimmed
      integer :: same

      trimmed = .true.
      if (present(whitespace)) trimmed = whitespace%value == trim_all%value
      e = expected
      a = actual
      if (trimmed) e = without_ends(expected)
      if (trimmed) a = without_ends(actual)
      if (len(e) == len(a) .and. e == a) return

      do same = 0, min(len(e), len(a)) - 1
         if (e(same + 1:same + 1) /= a(same + 1:same + 1)) exit
      end do
      if (trimmed) e = trim(expected)
      if (trimmed) a = trim(actual)
      lines = 'String assertion failed:'//newline//'    expected: <"'//e//'">'//newline// &
         '   but found: <"'//a//'">'//newline//'  first diff:   '//repeat('-', same)//'^'
      if (present(message)) lines = message//' '//lines
      call fail(lines, location)
   end subroutine equal_string

   subroutine equal_strings(expected, actual, message, location, whitespace)
      character(*), intent(in) :: expected(:), actual(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location
      type(whitespaceoptions), intent(in), optional :: whitespace
      integer :: k

      if (.not. conform(shape(expected), shape(actual), message, location)) return
      do k = 1, size(actual)
         call equal_string(expected(k), actual(k), message, location, whitespace)
      end do
   end subroutine equal_strings

   !> The string without blanks and tabs at both ends.
   pure function without_ends(string) result(s)
      character(*), intent(in) :: string
      character(:), allocatable :: s
      character(*), parameter :: blanks = ' '//achar(9)
      integer :: first

      first = verify(string, blanks)
      if (first == 0) then
         s = ''
      else
         s = string(first:verify(string, blanks, back=.true.))
      end if
   end function without_ends

   !> Reports a false comparison; the colons stand under each other.
   subroutine compare(holds, assertion, phrase, lhs, rhs, message, location)
      logical, intent(in) :: holds
      character(*), intent(in) :: assertion, phrase, lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      if (holds) return
      call fail(head(assertion, message)//newline//'    '//repeat(' ', len(phrase) - 3)//'LHS: <'//lhs//'>'// &
                newline//'    '//phrase//': <'//rhs//'>', location)
   end subroutine compare

   subroutine less_integer(lhs, rhs, message, location)
      integer, intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs < rhs, 'AssertLessThan', 'not less than', text(lhs), text(rhs), message, location)
   end subroutine less_integer

   subroutine less_real64(lhs, rhs, message, location)
      real(real64), intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs < rhs, 'AssertLessThan', 'not less than', text(lhs), text(rhs), message, location)
   end subroutine less_real64

   subroutine less_real128(lhs, rhs, message, location)
      real(real128), intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs < rhs, 'AssertLessThan', 'not less than', text(lhs), text(rhs), message, location)
   end subroutine less_real128

   subroutine less_equal_integer(lhs, rhs, message, location)
      integer, intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs <= rhs, 'AssertLessThanOrEqual', 'not less than or equal to', text(lhs), text(rhs), message, &
         location)
   end subroutine less_equal_integer

   subroutine less_equal_real64(lhs, rhs, message, location)
      real(real64), intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs <= rhs, 'AssertLessThanOrEqual', 'not less than or equal to', text(lhs), text(rhs), message, &
         location)
   end subroutine less_equal_real64

   subroutine less_equal_real128(lhs, rhs, message, location)
      real(real128), intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs <= rhs, 'AssertLessThanOrEqual', 'not less than or equal to', text(lhs), text(rhs), message, &
         location)
   end subroutine less_equal_real128

   subroutine greater_integer(lhs, rhs, message, location)
      integer, intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs > rhs, 'AssertGreaterThan', 'not greater than', text(lhs), text(rhs), message, location)
   end subroutine greater_integer

   subroutine greater_real64(lhs, rhs, message, location)
      real(real64), intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs > rhs, 'AssertGreaterThan', 'not greater than', text(lhs), text(rhs), message, location)
   end subroutine greater_real64

   subroutine greater_real128(lhs, rhs, message, location)
      real(real128), intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs > rhs, 'AssertGreaterThan', 'not greater than', text(lhs), text(rhs), message, location)
   end subroutine greater_real128

   subroutine greater_equal_integer(lhs, rhs, message, location)
      integer, intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs >= rhs, 'AssertGreaterThanOrEqual', 'not greater than or equal to', text(lhs), text(rhs), &
                   message, location)
   end subroutine greater_equal_integer

   subroutine greater_equal_real64(lhs, rhs, message, location)
      real(real64), intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs >= rhs, 'AssertGreaterThanOrEqual', 'not greater than or equal to', text(lhs), text(rhs), &
                   message, location)
   end subroutine greater_equal_real64

   subroutine greater_equal_real128(lhs, rhs, message, location)
      real(real128), intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in), optional :: location

      call compare(lhs >= rhs, 'AssertGreaterThanOrEqual', 'not greater than or equal to', text(lhs), text(rhs), &
                   message, location)
   end subroutine greater_equal_real128

   function text_integer(x) result(s)
      integer, intent(in) :: x
      character(:), allocatable :: s
      character(45) :: buffer

      write (buffer, '(g0)') x
      s = trim(buffer)
   end function text_integer

   function text_logical(x) result(s)
      logical, intent(in) :: x
      character(:), allocatable :: s
      character(45) :: buffer

      write (buffer, '(g0)') x
      s = trim(buffer)
   end function text_logical

   function text_real64(x) result(s)
      real(real64), intent(in) :: x
      character(:), allocatable :: s
      character(45) :: buffer

      write (buffer, '(g0)') x
      s = trim(buffer)
   end function text_real64

   function text_real128(x) result(s)
      real(real128), intent(in) :: x
      character(:), allocatable :: s
      character(45) :: buffer

      write (buffer, '(g0)') x
      s = trim(buffer)
   end function text_real128

   !> Whole numbers as [1,2].
   function list(numbers) result(s)
      integer, intent(in) :: numbers(:)
      character(:), allocatable :: s
      integer :: k

      s = '['
      do k = 1, size(numbers)
         if (k > 1) s = s//','
         s = s//text(numbers(k))
      end do
      s = s//']'
   end function list
end module funit
