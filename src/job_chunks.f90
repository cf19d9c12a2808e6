!> A job's sets, or their variants, in several processes. They are divided into parts that follow one another. A free
!> process takes the next part. It holds the text of this part in memory until all parts before are written. Meanwhile
!> it goes on with further parts, as long as no output holds too much. A process that dies or is broken off leaves its
!> part undone, and no part after that is written.
!>
!> The system counts the parts that are taken and those that are done, in two files without a name, and keeps a lock for
!> each part that is computed: a process that waits for a part waits for its lock. The system opens the lock as well if
!> the process of the part dies.
!>
!> Rejected: a pipe from process to process. A part then belongs to a process before it begins, so that unequal parts
!> leave one idle.
!>
!> Rejected: threads. gfortran 12 keeps the lengths of character results in static memory, where threads write over each
!> other's: of 2000 sets in two threads, two listings had words cut short.
module job_chunks
   use, intrinsic :: iso_c_binding, only: c_int, c_long, c_null_char
   use failures, only: capitals, status_system, status_signal
   use number_format, only: whole
   use processes, only: waitpid, no_hang, usleep, fork_process, interrupt_child, memfd_create, lseek, &
      from_here, change_lock, locked, unlocked
   use system_calls, only: signal_received, signal_pipe, last_error, reason_of
   use text_output, only: held_length, write_held, release_output, turn_lost
   use command_line, only: out_shared
   use outputs, only: outputs_t, job_chunk_t
   implicit none
   private
   public :: run_chunks, next_part, write_in_turn

   !> Parts for each process: the last ones end together, and text that waits is still in the processor's cache.
   integer, parameter :: parts_a_process = 1024
   !> Parts for each process, if variants are solved together: each part makes its structure again, which takes as long
   !> as several variants.
   integer, parameter :: parts_together = 32
   !> Microseconds after which the parent looks whether a child has ended or a signal has come.
   integer(c_int), parameter :: look_time = 2000

   !> An output that holds more characters than these waits for its turn after the instant. Its buffer, twice as large
   !> at most, is 128 MB unless the text of an instant is longer.
   integer, parameter :: max_held_length = 2**26
   !> A process of which an output holds more characters than these begins no further part.
   integer, parameter :: max_ahead = 2**24
   !> Characters of an output between two looks whether the turn has come: the time of a block of text.
   integer, parameter :: look_length = 65536
   !> The number of the lock of the process that takes a part: parts are counted from 1.
   integer, parameter :: taking = 0

contains

   !> Computes the sets or variants of the share `outputs%share` in several processes. The call returns more than once:
   !>
   !> - in each child, which computes the parts that `next_part` gives, and ends then;
   !> - in the parent when all is done: `next_part` gives no part.
   !>
   !> If a process cannot be started or was ended by a signal, the parent has its status and message.
   subroutine run_chunks(outputs, processes, status, message)
      class(outputs_t), intent(inout) :: outputs   !< open; in a child it holds its text
      integer, intent(in) :: processes       !< number of children, above 1
      integer, intent(inout) :: status       !< in the parent: the largest exit status
      character(:), allocatable, intent(inout) :: message   !< in the parent: of an error that no child has printed
      integer :: children(processes), started, k
      integer(c_int) :: ended(processes), ignored

      associate (s => outputs%share, count => outputs%share%last - outputs%share%first + 1)
         s%length = s%unit*max(1, count/(s%unit*processes*merge(parts_together, parts_a_process, s%unit > 1)))
         if (count < processes*s%length) s%length = (count - 1)/processes + 1

         ! The children.
         started = 0
         s%taken = memfd_create('taken'//c_null_char, 0_c_int)
         if (s%taken >= 0) s%done = memfd_create('done'//c_null_char, 0_c_int)
         if (s%done >= 0) started = processes
         do k = 1, started
            children(k) = fork_process()
            s%is_child = children(k) == 0
            if (s%is_child) then
               ! Files that it computes no part of are left as they are.
               outputs%files%emptied = .true.
               allocate (s%waiting(0), s%lengths(out_shared, 0))
               return
            end if
            if (children(k) < 0) started = k - 1
            if (children(k) < 0) exit
         end do

         if (started < processes) then
            status = status_system
            message = ' *** CANNOT START A PROCESS FOR'//text_of(s, started + 1)//' (' &
               //capitals(reason_of(last_error()))//')'
            call interrupt_child(children(:started))
         end if

         ended = 0
         do k = 1, started
            do while (waitpid(int(children(k), c_int), ended(k), no_hang) == 0)
               ignored = usleep(look_time)
               if (signal_received() > 0) call interrupt_child(children(k:started))
            end do
         end do

         do k = 1, started
            if (iand(ended(k), 127) == signal_pipe) then
               status = status_signal + signal_pipe
            else if (iand(ended(k), 127) == 0) then
               status = max(status, ishft(iand(ended(k), 65535), -8))
            else if (status < status_system) then
               ! All parts before its own are done.
               message = ' *** THE PROCESS FOR'//text_of(s, min(count_of(s%done) + 1, part_count(s))) &
                  //' WAS ENDED BY SIGNAL '//whole(iand(ended(k), 127))
               status = status_system
            end if
         end do

         ! The children have written these files, and computed all parts.
         outputs%files%emptied = .true.
         s%part = part_count(s)
      end associate
   end subroutine run_chunks

   !> Ends the current part, if there is one, and begins the next: its sets or variants are outputs%own_first to
   !> outputs%own_last. False if there is no further part or the job is over; then all is written.
   logical function next_part(outputs)
      class(outputs_t), intent(inout) :: outputs   !< of this process; get the next part
      integer :: k

      associate (s => outputs%share, files => outputs%files(:out_shared))
         if (s%is_child .and. s%part > 0) then
            if (goes_on(outputs)) then
               s%lengths = reshape([s%lengths, held_length(files) - sum(s%lengths, 2)], &
                  [size(files), size(s%waiting) + 1])
               s%waiting = [s%waiting, s%part]
               s%held = .false.
               call write_in_order(outputs, max_ahead)
            else
               ! A part that is not complete is written in its turn, and no part after it.
               call write_in_order(outputs, -1)
            end if
         end if

         next_part = goes_on(outputs)
         if (.not. s%is_child) then
            s%part = s%part + 1
         else if (next_part) then
            ! Nobody takes the one after it before it is locked.
            call change_lock(s%taken, taking, locked)
            s%part = int(lseek(s%taken, 1_c_long, from_here))
            call change_lock(s%taken, s%part, locked)
            call change_lock(s%taken, taking, unlocked)
            s%held = s%part <= part_count(s)
            if (s%held) then
               files%held = .true.
               do k = 1, size(files)
                  ! Files that the first part has emptied are not emptied again.
                  if (allocated(files(k)%buffer)) files(k)%emptied = s%part > 1 .or. len(files(k)%path) == 0
               end do
               call write_in_order(outputs, max_held_length)
            end if
         end if

         next_part = next_part .and. s%part <= part_count(s)
         outputs%own_first = first_of(s, s%part)
         outputs%own_last = first_of(s, s%part + 1) - 1

         if (s%is_child .and. .not. next_part) call write_in_order(outputs, -1)
      end associate
   end function next_part

   !> Writes the text whose turn has come, if there is much. It waits if an output holds too much.
   subroutine write_in_turn(outputs)
      class(outputs_t), intent(inout) :: outputs   !< of this process

      if (.not. outputs%share%held) return
      if (maxval(held_length(outputs%files(:out_shared))) >= outputs%share%look) call write_in_order(outputs, &
         max_held_length)
   end subroutine write_in_turn

   !> Writes the parts whose turn has come, and waits for the turn if an output holds too much. If a write fails or the
   !> turn never comes, the shared files have the error, and the held text is dropped.
   subroutine write_in_order(outputs, most)
      class(outputs_t), intent(inout) :: outputs   !< of this process
      integer, intent(in) :: most            !< characters that an output may hold without its turn; -1: none
      integer(c_long) :: done
      integer :: part, k

      associate (s => outputs%share, files => outputs%files(:out_shared))
         do while (size(s%waiting) > 0 .or. s%held)
            if (any(files%error /= 0)) exit
            part = s%part
            if (size(s%waiting) > 0) part = s%waiting(1)

            if (count_of(s%done) < part - 1) then
               s%look = maxval(held_length(files)) + look_length
               if (s%look - look_length <= most) return
               ! The part before is done, or will never be, when its lock is open.
               call change_lock(s%taken, part - 1, locked)
               call change_lock(s%taken, part - 1, unlocked)
               if (count_of(s%done) < part - 1) files%error = turn_lost
               cycle
            end if

            do k = 1, size(files)
               if (.not. allocated(files(k)%buffer)) cycle
               if (size(s%waiting) > 0) call write_held(files(k), s%lengths(k, 1))
               ! Further text of the current part is not held.
               if (size(s%waiting) == 0) call release_output(files(k))
            end do
            if (size(s%waiting) == 0) s%held = .false.
            if (size(s%waiting) == 0 .or. any(files%error /= 0)) cycle
            done = lseek(s%done, 1_c_long, from_here)
            call change_lock(s%taken, part, unlocked)
            s%waiting = s%waiting(2:)
            s%lengths = s%lengths(:, 2:)
         end do
         if (size(s%waiting) == 0 .and. .not. s%held) return
         files%written = 0
         files%used = 0
      end associate
   end subroutine write_in_order

   !> Tells whether the job goes on: the run has not ended before its time, and no write has failed.
   logical function goes_on(outputs)
      class(outputs_t), intent(in) :: outputs   !< of this process

      goes_on = .not. (outputs%ended .or. allocated(outputs%failure) .or. any(outputs%files%error /= 0))
   end function goes_on

   !> Counts the parts; 1 if there is nothing to compute.
   pure integer function part_count(share)
      type(job_chunk_t), intent(in) :: share   !< of the job

      part_count = max(1, (share%last - share%first)/share%length + 1)
   end function part_count

   !> Gives the first set or variant of a part; for a part after the last one, the number after the last of all.
   pure integer function first_of(share, part)
      type(job_chunk_t), intent(in) :: share   !< of the job
      integer, intent(in) :: part            !< counted from 1

      first_of = share%last + 1
      if (part <= part_count(share)) first_of = share%first + (part - 1)*share%length
   end function first_of

   !> Names a part, after a blank: SETS 5 TO 8, or VARIANTS 5 TO 8.
   pure function text_of(share, part) result(text)
      type(job_chunk_t), intent(in) :: share   !< of the job
      integer, intent(in) :: part            !< counted from 1
      character(:), allocatable :: text

      text = ' '//share%kind//' '//whole(first_of(share, part))//' TO '//whole(first_of(share, part + 1) - 1)
   end function text_of

   !> Counts the parts that all processes have taken or done: the position in a shared file; 0 without the file.
   integer function count_of(descriptor)
      integer(c_int), intent(in) :: descriptor   !< share%taken or share%done

      count_of = max(0, int(lseek(descriptor, 0_c_long, from_here)))
   end function count_of
end module job_chunks
