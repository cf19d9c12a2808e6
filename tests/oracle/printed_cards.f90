!> Tests. What programs that print decks made by chance have in common: a card, and a vector of a length and an angle.
module printed_cards
   use kinds, only: wp
   implicit none
   private
   public :: card, polar

contains

   !> Prints a card.
   subroutine card(name, l1, l2, l3, reals)
      character(*), intent(in) :: name, l1
      character(*), intent(in), optional :: l2, l3, reals(:)
      character(80) :: line

      line = name
      line(9:16) = l1
      if (present(l2)) line(17:24) = l2
      if (present(l3)) line(25:32) = l3
      if (present(reals)) write (line(33:), '(3a16)') reals
      print '(a)', trim(line)
   end subroutine card

   !> The vector of length `r` at an angle (rad) from the x axis.
   function polar(r, angle) result(v)
      real(wp), intent(in) :: r, angle
      real(wp) :: v(2)

      v = r*[cos(angle), sin(angle)]
   end function polar
end module printed_cards
