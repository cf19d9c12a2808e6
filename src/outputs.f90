!> The files that a job writes: those that all sets share, and those of which each set has its own.
module outputs
   use, intrinsic :: iso_c_binding, only: c_int, c_null_char
   use failures, only: failure_t, fail, capitals, status_system, status_rejected
   use text_output, only: output_t, open_output, check_apart, flush_output, close_output, forget_output, &
      abandon_output, has_failed
   use system_calls, only: identity_t, identity_of, make_directory, rmdir, last_error, reason_of, &
      signal_received
   use numerals, only: whole
   use command_line, only: options_t, file_options, out_last
   implicit none
   private
   public :: outputs_t, share_of_job_t, open_outputs, flush_files, forget_files, close_outputs, is_over, set_suffix

   !> The part of a job in several processes that this process computes; `shares` divides the job.
   type :: share_of_job_t
      character(:), allocatable :: kind         !< SETS or VARIANTS
      integer :: first = 1, last = 0            !< all of them
      integer :: length = huge(1)               !< so many of them are a part
      integer :: unit = 1                       !< so many variants are solved together
      logical :: is_child = .false., is_parent = .false.
      !> Descriptors of two files, whose positions all processes share: how many parts are taken, how many are done. The
      !> lock of a part is that of a byte of the first.
      integer(c_int) :: taken = -1, done = -1
      integer :: part = 0                       !< the one at hand
      logical :: held = .false.                 !< its text is held
      integer :: look = 0                       !< it is looked for the turn where an output holds so much
      integer, allocatable :: waiting(:)        !< complete parts before it, whose turn has not come
      integer, allocatable :: lengths(:, :)     !< the characters that each output holds of them
   end type share_of_job_t

   type :: outputs_t
      logical :: asked(out_last) = .false.                  !< the command asks for them: no other is open
      integer, allocatable :: asked_list(:)                 !< the numbers of those
      !> (out_last, 0:sets or 0) In column 0 those that all sets share; in column i those of set number i.
      type(output_t), allocatable :: files(:, :)
      character(:), allocatable :: made_directory           !< that was not there before
      type(share_of_job_t) :: share
      !> The sets that this process computes now; where the deck has VARY cards, numbers of variants, counted through
      !> all sets.
      integer :: own_first = 1, own_last = 0
      logical :: ended = .false.                            !< before its time: the listing says so in its last line
   end type outputs_t

contains

   !> Opens the outputs that `options` ask for, for the sets `first` to `last` of the deck's `count`. Errors:
   !> status_system; status_rejected where two of them are one file, or would be one after another on standard output.
   subroutine open_outputs(options, first, last, count, o, failure)
      type(options_t), intent(in) :: options
      integer, intent(in) :: first, last, count
      class(outputs_t), intent(inout), target :: o
      type(failure_t), allocatable, intent(out) :: failure
      type(output_t), pointer :: all_files(:)
      logical :: made, exists
      integer :: k, i

      o%asked = [(allocated(options%files(k)%text), k=1, out_last)]
      o%asked_list = pack([(k, k=1, out_last)], o%asked)
      allocate (o%files(out_last, 0:merge(last, 0, any(o%asked .and. file_options%each_set))))
      do k = 1, out_last
         if (.not. o%asked(k)) cycle
         if (len_trim(file_options(k)%in_directory) > 0 .and. .not. allocated(failure)) then
            ! What else is wrong with a directory shows when its files are opened.
            call make_directory(options%files(k)%text, made, exists)
            if (made) o%made_directory = options%files(k)%text
            if (.not. exists) call fail(failure, status_system, 'DIRECTORY '//options%files(k)%text &
               //' CANNOT BE MADE ('//capitals(reason_of(last_error()))//')')
         end if
         if (first < last .and. file_options(k)%each_set .and. .not. allocated(failure)) &
            call check_table_of_one(options%files(k)%text)
         do i = merge(first, 0, file_options(k)%each_set), merge(last, 0, file_options(k)%each_set)
            if (allocated(failure)) exit
            call open_output(o%files(k, i), path_of(set_suffix(first, last, i)), failure)
         end do
      end do
      all_files(1:size(o%files)) => o%files
      if (.not. allocated(failure)) call check_apart(all_files, options%deck, failure)
      if (.not. allocated(failure)) return
      do i = 1, size(all_files)
         call abandon_output(all_files(i))
      end do
      if (allocated(o%made_directory)) i = rmdir(o%made_directory//c_null_char)

   contains

      !> Rejects standard output, a pipe, and a device other than /dev/null as `path` for the tables of `count` sets:
      !> they would be mixed. Under /dev no file is made. Errors: status_rejected.
      subroutine check_table_of_one(path)
         character(*), intent(in) :: path
         type(identity_t) :: id
         character(:), allocatable :: name

         name = 'STANDARD OUTPUT'
         if (len(path) > 0) then
            if (is_null_device(path)) return
            id = identity_of(path=path)
            if (.not. id%device_or_pipe .and. (index(path, '/dev/') /= 1 .or. index(path, '/dev/shm/') == 1)) return
            name = 'FILE '//path
         end if
         call fail(failure, status_rejected, name//' TAKES ONE TABLE ONLY: CHOOSE A SET OF '//whole(count) &
            //' WITH --sets K/'//whole(count))
      end subroutine check_table_of_one

      !> The path of output number `k`, in which files of a set have the `suffix`; '' is standard output. /dev/null
      !> takes the files of all sets.
      function path_of(suffix) result(path)
         character(*), intent(in) :: suffix
         character(:), allocatable :: path
         integer :: dot

         path = options%files(k)%text
         if (len_trim(file_options(k)%in_directory) > 0) path = path//'/'//trim(file_options(k)%in_directory)
         if (len(path) == 0) return
         if (is_null_device(path)) return
         dot = index(path, '.', back=.true.)
         ! A name without an extension ends with the suffix.
         if (dot <= index(path, '/', back=.true.) + 1) dot = len(path) + 1
         path = path(:dot - 1)//suffix//path(dot:)
      end function path_of
   end subroutine open_outputs

   !> Whether `path` leads to the device that takes everything and keeps nothing.
   logical function is_null_device(path)
      character(*), intent(in) :: path
      type(identity_t) :: a, b

      a = identity_of(path=path)
      b = identity_of(path='/dev/null')
      is_null_device = a%device_or_pipe .and. a%inode == b%inode .and. all(a%device == b%device)
   end function is_null_device

   !> What the names of files have before their extension for set number `i`, where the job has more than one set, those
   !> from `first` to `last`; '' for files that all sets share (0).
   pure function set_suffix(first, last, i) result(suffix)
      integer, intent(in) :: first, last, i
      character(:), allocatable :: suffix

      suffix = ''
      if (first < last .and. i > 0) suffix = '-'//whole(i)
   end function set_suffix

   !> Writes at once what there is for the files of the sets from `first` to `last`, or for those that all sets share
   !> (0).
   subroutine flush_files(o, first, last)
      class(outputs_t), intent(inout) :: o
      integer, intent(in) :: first, last
      integer :: k, i

      do i = first, min(last, ubound(o%files, 2))
         do k = 1, out_last
            if (allocated(o%files(k, i)%buffer)) call flush_output(o%files(k, i))
         end do
      end do
   end subroutine flush_files

   !> Leaves the files of the sets from `first` to `last` to other processes.
   subroutine forget_files(o, first, last)
      class(outputs_t), intent(inout) :: o
      integer, intent(in) :: first, last
      integer :: i

      do i = first, min(last, ubound(o%files, 2))
         call forget_output(o%files(:, i))
      end do
   end subroutine forget_files

   !> Closes all outputs; `failure`: that of the last one that could not be written.
   subroutine close_outputs(o, failure)
      class(outputs_t), intent(inout) :: o
      type(failure_t), allocatable, intent(out) :: failure
      type(failure_t), allocatable :: other
      integer :: k, i

      do i = 0, ubound(o%files, 2)
         do k = 1, out_last
            if (.not. allocated(o%files(k, i)%buffer)) cycle
            call close_output(o%files(k, i), other)
            if (allocated(other)) call move_alloc(other, failure)
         end do
      end do
   end subroutine close_outputs

   !> What follows in set number `i` need not be computed: a write has failed, or a signal has come.
   logical function is_over(o, i)
      class(outputs_t), intent(in) :: o
      integer, intent(in) :: i
      integer :: k

      is_over = signal_received() > 0
      ! Only what was asked for: this is asked after every instant.
      do k = 1, size(o%asked_list)
         if (has_failed(o%files(o%asked_list(k), merge(i, 0, file_options(o%asked_list(k))%each_set)))) is_over = .true.
      end do
   end function is_over
end module outputs
