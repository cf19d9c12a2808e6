!> How far a long run is, on a terminal: one line on standard error, rewritten, and gone at the end.
module progress
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64
   use system_calls, only: isatty, write_bytes
   implicit none
   private
   public :: progress_t, start_progress, show_progress, end_progress, line_over

   integer(c_int), parameter :: standard_output = 1, standard_error = 2
   !> Runs shorter than this many seconds show nothing; the line then changes so many times a second.
   integer, parameter :: first_seconds = 2, changes_a_second = 4

   type :: progress_t
      logical :: shown = .false.      !< there is somebody to show it to
      integer(int64) :: due = 0       !< the count of the clock at which the line is written next
      integer :: length = 0           !< of the line that stands on the terminal
   end type progress_t

contains

   !> Starts the clock. Progress is shown if it is `wanted` and standard error is a terminal; not, however, where
   !> standard output is one that an output is printed on (`printing`): that shows the progress itself.
   subroutine start_progress(p, wanted, printing)
      type(progress_t), intent(out) :: p
      logical, intent(in) :: wanted, printing
      integer(int64) :: count, rate

      p%shown = wanted .and. isatty(standard_error) /= 0
      if (p%shown .and. printing) p%shown = isatty(standard_output) == 0
      if (.not. p%shown) return
      call system_clock(count, rate)
      p%due = count + first_seconds*rate
   end subroutine start_progress

   !> Shows `words` and "`k` OF `n`" if it is time.
   subroutine show_progress(p, words, k, n)
      type(progress_t), intent(inout) :: p
      character(*), intent(in) :: words
      integer, intent(in) :: k, n
      integer(int64) :: count, rate
      character(80) :: line

      if (.not. p%shown) return
      call system_clock(count, rate)
      if (count < p%due) return
      p%due = count + rate/changes_a_second
      write (line, '(1x, a, 1x, i0, a, i0)') words, k, ' OF ', n
      call write_line(p, trim(line))
   end subroutine show_progress

   !> Takes the line away, before something else is printed.
   subroutine end_progress(p)
      type(progress_t), intent(inout) :: p

      if (p%length > 0) call write_line(p, '')
   end subroutine end_progress

   !> Writes `line` in the place of the one before it. What is not written is no error: it is no result.
   subroutine write_line(p, line)
      type(progress_t), intent(inout) :: p
      character(*), intent(in) :: line
      integer(c_size_t) :: written

      written = write_bytes(standard_error, line_over(p%length, line))
      p%length = len(line)
   end subroutine write_line

   !> The characters that put `line` in the place of one of `length` characters.
   pure function line_over(length, line) result(text)
      integer, intent(in) :: length
      character(*), intent(in) :: line
      character(:), allocatable :: text
      character(1), parameter :: return = achar(13)

      text = return//line
      if (length > len(line)) text = text//repeat(' ', length - len(line))//return//line
   end function line_over
end module progress
