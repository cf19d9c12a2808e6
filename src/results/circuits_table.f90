!> The answer to the card CIRCUITS in the listing: a row for each branch, then the dead points and the change points.
module circuits_table
   use kinds, only: wp
   use motion, only: diagnostic_t, diagnostic_limit
   use independent, only: set_t
   use set_members, only: name_of_drive
   use circuit_trace, only: end_closed, end_far, end_shut
   use circuits, only: circuits_t, circuit_branch_t, revolutions_of
   use set_circuits, only: known
   use ranges_table, only: side_words
   use text_output, only: output_t, put
   use number_format, only: whole
   use listing, only: at_limit, full_turn_words, measure, value_digits
   use listing_layout, only: write_folded, angle_unit
   use phrases
   implicit none
   private
   public :: write_circuits

   !> The last characters before the columns of branch, assemblies and the range of the drive.
   integer, parameter :: column_ends(3) = [9, 17, 31]
   !> An end of a branch without a dead point: a slide goes to infinity, the circuit could not be followed, or a
   !> cylinder has the length 0.
   type(phrase_t), parameter :: end_words(end_far:end_shut) = [text_not_limited, text_lost, text_shut]
   !> Digits of the drive's value at which circuits meet: it is known to the root of a rounding.
   integer, parameter :: change_point_digits = 6

contains

   !> Writes the circuits of a set at the end of its listing, drive after drive.
   subroutine write_circuits(o, set, list)
      type(output_t), intent(inout) :: o
      class(set_t), intent(in) :: set        !< of the circuits
      type(circuits_t), intent(in) :: list(:)   !< (drives)
      integer :: n

      call put(o, '')
      do n = 1, size(list)
         if (n > 1) call put(o, '')
         associate (found => list(n))
            call put(o, ' '//phrase(text_circuits, set%polish)//', '//phrase(text_drive, set%polish)//' ' &
               //name_of_drive(set, found%part, found%drive))
            if (.not. found%is_complete) call put(o, ' *** '//phrase(text_circuits_missing, set%polish))
            if (found%are_more) &
               call put(o, ' *** '//phrase(text_more_circuits, set%polish)//' '//whole(size(found%list)))
            if (found%is_redundant) then
               call put(o, ' *** '//phrase(text_not_followed, set%polish))
            else if (size(found%list) == 0) then
               call put(o, '   '//phrase(text_none, set%polish))
            else
               call write_branches(o, set, found)
            end if
         end associate
      end do
   end subroutine write_circuits

   !> Writes a row for each branch of the circuits of a drive, then the dead points and the change points.
   subroutine write_branches(o, set, found)
      type(output_t), intent(inout) :: o
      class(set_t), intent(in) :: set        !< of the circuits
      type(circuits_t), intent(in) :: found   !< of the drive
      character(column_ends(3)) :: row
      character(:), allocatable :: text
      type(diagnostic_t) :: position
      integer :: i, k

      row = ' '//phrase(text_circuit, set%polish)
      row(column_ends(1) + 1:) = phrase(text_branch, set%polish)
      row(column_ends(2) + 1:) = phrase(text_assembly_number, set%polish)
      call put(o, row//phrase(text_range_of, set%polish)//' '//name_of_drive(set, found%part, found%drive)//', ' &
         //trim(merge(angle_unit(set), set%length_unit, found%curve%is_angle)))
      do k = 1, size(found%branches)
         associate (b => found%branches(k))
            text = words_of(b%assemblies)
            row = ' '//whole(b%circuit)
            row(column_ends(1) + 1:) = whole(k)
            ! If there are more assemblies than the column has room for, the range follows them.
            text = text(2:)
            text = row(:column_ends(2))//text//repeat(' ', max(1, column_ends(3) - column_ends(2) - len(text)))
            call write_folded(o, text, range_words(set, found, b), repeat(' ', len(text)))
         end associate
      end do

      ! For each dead point the drive's value, links, and the branches that end there.
      if (size(found%dead) > 0) call put(o, ' '//phrase(text_dead_points, set%polish))
      do i = 1, size(found%dead)
         position = found%dead(i)
         position%part = found%part
         text = meeting_words(text_branch, text_branches, pack([(k, k=1, size(found%branches))], &
            [(any(found%branches(k)%dead == i), k=1, size(found%branches))]), set%polish)//' ' &
            //value_words(set, found, position%value)
         if (position%links(1) > 0) text = text//', '//at_limit(set, position)
         call write_folded(o, '   ', text, repeat(' ', 6))
      end do

      ! For each change point the circuits that meet there, and the drive's value.
      if (size(found%meetings) > 0) call put(o, ' '//phrase(text_change_points, set%polish))
      do i = 1, size(found%meetings)
         position = diagnostic_t(diagnostic_limit, is_angle=found%curve%is_angle, value=found%meetings(i)%value)
         if (abs(position%value) <= sqrt(epsilon(1.0_wp))) position%value = 0.0_wp
         call put(o, '   '//meeting_words(text_circuit, text_circuit_numbers, &
            pack([(k, k=1, size(found%list))], found%meetings(i)%circuits), set%polish)//' ' &
            //measure(set, position, change_point_digits))
      end do
   end subroutine write_branches

   !> Gives the range of the drive on a branch in words, and why it ends without a dead point.
   function range_words(set, found, branch) result(text)
      class(set_t), intent(in) :: set        !< of the circuits
      type(circuits_t), intent(in) :: found   !< of the drive
      type(circuit_branch_t), intent(in) :: branch   !< of these circuits
      character(:), allocatable :: text
      logical :: rises
      integer :: side

      associate (circuit => found%list(branch%circuit))
         if (circuit%rests) then
            text = phrase(text_at_rest, set%polish)//' '//value_words(set, found, branch%range(1))
         else if (all(circuit%ends == end_closed) .and. all(branch%dead == 0)) then
            text = full_turn_words(revolutions_of(circuit), set%polish)
         else
            ! The head of the column has their unit.
            text = value_words(set, found, branch%range(1))
            text = text(:index(text, ' '))//'.. '//value_words(set, found, branch%range(2))
            text = text(:index(text, ' ', back=.true.) - 1)
            rises = circuit%points(branch%first)%value(0) < circuit%points(branch%last)%value(0)
            do side = 1, 2
               if (branch%dead(side) == 0) text = text//'   '//side_words(side)//': ' &
                  //phrase(end_words(circuit%ends(merge(side, 3 - side, rises))), set%polish)
            end do
         end if
      end associate
   end function range_words

   !> Gives a value of the free drive with its unit; 0 if the value is no more than rounding.
   function value_words(set, found, number) result(words)
      class(set_t), intent(in) :: set        !< of the circuits
      type(circuits_t), intent(in) :: found   !< of the drive
      real(wp), intent(in) :: number         !< rad or length
      character(:), allocatable :: words

      words = measure(set, diagnostic_t(diagnostic_limit, is_angle=found%curve%is_angle, value=known(number)), &
         value_digits)
   end function value_words

   !> Gives the words before the value of the drive at a dead point or a change point: BRANCHES 1 AND 2 MEET AT, or
   !> BRANCH 1 AT.
   function meeting_words(one, many, numbers, polish) result(text)
      type(phrase_t), intent(in) :: one, many   !< the word for one branch or circuit, and for several
      integer, intent(in) :: numbers(:)      !< (1 or more) of the branches or circuits that meet
      logical, intent(in) :: polish          !< in Polish
      character(:), allocatable :: text
      integer :: n

      n = size(numbers)
      if (n == 1) then
         text = phrase(one, polish)//words_of(numbers)
      else
         text = phrase(many, polish)//words_of(numbers(:n - 1))//' '//phrase(text_and, polish)//words_of(numbers(n:)) &
            //' '//phrase(text_meet, polish)
      end if
      text = text//' '//phrase(text_at, polish)
   end function meeting_words

   !> Gives numbers as text, a blank before each.
   pure function words_of(numbers) result(text)
      integer, intent(in) :: numbers(:)      !< (any number)
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(numbers)
         text = text//' '//whole(numbers(i))
      end do
   end function words_of
end module circuits_table
