!> Tests. Closed forms of motions that take the other branch at a change point, or stand exactly on one. The lengths are
!> those of the decks, written out again by hand.
module closed_forms_branches
   use quad_jet, only: qp, jet_t, degree_q, constant_jet, time_jet, operator(+), operator(-), operator(*)
   use closed_forms_dyads, only: place_t, body_t, fixed_place, body, polar
   use closed_forms_bars, only: kite, antiparallelogram, antiparallelogram_links
   use closed_forms_hard, only: parallelogram, parallelogram_links, scott_russell
   implicit none
   private
   public :: parallelogram_branch, antiparallelogram_branch, kite_branch, scott_russell_branch

contains

   !> Cranks 2, base and coupler 4, from 20 deg at 10 deg a second; crossed from 180 to 360 deg.
   pure function parallelogram_branch(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)

      links = parallelogram(t)
      if (t > 16.0_qp .and. t < 34.0_qp) links = antiparallelogram_links((20.0_qp + 10.0_qp*time_jet(t))*degree_q)
   end function parallelogram_branch

   !> From 15 deg at 12.5 deg a second; crossed from 360 deg on only.
   pure function antiparallelogram_branch(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)

      links = antiparallelogram(t)
      if (t < 27.6_qp) links = parallelogram_links((15.0_qp + 12.5_qp*time_jet(t))*degree_q)
   end function antiparallelogram_branch

   !> Crank and coupler 1, base and rocker 3; from 180 to 360 deg the coupler lies on the crank and the rocker on the
   !> base.
   pure function kite_branch(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      type(jet_t) :: phi
      type(place_t) :: a0

      links = kite(t)
      if (t < 16.0_qp .or. t > 34.0_qp) return
      phi = (20.0_qp + 10.0_qp*time_jet(t))*degree_q
      a0 = fixed_place(0.0_qp, 0.0_qp)
      links(3) = body('COUPLER', polar(a0, 1.0_qp, phi), phi + constant_jet(180.0_qp*degree_q))
      links(4) = body('ROCKER', fixed_place(3.0_qp, 0.0_qp), constant_jet(180.0_qp*degree_q))
   end function kite_branch

   !> Crank 1.5 and bar 3; from 90 deg on the end B stays in the centre, and the bar lies on the crank.
   pure function scott_russell_branch(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      type(jet_t) :: phi
      type(place_t) :: o

      links = scott_russell(t)
      if (t < 5.0_qp) return
      phi = (30.0_qp + 12.0_qp*time_jet(t))*degree_q
      o = fixed_place(0.0_qp, 0.0_qp)
      links(3) = body('BAR', polar(o, 1.5_qp, phi), phi + constant_jet(180.0_qp*degree_q))
      links(4) = body('SHOE', o, constant_jet(0.0_qp))
   end function scott_russell_branch
end module closed_forms_branches
