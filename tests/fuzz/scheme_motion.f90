!> Tests. The true motion of a scheme in real128: from its known assembly in steps so small that no other assembly is
!> near, group by group, by closed forms where there are such and by Newton's method for the others. What cannot be
!> followed is lost from there on, and so is what hangs on it.
module scheme_motion
   use, intrinsic :: iso_fortran_env, only: real64
   use quad_jet, only: qp, jet_t, constant_jet, operator(+)
   use schemes, only: scheme_t, group_t, body_t, form_any, form_rrr, form_prp, form_rpp, form_parallelogram, &
      angle_unit, is_angle, drive_unit, set_trigonometry, point_on, is_redundant
   use mechanism, only: drive_relangle
   use drive_laws, only: law_jet, variation
   use dyad_forms, only: solve_dyad, place_parallelogram
   use group_newton, only: outcome_t, solve_group, residuals
   implicit none
   private
   public :: motion_t, begin_motion, move_to, closes, is_followed, is_lost

   !> Of a group: followed, at a limit, or lost in another way, which tells nothing of the mechanism.
   enum, bind(c)
      enumerator :: is_followed, is_lost, is_unknown
   end enum

   type :: motion_t
      real(qp) :: t = 0.0_qp
      type(body_t), allocatable :: b(:)
      integer, allocatable :: status(:)        !< of the groups
      real(qp), allocatable :: margin(:)       !< square of the distance from a singularity, about 1 far from it
      real(qp), allocatable :: slope(:), bow(:) !< its derivatives where there is a closed form
      real(qp), allocatable :: lowest(:)       !< the least margin on the way
      integer, allocatable :: sign(:)          !< of the determinant
      type(jet_t), allocatable :: sine(:)      !< of a parallelogram's angle
      logical, allocatable :: crossed(:)       !< an antiparallelogram
      logical, allocatable :: has_branched(:)
      logical, allocatable :: was_open(:)      !< a change point was passed at angles so large that it may be refused
   end type motion_t

   !> Rad, or lengths, that a drive goes in one step at most.
   real(qp), parameter :: longest_way = 0.4_qp
   !> A step of so small a part of what is asked for ends the motion of a group; a limit of motion is then as near as
   !> its square root.
   real(qp), parameter :: shortest = 1.0e-7_qp, limit_margin = 1.0e-4_qp
   !> Of a margin that is no further below zero before it comes back nobody can tell, by a deck's 16 digits, that its
   !> branches do not cross: the program takes circuits closer than 1E-7 for crossing ones.
   real(qp), parameter :: almost_crossing = 1.0e-12_qp
   !> Nearer to a singularity than this a slide may be far off on its way to infinity, which is not followed.
   real(qp), parameter :: too_near = 1.0e-6_qp
   !> The sine of the angle from a change point within which an antiparallelogram may be so fast.
   real(qp), parameter :: whip = 0.3_qp
   !> A BRANCH card whose time lies so near to that of a change point, by the sine of the angle there, may mean it or
   !> not: the program knows that time to a substep of 1E-4 rad.
   real(qp), parameter :: same_time = 3.0e-4_qp
   !> More steps than this are not taken.
   integer, parameter :: most_tries = 5000
   !> Kantorovich's ratio with 3 for the bend of the equations: 0.5 would do.
   real(qp), parameter :: safe_ratio = 0.02_qp, bend = 3.0_qp
   real(qp), parameter :: rough = 1.0e-14_qp, exact = max(1.0e-26_qp, 256*epsilon(1.0_qp))
   !> A base whose ends are places so far away, in its own size, is rounded: whether the branches of a parallelogram on
   !> it cross nobody can tell.
   real(qp), parameter :: farthest = 1.0e4_qp
   !> Radians beyond which the rounding of angles leaves so wide a place without velocities about a change point that
   !> the program refuses to pass it: its square is in proportion to the angle.
   real(qp), parameter :: largest_angle = 15.0_qp
   !> At the first instant the assembly, rounded as the deck is, is so near; beside lengths much larger than those of a
   !> group, of its own ground link perhaps, so many roundings of them.
   real(qp), parameter :: rounding = 1.0e-7_qp, of_largest = 64.0_qp*epsilon(1.0_real64)

contains

   !> The motion at the first instant. `problem`: what is wrong with the scheme.
   subroutine begin_motion(s, t, m, problem)
      type(scheme_t), intent(in) :: s
      real(qp), intent(in) :: t
      type(motion_t), intent(out) :: m
      character(:), allocatable, intent(out) :: problem
      integer :: k, l, failed
      real(qp) :: largest

      m%t = t
      allocate (m%b(size(s%links)), m%sine(size(s%groups)))
      do l = 1, size(s%links)
         m%b(l)%x = constant_jet(s%links(l)%at(1))
         m%b(l)%y = constant_jet(s%links(l)%at(2))
         m%b(l)%phi = constant_jet(s%links(l)%at(3))
      end do
      call set_trigonometry(m%b)
      allocate (m%status(size(s%groups)), source=int(is_followed))
      allocate (m%margin(size(s%groups)), m%slope(size(s%groups)), m%bow(size(s%groups)), source=0.0_qp)
      allocate (m%lowest(size(s%groups)), source=huge(1.0_qp))
      allocate (m%sign(size(s%groups)), source=0)
      allocate (m%crossed(size(s%groups)), m%has_branched(size(s%groups)), m%was_open(size(s%groups)), source=.false.)
      call place_groups(s, m, 0.0_qp, exact, failed)
      if (failed > 0) then
         problem = 'THE FIRST POSITION IS NOT CLOSED'
         return
      end if
      largest = 0.0_qp
      do l = 1, size(s%links)
         largest = max(largest, maxval(abs(s%links(l)%at(:2))))
      end do
      do k = 1, size(s%groups)
         if (s%groups(k)%form == form_parallelogram .and. largest > farthest*s%groups(k)%scale) m%status(k) = is_unknown
         do l = s%groups(k)%links(1), s%groups(k)%links(2)
            associate (b => m%b(l), at => s%links(l)%at, u => s%groups(k)%scale)
               if (max(abs(b%x%v - at(1)), abs(b%y%v - at(2)))/u + abs(b%phi%v - at(3)) &
                  < rounding + of_largest*(largest/u)) cycle
            end associate
            problem = 'THE FIRST POSITION IS ANOTHER ONE'
         end do
      end do
   end subroutine begin_motion

   !> From the motion `m` to the time `t`.
   subroutine move_to(s, t, m)
      type(scheme_t), intent(in) :: s
      real(qp), intent(in) :: t
      type(motion_t), intent(inout) :: m
      type(motion_t) :: trial
      real(qp) :: h, span
      integer :: failed, tries

      tries = 0
      span = t - m%t
      if (abs(span) > 0.0_qp) then
         h = span/steps_of(s, m%t, t)
         do while (abs(t - m%t) > 0.0_qp)
            tries = tries + 1
            if (tries > most_tries) then
               m%status = is_unknown
               m%t = t
               exit
            end if
            if (abs(h) >= abs(t - m%t)*0.999_qp) h = t - m%t
            trial = m
            call place_groups(s, trial, h, rough, failed)
            if (failed == 0) then
               if (abs(t - m%t - h) > 0.0_qp) then
                  trial%t = m%t + h
               else
                  trial%t = t
               end if
               m = trial
               h = 1.5_qp*h
            else if (abs(h) > shortest*abs(span)) then
               h = 0.5_qp*h
            else
               call lose(s%groups(failed), h, failed, m)
               h = span/steps_of(s, m%t, t)
            end if
         end do
      end if
      trial = m
      call place_groups(s, trial, 0.0_qp, exact, failed)
      if (failed == 0) m = trial
   end subroutine move_to

   integer function steps_of(s, from, to)
      type(scheme_t), intent(in) :: s
      real(qp), intent(in) :: from, to
      real(qp) :: way
      integer :: k, i

      way = 0.0_qp
      do k = 1, size(s%groups)
         do i = s%groups(k)%drives(1), s%groups(k)%drives(2)
            associate (d => s%drives(i), unit => drive_unit(s, s%drives(i)))
               way = max(way, variation(d%law, from, to, unit, angle_unit(s))/merge(1.0_qp, s%groups(k)%scale, &
                  is_angle(d)))
            end associate
         end do
      end do
      steps_of = 1 + int(min(1.0e6_qp, way/longest_way))
   end function steps_of

   !> The group cannot be followed beyond `m`. Of one with drives some links may be known all the same, as may be some
   !> of those that hang on it by guides.
   subroutine lose(g, h, k, m)
      type(group_t), intent(in) :: g
      real(qp), intent(in) :: h
      integer, intent(in) :: k
      type(motion_t), intent(inout) :: m

      m%status(k) = is_unknown
      if (g%drives(2) >= g%drives(1)) return
      if (m%margin(k) < limit_margin .and. (g%form == form_any .or. m%slope(k)*h < 0.0_qp)) m%status(k) = is_lost
      if (m%bow(k) <= 0.0_qp) return
      if (m%slope(k)**2/(2.0_qp*m%bow(k)) - m%margin(k) < almost_crossing) m%status(k) = is_unknown
   end subroutine lose

   !> `trial` goes on by `h`. `failed`: the first group that the step was too long for, 0 for none.
   subroutine place_groups(s, trial, h, tolerance, failed)
      type(scheme_t), intent(in) :: s
      type(motion_t), intent(inout) :: trial
      real(qp), intent(in) :: h, tolerance
      integer, intent(out) :: failed
      logical :: fits
      integer :: k, i, l

      failed = 0
      do k = 1, size(s%groups)
         associate (g => s%groups(k))
            do i = 1, size(g%bases)
               l = s%links(g%bases(i))%group
               if (l == 0) cycle
               trial%status(k) = max(trial%status(k), trial%status(l))
               if (trial%status(l) /= is_followed .and. g%form /= form_rrr) trial%status(k) = is_unknown
            end do
            if (trial%status(k) /= is_followed) cycle
            do l = g%links(1), g%links(2)
               trial%b(l)%x = continued(trial%b(l)%x, h)
               trial%b(l)%y = continued(trial%b(l)%y, h)
               trial%b(l)%phi = continued(trial%b(l)%phi, h)
            end do
            select case (g%form)
            case (form_any)
               call place_any(s, g, k, h, tolerance, trial, fits)
            case (form_parallelogram)
               call follow_parallelogram(s, g, k, h, trial, fits)
            case default
               call follow_dyad(s, g, k, h, trial, fits)
            end select
            if (.not. fits) then
               failed = k
               return
            end if
            trial%lowest(k) = min(trial%lowest(k), trial%margin(k))
            if (trial%margin(k) < merge(too_near, almost_crossing, any(g%form == [form_any, form_prp, form_rpp])) &
               .and. g%form /= form_parallelogram) trial%status(k) = is_unknown
         end associate
      end do
   end subroutine place_groups

   pure type(jet_t) function continued(a, h)
      type(jet_t), intent(in) :: a
      real(qp), intent(in) :: h

      continued = jet_t(a%v + h*(a%d + 0.5_qp*h*a%dd), a%d + h*a%dd, a%dd)
   end function continued

   subroutine place_any(s, g, k, h, tolerance, trial, fits)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      integer, intent(in) :: k
      real(qp), intent(in) :: h, tolerance
      type(motion_t), intent(inout) :: trial
      logical, intent(out) :: fits
      type(outcome_t) :: o
      real(qp) :: before

      call solve_group(s, g, trial%t + h, tolerance, trial%b, o)
      fits = o%converged
      if (.not. fits) return
      before = trial%margin(k)
      trial%margin(k) = 1.0_qp/o%inverse**2
      if (trial%sign(k) /= 0) then
         fits = o%sign == trial%sign(k) .and. bend*o%first*o%inverse <= safe_ratio &
            .and. max(before, trial%margin(k)) <= 4.0_qp*min(before, trial%margin(k))
      end if
      trial%sign(k) = o%sign
   end subroutine place_any

   subroutine follow_dyad(s, g, k, h, trial, fits)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      integer, intent(in) :: k
      real(qp), intent(in) :: h
      type(motion_t), intent(inout) :: trial
      logical, intent(out) :: fits
      type(jet_t) :: margin
      real(qp) :: before, phi(2)

      phi = trial%b(g%links(1):g%links(2))%phi%v
      call solve_dyad(s, g, trial%b, margin)
      before = merge(trial%margin(k), margin%v, trial%lowest(k) < huge(1.0_qp))
      fits = margin%v > 0.0_qp
      ! Turns are counted by the prediction.
      if (abs(h) > 0.0_qp) fits = fits .and. all(abs(trial%b(g%links(1):g%links(2))%phi%v - phi) < 0.5_qp) &
         .and. abs(margin%v - before) <= 0.5_qp*max(margin%v, before) &
         .and. abs(margin%d*h) <= max(margin%v, before) .and. abs(trial%slope(k)*h) <= max(margin%v, before) &
         .and. abs(margin%dd*h**2) <= max(margin%v, before)
      trial%margin(k) = margin%v
      trial%slope(k) = margin%d
      trial%bow(k) = margin%dd
   end subroutine follow_dyad

   !> A parallelogram on its branch: past each change point straight on, but past the first one after the time of a
   !> BRANCH card on the other branch.
   subroutine follow_parallelogram(s, g, k, h, trial, fits)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      integer, intent(in) :: k
      real(qp), intent(in) :: h
      type(motion_t), intent(inout) :: trial
      logical, intent(out) :: fits
      type(jet_t) :: phi, sine, before
      real(qp) :: predicted(g%links(1):g%links(2)), longest, at
      logical :: passes

      predicted = trial%b(g%links(1):g%links(2))%phi%v
      associate (drive => s%drives(g%drives(1)))
         phi = law_jet(drive%law, trial%t + h, drive_unit(s, drive), angle_unit(s))
         if (drive%kind == drive_relangle) phi = trial%b(drive%subject)%phi + phi
      end associate
      before = trial%sine(k)
      call place_parallelogram(s, g, trial%b, phi, trial%crossed(k), sine)
      passes = trial%lowest(k) < huge(1.0_qp) .and. sine%v*before%v < 0.0_qp
      trial%was_open(k) = trial%was_open(k) .or. passes .and. abs(phi%v) > largest_angle
      ! The time of the passage, by the chord.
      at = trial%t
      if (passes) at = at + h*before%v/(before%v - sine%v)
      if (passes) call ask_others(s, trial, k, at, h)
      if (passes .and. .not. trial%has_branched(k) .and. abs(g%branch_after) < huge(1.0_qp)) then
         if (abs((at - g%branch_after)*sine%d) < same_time) trial%status(k) = is_unknown
         passes = (at - g%branch_after)*h > 0.0_qp
      end if
      if (passes .and. .not. trial%has_branched(k) .and. g%branch_after < huge(1.0_qp)) then
         trial%crossed(k) = .not. trial%crossed(k)
         trial%has_branched(k) = .true.
         call place_parallelogram(s, g, trial%b, phi, trial%crossed(k), sine)
      end if
      longest = 0.2_qp
      if (trial%crossed(k) .and. min(abs(sine%v), abs(before%v)) < whip) longest = longest*nearly_kite(s, g)
      fits = max(abs(sine%d), abs(before%d))*abs(h) <= longest .and. abs(sine%dd)*h**2 <= longest
      if (abs(h) > 0.0_qp) fits = fits .and. all(abs(trial%b(g%links(1):g%links(2))%phi%v - predicted) < 0.5_qp)
      ! A turn beside a change point.
      if (abs(h) > 0.0_qp .and. sine%d*before%d <= 0.0_qp .and. min(abs(sine%v), abs(before%v)) < 0.05_qp) &
         trial%status(k) = is_unknown
      trial%sine(k) = sine
      trial%margin(k) = merge(nearly_kite(s, g)**4, 1.0_qp, trial%crossed(k))
   end subroutine follow_parallelogram

   !> At the time `at` of a change point of group `k` a BRANCH card that no change point has served, and whose time is
   !> passed on the way `h`, may name a link of a parallelogram that hangs on this group. Where both are in one block,
   !> the change point is that link's too. So it is with any other parallelogram where equations are redundant: those
   !> that depend on one another are one block. Which branch either group takes is unknown then.
   pure subroutine ask_others(s, trial, k, at, h)
      type(scheme_t), intent(in) :: s
      type(motion_t), intent(inout) :: trial
      integer, intent(in) :: k
      real(qp), intent(in) :: at, h
      logical :: hangs(size(s%links))
      integer :: j

      hangs = .false.
      hangs(s%groups(k)%links(1):s%groups(k)%links(2)) = .true.
      do j = merge(1, k + 1, is_redundant(s)), size(s%groups)
         associate (g => s%groups(j))
            if (j == k .or. .not. (is_redundant(s) .or. any(hangs(g%bases)))) cycle
            hangs(g%links(1):g%links(2)) = .true.
            if (abs(g%branch_after) < huge(1.0_qp) .and. .not. trial%has_branched(j) &
               .and. (at - g%branch_after)*h > 0.0_qp) trial%status([k, j]) = is_unknown
         end associate
      end do
   end subroutine ask_others

   !> By how little the sides of a parallelogram differ. Where they do not, the antiparallelogram is a kite, which at
   !> its change points takes any position; where they hardly do, it goes past them fast: 1 over this is the largest
   !> ratio of its rates, and a step as long as the others could count a turn too many or too few.
   real(qp) function nearly_kite(s, g)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      real(qp) :: bar, base

      associate (p => s%pairs(g%pairs(1):g%pairs(1) + 2))
         bar = distance(s, point_on(s, p(1), g%links(1)), point_on(s, p(2), g%links(1)))
         base = distance(s, point_on(s, p(2), g%links(1) + 1), point_on(s, p(3), g%links(1) + 1))
      end associate
      nearly_kite = abs(bar - base)/(bar + base)
   end function nearly_kite

   pure real(qp) function distance(s, i, j)
      type(scheme_t), intent(in) :: s
      integer, intent(in) :: i, j

      distance = norm2(s%points(i)%offset - s%points(j)%offset)
   end function distance

   !> All pairs and drives of the groups that are followed are closed in `m`, with their derivatives.
   logical function closes(s, m)
      type(scheme_t), intent(in) :: s
      type(motion_t), intent(in) :: m
      real(qp), parameter :: nothing = max(1.0e-20_qp, 8192*epsilon(1.0_qp))
      type(jet_t), allocatable :: r(:)
      real(qp) :: speed(0:2), allowed
      integer :: k, l

      closes = .true.
      do k = 1, size(s%groups)
         if (m%status(k) /= is_followed) cycle
         r = residuals(s, s%groups(k), m%t, m%b)
         speed = [1.0_qp, 0.0_qp, 0.0_qp]
         do l = 1, size(m%b)
            associate (b => m%b(l), u => s%groups(k)%scale)
               speed(0) = max(speed(0), abs(b%x%v)/u, abs(b%y%v)/u)
               speed(1) = max(speed(1), abs(b%x%d)/u, abs(b%y%d)/u, abs(b%phi%d))
               speed(2) = max(speed(2), abs(b%x%dd)/u, abs(b%y%dd)/u, abs(b%phi%dd), speed(1)**2)
            end associate
         end do
         ! What is redundant closes as far as the deck's digits let it.
         allowed = merge(1.0e-12_qp, nothing, s%groups(k)%form == form_parallelogram)
         closes = closes .and. all(abs(r%v) <= allowed*speed(0)) .and. all(abs(r%d) <= allowed*speed(1)) &
            .and. all(abs(r%dd) <= allowed*speed(2))
      end do
   end function closes
end module scheme_motion
