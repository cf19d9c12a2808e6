!> Tests. Closed forms of the four-bars, also of those with a symmetry, which pass change points or take the other
!> branch there. The lengths are those of the decks in input/, written out again by hand so that a deck read wrongly
!> shows up as a difference.
module closed_forms_four_bars
   use kinds, only: wp
   use quad_jet
   use rise_laws, only: rise_jet, rise_words
   use closed_forms_dyads
   implicit none
   private
   public :: four_bars, triple_rocker

   !> Crank, coupler, rocker and base of the crank-rocker.
   real(qp), parameter :: sizes(4) = [1.0_qp, 3.5_qp, 3.0_qp, 4.0_qp]

contains

   !> The links of the deck `name` at `time`, in its set or variant number `set`; none for another deck.
   pure function four_bars(name, set, time) result(links)
      character(*), intent(in) :: name
      integer, intent(in) :: set
      type(jet_t), intent(in) :: time
      type(body_t), allocatable :: links(:)
      type(jet_t) :: slow, fast

      ! The cranks of those with a symmetry: they have change points at 180 and 360 deg.
      slow = (20.0_qp + 10.0_qp*time)*degree_q
      fast = (15.0_qp + 12.5_qp*time)*degree_q
      select case (name)
      case ('four_bar', 'stroke')
         if (set == 1) links = four_bar_links(30.0_qp*degree_q*time, sizes, 1.0_qp)
         if (set == 2) links = four_bar_links(0.5_qp + time + 0.25_qp*sin(2.0_qp*time + 0.5_qp), sizes, -1.0_qp)
      case ('poles')
         if (set == 1) links = four_bar_links(30.0_qp*degree_q*time, sizes, 1.0_qp)
         if (set == 2) links = parallelogram(slow)
      case ('crank_rockers')
         ! Variants: three cranks, each with its coupler, and two rockers for each.
         associate (k => (set - 1)/2)
            links = four_bar_links(30.0_qp*degree_q*time, [0.5_qp*(k + 1), 3.5_qp - 0.25_qp*k, &
               merge(2.75_qp, 3.0_qp, modulo(set, 2) == 1), 4.0_qp], 1.0_qp)
         end associate
      case ('rise_dwell'); links = four_bar_links(rise_dwell(set, time)*degree_q, sizes, 1.0_qp)
      case ('book_four_bar')
         links = four_bar_links((30.0_qp + 60.0_qp*time)*degree_q, [30.0_qp, 70.0_qp, 65.0_qp, 90.0_qp], 1.0_qp)
      case ('chebyshev')
         ! Chebyshev's lambda: the coupler is as long again to the point that runs along a straight line.
         links = four_bar_links(30.0_qp*degree_q*time, [1.0_qp, 2.5_qp, 2.5_qp, 2.0_qp], 1.0_qp)
      case ('triple_rocker'); links = triple_rocker(time, 1.0_qp)
      case ('far_small')
         ! Millionths on a base at (1200, 1600), where it is put after all is known.
         links = four_bar_links((10.0_qp + 30.0_qp*time)*degree_q, sizes*1.0e-6_qp, 1.0_qp)
         links%x = links%x + 1200.0_qp
         links%y = links%y + 1600.0_qp
      case ('many_turns')
         ! After 159154 turns.
         links = four_bar_links(1.0e6_qp + 0.5_qp*time, sizes, 1.0_qp)
      case ('drawing'); links = drawing(set, time)
      case ('transmission'); links = drawing(1, time)
      case ('drag_link'); links = drag_link(set, time)
      case ('kite', 'kite_across', 'kite_at'); links = kite(slow)
      case ('antiparallelogram', 'antiparallelogram_across', 'antiparallelogram_at'); links = antiparallelogram(fast)
      case ('parallelogram', 'parallelogram_at'); links = parallelogram(slow)
      case ('parallelogram_branch')
         ! Crossed from 180 to 360 deg.
         links = parallelogram(slow)
         if (time%v > 16.0_qp .and. time%v < 34.0_qp) links = antiparallelogram(slow)
      case ('antiparallelogram_branch')
         ! Crossed from 360 deg on only.
         links = antiparallelogram(fast)
         if (time%v < 27.6_qp) links = parallelogram(fast)
      case ('kite_branch')
         ! From 180 to 360 deg the coupler lies on the crank and the rocker on the base.
         links = kite(slow)
         if (time%v >= 16.0_qp .and. time%v <= 34.0_qp) then
            links(3)%phi = slow + 180.0_qp*degree_q
            links(4)%phi = constant_jet(180.0_qp*degree_q)
         end if
      case default; allocate (links(0))
      end select
   end function four_bars

   !> Crank 2, coupler 1.5, rocker 3 on a base of 4; the crank at 57 deg + 5 deg t. `side`: 1 with the joint B to the
   !> left of the way from A to B0.
   pure function triple_rocker(time, side) result(links)
      type(jet_t), intent(in) :: time
      real(qp), intent(in) :: side
      type(body_t) :: links(4)

      links = four_bar_links((57.0_qp + 5.0_qp*time)*degree_q, [2.0_qp, 1.5_qp, 3.0_qp, 4.0_qp], side)
   end function triple_rocker

   !> The crank's angle (deg): by each law of a rise it goes from 30 to 91.64 deg and back; in set 5 it turns at 1500
   !> turns a minute, t in milliseconds, less a rise of 96 deg.
   pure type(jet_t) function rise_dwell(set, time) result(phi)
      integer, intent(in) :: set
      type(jet_t), intent(in) :: time

      if (set == 5) then
         phi = 1500.0_qp*360.0_qp/60000.0_qp*time - rise_jet('3-4-5', 10.0_qp, 20.0_qp, 96.0_qp, time%v)
      else
         phi = 30.0_qp + rise_jet(trim(rise_words(set)), 0.3_qp, 1.2_qp, 61.64_qp, time%v) &
            - rise_jet(trim(rise_words(set)), 2.1_qp, 0.6_qp, 61.64_qp, time%v)
      end if
   end function rise_dwell

   !> Four-bar linkage A0 A B B0 as it is drawn, with B to the right of A B0; the axes of the links lie in those of the
   !> drawing. In set 2 the origin of the rocker's axes is drawn at B0.
   pure function drawing(set, time) result(links)
      integer, intent(in) :: set
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      real(qp), parameter :: a0(2) = [0.5_qp, 0.0_qp], a(2) = [0.0_qp, 1.0_qp], b(2) = [3.0_qp, 2.75_qp], &
         b0(2) = [4.0_qp, 0.0_qp], drawn(2) = 0.0_qp
      type(body_t) :: crank
      type(place_t) :: axle, pin, end_of_crank, elbow

      axle = fixed_place(a0(1), a0(2))
      pin = fixed_place(b0(1), b0(2))
      crank = body('CRANK', axle, -30.0_qp*degree_q*time)
      end_of_crank = place_on(crank, a(1) - a0(1), a(2) - a0(2))
      elbow = third_corner(end_of_crank, pin, constant_jet(sum((b - a)**2)), constant_jet(sum((b - b0)**2)), 1.0_qp)
      links = [base, drawn_link('CRANK', axle, end_of_crank, a0, a, drawn), &
               drawn_link('COUPLER', end_of_crank, elbow, a, b, drawn), &
               drawn_link('ROCKER', pin, elbow, b0, b, merge(drawn, b0, set == 1))]
   end function drawing

   !> Double crank: base 1 at (1, 0.5) turned by 30 deg, crank 2, coupler sqrt(6) with its axes in its middle,
   !> follower 2.5. The coupler's half length is the double that the deck's continuation card holds.
   pure function drag_link(set, time) result(links)
      integer, intent(in) :: set
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      real(qp), parameter :: half = real(real(sqrt(1.5_qp), wp), qp)
      type(jet_t) :: phi
      type(place_t) :: a0, b0, a, b, middle
      type(body_t) :: turned_base

      phi = 0.5_qp*time*time*sqrt(time)
      if (set == 1) phi = (90.0_qp + 24.0_qp*time)*degree_q
      a0 = fixed_place(1.0_qp, 0.5_qp)
      turned_base = body('BASE', a0, constant_jet(30.0_qp*degree_q))
      b0 = place_on(turned_base, 1.0_qp, 0.0_qp)
      a = polar(a0, 2.0_qp, phi)
      b = corner(a, 2.0_qp*half, b0, 2.5_qp, 1.0_qp)
      middle = place_t(0.5_qp*(a%x + b%x), 0.5_qp*(a%y + b%y))
      links = [turned_base, body('CRANK', a0, phi), body('COUPLER', middle, direction(a, b)), &
               body('FOLLOWER', b0, direction(b0, b))]
   end function drag_link

   !> Crank and coupler 1, base and rocker 3: B is the mirror image of A0 in the line from A to B0.
   pure function kite(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(4)
      type(place_t) :: b0, a

      b0 = fixed_place(3.0_qp, 0.0_qp)
      a = polar(origin, 1.0_qp, phi)
      links = bars(phi, a, mirrored(origin, a, b0), b0)
   end function kite

   !> Crank and rocker 2, base and coupler 4.
   pure function antiparallelogram(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(4)
      type(place_t) :: b0, a

      b0 = fixed_place(4.0_qp, 0.0_qp)
      a = polar(origin, 2.0_qp, phi)
      links = bars(phi, a, swapped(origin, a, b0), b0)
   end function antiparallelogram

   !> The antiparallelogram's lengths; the coupler only shifts.
   pure function parallelogram(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(4)

      links = [base, body('CRANK', origin, phi), body('COUPLER', polar(origin, 2.0_qp, phi), flat), &
               body('ROCKER', fixed_place(4.0_qp, 0.0_qp), phi)]
   end function parallelogram
end module closed_forms_four_bars
