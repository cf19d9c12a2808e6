!> Tests. `hard short|full INPUT...`: accuracy on everything that is hard to compute, in what its condition
!> allows. One line a scene; ends non-zero where a number without a mark is wrong by more than `bound` times that.
!>
!> A unit of the last three columns is eps times the sum, over all numbers of the deck, of what each of them rounded
!> would do to the result (hard_condition.f90): the result cannot be asked to be better than 1. Counted link by link, x
!> and y together, phi alone; the largest is printed.
program hard
   use, intrinsic :: iso_fortran_env, only: output_unit
   use kinds, only: wp
   use plane_vectors, only: pi, degree
   use quad_jet, only: qp
   use mechanism, only: method_matrix, method_dense
   use motion, only: motion_t, new_motion, flag_none, flag_stroke
   use scales, only: characteristic_length
   use analysis, only: analysis_t, make_analysis, advance
   use closed_forms_dyads, only: body_t
   use motion_errors, only: exactly_away
   use test_counter, only: test_counter_t, count_one, conclude
   use hard_condition, only: condition_t, measure
   use hard_scenes, only: scene_t, deck_scenes, jumps_of, far_from, four_bar_scene, slider_scene, exact_links
   implicit none

   !> Each result comes from some tens of roundings of intermediate numbers, each of which may do what the deck's own
   !> do; and a coordinate that the deck's numbers hardly move has those of its neighbours.
   real(qp), parameter :: bound = 100.0_qp
   !> What moves so much less than the rest of its kind counts as a constant.
   real(qp), parameter :: not_moved = 1.0e-7_qp
   !> Results of which a condition leaves nothing: beyond this, a mark is right.
   real(qp), parameter :: nothing_left = 1.0e-2_qp
   !> Of one scene.
   type :: scene_errors_t
      integer :: flagged = 0
      real(qp) :: condition = 0.0_qp, worst(0:2) = 0.0_qp
   end type scene_errors_t
   type(test_counter_t) :: counter
   logical :: short
   character(500) :: argument
   integer :: i

   call get_command_argument(1, argument)
   short = argument == 'short'
   print '(a)', &
      ' ERRORS OVER EPS TIMES THE SUM OF WHAT EACH NUMBER OF THE DECK DOES; CONDITION: THE LARGEST SUM OF A POSITION', &
      '', ' SCENE                        LINKS  INSTANTS  FLAGGED  CONDITION  POSITION  VELOCITY    ACCEL.'
   do i = 2, command_argument_count()
      call get_command_argument(i, argument)
      call judge_deck(trim(argument))
   end do
   call judge_dead_points()
   call judge_change_points()
   call judge_angles()
   call judge_sizes()
   call conclude(counter)

contains

   !> Every set of a deck as it is; some with cranks that turn evenly in leaps, some without drives of places far away.
   subroutine judge_deck(path)
      character(*), intent(in) :: path
      type(scene_t), allocatable :: list(:)
      character(*), parameter :: branch_jump(9) = [character(10) :: 'four_bar', 'yoke', 'drag_link', 'whitworth', &
         'jansen', &
         'klann', 'watt', 'stephenson', 'chebyshev']
      character(*), parameter :: moved(9) = [character(10) :: 'yoke', 'cylinder', 'scissor', 'oldham', 'jansen', &
         'excavator', 'grounds', 'xy_table', 'cognates']
      integer :: i

      list = deck_scenes(path, merge(5, 25, short))
      do i = 1, size(list)
         call judge(list(i))
      end do
      if (any(branch_jump == list(1)%deck)) call judge(jumps_of(list(1)))
      if (any(moved == list(1)%deck)) call judge(far_from(list(1)))
   end subroutine judge_deck

   !> At 1e-6, 1e-9, 1e-12 from a dead point: a four-bar driven by its rocker. Sliders are among the decks.
   subroutine judge_dead_points()
      integer :: k
      real(wp) :: angle, gap

      ! Crank and coupler in line: 16 + 9 + 24 cos(angle) = 4.5**2.
      angle = acos(-4.75_wp/24.0_wp)
      do k = 6, 12, 3
         gap = 10.0_wp**(-k)
         call judge(four_bar_scene('ROCKER BEFORE ITS END '//power(k), [4.0_wp, 1.0_wp, 3.5_wp, 3.0_wp], 4, &
            [angle + gap, gap, 0.0_wp], [(0.5_wp*i, i=0, 8)]))
      end do
   end subroutine judge_dead_points

   !> Crank-rockers that miss being parallelograms by 1e-6 and 1e-9: both positions on one line lie near change points.
   subroutine judge_change_points()
      integer :: k

      do k = 6, 9, 3
         call judge(four_bar_scene('NEARLY A PARALLELOGRAM '//power(k), &
            [4.0_wp, 2.0_wp, 4.0_wp, 2.0_wp + 10.0_wp**(-k)], 2, [-30.0_wp, 10.0_wp, 0.0_wp]*degree, [(0.5_wp*i, i=0, &
            78)]))
      end do
   end subroutine judge_change_points

   !> First steps at any angle, through 0 and half turns, after many turns; by every method.
   subroutine judge_angles()
      character(*), parameter :: names(7) = [character(8) :: '0', 'PI', '-PI', 'PI/2', '-2 PI', '1E6', '-1E6']
      real(wp), parameter :: first(7) = [0.0_wp, pi, -pi, pi/2.0_wp, -2.0_wp*pi, 1.0e6_wp, -1.0e6_wp]
      real(wp), parameter :: base_first(4) = [4.0_wp, 1.0_wp, 3.5_wp, 3.0_wp]
      type(scene_t) :: s
      integer :: k

      do k = 1, size(first)
         s = four_bar_scene('CRANK FROM '//trim(names(k)), base_first, 2, [first(k), 10.0_wp*degree, 0.0_wp], &
            [(1.0_wp*i, i=0, 36)])
         call judge(s)
         s%m%method = method_dense
         s%name = s%name//' DENSE'
         call judge(s)
         s = slider_scene('SLIDER FROM '//trim(names(k)), 1.0_wp, [first(k), -10.0_wp*degree, 0.0_wp], &
            [(1.0_wp*i, i=0, 36)])
         call judge(s)
         s%m%method = method_matrix
         s%name = s%name//' MATRIX'
         call judge(s)
      end do
   end subroutine judge_angles

   !> Millimetres at 1000 rad/s, links of very different lengths, and the smallest and largest decks.
   subroutine judge_sizes()
      real(wp), parameter :: times(37) = [(1.0_wp*i, i=0, 36)]
      real(wp), parameter :: slow(3) = [0.1_wp, 10.0_wp*degree, 0.0_wp]

      call judge(four_bar_scene('MILLIMETRES, 1000 RAD/S', [0.004_wp, 0.001_wp, 0.0035_wp, 0.003_wp], 2, &
         [0.0_wp, 1000.0_wp, 0.0_wp], 1.0e-4_wp*times))
      call judge(slider_scene('MILLIMETRES, 1000 RAD/S', 1.0e-3_wp, [0.0_wp, 1000.0_wp, 0.0_wp], 1.0e-4_wp*times))
      call judge(four_bar_scene('CRANK OF A MILLIONTH', [4.0_wp, 1.0e-6_wp, 3.5_wp, 3.0_wp], 2, slow, times))
      call judge(four_bar_scene('RODS OF A MILLION', [1.0_wp, 2.0_wp, 1.0e6_wp, 1.0e6_wp], 2, slow, times))
      call judge(slider_scene('SLIDER OF 1E-30', 1.0e-30_wp, slow, times))
      call judge(slider_scene('SLIDER OF 1E30', 1.0e30_wp, slow, times))
   end subroutine judge_sizes

   pure function power(k) result(text)
      integer, intent(in) :: k
      character(5) :: text

      write (text, '(a,i0)') '1E-', k
   end function power

   !> Runs the scene and prints its line.
   subroutine judge(s)
      type(scene_t), intent(in) :: s
      type(analysis_t) :: a
      type(motion_t) :: q
      type(scene_errors_t) :: errors
      real(wp) :: before(size(s%m%links))
      integer :: k

      call make_analysis(a, s%m)
      q = new_motion(size(s%m%links))
      do k = 1, size(s%at)
         before = q%position(3, :)
         call advance(a, s%at(k), q)
         if (k > 1) call look_at_turns(exact_links(s, s%at(k)), abs(s%at(k) - s%at(k - 1)), q%position(3, :) - before, &
            errors)
         ! The first three, every fourth and the last: the condition is the larger part of the time. Every fourth from
         ! the third has both change points of NEARLY A PARALLELOGRAM.
         if (short .and. size(s%at) > 9 .and. k > 3 .and. k < size(s%at) .and. mod(k, 4) /= 3) cycle
         call judge_instant(s, s%at(k), q, errors)
      end do
      call print_errors(s, errors)
   end subroutine judge

   !> An angle goes on from where it was: in short steps none is brought back by whole turns.
   subroutine look_at_turns(exact, interval, turned, errors)
      type(body_t), intent(in) :: exact(:)
      real(wp), intent(in) :: interval, turned(:)
      type(scene_errors_t), intent(inout) :: errors

      if (maxval(abs(exact%phi%d))*interval < 1.0_qp .and. any(abs(turned) > pi)) errors%worst = huge(1.0_qp)
   end subroutine look_at_turns

   subroutine judge_instant(s, t, q, errors)
      type(scene_t), intent(in) :: s
      real(wp), intent(in) :: t
      type(motion_t), intent(in) :: q
      type(scene_errors_t), intent(inout) :: errors
      type(body_t) :: exact(size(s%m%links))
      real(qp) :: allowed(3, size(s%m%links), 0:2)
      logical :: exists

      exact = exact_links(s, t)
      call find_allowed(s, exact, t, allowed, exists)
      if (.not. any(q%flag == [flag_none, flag_stroke])) then
         errors%flagged = errors%flagged + 1
         if (exists) exists = maxval(allowed(:, :, 1))*epsilon(1.0_wp) <= nothing_left*fastest(exact)
         if (exists) errors%worst = huge(1.0_qp)
      else if (.not. exists) then
         ! Of a singular position there are no rates: a mark is missing.
         errors%worst = huge(1.0_qp)
      else
         errors%condition = max(errors%condition, maxval(allowed(:2, :, 0))/characteristic_length(s%m), &
            maxval(allowed(3, :, 0)))
         errors%worst = max(errors%worst, ratios(q, exact, allowed))
      end if
   end subroutine judge_instant

   subroutine print_errors(s, errors)
      type(scene_t), intent(in) :: s
      type(scene_errors_t), intent(in) :: errors
      logical :: good

      good = all(errors%worst <= bound)
      print '(1x,a28,i6,i10,i8,es11.1,3f10.1,a)', s%name//repeat(' ', 28), size(s%m%links), size(s%at), &
         errors%flagged, &
         errors%condition, min(errors%worst, 1.0e7_qp), trim(merge('       ', ' FAILED', good))
      flush (output_unit)
      call count_one(counter, good, s%name)
   end subroutine print_errors

   !> (3, links, 0:2) what is divided by; `exists`: the position is not singular.
   subroutine find_allowed(s, exact, t, allowed, exists)
      type(scene_t), intent(in) :: s
      type(body_t), intent(in) :: exact(:)
      real(wp), intent(in) :: t
      real(qp), intent(out) :: allowed(3, size(exact), 0:2)
      logical, intent(out) :: exists
      type(condition_t) :: c

      c = measure(s%m, exact, real(t, qp))
      exists = c%exists
      allowed = c%of
      allowed(1, :, :) = max(allowed(1, :, :), allowed(2, :, :))
      allowed(2, :, :) = allowed(1, :, :)
      call allow_for_constants(characteristic_length(s%m), exact, allowed)
   end subroutine find_allowed

   !> A coordinate that no number of the deck moves, such as the velocity of a slider across its guide, may hold the
   !> rounding of the largest numbers that its equations hold.
   subroutine allow_for_constants(length, exact, allowed)
      real(wp), intent(in) :: length
      type(body_t), intent(in) :: exact(:)
      real(qp), intent(inout) :: allowed(3, size(exact), 0:2)
      real(qp) :: size_of(2, 0:2)
      integer :: k

      size_of(:, 0) = [real(length, qp), maxval(abs(exact%phi%v))]
      size_of(2, 1:) = [maxval(abs(exact%phi%d)), maxval(exact%phi%d**2 + abs(exact%phi%dd))]
      size_of(1, 1:) = size_of(2, 1:)*length + [maxval(max(abs(exact%x%d), abs(exact%y%d))), &
         maxval(max(abs(exact%x%dd), abs(exact%y%dd)))]
      do k = 0, 2
         where (allowed(:2, :, k) <= not_moved*max(size_of(1, k), maxval(allowed(:2, :, k)))) allowed(:2, :, &
            k) = size_of(1, k)
         where (allowed(3, :, k) <= not_moved*max(size_of(2, k), maxval(allowed(3, :, k)))) allowed(3, :, &
            k) = size_of(2, k)
      end do
   end subroutine allow_for_constants

   !> The largest of all velocities.
   pure real(qp) function fastest(b)
      type(body_t), intent(in) :: b(:)

      fastest = max(maxval(abs(b%x%d)), maxval(abs(b%y%d)), maxval(abs(b%phi%d)))
   end function fastest

   !> The largest errors (0:2) in units of eps `allowed`; angles to the next whole turn.
   function ratios(q, exact, allowed) result(worst)
      type(motion_t), intent(in) :: q
      type(body_t), intent(in) :: exact(:)
      real(qp), intent(in) :: allowed(3, size(exact), 0:2)
      real(qp) :: worst(0:2), off(3, 0:2)
      integer :: i, k

      worst = 0.0_qp
      do i = 1, size(exact)
         off = exactly_away(q, i, exact(i))
         do k = 0, 2
            if (all(off(:, k) <= 0.0_qp)) cycle
            worst(k) = max(worst(k), maxval(off(:, k)/(epsilon(1.0_wp)*max(allowed(:, i, k), tiny(1.0_qp)))))
         end do
      end do
   end function ratios
end program hard
