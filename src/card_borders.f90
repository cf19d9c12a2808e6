!> Level 4. Text that runs from one field of a card into the next.
module card_borders
   use kinds, only: wp
   use cards, only: card_t, field_t
   use deck_codes, only: border_crossed
   use numbers, only: read_real, flaw_none
   use complaints, only: complaints_t, complain, whole_text
   implicit none
   private
   public :: find_cuts

contains

   !> Marks in `cut` the fields of `fields` (in the order of their columns, each ending where the next one
   !> begins) whose text is cut by a border, and complains. Text is cut if it does not begin with its field
   !> and runs on behind the border, or if it is one real number only together with what stands there; the
   !> latter is asked where `numeric(i)`: field i may hold the beginning of a number. A full label beside
   !> a full label is no cut, nor are two full reals that cannot be one.
   subroutine find_cuts(card, fields, numeric, cut, list)
      type(card_t), intent(in) :: card
      type(field_t), intent(in) :: fields(:)
      logical, intent(in) :: numeric(:)
      logical, intent(out) :: cut(:)
      type(complaints_t), intent(inout) :: list
      integer :: i, start, finish, border

      cut = .false.
      do i = 1, size(fields) - 1
         border = fields(i)%last
         if (cut(i) .or. card%text(border:border) == ' ' .or. card%text(border + 1:border + 1) == ' ') cycle
         start = fields(i)%first + index(card%text(fields(i)%first:border), ' ', back=.true.)
         finish = border + index(card%text(border + 1:fields(i + 1)%last)//' ', ' ') - 1
         ! Two numbers, each in a field that it fills, may touch; the first may have a blank in the place of a plus.
         if (start <= fields(i)%first + merge(1, 0, numeric(i))) then
            if (.not. numeric(i)) cycle
            if (.not. is_real(card%text(start:finish))) cycle
         end if
         cut(i:i + 1) = .true.
         call complain(list, border_crossed, card, fields(i), start, card%text(start:finish), &
                       whole_text(border)//' AND '//whole_text(border + 1))
      end do
   end subroutine find_cuts

   pure logical function is_real(text)
      character(*), intent(in) :: text
      real(wp) :: value
      integer :: flaw, place

      call read_real(text, value, flaw, place)
      is_real = flaw == flaw_none
   end function is_real
end module card_borders
