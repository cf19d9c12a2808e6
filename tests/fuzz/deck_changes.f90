!> Tests. What the changes of decks have in common: a card out of many, a number near another.
module deck_changes
   use kinds, only: wp
   use dice, only: dice_t, throw, chance, between, magnitude
   use deck_draft, only: draft_t, label, set_real, set_full, find_cards
   implicit none
   private
   public :: pick, near, put_real, is_degrees

contains

   !> A line number out of `cards`, or 0 if there are none.
   integer function pick(r, cards)
      type(dice_t), intent(inout) :: r
      integer, intent(in) :: cards(:)

      pick = 0
      if (size(cards) > 0) pick = cards(throw(r, size(cards)))
   end function pick

   !> A changed number: times a factor, a little off, rounded to a whole, of the other sign.
   real(wp) function near(x, r)
      real(wp), intent(in) :: x
      type(dice_t), intent(inout) :: r

      select case (throw(r, 8))
      case (1:3); near = x*between(r, 0.6_wp, 1.6_wp)
      case (4); near = x*(1.0_wp + between(r, -1.0_wp, 1.0_wp)*10.0_wp**(-throw(r, 14)))
      case (5); near = x + between(r, -1.0_wp, 1.0_wp)*max(abs(x), 1.0_wp)
      case (6); near = anint(x)
      case (7); near = -x
      case default; near = x*magnitude(r, 2)
      end select
   end function near

   !> Writes `x` with nine digits or with all.
   subroutine put_real(d, r, i, k, x)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer, intent(in) :: i, k
      real(wp), intent(in) :: x

      if (chance(r, 0.2_wp)) then
         call set_full(d, i, k, x)
      else
         call set_real(d, i, k, x)
      end if
   end subroutine put_real

   logical function is_degrees(d)
      type(draft_t), intent(in) :: d
      integer, allocatable :: cards(:)

      cards = find_cards(d, ['UNITS   '])
      is_degrees = .false.
      if (size(cards) > 0) is_degrees = label(d%line(cards(1)), 2) == 'DEG'
   end function is_degrees
end module deck_changes
