!> The answer to the card RANGE in the listing: the ends of the range of each drive.
module ranges_table
   use independent, only: set_t
   use set_members, only: name_of_drive
   use ranges, only: range_t, lower_end, upper_end
   use listing, only: at_limit, full_turn_words, measure, value_digits
   use listing_layout, only: write_folded
   use text_output, only: output_t, put
   use number_format, only: whole
   use phrases
   implicit none
   private
   public :: write_ranges, side_words

   !> The words for both ends of a range.
   character(3), parameter :: side_words(lower_end:upper_end) = ['MIN', 'MAX']

contains

   !> Writes the ranges of drives after the last instant of a set.
   subroutine write_ranges(o, set, list)
      type(output_t), intent(inout) :: o     !< the listing
      class(set_t), intent(in) :: set        !< of the ranges
      type(range_t), intent(in) :: list(:)   !< (any number) in the order of the drives
      character(:), allocatable :: words
      integer :: i, side

      call put(o, '')
      call put(o, ' '//phrase(text_range, set%polish))
      if (size(list) == 0) call put(o, '   '//phrase(text_none, set%polish))
      do i = 1, size(list)
         associate (r => list(i))
            words = name_of_drive(set, r%part, r%drive)
            if (r%is_of_branch) words = words//'   '//phrase(text_range_of_branch, set%polish)
            call put(o, ' '//words)
            if (r%is_all) then
               call put(o, '   '//full_turn_words(r%turns, set%polish))
            else
               do side = lower_end, upper_end
                  words = measure(set, r%limit(side), value_digits)
                  if (r%limit(side)%links(1) + r%limit(side)%pair > 0) &
                     words = words//'   '//at_limit(set, r%limit(side))
                  ! Without links or a pair at the limit rounding is too coarse to follow the motion farther.
                  if (r%has_limit(side) .and. r%limit(side)%links(1) + r%limit(side)%pair == 0) &
                     words = words//'   '//phrase(text_close, set%polish)
                  if (r%has_limit(side)) then
                     call write_folded(o, '   '//side_words(side)//'  ', words, repeat(' ', 8))
                  else
                     call put(o, '   '//side_words(side)//'  '//phrase(text_no_limit, set%polish)//' '//words)
                  end if
               end do
            end if
            if (r%change_points > 0) &
               call put(o, '   '//phrase(text_on_the_way, set%polish)//' '//whole(r%change_points))
         end associate
      end do
   end subroutine write_ranges
end module ranges_table
