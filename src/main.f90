!> Level 23. The command kinmat: arguments, exit status; the only STOP.
program main
   use, intrinsic :: iso_fortran_env, only: error_unit
   use, intrinsic :: iso_c_binding, only: c_int
   use kinds, only: wp_name
   use failures, only: failure_t
   use command_line, only: options_t, read_command, help_text
   use cards, only: ruler_card
   use job, only: run_job
   use study, only: run_study
   use trials_job, only: run_trials
   use text_output, only: output_t, open_output, put, close_output
   implicit none

   interface
      integer(c_int) function isatty(descriptor) bind(c)
         import :: c_int
         integer(c_int), value :: descriptor
      end function isatty
   end interface

   character(*), parameter :: version = 'KINMAT 1.0, '//wp_name
   type(options_t) :: options
   type(failure_t), allocatable :: failure
   character(:), allocatable :: message
   integer :: status

   call read_command(options, failure)
   if (allocated(failure)) then
      write (error_unit, '(a)') ' *** '//failure%text
      call leave(failure%status)
   end if
   if (command_argument_count() == 0) then
      if (isatty(0_c_int) /= 0) options%show = 'HELP'
   end if
   select case (options%show)
   case ('HELP')
      call show(help_text())
   case ('VERSION')
      call show(version)
   case ('RULER')
      call show(ruler_card())
   case default
      if (options%study) then
         call run_study(options%deck, options%output, status, message)
      else if (len(options%trials) > 0) then
         call run_trials(options%trials, options%deck, options%output, status, message)
      else
         call run_job(options, status, message)
      end if
      if (len(message) > 0) write (error_unit, '(a)') message
      call leave(status)
   end select

contains

   !> One text on standard output.
   subroutine show(text)
      character(*), intent(in) :: text
      type(output_t) :: o

      call open_output(o, '', failure)
      call put(o, text)
      call close_output(o, failure)
      if (.not. allocated(failure)) return
      write (error_unit, '(a)') ' *** '//failure%text
      call leave(failure%status)
   end subroutine show

   !> Ends the process with an exit status and no word of its own.
   subroutine leave(status)
      integer, intent(in) :: status

      flush (error_unit)
      stop status, quiet=.true.
   end subroutine leave
end program main
