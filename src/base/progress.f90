!> How far a long run is, on a terminal: one line on standard error, rewritten, and gone at the end.
module progress
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64
   use system_calls, only: isatty, write_bytes
   implicit none
   private
   public :: progress_t, start_progress, show_progress, end_progress

   integer(c_int), parameter :: standard_output = 1, standard_error = 2
   !> Runs shorter than this many seconds show nothing; the line then changes so many times a second.
   integer, parameter :: first_seconds = 2, changes_a_second = 4
   !> Every line has this length, so that each covers the one before it.
   integer, parameter :: line_length = 58
   character(1), parameter :: return = achar(13)

   type :: progress_t
      logical :: shown = .false.      !< there is somebody to show it to
      integer(int64) :: due = 0       !< the count of the clock at which the line is written next
      logical :: stands = .false.     !< a line stands on the terminal
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
      integer(c_size_t) :: written
      character(line_length) :: line

      if (.not. p%shown) return
      call system_clock(count, rate)
      if (count < p%due) return
      p%due = count + rate/changes_a_second
      write (line, '(1x, a, 1x, i0, a, i0)') words, k, ' OF ', n
      ! What is not written is no error: it is no result.
      written = write_bytes(standard_error, return//line)
      p%stands = .true.
   end subroutine show_progress

   !> Takes the line away, before something else is printed.
   subroutine end_progress(p)
      type(progress_t), intent(inout) :: p

      integer(c_size_t) :: written

      if (p%stands) written = write_bytes(standard_error, return//repeat(' ', line_length)//return)
      p%stands = .false.
   end subroutine end_progress
end module progress
