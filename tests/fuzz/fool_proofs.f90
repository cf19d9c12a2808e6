!> Tests. `fool_proofs [ATTEMPTS [SEED]]`: tries to have something false proved. Mechanisms with one or two assemblies,
!> many of them near to change points or dead points by 1E-3 to 1E-14, are put into positions that are right, nearly
!> right or wrong; steps lead to the same or the other assembly, through places where there is none, and with drives
!> that go there and back between both ends. What is proved is held against closed forms in real128. The last line is
!> `N passed, N failed`: an attempt is passed where nothing false is proved.
program fool_proofs
   use kinds, only: wp
   use quad_jet, only: qp
   use arguments, only: number
   use dice, only: dice_t, new_dice, throw, chance, between
   use continuation, only: continuation_t, begin_continuation
   use block_state, only: set_drive_values
   use mechanism, only: mechanism_t
   use position_proof, only: proved_position_t, new_placed, prove_position
   use ball_equations, only: ball_numbers_t
   use ball_numbers, only: new_ball_numbers
   use motion_proof, only: step_proof_t, prove_step
   use block_solver, only: solve_block
   use convergence, only: solve_report_t
   use fool_scenes, only: fool_t, new_mechanism, find_unknowns, place_at, scene_four_bar, scene_inverted, &
      scene_slider, scene_arm, scene_cylinder, scene_guides
   implicit none

   !> Between the ends of a step so many places are looked at.
   integer, parameter :: samples = 200
   !> Differences are taken over this part of the time in which the drive swings.
   real(qp), parameter :: small = 1.0e-9_qp
   !> What differences in real128 leave of derivatives.
   real(qp), parameter :: of_differences = 1.0e-13_qp
   real(qp), parameter :: smooth = 1.0e-2_qp
   integer :: attempts, seed, i, positions, steps, false_ones
   type(dice_t) :: dice

   attempts = number(1, 2000)
   seed = number(2, 1)
   positions = 0
   steps = 0
   false_ones = 0
   do i = 1, attempts
      dice = new_dice(seed*1000003 + i)
      call try_substep(i)
   end do
   print '(a,i0,a,i0,a)', ' PROVED: ', positions, ' POSITIONS, ', steps, ' STEPS'
   if (20*steps < attempts .or. 2*positions < attempts) false_ones = false_ones + 1
   print '(i0,a,i0,a)', attempts - false_ones, ' passed, ', false_ones, ' failed'
   if (false_ones > 0) stop 1, quiet=.true.

contains

   subroutine try_substep(i)
      integer, intent(in) :: i
      type(fool_t) :: f
      type(mechanism_t) :: m
      type(continuation_t), allocatable :: e
      type(ball_numbers_t) :: p
      type(proved_position_t) :: q(2)
      type(step_proof_t) :: proof
      real(wp) :: t(2)
      integer :: sign_of(2), failed(2), k
      logical :: wrong

      f = some_mechanism()
      t(1) = between(dice, -3.0_wp, 3.0_wp)
      t(2) = t(1) + 10.0_wp**between(dice, -4.0_wp, 0.5_wp)/max(abs(f%rate), 0.1_wp)
      ! There and back.
      if (chance(dice, 0.4_wp)) then
         f%swing = 10.0_wp**between(dice, -2.0_wp, 0.5_wp)
         f%frequency = throw(dice, 3)*acos(-1.0_wp)/(t(2) - t(1))
         f%phase = -f%frequency*t(1)
         ! At rest at both ends.
         if (chance(dice, 0.5_wp)) then
            f%frequency = 2.0_wp*f%frequency
            f%phase = 0.5_wp*acos(-1.0_wp) - f%frequency*t(1)
         end if
      end if
      sign_of = merge(1, -1, chance(dice, 0.5_wp))
      if (chance(dice, 0.25_wp)) sign_of(2) = -sign_of(2)
      m = new_mechanism(f)
      allocate (e)
      call begin_continuation(e, m)
      p = new_ball_numbers(m, e%blocks, e%geometry)
      call find_unknowns(m, e, f)
      wrong = .false.
      do k = 1, 2
         q(k) = new_placed(e%blocks, size(m%drives))
         call put_there(f, e, t(k), sign_of(k))
         call prove_position(p, e%blocks, e%path, e%state, 2, q(k), failed(k))
         if (failed(k) > 0) cycle
         positions = positions + 1
         if (is_false(f, q(k), sign_of(k))) then
            print '(a,i0,a,i0)', ' ATTEMPT ', i, ': A FALSE POSITION IS PROVED, SCENE ', f%scene
            wrong = .true.
         end if
      end do
      if (all(failed == 0)) then
         call prove_step(p, e%blocks, e%geometry, e%path, e%state, q(1), q(2), proof)
         if (proof%is_proved) steps = steps + 1
         if (proof%is_proved .and. (sign_of(1) /= sign_of(2) .or. .not. exists_between(f, t, sign_of(1)))) then
            print '(a,i0,a,i0)', ' ATTEMPT ', i, ': A FALSE STEP IS PROVED, SCENE ', f%scene
            wrong = .true.
         end if
      end if
      if (wrong) false_ones = false_ones + 1
   end subroutine try_substep

   !> Often such that its two assemblies nearly meet, or that it is in line somewhere.
   function some_mechanism() result(f)
      type(fool_t) :: f
      real(wp) :: off

      f%scene = throw(dice, scene_guides)
      f%length = [between(dice, 0.3_wp, 1.5_wp), between(dice, 0.5_wp, 3.0_wp), between(dice, 0.0_wp, 2.0_wp), 1.0_wp]
      if (f%scene == scene_four_bar) f%length(3:) = [between(dice, 0.5_wp, 3.0_wp), between(dice, 0.5_wp, 4.0_wp)]
      if (f%scene == scene_guides) f%length(4) = between(dice, 0.1_wp, 3.0_wp)
      f%angle = between(dice, -4.0_wp, 4.0_wp)
      f%rate = between(dice, -2.0_wp, 2.0_wp)
      if (chance(dice, 0.5_wp)) return
      off = (2*throw(dice, 2) - 3)*10.0_wp**between(dice, -14.0_wp, -3.0_wp)
      associate (l => f%length)
         select case (f%scene)
         case (scene_four_bar)
            ! A parallelogram, a kite, or Grashof's limit.
            select case (throw(dice, 3))
            case (1)
               l(3:4) = [l(1) + off, l(2)]
            case (2)
               l(3) = l(2) + off
               l(4) = l(1)
            case default
               l(4) = max(0.1_wp, l(2) + l(3) - l(1) + off)
            end select
         case (scene_inverted)
            l(3) = abs(l(1) - l(2)) + off
         case (scene_slider)
            l(3) = max(0.0_wp, l(2) - l(1) + off)
         case (scene_arm)
            ! The end passes the pivot beside the guide.
            l(3) = l(2) + off
         case (scene_cylinder)
            l(3) = 0.0_wp
            l(2) = l(1) + off
         case default
            l(4) = off
         end select
         if (f%scene == scene_arm .or. f%scene == scene_cylinder) f%angle = 0.1_wp*f%angle
      end associate
   end function some_mechanism

   !> Puts the engine where the assembly `s` is at `t`; `s` becomes 0 where that is wrong by more than a little.
   subroutine put_there(f, e, t, s)
      type(fool_t), intent(in) :: f
      type(continuation_t), intent(inout) :: e
      real(wp), intent(in) :: t
      integer, intent(inout) :: s
      type(solve_report_t) :: c
      real(qp) :: x(2, -1:1), margin, h
      real(wp) :: off
      integer :: k

      call set_drive_values(e%path, t, e%state)
      do k = 1, size(e%blocks%list)
         if (e%blocks%list(k)%explicit) call solve_block(e%blocks, e%geometry, k, .true., e%work, e%state, c)
      end do
      h = small/max(1.0_wp, f%frequency)
      do k = -1, 1
         call place_at(f, t + k*h, s, x(:, k), margin)
         if (margin <= 0.0_qp) x(:, k) = between(dice, -3.0_wp, 3.0_wp)
      end do
      off = 0.0_wp
      if (chance(dice, 0.3_wp)) off = 10.0_wp**between(dice, -15.0_wp, 0.0_wp)
      do k = 1, size(f%unknowns)
         associate (u => e%state%u(f%unknowns(k)))
            u%value = real(x(k, 0), wp) + off*between(dice, -1.0_wp, 1.0_wp)
            u%rate = real(difference(f, k, x(k, 1), x(k, -1))/(2.0_qp*h), wp)
            ! Any: its bound is then as large.
            u%acceleration = between(dice, -1.0_wp, 1.0_wp)
         end associate
      end do
   end subroutine put_there

   !> No assembly lies within the bounds of `q` with all of its derivatives; otherwise `s` is its sign.
   logical function is_false(f, q, s)
      type(fool_t), intent(in) :: f
      type(proved_position_t), intent(in) :: q
      integer, intent(inout) :: s
      real(qp) :: x(2, -1:1), margin(-1:1), motion(0:2), h, open
      integer :: sign_of, k
      logical :: holds

      is_false = .true.
      s = 0
      h = small/max(1.0_wp, f%frequency)
      do sign_of = -1, 1, 2
         do k = -1, 1
            call place_at(f, q%t + k*h, sign_of, x(:, k), margin(k))
         end do
         if (margin(0) <= 0.0_qp) cycle
         holds = .true.
         do k = 1, size(f%unknowns)
            associate (u => q%u(f%unknowns(k)))
               motion(1) = difference(f, k, x(k, 1), x(k, -1))/(2.0_qp*h)
               motion(2) = (difference(f, k, x(k, 1), x(k, 0)) - difference(f, k, x(k, 0), x(k, -1)))/h**2
               motion(0) = u%value%mid + difference(f, k, x(k, 0), real(u%value%mid, qp))
               holds = holds .and. abs(motion(0) - u%value%mid) <= u%value%radius
               ! Beside a dead point differences are no derivatives.
               open = of_differences*max(1.0_qp, maxval(abs(motion)))
               if (minval(margin) > smooth) holds = holds &
                  .and. abs(motion(1) - u%rate%mid) <= u%rate%radius + open*small/h &
                  .and. abs(motion(2) - u%acceleration%mid) <= u%acceleration%radius + open*(small/h)**2
            end associate
         end do
         if (.not. holds) cycle
         is_false = .false.
         s = sign_of
      end do
   end function is_false

   !> The assembly `s` exists at all samples between the times `t` (2).
   logical function exists_between(f, t, s)
      type(fool_t), intent(in) :: f
      real(wp), intent(in) :: t(2)
      integer, intent(in) :: s
      real(qp) :: x(2), margin
      integer :: k

      exists_between = .true.
      do k = 0, samples
         call place_at(f, t(1) + (t(2) - t(1))*real(k, qp)/samples, s, x, margin)
         exists_between = exists_between .and. margin > 0.0_qp
      end do
   end function exists_between

   !> How much `x` of unknown number `k` is more than `y`: of angles less whole turns.
   pure real(qp) function difference(f, k, x, y)
      type(fool_t), intent(in) :: f
      integer, intent(in) :: k
      real(qp), intent(in) :: x, y
      real(qp), parameter :: turn = 2.0_qp*acos(-1.0_qp)

      difference = x - y
      if (k /= f%slide) difference = difference - turn*anint(difference/turn)
   end function difference
end program fool_proofs
