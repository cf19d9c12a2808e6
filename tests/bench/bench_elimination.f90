!> Tests. Two equations with two unknowns: DGESV, which solves them in every step, beside its operations written out for
!> two unknowns. How much the call costs, and that both give the same bits.
module bench_elimination
   use kinds, only: wp
   use lapack, only: gesv
   use study, only: seconds
   use dice, only: dice_t, new_dice, between, chance, throw
   use bench_tools, only: spread_t, spread_of, figure
   implicit none
   private
   public :: elimination_table, judge_elimination

   type :: system_t
      real(wp) :: a(2, 2) = 0.0_wp, b(2) = 0.0_wp
   end type system_t

contains

   !> Solves `a` x = `b` by the operations of the reference DGESV, in its order; arguments as of DGESV.
   pure subroutine eliminate(a, pivots, b, info)
      real(wp), intent(inout) :: a(2, 2), b(2)
      integer, intent(out) :: pivots(2), info

      info = 0
      pivots = merge([2, 2], [1, 2], abs(a(2, 1)) > abs(a(1, 1)))
      if (pivots(1) == 2) a(:, :) = a(2:1:-1, :)
      if (abs(a(1, 1)) <= 0.0_wp) then
         info = 1
      else if (abs(a(1, 1)) >= tiny(a)) then
         a(2, 1) = a(2, 1)*(1.0_wp/a(1, 1))
      else
         a(2, 1) = a(2, 1)/a(1, 1)
      end if
      a(2, 2) = a(2, 2) - a(2, 1)*a(1, 2)
      if (info == 0 .and. abs(a(2, 2)) <= 0.0_wp) info = 2
      if (info > 0) return
      if (pivots(1) == 2) b = [b(2), b(1)]
      ! Zeros are left as they are, with their sign.
      if (abs(b(1)) > 0.0_wp) b(2) = b(2) - b(1)*a(2, 1)
      if (abs(b(2)) > 0.0_wp) then
         b(2) = b(2)/a(2, 2)
         b(1) = b(1) - b(2)*a(1, 2)
      end if
      if (abs(b(1)) > 0.0_wp) b(1) = b(1)/a(1, 1)
   end subroutine eliminate

   !> The time of both, in the same repeat.
   subroutine elimination_table()
      integer, parameter :: repeats = 15
      type(system_t) :: systems(1000)
      type(dice_t) :: d
      real(wp) :: time(2, repeats)
      type(spread_t) :: ratio, own(2)
      integer :: k

      d = new_dice(1)
      do k = 1, size(systems)
         systems(k) = random_system(d, special=0.0_wp)
      end do
      do k = 1, repeats
         time(1, k) = time_of(systems, .false.)
         time(2, k) = time_of(systems, .true.)
      end do
      own = [spread_of(1.0e9_wp*time(1, :)), spread_of(1.0e9_wp*time(2, :))]
      ratio = spread_of(time(1, :)/time(2, :))
      print '(a)', '', ' TWO EQUATIONS: DGESV, AND ITS OPERATIONS WRITTEN OUT, WHICH LANES USE', &
         ' RATIO: DGESV over the other in the same repeat; NS: the middle time', '', &
         '  DGESV NS  WRITTEN NS     RATIO   LEAST    MOST'
      print '(2x, a8, 4x, a8, 2x, 3a8)', figure(own(1)%median), figure(own(2)%median), figure(ratio%median), &
         figure(ratio%least), figure(ratio%most)
   end subroutine elimination_table

   !> Seconds a system: written out or by DGESV.
   real(wp) function time_of(systems, written) result(time)
      type(system_t), intent(in) :: systems(:)
      logical, intent(in) :: written
      integer, parameter :: passes = 30
      real(wp) :: begun, total
      type(system_t) :: s
      integer :: i, k, pivots(2), info

      total = 0.0_wp
      begun = seconds()
      do i = 1, passes
         do k = 1, size(systems)
            s = systems(k)
            if (written) then
               call eliminate(s%a, pivots, s%b, info)
            else
               call gesv(2, 1, s%a, 2, pivots, s%b, 2, info)
            end if
            total = total + s%b(1)
         end do
      end do
      time = (seconds() - begun)/(real(passes, wp)*size(systems))
      if (.not. abs(total) <= huge(total)) error stop 'A SOLUTION WITHOUT BOUNDS'
   end function time_of

   !> Compares factors, pivots, solution and status of `count` systems bit by bit, and prints how many differ.
   !> `failed`: 1 if any does.
   subroutine judge_elimination(count, failed)
      integer, intent(in) :: count
      integer, intent(out) :: failed
      type(dice_t) :: d
      type(system_t) :: one, two
      integer :: k, different, p1(2), p2(2), info1, info2
      logical :: same

      d = new_dice(2)
      different = 0
      do k = 1, count
         one = random_system(d, special=0.1_wp)
         two = one
         call gesv(2, 1, one%a, 2, p1, one%b, 2, info1)
         call eliminate(two%a, p2, two%b, info2)
         same = all(are_same(one%a, two%a)) .and. all(are_same(one%b, two%b)) .and. all(p1 == p2) .and. info1 == info2
         if (.not. same) different = different + 1
      end do
      failed = merge(1, 0, different > 0)
      print '(a, i0, a, i0)', ' TWO EQUATIONS WRITTEN OUT: SYSTEMS WITH OTHER BITS THAN BY DGESV: ', different, &
         ' OF ', count
      print '(i0, a, i0, a)', 1 - failed, ' passed, ', failed, ' failed'
   end subroutine judge_elimination

   !> The same number, with the same sign of a zero.
   elemental logical function are_same(x, y)
      real(wp), intent(in) :: x, y

      are_same = abs(x - y) <= 0.0_wp .and. (sign(1.0_wp, x)*sign(1.0_wp, y) > 0.0_wp)
   end function are_same

   !> Numbers below 2; in a part `special` of all systems some are zero, alike or of other sizes.
   function random_system(d, special) result(s)
      type(dice_t), intent(inout) :: d
      real(wp), intent(in) :: special
      type(system_t) :: s
      integer :: i, k

      do i = 1, 2
         s%b(i) = number(d)
         do k = 1, 2
            s%a(k, i) = number(d)
         end do
      end do
      if (.not. chance(d, special)) return
      select case (throw(d, 6))
      case (1)
         s%a(throw(d, 2), throw(d, 2)) = 0.0_wp
      case (2)
         s%b(throw(d, 2)) = 0.0_wp
      case (3)
         s%a(:, 1) = 0.0_wp
      case (4)
         s%a(2, :) = sign(1.0_wp, s%a(2, 2))*s%a(1, :)
      case (5)
         s%a(:, throw(d, 2)) = scale(s%a(:, throw(d, 2)), throw(d, maxexponent(1.0_wp)/2) - maxexponent(1.0_wp)/4)
      case default
         ! Below the least normal number a reciprocal would overflow.
         s%a(:, 1) = scale(s%a(:, 1), minexponent(1.0_wp) - 4)
         s%b = scale(s%b, minexponent(1.0_wp) - 4)
      end select
   end function random_system

   !> A number whose last bits are random too.
   real(wp) function number(d)
      type(dice_t), intent(inout) :: d

      number = between(d, -1.0_wp, 1.0_wp)*between(d, 1.0_wp, 2.0_wp)
   end function number
end module bench_elimination
