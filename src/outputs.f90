!> The files that a job writes: those that all sets share, and those of which each set has its own, open while it is
!> computed.
module outputs
   use, intrinsic :: iso_c_binding, only: c_int
   use failures, only: failure_t, fail, status_rejected
   use text_output, only: output_t, open_output, check_apart, close_output, abandon_output
   use system_calls, only: identity_t, identity_of, signal_received
   use number_format, only: whole
   use command_line, only: options_t, out_shared, out_table, out_last
   implicit none
   private
   public :: outputs_t, job_chunk_t, open_outputs, open_table, close_outputs, is_over

   !> The part of a job in several processes that this process computes; `shares` divides the job.
   type :: job_chunk_t
      character(:), allocatable :: kind         !< SETS or VARIANTS
      integer :: first = 1, last = 0            !< of the whole share: of all parts
      integer :: length = huge(1)               !< sets or variants of a part
      integer :: unit = 1                       !< variants that are solved together
      logical :: is_child = .false.             !< this process is a child
      !> Descriptors of two files, whose positions all processes share: how many parts are taken, how many are done. The
      !> lock of a part is that of a byte of the first.
      integer(c_int) :: taken = -1, done = -1
      integer :: part = 0                       !< number of the current part
      logical :: held = .false.                 !< the text of the current part is held
      integer :: look = 0                       !< characters that an output holds at the next look for the turn
      integer, allocatable :: waiting(:)        !< (any number) complete parts whose turn has not come
      integer, allocatable :: lengths(:, :)     !< (outputs, waiting) characters of these parts in each output
   end type job_chunk_t


   !> The outputs of a job, or of a process of it.
   type :: outputs_t
      logical :: asked(out_last) = .false.                  !< the command asks for these: no other is open
      type(output_t) :: files(out_last)                     !< up to `out_shared` of all sets, then of the current set
      type(failure_t), allocatable :: failure               !< of the last file that could not be opened or written
      type(job_chunk_t) :: share                            !< of this process
      !> The sets that this process computes now; if the deck has VARY cards, numbers of variants, counted through all
      !> sets.
      integer :: own_first = 1, own_last = 0
      logical :: ended = .false.                            !< before the end: the last line of the listing says so
   end type outputs_t

contains

   !> Opens the outputs that all sets share, and checks that the outputs of each set can be opened. Only outputs that
   !> the options ask for are opened.
   !>
   !> Errors: status_system if a file cannot be opened; status_rejected if two outputs are one file, or if several
   !> tables would follow one another on standard output. After an error no output is open.
   subroutine open_outputs(options, first, last, count, outputs, failure)
      type(options_t), intent(in) :: options   !< of the command
      integer, intent(in) :: first, last     !< numbers of the first and the last set that are computed
      integer, intent(in) :: count           !< sets in the deck
      class(outputs_t), intent(inout) :: outputs   !< gets the files
      type(failure_t), allocatable, intent(out) :: failure   !< not allocated: all are open
      integer :: k, i

      outputs%asked = [(allocated(options%files(k)%text), k=1, out_last)]
      do k = 1, out_shared
         if (outputs%asked(k) .and. .not. allocated(failure)) &
            call open_output(outputs%files(k), options%files(k)%text, failure)
      end do

      if (outputs%asked(out_table) .and. first < last .and. .not. allocated(failure)) then
         if (len(options%files(out_table)%text) == 0) call fail(failure, status_rejected, &
            'STANDARD OUTPUT TAKES ONE TABLE ONLY: CHOOSE A SET OF '//whole(count)//' WITH --sets K/' &
            //whole(count))
      end if
      if (.not. allocated(failure)) call check_apart(outputs%files, options%deck, failure)

      do i = first, last
         if (allocated(failure)) exit
         call open_table(options, first, last, i, .true., outputs, failure)
         call abandon_output(outputs%files(out_table))
      end do
      if (allocated(failure)) call abandon_output(outputs%files)
   end subroutine open_outputs

   !> Opens the table of a set, if tables are asked for. If several sets are computed, the name of its file has the
   !> number of the set before its extension.
   !>
   !> Errors: status_system if the file cannot be opened; status_rejected if it is the deck or another output.
   subroutine open_table(options, first, last, i, tries, outputs, failure)
      type(options_t), intent(in) :: options   !< of the command
      integer, intent(in) :: first, last     !< numbers of the first and the last set that are computed
      integer, intent(in) :: i               !< number of the set, from `first` to `last`
      logical, intent(in) :: tries           !< a check: devices and pipes stay closed, for their readers would leave
      class(outputs_t), intent(inout) :: outputs   !< with the shared files; gets the table
      type(failure_t), allocatable, intent(out) :: failure   !< not allocated: open, or no table is asked for
      type(identity_t) :: there
      character(:), allocatable :: path
      integer :: dot

      if (.not. outputs%asked(out_table)) return
      path = options%files(out_table)%text
      dot = index(path, '.', back=.true.)
      ! A name without an extension ends with the number.
      if (dot <= index(path, '/', back=.true.) + 1) dot = len(path) + 1
      if (first < last) path = path(:dot - 1)//'-'//whole(i)//path(dot:)
      there = identity_of(path)
      if (.not. (tries .and. there%device_or_pipe)) call open_output(outputs%files(out_table), path, failure)
      if (.not. allocated(failure)) call check_apart(outputs%files, options%deck, failure)
   end subroutine open_table

   !> Closes several outputs. outputs%failure becomes the failure of the last one that could not be written.
   subroutine close_outputs(outputs, first, last)
      class(outputs_t), intent(inout) :: outputs   !< open or not
      integer, intent(in) :: first, last     !< the outputs: out_listing, ..., out_table
      type(failure_t), allocatable :: failure
      integer :: k

      do k = first, last
         if (.not. allocated(outputs%files(k)%buffer)) cycle
         call close_output(outputs%files(k), failure)
         if (allocated(failure)) call move_alloc(failure, outputs%failure)
      end do
   end subroutine close_outputs

   !> Tells whether the rest of the job need not be computed: an output has failed, or a signal has come.
   logical function is_over(outputs)
      class(outputs_t), intent(in) :: outputs   !< of the job

      is_over = signal_received() > 0 .or. allocated(outputs%failure) .or. any(outputs%files%error /= 0)
   end function is_over
end module outputs
