!> The parts of a job that this process computes, and their text. It is held in memory until all parts before are
!> written; meanwhile the process goes on with further parts, as long as no output holds too much.
module parts_in_turn
   use text_output, only: output_t, hold_output, held_length, write_held, release_output, drop_held, has_failed, &
      turn_lost
   use turns, only: turns_t, take_part, has_turn, wait_for_turn, pass_turn
   implicit none
   private
   public :: parts_in_turn_t, begin_part, end_part, write_in_turn, write_rest

   !> An output that holds more characters than these waits for its turn after the instant. Its buffer, twice as large
   !> at most, is 128 MB unless the text of an instant is longer.
   integer, parameter :: max_held = 2**26
   !> An output that holds more than these begins no further part.
   integer, parameter :: max_ahead = 2**24
   !> After so many characters it is looked whether the turn has come: in a block's time it may.
   integer, parameter :: look_length = 65536

   type :: parts_in_turn_t
      type(turns_t) :: turns
      integer :: part = 0                       !< the one at hand
      logical :: held = .false.                 !< its text is held
      integer :: look = 0                       !< it is looked for the turn where an output holds so much
      integer, allocatable :: waiting(:)        !< complete parts before it, whose turn has not come
      integer, allocatable :: lengths(:, :)     !< the characters that each output holds of them
   end type parts_in_turn_t

contains

   !> Takes the next part; p%part is greater than `parts` if there is none. `files`: the outputs that all parts share.
   subroutine begin_part(p, parts, files)
      type(parts_in_turn_t), intent(inout) :: p
      integer, intent(in) :: parts
      type(output_t), intent(inout) :: files(:)
      integer :: k

      if (.not. allocated(p%waiting)) allocate (p%waiting(0), p%lengths(size(files), 0))
      p%part = take_part(p%turns)
      p%held = p%part <= parts
      if (.not. p%held) return
      do k = 1, size(files)
         if (.not. allocated(files(k)%buffer)) cycle
         call hold_output(files(k))
         ! What the first part has emptied is not emptied again.
         files(k)%emptied = p%part > 1 .or. len(files(k)%path) == 0
      end do
      call write_what_may_be(p, files, max_held)
   end subroutine begin_part

   !> Ends the part at hand. One that is not `complete` is written in its turn, and no part after it.
   subroutine end_part(p, files, complete)
      type(parts_in_turn_t), intent(inout) :: p
      type(output_t), intent(inout) :: files(:)
      logical, intent(in) :: complete
      integer :: lengths(size(files)), k

      if (.not. complete) then
         call write_rest(p, files)
         return
      end if
      lengths = [(lengths_of(k), k=1, size(files))] - sum(p%lengths, 2)
      p%lengths = reshape([p%lengths, lengths], [size(files), size(p%waiting) + 1])
      p%waiting = [p%waiting, p%part]
      p%held = .false.
      call write_what_may_be(p, files, max_ahead)

   contains

      !> What output number `k` has not written.
      integer function lengths_of(k)
         integer, intent(in) :: k

         lengths_of = 0
         if (allocated(files(k)%buffer)) lengths_of = held_length(files(k))
      end function lengths_of
   end subroutine end_part

   !> Writes what may be written, if there is much; waits where an output holds too much.
   subroutine write_in_turn(p, files)
      type(parts_in_turn_t), intent(inout) :: p
      type(output_t), intent(inout) :: files(:)

      if (.not. p%held) return
      if (most_held(files) >= p%look) call write_what_may_be(p, files, max_held)
   end subroutine write_in_turn

   !> Writes all, when its turn has come.
   subroutine write_rest(p, files)
      type(parts_in_turn_t), intent(inout) :: p
      type(output_t), intent(inout) :: files(:)

      call write_what_may_be(p, files, -1)
   end subroutine write_rest

   !> Writes the parts whose turn has come; waits for it as long as an output holds more than `most` characters. An
   !> error, or a turn that never comes, is that of `files`, and what is held is dropped.
   subroutine write_what_may_be(p, files, most)
      type(parts_in_turn_t), intent(inout) :: p
      type(output_t), intent(inout) :: files(:)
      integer, intent(in) :: most
      integer :: part

      do while (size(p%waiting) > 0 .or. p%held)
         if (any(has_failed(files))) exit
         part = p%part
         if (size(p%waiting) > 0) part = p%waiting(1)
         if (.not. has_turn(p%turns, part)) then
            p%look = most_held(files) + look_length
            if (most_held(files) <= most) return
            if (.not. wait_for_turn(p%turns, part)) then
               files%error = turn_lost
               exit
            end if
         end if
         call write_part()
      end do
      if (any(has_failed(files)) .and. (size(p%waiting) > 0 .or. p%held)) call drop_held(files)

   contains

      !> Writes the first part that waits, or what there is of the part at hand, whose further text is not held.
      subroutine write_part()
         integer :: k

         do k = 1, size(files)
            if (.not. allocated(files(k)%buffer)) cycle
            if (size(p%waiting) > 0) call write_held(files(k), p%lengths(k, 1))
            if (size(p%waiting) == 0) call release_output(files(k))
         end do
         if (size(p%waiting) == 0) then
            p%held = .false.
         else if (.not. any(has_failed(files))) then
            call pass_turn(p%turns, part)
            p%waiting = p%waiting(2:)
            p%lengths = p%lengths(:, 2:)
         end if
      end subroutine write_part
   end subroutine write_what_may_be

   !> The characters of the output that holds the most.
   pure integer function most_held(files)
      type(output_t), intent(in) :: files(:)
      integer :: k

      most_held = 0
      do k = 1, size(files)
         if (allocated(files(k)%buffer)) most_held = max(most_held, held_length(files(k)))
      end do
   end function most_held
end module parts_in_turn
