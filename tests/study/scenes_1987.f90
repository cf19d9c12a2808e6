!> Tests. The mechanisms on which the method of 1987 is measured: a deck, lengths in its characteristic one, and the
!> closed form in real128 at every degree of the crank.
module scenes_1987
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use test_counter, only: sets_of
   use scales, only: characteristic_length, power_of_two
   use sample_mechanisms, only: magnified
   use configuration, only: system_t, configuration_t, new_system, new_configuration, set_configuration, &
      choose_references
   use quad_jet, only: qp, pi_q, degree_q, wrap_angle
   use quad_frozen, only: references_t
   use closed_forms_dyads, only: body_t
   use closed_forms, only: closed_form
   implicit none
   private
   public :: scene_t, new_scene, exact, scene_names

   character(16), parameter :: scene_names(6) = [character(16) :: 'yoke', 'crank-slider', 'four-bar', &
      'four-bar crossed', 'Andrews', 'slider to left']

   type :: scene_t
      character(16) :: name = ''
      type(mechanism_t) :: m
      type(system_t) :: system
      type(configuration_t) :: configuration                      !< room for an iteration
      type(references_t) :: references          !< of an iteration in the print's form
      type(configuration_t) :: once                      !< with the references chosen at the crank angle 0
      real(qp), allocatable :: turn(:, :, :)    !< (3, links, 0:359) positions; the angles go on without leaps
   end type scene_t

contains

   !> The mechanism number `i` of `scene_names`.
   function new_scene(i) result(s)
      integer, intent(in) :: i
      type(scene_t) :: s
      character(12), parameter :: decks(6) = [character(12) :: 'yoke', 'crank_slider', 'four_bar', 'four_bar', &
         'andrews', &
         'crank_slider']
      type(mechanism_t), allocatable :: sets(:)
      real(wp) :: unit
      integer :: k

      s%name = scene_names(i)
      sets = sets_of('input/'//trim(decks(i))//'.deck')
      unit = power_of_two(characteristic_length(sets(1)))
      s%m = magnified(sets(1), 1.0_wp/unit)
      s%system = new_system(s%m)
      if (abs(s%system%length - 1.0_wp) > 0.0_wp) error stop 'A SCENE OF THE STUDY HAS ANOTHER UNIT'
      allocate (s%turn(3, size(s%m%links), 0:359))
      do k = 0, 359
         s%turn(:, :, k) = closed(decks(i), i, k, real(unit, qp))
         if (k == 0) call go_on(real(s%m%links%position(3), qp), s%turn(3, :, 0))
         if (k > 0) call go_on(s%turn(3, :, k - 1), s%turn(3, :, k))
      end do
      if (count(abs(s%turn(3, :, 359) - s%turn(3, :, &
         0)) > pi_q) /= 1) error stop 'MORE THAN THE CRANK TURNS'
      s%configuration = new_configuration(s%system, s%m)
      s%once = s%configuration
      s%once%q = real(exact(s, 0), wp)
      call set_configuration(s%system, s%once)
      call choose_references(s%system, s%once)
   end function new_scene

   !> Brings the angles `phi` to the turn nearest to `before`.
   pure subroutine go_on(before, phi)
      real(qp), intent(in) :: before(:)
      real(qp), intent(inout) :: phi(:)

      phi = before + wrap_angle(phi - before)
   end subroutine go_on

   !> The closed form of mechanism `i` with the crank at `k` degrees, lengths in `unit`. The crossed four-bar is the
   !> mirror image in the x axis of the open one with its crank at -k degrees; the slider on the left side that in the y
   !> axis of the one on the right with its crank at 180 - k degrees.
   function closed(deck, i, k, unit) result(q)
      character(*), intent(in) :: deck
      integer, intent(in) :: i, k
      real(qp), intent(in) :: unit
      real(qp), allocatable :: q(:, :)
      type(body_t), allocatable :: links(:)
      integer :: angle

      angle = k
      if (i == 4) angle = -k
      if (i == 6) angle = 180 - k
      links = closed_form(trim(deck), 1, real(angle, qp)/merge(60.0_qp, 30.0_qp, deck == 'crank_slider'))
      allocate (q(3, size(links)))
      q(1, :) = links%x%v/unit
      q(2, :) = links%y%v/unit
      q(3, :) = links%phi%v
      if (i == 4) q(2:, :) = -q(2:, :)
      if (i /= 6) return
      q(1, :) = -q(1, :)
      ! Crank and rod lie along their axes; base and piston have no length and stay at 0.
      q(3, 2:3) = pi_q - q(3, 2:3)
   end function closed

   !> The positions (3, links) with the crank at `angle` degrees, which may lie outside one turn: the crank's angle
   !> alone goes on, the other links swing.
   pure function exact(s, angle) result(q)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: angle
      real(qp) :: q(3, size(s%turn, 2))

      q = s%turn(:, :, modulo(angle, 360))
      q(3, s%m%drives(1)%subject) = angle*degree_q
   end function exact
end module scenes_1987
