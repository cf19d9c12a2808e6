!> Tests. Closed forms of mechanisms whose ratios are asked for: the links by the values of the drives, so that each
!> drive can move alone. The lengths and laws are those of the decks in input/, written out again by hand so that a deck
!> read wrongly shows up as a difference.
module closed_forms_ratios
   use quad_jet
   use closed_forms_dyads
   implicit none
   private
   public :: ratio_laws, by_drives

contains

   !> The values of the drives of the deck `name` at `time`; none for another deck.
   pure function ratio_laws(name, time) result(f)
      character(*), intent(in) :: name
      type(jet_t), intent(in) :: time
      type(jet_t), allocatable :: f(:)

      select case (name)
      case ('boom')
         f = [2.0_qp + 0.5_qp*time]
      case ('leverage')
         f = [50.0_qp*time - 100.0_qp]
      case ('jacobian')
         f = [(30.0_qp + 20.0_qp*time)*degree_q, (60.0_qp + 30.0_qp*time - 2.5_qp*time*time)*degree_q]
      case default
         allocate (f(0))
      end select
   end function ratio_laws

   !> The links of the deck `name` where its drives have the values `f`.
   pure function by_drives(name, f) result(links)
      character(*), intent(in) :: name
      type(jet_t), intent(in) :: f(:)
      type(body_t), allocatable :: links(:)

      select case (name)
      case ('boom')
         links = [base, boom(f(1))]
      case ('leverage')
         ! The wheel is 500 from O, at the height of the drive and to the right.
         links = [body('FRAME', origin, flat), body('ARM', origin, atan2(f(1), sqrt(500.0_qp**2 - f(1)*f(1))))]
      case ('jacobian')
         links = [base, body('UPPER', origin, f(1)), body('FORE', polar(origin, 2.0_qp, f(1)), f(1) + f(2))]
      case default
         allocate (links(0))
      end select
   end function by_drives

   !> Boom, barrel and rod: B is a corner of the triangle of O, B0 = (2, -1) and B, whose sides are OB and the `ram`.
   pure function boom(ram) result(links)
      type(jet_t), intent(in) :: ram
      type(body_t) :: links(3)
      real(qp), parameter :: b_x = 1.5_qp, b_y = 1.0_qp
      type(place_t) :: foot, b

      foot = fixed_place(2.0_qp, -1.0_qp)
      b = third_corner(origin, foot, constant_jet(b_x**2 + b_y**2), ram*ram, 1.0_qp)
      links = [body('BOOM', origin, direction(origin, b) - atan2(b_y, b_x)), body('BARREL', foot, direction(foot, b)), &
               body('ROD', b, direction(foot, b))]
   end function boom
end module closed_forms_ratios
