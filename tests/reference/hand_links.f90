!> Tests. The links of a deck at any time by its closed form, angles without leaps.
module hand_links
   use mechanism, only: mechanism_t
   use quad_jet, only: qp, pi_q
   use closed_forms_dyads, only: body_t
   use closed_forms, only: closed_form
   implicit none
   private
   public :: move_links_to

contains

   !> Puts `links` (in the order of the deck `name`) where the closed form has them at `t`, with angles next to what they
   !> were before. `fault`: what does not fit, '' if all does.
   subroutine move_links_to(name, m, t, links, fault)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: t
      type(body_t), intent(inout) :: links(:)
      character(:), allocatable, intent(out) :: fault
      type(body_t), allocatable :: found(:)
      real(qp) :: phi
      integer :: k, i

      found = closed_form(name, merge(m%variant, m%set_number, m%variant > 0), t)
      fault = ''
      if (size(found) /= size(m%links)) fault = 'THE CLOSED FORM AND THE DECK DIFFER IN THEIR LINKS'
      do i = 1, size(found)
         if (fault /= '') return
         k = findloc(m%links%name == found(i)%name, .true., dim=1)
         if (k == 0) then
            fault = 'THE DECK HAS NO LINK '//found(i)%name
            return
         end if
         phi = next_to(links(k)%phi%v, found(i)%phi%v)
         links(k) = found(i)
         links(k)%phi%v = phi
      end do
   end subroutine move_links_to

   !> `phi` turned by whole turns until it is within half a turn of `before`.
   pure real(qp) function next_to(before, phi)
      real(qp), intent(in) :: before, phi

      next_to = phi + 2.0_qp*pi_q*anint((before - phi)/(2.0_qp*pi_q))
   end function next_to
end module hand_links
