!> Tests. What programs that make decks have in common: a card, and a vector of a length and an angle.
module printed_cards
   use kinds, only: wp
   implicit none
   private
   public :: row, card, polar

contains

   !> A card by its fields: name, labels A to C, reals 1 to 3 as texts.
   pure function row(name, a, b, c, r1, r2, r3) result(line)
      character(*), intent(in) :: name
      character(*), intent(in), optional :: a, b, c, r1, r2, r3
      character(80) :: line

      line = name
      if (present(a)) line(9:16) = a
      if (present(b)) line(17:24) = b
      if (present(c)) line(25:32) = c
      if (present(r1)) line(33:48) = r1
      if (present(r2)) line(49:64) = r2
      if (present(r3)) line(65:80) = r3
   end function row

   !> Prints a card; `reals`: as they stand on it.
   subroutine card(name, l1, l2, l3, reals)
      character(*), intent(in) :: name
      character(*), intent(in), optional :: l1, l2, l3, reals(:)
      character(80) :: line

      line = row(name, l1, l2, l3)
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
