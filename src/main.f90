!> The command kinmat: arguments, exit status; the only STOP.
program main
   use, intrinsic :: iso_fortran_env, only: error_unit
   use, intrinsic :: iso_c_binding, only: c_int
   use kinds, only: program_name, wp_name
   use failures, only: failure_t, capitals, status_signal
   use system_calls, only: occupy_standard_descriptors, end_by_signal, isatty
   use command_line, only: options_t, out_listing, read_command, explained
   use document_texts, only: help_on
   use cards, only: layout_of
   use job, only: run_job
   use study, only: run_study
   use text_output, only: output_t, open_output, put, close_output
   implicit none

   type(options_t) :: options
   type(failure_t), allocatable :: failure
   character(:), allocatable :: message
   integer :: status

   call occupy_standard_descriptors
   call read_command(options, failure)
   if (allocated(failure)) call leave(failure%status, ' *** '//failure%text)
   if (command_argument_count() == 0) then
      if (isatty(0_c_int) /= 0) options%show = 'HELP'
   end if

   select case (options%show)
   case ('HELP')
      call show(help_on(''))
   case ('VERSION')
      call show(program_name//', '//wp_name)
   case ('RULER')
      message = layout_of(options%deck)
      if (len(options%deck) > 0) message = message//new_line('a')//help_on(capitals(options%deck))
      call show(message)
   case ('EXPLAIN')
      call show(explained(options%deck))
   case default
      if (options%study .or. options%time) then
         call run_study(options%deck, options%files(out_listing)%text, options%time, status, message)
      else
         call run_job(options, status, message)
      end if
      call leave(status, message)
   end select

contains

   !> Writes a text on standard output. If the output fails, the process ends with a message and the failure's status.
   subroutine show(text)
      character(*), intent(in) :: text       !< one or several lines, without the end of the last
      type(output_t) :: o

      call open_output(o, '', failure)
      if (.not. allocated(failure)) then
         call put(o, text)
         call close_output(o, failure)
      end if
      if (allocated(failure)) call leave(failure%status, ' *** '//failure%text)
   end subroutine show

   !> Ends the process with an exit status, or by the signal that the status stands for.
   subroutine leave(status, message)
      integer, intent(in) :: status          !< exit status; above status_signal, the number of a signal is added to it
      character(*), intent(in) :: message    !< lines for standard error; '': none
      integer :: ignored

      if (len(message) > 0) write (error_unit, '(a)', iostat=ignored) message
      flush (error_unit, iostat=ignored)
      if (status > status_signal) call end_by_signal(status - status_signal)
      stop status, quiet=.true.
   end subroutine leave
end program main
