!> Stand-in for the module `funit` of pFUnit 4 where pFUnit is not installed: the assertions that our tests use, with
!> pFUnit's names, arguments and report. What it lacks does not compile, so a test that builds here builds there.
!> The module funit_reports has the state of the run and the reports; assertions of logicals and numbers are one text.
module funit_reports
   use, intrinsic :: iso_fortran_env, only: output_unit
   implicit none
   private
   public :: sourcelocation, raised, running
   public :: fail, head, conform, unequal, compare

   type :: sourcelocation
      character(255) :: file = ''
      integer :: line = 0
   end type sourcelocation

   character, parameter, public :: newline = new_line('a')

   !> State of the run: assertions have no other way to tell the runner.
   character(:), allocatable :: running
   integer :: raised = 0

contains

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

   !> Whole numbers as [1,2].
   function list(numbers) result(s)
      integer, intent(in) :: numbers(:)
      character(:), allocatable :: s
      character(11) :: digits
      integer :: k

      s = '['
      do k = 1, size(numbers)
         if (k > 1) s = s//','
         write (digits, '(i0)') numbers(k)
         s = s//trim(digits)
      end do
      s = s//']'
   end function list
end module funit_reports

#define VALUE logical
#define TOLERANCE
#define IS_LOGICAL
#define ASSERTION 'AssertEquivalent'
module funit_logical
#include "funit_kind.inc"
end module funit_logical

#undef VALUE
#undef IS_LOGICAL
#undef ASSERTION
#define VALUE integer
#define ASSERTION 'AssertEqual'
module funit_integer
#include "funit_kind.inc"
end module funit_integer

#undef VALUE
#undef TOLERANCE
#define VALUE real(real64)
#define TOLERANCE tolerance,
#define IS_REAL
module funit_real64
#include "funit_kind.inc"
end module funit_real64

#undef VALUE
#define VALUE real(real128)
module funit_real128
#include "funit_kind.inc"
end module funit_real128

module funit
   use, intrinsic :: iso_fortran_env, only: output_unit
   use funit_reports
   use funit_logical
   use funit_integer
   use funit_real64
   use funit_real128
   implicit none
   private
   public :: sourcelocation, anyexceptions, whitespaceoptions, keep_all, trim_all
   public :: assertequal, asserttrue, assertfalse, assertisfinite, assertfail
   public :: assertlessthan, assertlessthanorequal, assertgreaterthan, assertgreaterthanorequal
   public :: run_test, report_tests

   !> How strings are compared: without blanks and tabs at both ends (the default), or as they are.
   type :: whitespaceoptions
      integer :: value = 0
   end type whitespaceoptions
   type(whitespaceoptions), parameter :: trim_all = whitespaceoptions(1), keep_all = whitespaceoptions(2)

   abstract interface
      subroutine test_procedure()
      end subroutine test_procedure
   end interface

   interface assertequal
      module procedure equal_string, equal_strings
   end interface assertequal

   interface asserttrue
      module procedure true_scalar, true_array
   end interface asserttrue

   interface assertfalse
      module procedure false_scalar, false_array
   end interface assertfalse

   interface assertfail
      module procedure fail
   end interface assertfail

   integer :: passed = 0, failed = 0

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
end module funit
